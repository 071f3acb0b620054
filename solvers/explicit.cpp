/// The explicit method: stages, error control, detection of stiffness, dense output.
#include "solvers/explicit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rosin::solvers {

namespace {
constexpr double rounding = 2.3e-16;
constexpr double safety = 0.88, least_factor = 0.3, greatest_factor = 4;
/// The part of the way to the limit from which on steps are taken in time, so that the limit is met exactly.
constexpr double close = 1.3;
}  // namespace

Explicit::Explicit(const System& system, double tolerance)
    : system_(system), n_(system.size()), blocks_(n_ / 4 + 1), tolerance_(std::max(tolerance, least_tolerance)) {
  for (auto* v : {&y_, &y_before_, &y_trial_, &scale_, &weight_, &work_}) v->assign(4 * blocks_, 0.0);
  slopes_.assign((Tableau::all + 1) * blocks_, Block{});
  dense_.assign((3 + Tableau::dense) * 4 * blocks_, 0.0);
}

void Explicit::start(double t, std::span<const double> y) {
  t_ = t_before_ = t;
  t_low_ = 0;
  std::copy(y.begin(), y.end(), y_.begin());
  y_before_ = y_;
  h_next_ = 0;
  known_ = dense_known_ = false;
  stiff_steps_ = easy_steps_ = 0;
}

bool Explicit::evaluate(double t, const double* y, double* slope) {
  double pace = 1;
  system_.flow(t, y, slope, pace);
  ++count_.evaluations;
  double sum = 0;
  if (clock_ == Clock::time) {
    slope[n_] = 1;
    for (int i = 0; i < n_; ++i) sum += slope[i];
  } else {
    const double dt = slope[n_] = 1 / pace;
    for (int i = 0; i < n_; ++i) sum += slope[i] *= dt;
  }
  return std::isfinite(sum + slope[n_]);
}

namespace {
/// Σ_j w_j k_j of block b, unrolled over the weights that are not zero, in two sums that do not wait for each other.
template <const auto& weights, class Block, int... j>
inline Block weighted(const Block* k, int blocks, int b, std::integer_sequence<int, j...>) {
  Block even{}, odd{};
  const auto add = [&]<int i>(std::integral_constant<int, i>) {
    if constexpr (weights[i] != 0) (i % 2 ? odd : even) += weights[i] * k[i * blocks + b];
  };
  (add(std::integral_constant<int, j>()), ...);
  return even + odd;
}
}  // namespace

/// y + h Σ_j a_ij k_j
template <int stage>
void Explicit::combine(double h, double* to) const {
  for (int b = 0; b < blocks_; ++b) {
    Block y;
    std::memcpy(&y, y_.data() + 4 * b, sizeof y);
    y += h * weighted<Tableau::a[stage]>(slopes_.data(), blocks_, b, std::make_integer_sequence<int, stage>());
    std::memcpy(to + 4 * b, &y, sizeof y);
  }
}

template <int... stage>
bool Explicit::stages(double h, std::integer_sequence<int, stage...>) {
  // Stages 1 … 11; time is counted from the start of the step, so that short steps late in a run lose nothing.
  return ((combine<stage + 1>(h, work_.data()), evaluate(node_time(t_ + work_[n_]), work_.data(), slope(stage + 1))) &&
          ...);
}

double Explicit::estimate_error(double h) {
  constexpr std::make_integer_sequence<int, Tableau::stages> all;
  const int time_block = n_ / 4, time_lane = n_ % 4;
  const double time5 = weighted<Tableau::error5>(slopes_.data(), blocks_, time_block, all)[time_lane],
               time3 = weighted<Tableau::error3>(slopes_.data(), blocks_, time_block, all)[time_lane];
  // An error e_t in time at a given s is one of −ẏ e_t in y at a given time.
  const double dt = 1 / slope(Tableau::stages - 1)[n_];
  double sum5 = 0, sum3 = 0;
  for (int b = 0; b < blocks_; ++b) {
    const Block& last = slopes_[(Tableau::stages - 1) * blocks_ + b];
    Block weight;
    std::memcpy(&weight, weight_.data() + 4 * b, sizeof weight);
    const Block e5 = (weighted<Tableau::error5>(slopes_.data(), blocks_, b, all) - last * (dt * time5)) * weight,
                e3 = (weighted<Tableau::error3>(slopes_.data(), blocks_, b, all) - last * (dt * time3)) * weight;
    const Block square5 = e5 * e5, square3 = e3 * e3;
    for (int i = 0; i < 4; ++i) sum5 += square5[i], sum3 += square3[i];
  }
  if (sum5 == 0) return 0;
  return h * sum5 / std::sqrt((sum5 + 0.01 * sum3) * n_) / tolerance_;
}

