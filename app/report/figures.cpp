/// Curves of documents and of their tables.
#include "app/report/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "app/report/plane.hpp"
#include "app/report/quantities.hpp"
#include "core/error.hpp"
#include "core/process.hpp"

namespace rosin::app::report {

namespace {

/// Numbers in one figure: what a page of a megabyte has room for.
constexpr std::size_t most_numbers = 40'000, most_columns = 12;

struct Curve {
  std::string name;
  std::vector<std::vector<double>> columns;
  int like = -1;  ///< colour and dashes of another curve; −1: its own
  const char* dash = nullptr;
  bool points = false;
};

ordered_json quantity(const std::string& key, const std::string& unit) {
  const auto of_key = known(key);
  ordered_json entry{{"key", key}, {"name", readable(key)}, {"unit", readable_unit(unit.empty() ? of_key.unit : unit)}};
  if (unit == "1" || (unit.empty() && of_key.unit == "1")) entry["unit"] = "1";
  if (!of_key.symbol.empty()) entry["symbol"] = of_key.symbol;
  return entry;
}

/// Samples that are shown where there is no room for all: of each stretch the least and the largest value.
std::vector<std::size_t> thinned(const std::vector<double>& values, std::size_t most) {
  std::vector<std::size_t> kept;
  const auto count = values.size(), stretches = std::max<std::size_t>(most / 2, 1);
  if (count <= most) {
    for (std::size_t i = 0; i < count; ++i) kept.push_back(i);
    return kept;
  }
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto from = s * count / stretches, end = (s + 1) * count / stretches;
    const auto [least, largest] =
        std::minmax_element(values.begin() + std::ptrdiff_t(from), values.begin() + std::ptrdiff_t(end));
    std::set<std::size_t> pair{std::size_t(least - values.begin()), std::size_t(largest - values.begin())};
    if (s == 0) pair.insert(0);
    if (s + 1 == stretches) pair.insert(count - 1);
    kept.insert(kept.end(), pair.begin(), pair.end());
  }
  return kept;
}

/// The same of points that lie beside each other.
std::vector<std::size_t> every_so_many(std::size_t count, std::size_t most) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0, step = 1 + (count - 1) / most; i < count; i += step) kept.push_back(i);
  return kept;
}

/// \param columns "name" and "unit" of each, as `quantity` makes them
Figure curves(const std::string& title, std::vector<ordered_json> columns, std::vector<Curve> list, std::size_t x,
              std::size_t y) {
  Figure figure;
  const auto room = std::max<std::size_t>(most_numbers / (columns.size() * std::max<std::size_t>(list.size(), 1)), 50);
  auto series = ordered_json::array();
  bool all = true;
  for (auto& curve : list) {
    const auto kept = curve.points ? every_so_many(curve.columns[y].size(), room) : thinned(curve.columns[y], room);
    all = all && kept.size() == curve.columns[y].size();
    auto data = ordered_json::array();
    for (const auto& column : curve.columns) {
      auto values = ordered_json::array();
      for (const auto i : kept) values.push_back(rounded(column[i], 9));
      data.push_back(std::move(values));
    }
    ordered_json one{{"name", curve.name}, {"data", std::move(data)}};
    if (curve.like >= 0) one["like"] = curve.like;
    if (curve.dash) one["dash"] = curve.dash;
    if (curve.points) one["points"] = true;
    series.push_back(std::move(one));
  }
  figure.data = {{"kind", "curves"}, {"title", title}, {"columns", columns}, {"series", std::move(series)},
                 {"x", x},           {"y", y}};
  figure.caption = title + ".";
  if (!all) figure.data["thinned"] = true;
  if (!all) figure.caption += " A part of the samples is shown, with their extremes; all stand in the results folder.";
  return figure;
}

bool all_of_size(const std::vector<std::vector<double>>& columns, std::size_t size) {
  return size > 0 && std::ranges::all_of(columns, [&](const auto& column) { return column.size() == size; });
}

/// The first of these names among the columns, else the given one.
std::size_t column_named(const std::vector<std::string>& names, std::initializer_list<std::string_view> wanted,
                         std::size_t otherwise) {
  for (const auto& name : wanted)
    if (const auto found = std::ranges::find(names, name); found != names.end())
      return std::size_t(found - names.begin());
  return std::min(otherwise, names.size() - 1);
}

// ---------------------------------------------------------------- motions

