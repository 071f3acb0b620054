/// A bowed string with a friction curve or a contact that warms, as a loop written for that one law.
#pragma once
#include <string>

namespace bench {

/// The string of rosin's defaults (oscillators/bowed_string.hpp) at a sample rate, with cubic delays.
struct StringProblem {
  double acceleration, load, sample_rate;
};
struct StringMotion {
  double first_slip = 0;   ///< s
  double fourth_slip = 0;  ///< onset, s
  long samples = 0;
};
/// Two exponentials against the slip rate, by Newton's method from above, with hysteresis.
StringMotion bow_by_hand_curve(const StringProblem&);
/// A temperature of five parts, corrected twice, with friction from a table of it.
StringMotion bow_by_hand_temperature(const StringProblem&);

}  // namespace bench