void Explicit::watch_stiffness(double h) {
  // |f(y₁) − f(Y₁₁)|/|y₁ − Y₁₁| estimates the greatest rate (Hairer & Wanner, IV.2).
  const double *end = slope(0), *last = slope(Tableau::stages - 1);
  double rates = 0, distances = 0;
  for (int i = 0; i < n_; ++i) {
    const double dk = (end[i] - last[i]) / scale_[i], dy = (y_[i] - work_[i]) / scale_[i];
    rates += dk * dk, distances += dy * dy;
  }
  if (distances > 0 && h * std::sqrt(rates / distances) > Tableau::stability) {
    ++stiff_steps_;
    easy_steps_ = 0;
  } else if (++easy_steps_ >= 6) {
    stiff_steps_ = 0;
  }
}

double Explicit::first_step(double t_limit) {
  // A step in which the solution changes by a hundredth of its scale.
  double fastest = 0;
  for (int i = 0; i < n_; ++i) fastest = std::max(fastest, std::abs(slope(0)[i]) / scale_[i]);
  const double whole = (t_limit - t_) / slope(0)[n_];
  return std::min(fastest > 0 ? 0.01 / fastest : 1e-3 * whole, 0.1 * whole);
}

void Explicit::set_clock(Clock clock) {
  if (clock_ == clock) return;
  const double before = slope(0)[n_];  // dt/ds
  clock_ = clock;
  evaluate(node_time(t_), y_.data(), slope(0));
  h_next_ *= before / slope(0)[n_];
}

Outcome Explicit::step(double t_limit) {
  last_moment_ = std::nextafter(t_limit, t_);
  if (!known_ && !evaluate(node_time(t_), y_.data(), slope(0))) return not_finite();
  known_ = true;
  system_.scale(y_.data(), scale_.data());
  for (int i = 0; i < n_; ++i) weight_[i] = 1 / scale_[i];
  y_[n_] = 0;  // time is counted from the start of the step
  if (h_next_ == 0) h_next_ = first_step(t_limit);
  const double remaining = t_limit - t_ - t_low_, planned = h_next_ * slope(0)[n_];
  if (close * planned >= remaining)
    set_clock(Clock::time);
  else if (4 * close * planned < remaining)
    set_clock(Clock::pace);
  double h = h_next_;
  if (system_.resolution() < infinity) h = std::min(h, system_.resolution() / slope(0)[n_]);
  bool rejected = false;
  for (int attempt = 0;; ++attempt) {
    bool last = false;
    if (clock_ == Clock::time) {
      if (h >= remaining * (1 - 1e-12))
        h = remaining, last = true;
      else if (h > 0.5 * remaining)
        h = 0.5 * remaining;
    }
    // Where nothing depends on time, steps may be shorter than the clock shows.
    const double shortest = 4 * rounding * (system_.autonomous() ? 1e-9 : 1) * std::max(std::abs(t_), 1e-300);
    if (!(h * slope(0)[n_] > shortest) || attempt > 100)
      return {Ending::tolerance_not_met,
              fmt::format("at t = {:.9g} s the step fell to {:.3g} s", t_, h * slope(0)[n_])};
    const bool finite = stages(h, std::make_integer_sequence<int, Tableau::stages - 1>());
    if (!finite) {
      ++count_.rejected;
      h *= 0.25;
      rejected = true;
      continue;
    }
    const double error = estimate_error(h);
    const double factor_now = std::pow(std::max(error, 1e-10), -1.0 / 8);
    if (!(error <= 1)) {
      ++count_.rejected;
      h *= std::isfinite(error) ? std::clamp(safety * factor_now, least_factor, 0.9) : 0.2;
      rejected = true;
      continue;
    }
    combine<Tableau::stages>(h, y_trial_.data());
    if (clock_ == Clock::pace && y_trial_[n_] >= remaining) {  // too far: approach the limit in time instead
      ++count_.rejected;
      set_clock(Clock::time);
      h = h_next_;
      continue;
    }
    const double factor = std::clamp(safety * factor_now, least_factor, rejected ? 1.0 : greatest_factor);
    y_before_.swap(y_);
    y_.swap(y_trial_);
    t_before_ = t_;
    const double advance = y_[n_] + t_low_;
    t_ = last ? t_limit : t_before_ + advance;
    t_low_ = last ? 0 : advance - (t_ - t_before_);
    h_last_ = h;
    h_next_ = last && h_next_ > h ? std::max(h_next_, h * factor) : h * factor;
    system_.restore(node_time(t_), y_.data());
    ++count_.steps;
    dense_known_ = false;
    // The slope at the end is the first of the next step; that at the start is kept for dense output.
    std::swap_ranges(slope(0), slope(1), slope(Tableau::all));
    if (!evaluate(node_time(t_), y_.data(), slope(0))) return not_finite();
    watch_stiffness(h);
    return {};
  }
}

