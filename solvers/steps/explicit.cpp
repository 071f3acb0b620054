/// The explicit method: iteration of the stages, error control, detection of stiffness, dense output.
#include "solvers/steps/explicit.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/bracket.hpp"
#include "core/instruction_set.hpp"
#include "core/stop.hpp"

namespace rosin::solvers::steps {

namespace {
constexpr int s = GaussTableau::stages;
constexpr double rounding = 2.3e-16;
constexpr double safety = 0.75, least_factor = 0.3, greatest_factor = 2;
/// Steps are taken in time, to end exactly at the limit, once the step times this factor reaches the limit.
constexpr double close = 1.3;
constexpr int most_sweeps = 18;
/// Contraction of the stages' errors in a sweep that needs the fewest sweeps per length.
constexpr double best_contraction = 0.3;
constexpr double too_slow = 0.8;
constexpr double little = 0.03;  ///< change over the scale
/// The estimate falls with this power of the step.
constexpr double estimate_order = 15;

ROSIN_INLINE double sum_of(const Pack& x) {
  const Block& b = x.block;
  return ((b[0] + b[4]) + (b[1] + b[5])) + ((b[2] + b[6]) + (b[3] + b[7]));
}
/// Σ_j w_j f_j in each lane, from the values f at the nodes; four partial sums shorten the chain of dependent
/// additions.
ROSIN_INLINE Pack weighted(const std::array<Pack, s>& w, const Pack& f) {
  Pack sum[4];
  ROSIN_UNROLL
  for (int j = 0; j < 4; ++j) sum[j] = w[j] * f.block[j] + w[j + 4] * f.block[j + 4];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}
}  // namespace

Explicit::Explicit(const System& system, double tolerance)
    : system_(system),
      tableau_(GaussTableau::get()),
      n_(system.size()),
      tolerance_(std::max(tolerance, least_tolerance)) {
  for (auto* v : {&y_, &y_before_, &y_trial_, &scale_, &start_slope_}) v->assign(n_ + 1, 0.0);
  for (auto* v : {&weight_, &from_, &stages_, &rates_, &slopes_, &slopes_trial_}) v->assign(n_ + 1, Pack(0.0));
}

void Explicit::start(double t, std::span<const double> y) {
  t_ = t_before_ = t;
  t_carry_ = 0;
  std::copy(y.begin(), y.end(), y_.begin());
  y_[n_] = 0;
  y_before_ = y_;
  h_next_ = contraction_per_h_ = 0;
  fresh_ = true;
  start_dt_ = 0;
  stiff_steps_ = easy_steps_ = 0;
}

void Explicit::evaluate(double t, Pack* f) {
  Pack times;
  for (int i = 0; i < s; ++i) times.block[i] = node_time(t + stages_[n_].block[i]);
  system_.flow(times, stages_.data(), f, pace_);
  if (clock_ == Clock::time) pace_ = 1.0;
  ++count_.evaluations;
}

double Explicit::sweep(Pack* f, bool rates) {
  double squares = 0;
  run_on_lanes([&] {
    if (rates) {
      const Pack dt = 1.0 / pace_;
      for (int i = 0; i < n_; ++i) f[i] = f[i] * dt;
      f[n_] = dt;
    }
    Pack sum = 0.0;
    const Pack h = length_;
    for (int i = 0; i <= n_; ++i) {
      const Pack moved = from_[i] + h * weighted(tableau_.a, f[i]), e = (moved - stages_[i]) * weight_[i];
      sum = sum + e * e;
      stages_[i] = moved;
    }
    squares = sum_of(sum);
  });
  return std::sqrt(squares / (s * n_));
}

Explicit::Iteration Explicit::iterate(double t, const double* y, double h, Pack* f) {
  for (int i = 0; i <= n_; ++i) from_[i] = y[i];
  length_ = h;
  sweep(f, false);
  double previous = 0;
  for (int sweeps = 1; sweeps <= most_sweeps; ++sweeps) {
    evaluate(t, f);
    const double change = sweep(f, true);
    if (!std::isfinite(change)) return Iteration::not_finite;
    const double rate = sweeps == 1 ? contraction_per_h_ * h : change / previous;
    previous = change;
    contraction_ = rate;
    if (rate < too_slow && change * rate <= (1 - rate) * goal_ && (sweeps > 1 || change <= goal_))
      return Iteration::converged;
    if (sweeps < 3) continue;
    if (rate >= too_slow) return change <= goal_ ? Iteration::converged : Iteration::slow;
    double left = change;
    for (int k = sweeps; k < most_sweeps; ++k) left *= rate;
    if (left > goal_) return Iteration::slow;
  }
  return Iteration::slow;
}

void Explicit::extrapolate(double from, double ratio, Pack* f) const {
  run_on_lanes([&] {
    const auto w = tableau_.basis(from + ratio * tableau_.nodes);
    for (int i = 0; i <= n_; ++i) f[i] = weighted(w, slopes_[i]);
  });
}

void Explicit::advance(const double* y, double h, const Pack* f, double* to) const {
  for (int i = 0; i <= n_; ++i) to[i] = y[i] + h * sum_of(tableau_.b * f[i]);
}

/// A smooth motion's Legendre coefficients on a step fall as C q^k. Known are C, the size of the slopes, and the
/// coefficients of the two highest degrees, s − 1 and s − 2, of which one may vanish by chance. The error of the end of
/// the step is of the size of C q^(2s); the estimate C q^(2(s − 1)) must meet the tolerance.
double Explicit::estimate_error(const Pack* f, double h) {
  double size = 0, highest = 0, second = 0;
  for (int i = 0; i <= n_; ++i) {
    const double w = h * weight_[i].block[0];
    const double top = w * sum_of(tableau_.top[0] * f[i]), below = w * sum_of(tableau_.top[1] * f[i]);
    if (i == n_) change_ = std::sqrt(size / n_);
    size += w * w * sum_of(tableau_.b * (f[i] * f[i]));
    highest += top * top, second += below * below;
  }
  if (size == 0) return 0;
  const double share = highest / size, instead = second / size;  // q^14, q^12
  return std::sqrt(size / n_) * std::max(share, instead * std::cbrt(std::sqrt(instead))) / tolerance_;
}

void Explicit::begin() {
  for (int i = 0; i < n_; ++i) stages_[i] = y_[i];
  stages_[n_] = 0.0;
  evaluate(t_, rates_.data());
  start_dt_ = 1 / pace_.block[0];
  for (int i = 0; i < n_; ++i) start_slope_[i] = rates_[i].block[0] * start_dt_;
  start_slope_[n_] = start_dt_;
  fresh_ = true;
}

double Explicit::first_step(double t_limit) const {
  // A step in which the solution changes by a tenth of its scale.
  double fastest = 0;
  for (int i = 0; i < n_; ++i) fastest = std::max(fastest, std::abs(start_slope_[i]) / scale_[i]);
  const double whole = (t_limit - t_) / start_dt_;
  return std::min(fastest > 0 ? 0.1 / fastest : 1e-3 * whole, 0.1 * whole);
}

void Explicit::set_clock(Clock clock) {
  if (clock_ == clock) return;
  const double before = start_dt_;
  clock_ = clock;
  begin();
  h_next_ *= before / start_dt_;
  contraction_per_h_ *= start_dt_ / before;
}

Outcome Explicit::step(double t_limit) {
  end_if_stopped();
  last_moment_ = std::nextafter(t_limit, t_);
  y_[n_] = 0;  // time is counted from the start of the step
  if (start_dt_ == 0) {
    begin();
    for (int i = 0; i <= n_; ++i)
      if (!std::isfinite(start_slope_[i])) {
        start_dt_ = 0;
        return not_finite();
      }
  }
  system_.scale(y_.data(), scale_.data());
  double digits = 0;  // rounding error of the unknowns, in scales
  for (int i = 0; i < n_; ++i) {
    weight_[i] = 1 / scale_[i];
    digits = std::max(digits, std::abs(y_[i]) / scale_[i]);
  }
  goal_ = std::max(0.1 * tolerance_, 2 * rounding * digits);
  if (h_next_ == 0) h_next_ = first_step(t_limit);
  const double remaining = t_limit - t_ - t_carry_, planned = h_next_ * start_dt_;
  if (close * planned >= remaining)
    set_clock(Clock::time);
  else if (4 * close * planned < remaining)
    set_clock(Clock::pace);
  weight_[n_] = clock_ == Clock::pace ? 1 / start_dt_ : 0;
  double h = h_next_;
  if (system_.resolution() < infinity) h = std::min(h, system_.resolution() / start_dt_);
  bool rejected = false, slow = false;
  for (int attempt = 0;; ++attempt) {
    bool last = false;
    if (clock_ == Clock::time) {
      if (h >= remaining * (1 - 1e-12))
        h = remaining, last = true;
      else if (h > 0.5 * remaining)
        h = 0.5 * remaining;
    }
    // Where nothing depends on time, a step may be below rounding error of the time.
    const double shortest = 4 * rounding * (system_.autonomous() ? 1e-9 : 1) * std::max(std::abs(t_), 1e-300);
    if (!(h * start_dt_ > shortest) || attempt > 100)
      return {Ending::tolerance_not_met, fmt::format("at t = {:.9g} s the step fell to {:.3g} s", t_, h * start_dt_)};
    constexpr int patience = 3;  // attempts with a prediction of full order
    if (fresh_)
      for (int i = 0; i <= n_; ++i) slopes_trial_[i] = start_slope_[i];
    else
      extrapolate(1, attempt < patience ? h / h_last_ : 0, slopes_trial_.data());
    const Iteration iteration = iterate(t_, y_.data(), h, slopes_trial_.data());
    if (iteration != Iteration::converged) {
      ++count_.rejected;
      h *= iteration == Iteration::slow ? 0.5 : 0.25;
      rejected = slow = true;
      continue;
    }
    const double error = estimate_error(slopes_trial_.data(), h);
    const double factor_now = safety * std::pow(std::max(error, 1e-30), -1 / estimate_order);
    if (!(error <= 1)) {
      ++count_.rejected;
      h *= std::isfinite(error) ? std::clamp(factor_now, least_factor, 0.9) : 0.2;
      rejected = true;
      continue;
    }
    advance(y_.data(), h, slopes_trial_.data(), y_trial_.data());
    if (clock_ == Clock::pace && y_trial_[n_] >= remaining) {  // too far: approach the limit in time instead
      ++count_.rejected;
      set_clock(Clock::time);
      weight_[n_] = 0;
      h = h_next_;
      continue;
    }
    const double converging = best_contraction / contraction_;
    const double factor = std::clamp(std::min(factor_now, converging), least_factor, rejected ? 1.0 : greatest_factor);
    // Convergence limits the step, although the unknowns hardly change in it.
    if ((slow || converging < std::min(factor_now, 1.5)) && change_ < little) {
      ++stiff_steps_;
      easy_steps_ = 0;
    } else if (++easy_steps_ >= 6) {
      stiff_steps_ = 0;
    }
    contraction_per_h_ = contraction_ / h;
    y_before_.swap(y_);
    y_.swap(y_trial_);
    slopes_.swap(slopes_trial_);
    t_before_ = t_;
    const double advanced = y_[n_] + t_carry_;
    t_ = last ? t_limit : t_before_ + advanced;
    t_carry_ = last ? 0 : advanced - (t_ - t_before_);
    h_last_ = h;
    clock_last_ = clock_;
    h_next_ = last && h_next_ > h ? std::max(h_next_, h * factor) : h * factor;
    fresh_ = false;
    start_dt_ = clock_ == Clock::pace ? sum_of(tableau_.end * slopes_[n_]) : 1;
    if (!(start_dt_ > 0)) start_dt_ = slopes_[n_].block[s - 1];
    system_.restore(node_time(t_), y_.data());
    ++count_.steps;
    return {};
  }
}

Outcome Explicit::not_finite() const {
  for (int i = 0; i < n_; ++i)
    if (!std::isfinite(start_slope_[i]))
      return {Ending::not_finite, fmt::format("at t = {:.9g} s in '{}'", t_, system_.unknown(i))};
  return {Ending::not_finite, fmt::format("at t = {:.9g} s", t_)};
}

double Explicit::part_of_step(double t) const {
  const double whole = t - t_before_;
  if (clock_last_ == Clock::time) return whole / h_last_;
  double q[s];  // time from the start of the step is Σ q_k θ^(k+1)
  for (int k = 0; k < s; ++k) {
    q[k] = 0;
    for (int j = 0; j < s; ++j) q[k] += h_last_ / (k + 1) * tableau_.lagrange[j][k] * slopes_[n_].block[j];
  }
  const auto late = [&](double theta) {
    double sum = 0;
    for (int k = s - 1; k >= 0; --k) sum = (sum + q[k]) * theta;
    return sum - whole;
  };
  // Time rises with θ.
  Bracket bracket{0, 1, -whole, late(1)};
  double theta = 1;
  for (int i = 0; i < 60 && bracket.width() > 1e-12; ++i) {
    theta = bracket.secant();
    if (!bracket.holds(theta)) break;
    const double f = late(theta);
    if (std::abs(f) <= 1e-10 * whole) break;
    bracket.take(theta, f);
  }
  return theta;
}

std::array<double, GaussTableau::stages> Explicit::inner_times() const {
  std::array<double, GaussTableau::stages> times;
  for (int i = 0; i < s; ++i) {
    double part = clock_last_ == Clock::time ? tableau_.nodes.block[i] : 0;
    for (int j = 0; j < s && clock_last_ == Clock::pace; ++j) part += tableau_.a[j].block[i] * slopes_[n_].block[j];
    times[i] = node_time(t_before_ + part * h_last_);
  }
  return times;
}

void Explicit::approximate(double t, double* y) {
  const double theta = part_of_step(t);
  extrapolate(0, theta, slopes_trial_.data());
  advance(y_before_.data(), theta * h_last_, slopes_trial_.data(), y_trial_.data());
  std::copy_n(y_trial_.data(), n_, y);
  system_.restore(t, y);
}

void Explicit::interpolate(double t, double* y) {
  if (t >= t_ || t <= t_before_) {
    std::copy_n(t >= t_ ? y_.data() : y_before_.data(), n_, y);
    return;
  }
  // The polynomial of the last step has half its order: it starts the iteration of a shorter step from the same start.
  const Clock clock = std::exchange(clock_, clock_last_);
  const double whole = t - t_before_;
  double theta = part_of_step(t);
  extrapolate(0, theta, slopes_trial_.data());
  for (int i = 0; i < 4; ++i) {
    const double h = theta * h_last_;
    if (iterate(t_before_, y_before_.data(), h, slopes_trial_.data()) != Iteration::converged) {
      extrapolate(0, theta, slopes_trial_.data());
      advance(y_before_.data(), h, slopes_trial_.data(), y_trial_.data());
      break;
    }
    advance(y_before_.data(), h, slopes_trial_.data(), y_trial_.data());
    if (clock_ == Clock::time) break;
    // The missing time is added by the slope at the end, or by another length of the step where its square matters.
    const double missing = (whole - y_trial_[n_]) / sum_of(tableau_.end * slopes_trial_[n_]);
    if (missing * missing <= 0.01 * tolerance_ || i == 3) {
      for (int k = 0; k < n_; ++k) y_trial_[k] += missing * sum_of(tableau_.end * slopes_trial_[k]);
      break;
    }
    theta += missing / h_last_;
  }
  clock_ = clock;
  std::copy_n(y_trial_.data(), n_, y);
  system_.restore(t, y);
}

}  // namespace rosin::solvers::steps
