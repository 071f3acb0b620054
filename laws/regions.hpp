/// Dry friction made continuous by the force that would hold the contact, the "multi-region" law.
#pragma once
#include <memory>

#include "laws/law.hpp"

namespace rosin::laws {

/// A set-valued law with friction of slip beyond a width of slip rates, F = N·μ(|v| − width) sgn v, and region_friction
/// within it. The law itself is asked for friction of slip alone; who knows the holding force asks the rest.
/// Source: J. Awrejcewicz, D. Grzelczyk & Y. Pyryev, A novel dry friction modeling and its impact on differential
/// equations computation and Lyapunov exponents estimation, J. Vibroeng. 10, 475-482, 2008.
/// \throws InputError for a law that is not set-valued or has states, and for a width outside that of smoothing
std::shared_ptr<const FrictionLaw> by_regions(std::shared_ptr<const FrictionLaw> law, double width);

/// The width (m/s) of such a law; 0 of others.
double region_width(const FrictionLaw&);

/// Friction by regions, and its slopes.
struct RegionFriction {
  double force, by_slip, by_slip_rate, by_holding;  ///< N; 1; N s/m; 1
};
/// F = S + A (F_v − S), with S the holding force up to ±|F_v| and A = w² (3 − 2 |w|), w = v/width up to ±1.
/// \param slip     F_v, friction of slip (N), which does not depend on v within the width
/// \param holding  the force that would hold the contact (N)
RegionFriction region_friction(double v, double width, double slip, double holding);

}  // namespace rosin::laws
