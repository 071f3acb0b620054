/// Files of a results folder: each appears under its name only when it is whole.
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app {

/// Lets `write` make a file under a temporary name beside `path`, then renames it.
/// \throws std::runtime_error if it cannot be written.
void write_whole(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);
void write_whole(const std::filesystem::path& path, std::string_view content);

/// One column of a table: "slip_rate (m/s)" and its values.
struct Column {
  std::string header;
  std::span<const double> values;
};
/// Header of a column: the name, and the unit unless it has none.
std::string column_header(std::string_view name, std::string_view unit);
/// Comma-separated, with numbers that read back the same.
void write_csv(const std::filesystem::path& path, const std::vector<Column>& columns);

}  // namespace rosin::app
