/// The collocation method: simplified Newton on decoupled blocks, error control, events, variational equations.
#include "solvers/steps/collocation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/stop.hpp"
#include "solvers/steps/lu.hpp"

namespace rosin::solvers::steps {

namespace {
constexpr int s = Collocation::stages;
constexpr double rounding = 2.3e-16;
constexpr int step_iterations = 12;     ///< beyond these a shorter step converges faster
constexpr int patient_iterations = 60;  ///< for a step of given length
constexpr int corner_attempt = 4;       ///< failures of Newton's method before the search for a corner
/// Accepted rounding error in scales. The bound of the rounding error may be large while the error itself is small: the
/// second value serves where no step succeeds with the first.
constexpr double most_rounding[] = {1e-6, 0.1};
constexpr int rounding_attempt = 12;
constexpr int most_pieces = 12;    ///< of the way to a singular kink
constexpr int kink_attempts = 10;  ///< after which rounding may be what the estimate next to it shows
constexpr double least_factor = 0.1, greatest_factor = 8, safety = 0.85;
}  // namespace

Collocation::Collocation(const System& system, double tolerance)
    : system_(system),
      tableau_(RadauTableau::get()),
      n_(system.size()),
      tolerance_(std::max(tolerance, least_tolerance)),
      algebra_(stage_algebra(system, tableau_, tolerance_)),
      most_rounding_(most_rounding[0]) {
  // The embedded estimate falls with h^6, the error of the solution with h^9. The estimate must meet tolerance^(2/3),
  // at which the solution meets the tolerance (after the idea of Hairer & Wanner 1999 for their code of variable
  // order). The error of moderately stiff unknowns, such as the slip rate in slow stick, stays at the size of the
  // estimate.
  estimate_tolerance_ = std::pow(tolerance_, 2.0 / 3);
  bound_share_ = std::min(1.0, std::pow(tolerance_ / 1e-6, 1.0 / 9));
  const int n = n_;
  for (auto* v : {&carry_, &y_, &y_before_, &f0_, &mass_, &scale_, &work_}) v->assign(n, 0.0);
  for (auto* v : {&Z_, &Z_trial_, &residual_, &stage_mass_}) v->assign(s * n, 0.0);
  real_right_.assign(n, 0.0);
  for (auto& right : pair_right_) right.assign(n, 0.0);
  f_stage_.assign(n, 0.0);
}

double Collocation::norm(const double* v) const {
  double sum = 0;
  for (int i = 0; i < n_; ++i) {
    const double e = v[i] / scale_[i];
    sum += e * e;
  }
  return std::sqrt(sum / n_);  // NaN stays NaN
}

bool Collocation::start(double t, std::span<const double> y) {
  t_ = t_before_ = t;
  y_.assign(y.begin(), y.end());
  y_before_ = y_;
  std::fill(carry_.begin(), carry_.end(), 0.0);
  h_next_ = 0;
  fresh_ = true;
  rounded_ = false;
  rejections_ = 0;
  // Neither cost nor result of a solution may depend on earlier ones.
  algebra_->forget();
  system_.mass(t, mass_.data());
  if (!make_consistent()) return false;
  y_before_ = y_;
  time_carry_ = time_carry_before_ = 0;
  system_.kinks(t, y_.data(), kinks_);
  has_kinks_ = std::ranges::any_of(kinks_, [](double k) { return !std::isnan(k); });
  kink_side_.assign(kinks_.size(), 0);
  since_kink_ = has_kinks_ && system_.kinks_are_singular() ? 0 : infinity;
  pieces_ = 0;
  if (has_kinks_) end_at_kink();
  return true;
}

bool Collocation::make_consistent() {
  // Newton on the algebraic rows in the algebraic unknowns.
  std::vector<int> rows;
  for (int i = 0; i < n_; ++i)
    if (mass_[i] == 0) rows.push_back(i);
  if (rows.empty()) return true;
  std::vector<double>& r = work_;
  for (int iteration = 0; iteration < 200; ++iteration) {
    algebra_->linearise(t_, y_.data(), f0_.data());
    ++count_.linearisations;
    for (const int i : rows) r[i] = -f0_[i];
    if (!algebra_->solve_algebraic(mass_, r.data())) return false;
    system_.scale(y_.data(), scale_.data());
    double change = 0, jump = 0;
    for (const int i : rows) {
      const double scale = scale_[i], step = std::abs(r[i]);
      change = std::max(change, step / scale);
      jump = std::max(jump, step / std::max(scale, 0.1 * std::abs(y_[i])));
    }
    if (!std::isfinite(change)) return false;
    const double damping = std::min(
        1.0,
        1.0 /
            jump);  // friction is exponential in the slip rate: a step is at most one scale, or a tenth of the unknown
    for (const int i : rows) y_[i] += damping * r[i];
    if (change < 1e-13) break;
  }
  return true;
}

/// An algebraic row may have a corner (|v| at v = 0) within rounding error of the last step's end. If all solutions lie
/// beyond it, where the slope differs, Newton's method alternates at any step length. Solving the algebraic unknowns
/// anew then moves them to the other side. They stay where the slope does not change: the row may have an extremum
/// there, and new rounding errors at every step would shorten the steps without end.
void Collocation::search_for_corner() {
  constexpr double corner = 0.05;  // relative change of a slope
  const std::vector<double> unchanged = y_;
  std::vector<double> before(n_);
  for (int i = 0; i < n_; ++i) before[i] = algebra_->own_slope(i);
  bool slope_changed = false;
  if (make_consistent()) {
    algebra_->linearise(t_, y_.data(), f0_.data());
    ++count_.linearisations;
    for (int i = 0; i < n_; ++i)
      slope_changed |= mass_[i] == 0 && std::abs(algebra_->own_slope(i) - before[i]) > corner * std::abs(before[i]);
  }
  if (slope_changed) return;
  y_ = unchanged;
  algebra_->linearise(t_, y_.data(), f0_.data());
  ++count_.linearisations;
}

/// The largest growth rate that a step of length h resolves: z/h, with the error of the method at z equal to the
/// tolerance times e^z. The error estimate is blind to growth while the mode is small, and beyond its pole at z = γ the
/// method damps the mode.
double Collocation::resolved_growth(double h) const {
  constexpr double last_term = 2.2e-9;
  return std::min(std::pow(tolerance_ / last_term, 1.0 / (2 * s)), 0.5 * tableau_.gamma) / h;
}

/// The step length h, or the first shorter one at which a mode grows too fast, tried upwards from the last length (at a
/// start from far below h). The growth test misses two modes of about the same rate if a step passes the bounds of both
/// at once.
double Collocation::within_growth(double h) {
  constexpr double apart = 1.5, far_below = 1e-7;
  for (double shorter = fresh_ ? far_below * h : h_last_; shorter < h; shorter *= apart)
    if (algebra_->grows_faster(resolved_growth(shorter), mass_)) return shorter;
  return h;
}

Collocation::Newton Collocation::solve_stages(double t, const double* y0, double h, int most_iterations,
                                              bool to_rounding) {
  const int n = n_;
  for (int i = 0; i < s; ++i) system_.mass(node_time(t, tableau_.c[i] * h), &stage_mass_[i * n]);
  const double goal = std::max(0.01 * tolerance_, 20 * rounding);
  double previous = 0, rate = 1, change = 0;
  const auto stalled = [&] {
    if (change < 1e3 * rounding) return Newton::converged;
    return to_rounding && change <= std::min(rounding_error(), most_rounding_) ? Newton::rounded : Newton::slow;
  };
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    iterations_ = iteration + 1;
    // Residual f(Y_i) − M_i (A⁻¹ Z)_i / h.
    for (int i = 0; i < s; ++i) {
      for (int k = 0; k < n; ++k) work_[k] = y0[k] + Z_trial_[i * n + k];
      system_.evaluate(node_time(t, tableau_.c[i] * h), work_.data(), &residual_[i * n]);
      for (int k = 0; k < n; ++k) {
        double sum = 0;
        for (int j = 0; j < s; ++j) sum += tableau_.a_inverse[i][j] * Z_trial_[j * n + k];
        residual_[i * n + k] -= stage_mass_[i * n + k] * sum / h;
      }
    }
    count_.evaluations += s;
    // Decoupled blocks: (λ_k M/h − J) w_k = (T⁻¹ residual)_k, ΔZ = T w.
    change = 0;
    auto& real_part = real_right_;
    for (int k = 0; k < n; ++k) {
      real_part[k] = 0;
      for (int i = 0; i < s; ++i) real_part[k] += tableau_.real_row[i] * residual_[i * n + k];
    }
    algebra_->solve_real(real_part.data());
    auto& w = pair_right_;
    for (int p = 0; p < 2; ++p) {
      for (int k = 0; k < n; ++k) {
        w[p][k] = 0;
        for (int i = 0; i < s; ++i) w[p][k] += tableau_.pair_row[p][i] * residual_[i * n + k];
      }
      algebra_->solve_pair(p, w[p].data());
    }
    for (int i = 0; i < s; ++i) {
      for (int k = 0; k < n; ++k) {
        const double delta =
            tableau_.real_column[i] * real_part[k] + 2 * (product(tableau_.pair_column[0][i], w[0][k]).real() +
                                                          product(tableau_.pair_column[1][i], w[1][k]).real());
        Z_trial_[i * n + k] += delta;
        const double e = delta / scale_[k];
        change += e * e;
      }
    }
    change = std::sqrt(change / (s * n));
    if (!std::isfinite(change)) return Newton::not_finite;
    if (change <= 20 * rounding) return Newton::converged;
    if (iteration > 0) {
      rate = change / previous;
      if (rate < 1 && change * rate / (1 - rate) <= goal) return Newton::converged;
      if (rate > 0.99 && iteration > 2) return stalled();
      // The remaining iterations must suffice at the present rate.
      if (iteration > 2 && rate < 1 && change * std::pow(rate, most_iterations - 1 - iteration) / (1 - rate) > goal)
        return stalled();
    }
    previous = change;
  }
  return stalled();
}

