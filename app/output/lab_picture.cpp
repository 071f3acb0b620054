/// Marks of readings in the panels of experiments: where a, a − b and L are, how high the last peak is, how it heals.
#include "app/output/lab_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "app/output/caption.hpp"
#include "app/output/digits.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/lab.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;
using analysis::lab::Panel;
using analysis::lab::Result;

namespace {

/// A reading with the symbol that it has in the field, and the distance in a panel that it is read off.
struct Mark {
  std::string symbol, reading, along = "";  ///< along: what the distance is
  bool drawn = false;
  double from_x = 0, from_y = 0, to_x = 0, to_y = 0;
};

/// Where a curve comes nearest to a value; the last such place.
double place_of(const Panel::Curve& curve, double value) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < curve.y.size(); ++i)
    if (std::abs(curve.y[i] - value) <= std::abs(curve.y[nearest] - value)) nearest = i;
  return curve.x.empty() ? 0 : curve.x[nearest];
}

std::vector<Mark> marks_in(const Result& result, const scene::Scene& scene, const Panel& panel) {
  const auto value = [&](const char* name) { return result.reading(name).value; };
  const auto& curve = panel.curves.front();
  const auto& experiment = scene.task<tasks::Lab>().experiment->name;
  if (experiment == "velocity-step" && panel.x_label == "slip since the step" && !curve.x.empty()) {
    const double before = value("friction_before"), peak = value("peak"), level = before + value("final_change"),
                 length = value("decay_length"), at = place_of(curve, peak),
                 decayed = std::lerp(level, peak, std::exp(-1)), end = 0.9 * curve.x.back();
    std::vector<Mark> marks = {{"a − b", "rate_dependence", "(a − b) ln(V/V₀)", true, end, before, end, level}};
    if (!std::isfinite(length)) return marks;  // no extreme apart from the level after: nothing jumps
    const bool jumps = std::abs(peak - before) > 0.02 * std::abs(peak - level);
    marks.insert(marks.begin(), {"a", "direct_effect", "a ln(V/V₀)", jumps, at, before, at, peak});
    marks.push_back({"decay length", "decay_length", "1/e", true, at, decayed, at + length, decayed});
    return marks;
  }
  if (experiment == "slide-hold-slide" && panel.x_decades) return {{"β", "healing_rate"}};
  if (experiment == "slide-hold-slide") {
    const double peak = result.tables.front().values[1].back(), at = place_of(curve, peak);
    return {{"Δμ", "last_rise", "Δμ", value("last_rise") > result.reading("last_rise").error, at,
             peak - value("last_rise"), at, peak}};
  }
  return {};
}

/// "a = 0.010000 ± 2e-06" of each mark whose reading is a number.
std::vector<std::string> texts_of(const Result& result, const std::vector<Mark>& marks) {
  std::vector<std::string> texts;
  for (const auto& mark : marks) {
    const auto& reading = result.reading(mark.reading);
    if (!std::isfinite(reading.value)) continue;
    const auto [factor, unit] = scaled(reading.unit, std::abs(reading.value));
    const auto text = fmt::format("{} = {}", mark.symbol, with_error(reading.value * factor, reading.error * factor));
    texts.push_back(unit == "1" ? text : text + ' ' + unit);
  }
  return texts;
}

/// Arrows with the symbols of what they show, and the texts below the upper border.
std::string drawn(const std::vector<Mark>& marks, const std::vector<std::string>& texts, double x, double y) {
  std::string script = "unset arrow\nunset label\n";
  for (std::size_t i = 0; i < texts.size(); ++i)
    script += fmt::format("set label {} at graph 0.97, graph {:.3f} right\n", single_quoted(texts[i]),
                          0.94 - 0.075 * double(i));
  for (const auto& mark : marks) {
    if (!mark.drawn) continue;
    script += fmt::format(
        "set arrow from {:.8g},{:.8g} to {:.8g},{:.8g} heads filled size graph 0.015,20 front linecolor "
        "'#B0560F' linewidth 1.4\n",
        mark.from_x * x, mark.from_y * y, mark.to_x * x, mark.to_y * y);
    const bool upright = mark.from_x == mark.to_x;
    script += fmt::format("set label {} at {:.8g},{:.8g} {} front textcolor '#B0560F'\n", single_quoted(mark.along),
                          (mark.from_x + mark.to_x) / 2 * x, (mark.from_y + mark.to_y) / 2 * y,
                          upright ? "right offset -0.7,0" : "center offset 0,-0.9");
  }
  return script;
}

}  // namespace

