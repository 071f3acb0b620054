/// The search for the fixed point of the onset map: plain periods, extrapolation from them, and Newton's method.
#include "analysis/cycles/onset_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "analysis/cycles/multipliers.hpp"
#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The iteration to the fixed point of the onset map. Plain periods converge to an attracting one; extrapolation from
/// several (Anderson mixing) gets there sooner. Many slow states, such as the temperatures of deep layers, converge one
/// after the other; a step of Newton's method moves all of them at once, and the fast states follow within a few
/// periods. After repeated failures of the extrapolation Newton's method is tried earlier.
class OnsetMap::OnsetSearch {
 public:
  OnsetSearch(OnsetMap& map, VectorXd onset) : map_(map), z_(std::move(onset)) {}

  /// Where the next period begins.
  const VectorXd& onset() const { return z_; }
  /// True if the onset comes from an extrapolation or a Newton step that has not yet been judged.
  bool extrapolated() const { return extrapolated_at_ >= 0 || k_ <= newton_judged_at_; }
  /// True once a Newton step has been taken and kept.
  bool used_newton() const { return newton_judged_at_ >= 0; }

  /// Takes the onset that ends the period.
  void add(const VectorXd& image) {
    onsets_.push_back(z_), changes_.push_back(image - z_);
    now_ = map_.size_of_step(changes_.back(), z_);
    extrapolation_ = accelerated();
    // Changes before and after an extrapolation are not comparable.
    comparable_ = std::min<std::size_t>(onsets_.size(), k_ - last_extrapolation_);
    scatters_ = scatter_in(std::span(changes_).last(comparable_));
    if (now_ < 0.5 * nearest_) nearest_ = now_, nearest_at_ = k_;
    converges_slowly_ = k_ > 3 && now_ < 1e3 * resolution() && !(now_ < 0.5 * change_);
    settled_ = now_ < 10 * resolution() || converges_slowly_;
    // Changes that alternate without shrinking have reached rounding error.
    stagnates_ = k_ - nearest_at_ >= 2 * patience && now_ < 100 * nearest_ && !extrapolated() && scatters_;
  }
  /// True if `period`, the last one, is as close to the fixed point as plain periods come.
  bool has_converged(const StickSlipPeriod& period) const {
    // States that measure the time at rest scatter with the times at which slip stops, and states that have nearly
    // decayed scatter with the rounding error of their first values. The metrics of two such periods then show the
    // remaining error.
    const bool unshaken = now_ < 10 * closest_;  // by an extrapolation
    return settled_ || std::max(now_, change_) < 3 * map_.scatter(period) || (unshaken && changes_cancel()) ||
           stagnates_;
  }
  /// Remaining relative distance to the fixed point, where metrics `changed` by this in the last period.
  double remaining_distance(double changed) const {
    if (!settled_) return 10 * changed;
    // Metrics may change by more than the states, as stick that ends the sooner the hotter the contact is.
    const double moved = onsets_.size() > 1 ? map_.size_of_step(z_ - onsets_.end()[-2], z_) : infinity;
    return (moved > 0 ? std::max(changed / moved, 1.0) : 1) * distance_left();
  }
  /// True if plain periods may have stalled short of the fixed point.
  bool may_have_stalled() const {
    constexpr double many = 1e3;  // periods to the fixed point; beyond this the estimate may be rounding error
    return map_.kind_ == Onset::reversed || converges_slowly_ || stagnates_ ||
           (settled_ && distance_left() > many * now_);
  }
  /// Relative accuracy of the states, at best.
  double resolution() const { return std::max(map_.tolerance_, 1e-14); }
  /// Number of slips, two or more, after which the slips repeat: a period holds that many. Else 1.
  int slips_in_pattern() const {
    constexpr std::size_t enough = 8, most = 8;
    constexpr double alike = 1e-3, apart = 1e-3;
    const auto last = std::span(onsets_).last(comparable_);
    const VectorXd image = z_ + changes_.back();
    for (std::size_t n = 2; n <= most && last.size() >= enough + n && now_ > apart; ++n)
      if (map_.size_of_step(image - last[last.size() - n], image) < alike * now_) return int(n);
    return 1;
  }
  bool wants_newton() const { return k_ >= newton_at_ && k_ > newton_judged_at_ && !scatters_; }

