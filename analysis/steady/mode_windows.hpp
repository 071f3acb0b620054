/// Where each mode of steady sliding grows along a parameter: onset and end of every one, followed by its shape.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "analysis/steady/thresholds.hpp"

namespace rosin::analysis::steady {

/// Values of the parameter, side by side, at which one mode grows.
struct ModeWindow {
  std::optional<Threshold> onset, end;  ///< none: it grows at that end of the scan, or is lost in another that grows
  double at;                            ///< value at which it grows fastest, among those that were looked at
  ComplexMode fastest;                  ///< the mode there
};

struct Scan {
  std::vector<double> values;                                  ///< of the parameter, ascending
  std::vector<std::vector<std::complex<double>>> eigenvalues;  ///< [value]; each a branch from value to value
  std::vector<int> unstable_modes;                             ///< [value]
  std::vector<ModeWindow> windows;                             ///< by their onsets
  /// Ascending: where the first mode begins to grow and the last one ceases to.
  std::vector<Threshold> thresholds;
  std::vector<double> without;  ///< values that have no steady sliding
};

/// Stability at each of the values, ascending, that has steady sliding, and the windows of its modes. Values are added
/// between them until every mode that grows is the continuation of one before, one mode at most begins or ceases to
/// grow from each value to the next, and no parabola through three of them, of a growth rate, its square, or the square
/// of the distance of two neutral frequencies (analytic where two of them merge), passes 0 in between. Where friction
/// locks the structure at one value, stability may change across it.
/// \param most_added  values; a scan that would need more ends with these
/// \throws InputError if no value has steady sliding
Scan scan(const std::function<StructureStability(double)>& stability_at, const std::vector<double>& values,
          int most_added = 2000);

}  // namespace rosin::analysis::steady
