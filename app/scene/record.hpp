/// Measured records: columns of a CSV or NetCDF file at even spacing, read in blocks so that memory does not grow.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/scene/in_thread.hpp"
#include "app/scene/table_layout.hpp"

namespace rosin::app::scene {

struct RecordSource {
  std::filesystem::path file;        ///< *.nc: NetCDF, else text
  std::optional<RecordColumn> time;  ///< checked to be even
  double sample_rate = 0;            ///< Hz, where there is no time
  std::vector<RecordColumn> columns;
  TableKeys keys = {};
  /// Rows with missing numbers are handed over, with NaN in place of those, and a row of them where time tells that
  /// rows are missing; else they are refused.
  bool gaps = false;
  int least = 2;  ///< samples
  int width = 0;  ///< columns that a text must have where none are chosen; 0: any number
};

struct RecordEnd {
  double sample_rate = 0;  ///< Hz, the mean
  long samples = 0;
  long gaps = 0;                ///< rows in which a number is missing, one for rows that are not there
  long missing = 0;             ///< rows that are not there
  std::string understood = {};  ///< of the file, in one sentence
};

/// Hands the columns in SI units to `use`, block by block, with the sample rate as the first times tell it.
/// \throws InputError with file and line (or sample) for steps in time, uneven times, numbers that are missing or not
/// finite, and columns that are not there. Nothing is interpolated.
RecordEnd read_record(const RecordSource&,
                      const std::function<void(double sample_rate, std::span<const std::span<const double>>)>& use);

/// While it lives, what is understood of files that are read in this thread is noted, for whoever wants it explained,
/// and what their numbers are, for whoever must know them again.
class FilesRead : public InThread<FilesRead> {
 public:
  static void note(const std::string& understood, std::uint64_t checksum);
  std::vector<std::string> texts;
  std::uint64_t checksum = 0;  ///< of all numbers, in their order; 0: none were read
};

}  // namespace rosin::app::scene
