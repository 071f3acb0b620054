/// The state of a sounding string as a list of numbers: waves on their way, ends, hair, body and contacts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "oscillators/bowed_string.hpp"

namespace rosin::oscillators {

template <class F>
void StringLanes::each_number(const F& f) {
  constexpr double speed = 1, follows = std::numeric_limits<double>::infinity();
  const auto line = [&](Line& waves, int reach) {
    for (int i = 1; i <= reach; ++i) f(waves.past[std::size_t(n_ - i) & waves.mask], speed);
  };
  const auto whole = [&](Line& waves) { line(waves, waves.taps.reach()); };
  for (auto& waves : waves_) {
    const bool presses = &waves == &waves_.front() && body_.empty();  // on the bridge, which reads its waves earlier
    const int reach = waves.bridge.taps.reach();
    line(waves.bridge, presses ? std::max(reach, to_bridge_.reach()) : reach);
    whole(waves.nut);
    for (auto* lines : {&waves.rightward, &waves.leftward})
      for (auto& between : *lines) whole(between);
    for (auto* end : {&waves.at_bridge, &waves.at_nut}) f(end->first, speed), f(end->second, speed);
  }
  for (auto& passed : dispersion_.state) f(passed, speed);
  if (!body_.empty()) whole(from_bridge_);
  for (auto& mode : body_) {
    const double omega = std::sqrt(mode.stiffness);
    f(mode.displacement, speed / omega), f(mode.velocity, speed), f(mode.acceleration, speed * omega);
  }
  const double k = string_.bow.hair_stiffness;
  if (k != BowedString::none)
    for (std::size_t m = 0; m < bows_.size(); ++m)
      f(hair_stretch_[m], speed * string_.surface_impedance() / k), f(hair_speed_[m], speed);
  for (auto& bow : bows_)
    for (auto* number : bow.memory()) f(*number, follows);
}

std::vector<double> StringLanes::state(int lane) {
  std::vector<double> values;
  each_number([&](const Lanes& number, double) { values.push_back(number[lane]); });
  return values;
}

std::vector<double> StringLanes::state_sizes() {
  std::vector<double> sizes;
  each_number([&](const Lanes&, double size) { sizes.push_back(size); });
  return sizes;
}

void StringLanes::set_state(int lane, std::span<const double> values) {
  auto next = values.begin();
  each_number([&](Lanes& number, double) { number.set(lane, *next++); });
  for (auto& bow : bows_) {
    auto& direction = *bow.memory().front();
    direction.set(lane, std::round(direction[lane]));
  }
}

}  // namespace rosin::oscillators
