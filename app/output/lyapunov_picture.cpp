/// The picture of Lyapunov exponents: running averages, or the growth of disturbances over a period.
#include <fmt/format.h>

#include "analysis/cycles/lyapunov.hpp"
#include "app/output/digits.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"

namespace rosin::app::output {

using namespace results;

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::cycles::LyapunovSpectrum& spectrum) {
  constexpr std::size_t most_panels = 4;
  const bool is_cycle = spectrum.from == "cycle";
  auto figure = figure_of(scene, "lyapunov",
                          is_cycle ? "Growth of disturbances over a period"
                                   : "Running averages of Lyapunov exponents, with the standard error of the last");
  figure.height = 180, figure.key = Key::below;
  auto time = axis_of("time", "s");
  time.from = 0, time.to = spectrum.time.back();
  for (std::size_t c = 0; c < std::min(spectrum.course.size(), most_panels); ++c) {
    const auto& [value, error, trivial] = spectrum.exponents[c];
    const Line course{.table = "lyapunov.csv", .y = {int(c) + 2}, .title = is_cycle ? "" : "average until t"};
    const auto exponent = fmt::format("λ = {} 1/s", with_error(value, error));
    if (is_cycle) {
      figure.panels.push_back(
          {.x = time,
           .y = {.name = fmt::format("ln growth {}", c + 1)},
           .lines = {{.table = "", .look = {.style = 1}, .rows = {{0, 0}, {time.to, value * time.to}}}, course},
           .title = "λ t, " + exponent});
      continue;
    }
    // The first averages are of little, and would set the scale.
    constexpr double early = 0.05, band = 4;
    const auto& values = spectrum.course[c];
    auto shown = Extent::of(std::ranges::subrange(values.begin() + long(early * double(values.size())), values.end()));
    shown.include(value - band * error), shown.include(value + band * error);
    figure.panels.push_back({.x = time,
                             .y = {.name = "exponent",
                                   .unit = "1/s",
                                   .symbol = fmt::format("λ_{}", c + 1),
                                   .from = shown.low,
                                   .to = shown.high},
                             .lines = {course},
                             .rules = {{'y', value, {.style = 1}, "last average"}},
                             .shades = {{'y', value - error, value + error, "#ECD5C3", "standard error"}},
                             .title = exponent});
  }
  return write(folder, figure);
}

}  // namespace rosin::app::output