std::vector<std::string> write_lab_picture(const fs::path& folder, const scene::Scene& scene, const Result& result) {
  const auto& panels = result.panels;
  const int count = static_cast<int>(panels.size());
  const auto title = scene.title.empty() ? std::string(scene.task<tasks::Lab>().experiment->title) : scene.title;
  // Keys stand above their panels; of many curves inside.
  const auto labelled = [](const Panel& panel) {
    const auto count = std::ranges::count_if(panel.curves, [](const auto& curve) { return !curve.label.empty(); });
    return count > 3 ? 0 : int(count);
  };
  const Sheet sheet{"lab",
                    "What an experiment shows, a panel each",
                    {.width = count == 1 ? 720 : 940,
                     .panels = count,
                     .columns = std::min(count, 2),
                     .panel = 310,
                     .above = 28,
                     .between_rows = 95,
                     .key = Layout::Key::own,
                     .own_titles = std::ranges::max(panels | std::views::transform(labelled))},
                    title,
                    caption(scene)};
  std::string script = "set grid\n";
  std::vector<std::string> files;
  for (const auto& panel : panels) {
    double far = 0, high = 0;
    for (const auto& curve : panel.curves)
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (std::isfinite(curve.x[i])) far = std::max(far, std::abs(curve.x[i]));
        if (std::isfinite(curve.y[i])) high = std::max(high, std::abs(curve.y[i]));
      }
    const bool is_zero = high <= panel.y_error && !panel.y_decades;  // what is left is rounding
    const auto x = panel.x_decades ? Scaled{1, panel.x_unit} : scaled(panel.x_unit, far);
    const auto y = panel.y_decades ? Scaled{1, panel.y_unit} : scaled(panel.y_unit, high);
    script += fmt::format("\n{}\n{}\nset xlabel {}\nset ylabel {}\n", axis_scale('x', panel.x_decades),
                          axis_scale('y', panel.y_decades), label(panel.x_label, x.unit), label(panel.y_label, y.unit));
    const auto marks = marks_in(result, scene, panel);
    const auto texts = texts_of(result, marks);  // in a band above the curves
    script += panel.y_decades
                  ? "unset offsets\n"
                  : fmt::format("set offsets 0, 0, graph {:g}, graph 0.06\n", 0.06 + 0.1 * double(texts.size()));
    script += is_zero ? "set yrange [-1:1]\n" : "set yrange [*:*]\n";
    script += drawn(marks, texts, x.factor, y.factor);
    script += panel.curves.size() > 3 ? "set key inside top right vertical\n"
                                      : "set key at graph 1,1.02 right bottom horizontal\n";
    std::vector<std::string> curves;
    for (const auto& curve : panel.curves) {
      const auto file =
          fmt::format("lab-panel-{}-{}.csv", &panel - panels.data() + 1, &curve - panel.curves.data() + 1);
      const std::vector<double> zeros(curve.y.size());
      std::vector<Column> table = {{column_header(panel.x_label, panel.x_unit), curve.x},
                                   {column_header(panel.y_label, panel.y_unit), is_zero ? zeros : curve.y}};
      if (!curve.low.empty()) {
        table.push_back({"low", curve.low});
        table.push_back({"high", curve.high});
        curves.push_back(fmt::format("'{}' using ($1*{}):($3*{}):($4*{}) with filledcurves linecolor '#B8CBE0' notitle",
                                     file, x.factor, y.factor, y.factor));
      }
      write_csv(folder / file, table);
      files.push_back(file);
      const auto title = curve.label.empty() ? std::string("notitle") : "title " + single_quoted(curve.label);
      const int style = static_cast<int>(&curve - panel.curves.data()) % 3 + 1;
      curves.push_back(fmt::format("'{}' using ($1*{}):($2*{}) with {} {} {}", file, x.factor, y.factor,
                                   curve.points ? "points pointtype 7 pointsize 0.9 linecolor" : "lines linestyle",
                                   curve.points ? "'#00336F'" : fmt::format("{}", style), title));
    }
    script += fmt::format("plot {}\n", fmt::join(curves, ", \\\n     "));
  }
  write_whole(folder / "lab.gp", sheet.with(std::move(script)));
  files.push_back("lab.gp");
  return files;
}

}  // namespace rosin::app::output