double Collocation::estimate_error(double t, const double* y0, double h, bool refine) {
  const int n = n_;
  std::vector<double>& e = f_stage_;
  const auto solve = [&](const double* f) {
    for (int k = 0; k < n; ++k) {
      double sum = 0;
      for (int i = 0; i < s; ++i) sum += tableau_.error_weights[i] * Z_trial_[i * n + k];
      e[k] = f[k] + tableau_.gamma / h * mass_[k] * sum;
    }
    algebra_->solve_real(e.data());
  };
  solve(f0_.data());
  double size = norm(e.data());
  const double ringing =
      algebra_->error_of_oscillations({h, h * resolved_growth(h), y_, mass_, scale_, {e.data(), std::size_t(n)}, size});
  if (refine && size > estimate_tolerance_) {
    // The estimate is filtered once more for stiff components (Hairer & Wanner, IV.8), but not at a start, where the
    // filter would hide their transient, which a long step skips at every tolerance alike.
    for (int k = 0; k < n; ++k) work_[k] = y0[k] + e[k];
    std::vector<double>& f = residual_;
    system_.evaluate(t, work_.data(), f.data());
    ++count_.evaluations;
    solve(f.data());
    size = norm(e.data());
  }
  if (size > estimate_tolerance_) size = beyond_rounding(e);
  estimate_ = size;
  // The error of an oscillation falls with h^10, this estimate with h^6.
  return std::max(size / estimate_tolerance_, std::pow(ringing / tolerance_, 0.6));
}

