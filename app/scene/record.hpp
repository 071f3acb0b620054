/// Measured records: columns of a CSV or NetCDF file at even spacing, read in blocks so that memory does not grow.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rosin::app::scene {

/// One column: its name in the file, the unit of the file's numbers (empty: as the file says, else SI), and the SI unit
/// that is wanted.
struct RecordColumn {
  std::string name, unit, si;
};

struct RecordSource {
  std::filesystem::path file;        ///< *.nc: NetCDF, else text with a header line
  std::optional<RecordColumn> time;  ///< checked to be even
  double sample_rate = 0;            ///< Hz, where there is no time
  std::vector<RecordColumn> columns;
};

struct RecordEnd {
  double sample_rate = 0;  ///< Hz, the mean
  long samples = 0;
};

/// Hands the columns in SI units to `use`, block by block, with the sample rate as the first times tell it.
/// \throws InputError with file and line (or sample) for gaps, uneven times, numbers that are missing or not finite,
/// and columns that are not there. Nothing is interpolated.
RecordEnd read_record(const RecordSource&,
                      const std::function<void(double sample_rate, std::span<const std::span<const double>>)>& use);

}  // namespace rosin::app::scene
