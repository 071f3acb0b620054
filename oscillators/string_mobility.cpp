/// How a bowed string answers small forces under the bow: its waves as they are sampled, at a complex frequency.
#include <cmath>

#include "oscillators/bowed_string.hpp"

namespace rosin::oscillators {

using Complex = std::complex<double>;

StringLanes::Mobility StringLanes::mobility(Complex s) const {
  const int contacts = int(bows_.size());
  const double dt = string_.step();
  const Complex z = std::exp(-s * dt);  // a delay of one sample
  const auto through = [&](const Taps& taps) {
    Complex sum = 0;
    for (auto weight = taps.weight.rbegin(); weight != taps.weight.rend(); ++weight) sum = sum * z + *weight;
    return sum * std::pow(z, taps.first);
  };
  const auto smoothed = [&](const Smoother& by) {
    const Complex once = (1 - by.keep) / (1.0 - by.keep * z);
    return once * once;
  };
  Mobility result{Eigen::MatrixXcd::Zero(contacts, contacts), {}};
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    const auto& waves = waves_[k];
    Complex at_bridge = -waves.bridge_gain * through(waves.bridge.taps) * smoothed(waves.at_bridge);
    Complex at_nut = -waves.nut_gain * through(waves.nut.taps) * smoothed(waves.at_nut);
    if (k == 0) {
      for (std::size_t i = 0; i < dispersion_.state.size(); ++i)
        at_nut *= (dispersion_.a + z) / (1.0 + dispersion_.a * z);
      if (!body_.empty()) {
        const Complex sigma = 2 / dt * (1.0 - z) / (1.0 + z);  // d/dt by the trapezoidal rule
        Complex body = 0;
        for (const auto& mode : body_)
          body += sigma / mode.mass / (sigma * sigma + mode.damping * sigma + mode.stiffness);
        const Complex moves = 2.0 * waves.impedance * body / (1.0 + waves.impedance * body);
        at_bridge *= (1.0 - moves) * through(from_bridge_.taps);
      }
    }
    // From each contact to the bridge or to the nut and back, and on between neighbours.
    std::vector<Complex> left(std::size_t(contacts), at_bridge), right(std::size_t(contacts), at_nut), on;
    for (const auto& line : waves.rightward) on.push_back(through(line.taps));
    for (int m = 1; m < contacts; ++m) left[m] = left[m - 1] * on[m - 1] * on[m - 1];
    for (int m = contacts - 2; m >= 0; --m) right[m] = right[m + 1] * on[m] * on[m];
    const Complex round_trip = left[0] * right[0];
    result.round_trips.push_back(round_trip);
    for (int n = 0; n < contacts; ++n) {
      // What a force of 1 N at contact n sends to both sides, and brings back to the others.
      const Complex sent = 0.5 / waves.impedance / (1.0 - round_trip);
      Complex leftward = sent * (1.0 + right[n]), rightward = sent * (1.0 + left[n]);
      result.velocity(n, n) += leftward * (1.0 + left[n]);
      for (int m = n - 1; m >= 0; --m) leftward *= on[m], result.velocity(m, n) += leftward * (1.0 + left[m]);
      for (int m = n + 1; m < contacts; ++m)
        rightward *= on[m - 1], result.velocity(m, n) += rightward * (1.0 + right[m]);
    }
  }
  return result;
}

}  // namespace rosin::oscillators