/// Rounding error of f in a row.
double Collocation::rounding_of_row(int row) const {
  return last_digits_of_terms(algebra_->size_of_terms(row, y_.data()));
}

/// Rounding error of f in the embedded estimate of a step whose matrix is factorised, in scales.
double Collocation::rounding_error() {
  for (int i = 0; i < n_; ++i) work_[i] = rounding_of_row(i);
  algebra_->solve_real(work_.data());
  return norm(work_.data());
}

/// The size of an estimate, in scales, beyond the part from rounding error of algebraic rows, which does not depend on
/// the length of the step.
double Collocation::beyond_rounding(const std::vector<double>& estimate) {
  for (int i = 0; i < n_; ++i) work_[i] = mass_[i] == 0 ? rounding_of_row(i) : 0;
  algebra_->solve_real(work_.data());
  for (int i = 0; i < n_; ++i)
    work_[i] = std::max(std::abs(estimate[i]) - std::min(std::abs(work_[i]), most_rounding_ * scale_[i]), 0.0);
  return norm(work_.data());
}

double Collocation::first_step(double t_limit) {
  // The solution changes by a hundredth of its scale in this step, by the differential rows.
  double fastest = 0;
  for (int i = 0; i < n_; ++i)
    if (mass_[i] > 0) fastest = std::max(fastest, std::abs(f0_[i] / mass_[i]) / scale_[i]);
  // Stiff rows decay within 1/|J|; the step may be longer, as error control decides.
  const double guess = fastest > 0 ? 0.01 / fastest : 1e-3 * (t_limit - t_);
  // The step is shorter at tighter tolerances, so that two tolerances never take the same steps over a transient, nor
  // share the samples within the first.
  const double share = 0.1 * std::cbrt(tolerance_);
  double first = std::min({bound_share_ * guess, share * (t_limit - t_), system_.resolution()});
  if (resolve_starts_) {
    double response = 0;  // largest sum of a row of M⁻¹ J, in scales
    for (int i = 0; i < n_; ++i) {
      const double sum = algebra_->size_of_terms(i, scale_.data());
      if (mass_[i] > 0) response = std::max(response, sum / (mass_[i] * scale_[i]));
    }
    if (response > 0 && std::isfinite(response)) first = std::min(first, bound_share_ / response);
  }
  return std::max(first, 16 * rounding * std::abs(t_));
}

