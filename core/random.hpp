/// Random numbers that are the same on every machine: SplitMix64 (Steele, Lea & Flood 2014), a counter well mixed.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rosin {

/// From one state of the counter to the next.
inline constexpr std::uint64_t splitmix_step = 0x9E3779B97F4A7C15u;

/// The bits of a counter's state, mixed.
inline std::uint64_t splitmix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// The upper 53 bits as a number in (0, 1).
inline double open_unit(std::uint64_t bits) { return (double(bits >> 11) + 0.5) * 0x1p-53; }

/// Independent standard normal numbers: the same for the same seed on every machine.
std::vector<double> white_noise(std::size_t count, std::uint64_t seed);

}  // namespace rosin
