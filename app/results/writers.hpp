/// Formats in which tables of a result are written.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/results/result.hpp"

namespace rosin::app {
struct Request;
}

namespace rosin::app::results {

/// Of documents: what stands in one under which name. It grows where a name goes or means something else.
constexpr const char* schema = "rosin-results-1";

struct Writer {
  const char *extension, *option, *help;  ///< ".csv"; the option that asks for it, null: none does
  bool (*writes)(const Table&, bool asked);
  void (*write)(const std::filesystem::path& file, const Table&, const Result&);
};
/// Those in writers.def.
const std::vector<Writer>& writers();

/// Writes each table that has values in every format that is asked for. \returns the names of the files
std::vector<std::string> write_tables(const std::filesystem::path& folder, const Result&, const Request&);

/// Names, dimensions, units, meanings and errors of a table: all but its values.
ordered_json description_of(const Table&);

/// A table in the common sense.
inline bool is_rows(const Table& table) { return table.dimensions.size() == 1 && !table.is_field; }

/// What a column is called on an axis: its meaning, or its name in words.
std::string meaning_of(const Channel&);
/// "absolute error of slip rate"
std::string error_of(const Channel&);
/// What else is known of numbers of that name; empty where nothing is.
std::string description_of(const Channel&);

/// Words of flags, apart.
std::vector<std::string> words_of(const Flags&);

}  // namespace rosin::app::results