  /// Takes Newton's step. Where there is none, the next attempt is 24 periods later and a plain period follows.
  void take_newton_step(const std::optional<VectorXd>& step) {
    if (!step) {
      newton_at_ = k_ + patience;
      return next_period();
    }
    keep_best();
    onsets_.clear(), changes_.clear();
    z_ += *step;
    change_ = infinity;
    extrapolated_at_ = -1;
    newton_judged_at_ = k_ + 1 + grace;
    newton_at_ = newton_judged_at_ + plain;
    ++k_;
  }
  /// Continues from the end of the last period, or from an extrapolation.
  void next_period() {
    // Fast states recover from an extrapolation within a few periods.
    const bool farther = now_ > 2 * closest_, waits = extrapolated_at_ >= 0 && k_ <= extrapolated_at_ + grace;
    if (farther && !waits && (extrapolated_at_ >= 0 || k_ == newton_judged_at_)) {
      restore_best();
    } else {
      if (!farther) extrapolated_at_ = -1;
      keep_best();
      constexpr double converging = 1 - 1e-7;
      const bool extrapolates = extrapolated_at_ < 0 && k_ > plain_periods_until_ && k_ > newton_judged_at_ &&
                                std::max(now_ / change_, change_ / change_before_) < converging;
      if (extrapolates) extrapolated_at_ = last_extrapolation_ = k_;
      z_ += extrapolates ? extrapolation_ : changes_.back();
    }
    change_before_ = change_;
    change_ = now_;
    ++k_;
  }
  /// Returns to the best onset so far, after an extrapolation to states from which slip never comes to rest.
  void return_to_best() {
    restore_best();
    if (constexpr int most_failures = 5; failures_ > most_failures) plain_periods_until_ = most_periods;
    ++k_;
  }
  /// Restarts at `onset`, with another number of slips in a period.
  void restart(const VectorXd& onset) {
    z_ = onset;
    onsets_.clear(), changes_.clear();
    closest_ = change_ = infinity;
    ++k_;
  }
  const VectorXd& change() const { return changes_.back(); }
  bool goes_on() const { return k_ < most_periods; }

 private:
  static constexpr int most_periods = 400, plain = 6, patience = 24, grace = 4;

  double distance_left() const { return std::max(now_, map_.size_of_step(extrapolation_, z_)); }
  void keep_best() {
    if (now_ < closest_) closest_ = now_, closest_image_ = z_ + changes_.back();
  }
  void restore_best() {
    constexpr int again = 2;
    onsets_.clear(), changes_.clear();
    z_ = closest_image_;
    const bool used_newton = k_ <= newton_judged_at_;
    plain_periods_until_ = k_ + ++failures_ * plain;
    if (used_newton || failures_ >= again) newton_at_ = k_ + (used_newton ? patience : plain);
    extrapolated_at_ = newton_judged_at_ = -1;
  }
  /// Anderson mixing: the step from the last onset to the fixed point, extrapolated from the last periods and limited
  /// to half of each state.
  VectorXd accelerated() const {
    constexpr std::size_t depth = 6;
    const VectorXd z = onsets_.back(), step = changes_.back(), sizes = map_.sizes_at(z);
    const std::size_t m = std::min({depth, onsets_.size() - 1, std::size_t(z.size())});
    if (m == 0) return step;
    MatrixXd moved(z.size(), m), differed(z.size(), m);
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t at = onsets_.size() - 1 - i;
      moved.col(i) = (onsets_[at] - onsets_[at - 1]).cwiseQuotient(sizes);
      differed.col(i) = (changes_[at] - changes_[at - 1]).cwiseQuotient(sizes);
    }
    const VectorXd share = least_squares(differed, step.cwiseQuotient(sizes));
    VectorXd extrapolation = step - ((moved + differed) * share).cwiseProduct(sizes);
    if (!extrapolation.allFinite()) return step;
    const auto farthest = [&](const VectorXd& d) { return d.cwiseQuotient(sizes).cwiseAbs().maxCoeff(); };
    constexpr double most = 0.5;
    // Changes that differ by rounding error alone, as where heat only accumulates, give a random direction.
    if (extrapolation.cwiseQuotient(sizes).dot(step.cwiseQuotient(sizes)) < 0)
      extrapolation = step * (most / farthest(step));
    return farthest(extrapolation) > most ? VectorXd(extrapolation * (most / farthest(extrapolation))) : extrapolation;
  }
  /// True if the last changes cancel in their sum, as rounding error does and slow convergence does not.
  bool scatter_in(std::span<const VectorXd> changes) const {
    constexpr std::size_t few = 3, most = 6;
    if (changes.size() < few) return false;
    VectorXd sum = VectorXd::Zero(z_.size());
    double sizes = 0;
    for (const auto& change : changes.last(std::min(most, changes.size())))
      sum += change, sizes += map_.size_of_step(change, z_);
    return map_.size_of_step(sum, z_) < 0.5 * sizes;
  }
  /// True if the small changes of the last periods have cancelled, which slow changes of one sign would not.
  bool changes_cancel() const {
    constexpr std::size_t periods = 8;
    constexpr double small = 1e-2, nowhere = 3;
    if (onsets_.size() < periods) return false;
    double largest = 0, farthest = 0;
    for (std::size_t i = onsets_.size() - periods; i < onsets_.size(); ++i) {
      largest = std::max(largest, map_.size_of_step(changes_[i], onsets_[i]));
      farthest = std::max(farthest, map_.size_of_step(onsets_.back() - onsets_[i], onsets_.back()));
    }
    return largest < small && farthest < nowhere * map_.size_of_step(changes_.back(), onsets_.back());
  }

  OnsetMap& map_;
  VectorXd z_;
  std::vector<VectorXd> onsets_, changes_;                         ///< in the last periods, since the last restart
  int k_ = 0;                                                      ///< number of the period that starts at z
  double now_ = 0, change_ = infinity, change_before_ = infinity;  ///< relative changes in the last three periods
  VectorXd extrapolation_;                                         ///< step to the extrapolated fixed point
  std::size_t comparable_ = 0;                                     ///< number of periods since an extrapolation
  bool scatters_ = false, converges_slowly_ = false, settled_ = false, stagnates_ = false;
  double closest_ = infinity;  ///< smallest change of a period since the last restart
  VectorXd closest_image_;     ///< the onset at the end of that period
  double nearest_ = infinity;  ///< smallest change so far
  int nearest_at_ = 0;
  int extrapolated_at_ = -1;     ///< period before an extrapolation that has not yet reduced the change
  int last_extrapolation_ = -1;  ///< period before the last extrapolation
  int plain_periods_until_ = plain - 1, failures_ = 0;
  int newton_at_ = patience - 1;  ///< period after which Newton's method is next tried
  int newton_judged_at_ = -1;     ///< period by which its step must have reduced the change
};

