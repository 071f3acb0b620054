/// Numbers with the digits that their errors leave.
#pragma once
#include <string>

namespace rosin::app::output {

/// "22.58705580" at an error of 3e-8, "0" where the error hides every digit, ten digits where no error is known.
std::string digits_by_error(double value, double error);

/// "19.1000 ± 0.0007", as pictures have it; four digits where no error is known.
std::string with_error(double value, double error);

}  // namespace rosin::app::output
