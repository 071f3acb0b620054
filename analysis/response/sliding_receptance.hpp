/// How a structure in steady sliding answers a small force along the slip of one of its contacts, friction of all of
/// them included.
///
/// The equations are those of `stability`: M ẏ = J y + b F about steady sliding, so that y(s) = (s M − J)⁻¹ b F. With
/// one contact the answer tᵀx/F is H/(1 + s Z H), H the receptance without friction and Z the contact's response.
#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "oscillators/structure_system.hpp"

namespace rosin::analysis::response {

/// A contact of a structure by itself: its law under the speed of its surface and its load in steady sliding.
/// \param contact  from 0
/// \throws InputError for a contact that is not there or has no friction, and without steady sliding
oscillators::Model contact_in_sliding(const oscillators::Structure&, int contact);

class SlidingReceptance {
 public:
  /// \throws InputError as contact_in_sliding
  SlidingReceptance(const oscillators::Structure&, int contact);

  struct Answer {
    std::vector<std::complex<double>> coordinates;  ///< of each, m/N (rad/N of an angle)
    std::vector<double> errors;                     ///< that rounding of the equations leaves
    std::complex<double> contact;                   ///< tᵀx, m/N
    double contact_error;
  };
  Answer operator()(std::complex<double> s) const;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor J_;
  Eigen::VectorXd mass_, force_, tangential_;
};

}  // namespace rosin::analysis::response