OnsetMap::OnsetMap(const Model& model, double tolerance, double stick_threshold, Onset kind, int slips)
    : model_(model),
      system_(model),
      tolerance_(tolerance),
      stick_threshold_(stick_threshold),
      kind_(kind),
      slips_(slips) {
  std::vector<double> s(system_.size());
  const std::vector<double> rest(system_.size());
  system_.scale(rest.data(), s.data());
  if (kind == Onset::reversed) {
    mapped_.push_back(displacement);
    s[displacement] = model.drive.speed.level() * std::sqrt(model.slider.mass / model.slider.stiffness);
  }
  for (int i = mechanical; i < system_.size(); ++i) mapped_.push_back(i);
  scale_ = gather(s);
}

StickSlipPeriod OnsetMap::cycle(const std::vector<double>* reversed) {
  auto period = stick_slip_period(model_, tolerance_, stick_threshold_, reversed, 1, kind_);
  if (!period.found || scale_.size() == 0) return period;  // without memory, stick forgets the past
  long steps = period.steps, evaluations = period.evaluations;
  constexpr long most_steps = longest_period;
  OnsetSearch search(*this, gather(period.onset));
  while (search.goes_on() && steps < most_steps) {
    constexpr long alike = 20, few = 1000;  // steps: a period with many more is another motion
    StickSlipPeriod next = period_from(search.onset(), search.extrapolated() ? alike * period.steps + few : most_steps);
    steps += next.steps, evaluations += next.evaluations;
    if (!next.found && search.extrapolated()) {
      search.return_to_best();
      continue;
    }
    const Metrics before = std::exchange(period, std::move(next)).metrics;
    if (!period.found) return period;
    search.add(gather(period.onset));
    if (search.has_converged(period)) {
      if (reduce_to_fewer_slips(search.onset(), 1e3 * search.resolution())) {
        search.restart(search.onset());
        continue;
      }
      const double remaining = search.remaining_distance(largest_change(before, period.metrics));
      if (search.may_have_stalled())
        period = refined_by_newton(std::move(period), search.onset(), remaining, steps, evaluations);
      else
        period.closure += remaining;
      period.steps = steps, period.evaluations = evaluations, period.slips = slips_;
      period.used_newton = search.used_newton();
      return period;
    }
    if (const int kinds = slips_ == 1 ? search.slips_in_pattern() : 1; kinds > 1) {
      slips_ = kinds;
      search.restart(search.onset() + search.change());
    } else if (search.wants_newton()) {
      steps += 2 * scale_.size() * period.steps;  // about
      search.take_newton_step(newton_step(search.onset(), search.change()));
    } else {
      search.next_period();
    }
  }
  period.found = false;
  period.outcome = {Ending::budget_spent, "stick and slip do not come to repeat themselves"};
  return period;
}

std::vector<std::complex<double>> OnsetMap::multipliers(const std::vector<double>& onset, double share) const {
  if (scale_.size() == 0) return {0.0};
  const MatrixXd D = derivative(gather(onset), share);
  if (!D.allFinite()) return {};
  return by_modulus(D);
}

VectorXd OnsetMap::gather(const std::vector<double>& y) const {
  VectorXd z(mapped_.size());
  for (std::size_t k = 0; k < mapped_.size(); ++k) z[k] = y[mapped_[k]];
  return z;
}

