/// The times at which a motion passes decades of its natural size.
#include "analysis/motion/growth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rosin::analysis::motion {

Growth::Growth(const oscillators::StructureSystem& system) : passed_{} {
  const std::vector<double> rest(system.size());
  std::vector<double> scale(system.size());
  system.scale(rest.data(), scale.data());
  size_.assign(scale.begin(), scale.begin() + system.coordinates());
}

bool Growth::continues(double step, const std::vector<double>& y) {
  time_ += step;
  double largest = 0;
  for (std::size_t i = 0; i < size_.size(); ++i) largest = std::max(largest, std::abs(y[i]) / size_[i]);
  for (; next_ <= decades && largest >= std::pow(10, next_); ++next_) passed_[std::size_t(next_)] = time_;
  if (next_ <= decades) return false;
  const auto of = [&](std::size_t last) { return passed_[last] - passed_[last - 3]; };
  constexpr double as_long = 2;
  return of(12) > 0 && of(12) <= as_long * of(9) && of(9) <= as_long * of(6);
}

double Growth::rate() const { return std::log(1e6) / (passed_[12] - passed_[6]); }

std::string Growth::described(double t) const {
  return fmt::format("at t = {:.6g} s a coordinate is 10^{} times its natural size, and grows with {:.2g} 1/s", t,
                     decades, rate());
}

}  // namespace rosin::analysis::motion
