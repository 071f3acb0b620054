/// Numbers with units as text, converted to SI once, at the edge.
#pragma once
#include <string_view>

namespace rosin {

/// The number in `text` expressed in `si_unit`: "0.01 mm/s" in "m/s" is 1e-5; a plain "3" is taken as SI.
/// \throws InputError if the text is not a number with an optional unit, or the unit has another dimension.
double to_si(std::string_view text, std::string_view si_unit);

/// True if the text is a unit ("N s/m", "1/um", "1").
bool unit_known(std::string_view unit);

}  // namespace rosin
