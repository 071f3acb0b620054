/// Tables of key numbers, made from whatever a document holds: single numbers, complex pairs, lists of objects.
#include "app/report/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "app/output/markup.hpp"
#include "app/report/quantities.hpp"
#include "core/error.hpp"

namespace rosin::app::report {

using output::escaped;

namespace {

constexpr std::size_t most_rows = 20, longest_list = 12;

/// Entries of documents that figures, verdicts and other parts of the page show.
bool is_shown_elsewhere(const std::string& key) {
  constexpr std::string_view keys =
      " title verb law version schema outcome outcome_detail approximation error units meaning datasets cost notes "
      "warnings time columns series planes labels x y failures points path correlation mesh sound metrics_errors fold "
      "unit errors standard_errors ";
  return keys.find(' ' + key + ' ') != keys.npos;
}

bool is_pair(const ordered_json& value) {
  return value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
}

struct Context {
  const ordered_json &error, &units, &meaning;
};

std::string complex_text(const ordered_json& pair, const std::string& unit) {
  const double imaginary = number(pair[1]);
  return fmt::format(
      "{}{}{}", number_text(number(pair[0]), 6),
      imaginary == 0 ? "" : fmt::format(" {} {} i", imaginary < 0 ? "−" : "+", number_text(std::abs(imaginary), 6)),
      unit.empty() || unit == "1" ? "" : " " + unit);
}

/// A list of two numbers is an interval or alike; pairs within a list are complex numbers.
std::string text_of(const ordered_json& value, const std::string& unit, double error) {
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return amount(value.get<double>(), unit, error);
  if (!value.is_array()) return value.is_null() ? "none" : "";
  std::string list;
  for (const auto& entry : value)
    list += (list.empty() ? "" : ", ") + (is_pair(entry) ? complex_text(entry, unit) : text_of(entry, unit, NAN));
  return list;
}

bool is_small(const ordered_json& value) {
  if (value.is_object()) return false;
  if (!value.is_array()) return true;
  return value.size() <= longest_list && !value.empty() &&
         std::ranges::all_of(value, [](const auto& entry) { return entry.is_primitive() || is_pair(entry); });
}

std::string row(const std::string& name, const std::string& symbol, const std::string& value,
                const std::string& meaning) {
  return fmt::format("<tr><th scope=\"row\">{}{}</th><td{}>{}</td><td>{}</td></tr>\n", escaped(readable(name)),
                     symbol.empty() ? "" : " " + escaped(symbol), value.size() > 60 ? " class=\"long\"" : "",
                     escaped(value), escaped(meaning));
}

/// Rows of the numbers of an object.
std::string rows_of(const ordered_json& object, const Context& context) {
  std::string rows;
  if (!object.is_object()) return rows;
  for (const auto& [key, value] : object.items()) {
    if (is_shown_elsewhere(key) || !is_small(value) || key == "standard_error") continue;
    const auto of_key = known(key);
    const auto unit = unit_of(key, context.units);
    const auto meaning = word(context.meaning, key).empty() ? of_key.meaning : word(context.meaning, key);
    double error = context.error.is_number() && key == "value" ? number(context.error) : number(context.error, key);
    if (std::isnan(error)) error = number(object, key + "_error");
    if (key.ends_with("_error") && object.contains(key.substr(0, key.size() - 6))) continue;
    const bool truth = meaning.starts_with("1 if ");
    rows += row(key, of_key.symbol, truth ? (number(value) > 0 ? "yes" : "no") : text_of(value, unit, error),
                truth ? meaning.substr(5) : meaning);
  }
  return rows;
}

std::string titled(const std::string& title, const std::string& head, const std::string& rows) {
  if (rows.empty()) return {};
  const auto count = std::ranges::count(rows, '\n');
  const bool folded = count > 25;
  return fmt::format(
      "<h3>{}</h3>\n{}<div class=\"wide\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"{}\"><table>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody></table></div>\n{}",
      escaped(title), folded ? fmt::format("<details><summary>{} rows</summary>\n", count) : "", escaped(title), head,
      rows, folded ? "</details>\n" : "");
}

/// What a list or an object of a document is called on the page.
std::string title_of(const std::string& key) {
  static const std::map<std::string, std::string> titles = {
      {"steady", "Steady sliding"},
      {"hopf", "Where steady sliding changes stability (Hopf points)"},
      {"thresholds", "Thresholds of steady sliding"},
      {"windows", "Windows in which a mode grows"},
      {"extrema", "Extrema of the curve"},
      {"section", "Where the period begins"},
      {"state", "States"},
      {"metrics", "Metrics"},
      {"readings", "Readings"},
      {"events", "Events"},
      {"modes", "Modes"},
      {"attractors", "Motions that starts come to"},
      {"threshold", "Disturbance that steady sliding does not survive"},
      {"parameters", "Fitted parameters"},
      {"measurements", "Measurements"},
      {"ranking", "Laws ranked"},
      {"members", "Members"},
      {"differences", "Differences"},
      {"branches", "Branches of cycles"},
      {"stability", "The structure on this friction"},
      {"best", "The best measurement"},
  };
  const auto found = titles.find(key);
  return found == titles.end() ? readable(key) : found->second;
}

std::string named(const std::string& title, const std::string& rows) {
  return titled(title, "<th scope=\"col\">quantity</th><th scope=\"col\">value</th><th scope=\"col\">meaning</th>",
                rows);
}

/// Objects of one kind, one in a row.
/// \param value_unit of what is called "value" in them, unless they say it themselves
std::string list_of(const std::string& title, const ordered_json& given, const std::string& value_unit = "",
                    const std::string& name_column = "") {
  auto list = given;
  for (auto& entry : list)  // metrics of a motion are as good as its own numbers
    if (entry.is_object() && at(entry, "metrics").is_object()) {
      const auto metrics = entry["metrics"];
      for (const auto& [key, value] : metrics.items())
        if (!entry.contains(key)) entry[key] = value;
    }
  std::vector<std::string> keys;
  for (const auto& [index, entry] : list.items()) {
    if (!entry.is_object()) return {};
    for (const auto& [key, value] : entry.items()) {
      const bool wanted = key != "error" && key != "shape" && is_small(value) && !value.is_null();
      if (wanted && std::ranges::find(keys, key) == keys.end() && keys.size() < 10) keys.push_back(key);
    }
  }
  std::erase_if(keys, [&](const auto& key) {  // an error stands beside its value
    const bool value = std::ranges::find(keys, "value") != keys.end();
    return (key == "standard_error" && value) || key == "unit" || key == "errors" || key == "difference_errors";
  });
  if (keys.empty()) return {};
  std::string head = name_column.empty() ? "" : fmt::format("<th scope=\"col\">{}</th>", escaped(name_column)), rows;
  for (const auto& key : keys) {
    const auto symbol = known(key).symbol;
    head +=
        fmt::format("<th scope=\"col\">{}{}</th>", escaped(readable(key)), symbol.empty() ? "" : " " + escaped(symbol));
  }
  std::size_t shown = 0;
  for (const auto& [index, entry] : list.items()) {
    if (++shown > most_rows) break;
    rows += "<tr>";
    if (!name_column.empty()) rows += fmt::format("<th scope=\"row\">{}</th>", escaped(index));
    for (const auto& key : keys) {
      const auto& value = at(entry, key);
      const auto& errors = at(entry, "error");
      double error = errors.is_number() && key == "value" ? number(errors) : number(errors, key);
      if (std::isnan(error) && key == "value") error = number(entry, "standard_error");
      auto unit = known(key).unit;
      if (key == "value") {
        unit = word(entry, "unit");
        if (unit.empty()) unit = known(word(entry, "parameter")).unit;
        if (unit.empty()) unit = value_unit;
      }
      if (key == "values" || key == "differences") unit = word(entry, "unit");
      const auto beside = numbers(at(entry, key == "values"        ? "errors"
                                            : key == "differences" ? "difference_errors"
                                                                   : ""));
      std::string text;
      for (std::size_t i = 0; i < beside.size() && i < value.size(); ++i)
        text += (i > 0 ? ", " : "") + text_of(value[i], unit, beside[i]);
      if (text.empty() && entry.contains(key)) text = text_of(value, unit, error);
      rows += fmt::format("<td>{}</td>", escaped(text));
    }
    rows += "</tr>\n";
  }
  if (list.size() > most_rows)
    rows += fmt::format("<tr><td colspan=\"{}\">and {} more in the document</td></tr>\n",
                        keys.size() + !name_column.empty(), list.size() - most_rows);
  return titled(title, head, rows);
}

/// A row for each number of many that lists have in common: eigenvalues, multipliers.
std::string pairs_of(const std::string& key, const ordered_json& pairs) {
  const auto of_key = known(key);
  std::string rows;
  for (std::size_t i = 0; i < std::min(pairs.size(), most_rows); ++i)
    rows += row(std::to_string(i + 1), "", complex_text(pairs[i], of_key.unit), "");
  if (pairs.size() > most_rows) rows += row("…", "", fmt::format("{} more", pairs.size() - most_rows), "");
  return titled(fmt::format("{}{}", readable(key), of_key.meaning.empty() ? "" : ", " + of_key.meaning),
                "<th scope=\"col\">number</th><th scope=\"col\">value</th><th scope=\"col\"></th>", rows);
}

/// Lists of equal length side by side: the slip events of a run, tables of an experiment.
std::string columns_of(const std::string& title, const ordered_json& object, const ordered_json& units) {
  std::vector<std::string> keys;
  std::size_t length = 0;
  for (const auto& [key, values] : object.items()) {
    if (!values.is_array() || values.empty() ||
        !std::ranges::all_of(values, [](const auto& v) { return v.is_primitive(); }))
      continue;
    if (length == 0) length = values.size();
    if (values.size() == length) keys.push_back(key);
  }
  if (keys.empty()) return {};
  std::string head, rows;
  for (const auto& key : keys) {
    const auto of_key = known(key);
    head += fmt::format("<th scope=\"col\">{}{}</th>", escaped(readable(key)),
                        of_key.symbol.empty() ? "" : " " + escaped(of_key.symbol));
  }
  for (std::size_t i = 0; i < std::min(length, most_rows); ++i) {
    rows += "<tr>";
    for (const auto& key : keys) {
      const auto errors = numbers(at(at(object, "error"), key));
      const auto unit = unit_of(key, units);
      rows += fmt::format("<td>{}</td>", escaped(text_of(object[key][i], unit, i < errors.size() ? errors[i] : NAN)));
    }
    rows += "</tr>\n";
  }
  if (length > most_rows)
    rows +=
        fmt::format("<tr><td colspan=\"{}\">and {} more in the document</td></tr>\n", keys.size(), length - most_rows);
  return titled(title, head, rows);
}

bool is_list_of_objects(const ordered_json& value) {
  return value.is_array() && !value.empty() &&
         std::ranges::all_of(value, [](const auto& entry) { return entry.is_object(); });
}

bool is_list_of_pairs(const ordered_json& value) {
  return value.is_array() && value.size() > 0 && std::ranges::all_of(value, is_pair);
}

}  // namespace

namespace {

/// Range and largest error of each metric of a plane.
std::string rows_of_plane(const ordered_json& document) {
  std::string rows;
  const auto& metrics = at(document, "metrics");
  if (!at(document, "regime").is_array() || !metrics.is_object()) return rows;
  const auto each = [](const ordered_json& grid, const auto& f) {
    for (const auto& line : grid.is_array() ? grid : ordered_json::array())
      for (const double value : numbers(line))
        if (std::isfinite(value)) f(value);
  };
  for (const auto& [name, grid] : metrics.items()) {
    double least = INFINITY, largest = -INFINITY, error = -1;  // none is known
    each(grid, [&](double value) { least = std::min(least, value), largest = std::max(largest, value); });
    each(at(at(document, "error"), name), [&](double value) { error = std::max(error, value); });
    if (!(least <= largest)) continue;
    const auto of_name = known(name);
    rows += row(name, of_name.symbol,
                fmt::format("{} … {}{}", amount(least, of_name.unit), amount(largest, of_name.unit),
                            error < 0 ? "" : ", error at most " + number_text(error, 1)),
                of_name.meaning);
  }
  return rows;
}

}  // namespace

std::string tables_of(const Result& result) {
  const auto& document = result.document;
  const auto &error = at(document, "error"), &units = at(document, "units"), &meaning = at(document, "meaning");
  auto own = document;
  for (const auto* key : {"slip_rate", "friction_coefficient", "frequency", "tangential"})
    if (own.contains(key) && own[key].is_array()) own.erase(key);
  for (const auto* key : {"eigenvalues", "multipliers"})
    if (is_list_of_pairs(at(own, key))) own.erase(key);
  if (result.label == "map" || result.label == "sweep")
    for (const auto* key : {"values", "up", "down"}) own.erase(key);
  auto html = named("Key numbers", rows_of_plane(document) + rows_of(own, {error, units, meaning}));
  for (const auto& [key, value] : document.items()) {
    if (is_shown_elsewhere(key)) continue;
    const auto title = title_of(key);
    if (result.label == "fit" && key == "parameters") {
      for (const auto& fit : at(document, "ranking"))  // the best law first
        html += list_of(fmt::format("{} of {}", title, word(fit, "law")), at(fit, "parameters"), "", "name");
    } else if (is_list_of_objects(value)) {
      html += list_of(title, value, unit_of_parameter(document));
    } else if ((key == "eigenvalues" || key == "multipliers") && is_list_of_pairs(value)) {
      html += pairs_of(key, value);
    } else if (value.is_object() && !value.empty() && !(result.label == "map" && key == "threshold")) {
      const auto of_object = named(
          title, rows_of(value, {key == "metrics" || key == "readings" ? error : at(value, "error"), units, meaning}));
      const bool objects = std::ranges::all_of(value, [](const auto& entry) { return entry.is_object(); });
      html += objects && of_object.empty() ? list_of(title, value, "", "name") : of_object;
      if (key == "tables")
        for (const auto& [name, table] : value.items())
          if (table.is_object()) html += columns_of(readable(name), table, units);
      if (key == "stick_slip") html += columns_of("Slip events", value, units);
    }
  }
  return html;
}

}  // namespace rosin::app::report
