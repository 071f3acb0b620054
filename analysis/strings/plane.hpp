/// Planes of bowed strings: transients and regimes pixel by pixel, which of them a finer sample rate confirms, and the
/// limits between which Helmholtz motion is expected.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "analysis/strings/bowing.hpp"

namespace rosin::analysis::strings {

struct Pixel {
  Bowing bowing;
  /// Largest difference of the transient's length to those at finer sample rates, in periods; NaN without any.
  double length_error;
  bool reproducible;  ///< it stays within the bound; true without finer rates
};

struct PlaneOptions {
  BowingOptions bowing;
  std::vector<int> finer = {2};  ///< factors of the sample rate that pixels are computed at again
  double within = 0.3;           ///< by which the length of a reproducible transient differs at most, in periods
  int threads = 1;
};

/// \param finished  called with a place among the models and the number of the pass, from one thread at a time
std::vector<Pixel> bow_plane(std::span<const BowedStringModel>, const PlaneOptions&,
                             const std::function<void(std::size_t, std::size_t)>& finished = {});

/// Of pixels in rows of `width`; good: with transients shorter than `good` periods.
struct PlaneStatistics {
  int good = 0, shorter_than_most = 0, failed = 0, reproducible = 0, good_and_reproducible = 0;
  int speckles = 0;         ///< good among at least 75 % of neighbours that are not, or the reverse
  double edge_density = 0;  ///< part of neighbouring pairs of which one is good
};
PlaneStatistics statistics_of(std::span<const Pixel>, std::size_t width, double good, double most);

/// Part of the pixels, reproducible in both planes, of which one is good and the other is not, and their number.
struct PlaneDifference {
  int compared = 0, differ = 0;
};
PlaneDifference difference(std::span<const Pixel>, std::span<const Pixel>, double good);

/// Coefficient that holds at rest under a load after long rest; of laws without a limit there, that of slow creep.
double friction_at_rest(const FrictionLaw&, double normal_load);

/// Between the two rays of force over acceleration of the bow, N/a (N s²/m), a string is expected to come to Helmholtz
/// motion within `periods`: below, several slips a period begin at once; above, slip after the first comes late. With
/// friction of rest μ_s and of slip μ_s − Δμ, from Schelleng's maximum at the speed of the bow at the first slip and
/// after that many periods (Guettler 2002, Acustica 88, 970, states the conditions; the rays follow from them).
struct GuettlerRays {
  double lower, upper;
};
GuettlerRays guettler_rays(const oscillators::BowedString&, double at_rest, double difference, double periods);

/// Least and largest force of Helmholtz motion at a speed of the bow (Schelleng 1973, J. Acoust. Soc. Am. 53, 26):
/// 2Z₀v/(β Δμ) and Z₀²v/(2β²R Δμ), with the friction of slip at v/β. The least is 0 if no bridge resistance is given.
struct SchellengLimits {
  double least, most;
};
SchellengLimits schelleng_limits(const BowedStringModel&, double bow_speed);

}  // namespace rosin::analysis::strings
