/// Rates of turning, which differ from frequencies by 2 pi.
#pragma once
#include <string_view>

#include "core/error.hpp"

namespace rosin {

/// One of two units counts an angle and the other does not, as to_si finds: 10 1/s may be 10 rad/s or 10 turns in a
/// second.
struct UnclearAngle : InputError {
  using InputError::InputError;
};

/// The number in `text`, of something that rotates, in rad/s: a bare 1/min counts turns. \throws InputError as to_si
double turning_to_si(std::string_view text);

}  // namespace rosin
