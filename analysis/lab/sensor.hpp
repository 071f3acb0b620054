/// Sensors: what a measuring chain makes of a true record. Low-pass, sampling, noise, resolution and range, by seed.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/parameters.hpp"

namespace rosin::analysis::lab {

/// Columns against time. Between samples the truth is taken as linear.
struct Record {
  std::vector<double> time;  ///< s, ascending
  std::vector<std::string> names, units;
  std::vector<std::vector<double>> columns;  ///< [column][sample]
  std::vector<double> breaks;                ///< times at which the protocol or friction jumps
  std::vector<double> errors;                ///< of each column, absolute: what its integration leaves

  /// \throws InputError if there is no such column.
  const std::vector<double>& column(std::string_view name) const;
  void add(std::string name, std::string unit, std::vector<double> values, double error = 0);
};

/// The measuring chain, in the order in which it acts. What is zero or not named is ideal.
struct Sensor {
  double low_pass = 0;                       ///< corner frequency of a single pole, Hz
  double sample_rate = 0;                    ///< Hz; 0: the record's own samples
  std::map<std::string, double> noise;       ///< rms of white noise by column, in the column's unit
  std::map<std::string, double> resolution;  ///< smallest step of the converter
  std::map<std::string, double> range;       ///< readings are held within ± this
  std::uint64_t seed = 1;

  bool ideal() const;
};

/// The record as measured: same seed, same noise, on every machine. Adds to `warnings` columns that saturate and those
/// of which the samples show too little (aliasing).
/// \throws InputError for columns that the record has not, values out of range, and sample rates of no use.
Record measure(const Record&, const Sensor&, std::vector<std::string>& warnings);

}  // namespace rosin::analysis::lab
