/// Planes of documents.
#include "app/report/plane.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "app/report/quantities.hpp"

namespace rosin::app::report {

namespace {

/// Cells times layers, each with its error: what a page of a megabyte has room for.
constexpr std::size_t most_cells = 25'000;

/// An axis as it is drawn: borders of its cells; values outside the scale stand below it, after a gap.
struct DrawnAxis {
  std::string parameter, unit;
  bool log = false;
  std::vector<double> values, low, at, high;
  std::size_t regular = 0;

  explicit DrawnAxis(const ordered_json& axis) {
    parameter = word(axis, "parameter").empty() ? word(axis, "start") : word(axis, "parameter");
    unit = word(axis, "unit");
    log = word(axis, "scale") == "log";
    values = numbers(report::at(axis, "values"));
    if (values.size() < 2) return;
    const auto place = [&](double value) { return log ? std::log10(value) : value; };
    const double step = place(values[1]) - place(values[0]);
    regular = 1;
    while (regular < values.size() &&
           std::abs(place(values[regular]) - place(values[regular - 1]) - step) <= 1e-6 * std::abs(step))
      ++regular;
    const double first = place(values[0]), last = place(values[regular - 1]);
    const double thickness = std::max(std::abs(step), std::abs(last - first) / 40);
    const auto back = [&](double coordinate) { return log ? std::pow(10, coordinate) : coordinate; };
    for (std::size_t i = 0; i < values.size(); ++i) {
      const bool outside = i >= regular;
      const double centre =
          outside ? std::min(first, last) - (2.5 + 1.5 * double(values.size() - 1 - i)) * thickness : place(values[i]);
      const double half = (outside ? thickness : std::abs(step)) / 2;
      low.push_back(back(centre - half)), at.push_back(back(centre)), high.push_back(back(centre + half));
    }
  }
  bool usable() const { return regular >= 2; }

  ordered_json json() const {
    const auto of_parameter = known(parameter);
    const auto [least, largest] = std::minmax_element(values.begin(), values.begin() + std::ptrdiff_t(regular));
    const bool path = parameter.find('.') != parameter.npos && !of_parameter.meaning.empty();
    ordered_json axis{{"name", path ? of_parameter.meaning : readable(parameter)},
                      {"parameter", parameter},
                      {"unit", unit},
                      {"log", log},
                      {"values", values},
                      {"low", low},
                      {"at", at},
                      {"high", high}};
    if (!of_parameter.symbol.empty()) axis["symbol"] = of_parameter.symbol;
    if (regular < values.size()) {
      axis["within"] = {*least * (1 - 1e-9), *largest * (1 + 1e-9)};
      auto& extra = axis["extra"] = ordered_json::array();
      for (std::size_t i = regular; i < values.size(); ++i) extra.push_back({{"at", at[i]}, {"value", values[i]}});
    }
    return axis;
  }
};

bool is_grid(const ordered_json& rows, std::size_t height, std::size_t width) {
  return rows.is_array() && rows.size() == height &&
         std::ranges::all_of(rows, [&](const auto& row) { return row.is_array() && row.size() == width; });
}

ordered_json rounded_grid(const ordered_json& rows, int digits) {
  auto grid = ordered_json::array();
  for (const auto& row : rows) {
    auto list = ordered_json::array();
    for (const auto& value : row) list.push_back(rounded(number(value), digits));
    grid.push_back(std::move(list));
  }
  return grid;
}

/// A plane in the making.
struct Plane {
  DrawnAxis x, y;
  ordered_json layers = ordered_json::array(), lines = ordered_json::array();

  Plane(const ordered_json& x_axis, const ordered_json& y_axis) : x(x_axis), y(y_axis) {}
  bool usable() const { return x.usable() && y.usable(); }
  bool fits(const ordered_json& rows) const { return is_grid(rows, y.values.size(), x.values.size()); }

