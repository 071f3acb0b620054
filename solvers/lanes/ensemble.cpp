/// Rosenbrock steps of 32 systems at once.
#include "solvers/lanes/ensemble.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "core/instruction_set.hpp"
#include "core/parameters.hpp"

namespace rosin::solvers::lanes {

namespace {
using Method = Ensemble::Method;
// Steps grow slowly: longer leaps passed over the bends where slip ends, unseen by the estimate.
constexpr double safety = 0.9, least_factor = 0.2, largest_factor = 2;
}  // namespace

Ensemble::Ensemble(const LaneSystem& system) : system_(system), size_(system.size()) {
  if (size_ > capacity || size_ < 1)
    throw InputError(fmt::format("the ensemble solver takes 1 to {} unknowns, got {}", capacity, size_));
  for (auto* lanes : {&y_, &before_, &tried_, &stage_, &f_, &mass_, &scale_}) lanes->fill(0.0);
  factors_.fill(0.0);
  for (auto& stage : U_) stage.fill(0.0);
  h_ = length_ = tolerance_ = 1.0;
  longest_ = infinity;
  time_ = time_before_ = accepted_error_ = accepted_length_ = 0.0;
}

void Ensemble::start(int lane, const double* y, double tolerance, double first_step) {
  for (int i = 0; i < size_; ++i) y_[i].set(lane, y[i]);
  h_.set(lane, first_step);
  longest_.set(lane, infinity);
  time_.set(lane, 0);
  tolerance_.set(lane, tolerance);
  accepted_length_.set(lane, 0);
}

void Ensemble::retake(int lane, double theta) {
  for (int i = 0; i < size_; ++i) y_[i].set(lane, before_[i][lane]);
  time_.set(lane, time_before_[lane]);
  h_.set(lane, theta * length_[lane]);
  accepted_length_.set(lane, 0);
}

void Ensemble::adjust(int lane, double theta) {
  for (int i = 0; i < size_; ++i) y_[i].set(lane, interpolate(lane, i, theta));
  time_.set(lane, time_before_[lane] + theta * length_[lane]);
}

Ensemble::Polynomial<double> Ensemble::polynomial(int lane, int i) const {
  Polynomial<double> q{before_[i][lane], tried_[i][lane], {0, 0, 0}};
  for (int term = 0; term < Method::dense_terms; ++term)
    for (int s = 0; s < Method::stages; ++s) q.k[term] += Method::dense[term][s] * U_[s][i][lane];
  return q;
}

// Kernels take the number of unknowns n as std::integral_constant, so that their loops unroll, or as int.
namespace {
template <class Size>
constexpr int most = Ensemble::capacity;
template <int n>
constexpr int most<std::integral_constant<int, n>> = n;
}  // namespace

/// A = M/(hγ) − J = LU of one pack, and its masses over h.
template <class Size>
ROSIN_INLINE void Ensemble::factorise_pack(Size n, int p) {
  const Pack h = min(h_.pack[p], longest_.pack[p]), per_h = 1.0 / h;
  length_.pack[p] = h;
  Pack A[most<Size>][most<Size>];
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) {
    mass_[i].pack[p] = mass_[i].pack[p] * per_h;
    ROSIN_UNROLL
    for (int j = 0; j < n; ++j) A[i][j] = -factors_[i * n + j].pack[p];
    A[i][i] = A[i][i] + mass_[i].pack[p] * (1 / Method::gamma);
  }
  ROSIN_UNROLL
  for (int k = 0; k < n; ++k) {
    A[k][k] = 1.0 / A[k][k];
    ROSIN_UNROLL
    for (int i = k + 1; i < n; ++i) {
      A[i][k] = A[i][k] * A[k][k];
      ROSIN_UNROLL
      for (int j = k + 1; j < n; ++j) A[i][j] = A[i][j] - A[i][k] * A[k][j];
    }
  }
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) ROSIN_UNROLL
  for (int j = 0; j < n; ++j) factors_[i * n + j].pack[p] = A[i][j];
}

