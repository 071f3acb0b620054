/// What stands in a results folder: of each verb its document and its manifest. Include only in .cpp files.
#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::report {

using nlohmann::ordered_json;

/// What one verb left.
struct Result {
  std::string label;  ///< "cycle"; "design" of compare --design
  ordered_json document, manifest;
  std::string checksum;  ///< of the document's file
};

struct Folder {
  std::filesystem::path path;
  std::vector<Result> results = {};  ///< in the order of the help
  /// Names of links and of files that are not what they seem, and why.
  std::map<std::string, std::string> left_out = {};
};

/// \throws InputError where there are no results, where a document is damaged, and where another version wrote it.
Folder read_folder(const std::filesystem::path&);

/// A table of a results folder: "slip_rate (m/s)" and its values, NaN where there is none.
struct TableColumn {
  std::string name, unit;
  std::vector<double> values;
  std::vector<std::string> texts = {};  ///< of a column whose first cell is a word: all its cells
};
/// Empty where the file is missing or is no table of numbers.
std::vector<TableColumn> read_table(const std::filesystem::path&);

// What stands in documents, which somebody may have changed: an entry that is missing or of another kind is none.

/// The entry, or null.
const ordered_json& at(const ordered_json&, std::string_view key);
/// \returns NaN for what is no number.
double number(const ordered_json&);
inline double number(const ordered_json& object, std::string_view key) { return number(at(object, key)); }
/// Empty for what is no text.
std::string word(const ordered_json& object, std::string_view key);
bool yes(const ordered_json& object, std::string_view key);
/// One NaN for each entry that is no number; empty for what is no list.
std::vector<double> numbers(const ordered_json&);

}  // namespace rosin::app::report
