/// Multipliers at two tolerances, whose difference is their error.
#include "analysis/cycles/multipliers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/eigenpairs.hpp"
#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

std::vector<Complex> by_modulus(const MatrixXd& D) {
  const auto found = eigenpairs(D).values;
  std::vector<Complex> values(found.data(), found.data() + found.size());
  std::sort(values.begin(), values.end(), [](auto a, auto b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  return values;
}

std::vector<Complex> multipliers_of(const MatrixXd& derivative, const VectorXd& scale) {
  auto values = by_modulus(scale.cwiseInverse().asDiagonal() * derivative * scale.asDiagonal());
  values.pop_back();  // the zero of the projection onto the section
  return values;
}

Multipliers known_multipliers(const std::vector<Complex>& coarse, std::vector<Complex> fine) {
  constexpr double known = 0.1, rounding = 1e-13, shared = 1e-3;
  // Each is paired with the nearest of the others, the largest first.
  auto others = coarse;
  std::vector<double> apart;
  for (const auto& value : fine) {
    const auto nearest = std::min_element(others.begin(), others.end(),
                                          [&](auto a, auto b) { return std::abs(a - value) < std::abs(b - value); });
    if (nearest == others.end()) return {{}, {}, "multipliers at two tolerances do not go with each other"};
    apart.push_back(std::abs(*nearest - value));
    others.erase(nearest);
  }
  Multipliers result;
  // A difference may be small by chance: every error is at least 1e-3 of the largest.
  const double largest = apart.empty() ? 0 : *std::max_element(apart.begin(), apart.end());
  const double size = fine.empty() ? 0 : std::abs(fine.front());
  double unknown = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const double error = apart[i] + shared * largest + rounding * std::max(1.0, size);
    if (!(error < known * std::max(1.0, std::abs(fine[i])))) {
      unknown = std::max(unknown, std::isfinite(error) ? error : infinity);
      continue;
    }
    result.values.push_back(fine[i]);
    result.errors.push_back(error);
  }
  if (const auto lost = fine.size() - result.values.size(); lost > 0)
    result.left_out = fmt::format("{} of {} multipliers left out: at two tolerances they differ by up to {:.2g}", lost,
                                  fine.size(), unknown);
  return result;
}

namespace {

/// The derivative at the fixed point of the map at a tolerance, from a neighbouring y, which moves there. Nothing where
/// the motion does not return, or not to its start.
std::optional<MatrixXd> derivative_at_fixed_point(ReturnMap& map, std::vector<double>& y, double tolerance, int returns,
                                                  double amplitude, bool closes) {
  const int most_steps = closes ? 5 : 1;
  constexpr double noise = 100;                       // error of a return, in tolerances
  constexpr double closed = 1e-6, near_cycle = 1e-3;  // farther away the derivative is not the cycle's
  const VectorXd scale = map.scale();
  const auto begin = y;
  std::optional<MatrixXd> derivative;
  double before = infinity;
  for (int k = 0; k < most_steps; ++k) {
    const auto returned =
        map.follow(y, tolerance, returns, true, Derivative::across_motion, nullptr, dip_of(amplitude));
    if (!returned.outcome.complete()) return std::nullopt;
    const VectorXd change = map.difference(returned.end, y);
    const double length = map.length(change);
    if (!(length < before)) break;
    before = length;
    derivative = returned.derivative;
    if (length < noise * tolerance * std::min(1.0, amplitude)) break;
    const MatrixXd I = MatrixXd::Identity(scale.size(), scale.size());
    const VectorXd step =
        scale.asDiagonal() * solve_linear(scale.cwiseInverse().asDiagonal() * (I - *derivative) * scale.asDiagonal(),
                                          scale.cwiseInverse().asDiagonal() * change);
    if (!step.allFinite()) break;
    y = map.moved(y, step, 1);
  }
  const double size = std::min(1.0, amplitude);
  if (closes && !(before < closed * size && map.distance(y, begin) < near_cycle * size)) return std::nullopt;
  return derivative;
}

}  // namespace

Multipliers cycle_multipliers(ReturnMap& map, std::vector<double> y, int returns, double amplitude, bool closes) {
  std::vector<Complex> found[2];
  const double tolerances[] = {1e-9, 1e-11};
  for (int k = 0; k < 2; ++k) {
    const auto derivative = derivative_at_fixed_point(map, y, tolerances[k], returns, amplitude, closes);
    if (!derivative)
      return {
          {},
          {},
          fmt::format("multipliers left out: the cycle does not close on itself at a tolerance of {}", tolerances[k])};
    found[k] = multipliers_of(*derivative, map.scale());
  }
  return known_multipliers(found[0], std::move(found[1]));
}

}  // namespace rosin::analysis::cycles
