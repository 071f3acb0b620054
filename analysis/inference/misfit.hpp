/// Misfit, told from noise: what a law leaves over of a series hangs on the motion, noise does not.
#pragma once
#include <optional>
#include <string>

#include "analysis/inference/measurement.hpp"
#include "analysis/inference/noise.hpp"

namespace rosin::analysis::inference {

struct Misfit {
  std::string where;       ///< of the motion, where it is clearest: "after changes of the slip rate", …
  double size = 0;         ///< root mean square, in the unit of the residuals
  double probability = 0;  ///< of as much by chance
};

/// What is told from each other.
struct Told {
  std::optional<Misfit> misfit;
  SeriesNoise noise;  ///< without what hangs on the motion
};

/// Means over stretches of the motion are fitted to residuals beside the slopes of the variables, with the noise, its
/// correlation included, that remains: stretches behind each change of the slip rate, at rest and in motion, doubling
/// in length; classes of slip rate, rising or falling in magnitude; classes of load. An F test tells by how much they
/// explain more than noise. Because noise is what remains beside them, its correlation takes no misfit up. Misfit is
/// what less than a thousandth of records of the right law would leave.
/// \param slip_rate at each x, m/s, that is imposed, or that the fitted motion has
/// \param part residuals of the measurement and their slopes, neither whitened, with the noise as it was found.
Told tell_misfit(const Measurement&, const std::vector<double>& slip_rate, const Leftover& part);

}  // namespace rosin::analysis::inference
