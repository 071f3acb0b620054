/// Formats of tables.
#include "app/results/writers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "app/command_line.hpp"
#include "app/report/quantities.hpp"
#include "app/verbs/stopping.hpp"

namespace rosin::app::results {

namespace fs = std::filesystem;

#define WRITER(format) Writer format##_writer();
#include "app/results/writers.def"
#undef WRITER

const std::vector<Writer>& writers() {
  static const std::vector<Writer> list = {
#define WRITER(format) format##_writer(),
#include "app/results/writers.def"
#undef WRITER
  };
  return list;
}

std::vector<std::string> write_tables(const fs::path& folder, const Result& result, const Request& request) {
  std::vector<std::string> files;
  for (const auto& table : result.tables) {
    if (std::ranges::any_of(table.dimensions, [](const auto& dimension) { return dimension.length == 0; })) continue;
    for (const auto& writer : writers())
      if (writer.writes(table, writer.option && request.formats.contains(writer.option + 2))) {
        verbs::results_are_due();
        files.push_back(table.name + writer.extension);
        writer.write(folder / files.back(), table, result);
      }
  }
  return files;
}

ordered_json description_of(const Table& table) {
  ordered_json description{{"name", table.name}};
  for (const auto& [name, length] : table.dimensions) description["dimensions"][name] = length;
  auto& variables = description["variables"] = ordered_json::object();
  for (const auto& column : table.columns) {
    auto over = ordered_json::array();
    for (const auto dimension : column.over) over.push_back(table.dimensions[dimension].name);
    auto& variable = variables[column.of.name] = {{"over", std::move(over)}};
    if (std::holds_alternative<std::vector<double>>(column.values)) variable["unit"] = column.of.unit;
    variable["meaning"] = meaning_of(column.of);
    if (column.error.size() == 1) variable["error"] = column.error.front();
    if (const auto* flags = std::get_if<Flags>(&column.values)) variable["words"] = words_of(*flags);
  }
  return description;
}

std::string meaning_of(const Channel& channel) {
  return channel.meaning.empty() ? report::readable(channel.name) : channel.meaning;
}

std::string error_of(const Channel& channel) { return "absolute error of " + report::readable(channel.name); }

std::string description_of(const Channel& channel) {
  return channel.meaning.empty() ? report::known(channel.name).meaning : std::string();
}

std::vector<std::string> words_of(const Flags& flags) {
  std::istringstream text(flags.words);
  return {std::istream_iterator<std::string>(text), {}};
}

}  // namespace rosin::app::results
