/// The equations of an oscillator linearised about a state: M δẏ = J δy.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "core/eigenpairs.hpp"
#include "core/system.hpp"

namespace rosin::analysis::steady {

struct Linearised {
  std::vector<double> y;  ///< about which
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J;
  Eigen::VectorXd f, mass, scale;
  /// What moves by its own, each unknown in its scale.
  MovingPart moving() const { return moving_part(J, mass, scale); }
};

/// At time 0, in the present modes of the contacts.
Linearised linearise(const System&, std::vector<double> y);

}  // namespace rosin::analysis::steady
