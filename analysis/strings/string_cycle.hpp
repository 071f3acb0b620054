/// Periodic motion of a bowed string: what it has come to under a bow of constant speed and load.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "analysis/strings/bowing.hpp"

namespace rosin::analysis::strings {

using oscillators::Gesture;

/// Numbers of one period.
struct StringPeriod {
  struct Measure {
    double value = NAN,
           error = NAN;  ///< absolute: scatter of the last periods, and twice the difference to a finer string
  };
  Measure period;  ///< s
  Measure slips;   ///< in it: 1 in Helmholtz motion
  Measure stick_fraction;
  Measure slip_distance;  ///< of bow and string past each other, in slips that count, m
  Measure bridge_force;   ///< peak to peak, N
};
struct StringPeriodName {
  const char *name, *unit, *meaning;
  StringPeriod::Measure StringPeriod::*member;
};
const std::array<StringPeriodName, 5>& string_period_names();

struct StringCycle {
  Outcome outcome;  ///< none_exists: no motion that repeats itself
  StringRegime regime;
  StringPeriod period;  ///< where there is one
  long samples = 0;     ///< of both strings
};

/// Two bowings of one string, the second at a higher sample rate. A motion is periodic if its regime has one slip or
/// two in a period, and the last periods differ by less than 1 %.
StringCycle cycle_of(const BowedStringModel&, const Bowing&, const Bowing& finer, const TransientOptions&);

/// The motions that strings have come to after some periods of the open string, each at its sample rate and at twice
/// that. \throws InputError where a bow changes its speed or load.
std::vector<StringCycle> string_cycles(std::span<const BowedStringModel>, double periods, const TransientOptions&,
                                       int threads);
/// The same along values of the bow's load or speed, each going on from the motion at the value before: a force or
/// speed that moves evenly to its next value in the first half of these periods, and stays there in the second. \param
/// values  in their order, for each way on which the string goes; as many of each
std::vector<std::vector<StringCycle>> string_cycles_along(const BowedStringModel&, Gesture BowedStringModel::*moved,
                                                          std::span<const std::vector<double>> values, double periods,
                                                          const TransientOptions&);
/// \throws InputError where a bow changes its speed or load, or does not move
void require_steady_bow(const BowedStringModel&);
/// How a string is bowed for that.
BowingOptions until_periodic(const BowedStringModel&, double periods, const TransientOptions&);

}  // namespace rosin::analysis::strings
