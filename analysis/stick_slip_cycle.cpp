/// The map of a contact's states from onset to onset of slip, its fixed point, and slip without stick.
#include "analysis/stick_slip_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "analysis/curve.hpp"
#include "analysis/dry_cycle.hpp"
#include "analysis/exact_run.hpp"
#include "analysis/refinement.hpp"
#include "analysis/return_map.hpp"
#include "analysis/slow_swing.hpp"
#include "analysis/stability.hpp"
#include "analysis/stick_slip_period.hpp"
#include "core/eigenpairs.hpp"
#include "solvers/stick_slip.hpp"

namespace rosin::analysis {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using oscillators::SliderSystem;

namespace {

/// The return from onset to onset of slip, about the fixed point that periods from stick lead to: of the contact's
/// states where stick has loaded it to its limit; also of the displacement where slip reverses.
class OnsetMap {
 public:
  OnsetMap(const Model& model, double tolerance, double stick_threshold, Onset kind, int slips = 1)
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
      returning_.push_back(displacement);
      s[displacement] = model.drive.speed.level() * std::sqrt(model.slider.mass / model.slider.stiffness);
    }
    for (int i = mechanical; i < system_.size(); ++i) returning_.push_back(i);
    scale_ = gather(s);
  }

  /// The period that repeats itself, beginning with one from rest, or from where slip has turned to go along the drive.
  StickSlipPeriod cycle(const std::vector<double>* reversed = nullptr) {
    auto period = stick_slip_period(model_, tolerance_, stick_threshold_, reversed, 1, kind_);
    if (!period.found || scale_.size() == 0) return period;  // without memory stick forgets the past
    long steps = period.steps, evaluations = period.evaluations;
    constexpr int most_periods = 400;
    constexpr long most_steps = longest_period;
    VectorXd z = gather(period.onset);
    std::vector<VectorXd> onsets, changes;  // of the last periods, as long as they belong together
    double change = infinity, change_before = infinity, closest = infinity;
    VectorXd closest_image;
    int leapt_at = -1;   ///< the period before a leap that has not led closer yet
    int last_leap = -1;  ///< the period before it
    // Plain periods lead to what attracts; where they come in, what they have in common leads there faster.
    constexpr int plain = 6, most_strays = 5;
    int plain_until = plain - 1, strays = 0;
    // Many slow states, such as the temperatures of deep layers, come in one after the other; Newton's method turns
    // them all at once, and the fast ones follow within a few periods. Where leaps lead astray again and again it is
    // not waited for so long.
    constexpr int patience = 24, grace = 4, again = 2;
    int turn_at = patience - 1;  ///< the period after which it is next asked
    int judged_at = -1;          ///< the period by which it must have led closer
    // What neither leads closer, and changes to and fro, is as close as rounding lets it come.
    double nearest = infinity;
    int nearest_at = 0;
    const auto go_back = [&](int k) {
      onsets.clear(), changes.clear();
      z = closest_image;
      const bool turned = k <= judged_at;
      plain_until = k + ++strays * plain;
      if (turned || strays >= again) turn_at = k + (turned ? patience : plain);
      leapt_at = judged_at = -1;
    };
    for (int k = 0; k < most_periods && steps < most_steps && period.found; ++k) {
      const Metrics before = period.metrics;
      const bool led = leapt_at >= 0 || k <= judged_at;
      constexpr long alike = 20, few = 1000;  // steps: a period that takes many more is of another kind
      StickSlipPeriod next = period_from(z, led ? alike * period.steps + few : most_steps);
      steps += next.steps, evaluations += next.evaluations;
      if (!next.found && led) {
        // Beyond where slip comes to rest, to which periods by themselves may never lead.
        go_back(k);
        if (strays > most_strays) plain_until = most_periods;
        continue;
      }
      period = std::move(next);
      if (!period.found) break;
      const VectorXd step = gather(period.onset) - z;
      const double now = size_of_step(step, z);
      onsets.push_back(z), changes.push_back(step);
      const VectorXd onward = accelerated(onsets, changes);
      const double known = std::max(tolerance_, 1e-14);  // no state is known better
      const bool comes_in_slowly = k > 3 && now < 1e3 * known && !(now < 0.5 * change);
      const bool settled = now < 10 * known || comes_in_slowly;
      if (now < 0.5 * nearest) nearest = now, nearest_at = k;
      // Onsets before a leap say nothing of those after it.
      const std::size_t together = std::min<std::size_t>(onsets.size(), k - last_leap);
      const bool scatters = scatter_in(std::span(changes).last(together), z);
      const bool no_nearer = k - nearest_at >= 2 * patience && now < 100 * nearest && !led && scatters;
      // States that count the time at rest scatter as the times at which slip stops, and what has all but decayed as
      // the rounding of what it came from. Then the metrics of two periods that both do show what is left.
      const bool unshaken = now < 10 * closest;  // by a leap
      if (settled || std::max(now, change) < 3 * scatter(period) || (unshaken && go_nowhere(onsets, changes)) ||
          no_nearer) {
        if (fewer_slips_do(z, 1e3 * known)) {
          onsets.clear(), changes.clear();
          closest = change = infinity;
          continue;
        }
        // Metrics may change by more than states do, as stick does that ends the sooner the hotter the contact is.
        const double changed = largest_change(before, period.metrics);
        const double moved = onsets.size() > 1 ? size_of_step(z - onsets.end()[-2], z) : infinity;
        const double times = moved > 0 ? std::max(changed / moved, 1.0) : 1;
        const double away = std::max(now, size_of_step(onward, z)), open = settled ? times * away : 10 * changed;
        constexpr double many = 1e3;  // periods from what repeats itself, or rounding says so
        if (kind_ == Onset::reversed || comes_in_slowly || no_nearer || (settled && away > many * now))
          period = closer(std::move(period), z, open, steps, evaluations);
        else
          period.closure += open;
        period.steps = steps, period.evaluations = evaluations, period.slips = slips_;
        period.turned = judged_at >= 0;
        return period;
      }
      if (slips_ == 1 && alternate(std::span(onsets).last(together), z + step, now)) {
        onsets.clear(), changes.clear();
        closest = change = infinity;
        z += step;
        continue;
      }
      constexpr double comes_in = 1 - 1e-7;
      if (k >= turn_at && k > judged_at && !scatters) {
        steps += 2 * z.size() * period.steps;  // about
        if (const auto turn = newton_step(z, step)) {
          if (now < closest) closest = now, closest_image = z + step;
          onsets.clear(), changes.clear();
          z += *turn;
          change = infinity;
          leapt_at = -1;
          judged_at = k + 1 + grace;
          turn_at = judged_at + plain;
          continue;
        }
        turn_at = k + patience;
      }
      // What a leap does to fast states is gone within a few periods.
      const bool farther = now > 2 * closest, waits = leapt_at >= 0 && k <= leapt_at + grace;
      if (farther && !waits && (leapt_at >= 0 || k == judged_at)) {
        go_back(k);
      } else {
        if (!farther) leapt_at = -1;
        if (now < closest) closest = now, closest_image = z + step;
        const bool leaps = leapt_at < 0 && k > plain_until && k > judged_at &&
                           std::max(now / change, change / change_before) < comes_in;
        if (leaps) leapt_at = last_leap = k;
        z += leaps ? onward : step;
      }
      change_before = change;
      change = now;
    }
    if (period.found) {
      period.found = false;
      period.outcome = {Ending::budget_spent, "stick and slip do not come to repeat themselves"};
    }
    return period;
  }