VectorXd OnsetMap::sizes_at(const VectorXd& z) const {
  VectorXd sizes = z.cwiseAbs().cwiseMax(1e-12 * scale_);
  if (kind_ == Onset::reversed) sizes[0] = scale_[0];
  return sizes;
}

double OnsetMap::size_of_step(const VectorXd& step, const VectorXd& z) const {
  return step.cwiseQuotient(sizes_at(z)).norm();
}

double OnsetMap::scatter(const StickSlipPeriod& period) {
  std::vector<double> f(system_.size()), mass(system_.size());
  system_.set_mode(0, ContactMode::stick);
  system_.evaluate(0, period.onset.data(), f.data());
  system_.mass(0, mass.data());
  system_.set_mode(0, ContactMode::forward);
  VectorXd error(scale_.size());
  for (int k = 0; k < error.size(); ++k) error[k] = period.stop_time_error * f[mapped_[k]] / mass[mapped_[k]];
  return size_of_step(error, gather(period.onset));
}

double OnsetMap::largest_change(const Metrics& a, const Metrics& b) const {
  double largest = 0;
  for (const auto& metric : metric_names())
    largest = std::max(largest,
                       std::abs(a.*metric.member - b.*metric.member) / size_of(metric, b, model_.drive.speed.level()));
  return largest;
}

StickSlipPeriod OnsetMap::period_from(const VectorXd& z, long most_steps) const {
  std::vector<double> onset(system_.size());
  for (std::size_t k = 0; k < mapped_.size(); ++k) onset[mapped_[k]] = z[k];
  if (kind_ == Onset::held) onset = system_.loaded_at_rest(system_.observe(0, onset.data()).state, 1);
  return stick_slip_period(model_, tolerance_, stick_threshold_, &onset, slips_, kind_, most_steps);
}

MatrixXd OnsetMap::derivative(const VectorXd& z, double share) const {
  const int n = int(z.size());
  MatrixXd D = MatrixXd::Zero(n, n), unknown = MatrixXd::Constant(n, n, std::nan(""));
  const double part = share * std::max(1e-4, 100 * tolerance_);
  constexpr long most_steps = 400'000;
  long steps = 0;
  for (int k = 0; k < n; ++k) {
    const double h = part * sizes_at(z)[k];
    const auto right = period_from(z + h * VectorXd::Unit(n, k)), left = period_from(z - h * VectorXd::Unit(n, k));
    steps += right.steps + left.steps;
    if (!right.found || !left.found || steps > most_steps) return unknown;
    D.col(k) = (gather(right.onset) - gather(left.onset)) / (2 * h);
  }
  return D;
}

std::optional<VectorXd> OnsetMap::newton_step(const VectorXd& z, const VectorXd& step) const {
  const VectorXd sizes = sizes_at(z);
  const MatrixXd D = sizes.cwiseInverse().asDiagonal() * derivative(z) * sizes.asDiagonal();
  if (!D.allFinite()) return std::nullopt;
  VectorXd extrapolation = solve_linear(MatrixXd::Identity(z.size(), z.size()) - D, step.cwiseQuotient(sizes));
  if (!extrapolation.allFinite()) return std::nullopt;
  constexpr double most = 0.5;
  extrapolation = extrapolation.cwiseMax(-most);
  return VectorXd(extrapolation.cwiseProduct(sizes));
}

StickSlipPeriod OnsetMap::refined_by_newton(StickSlipPeriod period, VectorXd z, double without_newton, long& steps,
                                            long& evaluations) const {
  constexpr double farthest = 0.5, rounding = 1e-15;
  double left = infinity, times = 1;  // distance to the fixed point; change of the metrics over change of the states
  while (const auto step = newton_step(z, gather(period.onset) - z)) {
    steps += 2 * z.size() * period.steps;  // about
    const double length = size_of_step(*step, z);
    const bool halves = length < std::min(0.5 * left, farthest);
    left = std::min(length, left);
    if (!halves || left < rounding) break;
    auto next = period_from(z + *step);
    steps += next.steps, evaluations += next.evaluations;
    if (!next.found) break;
    times = std::max(times, largest_change(period.metrics, next.metrics) / length);
    z += *step;
    period = std::move(next);
  }
  period.closure += left < infinity ? times * left : without_newton;
  return period;
}

bool OnsetMap::reduce_to_fewer_slips(const VectorXd& z, double same) {
  const int all = slips_;
  for (slips_ = 1; slips_ < all; ++slips_) {
    if (all % slips_ != 0) continue;
    const auto period = period_from(z);
    if (period.found && size_of_step(gather(period.onset) - z, z) < same) return true;
  }
  slips_ = all;
  return false;
}

}  // namespace rosin::analysis::cycles
