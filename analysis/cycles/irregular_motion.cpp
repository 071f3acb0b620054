/// The Lyapunov exponent from the derivatives of returns, and the test that motion is irregular.
#include "analysis/cycles/irregular_motion.hpp"

#include <array>
#include <cmath>

namespace rosin::analysis::cycles {

using Eigen::VectorXd;

namespace {

constexpr int parts = 10, part = 40, relaxed = 30;  // number of parts; returns in a part, and before the first
constexpr double certainly = 5, agree = 4;          // errors

/// Mean over the parts of a motion, with its standard error.
struct Mean {
  double value = 0, error = 0;
};
Mean mean_of(const double* first, int count) {
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) sum += first[i];
  const double mean = sum / count;
  for (int i = 0; i < count; ++i) squares += (first[i] - mean) * (first[i] - mean);
  return {mean, std::sqrt(squares / (count * (count - 1)))};
}
bool alike(const Mean& a, const Mean& b) { return std::abs(a.value - b.value) <= agree * std::hypot(a.error, b.error); }

/// The Lyapunov exponent of the motion from y, per return; moves y to its end.
std::optional<Mean> follow(ReturnMap& map, std::vector<double>& y, double tolerance) {
  constexpr double tighter = 1e-3, small = 1e-5;  // factor on the tolerance; largest relative error of a return
  constexpr long most_steps = 300'000;
  const auto steady = map.system().steady(0);
  const long last_step = map.cost().steps + most_steps;
  VectorXd neighbour = VectorXd::Ones(map.scale().size());  // in scales
  double amplitude = 1;
  std::array<double, parts> growth_of_part{}, sizes{};
  for (int k = -relaxed; k < parts * part; ++k) {
    const auto returned = map.follow(y, tolerance, 1, true, Derivative::of_steps, nullptr, dip_of(amplitude));
    if (!returned.outcome.complete() || map.cost().steps > last_step) return std::nullopt;
    if (k % part == 0) {
      const auto again = map.follow(y, tighter * tolerance, 1, true, Derivative::none, nullptr, dip_of(amplitude));
      if (!again.outcome.complete() ||
          map.distance(again.end, returned.end) > small * map.distance(returned.end, steady))
        return std::nullopt;
    }
    const VectorXd image = returned.derivative * neighbour.cwiseProduct(map.scale());
    neighbour = image.cwiseQuotient(map.scale());
    const double growth = neighbour.norm();
    if (!(growth > 0) || !std::isfinite(growth)) return std::nullopt;
    neighbour /= growth;
    y = returned.end;
    amplitude = returned.amplitude;
    if (k < 0) continue;
    growth_of_part[k / part] += std::log(growth) / part;
    sizes[k / part] += std::log(amplitude) / part;
  }
  constexpr int half = parts / 2;
  if (!alike(mean_of(&sizes[0], half), mean_of(&sizes[half], half))) return std::nullopt;
  return mean_of(growth_of_part.data(), parts);
}

}  // namespace

std::optional<Divergence> divergence_from(ReturnMap& map, const std::vector<double>& y) {
  // The second tolerance serves where the error of a return is too large at the first.
  for (const double tolerance : {1e-8, 1e-10}) {
    auto here = y;
    const auto first = follow(map, here, tolerance);
    if (!first) continue;
    if (!(first->value > certainly * first->error)) return std::nullopt;
    const double another = 1e-2 * tolerance;
    const auto second = follow(map, here, another);
    if (!second || !alike(*first, *second) || !(second->value > certainly * second->error)) return std::nullopt;
    return Divergence{(first->value + second->value) / 2, std::max(first->error, second->error), 2 * parts * part};
  }
  return std::nullopt;
}

}  // namespace rosin::analysis::cycles
