/// Accelerations by the smoother of displacements, one derivative higher.
#include "analysis/inference/recorded_slip_rate.hpp"

#include <utility>

namespace rosin::analysis::inference {

Measurement::History recorded_slip_rate(std::vector<double> time, std::vector<double> slip_rate,
                                        std::vector<double> normal_load) {
  const auto smooth = recorded_motion(time, slip_rate);
  Measurement::History history;
  auto& motion = history.recorded;
  motion.before = motion.after = slip_rate;
  motion.displacement = {0};
  for (std::size_t i = 0; i + 1 < time.size(); ++i) {
    const double span = time[i + 1] - time[i];
    const double mean = (slip_rate[i] + slip_rate[i + 1]) / 2 + span / 12 * (smooth.after[i] - smooth.before[i + 1]);
    motion.displacement.push_back(motion.displacement.back() + span * mean);
  }
  history.slip_rate_noise = smooth.noise;
  history.time = std::move(time), history.slip_rate = std::move(slip_rate);
  history.normal_load = std::move(normal_load);
  return history;
}

}  // namespace rosin::analysis::inference
