/// Tables of a results folder.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/files.hpp"

namespace rosin::app::output {

/// One column of a table: "slip_rate (m/s)" and its values.
struct Column {
  std::string header;
  std::span<const double> values;
};
/// Header of a column: the name, and the unit unless it has none.
std::string column_header(std::string_view name, std::string_view unit);
/// Comma-separated, with numbers that read back the same.
void write_csv(const std::filesystem::path& path, const std::vector<Column>& columns);

}  // namespace rosin::app::output
