/// The picture of Lyapunov exponents: running averages, or the growth of disturbances over a period.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "core/files.hpp"

namespace rosin::app::output {

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::cycles::LyapunovSpectrum& spectrum) {
  constexpr std::size_t most_panels = 4;
  constexpr int panel = 220, margin = 120;
  const bool is_cycle = spectrum.from == "cycle";
  const std::size_t panels = std::min(spectrum.course.size(), most_panels);
  const int height = margin + panel * int(panels);
  std::string script =
      preamble("lyapunov",
               is_cycle ? "Growth of disturbances over a period"
                        : "Running averages of Lyapunov exponents, with the standard error of the last",
               820, height);
  script += fmt::format("set multiplot layout {},1 title {} margins 0.14,0.96,{:.4f},{:.4f} spacing 0,0.06\n", panels,
                        single_quoted(scene.title), 60.0 / height, 1 - 70.0 / height);
  script += "set grid\nset key at graph 1,1.02 right bottom horizontal\n";
  script += fmt::format("set xrange [0:{}]\nset format x ''\n", spectrum.time.back());
  for (std::size_t c = 0; c < panels; ++c) {
    const auto& [value, error, trivial] = spectrum.exponents[c];
    const auto& course = spectrum.course[c];
    if (c + 1 == panels) script += "set format x '%g'\nset xlabel 'time t (s)'\n";
    if (is_cycle) {
      script += fmt::format("set ylabel 'ln growth {}'\nplot {}*x with lines linestyle 2 title {}, \\\n", c + 1, value,
                            single_quoted(fmt::format("λ t, λ = {:.6g} 1/s", value)));
      script += fmt::format("     'lyapunov.csv' using 1:{} with lines linestyle 1 notitle\n", c + 2);
      continue;
    }
    // The first averages are of little, and would set the scale.
    constexpr double early = 0.05, band = 4;
    const auto first = course.begin() + long(early * double(course.size()));
    const auto [low, high] = std::minmax_element(first, course.end());
    script += fmt::format("set ylabel 'exponent λ_{{{}}} (1/s)'\nset yrange [{}:{}]\n", c + 1,
                          std::min(*low, value - band * error), std::max(*high, value + band * error));
    script += fmt::format(
        "plot '+' using 1:({}):({}) with filledcurves linecolor '#B0560F' fillstyle solid 0.25 noborder "
        "title 'standard error', \\\n     {} with lines linestyle 2 title {}, \\\n",
        value - error, value + error, value, single_quoted(fmt::format("{:.4g} 1/s", value)));
    script += fmt::format("     'lyapunov.csv' using 1:{} with lines linestyle 1 title 'average until t'\n", c + 2);
  }
  script += "unset multiplot\n";
  write_whole(folder / "lyapunov.gp", script);
  return {"lyapunov.gp"};
}

}  // namespace rosin::app::output
