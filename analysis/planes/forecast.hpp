/// How the work for a plane is spread over it, for the time that is left.
#pragma once
#include <vector>

#include "analysis/cycles/coexistence.hpp"
#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/planes/map.hpp"

namespace rosin::analysis::planes {

/// Looks for the cycles at a few points spread over the plane: what they take, their surroundings will take.
class Forecast {
 public:
  /// `tolerance`, `metrics`: of the points that are to be computed.
  Forecast(const Model&, const MapOptions&, double tolerance, const std::vector<std::string>& metrics,
           cycles::CoexistenceSearch&);
  /// Step attempts that a cycle at the point (ix, iy) is expected to take.
  double attempts_at(int ix, int iy) const;
  /// What a point has taken.
  static double attempts_of(const lanes::LaneCycle&);
  static constexpr double judging = 40;  ///< the same for a look at stability alone

 private:
  struct Sample {
    int ix, iy;
    double attempts;
  };
  std::vector<Sample> samples_;
};

}  // namespace rosin::analysis::planes
