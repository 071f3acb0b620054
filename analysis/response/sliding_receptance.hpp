/// How an oscillator in steady sliding answers a small force along the slip of one of its contacts, friction of all of
/// them included.
#pragma once
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "oscillators/structure_system.hpp"

namespace rosin::analysis::response {

/// A contact of a structure by itself: its law under the speed of its surface and its load in steady sliding.
/// \param contact  from 0
/// \throws InputError for a contact that is not there or has no friction, and without steady sliding
oscillators::Model contact_in_sliding(const oscillators::Structure&, int contact);

struct SlidingReceptance {
  struct Answer {
    std::vector<std::complex<double>> coordinates;  ///< of each, m/N (rad/N of an angle)
    std::vector<double> errors;                     ///< absolute
    std::complex<double> contact;                   ///< displacement along the slip, m/N
    double contact_error;
  };
  std::vector<std::string> coordinates;  ///< their names
  std::function<Answer(std::complex<double> s)> at;
};

/// Of a structure, by the equations of `stability`: M ẏ = J y + b F about steady sliding, so that y(s) = (s M − J)⁻¹ b
/// F. With one contact the answer tᵀx/F is H/(1 + s Z H), H the receptance without friction and Z the contact's
/// response. Errors are what rounding of the equations leaves. \throws InputError as contact_in_sliding
SlidingReceptance sliding_receptance(const oscillators::Structure&, int contact);

}  // namespace rosin::analysis::response