Outcome Collocation::step(double t_limit) {
  end_if_stopped();
  const int n = n_;
  last_moment_ = std::nextafter(t_limit, t_);
  system_.mass(t_, mass_.data());
  algebra_->linearise(t_, y_.data(), f0_.data());
  ++count_.linearisations;
  system_.scale(y_.data(), scale_.data());
  for (int i = 0; i < n; ++i)
    if (!std::isfinite(f0_[i]))
      return {Ending::not_finite, fmt::format("at t = {:.9g} s in '{}'", t_, system_.unknown(i))};
  double h = h_next_ > 0 ? h_next_ : first_step(t_limit);
  h = std::min({h, system_.resolution(), longest_step_, algebra_->longest_step()});
  h = within_growth(h);
  // A step may be below rounding error of the time, as in a fast slip after a long stick, or while friction reverses:
  // what depends on time then stands still within it, and carried time adds up.
  const double shortest = 1e-30 * 4 * rounding * std::max(std::abs(t_), 1e-300);
  bool rejected = false;
  constexpr int shortened = 3;
  const double first_tried = h, planned = rejections_ < shortened ? h : 0;
  for (int attempt = 0;; ++attempt) {
    if (attempt == rounding_attempt && most_rounding_ < most_rounding[1]) {
      most_rounding_ = most_rounding[1];
      h = first_tried;
    }
    const double remaining = (t_limit - t_) - time_carry_;
    bool last = false;
    if (h >= remaining * (1 - 1e-12) && remaining <= longest_step_)
      h = remaining, last = true;
    else if (h > 0.5 * remaining)
      h = 0.5 * remaining;  // two equal steps avoid a tiny last one
    while (h >= shortest && algebra_->grows_faster(resolved_growth(h), mass_)) h *= 0.5, last = false;
    if (h < shortest || attempt > 200 || !(h > 0)) {
      int worst = 0;
      for (int i = 1; i < n; ++i)
        if (std::abs(f_stage_[i]) / scale_[i] > std::abs(f_stage_[worst]) / scale_[worst]) worst = i;
      return {Ending::tolerance_not_met,
              fmt::format("at t = {:.9g} s the step fell to {:.3g} s in '{}'", t_, h, system_.unknown(worst))};
    }
    algebra_->factorise(h, mass_);
    ++count_.factorisations;
    // Newton's method starts from the extrapolated polynomial of the last step.
    if (fresh_ || rejected) {
      std::fill(Z_trial_.begin(), Z_trial_.end(), 0.0);
    } else {
      for (int i = 0; i < s; ++i) {
        interpolate(1 + tableau_.c[i] * h / h_last_, &Z_trial_[i * n]);
        for (int k = 0; k < n; ++k) Z_trial_[i * n + k] -= y_[k];
      }
      // An extrapolation over more than a scale is a worse start than none.
      if (!(norm(&Z_trial_[(s - 1) * n]) < 1)) std::fill(Z_trial_.begin(), Z_trial_.end(), 0.0);
    }
    // A residual that shorter steps have not reduced may be rounding error of the forces; but where slip is about to
    // jump, every step above rounding error of the time is too long.
    const bool to_rounding = rejections_ >= shortened && h > 4 * rounding * std::abs(t_);
    const Newton newton = solve_stages(t_, y_.data(), h, step_iterations, to_rounding);
    if (newton == Newton::slow || newton == Newton::not_finite) {
      if (attempt == corner_attempt) search_for_corner();
      ++count_.rejected;
      ++rejections_;
      h *= newton == Newton::not_finite ? 0.25 : 0.4;
      rejected = true;
      continue;
    }
    double error = estimate_error(t_, y_.data(), h, rejected && !fresh_);
    if (attempt < kink_attempts && since_kink_ < infinity)
      error = std::max(error, error_beside_kink(h, time_to_kink(h)));
    double factor = safety * std::pow(std::max(error, 1e-12), -1.0 / (s + 1));
    if (!(error <= 1)) {
      ++count_.rejected;
      ++rejections_;
      h = algebra_->longest_step() < h ? algebra_->longest_step()
                                       : h * (std::isfinite(error) ? std::clamp(factor, least_factor, 0.9) : 0.2);
      rejected = true;
      continue;
    }
    // Shorter steps do not reduce rounding error, and its part of the estimate has no trend.
    const bool was_rounded = rounded_;
    rounded_ = newton == Newton::rounded;
    if (attempt == 0 && !rounded_) rejections_ = 0;
    // Predictive control (Gustafsson) uses the trend of the error over two steps.
    if (!fresh_ && error_last_ > 0 && !rounded_ && !was_rounded)
      factor = std::min(factor, factor * (h / h_last_) * std::pow(error_last_ / std::max(error, 1e-12), 1.0 / (s + 1)));
    // After slow convergence of Newton's method the step is not lengthened, or the next one would fail.
    const double manageable = iterations_ >= 8 ? 0.95 : iterations_ >= 6 ? 1.15 : greatest_factor;
    factor = std::clamp(factor, least_factor, rejected ? 1.0 : manageable);
    error_last_ = std::max(error, 1e-3);
    Z_.swap(Z_trial_);
    y_before_ = y_;
    t_before_ = t_;
    algebra_->accept();
    for (int k = 0; k < n; ++k) {
      const double change = Z_[(s - 1) * n + k] + carry_[k];
      y_[k] += change;
      carry_[k] = change - (y_[k] - y_before_[k]);
    }
    time_carry_before_ = time_carry_;
    h_last_ = h;
    if (last)
      t_ = t_limit, time_carry_ = 0;
    else
      advance_time();
    // A step cut by the limit leaves the longer planned one valid.
    h_next_ = last && h_next_ > h ? std::max(h_next_, h * factor) : h * factor;
    if (rounded_) h_next_ = std::max(h_next_, planned);
    fresh_ = false;
    ++count_.steps;
    ended_at_kink_ = false;
    since_kink_ += h;
    return !has_kinks_ || end_at_kink() ? Outcome{} : step(t_limit);
  }
}

