/// Where a motion starts: in steady sliding, at rest, or at given values.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "oscillators/slider_system.hpp"

namespace rosin::analysis::motion {

using oscillators::Model;

/// A start by its kind, with values in natural units.
struct Start {
  enum class Kind { steady, rest, given } kind = Kind::steady;
  std::optional<double> displacement, velocity, slip_rate;  ///< given: velocity or slip_rate, not both
  std::map<std::string, double> states;                     ///< given: by name; missing ones are steady
};

/// Writes given natural states over those of `state`. \throws InputError for unknown states and values out of range.
void take_states(const FrictionLaw&, const std::map<std::string, double>& given, std::vector<double>& state);

/// The start as unknowns of the system. "rest": the slider moves with the drive, the spring is unstretched, and states
/// have the law's values for long rest, by default those of steady creep at 1e-12 m/s. Missing values come from steady
/// sliding, or from rest for a contact that may stick and starts without slip.
/// \throws InputError for unknown states, values out of range or that contradict each other, and "steady" without a
/// drive.
std::vector<double> starting_point(const oscillators::SliderSystem&, const Start&);

}  // namespace rosin::analysis::motion
