/// The linearised equations of an oscillator in its steady sliding.
#include "analysis/branches/linearised.hpp"

namespace rosin::analysis::branches {

Linearised linearise(Oscillator& oscillator) {
  Linearised result;
  result.y = oscillator.steady();
  const System& system = oscillator.system();
  const int n = system.size();
  std::vector<double> f(n);
  Eigen::VectorXd mass(n);
  result.scale.resize(n);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(n, n);
  system.linearise(0, result.y.data(), f.data(), J.data());
  system.mass(0, mass.data());
  system.scale(result.y.data(), result.scale.data());
  result.part = moving_part(J, mass, result.scale);
  return result;
}

}  // namespace rosin::analysis::branches
