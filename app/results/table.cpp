/// Tables and their names.
#include "app/results/table.hpp"

#include <algorithm>
#include <cctype>

namespace rosin::app::results {

namespace {

std::size_t length_of(const Column& column) {
  return std::visit(
      [](const auto& values) {
        if constexpr (requires { values.size(); })
          return values.size();
        else
          return values.values.size();
      },
      column.values);
}

bool counts_rows(const Column& column) {
  const auto* values = std::get_if<std::vector<double>>(&column.values);
  if (!values) return false;
  const bool rises = std::ranges::adjacent_find(*values, [](double a, double b) { return !(a < b); }) == values->end();
  return rises || column.of.name == "time";
}

/// The last part of a path that is a word, and the numbers behind it: "stiffness_2" of "oscillator.stiffness.2".
std::string last_word(const std::string& path) {
  auto begin = path.rfind('.') + 1;
  while (begin > 1 && begin < path.size() && std::isdigit(static_cast<unsigned char>(path[begin])))
    begin = path.rfind('.', begin - 2) + 1;
  return path.substr(begin);
}

}  // namespace

Table rows(std::string name, std::vector<Column> columns) {
  Table table{.name = std::move(name), .dimensions = {{"row", 0}}, .columns = std::move(columns)};
  if (table.columns.empty()) return table;
  const auto& first = table.columns.front();
  table.dimensions.front() = {counts_rows(first) ? variable_name(first.of.name) : "row", length_of(first)};
  return table;
}

std::string variable_name(std::string name) {
  for (char& c : name)
    if (c == ' ' || c == '/') c = '_';
  return name;
}

std::vector<std::string> axis_names(const std::vector<std::string>& paths, const std::vector<std::string>& taken) {
  std::vector<std::string> names;
  for (const auto& path : paths) names.push_back(last_word(path));
  auto all = taken;
  all.insert(all.end(), names.begin(), names.end());
  if (std::ranges::any_of(names, [&](const auto& name) { return std::ranges::count(all, name) > 1; })) names = paths;
  for (auto& name : names) std::ranges::replace(name, '.', '_');
  return names;
}

}  // namespace rosin::app::results