/// Times during which something sticks, by the events of a run; empty where several contacts do so by themselves.
ordered_json stick_of(const ordered_json& events, double end) {
  auto bands = ordered_json::array();
  double since = NAN;
  if (!events.is_array()) return bands;
  for (const auto& event : events) {
    if (!at(event, "contact").is_null()) return ordered_json::array();
    const auto kind = word(event, "kind");
    if (kind == "stick") since = number(event, "time");
    if (kind == "slip" && !std::isnan(since)) bands.push_back({since, number(event, "time")}), since = NAN;
  }
  if (!std::isnan(since)) bands.push_back({since, end});
  return bands.size() > 400 ? ordered_json::array() : bands;
}

void add_motion(const ordered_json& document, std::vector<Figure>& figures) {
  const auto time = numbers(at(document, "time"));
  const auto& given = at(document, "columns");
  if (time.empty() || !given.is_object()) return;
  std::vector<std::string> names{"time"};
  std::vector<ordered_json> columns{quantity("time", "s")};
  Curve motion{"", {time}};
  for (const auto& [name, values] : given.items()) {
    auto list = numbers(values);
    if (list.size() != time.size() || names.size() > most_columns) continue;
    names.push_back(name);
    columns.push_back(quantity(name, word(at(document, "units"), name)));
    if (const double error = number(at(document, "error"), name); error > 0)
      columns.back()["error"] = rounded(error, 2);
    motion.columns.push_back(std::move(list));
  }
  if (names.size() < 2) return;
  const auto slip = column_named(names, {"slip_rate", "slip_rate_1", "velocity"}, 1);
  const auto friction =
      column_named(names, {"friction_coefficient", "friction_force", "friction_force_1", "friction"}, 1);
  figures.push_back(curves("Motion over time", columns, {motion}, 0, slip));
  const auto bands = stick_of(at(document, "events"), time.back());
  figures.back().data["bands"] = bands;
  if (!bands.empty()) figures.back().caption += " Shaded: stick.";
  if (friction != slip) figures.back().views.push_back({"Friction over slip rate", slip, friction});
}

// ---------------------------------------------------------------- tables

/// A table as columns any of which may be drawn over any other.
void add_table(const Folder& folder, const std::string& file, const std::string& title, std::vector<Figure>& figures,
               std::initializer_list<std::string_view> up = {}, std::initializer_list<std::string_view> across = {}) {
  const auto table = read_table(folder.path / file);
  if (table.size() < 2 || table.front().values.empty()) return;
  std::vector<std::string> names;
  std::vector<ordered_json> columns;
  Curve curve;
  for (std::size_t c = 0; c < std::min(table.size(), most_columns); ++c) {
    names.push_back(table[c].name);
    columns.push_back(quantity(table[c].name, table[c].unit));
    curve.columns.push_back(table[c].values);
  }
  figures.push_back(curves(title, columns, {curve}, column_named(names, across, 0), column_named(names, up, 1)));
}

void add_cycle(const Folder& folder, std::vector<Figure>& figures) {
  add_table(folder, "cycle.csv", "One period over time", figures, {"slip_rate", "slip_rate_1", "velocity"});
  if (figures.empty()) return;
  std::vector<std::string> names;
  for (const auto& column : figures.back().data["columns"]) names.push_back(word(column, "key"));
  const auto slip = column_named(names, {"slip_rate", "slip_rate_1"}, 1);
  const auto friction = column_named(
      names, {"friction_coefficient", "friction_force", "friction_coefficient_1", "friction_force_1"}, slip);
  if (friction != slip) figures.back().views.push_back({"Friction over slip rate in one period", slip, friction});
}

/// Measured values and the curves of the laws that were fitted, of each set of data.
void add_fits(const Folder& folder, const Result& result, std::vector<Figure>& figures) {
  const auto& data = at(result.document, "measurements");
  for (std::size_t d = 0; data.is_array() && d < data.size(); ++d) {
    const auto table = read_table(folder.path / fmt::format("fit-curve-{}.csv", d + 1));
    if (table.size() < 3 || table[0].values.empty()) continue;
    std::vector<Curve> shown = {{"measured", {table[0].values, table[1].values}, -1, nullptr, true},
                                {word(result.document, "law"), {table[0].values, table[2].values}}};
    const auto of_others = table[2].name + " of ";
    for (const auto& column : table)
      if (column.name.starts_with(of_others))
        shown.push_back({column.name.substr(of_others.size()), {table[0].values, column.values}});
    figures.push_back(curves("Measured and fitted: " + word(data[d], "data"),
                             {quantity(table[0].name, table[0].unit), quantity("friction", "1")}, std::move(shown), 0,
                             1));
    figures.back().data["columns"][1]["name"] = "measured and fitted";
  }
}

// ---------------------------------------------------------------- curves along a parameter

