/// Declared figures with the numbers that their lines show.
#include "app/report/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "app/output/document.hpp"
#include "app/report/plane.hpp"
#include "app/report/quantities.hpp"
#include "app/results/figure.hpp"
#include "core/error.hpp"
#include "core/process.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::report {

namespace fs = std::filesystem;

namespace {

/// Numbers in one figure: what a page of a megabyte has room for.
constexpr double most_numbers = 60'000;
constexpr std::uintmax_t largest_declaration = 10'000'000;  // bytes

/// Samples that are shown where there is no room for all: of each stretch the least and the largest value, and a gap.
std::vector<std::size_t> thinned(const std::vector<double>& values, std::size_t most) {
  std::vector<std::size_t> kept;
  const auto count = values.size(), stretches = std::max<std::size_t>(most / 3, 1);
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto from = s * count / stretches, end = (s + 1) * count / stretches;
    std::optional<std::size_t> least, largest, gap;
    for (auto i = from; i < end; ++i) {
      if (std::isnan(values[i])) gap = i;
      if (!least || values[i] < values[*least] || std::isnan(values[*least])) least = i;
      if (!largest || values[i] > values[*largest] || std::isnan(values[*largest])) largest = i;
    }
    std::set<std::size_t> shown;
    for (const auto& one : {least, largest, gap})
      if (one) shown.insert(*one);
    if (s == 0 && count > 0) shown.insert(0);
    if (s + 1 == stretches && count > 0) shown.insert(count - 1);
    kept.insert(kept.end(), shown.begin(), shown.end());
  }
  return kept;
}

/// The same of points that lie beside each other.
std::vector<std::size_t> every_so_many(std::size_t count, std::size_t most) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0, step = 1 + (count - 1) / most; i < count; i += step) kept.push_back(i);
  return kept;
}

/// Tables of a figure, each read once.
class Tables {
 public:
  explicit Tables(const Folder& folder) : folder_(folder) {}
  const std::vector<TableColumn>& operator[](const std::string& file) {
    const auto [entry, is_new] = read_.try_emplace(file);
    if (is_new && fs::path(file).filename() == file && !folder_.left_out.contains(file))
      entry->second = read_table(folder_.path / file);
    return entry->second;
  }

 private:
  const Folder& folder_;
  std::map<std::string, std::vector<TableColumn>> read_;
};

/// The rows that a line holds itself, as columns.
std::vector<TableColumn> columns_of(const ordered_json& rows) {
  std::vector<TableColumn> columns;
  for (const auto& row : rows) {
    const auto values = numbers(row);
    columns.resize(std::max(columns.size(), values.size()));
    for (std::size_t c = 0; c < values.size(); ++c) columns[c].values.push_back(values[c]);
  }
  return columns;
}

const TableColumn* column_at(const std::vector<TableColumn>& table, double number) {
  return number >= 1 && number <= double(table.size()) ? &table[std::size_t(number) - 1] : nullptr;
}

/// A number of each row, NaN where it gives none.
std::vector<double> values_of(const ordered_json& cell, const std::vector<TableColumn>& table) {
  const auto rows = table.empty() ? 0 : table.front().values.size();
  const auto or_else = [](double value, double otherwise) { return std::isnan(value) ? otherwise : value; };
  const auto* column = column_at(table, number(cell, "column"));
  auto values = column ? column->values : std::vector<double>(rows);
  const auto* over = column_at(table, number(cell, "over"));
  const double factor = or_else(number(cell, "factor"), 1), plus = or_else(number(cell, "plus"), 0),
               least = number(cell, "least");
  for (std::size_t row = 0; row < values.size(); ++row) {
    auto& value = values[row];
    if (over) value /= over->values[row];
    if (yes(cell, "absolute")) value = std::abs(value);
    value = value * factor + plus;
    if (value < least) value = least;
  }
  return values;
}

bool holds(const ordered_json& conditions, const std::vector<TableColumn>& table, std::size_t row) {
  return std::ranges::all_of(conditions, [&](const ordered_json& one) {
    const auto* column = column_at(table, number(one, "column"));
    if (!column) return false;
    if (const auto& wanted = at(one, "value"); wanted.is_string())
      return row < column->texts.size() && column->texts[row] == word(one, "value");
    const double value = column->values[row], wanted = number(one, "value");
    const auto compare = word(one, "compare");
    return compare == "<" ? value < wanted : compare == ">" ? value > wanted : value == wanted;
  });
}

/// The absolute error of a column, as the document states it for all its values; NaN where it states none.
double error_of(const ordered_json& document, const std::string& file, const ordered_json& cell) {
  if (cell.size() != 1) return NAN;  // not the column as it is
  for (const auto& table : at(document, "datasets")) {
    const auto& variables = at(table, "variables");
    const auto place = number(cell, "column") - 1;
    if (!variables.is_object()) continue;
    if (word(table, "name") + ".csv" != file || !(place >= 0 && place < double(variables.size()))) continue;
    return number(std::next(variables.begin(), std::ptrdiff_t(place)).value(), "error");
  }
  return NAN;
}

/// A colour of the page in place of one of the lines' own, which would be dark on a dark page.
void add_look(ordered_json& series, const ordered_json& look) {
  const auto colour = word(look, "colour");
  for (int style = 0; style < results::reference_style; ++style)
    if (results::line_styles[style].colour == colour) series["like"] = style;
  std::string dash = word(look, "dash");
  std::ranges::replace(dash, ',', ' ');
  series["dash"] = dash;
}

