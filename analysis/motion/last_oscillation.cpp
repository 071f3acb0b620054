/// Frames between passages.
#include "analysis/motion/last_oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rosin::analysis::motion {

namespace {
constexpr std::size_t most_frames = 256;

/// Every second one.
template <class List>
void thin_out(List& list) {
  for (std::size_t i = 0; 2 * i < list.size(); ++i)
    if (i > 0) list[i] = std::move(list[2 * i]);
  list.resize((list.size() + 1) / 2);
}
}  // namespace

Frames Frames::evenly(int count) const {
  Frames even;
  for (int k = 0; k < count; ++k) {
    const double t = time.front() + duration() * k / (count - 1);
    const auto after = std::ranges::lower_bound(time, t);
    const auto j = std::clamp<std::size_t>(std::size_t(after - time.begin()), 1, size() - 1), i = j - 1;
    const double part = std::clamp((t - time[i]) / (time[j] - time[i]), 0.0, 1.0);
    even.time.push_back(t);
    even.coordinates.emplace_back((1 - part) * coordinates[i] + part * coordinates[j]);
    even.touch.push_back(touch[part < 0.5 ? i : j]);
    even.friction.push_back(std::lerp(friction[i], friction[j], part));
    even.load.push_back(std::lerp(load[i], load[j], part));
  }
  return even;
}

void LastOscillation::add(double place, double time, const Eigen::VectorXd& coordinates,
                          const std::vector<Touch>& touch, double friction, double load) {
  const bool passes = started_ && before_ < 0 && place >= 0;
  started_ = true, before_ = place;
  if (passes) {
    if (begun_) {
      keep(time, coordinates, touch, friction, load);
      whole_ = std::exchange(present_, {});
    }
    begun_ = true, steps_ = 0, stride_ = 1;
  }
  if (!begun_ || steps_++ % stride_ != 0) return;
  keep(time, coordinates, touch, friction, load);
  if (present_.size() < most_frames) return;
  thin_out(present_.time), thin_out(present_.coordinates), thin_out(present_.touch);
  thin_out(present_.friction), thin_out(present_.load);
  stride_ *= 2;
}

void LastOscillation::keep(double time, const Eigen::VectorXd& coordinates, const std::vector<Touch>& touch,
                           double friction, double load) {
  present_.time.push_back(time), present_.coordinates.push_back(coordinates), present_.touch.push_back(touch);
  present_.friction.push_back(friction), present_.load.push_back(load);
}

}  // namespace rosin::analysis::motion
