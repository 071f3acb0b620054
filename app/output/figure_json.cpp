/// Figures as JSON, for whoever draws them otherwise: with all that is decided about them, and nothing that is usual.
#include <nlohmann/json.hpp>

#include "app/output/figure.hpp"

namespace rosin::app::output {

using namespace results;
using nlohmann::ordered_json;

namespace {

/// Leaves out what is unset, empty or false.
void add(ordered_json& object, const char* key, ordered_json value) {
  const bool none = value.is_null() || (value.is_number_float() && !std::isfinite(value.get<double>())) ||
                    (value.is_boolean() && !value.get<bool>()) || (value.is_structured() && value.empty()) ||
                    value == "";
  if (!none) object[key] = std::move(value);
}

template <class List, class F>
ordered_json list_of(const List& list, F f) {
  auto array = ordered_json::array();
  for (const auto& one : list) array.push_back(f(one));
  return array;
}

ordered_json json_of(const Tick& tick) { return {tick.at, tick.label}; }

ordered_json json_of(const Axis& axis) {
  ordered_json object;
  add(object, "name", axis.name);
  add(object, "symbol", axis.symbol);
  add(object, "detail", axis.detail);
  add(object, "unit", axis.unit == "1" ? "" : axis.unit);
  add(object, "decades", axis.decades);
  add(object, "low", axis.shown.low);
  add(object, "high", axis.shown.high);
  add(object, "from", axis.from);
  add(object, "to", axis.to);
  add(object, "ticks", list_of(axis.ticks, [](const Tick& tick) { return json_of(tick); }));
  add(object, "further_ticks", list_of(axis.further, [](const Tick& tick) { return json_of(tick); }));
  add(object, "ticks_from", axis.ticks_from);
  add(object, "zero", axis.zero);
  return object;
}

constexpr const char* points[] = {"dot", "circle", "cross",   "plus",      "square",      "open square",
                                  "up",  "down",   "open up", "open down", "open diamond"};

ordered_json json_of(const Look& look) {
  const auto& style = line_styles[look.style];
  ordered_json object{{"colour", look.colour.empty() ? style.colour : look.colour},
                      {"width", std::isnan(look.width) ? style.width : look.width},
                      {"point", points[int(look.point)]},
                      {"size", look.size}};
  add(object, "dash", look.dash.empty() ? std::string(style.dash) : look.dash == "solid" ? "" : look.dash);
  add(object, "halo", look.halo);
  return object;
}

/// Null where a row gives none.
ordered_json json_of(const Cell& cell) {
  ordered_json object;
  if (cell.column > 0) object["column"] = cell.column;
  if (cell.over > 0) object["over"] = cell.over;
  add(object, "absolute", cell.absolute);
  if (cell.factor != 1) object["factor"] = cell.factor;
  if (cell.plus != 0) object["plus"] = cell.plus;
  add(object, "least", cell.least);
  return object;
}

ordered_json json_of(const Where& where) {
  return {{"column", where.column},
          {"compare", std::string(1, where.compare)},
          {"value", where.text.empty() ? ordered_json(where.number) : ordered_json(where.text)}};
}

constexpr const char* hows[] = {"line", "points", "line and points", "steps", "bars",    "filled",
                                "band", "cells",  "upright",         "image", "surface", "boxplot"};

ordered_json json_of(const Line& line) {
  ordered_json object{{"how", hows[int(line.how)]}};
  add(object, "table", line.table);
  add(object, "rows", line.rows);
  add(object, "title", line.title);
  for (const auto& [key, cell] :
       {std::pair{"x", &line.x}, {"y", &line.y}, {"z", &line.z}, {"low", &line.low}, {"high", &line.high}})
    add(object, key, json_of(*cell));
  if (line.corners > 0) object["corners"] = line.corners;
  add(object, "where", list_of(line.where, [](const Where& where) { return json_of(where); }));
  add(object, "sorted", line.sorted);
  if (const auto& g = line.grid)
    object["grid"] = {{"first", g->first},
                      {"columns", g->columns},
                      {"rows", g->rows},
                      {"x", {g->x_first, g->x_last}},
                      {"y", {g->y_first, g->y_last}}};
  object["look"] = json_of(line.look);
  return object;
}

constexpr const char *sides[] = {"", "left", "right", "above", "below"},
                     *palettes[] = {"cividis", "grey", "blue", "signs"};

ordered_json json_of(const Panel& panel) {
  ordered_json object{{"x", json_of(panel.x)}, {"y", json_of(panel.y)}};
  if (panel.z) object["z"] = json_of(*panel.z);
  if (panel.colours)
    object["colours"] = {{"axis", json_of(panel.colours->axis)}, {"palette", palettes[int(panel.colours->palette)]}};
  add(object, "title", panel.title);
  add(object, "lines", list_of(panel.lines, [](const Line& line) { return json_of(line); }));
  add(object, "rules", list_of(panel.rules, [](const Rule& rule) {
        return ordered_json{
            {"axis", std::string(1, rule.axis)}, {"at", rule.at}, {"title", rule.title}, {"look", json_of(rule.look)}};
      }));
  add(object, "shades", list_of(panel.shades, [](const Shade& shade) {
        return ordered_json{{"axis", std::string(1, shade.axis)},
                            {"from", shade.from},
                            {"to", shade.to},
                            {"colour", shade.colour},
                            {"title", shade.title}};
      }));
  add(object, "marks", list_of(panel.marks, [](const Mark& mark) {
        return ordered_json{
            {"x", mark.x},         {"y", mark.y},         {"text", mark.text},         {"side", sides[int(mark.side)]},
            {"point", mark.point}, {"title", mark.title}, {"look", json_of(mark.look)}};
      }));
  add(object, "measures", list_of(panel.measures, [](const Measure& one) {
        return ordered_json{{"from", {one.from_x, one.from_y}}, {"to", {one.to_x, one.to_y}}, {"name", one.name}};
      }));
  add(object, "notes", panel.notes);
  add(object, "key", panel.key);
  add(object, "equal_scales", panel.equal_scales);
  add(object, "height", panel.height > 0 ? ordered_json(panel.height) : ordered_json());
  return object;
}

}  // namespace

std::string to_json(const Figure& figure) {
  constexpr const char* keys[] = {"above", "below", "own"};
  ordered_json object{{"name", figure.name},       {"what", figure.what},         {"title", figure.title},
                      {"caption", figure.caption}, {"columns", figure.columns},   {"width", figure.width},
                      {"height", figure.height},   {"key", keys[int(figure.key)]}};
  object["panels"] = list_of(figure.panels, [](const Panel& panel) { return json_of(panel); });
  add(object, "rows", list_of(figure.rows, [](const auto& row) { return ordered_json{row.first, row.second}; }));
  return object.dump(1, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace rosin::app::output