void add_steady_curve(const ordered_json& document, std::vector<Figure>& figures) {
  const Curve curve{"", {numbers(at(document, "slip_rate")), numbers(at(document, "friction_coefficient"))}};
  if (!all_of_size(curve.columns, curve.columns[0].size())) return;
  auto rate = quantity("slip_rate", "m/s");
  rate["log"] = true;
  figures.push_back(
      curves("Steady friction over slip rate", {rate, quantity("friction_coefficient", "1")}, {curve}, 0, 1));
  auto& marks = figures.back().data["marks"] = ordered_json::array();
  for (const auto& extremum : at(document, "extrema"))
    marks.push_back({{"column", 0}, {"at", number(extremum, "slip_rate")}, {"label", word(extremum, "kind")}});
}

std::vector<double> part_of(const ordered_json& pairs, bool imaginary) {
  std::vector<double> values;
  for (const auto& pair : pairs.is_array() ? pairs : ordered_json::array())
    values.push_back(pair.is_array() && pair.size() == 2 ? number(pair[imaginary ? 1 : 0]) : NAN);
  return values;
}

void add_eigenvalues(const ordered_json& document, std::vector<Figure>& figures) {
  const auto& list = at(document, "eigenvalues");
  auto growth = part_of(list, false), frequency = part_of(list, true);
  if (growth.size() < 2) return;
  auto real = quantity("growth_rate", "1/s"), imaginary = quantity("angular_frequency", "rad/s");
  figures.push_back(curves("Eigenvalues of steady sliding; right of the line motions grow", {real, imaginary},
                           {{"", {growth, frequency}, -1, nullptr, true}}, 0, 1));
  figures.back().data["marks"] = {{{"column", 0}, {"at", 0}, {"label", "growth begins"}}};
}

/// Growth and frequency of each mode along a parameter.
void add_scan(const ordered_json& document, std::vector<Figure>& figures) {
  const auto& path = at(document, "path");
  const auto values = numbers(at(path, "value"));
  const auto& branches = at(path, "eigenvalues");
  if (values.empty() || !branches.is_array()) return;
  std::vector<Curve> list;
  const bool by_value = branches.size() == values.size();  // a list of eigenvalues at each value
  if (!by_value) return;
  Curve all{"", {{}, {}, {}}, -1, nullptr, true};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto growth = part_of(branches[i], false), frequency = part_of(branches[i], true);
    for (std::size_t k = 0; k < growth.size(); ++k) {
      if (frequency[k] < 0) continue;  // of a pair one
      all.columns[0].push_back(values[i]);
      all.columns[1].push_back(growth[k]);
      all.columns[2].push_back(frequency[k]);
    }
  }
  const auto parameter = word(document, "parameter");
  figures.push_back(curves("Growth rates along " + parameter,
                           {quantity(parameter, unit_of_parameter(document)), quantity("growth_rate", "1/s"),
                            quantity("angular_frequency", "rad/s")},
                           {all}, 0, 1));
  auto& marks = figures.back().data["marks"] = ordered_json::array();
  for (const auto& threshold : at(document, "thresholds"))
    marks.push_back({{"column", 0}, {"at", number(threshold, "value")}, {"label", word(threshold, "kind")}});
}

void add_sweep(const ordered_json& document, std::vector<Figure>& figures) {
  const auto values = numbers(at(document, "values"));
  if (values.empty()) return;
  const auto parameter = word(document, "parameter");
  std::vector<ordered_json> columns{quantity(parameter, unit_of_parameter(document))};
  std::vector<Curve> list;
  for (const auto* direction : {"up", "down"}) {
    const auto& recorded = at(document, direction);
    Curve curve{direction == std::string("up") ? "upwards" : "downwards", {values}};
    if (recorded.is_object()) {  // metrics by name
      for (const auto& [name, list] : recorded.items()) {
        auto column = numbers(list);
        if (column.size() != values.size()) continue;
        curve.columns.push_back(std::move(column));
        if (columns.size() < curve.columns.size()) columns.push_back(quantity(name, ""));
      }
    } else if (recorded.is_array() && !recorded.empty()) {  // at each value the moments of one column
      curve.columns = {{}, {}};
      curve.points = true;
      for (std::size_t i = 0; i < std::min(values.size(), recorded.size()); ++i)
        for (const double moment : numbers(recorded[i])) {
          curve.columns[0].push_back(values[i]);
          curve.columns[1].push_back(moment);
        }
      if (columns.size() < 2) columns.push_back(quantity(word(document, "column"), ""));
    }
    if (curve.columns.size() > 1 && curve.columns.size() == columns.size() && !curve.columns[1].empty())
      list.push_back(std::move(curve));
  }
  if (list.empty()) return;
  figures.push_back(curves("Along " + parameter, columns, list, 0, 1));
  auto& marks = figures.back().data["marks"] = ordered_json::array();
  for (const auto& threshold : at(document, "thresholds"))
    marks.push_back({{"column", 0}, {"at", number(threshold, "value")}, {"label", word(threshold, "kind")}});
}

