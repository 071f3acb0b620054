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
constexpr int schema = 1;

struct Writer {
  const char* extension;  ///< of its files, ".csv"
  bool (*writes)(const Table&, const Request&);
  void (*write)(const std::filesystem::path& file, const Table&, const Result&);
};
/// Those in writers.def.
const std::vector<Writer>& writers();

/// Writes each table that has values in every format that is asked for. \returns the names of the files
std::vector<std::string> write_tables(const std::filesystem::path& folder, const Result&, const Request&);

/// Names, dimensions, units, meanings and errors of a table: all but its values.
ordered_json description_of(const Table&);

/// What a column means in one line, for a file that has room for it.
std::string meaning_of(const Channel&);

/// Words of flags, apart.
std::vector<std::string> words_of(const Flags&);

}  // namespace rosin::app::results