  void add_words(const std::string& name, const ordered_json& rows) {
    if (!fits(rows)) return;
    std::vector<std::string> words;
    for (const auto& row : rows)
      for (const auto& value : row)
        if (value.is_string() && std::ranges::find(words, value.get<std::string>()) == words.end())
          words.push_back(value.get<std::string>());
    std::ranges::sort(words);
    layers.push_back({{"name", name}, {"unit", "1"}, {"words", words}, {"values", rows}});
  }
  void add_numbers(const std::string& key, const ordered_json& rows, const ordered_json& errors,
                   const std::string& of_whom = "") {
    if (!fits(rows)) return;
    const auto of_key = known(key);
    ordered_json layer{{"name", (of_whom.empty() ? "" : of_whom + ": ") + readable(key)},
                       {"unit", of_key.unit.empty() ? "1" : of_key.unit},
                       {"values", rounded_grid(rows, 9)}};
    if (!of_key.symbol.empty()) layer["symbol"] = of_key.symbol;
    if (key == "discriminability" || key == "separation") layer["decades"] = true;
    if (fits(errors)) layer["error"] = rounded_grid(errors, 2);
    layers.push_back(std::move(layer));
  }
  void add_line(const std::string& name, const ordered_json& line, const char* dash) {
    const auto xs = numbers(at(line, "x")), ys = numbers(at(line, "y"));
    if (xs.empty() || xs.size() != ys.size()) return;
    ordered_json drawn{{"name", name}, {"x", ordered_json::array()}, {"y", ordered_json::array()}, {"dash", dash}};
    for (std::size_t i = 0; i < xs.size(); ++i) {
      if (!std::isfinite(xs[i]) || !std::isfinite(ys[i])) continue;
      drawn["x"].push_back(rounded(xs[i], 9));
      drawn["y"].push_back(rounded(ys[i], 9));
    }
    lines.push_back(std::move(drawn));
  }

  /// Every so many-th row and column, where all would make too large a page.
  std::size_t thin() {
    const auto cells = x.values.size() * y.values.size() * layers.size();
    const auto every = std::size_t(std::ceil(std::sqrt(double(cells) / most_cells)));
    if (every <= 1) return 1;
    const auto keep = [&](auto& list) {
      std::remove_reference_t<decltype(list)> kept{};
      for (std::size_t i = 0; i < list.size(); i += every) kept.push_back(list[i]);
      list = std::move(kept);
    };
    for (auto& layer : layers)
      for (const auto* key : {"values", "error"})
        if (auto found = layer.find(key); found != layer.end()) {
          keep(*found);
          for (auto& row : *found) keep(row);
        }
    for (auto* axis : {&x, &y}) {
      auto step = axis->values;
      step.resize(axis->regular);
      keep(step);
      axis->values = step;
      *axis = DrawnAxis({{"parameter", axis->parameter},
                         {"unit", axis->unit},
                         {"scale", axis->log ? "log" : "linear"},
                         {"values", step}});
    }
    for (auto& layer : layers)  // without those outside the scale
      for (const auto* key : {"values", "error"})
        if (auto found = layer.find(key); found != layer.end()) {
          found->get_ref<ordered_json::array_t&>().resize(y.values.size());
          for (auto& row : *found) row.get_ref<ordered_json::array_t&>().resize(x.values.size());
        }
    return every;
  }