/// Points of a branch in their order, each stretch of one stability a curve of its own; dashed: unstable.
void add_branches(const ordered_json& document, std::vector<Figure>& figures) {
  const auto& points = at(document, "points");
  if (!points.is_array() || word(document, "parameter").empty()) return;
  std::set<std::string> metrics;
  std::vector<std::string> names;
  for (const auto& point : points)
    if (word(point, "kind") == "cycle")
      for (const auto& [name, value] : at(point, "metrics").items())
        if (metrics.insert(name).second && names.size() < 8) names.push_back(name);
  if (names.empty()) names = {"growth_rate", "angular_frequency"};
  const auto parameter = word(document, "parameter");
  std::vector<ordered_json> columns{quantity(parameter, unit_of_parameter(document))};
  for (const auto& name : names) columns.push_back(quantity(name, ""));
  std::vector<Curve> list;
  const bool cycles = names.front() != "growth_rate";
  int before = -2;  // no branch
  std::vector<double> last;
  for (const auto& point : points) {
    const bool steady = word(point, "kind") == "equilibrium";
    if (steady && cycles) continue;
    const bool stable = yes(point, "stable");
    const double given = number(point, "branch");
    const int branch = steady || !(given >= 0 && given < 1000) ? -1 : int(given);
    const auto name = fmt::format("{}{}", steady ? "steady sliding" : fmt::format("cycles {}", branch + 1),
                                  stable ? "" : ", unstable");
    std::vector<double> row{number(point, "value")};
    for (const auto& metric : names) row.push_back(number(at(point, "metrics"), metric));
    if (list.empty() || list.back().name != name || branch != before) {
      Curve part{name, std::vector<std::vector<double>>(columns.size()), branch + 1, stable ? "" : "6 4"};
      if (branch == before && !last.empty())  // joined to the stretch before
        for (std::size_t c = 0; c < columns.size(); ++c) part.columns[c].push_back(last[c]);
      list.push_back(std::move(part));
    }
    for (std::size_t c = 0; c < columns.size(); ++c) list.back().columns[c].push_back(row[c]);
    before = branch, last = row;
  }
  if (list.empty()) return;
  const auto shown = column_named(names, {"slip_rate_max", "slip_rate_1_max", "growth_rate"}, 0) + 1;
  figures.push_back(curves("Branches along " + parameter + "; dashed: unstable", columns, list, 0, shown));
  auto& marks = figures.back().data["marks"] = ordered_json::array();
  for (const auto& event : at(document, "events"))
    if (marks.size() < 40)
      marks.push_back({{"column", 0}, {"at", number(event, "value")}, {"label", word(event, "kind")}});
}

// ---------------------------------------------------------------- responses and comparisons

Curve response(const std::string& name, const std::vector<double>& frequency, const ordered_json& pairs) {
  const auto real = part_of(pairs, false), imaginary = part_of(pairs, true);
  Curve curve{name, {frequency, {}, {}, real, imaginary}};
  for (std::size_t i = 0; i < real.size(); ++i) {
    curve.columns[1].push_back(std::hypot(real[i], imaginary[i]));
    curve.columns[2].push_back(std::atan2(imaginary[i], real[i]) * 180 / std::numbers::pi);
  }
  return curve;
}

void add_response(const ordered_json& document, std::vector<Figure>& figures) {
  const auto frequency = numbers(at(document, "frequency"));
  if (frequency.empty()) return;
  std::vector<Curve> list;
  const auto add = [&](const std::string& name, const ordered_json& pairs) {
    if (pairs.is_array() && pairs.size() == frequency.size()) list.push_back(response(name, frequency, pairs));
  };
  const bool measured = at(document, "predicted").is_array();
  add(measured ? "measured" : "predicted", at(document, "tangential"));
  if (measured) add("predicted", at(document, "predicted"));
  const auto& family = at(document, "family");
  for (const auto& member : at(family, "members"))
    add(fmt::format("{} = {}", word(family, "parameter"), amount(number(member, "value"), word(family, "unit"))),
        at(member, "tangential"));
  if (list.empty()) return;
  std::vector<ordered_json> columns{quantity("frequency", "Hz"), quantity("magnitude", "N s/m"), quantity("phase", "°"),
                                    quantity("real part", "N s/m"), quantity("imaginary part", "N s/m")};
  columns[0]["log"] = columns[1]["log"] = true;
  figures.push_back(curves("Frequency response of friction: magnitude", columns, list, 0, 1));
  figures.back().views.push_back({"Frequency response of friction: phase", 0, 2});
}

