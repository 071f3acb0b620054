/// Tables as NetCDF-4 files, which xarray opens with coordinates, units, flags and errors.
#include <set>

#include "app/results/netcdf_file.hpp"
#include "app/results/writers.hpp"
#include "core/files.hpp"

namespace rosin::app::results {

namespace {

void add(const NetcdfFile& file, int variable, const Attributes& attributes) {
  for (const auto& [name, value] : attributes)
    std::visit([&, &name = name](const auto& known) { file.attribute(variable, name.c_str(), known); }, value);
}

void write_dataset(const std::filesystem::path& path, const Table& table, const Result& result) {
  NetcdfFile file;
  file.begin(result.scene);
  add(file, NC_GLOBAL, table.more);
  std::vector<int> dimensions;
  for (const auto& [name, length] : table.dimensions) dimensions.push_back(file.dimension(name, length));
  std::set<std::string> taken;
  for (const auto& column : table.columns) {
    const auto name = variable_name(column.of.name);
    if (!taken.insert(name).second) continue;
    std::vector<int> over;
    for (const auto dimension : column.over) over.push_back(dimensions[dimension]);
    const auto define = [&](const std::string& as, nc_type type, const std::vector<int>& along,
                            const std::string& meaning) {
      const int variable = file.variable(as, type, along);
      if (type == NC_DOUBLE) file.attribute(variable, "units", column.of.unit);
      file.attribute(variable, "long_name", meaning);
      return variable;
    };
    const auto meaning = meaning_of(column.of);
    int variable = 0;
    if (const auto* flags = std::get_if<Flags>(&column.values)) {
      variable = define(name, NC_BYTE, over, meaning);
      if (!flags->numbers.empty()) {
        file.attribute(variable, "flag_values", flags->numbers);
        file.attribute(variable, "flag_meanings", flags->words);
      }
      file.values(variable, flags->values);
    } else if (const auto* words = std::get_if<std::vector<std::string>>(&column.values)) {
      file.values(variable = define(name, NC_STRING, over, meaning), *words);
    } else {
      file.values(variable = define(name, NC_DOUBLE, over, meaning), std::get<std::vector<double>>(column.values));
    }
    if (const auto more = description_of(column.of); !more.empty()) file.attribute(variable, "description", more);
    add(file, variable, column.more);
    if (!column.error.empty() && taken.insert(name + "_error").second)
      file.values(
          define(name + "_error", NC_DOUBLE, column.error.size() > 1 ? over : std::vector<int>(), error_of(column.of)),
          column.error);
  }
  write_whole(path, file.close());
}

}  // namespace

/// Fields always, rows where they are asked for.
Writer netcdf_writer() {
  return {".nc", "--netcdf", "write every table (CSV) as NetCDF, too",
          [](const Table& table, bool asked) { return asked || !is_rows(table); }, write_dataset};
}

}  // namespace rosin::app::results