  Figure figure(const std::string& title) {
    const auto every = thin();
    Figure made;
    made.caption = title + ".";
    if (every > 1)
      made.caption += fmt::format(" One value in {} of each axis is shown; all stand in the results folder.", every);
    made.data = {{"kind", "plane"}, {"title", title},   {"x", x.json()},
                 {"y", y.json()},   {"layers", layers}, {"lines", lines}};
    return made;
  }
};

/// Motions at single points that stand in the same folder, by their parameters.
ordered_json spots_of(const Folder& folder, const DrawnAxis& x, const DrawnAxis& y) {
  auto spots = ordered_json::array();
  for (const auto& other : folder.results) {
    if (other.label != "cycle" && other.label != "run") continue;
    const auto& parameters = at(other.manifest, "parameters");
    const double at_x = number(at(parameters, x.parameter), "value"),
                 at_y = number(at(parameters, y.parameter), "value");
    const auto nearest = [](const DrawnAxis& axis, double value) {
      for (std::size_t i = 0; i < axis.values.size(); ++i)
        if (value >= std::min(axis.low[i], axis.high[i]) && value <= std::max(axis.low[i], axis.high[i])) return int(i);
      return -1;
    };
    const int ix = nearest(x, at_x), iy = nearest(y, at_y);
    if (ix < 0 || iy < 0) continue;
    const auto name = other.label == "cycle" ? "the cycle of this page" : "the run of this page";
    spots.push_back({{"x", at_x},
                     {"y", at_y},
                     {"ix", ix},
                     {"iy", iy},
                     {"name", name},
                     {"link", "#" + other.label},
                     {"text", fmt::format("Within this cell, {} was computed: {} = {}, {} = {}.", name, x.parameter,
                                          amount(at_x, x.unit), y.parameter, amount(at_y, y.unit))}});
  }
  return spots;
}

}  // namespace

ordered_json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.{}g}", value, digits).c_str(), nullptr);
}

void add_planes(const Folder& folder, const Result& result, std::vector<Figure>& figures) {
  const auto& document = result.document;
  Plane plane(at(document, "x"), at(document, "y"));
  if (!plane.usable()) return;
  const auto add_metrics = [&](const ordered_json& of, const std::string& whom) {
    if (const auto& metrics = at(of, "metrics"); metrics.is_object())
      for (const auto& [name, rows] : metrics.items()) plane.add_numbers(name, rows, at(at(of, "error"), name), whom);
  };
  add_metrics(document, "");
  plane.add_words("regime", at(document, "regime"));
  if (const auto& members = at(document, "planes"); members.is_object())
    for (const auto& [member, of] : members.items()) {
      add_metrics(of, member);
      plane.add_words(member + ": regime", at(of, "regime"));
      plane.add_line(member + ": threshold of steady sliding", at(of, "threshold"), plane.lines.empty() ? "" : "6 4");
    }
  if (const auto& labels = at(document, "labels"); plane.fits(labels)) {
    auto words = labels;
    const auto& attractors = at(document, "attractors");
    const auto named = [&](int label) {
      const bool there = attractors.is_array() && label >= 0 && std::size_t(label) < attractors.size();
      return fmt::format("motion {}{}", label + 1, there ? ", " + word(attractors[std::size_t(label)], "kind") : "");
    };
    for (auto& row : words)
      for (auto& value : row) value = value.is_number() ? ordered_json(named(value.get<int>())) : ordered_json();
    plane.add_words("motion that the start comes to", words);
  }
  plane.add_numbers("discriminability", at(document, "discriminability"), at(document, "discriminability_error"));
  if (const auto& parts = at(document, "by_metric"); parts.is_object() && parts.size() > 1)
    for (const auto& [name, part] : parts.items())
      plane.add_numbers("discriminability", at(part, "discriminability"), {}, name);
  plane.add_numbers("separation", at(document, "separation"), {});
  plane.add_line("threshold of steady sliding", at(document, "threshold"), "");
  plane.add_line("fold of cycles", at(document, "fold"), "6 4");
  if (plane.layers.empty()) return;
  const auto title = fmt::format("Over {} and {}", plane.x.parameter, plane.y.parameter);
  auto figure = plane.figure(title);
  if (result.label == "map") {
    const bool string = word(result.manifest, "scene_resolved").find("type = \"string\"") != std::string::npos;
    figure.data["command"] = command_of(result, string ? "run" : "cycle", {plane.x.parameter, plane.y.parameter});
    figure.data["spots"] = spots_of(folder, plane.x, plane.y);
    if (figure.caption == title + ".") figure.data["failures"] = at(document, "failures");
  }
  figures.push_back(std::move(figure));
}

}  // namespace rosin::app::report
