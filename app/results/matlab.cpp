/// Tables as MAT-files (level 5), which MATLAB, Octave and SciPy read.
#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cctype>
#include <memory>

#include "app/results/writers.hpp"
#include "app/scene/scene.hpp"
#include "core/files.hpp"

namespace rosin::app::results {

namespace {

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

/// "law.L" as law_L: a letter first, then letters, digits and underscores.
std::string matlab_name(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return std::isalpha(static_cast<unsigned char>(name.front())) ? name : "x" + name;
}

Variable made(matvar_t* variable) {
  if (!variable) throw std::runtime_error("matio cannot make a variable");
  return {variable, &Mat_VarFree};
}

/// In UTF-8.
Variable word(const char* name, std::string text) {
  std::size_t size[] = {1, text.size()};
  return made(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, size, text.data(), 0));
}

/// Values in their order: the last dimension of the table becomes MATLAB's first.
Variable numbers(const std::string& name, std::vector<double> values, std::vector<std::size_t> size) {
  std::ranges::reverse(size);
  size.resize(std::max<std::size_t>(size.size(), 2), 1);
  return made(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, int(size.size()), size.data(), values.data(), 0));
}

Variable words(const std::string& name, const std::vector<std::string>& values, std::vector<std::size_t> size) {
  std::ranges::reverse(size);
  size.resize(std::max<std::size_t>(size.size(), 2), 1);
  std::vector<matvar_t*> cells;
  for (const auto& value : values) cells.push_back(word(nullptr, value).release());
  return made(Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, int(size.size()), size.data(), cells.data(), 0));
}

void write_mat(const std::filesystem::path& path, const Table& table, const Result& result) {
  write_whole(path, [&](const std::filesystem::path& temporary) {
    const auto header = fmt::format("MATLAB 5.0 MAT-file, rosin {}", ROSIN_VERSION);  // no date: same result, same file
    const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(
        Mat_CreateVer(temporary.c_str(), header.c_str(), MAT_FT_MAT5), &Mat_Close);
    if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
    const auto put = [&](const Variable& variable) {
      if (Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) != 0)
        throw std::runtime_error(fmt::format("{}: cannot be written; is the disk full?", path.string()));
    };
    std::vector<std::string> names;
    std::vector<std::string> units;
    for (const auto& column : table.columns) {
      const auto name = matlab_name(column.of.name);
      if (std::ranges::find(names, name) != names.end()) continue;
      names.push_back(name), units.push_back(column.of.unit);
      std::vector<std::size_t> size;
      for (const auto dimension : column.over) size.push_back(table.dimensions[dimension].length);
      if (const auto* texts = std::get_if<std::vector<std::string>>(&column.values)) {
        put(words(name, *texts, size));
      } else if (const auto* flags = std::get_if<Flags>(&column.values)) {
        put(numbers(name, {flags->values.begin(), flags->values.end()}, size));
      } else {
        put(numbers(name, column.numbers(), size));
        if (column.error.empty()) continue;
        names.push_back(name + "_error"), units.push_back(column.of.unit);
        put(numbers(names.back(), column.error, column.error.size() > 1 ? size : std::vector<std::size_t>()));
      }
    }
    std::vector<const char*> fields;
    for (const auto& name : names) fields.push_back(name.c_str());
    std::size_t one[] = {1, 1};
    const auto of_names = made(Mat_VarCreateStruct("units", 2, one, fields.data(), unsigned(fields.size())));
    for (std::size_t i = 0; i < names.size(); ++i)
      Mat_VarSetStructFieldByName(of_names.get(), fields[i], 0, word(fields[i], units[i]).release());
    put(of_names);
    put(word("title", result.scene.title));
    put(word("scene", result.scene.resolved));
  });
}

}  // namespace

Writer matlab_writer() {
  return {".mat", "--matlab", "write every table as a MAT-file, for MATLAB, Octave and SciPy",
          [](const Table&, bool asked) { return asked; }, write_mat};
}

}  // namespace rosin::app::results
