/// Making models comparable: parameters of one are adjusted until chosen properties agree with those of another.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "oscillators/model.hpp"

namespace rosin::analysis::inference {

using oscillators::Model;

/// A number that an experimenter would read off a law, and that two laws can share.
struct Property {
  std::string name;    ///< see property_names()
  double slip_rate;    ///< V, m/s
  double ratio = 10;   ///< of "fracture-energy": the slip rate steps from V to ratio·V
  double hold = 1000;  ///< of "static-peak": time at rest, s
};

struct PropertyName {
  std::string_view name, unit, meaning;
};
/// "steady-friction" μ_ss(V); "steady-slope" dμ_ss/d ln V; "direct-effect" ∂μ/∂ln v at V with the states held;
/// "fracture-energy" ∫(μ − μ_ss) ds after a step from V to ratio·V, per unit normal load (m); "static-peak" μ when slip
/// resumes at V after a hold, or the static limit of a set-valued law.
std::span<const PropertyName> property_names();

/// The property of a model's law under its drive's normal load. \throws InputError for unknown names (with the
/// nearest), slip rates that are not positive, and laws that have no such property.
double value_of(const Property&, const Model&);

/// Steady friction at slip rates from `low` to `high` (m/s), evenly spaced in their logarithm: a whole curve as
/// properties.
std::vector<Property> steady_curve(double low, double high, int points = 41);

/// What adjusting has led to.
struct Equalised {
  Model model;
  std::vector<double> values;  ///< of the adjusted parameters
  double difference = 0;       ///< largest of the properties, relative to the reference
};
/// Adjusts the parameters at the paths `adjust` until the properties agree with the reference's, by the method of
/// Levenberg and Marquardt; in the sense of least squares if there are more properties than parameters.
/// \throws InputError if there are more parameters than properties, or if as many cannot be made equal.
Equalised equalise(const Model& member, const Model& reference, std::span<const Property>,
                   std::span<const std::string> adjust);

}  // namespace rosin::analysis::inference