Outcome Explicit::not_finite() {
  for (int i = 0; i < n_; ++i)
    if (!std::isfinite(slope(0)[i]))
      return {Ending::not_finite, fmt::format("at t = {:.9g} s in '{}'", t_, system_.unknown(i))};
  return {Ending::not_finite, fmt::format("at t = {:.9g} s", t_)};
}

void Explicit::prepare_dense() {
  // Three more stages of the last step, from its own start and slopes; then those of the present state come back.
  const double t_end = t_;
  y_.swap(y_before_);
  t_ = t_before_;
  std::swap_ranges(slope(0), slope(1), slope(Tableau::all));
  std::copy_n(slope(Tableau::all), 4 * blocks_, slope(Tableau::stages));
  const double before = y_[n_];
  y_[n_] = 0;
  const auto stage = [&]<int i>(std::integral_constant<int, i>) {
    combine<i>(h_last_, work_.data());
    evaluate(node_time(t_ + work_[n_]), work_.data(), slope(i));
  };
  stage(std::integral_constant<int, 13>());
  stage(std::integral_constant<int, 14>());
  stage(std::integral_constant<int, 15>());
  y_[n_] = before;
  for (int i = 0; i <= n_; ++i) {
    double* f = dense_.data() + i * (3 + Tableau::dense);
    const double from = i == n_ ? 0 : y_[i], change = y_before_[i] - from;
    f[0] = change;
    f[1] = h_last_ * slope(0)[i] - change;
    f[2] = 2 * change - h_last_ * (slope(Tableau::stages)[i] + slope(0)[i]);
    for (int r = 0; r < Tableau::dense; ++r) {
      f[3 + r] = 0;
      for (int j = 0; j < Tableau::all; ++j) f[3 + r] += h_last_ * Tableau::d[r][j] * slope(j)[i];
    }
  }
  std::swap_ranges(slope(0), slope(1), slope(Tableau::all));
  y_.swap(y_before_);
  t_ = t_end;
  dense_known_ = true;
}

double Explicit::dense(double theta, int i) const {
  const double* f = dense_.data() + i * (3 + Tableau::dense);
  double y = 0;
  for (int r = 2 + Tableau::dense; r >= 0; --r) y = (y + f[r]) * (r % 2 == 0 ? theta : 1 - theta);
  return (i == n_ ? 0 : y_before_[i]) + y;
}

void Explicit::interpolate(double t, double* y) {
  if (t >= t_ || t <= t_before_) {
    std::copy_n(t >= t_ ? y_.data() : y_before_.data(), n_, y);
    return;
  }
  if (!dense_known_) prepare_dense();
  // The part θ of the step in s at which time is t: it rises with θ; regula falsi (Illinois).
  const double whole = t - t_before_;
  double low = 0, high = 1, f_low = -whole, f_high = dense(1, n_) - whole, theta = 1;
  for (int i = 0, kept = 0; i < 100 && high - low > 1e-16; ++i) {
    theta = (low * f_high - high * f_low) / (f_high - f_low);
    if (!(theta > low && theta < high)) break;
    const double f = dense(theta, n_) - whole;
    if (std::abs(f) <= rounding * whole) break;
    if (f > 0) {
      high = theta, f_high = f;
      if (kept == -1) f_low *= 0.5;
      kept = -1;
    } else {
      low = theta, f_low = f;
      if (kept == 1) f_high *= 0.5;
      kept = 1;
    }
  }
  for (int i = 0; i < n_; ++i) y[i] = dense(theta, i);
  system_.restore(t, y);
}

}  // namespace rosin::solvers
