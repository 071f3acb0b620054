/// Jacobian, mass and scales of a system in one state.
#include "analysis/steady/linearised.hpp"

namespace rosin::analysis::steady {

Linearised linearise(const System& system, std::vector<double> y) {
  const int n = system.size();
  Linearised at;
  at.y = std::move(y);
  at.J.resize(n, n), at.f.resize(n), at.mass.resize(n), at.scale.resize(n);
  system.linearise(0, at.y.data(), at.f.data(), at.J.data());
  system.mass(0, at.mass.data());
  system.scale(at.y.data(), at.scale.data());
  return at;
}

}  // namespace rosin::analysis::steady
