/// Normal numbers from a counter, by Box & Muller (Ann. Math. Stat. 29, 610-611, 1958).
#include "core/random.hpp"

#include <cmath>
#include <numbers>

namespace rosin {

std::vector<double> white_noise(std::size_t count, std::uint64_t seed) {
  const auto mix = [](std::uint64_t x) { return splitmix(x + splitmix_step); };
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t at = mix(seed) + 2 * i;
    values[i] = std::sqrt(-2 * std::log(open_unit(mix(at)))) * std::cos(2 * std::numbers::pi * open_unit(mix(at + 1)));
  }
  return values;
}

}  // namespace rosin
