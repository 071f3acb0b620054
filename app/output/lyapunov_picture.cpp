/// The picture of Lyapunov exponents: running averages, or the growth of disturbances over a period.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/cycles/lyapunov.hpp"
#include "app/output/caption.hpp"
#include "app/output/digits.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "core/files.hpp"

namespace rosin::app::output {

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::cycles::LyapunovSpectrum& spectrum) {
  constexpr std::size_t most_panels = 4;
  const bool is_cycle = spectrum.from == "cycle";
  const std::size_t panels = std::min(spectrum.course.size(), most_panels);
  const Sheet sheet{"lyapunov",
                    is_cycle ? "Growth of disturbances over a period"
                             : "Running averages of Lyapunov exponents, with the standard error of the last",
                    {.panels = int(panels), .panel = 180, .above = 26, .between_rows = 45},
                    scene.title,
                    caption(scene)};
  std::string script = "set grid\n";
  script += fmt::format("set xrange [0:{}]\nset format x ''\n", spectrum.time.back());
  const auto exponent = [](const std::string& text) {
    return fmt::format("set label 1 {} at graph 0,1 offset 0,0.7 left\n", single_quoted(text));
  };
  for (std::size_t c = 0; c < panels; ++c) {
    const auto& [value, error, trivial] = spectrum.exponents[c];
    const auto& course = spectrum.course[c];
    if (c + 1 == panels) script += "set format x '%g'\nset xlabel 'time t (s)'\n";
    if (is_cycle) {
      script += fmt::format("{}set ylabel 'ln growth {}'\nplot {}*x with lines linestyle 2 notitle, \\\n",
                            exponent(fmt::format("λ t, λ = {} 1/s", with_error(value, error))), c + 1, value);
      script += fmt::format("     'lyapunov.csv' using 1:{} with lines linestyle 1 notitle\n", c + 2);
      continue;
    }
    // The first averages are of little, and would set the scale.
    constexpr double early = 0.05, band = 4;
    const auto first = course.begin() + long(early * double(course.size()));
    const auto [low, high] = std::minmax_element(first, course.end());
    script += exponent(fmt::format("λ = {} 1/s", with_error(value, error)));
    script += fmt::format("set ylabel 'exponent λ_{{{}}} (1/s)'\nset yrange [{}:{}]\n", c + 1,
                          std::min(*low, value - band * error), std::max(*high, value + band * error));
    script += fmt::format(
        "plot '+' using 1:({}):({}) with filledcurves linecolor '#B0560F' fillstyle solid 0.25 noborder "
        "title 'standard error', \\\n     {} with lines linestyle 2 title 'last average', "
        "\\\n     'lyapunov.csv' using 1:{} with lines linestyle 1 title 'average until t'\nunset key\n",
        value - error, value + error, value, c + 2);
  }
  write_whole(folder / "lyapunov.gp", sheet.with(std::move(script)));
  return {"lyapunov.gp"};
}

}  // namespace rosin::app::output
