/// Writing to a temporary name and renaming, and tables as CSV.
#include "app/files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace rosin::app {

namespace fs = std::filesystem;

void write_whole(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path temporary = path.parent_path() / fmt::format(".{}.{}", path.filename().string(), getpid());
  try {
    write(temporary);
    fs::rename(temporary, path);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_whole(const fs::path& path, std::string_view content) {
  write_whole(path, [&](const fs::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.close();
    if (!file) throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
  });
}

std::string column_header(std::string_view name, std::string_view unit) {
  return unit == "1" ? std::string(name) : fmt::format("{} ({})", name, unit);
}

void write_csv(const fs::path& path, const std::vector<Column>& columns) {
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

}  // namespace rosin::app