/// Beside a singular kink the error of a step is the estimate itself, in tolerances: next to it all of that, farther
/// away a part that falls with the fourth power of the distance over the length, by which the orders of the two differ.
/// \param ahead  s, from the end of the step to the next kink
double Collocation::error_beside_kink(double h, double ahead) const {
  constexpr double rounding_of_estimate = 1e-14;
  const double away = std::min(since_kink_, ahead), part = away > h ? std::pow(h / away, 4) : 1;
  return part * std::max(estimate_ - rounding_of_estimate, 0.0) / tolerance_;
}

/// From the end of the step of length h that is tried to the next kink, at the rate of this step (s).
double Collocation::time_to_kink(double h) {
  system_.kinks(t_, y_.data(), kinks_);
  const std::vector<double> begin = kinks_;
  for (int k = 0; k < n_; ++k) work_[k] = y_[k] + Z_trial_[(s - 1) * n_ + k];
  system_.kinks(t_ + h, work_.data(), kinks_);
  double soonest = infinity;
  for (std::size_t k = 0; k < begin.size(); ++k)
    if (const double rate = (kinks_[k] - begin[k]) / h; kinks_[k] * rate < 0)
      soonest = std::min(soonest, std::abs(kinks_[k] / rate));
  return soonest;
}

/// False where the step must be taken anew, shorter. Ends the step at the first kink in it; the next begins anew there.
/// A step over a kink loses its order, and neither its estimate nor the difference of two tolerances shows the error
/// reliably.
bool Collocation::end_at_kink() {
  constexpr double across = 1e-13;  // above rounding error of a step that ended there
  system_.kinks(t_, y_.data(), kinks_);
  const std::vector<double> end = kinks_;
  double first = infinity;
  std::size_t reached = 0;
  for (std::size_t k = 0; k < end.size(); ++k) {
    double& side = kink_side_[k];
    if (side == 0 && std::abs(end[k]) > across) side = end[k] > 0 ? 1 : -1;
    if (!(side * end[k] < -across)) continue;
    system_.kinks(t_before_, y_before_.data(), kinks_);
    const auto theta = locate(
        [&](double t, const double* y) {
          system_.kinks(t, y, kinks_);
          return kinks_[k];
        },
        0, 1, side * std::max(side * kinks_[k], 0.0), end[k]);
    if (!theta)
      side = 0, fresh_ = true;
    else if (*theta < first)
      first = *theta, reached = k;
  }
  if (first == infinity) return true;
  std::vector<double> there(n_);
  if (since_kink_ < infinity && pieces_ < most_pieces && solve_at(first, there.data())) {
    estimate_error(t_before_, y_before_.data(), first * h_last_, false);
    since_kink_ -= h_last_;
    if (error_beside_kink(first * h_last_, 0) > 1) {
      // A last step too long for what is singular at its end: the way to the kink is taken in shorter ones.
      ++pieces_, ++count_.rejected;
      y_ = y_before_, t_ = t_before_, time_carry_ = time_carry_before_;
      std::fill(carry_.begin(), carry_.end(), 0.0);
      h_next_ = 0.5 * first * h_last_;
      fresh_ = true;
      return false;
    }
  }
  ended_at_kink_ = shorten(first);
  kink_side_[reached] = 0;
  if (since_kink_ < infinity) since_kink_ = 0;
  pieces_ = 0;
  fresh_ = true;
  return true;
}

