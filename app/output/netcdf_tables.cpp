/// A table becomes variables over its first column, if that rises, as a time or a frequency does, else over its rows.
#include "app/output/netcdf_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "app/output/netcdf_file.hpp"
#include "app/report/folder.hpp"
#include "app/report/quantities.hpp"
#include "app/scene/scene.hpp"
#include "core/files.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using report::TableColumn;

namespace {

/// A name as NetCDF and the attributes of xarray take it.
std::string variable_name(std::string name) {
  for (char& c : name)
    if (c == ' ' || c == '/') c = '_';
  return name;
}

/// Time stands still in a jump, and is the coordinate all the same.
bool is_coordinate(const TableColumn& column) {
  const auto& values = column.values;
  const bool rises = std::ranges::adjacent_find(values, [](double a, double b) { return !(a < b); }) == values.end();
  return column.texts.empty() && (rises || column.name == "time");
}

/// What the result says that a column means, or what the name says.
std::string meaning_of(const ordered_json& document, const std::string& name) {
  const auto said = report::word(report::at(document, "meaning"), name);
  if (!said.empty()) return said;
  const auto known = report::known(name).meaning;
  return known.empty() || known == report::readable(name) ? report::readable(name)
                                                          : fmt::format("{}: {}", report::readable(name), known);
}

void write(const fs::path& path, const std::vector<TableColumn>& table, const scene::Scene& scene,
           const ordered_json& document) {
  NetcdfFile file;
  file.begin(scene);
  const auto& first = table.front();
  const int along =
      file.dimension(is_coordinate(first) ? variable_name(first.name) : std::string("row"), first.values.size());
  const auto& errors = report::at(document, "error");
  std::set<std::string> taken;
  const auto define = [&](const std::string& name, nc_type type, const std::vector<int>& dimensions,
                          const std::string& unit, const std::string& meaning) {
    const int variable = file.variable(name, type, dimensions);
    if (type == NC_DOUBLE) file.attribute(variable, "units", unit);
    file.attribute(variable, "long_name", meaning);
    return variable;
  };
  for (const auto& column : table) {
    const auto name = variable_name(column.name);
    if (!taken.insert(name).second) continue;
    const auto meaning = meaning_of(document, column.name);
    const bool text = !column.texts.empty();
    const int variable = define(name, text ? NC_STRING : NC_DOUBLE, {along}, column.unit, meaning);
    if (text) {
      file.values(variable, column.texts);
      continue;
    }
    file.values(variable, column.values);
    const double error = report::number(errors, column.name);
    if (std::isfinite(error) && taken.insert(name + "_error").second)
      file.values(define(name + "_error", NC_DOUBLE, {}, column.unit, "absolute error of " + column.name),
                  std::vector{error});
  }
  write_whole(path, file.close());
}

}  // namespace

std::vector<std::string> write_netcdf_tables(const fs::path& folder, const std::vector<std::string>& files,
                                             const scene::Scene& scene, const std::string& text) {
  const auto document = ordered_json::parse(text);
  std::vector<std::string> written;
  for (const auto& name : files) {
    if (fs::path(name).extension() != ".csv") continue;
    const auto beside = fs::path(name).replace_extension(".nc").string();
    if (std::ranges::find(files, beside) != files.end()) continue;
    const auto table = report::read_table(folder / name);
    if (table.empty() || table.front().values.empty()) continue;
    write(folder / beside, table, scene, document);
    written.push_back(beside);
  }
  return written;
}

}  // namespace rosin::app::output
