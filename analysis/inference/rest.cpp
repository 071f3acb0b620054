/// Rest by the changes of sign of a slip rate that friction does not follow.
#include "analysis/inference/rest.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/inference/noise.hpp"

namespace rosin::analysis::inference {

namespace {

/// The value below which so much of them lies.
double quantile(std::vector<double> values, double part) {
  const auto at = values.begin() + std::ptrdiff_t(double(values.size() - 1) * part);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}
double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

struct Lobe {
  std::size_t begin, end;
  double sign, square, friction;  ///< of the slip rate, and mean friction

  std::size_t size() const { return end - begin; }
};

std::vector<Lobe> lobes_of(std::span<const double> slip_rate, std::span<const double> friction) {
  std::vector<Lobe> lobes;
  const auto close = [&](std::size_t begin, std::size_t end, double sign) {
    Lobe lobe{begin, end, sign, 0, 0};
    for (std::size_t k = begin; k < end; ++k) {
      lobe.square += slip_rate[k] * slip_rate[k] / double(end - begin);
      lobe.friction += friction[k] / double(end - begin);
    }
    lobes.push_back(lobe);
  };
  std::size_t begin = 0;
  double sign = 0;
  for (std::size_t k = 0; k < slip_rate.size(); ++k) {
    const double here = double((slip_rate[k] > 0) - (slip_rate[k] < 0));
    if (here * sign < 0) close(std::exchange(begin, k), k, sign);
    if (here != 0) sign = here;
  }
  close(begin, slip_rate.size(), sign);
  return lobes;
}

/// Those between two changes of sign that friction does not follow.
std::vector<Lobe> at_rest(const std::vector<Lobe>& lobes, double friction_of_sliding) {
  const auto reverses = [&](const Lobe& before, const Lobe& after) {
    return after.sign * (after.friction - before.friction) > friction_of_sliding;  // of twice as much
  };
  std::vector<Lobe> found;
  for (std::size_t i = 1; i + 1 < lobes.size(); ++i)
    if (!reverses(lobes[i - 1], lobes[i]) && !reverses(lobes[i], lobes[i + 1])) found.push_back(lobes[i]);
  return found;
}

/// Takes slip between two rests that is no longer than a spike for rest, and so all samples within `reach` of it.
void join(std::vector<char>& rest, std::size_t reach) {
  for (std::size_t k = 0; k < rest.size();) {
    auto end = k;
    while (end < rest.size() && rest[end] == rest[k]) ++end;
    if (!rest[k] && k > 0 && end < rest.size() && end - k <= 2 * reach)
      std::fill(rest.begin() + std::ptrdiff_t(k), rest.begin() + std::ptrdiff_t(end), char(1));
    k = end;
  }
  const auto before = rest;
  for (std::size_t k = 0; k < rest.size(); ++k)
    if (before[k])
      std::fill(rest.begin() + std::ptrdiff_t(k - std::min(k, reach)),
                rest.begin() + std::ptrdiff_t(std::min(rest.size(), k + reach + 1)), char(1));
}

}  // namespace

Rest rest_below(std::span<const double> slip_rate, double below) {
  Rest rest{.below = below, .given = true};
  for (const double u : slip_rate) rest.state.push_back(std::abs(u) <= below);
  join(rest.state, 1);
  return rest;
}

Rest find_rest(std::span<const double> slip_rate, std::span<const double> friction) {
  std::vector<double> speeds, frictions;
  for (const double u : slip_rate) speeds.push_back(std::abs(u));
  const double fast = quantile(speeds, 0.9);
  for (std::size_t k = 0; k < speeds.size(); ++k)
    if (speeds[k] >= fast) frictions.push_back(std::abs(friction[k]));
  const auto lobes = at_rest(lobes_of(slip_rate, friction), median(frictions));
  constexpr std::size_t enough_lobes = 8;
  constexpr double far = 6, within = 4;  // standard deviations
  const auto within_noise = [&](double noise) {
    Rest rest{.noise = noise, .below = within * noise};
    for (const double u : slip_rate) rest.state.push_back(std::abs(u) <= rest.below);
    return rest;
  };
  if (lobes.size() < enough_lobes) return within_noise(roughness(slip_rate));
  // The median counts lobes that hold a slip between two sticks as single ones.
  std::vector<double> squares;
  for (const auto& lobe : lobes) squares.push_back(lobe.square);
  const double rough = std::sqrt(median(squares));
  double square = 0, count = 0, quiet = 0;
  for (const auto& lobe : lobes)
    if (lobe.square < far * far * rough * rough)
      square += lobe.square * double(lobe.size()), count += double(lobe.size()), ++quiet;
  auto rest = within_noise(std::sqrt(square / count));
  rest.found = true;
  // A lobe of noise is twice as long as the sensor needs to follow; slip that is shorter is a spike of it.
  const auto reach = std::size_t(std::ceil(count / quiet / 2));
  join(rest.state, reach);
  return rest;
}

}  // namespace rosin::analysis::inference