ordered_json axis_of(const ordered_json& axis) {
  auto name = word(axis, "name");
  if (const auto detail = word(axis, "detail"); !detail.empty()) name += ", " + detail;
  ordered_json drawn{{"name", name}, {"unit", word(axis, "unit")}, {"log", yes(axis, "decades")}};
  if (const auto symbol = word(axis, "symbol"); !symbol.empty())
    (name.empty() ? drawn["name"] : drawn["symbol"]) = symbol;
  for (const auto* key : {"from", "to", "ticks", "zero"})
    if (const auto& value = at(axis, key); !value.is_null()) drawn[key] = value;
  return drawn;
}

/// What the page draws by itself: lines and points in a plane.
bool is_drawable(const ordered_json& panel) {
  static const std::set<std::string> known = {"line",   "points", "line and points", "steps", "bars",
                                              "filled", "band",   "upright"};
  return at(panel, "z").is_null() && std::ranges::all_of(at(panel, "lines"), [](const ordered_json& line) {
           return known.contains(word(line, "how"));
         });
}

/// The part of their samples that all lines of a figure have room for.
double shown_part(const ordered_json& declared, Tables& tables) {
  double samples = 1;
  for (const auto& panel : at(declared, "panels"))
    for (const auto& line : at(panel, "lines"))
      if (const auto& table = tables[word(line, "table")]; is_drawable(panel) && !table.empty())
        samples += double(table.front().values.size());
  return most_numbers / (2 * samples);
}

/// Each panel is a figure of the page.
Figure panel_of(const Result& result, const ordered_json& declared, const ordered_json& panel, double part,
                Tables& tables) {
  const auto& lines = at(panel, "lines");
  auto x = axis_of(at(panel, "x")), y = axis_of(at(panel, "y"));
  auto series = ordered_json::array();
  bool all = true;
  for (const auto& line : lines) {
    const auto file = word(line, "table");
    const auto own = file.empty() ? columns_of(at(line, "rows")) : std::vector<TableColumn>();
    const auto& table = file.empty() ? own : tables[file];
    if (table.empty()) continue;
    const auto how = word(line, "how");
    auto along = values_of(at(line, "x"), table), up = values_of(at(line, how == "band" ? "low" : "y"), table);
    const auto upper = how == "band" ? values_of(at(line, "high"), table) : std::vector<double>();
    for (std::size_t row = 0; row < up.size(); ++row)
      if (!holds(at(line, "where"), table, row)) up[row] = NAN;
    const auto room = std::size_t(std::max(50.0, std::min(part, 1.0) * double(up.size())));
    const auto kept = how == "points" || up.size() <= room ? every_so_many(up.size(), room) : thinned(up, room);
    all = all && kept.size() == up.size();
    const auto list = [&](const std::vector<double>& values) {
      auto shown = ordered_json::array();
      for (const auto row : kept) shown.push_back(rounded(values[row], 9));
      return shown;
    };
    ordered_json one{{"name", word(line, "title")}, {"how", how}, {"x", list(along)}, {"y", list(up)}};
    if (!upper.empty()) one["upper"] = list(upper);
    add_look(one, at(line, "look"));
    for (const auto& [axis, key] : {std::pair{&x, "x"}, {&y, "y"}})
      if (const double error = error_of(result.document, file, at(line, key)); error > 0)
        (*axis)["error"] = rounded(error, 2);
    series.push_back(std::move(one));
  }
  Figure figure;
  const auto heading = word(panel, "title"), up = word(y, "name");
  figure.caption = word(declared, "what");
  if (!heading.empty())
    figure.caption += ": " + heading;
  else if (!up.empty())
    figure.caption += fmt::format(": {} over {}", up, word(x, "name"));
  figure.caption += '.';
  if (!all) figure.caption += " A part of the samples is shown, with their extremes; all stand in the results folder.";
  figure.data = {{"kind", "curves"}, {"title", figure.caption}, {"x", x}, {"y", y}, {"series", std::move(series)}};
  for (const auto* key : {"shades", "rules", "marks", "notes"})
    if (const auto& list = at(panel, key); list.is_array()) {
      figure.data[key] = list;
      for (auto& entry : figure.data[key])
        if (const auto& look = at(entry, "look"); look.is_object()) add_look(entry, ordered_json(look));
    }
  return figure;
}

/// The figures of a result, as its manifest lists them.
void add_declared(const Folder& folder, const Result& result, std::vector<Figure>& figures) {
  const bool has_plane = !figures.empty();
  Tables tables(folder);
  for (const auto& file : at(result.manifest, "files")) {
    constexpr std::string_view ending = ".figure.json";
    const auto name = file.is_string() ? file.get<std::string>() : "";
    std::error_code problem;
    if (!name.ends_with(ending) || fs::path(name).has_parent_path() || folder.left_out.contains(name) ||
        !fs::is_regular_file(folder.path / name, problem))
      continue;
    const auto declared =
        output::parse_document((folder.path / name).string(), read_found(folder.path / name, largest_declaration));
    const auto before = figures.size();
    const double part = shown_part(declared, tables);
    for (const auto& panel : at(declared, "panels")) {
      if (!is_drawable(panel)) continue;
      auto figure = panel_of(result, declared, panel, part, tables);
      if (!figure.data["series"].empty() || figure.data.contains("rules")) figures.push_back(std::move(figure));
    }
    const bool is_missing = figures.size() == before && !has_plane;  // whose numbers stand on the page's own plane
    if (is_missing)
      figures.push_back({word(declared, "what") + ".", {}, name.substr(0, name.size() - ending.size()) + ".png"});
  }
}

}  // namespace

std::vector<Figure> figures_of(const Folder& folder, const Result& result) {
  std::vector<Figure> figures;
  add_planes(folder, result, figures);
  add_declared(folder, result, figures);
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