  /// Multipliers of the period that ends, and so begins, at `onset`, largest first; none where neighbouring periods
  /// do not return.
  std::vector<std::complex<double>> multipliers(const std::vector<double>& onset) const {
    if (scale_.size() == 0) return {0.0};
    const MatrixXd D = derivative(gather(onset));
    if (!D.allFinite()) return {};
    const auto found = eigenpairs(D).values;
    std::vector<std::complex<double>> values(found.data(), found.data() + found.size());
    std::sort(values.begin(), values.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
    return values;
  }

 private:
  static constexpr int displacement = 0, mechanical = 2;
  VectorXd gather(const std::vector<double>& y) const {
    VectorXd z(returning_.size());
    for (std::size_t k = 0; k < returning_.size(); ++k) z[k] = y[returning_[k]];
    return z;
  }
  /// States are measured by themselves: a time at rest may be small or large beside its natural size.
  VectorXd sizes_at(const VectorXd& z) const {
    VectorXd sizes = z.cwiseAbs().cwiseMax(1e-12 * scale_);
    if (kind_ == Onset::reversed) sizes[0] = scale_[0];
    return sizes;
  }
  double size_of_step(const VectorXd& step, const VectorXd& z) const { return step.cwiseQuotient(sizes_at(z)).norm(); }
  /// The way from the last onset to the one that repeats itself: Anderson mixing of the last periods, and no farther
  /// than half of what each state is.
  VectorXd accelerated(const std::vector<VectorXd>& onsets, const std::vector<VectorXd>& changes) const {
    constexpr std::size_t depth = 6;
    const VectorXd z = onsets.back(), step = changes.back(), sizes = sizes_at(z);
    const std::size_t m = std::min({depth, onsets.size() - 1, std::size_t(z.size())});
    if (m == 0) return step;
    MatrixXd moved(z.size(), m), differed(z.size(), m);
    for (std::size_t i = 0; i < m; ++i) {
      const std::size_t at = onsets.size() - 1 - i;
      moved.col(i) = (onsets[at] - onsets[at - 1]).cwiseQuotient(sizes);
      differed.col(i) = (changes[at] - changes[at - 1]).cwiseQuotient(sizes);
    }
    const VectorXd share = differed.colPivHouseholderQr().solve(step.cwiseQuotient(sizes));
    VectorXd onward = step - ((moved + differed) * share).cwiseProduct(sizes);
    if (!onward.allFinite()) return step;
    const auto farthest = [&](const VectorXd& way) { return way.cwiseQuotient(sizes).cwiseAbs().maxCoeff(); };
    constexpr double most = 0.5;
    // Changes that differ by rounding alone, as where heat only adds up, point anywhere.
    if (onward.cwiseQuotient(sizes).dot(step.cwiseQuotient(sizes)) < 0) onward = step * (most / farthest(step));
    return farthest(onward) > most ? VectorXd(onward * (most / farthest(onward))) : onward;
  }
  /// From z, where a period changes the states by `step`, to where Newton's method has none change. Nothing where
  /// neighbouring periods do not return.
  std::optional<VectorXd> newton_step(const VectorXd& z, const VectorXd& step) const {
    const VectorXd sizes = sizes_at(z);
    const MatrixXd D = sizes.cwiseInverse().asDiagonal() * derivative(z) * sizes.asDiagonal();
    if (!D.allFinite()) return std::nullopt;
    VectorXd onward = (MatrixXd::Identity(z.size(), z.size()) - D).partialPivLu().solve(step.cwiseQuotient(sizes));
    if (!onward.allFinite()) return std::nullopt;
    constexpr double most = 0.5;
    onward = onward.cwiseMax(-most);
    return VectorXd(onward.cwiseProduct(sizes));
  }
  /// What a period hardly forgets, such as a reversal, is far from where it repeats itself although nothing shows in a
  /// period. From one that begins at z to that, by Newton's method for as long as that halves the way. What is left of
  /// it counts as open; where neighbouring periods do not return, `open`.
  StickSlipPeriod closer(StickSlipPeriod period, VectorXd z, double open, long& steps, long& evaluations) const {
    constexpr double farthest = 0.5, last_digits = 1e-15;
    double way = infinity, times = 1;  // what is left; and by how much more metrics change
    while (const auto turn = newton_step(z, gather(period.onset) - z)) {
      steps += 2 * z.size() * period.steps;  // about
      const double left = size_of_step(*turn, z);
      const bool leads = left < std::min(0.5 * way, farthest);
      way = std::min(left, way);
      if (!leads || way < last_digits) break;
      auto next = period_from(z + *turn);
      steps += next.steps, evaluations += next.evaluations;
      if (!next.found) break;
      times = std::max(times, largest_change(period.metrics, next.metrics) / left);
      z += *turn;
      period = std::move(next);
    }
    period.closure += way < infinity ? times * way : open;
    return period;
  }
  /// True if the changes of the last periods do not add up, as those of slow states would: rounding makes them.
  bool scatter_in(std::span<const VectorXd> changes, const VectorXd& z) const {
    constexpr std::size_t few = 3, most = 6;
    if (changes.size() < few) return false;
    VectorXd sum = VectorXd::Zero(z.size());
    double sizes = 0;
    for (const auto& change : changes.last(std::min(most, changes.size())))
      sum += change, sizes += size_of_step(change, z);
    return size_of_step(sum, z) < 0.5 * sizes;
  }
  /// True if small changes of the last periods have not led away from where they began, as slow ones of one sign do.
  bool go_nowhere(const std::vector<VectorXd>& onsets, const std::vector<VectorXd>& changes) const {
    constexpr std::size_t periods = 8;
    constexpr double small = 1e-2, nowhere = 3;
    if (onsets.size() < periods) return false;
    double largest = 0, farthest = 0;
    for (std::size_t i = onsets.size() - periods; i < onsets.size(); ++i) {
      largest = std::max(largest, size_of_step(changes[i], onsets[i]));
      farthest = std::max(farthest, size_of_step(onsets.back() - onsets[i], onsets.back()));
    }
    return largest < small && farthest < nowhere * size_of_step(changes.back(), onsets.back());
  }
  /// True if slips of two kinds or more follow each other by turns: a period then holds as many. `change`: from the
  /// last onset to z.
  bool alternate(std::span<const VectorXd> onsets, const VectorXd& z, double change) {
    constexpr std::size_t settled = 8, most = 8;
    constexpr double alike = 1e-3, apart = 1e-3;
    for (std::size_t n = 2; n <= most && onsets.size() >= settled + n && change > apart; ++n)
      if (size_of_step(z - onsets[onsets.size() - n], z) < alike * change) {
        slips_ = int(n);
        return true;
      }
    return false;
  }
  /// True if slips that were taken for several kinds, on the way to the cycle, are one and the same there.
  bool fewer_slips_do(const VectorXd& z, double same) {
    const int all = slips_;
    for (slips_ = 1; slips_ < all; ++slips_) {
      if (all % slips_ != 0) continue;
      const auto period = period_from(z);
      if (period.found && size_of_step(gather(period.onset) - z, z) < same) return true;
    }
    slips_ = all;
    return false;
  }
  /// Of the states at the onset that ends a period.
  double scatter(const StickSlipPeriod& period) {
    std::vector<double> f(system_.size()), mass(system_.size());
    system_.set_direction(0);
    system_.evaluate(0, period.onset.data(), f.data());
    system_.mass(0, mass.data());
    system_.set_direction(1);
    VectorXd open(scale_.size());
    for (int k = 0; k < open.size(); ++k) open[k] = period.landing * f[returning_[k]] / mass[returning_[k]];
    return size_of_step(open, gather(period.onset));
  }
  double largest_change(const Metrics& a, const Metrics& b) const {
    double largest = 0;
    for (const auto& metric : metric_names())
      largest = std::max(
          largest, std::abs(a.*metric.member - b.*metric.member) / size_of(metric, b, model_.drive.speed.level()));
    return largest;
  }
  StickSlipPeriod period_from(const VectorXd& z, long most_steps = longest_period) const {
    std::vector<double> onset(system_.size());
    for (std::size_t k = 0; k < returning_.size(); ++k) onset[returning_[k]] = z[k];
    if (kind_ == Onset::held) onset = system_.loaded_at_rest(system_.observe(0, onset.data()).state, 1);
    return stick_slip_period(model_, tolerance_, stick_threshold_, &onset, slips_, kind_, most_steps);
  }
  /// Not finite where neighbouring periods do not return, or would take too long.
  MatrixXd derivative(const VectorXd& z) const {
    const int n = int(z.size());
    MatrixXd D = MatrixXd::Zero(n, n), unknown = MatrixXd::Constant(n, n, std::nan(""));
    const double part = std::max(1e-4, 100 * tolerance_);
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

  const Model& model_;
  SliderSystem system_;
  double tolerance_, stick_threshold_;
  Onset kind_;
  int slips_;                   ///< in a period
  std::vector<int> returning_;  ///< unknowns that a period maps
  VectorXd scale_;              ///< of these
};

/// A passage of slip, which may reverse but does not stick for long, from v = V rising at a displacement `swing` above
/// that of steady sliding to the next such passage. Two mechanical unknowns, so the section is a line.
StickSlipPeriod slip_passage(const Model& model, double swing, double tolerance, double stick_threshold, bool record) {
  StickSlipPeriod result;
  SliderSystem system(model);
  solvers::StickSlip solver(system, tolerance);
  const auto steady = steady_sliding(model);
  const double V = model.drive.speed.level(), x_steady = steady.displacement;
  SwingWork work(system, steady.friction_force);
  const double natural = 2 * std::numbers::pi * std::sqrt(model.slider.mass / model.slider.stiffness);
  solver.bound_slip_step(0.1 * natural);
  if (!solver.start(0, system.unknowns_at(0, x_steady + swing, V, {}, 0))) {
    result.outcome = {Ending::not_finite, "at the start"};
    return result;
  }
  Recorder recorder(system, tolerance, stick_threshold, true);
  const auto section = [&](double t, const double* y) { return system.slip_rate(t, y) - V; };
  const double longest = 100 * natural + 10 * std::abs(system.loaded_at_rest({}, 1)[0]) / V;
  bool below = false;
  double period = 0, stuck = 0;
  std::vector<double> y(system.size());
  while (!result.found && solver.time() < longest && solver.stepper().count().steps < 5'000) {
    solvers::Switch switched;
    result.outcome = solver.step(longest, switched);
    if (!result.outcome.complete()) break;
    auto& step = solver.stepper();
    double low = 0, low_value = section(step.time_before(), step.state_before().data());
    for (int i = 0; i < solvers::Collocation::stages; ++i) {
      step.stage(i, y.data());
      const double value = section(step.stage_time(i), y.data());
      if (below && value >= 0) {
        const auto located = step.locate(section, low, step.node(i), std::min(low_value, -1e-300), value);
        result.found = located && step.shorten(*located);
        break;
      }
      if (value < -1e-10 * V) below = true;
      low = step.node(i), low_value = value;
    }
    period += step.length();
    if (system.direction() == 0) stuck += step.length();
    work.step(step);
    if (record) recorder.step(step);
  }
  if (result.found) {
    result.growth = work.growth(swing);
    if (record) {
      result.metrics = recorder.finish(period);
      result.metrics.stick_fraction = stuck / period;
      result.orbit = std::move(recorder.orbit);
    }
  }
  result.steps = solver.stepper().count().steps;
  result.evaluations = solver.stepper().count().evaluations;
  return result;
}

/// Static limit of a contact without memory.
double static_limit_of_curve(const Model& model) {
  const double N = model.drive.normal_load.level();
  return model.law->static_limit(N, model.law->steady({0, N}));
}

/// The swing at which slip that never sticks repeats itself: where the drift ln(A'/A) falls through zero.
struct BalancedSwing {
  std::optional<double> swing;
  Outcome outcome;
};
BalancedSwing balanced_swing(const Model& model, double tolerance) {
  const double natural = std::sqrt(model.slider.mass / model.slider.stiffness);
  const double at_drive = model.drive.speed.level() * natural;  // swings with that slip rate just come to rest
  const double largest =
      at_drive + 2 * model.drive.normal_load.level() * static_limit_of_curve(model) / model.slider.stiffness;
  constexpr long most_steps = 200'000;
  long steps = 0;
  const auto drift = [&](double log_swing) {
    if (steps > most_steps) return -1.0;
    const auto passage = slip_passage(model, std::exp(log_swing), tolerance, 0.1, false);
    steps += passage.steps;
    return passage.found && std::isfinite(passage.growth) ? passage.growth : -1.0;
  };
  constexpr double step = 0.25, farthest = 12;  // e-foldings of the swing
  double high = std::log(8 * largest), f_high = drift(high);
  const double lowest = std::log(at_drive) - farthest;
  for (double low = high - step; low > lowest && f_high < 0 && steps <= most_steps; low -= step) {
    const double f_low = drift(low);
    if (f_low <= 0) {
      high = low, f_high = f_low;
      continue;
    }
    std::uintmax_t iterations = 100;
    const auto [a, b] = boost::math::tools::toms748_solve(drift, low, high, f_low, f_high,
                                                          boost::math::tools::eps_tolerance<double>(50), iterations);
    if (steps <= most_steps) return {std::exp(0.5 * (a + b)), {}};
  }
  if (steps <= most_steps) return {};
  return {{}, {Ending::budget_spent, fmt::format("no swing that repeats itself within {} steps of slip", most_steps)}};
}

/// How the growth of a swing in a passage changes with the swing, d growth / d ln swing.
double slope_of_swing(const Model& model, double swing, double stick_threshold) {
  constexpr double closely = 1e-10, beside = 1e-4;
  const auto left = slip_passage(model, swing * (1 - beside), closely, stick_threshold, false);
  const auto right = slip_passage(model, swing * (1 + beside), closely, stick_threshold, false);
  return (right.growth - left.growth) / (2 * beside);
}

/// True where friction never falls with slip rate, not even from rest: then two motions never part, and none repeats
/// itself but steady sliding (or free oscillation about it, which nothing attracts).
bool never_weakens(const Model& model) {
  const auto& law = *model.law;
  const double N = model.drive.normal_load.level();
  double limit = static_limit_of_curve(model);
  if (remembers(model)) {
    // What slip has taken comes back at a stop or at rest, or never.
    const auto spent = law.after_stop(law.steady({model.drive.speed.level(), N}));
    for (const double rate : law.rate({0, N}, spent))
      if (rate != 0) return false;
    limit = law.static_limit(N, spent);
  }
  constexpr double nearly_rest = 1e-14, rounding = 1e-12;
  return !weakens_somewhere(law, N) && limit <= law.steady_friction({nearly_rest, N}).friction * (1 + rounding);
}

}  // namespace

Cycle find_stick_slip_cycle(const Model& model, const CycleOptions& options) {
  Cycle cycle;
  if (never_weakens(model)) {
    cycle.outcome = {Ending::none_exists, "friction nowhere falls with slip rate: nothing feeds an oscillation"};
    return cycle;
  }
  const auto dry = dry_oscillator(model);
  if (const auto* oscillator = std::get_if<solvers::DryOscillator>(&dry))
    if (auto exact = find_dry_cycle(*oscillator, options)) return *std::move(exact);
  const double V = model.drive.speed.level();
  Sharpening sharpening(options.tolerance, 0.2 * options.tolerance);
  const double friction_felt = std::min(1.0, friction_over_swing(model));
  bool sticks = true;
  std::vector<double> reversed;  ///< where slip turns to go along the drive, if it does in each period and never sticks
  const auto period_now = [&]() -> StickSlipPeriod {
    const double tol = sharpening.tolerance();
    if (!reversed.empty()) return OnsetMap(model, tol, options.stick_threshold, Onset::reversed).cycle(&reversed);
    if (sticks) {
      // Slip that only just comes to rest is missed by a solution that is not better than the miss.
      auto period = OnsetMap(model, tol, options.stick_threshold, Onset::held).cycle();
      constexpr double grazing = 1e-3, surely = 1e-6, sharp = 1e-14;
      const bool missed = !period.found && period.outcome.complete() && period.closest < grazing;
      // Where friction is weak, steps that follow the motion take little notice of it, nor of a short rest.
      const bool passed_over = missed && !period.reversed.empty() && !remembers(model) && friction_felt < 1;
      const double closely = passed_over ? std::max(friction_felt * std::min(tol, surely), sharp)
                             : period.grazes || (missed && period.reversed.empty()) ? sharp
                                                                                    : tol;
      if (!(tol > closely)) return period;
      auto closer = OnsetMap(model, closely, options.stick_threshold, Onset::held).cycle();
      constexpr double another = 0.1;
      if (period.found && closer.found && std::abs(closer.metrics.period / period.metrics.period - 1) > another)
        closer.outcome = {Ending::tolerance_not_met,
                          fmt::format("by {:.1e} of the drive's speed slip comes to rest or not, and a period has one "
                                      "slip or another number of them",
                                      period.closest)};
      return closer;
    }
    const auto balanced = balanced_swing(model, tol);
    if (!balanced.swing) {
      StickSlipPeriod none;
      none.outcome = balanced.outcome;
      return none;
    }
    auto period = slip_passage(model, *balanced.swing, tol, options.stick_threshold, true);
    period.onset_displacement = steady_sliding(model).displacement + *balanced.swing;
    return period;
  };
  StickSlipPeriod coarse = period_now();
  // What a period forgets of where slip reverses, and the last digits of that.
  double attraction = 1;
  constexpr double last_digits = 1e-15;
  // Weak attraction magnifies what steps err in the work of friction, at every tolerance alike; and where friction is
  // weak, steps that follow the motion take little notice of it.
  const double loose = sharpening.tolerance();
  const auto ask_for = [&](double share) {
    constexpr double weakest = 1e-8;
    sharpening = Sharpening(options.tolerance, loose * std::clamp(share, weakest, 1.0));
    coarse = period_now();
  };
  const auto multipliers_of = [&](const std::vector<double>& onset, int slips) {
    const Onset kind = reversed.empty() ? Onset::held : Onset::reversed;
    return OnsetMap(model, 1e-10, options.stick_threshold, kind, slips).multipliers(onset);
  };
  std::vector<std::complex<double>> multipliers;  // of the last period, where slip reverses
  const auto look_at_attraction = [&](const StickSlipPeriod& period) {
    multipliers = multipliers_of(period.onset, period.slips);
    if (!multipliers.empty()) attraction = 1 - std::abs(multipliers.front());
  };
  if (!coarse.found && coarse.outcome.complete() && remembers(model) && !coarse.reversed.empty()) {
    reversed = coarse.reversed;
    coarse = period_now();
    // True if friction changes the swings by rounding only. Steps may pass over short reversals, and so tell nothing of
    // friction that is felt there.
    const auto swings_freely = [&] {
      constexpr double rounding = 1e-9, hardly_felt = 1e-9, clearly = 1e-3;
      if (!coarse.found) return false;
      look_at_attraction(coarse);
      return std::abs(attraction) < rounding &&
             (friction_felt < hardly_felt || coarse.metrics.slip_rate_min < -clearly * V);
    };
    bool freely = swings_freely();
    // Steps that take no notice of friction may have swings free, or may have them only just reverse, which attracts.
    if (coarse.found && !(freely && friction_felt == 1)) {
      const double share = freely ? friction_felt : attraction * friction_felt;
      ask_for(share);
      freely = swings_freely();
      if (const double closer = attraction * friction_felt; coarse.found && !freely && closer < share) ask_for(closer);
    }
    if (freely) {
      cycle.outcome = {Ending::none_exists, "friction changes swings in which slip reverses by no more than rounding"};
      return cycle;
    }
  }
  const auto sliding = stability(model);
  if (!coarse.found && coarse.outcome.complete() && !sliding.stable && !sliding.marginal && !remembers(model)) {
    sticks = false;
    coarse = period_now();
    if (coarse.found) {
      const double swing = coarse.onset_displacement - sliding.steady.displacement;
      ask_for(-slope_of_swing(model, swing, options.stick_threshold));
    }
  }
  std::string worst;
  std::vector<double> onset;
  int slips = 1;
  bool turned = false;
  // Slip that passes the kinks of a table meets them anywhere within its steps; where friction is weak, and only
  // reverses, all but the same steps are taken at other tolerances.
  const auto& parameters = model.law->parameters();
  const bool kinks = std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.is_list; });
  const double caution = kinks || !reversed.empty() ? 10 : 1;
  while (sharpening.next()) {
    StickSlipPeriod fine = coarse.found ? period_now() : coarse;
    // Many periods from rest, each at no small cost, need not be gone through again.
    if (coarse.found && sticks && reversed.empty() && fine.outcome.ending == Ending::budget_spent)
      fine = OnsetMap(model, sharpening.tolerance(), options.stick_threshold, Onset::held, coarse.slips)
                 .cycle(&coarse.onset);
    if (coarse.found && sharpening.ease(fine.outcome)) fine = period_now();
    cycle.cost.steps += fine.steps + coarse.steps;
    cycle.cost.evaluations += fine.evaluations + coarse.evaluations;
    ++cycle.cost.cycles;
    const bool known = cycle.metrics.period > 0 && fine.outcome.ending == Ending::budget_spent;
    if (!fine.outcome.complete() && !known) {
      cycle.outcome = fine.outcome;
      return cycle;
    }
    if (!fine.found && cycle.metrics.period > 0) break;  // what was found before stays, as it was known
    if (!fine.found) {
      constexpr double rounding = 1e-13, by_a_hair = 1e-5;
      if (sticks && fine.closest < rounding)
        cycle.outcome = comes_to_rest_or_not(fine.closest);
      else if (remembers(model) && !fine.settles && (fine.closest < by_a_hair || !(sliding.stable || sliding.marginal)))
        cycle.outcome = {
            Ending::budget_spent,
            "slip started from stick has come neither to rest again nor to steady sliding, nor back to where it began"};
      else
        cycle.outcome = {Ending::none_exists, "slip started from stick neither sticks again nor keeps an amplitude"};
      return cycle;
    }
    if (!reversed.empty()) look_at_attraction(fine);
    const double closure = fine.closure + last_digits / std::max(std::abs(attraction), last_digits);
    Metrics error;
    double reached =
        estimate_errors(coarse.metrics, fine.metrics, sharpening.tolerance(), closure, V, false, error, worst, caution);
    error.friction_min += fine.friction;
    if (!reversed.empty()) error.friction_max += fine.friction;
    const double level = std::max(std::abs(fine.metrics.friction_min), std::abs(fine.metrics.friction_max));
    double doubtful = fine.friction;
    if (fine.turns_back > 0 && fine.turns_back < error.slip_rate_max) {
      // It may as well rest, under friction of either sign, for as long as the spring takes to make up for the doubt.
      const auto& slider = model.slider;
      const double rest = 2 * std::sqrt(2 * error.slip_rate_max * slider.mass / (slider.stiffness * V));
      doubtful += 2 * level;
      error.friction_min += 2 * level;
      error.friction_mean += 2 * level * rest / fine.metrics.period;
      error.stick_fraction += rest / fine.metrics.period;
    }
    if (const double part = doubtful / level; part > reached) reached = part, worst = "friction_min";
    const Outcome outcome = sharpening.judge(reached, worst);
    if (sharpening.supersedes(cycle, fine.metrics, error, reached)) {
      cycle.metrics = fine.metrics;
      cycle.error = error;
      cycle.orbit = fine.orbit;
      cycle.section_displacement = fine.onset_displacement;
      cycle.outcome = outcome;
      if (sticks) onset = fine.onset, slips = fine.slips, turned = fine.turned;
    }
    if (cycle.outcome.complete()) {
      state_with_caution(cycle.error, cycle.metrics, options.tolerance, V);
      break;
    }
    coarse = std::move(fine);
  }
  if (sticks) {
    cycle.multipliers = reversed.empty() ? multipliers_of(onset, slips) : std::move(multipliers);
    if (remembers(model)) cycle.section_state = SliderSystem(model).observe(0, onset.data()).state;
  } else {
    const double swing = cycle.section_displacement - steady_sliding(model).displacement;
    const double slope = slope_of_swing(model, swing, options.stick_threshold);
    cycle.multipliers = {slope < 0 ? std::min(1 + slope, std::nextafter(1.0, 0.0)) : 1 + slope};
  }
  // A swing about steady sliding that is no larger than its error is rounding, where friction hardly moves the slider.
  if (!sticks && cycle.metrics.slip_rate_max - V <= cycle.error.slip_rate_max) {
    const double swing = cycle.metrics.slip_rate_max / V - 1;
    cycle.metrics = {};
    cycle.orbit.clear();
    cycle.outcome = {
        Ending::tolerance_not_met,
        fmt::format("slip swings about steady sliding by {:.1e} of the drive speed, or by rounding", swing)};
    return cycle;
  }
  cycle.stable = !cycle.multipliers.empty() && std::abs(cycle.multipliers.front()) < 1;
  if (constexpr double certainly = 1.01;
      turned && !cycle.multipliers.empty() && std::abs(cycle.multipliers.front()) > certainly)
    cycle.outcome = {
        Ending::budget_spent,
        fmt::format("stick and slip do not come to repeat themselves: the period that would repels (largest "
                    "multiplier {:.3g})",
                    std::abs(cycle.multipliers.front()))};
  return cycle;
}

}  // namespace rosin::analysis
