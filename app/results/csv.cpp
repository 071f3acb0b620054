/// Tables as text with commas, whose numbers read back the same.
#include <fmt/format.h>

#include <algorithm>

#include "app/output/files.hpp"
#include "app/results/writers.hpp"

namespace rosin::app::results {

namespace {

void write_cell(fmt::memory_buffer& text, const Column& column, std::size_t row) {
  const auto end = std::back_inserter(text);
  if (const auto* numbers = std::get_if<std::vector<double>>(&column.values))
    fmt::format_to(end, "{}", (*numbers)[row]);
  else if (const auto* words = std::get_if<std::vector<std::string>>(&column.values))
    fmt::format_to(end, "{}", (*words)[row]);
  else
    fmt::format_to(end, "{}", std::get<Flags>(column.values).values[row]);
}

void write_rows(const std::filesystem::path& file, const Table& table, const Result&) {
  fmt::memory_buffer text;
  const auto write_row = [&](auto write_column) {
    bool first = true;
    for (const auto& column : table.columns) {
      if (column.over.empty()) continue;
      if (!std::exchange(first, false)) text.push_back(',');
      write_column(column);
    }
    text.push_back('\n');
  };
  write_row([&](const Column& column) {
    fmt::format_to(std::back_inserter(text), "{}", output::column_header(column.of.name, column.of.unit));
  });
  for (std::size_t row = 0; row < table.dimensions.front().length; ++row)
    write_row([&](const Column& column) { write_cell(text, column, row); });
  write_whole(file, std::string_view(text.data(), text.size()));
}

}  // namespace

Writer csv_writer() {
  return {".csv", nullptr, nullptr, [](const Table& table, bool) { return is_rows(table); }, write_rows};
}

}  // namespace rosin::app::results
