/// Marks of readings in the panels of experiments: where a, a − b and L are, how high the last peak is, how it heals.
#include "app/output/lab_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/output/digits.hpp"
#include "app/output/figure.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/scene_figure.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/lab.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;
using LabPanel = analysis::lab::Panel;
using analysis::lab::Result;

namespace {

/// A reading with the symbol that it has in the field, and the distance in a panel that it is read off.
struct Mark {
  std::string symbol, reading, along = "";  ///< along: what the distance is
  bool drawn = false;
  double from_x = 0, from_y = 0, to_x = 0, to_y = 0;
};

/// Where a curve comes nearest to a value; the last such place.
double place_of(const LabPanel::Curve& curve, double value) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < curve.y.size(); ++i)
    if (std::abs(curve.y[i] - value) <= std::abs(curve.y[nearest] - value)) nearest = i;
  return curve.x.empty() ? 0 : curve.x[nearest];
}

std::vector<Mark> marks_in(const Result& result, const scene::Scene& scene, const LabPanel& panel) {
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

}  // namespace

std::vector<std::string> write_lab_picture(const fs::path& folder, const scene::Scene& scene, const Result& result) {
  auto figure = figure_of(scene, "lab", "What an experiment shows, a panel each");
  if (figure.title.empty()) figure.title = scene.task<tasks::Lab>().experiment->title;
  const bool alone = result.panels.size() == 1;
  figure.width = alone ? 720 : 940, figure.columns = alone ? 1 : 2, figure.height = 310, figure.key = results::Key::own;
  for (const auto& panel : result.panels) {
    results::Extent across, up;
    for (const auto& curve : panel.curves) {
      for (const double x : curve.x) across.include(x);
      for (const double y : curve.y) up.include(y);
    }
    const bool is_zero = up.largest() <= panel.y_error && !panel.y_decades;  // what is left is rounding
    results::Panel shown{
        .x = {.name = panel.x_label, .unit = panel.x_unit, .decades = panel.x_decades, .shown = across},
        .y = {.name = panel.y_label, .unit = panel.y_unit, .decades = panel.y_decades, .shown = up}};
    if (is_zero) shown.y.shown = {}, shown.y.from = -1, shown.y.to = 1;
    const auto marks = marks_in(result, scene, panel);
    shown.notes = texts_of(result, marks);
    for (const auto& mark : marks)
      if (mark.drawn) shown.measures.push_back({mark.from_x, mark.from_y, mark.to_x, mark.to_y, mark.along});
    if (panel.curves.size() > 3) shown.key = "top right";
    for (std::size_t k = 0; k < panel.curves.size(); ++k) {
      const auto& curve = panel.curves[k];
      results::FigureTable table{
          fmt::format("lab-panel-{}-{}.csv", &panel - result.panels.data() + 1, k + 1),
          {column_of(panel.x_label, panel.x_unit, curve.x),
           column_of(panel.y_label, panel.y_unit, is_zero ? std::vector<double>(curve.y.size()) : curve.y)}};
      if (!curve.low.empty()) {
        table.columns.push_back({"low", curve.low});
        table.columns.push_back({"high", curve.high});
        shown.lines.push_back(
            {.table = table.file, .how = results::How::band, .look = {.colour = "#B8CBE0"}, .low = {3}, .high = {4}});
      }
      shown.lines.push_back({.table = table.file,
                             .how = curve.points ? results::How::points : results::How::line,
                             .look = {.style = results::style_of(k), .size = 0.9},
                             .title = curve.label});
      figure.tables.push_back(std::move(table));
    }
    figure.panels.push_back(std::move(shown));
  }
  return write(folder, figure);
}

}  // namespace rosin::app::output
