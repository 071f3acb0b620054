/// Wrong input is an InputError; a computation that ends short of its goal is an Outcome, which is a result.
#pragma once
#include <stdexcept>
#include <string>

#include "core/parameters.hpp"

namespace rosin {

/// The user's input cannot be used. `what()` names the quantity, the value, the accepted range and what to try.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How a computation ended.
enum class Ending {
  reached_end,        ///< everything asked was computed
  event,              ///< a stopping event was reached
  none_exists,        ///< what was asked for does not exist (no periodic motion, no Hopf point)
  tolerance_not_met,  ///< steps became too small for the tolerance
  budget_spent,       ///< the allowed number of steps or cycles was used up
  not_finite,         ///< a value overflowed or became NaN
  unbounded,          ///< the motion grows without bound
  interrupted,        ///< the user asked to stop
};

/// Name of an ending as it stands in results ("reached the end", …).
std::string name(Ending);

/// How a computation ended and, unless it reached the end, where and why.
struct Outcome {
  Ending ending = Ending::reached_end;
  std::string detail;  ///< "at t = 3.2 s the step fell below 1e-15 s in 'friction'"
  bool complete() const { return ending == Ending::reached_end || ending == Ending::event; }
};

/// "0.0001 … 0.5", with the magnitudes that are accepted where not all are.
std::string text(const Range&);

/// Throws InputError unless `range` contains `value`: "law.a = 3 is outside 0.0001 … 0.5 (direct effect,
/// dimensionless)".
void require(double value, const Range& range, std::string_view path, std::string_view meaning, std::string_view unit);

/// The unit as it is read in a sentence: "dimensionless" for "1".
std::string readable_unit(std::string_view unit);

}  // namespace rosin
