/// Writing tables as CSV.
#include "app/output/files.hpp"

#include <fmt/format.h>

#include "app/verbs/stopping.hpp"

namespace rosin::app::output {

namespace fs = std::filesystem;

std::string column_header(std::string_view name, std::string_view unit) {
  return unit == "1" ? std::string(name) : fmt::format("{} ({})", name, unit);
}

void write_csv(const fs::path& path, const std::vector<Column>& columns) {
  verbs::results_are_due();
  fmt::memory_buffer text;
  const auto write_row = [&](auto cell) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? "" : ",", cell(columns[i]));
    text.push_back('\n');
  };
  write_row([](const Column& column) { return column.header; });
  for (std::size_t row = 0; row < columns.front().values.size(); ++row)
    write_row([row](const Column& column) { return column.values[row]; });
  write_whole(path, std::string_view(text.data(), text.size()));
}

}  // namespace rosin::app::output