/// U_s of one pack, and the next stage's argument (y₁ after the last).
template <int s, class Size>
ROSIN_INLINE void Ensemble::solve_stage(Size n, int p) {
  constexpr bool chained = s + 1 >= Method::chained_from;
  Pack x[most<Size>], next[most<Size>];
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) {
    x[i] = 0.0;
    next[i] = chained ? stage_[i].pack[p] : y_[i].pack[p];
  }
  const auto add = [&]<int j>(std::integral_constant<int, j>) __attribute__((always_inline)) {
    ROSIN_UNROLL
    for (int i = 0; i < n; ++i) {
      const Pack U = U_[j][i].pack[p];
      x[i] = x[i] + Method::c[s][j] * U;
      if constexpr (!chained) next[i] = next[i] + Method::a[s + 1][j] * U;
    }
  };
  [&]<std::size_t... j>(std::index_sequence<j...>) __attribute__((always_inline)) {
    (add(std::integral_constant<int, int(j)>()), ...);
  }
  (std::make_index_sequence<s>());
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) x[i] = f_[i].pack[p] + mass_[i].pack[p] * x[i];
  ROSIN_UNROLL
  for (int i = 1; i < n; ++i) ROSIN_UNROLL
  for (int j = 0; j < i; ++j) x[i] = x[i] - factors_[i * n + j].pack[p] * x[j];
  ROSIN_UNROLL
  for (int i = n - 1; i >= 0; --i) {
    ROSIN_UNROLL
    for (int j = i + 1; j < n; ++j) x[i] = x[i] - factors_[i * n + j].pack[p] * x[j];
    x[i] = x[i] * factors_[i * n + i].pack[p];
  }
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) {
    U_[s][i].pack[p] = x[i];
    if constexpr (chained)
      stage_[i].pack[p] = next[i] + x[i];
    else
      stage_[i].pack[p] = next[i] + Method::a[s + 1][s] * x[i];
  }
}

/// The estimate decides, and says how long the next step may be: the smaller of the elementary and the predictive
/// control (K. Gustafsson, ACM Trans. Math. Softw. 20, 496-517, 1994, as in RODAS of Hairer & Wanner).
template <class Size>
ROSIN_INLINE void Ensemble::decide(Size n, int p) {
  constexpr double order = Method::estimate_order;
  Pack squares = 0.0, poison = 0.0;
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) {
    const Pack e = U_[Method::stages - 1][i].pack[p] / scale_[i].pack[p];
    squares = squares + e * e;
    poison = poison + 0.0 * stage_[i].pack[p];  // NaN where a value is not finite
  }
  // Logarithm of the error in units of the tolerance.
  const Pack tolerance = tolerance_.pack[p];
  const Pack error = 0.5 * log(max(squares * (1.0 / n) / (tolerance * tolerance), Pack(1e-12))) + poison;
  const Pack h = length_.pack[p], last_h = accepted_length_.pack[p];
  const Mask good = error < Pack(0.0), finite = error < Pack(600.0);
  const auto bounded = [&](const Pack& factor) __attribute__((always_inline)) {
    return min(max(factor, Pack(least_factor)), Pack(largest_factor));
  };
  Pack factor = bounded(safety * exp(error * (-1 / order)));
  const Pack predicted = bounded(safety * (h / last_h) * exp((accepted_error_.pack[p] - 2.0 * error) * (1 / order)));
  factor = select(good & (last_h > Pack(0.0)), min(factor, predicted), factor);
  // No growth right after a failure, which leaves a negative length behind.
  factor = select(last_h < Pack(0.0), min(factor, Pack(1.0)), factor);
  factor = select(good, factor, min(factor, Pack(safety)));
  factor = select(finite, factor, Pack(0.1));
  h_.pack[p] = h * factor;
  accepted_error_.pack[p] = select(good, max(error, Pack(std::log(1e-2))), accepted_error_.pack[p]);
  accepted_length_.pack[p] = select(good, h, -abs(last_h) - h);
  time_before_.pack[p] = time_.pack[p];
  time_.pack[p] = select(good, time_.pack[p] + h, time_.pack[p]);
  ROSIN_UNROLL
  for (int i = 0; i < n; ++i) {
    before_[i].pack[p] = y_[i].pack[p];
    tried_[i].pack[p] = stage_[i].pack[p];
    y_[i].pack[p] = select(good, stage_[i].pack[p], y_[i].pack[p]);
  }
  accepted_[p] = good;
}

template <class Size>
void Ensemble::try_step(Size n) {
  system_.mass(mass_.data());
  system_.linearise(y_.data(), f_.data(), factors_.data());
  system_.scale(y_.data(), factors_.data(), scale_.data());
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p) factorise_pack(n, p);
  });
  [&]<std::size_t... s>(std::index_sequence<s...>) {
    const auto stage = [&]<int number>(std::integral_constant<int, number>) {
      if (number > 0) system_.evaluate(stage_.data(), f_.data());
      run_on_lanes([&] {
        for (int p = 0; p < packs_; ++p) solve_stage<number>(n, p);
      });
    };
    (stage(std::integral_constant<int, int(s)>()), ...);
  }
  (std::make_index_sequence<Method::stages>());
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p) decide(n, p);
  });
}

void Ensemble::attempt() {
  const bool done = [&]<std::size_t... k>(std::index_sequence<k...>) {
    const auto fits = [&](auto n) { return size_ == n && (try_step(n), true); };
    return (fits(std::integral_constant<int, int(k) + 1>()) || ...);
  }
  (std::make_index_sequence<unrolled>());
  if (!done) try_step(size_);
}

}  // namespace rosin::solvers::lanes