void Collocation::interpolate(double theta, double* y) const {
  for (int k = 0; k < n_; ++k) y[k] = y_before_[k];
  for (int i = 0; i < s; ++i) {
    double weight = 0;
    for (int k = s - 1; k >= 0; --k) weight = (weight + tableau_.dense[i][k]) * theta;
    for (int k = 0; k < n_; ++k) y[k] += weight * Z_[i * n_ + k];
  }
}

void Collocation::stage(int i, double* y) const {
  for (int k = 0; k < n_; ++k) y[k] = y_before_[k] + Z_[i * n_ + k];
}

void Collocation::rate(double* rate) const {
  for (int k = 0; k < n_; ++k) {
    double sum = 0;
    for (int j = 0; j < s; ++j) sum += tableau_.a_inverse[s - 1][j] * Z_[j * n_ + k];
    rate[k] = sum / h_last_;
  }
}

bool Collocation::solve_at(double theta, double* y) {
  const int n = n_;
  if (theta <= 0 || theta >= 1) {
    const auto& end = theta <= 0 ? y_before_ : y_;
    std::copy(end.begin(), end.end(), y);
    return true;
  }
  const double h = theta * h_last_;
  system_.mass(t_before_, mass_.data());
  interpolate(theta, y);
  // The Jacobian comes from the start of the step, or from theta where Newton's method does not converge with that.
  for (const bool at_start : {true, false}) {
    algebra_->linearise(at_start ? t_before_ : t_before_ + h, at_start ? y_before_.data() : y, f0_.data());
    ++count_.linearisations;
    algebra_->factorise(h, mass_);
    ++count_.factorisations;
    for (int i = 0; i < s; ++i) {
      interpolate(theta * tableau_.c[i], &Z_trial_[i * n]);
      for (int k = 0; k < n; ++k) Z_trial_[i * n + k] -= y_before_[k];
    }
    const Newton newton = solve_stages(t_before_, y_before_.data(), h, patient_iterations);
    const double* change = &Z_trial_[(s - 1) * n];
    for (int k = 0; k < n; ++k) work_[k] = y_before_[k] + change[k] - y[k];
    constexpr double same_solution = 0.1;  // in scales: slow convergence counts if it ends this close to the polynomial
    if (newton == Newton::not_finite || (newton == Newton::slow && !(norm(work_.data()) < same_solution))) continue;
    for (int k = 0; k < n; ++k) y[k] = y_before_[k] + change[k];
    return true;
  }
  return false;
}