void add_comparison(const ordered_json& document, std::vector<Figure>& figures) {
  const auto& members = at(document, "series");
  if (!members.is_object() || members.empty()) return;
  std::vector<std::string> names;
  std::vector<ordered_json> columns;
  std::vector<Curve> list;
  for (const auto& [member, series] : members.items()) {
    if (!series.is_object()) continue;
    Curve curve{member, {}};
    for (const auto& [name, values] : series.items()) {
      curve.columns.push_back(numbers(values));
      if (list.empty()) {
        names.push_back(name);
        columns.push_back(quantity(name, ""));
      }
    }
    if (curve.columns.size() != columns.size() || columns.size() < 2) continue;
    if (all_of_size(curve.columns, curve.columns[0].size())) list.push_back(std::move(curve));
  }
  if (list.empty()) return;
  figures.push_back(curves("The members one over the other", columns, list, 0,
                           column_named(names, {"friction_coefficient", "slip_rate"}, 1)));
}

void add_loop(const Folder& folder, std::vector<Figure>& figures) {
  const auto before = figures.size();
  add_table(folder, "loop.csv", "Nyquist's loop of structure and friction, which must not go round −1", figures,
            {"imaginary"}, {"real"});
  if (figures.size() > before)  // without a structure there is no loop
    figures.back().data["marks"] = {{{"column", figures.back().data["x"]}, {"at", -1}, {"label", "−1"}}};
}

/// Where motions change, in two parameters.
void add_loci(const ordered_json& document, std::vector<Figure>& figures) {
  std::vector<Curve> list;
  std::string second;
  for (const auto& locus : at(document, "loci")) {
    Curve curve{word(locus, "kind"), {{}, {}}};
    second = word(locus, "parameter");
    for (const auto& point : at(locus, "points")) {
      curve.columns[0].push_back(number(point, "value"));
      curve.columns[1].push_back(number(point, "locus_value"));
    }
    if (!curve.columns[0].empty()) list.push_back(std::move(curve));
  }
  if (list.empty()) return;
  const auto first = word(document, "parameter");
  figures.push_back(curves(fmt::format("Where motions change, over {} and {}", first, second),
                           {quantity(first, ""), quantity(second, "")}, list, 0, 1));
}

}  // namespace

std::vector<Figure> figures_of(const Folder& folder, const Result& result) {
  const auto& document = result.document;
  std::vector<Figure> figures;
  add_planes(folder, result, figures);
  add_motion(document, figures);
  add_scan(document, figures);
  add_sweep(document, figures);
  add_branches(document, figures);
  add_loci(document, figures);
  add_response(document, figures);
  add_comparison(document, figures);
  if (result.label == "curve") add_steady_curve(document, figures);
  if (result.label == "stability") add_eigenvalues(document, figures);
  if (result.label == "cycle") add_cycle(folder, figures);
  if (result.label == "lyapunov")
    add_table(folder, "lyapunov.csv", "Mean rates so far, over the time that is averaged", figures);
  if (result.label == "fit") add_fits(folder, result, figures);
  if (result.label == "frf") add_loop(folder, figures);
  return figures;
}

std::string command_of(const Result& result, const std::string& verb, const std::vector<std::string>& varied) {
  const auto& manifest = result.manifest;
  std::string line = "rosin " + verb;
  if (const auto experiment = word(manifest, "experiment"); !experiment.empty() && verb == "lab")
    line += " " + shell_word(experiment);
  line += " " + shell_word(word(manifest, "scene"));
  if (result.label == "design" && verb == "compare") line += " --design";
  if (const auto& overrides = at(manifest, "overrides"); overrides.is_array())
    for (const auto& given : overrides) {
      if (!given.is_string()) continue;
      const auto text = given.get<std::string>();
      const bool of_table =
          verb != result.label && text.starts_with(result.label + ".");  // [map] means nothing to cycle
      if (!of_table && std::ranges::find(varied, text.substr(0, text.find('='))) == varied.end())
        line += " --set " + shell_word(text);
    }
  if (const double asked = number(at(manifest, "tolerance"), "asked"); varied.empty() && asked > 0)
    line += fmt::format(" --tolerance {}", asked);
  return line;
}

}  // namespace rosin::app::report