/// t_ to the end of the last step, its rounding error to time_carry_.
void Collocation::advance_time() {
  const double change = h_last_ + time_carry_before_;
  t_ = t_before_ + change;
  time_carry_ = change - (t_ - t_before_);
}

bool Collocation::shorten(double theta) {
  if (theta >= 1) return true;
  std::vector<double> y(n_);
  if (!solve_at(theta, y.data())) return false;
  Z_.swap(Z_trial_);
  y_ = y;
  std::fill(carry_.begin(), carry_.end(), 0.0);
  ended_at_kink_ = false;
  h_last_ *= theta;
  advance_time();
  h_next_ = std::max(h_next_, h_last_);
  return true;
}

void Collocation::propagate(std::vector<double>& S, int columns, const Forcing& forcing) {
  // (A⁻¹⊗M/h − J_i) δZ = J_i δy₀ + ∂f/∂p stage by stage, with the exact Jacobians of the converged stages.
  const int n = n_, m = s * n;
  if (m > largest_lu)
    throw InputError(fmt::format("the derivative of steps is known up to {} unknowns, not of {}", largest_lu / s, n));
  big_.assign(m * m, 0.0);
  big_right_.assign(m * columns, 0.0);
  big_pivot_.resize(m);
  J_stage_.resize(n * n);
  for (int i = 0; i < s; ++i) {
    const double t = stage_time(i);
    // At a kink the slopes are taken on the side of the step.
    constexpr double before_kink = 1 - 1e-7;
    if (ended_at_kink_ && i == s - 1)
      interpolate(before_kink, work_.data());
    else
      stage(i, work_.data());
    system_.linearise(t, work_.data(), f_stage_.data(), J_stage_.data());
    system_.mass(t, &stage_mass_[i * n]);
    if (forcing) forcing(t, work_.data(), &big_right_[i * n * columns]);
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < s; ++j)
        big_[(i * n + k) * m + j * n + k] += tableau_.a_inverse[i][j] * stage_mass_[i * n + k] / h_last_;
      for (int l = 0; l < n; ++l) {
        big_[(i * n + k) * m + i * n + l] -= J_stage_[k * n + l];
        for (int c = 0; c < columns; ++c)
          big_right_[(i * n + k) * columns + c] += J_stage_[k * n + l] * S[l * columns + c];
      }
    }
  }
  count_.linearisations += s;
  if (!factorise_lu(big_, big_pivot_, m)) {
    std::fill(S.begin(), S.end(), NAN);
    return;
  }
  solve_lu(big_, big_pivot_, m, big_right_.data(), columns);
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < columns; ++c) S[k * columns + c] += big_right_[((s - 1) * n + k) * columns + c];
}

}  // namespace rosin::solvers::steps
