/// A structure followed from break to break of its drive and from switch to switch of its contacts, and sampled.
#include "analysis/motion/structure_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/motion/follower.hpp"
#include "analysis/motion/structure_record.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::motion {

using Eigen::VectorXd;
using oscillators::Structure;
using oscillators::StructureSystem;

namespace {

/// Kinetic and elastic energy against the works of all forces that change it, by the quadrature of each step.
class EnergyAudit {
 public:
  explicit EnergyAudit(const StructureSystem& system)
      : system_(system),
        mass_(system.structure().M),
        symmetric_((system.structure().K + system.structure().K.transpose()) / 2),
        skew_((system.structure().K - system.structure().K.transpose()) / 2),
        force_(system.friction_contacts()),
        y_(system.size()) {
    for (auto* sums : {&impulse, &pressed, &open_time}) sums->assign(system.friction_contacts(), 0.0);
  }

  double energy(double t, const double* y) const {
    const VectorXd v = system_.velocity(t, y);
    const Eigen::Map<const VectorXd> q(y, system_.coordinates());
    return 0.5 * (v.dot(mass_ * v) + q.dot(symmetric_ * q));
  }
  /// The last step, in the modes that it was taken in.
  void add(const solvers::steps::Collocation& step) {
    const Structure& structure = system_.structure();
    for (int i = 0; i < solvers::steps::Collocation::stages; ++i) {
      step.stage(i, y_.data());
      const double t = step.stage_time(i), weight = solvers::steps::RadauTableau::get().b[i] * step.length();
      const VectorXd v = system_.velocity(t, y_.data());
      const Eigen::Map<const VectorXd> q(y_.data(), system_.coordinates());
      system_.friction_forces(t, y_.data(), force_.data());
      const double damping = -v.dot(system_.damping() * v), circulation = -v.dot(skew_ * q);
      double power = damping + circulation, size = std::abs(damping) + std::abs(circulation);
      const auto add = [&](double part) { power += part, size += std::abs(part); };
      for (std::size_t k = 0; k < structure.force.size(); ++k) add(structure.force[k].value(t) * v[k]);
      add(system_.normal_power(t, y_.data()));
      add(system_.stop_power(t, y_.data()));
      for (int j = 0; j < system_.friction_contacts(); ++j) {
        if (system_.follows_motion(j)) {
          impulse[j] += weight * force_[j], pressed[j] += weight * system_.normal_load(j, t, y_.data());
          open_time[j] += weight * system_.open_fraction(j, t, y_.data());
        }
        add(force_[j] * system_.along(j, v));
        heat += weight * force_[j] * system_.slip_rate(j, t, y_.data());
      }
      work_ += weight * power;
      turned_over_ += weight * size;
    }
  }
  void add_impact(const MotionEvent& event) {
    const auto& stop = system_.structure().stops[event.stop];
    const double e = stop.restitution;
    const double lost = 0.5 * mass_[stop.coordinate].begin()->value * (1 - e * e) * event.speed * event.speed;
    impacts += lost, work_ -= lost, turned_over_ += lost;
  }
  void begin(double t, const double* y) { before_ = energy(t, y), largest_ = before_; }
  /// Part of what was turned over that the balance leaves open.
  double residual(double t, const double* y) const {
    const double now = energy(t, y), throughput = turned_over_ + std::max(largest_, now);
    return throughput > 0 ? std::abs(now - before_ - work_) / throughput : 0;
  }
  std::vector<double> impulse, pressed;  ///< N s, of friction and of the load of each contact
  std::vector<double> open_time;         ///< s, by the part of its area that was open
  double heat = 0;                       ///< J, that friction has turned slip into
  double impacts = 0;                    ///< J, lost in impacts

 private:
  const StructureSystem& system_;
  oscillators::SparseRows mass_, symmetric_, skew_;
  std::vector<double> force_, y_;
  double before_ = 0, largest_ = 0, work_ = 0, turned_over_ = 0;
};

/// One pass at one tolerance.
struct Pass {
  StructureSystem system;
  StructureRecord columns;
  EnergyAudit energy;
  std::vector<RunEvent> events;
  std::vector<double> stick_time;  ///< s, of each set-valued contact
  Outcome outcome;
  Run::Cost cost;
  long choices = 0;
  double energy_residual = 0;

  Pass(const StructureModel& model, const RunOptions& options, const std::vector<double>& times, double tolerance)
      : system(model.structure), columns(system), energy(system), stick_time(system.contacts()) {
    try {
      follow(starting_point(system, model.start), options, times, tolerance);
    } catch (const Stopped&) {  // samples until then are good
      outcome = {Ending::interrupted, fmt::format("{} of {} samples are kept", columns.values[0].size(), times.size())};
    }
  }

 private:
  void follow(std::vector<double> y, const RunOptions& options, const std::vector<double>& times, double tolerance) {
    const double end = std::max(options.duration, times.back());
    std::size_t next = 0;
    std::vector<double> seen(system.size());
    energy.begin(0, y.data());
    Follower follower(system, tolerance);
    follower.most_steps = options.most_steps;
    follower.observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
      energy.add(step);
      for (int c = 0; c < system.contacts(); ++c)
        if (system.mode(c) == ContactMode::stick) stick_time[c] += step.length();
      for (; next < times.size() && times[next] < step.time(); ++next) {
        const double theta = (times[next] - step.time_before()) / step.length();
        if (times[next] == step.time_before())
          seen = step.state_before();
        else
          step.solve_at(theta, seen.data());
        columns.record(times[next], seen.data());
      }
      for (const auto& event : switches) {
        events.push_back(event_of(system, event));
        if (event.kind == "impact") energy.add_impact(event);
      }
      if (options.progress) options.progress(step.time() / end);
    };
    outcome = follower.follow(0, y, end);
    cost = {follower.count().steps, follower.count().evaluations};
    choices = follower.count().choices;
    if (!outcome.complete()) return;
    energy_residual = energy.residual(end, y.data());
    for (; next < times.size(); ++next) columns.record(times[next], y.data());
  }
};

/// Largest differences of the columns of two passes, with what the finer leaves. \returns the largest error of a
/// coordinate or velocity as a part of its size, which is its natural size where it hardly moves.
double compare(const Pass& fine, const Pass& coarse, const std::vector<double>& times, double tolerance,
               std::vector<double>& error) {
  const int n = fine.system.coordinates();
  const std::vector<double> rest(fine.system.size());
  std::vector<double> scale(fine.system.size());
  fine.system.scale(rest.data(), scale.data());
  // At the moment of an impact a velocity has two values.
  std::vector<bool> at_impact(times.size());
  constexpr double same_moment = 1e-9;
  for (const auto& event : fine.events)
    if (event.kind == "impact")
      for (auto at = std::ranges::lower_bound(times, event.time * (1 - same_moment) - same_moment);
           at != times.end() && *at <= event.time * (1 + same_moment) + same_moment; ++at)
        at_impact[std::size_t(at - times.begin())] = true;
  double worst = 0;
  error.clear();
  for (std::size_t c = 0; c < fine.columns.values.size(); ++c) {
    const auto &values = fine.columns.values[c], &others = coarse.columns.values[c];
    double size = 0, difference = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      size = std::max(size, std::abs(values[i]));
      if (at_impact[i] && int(c) >= n) continue;
      difference = i < others.size() ? std::max(difference, std::abs(values[i] - others[i])) : infinity;
    }
    error.push_back(difference + tolerance * size);
    if (int(c) < 2 * n) worst = std::max(worst, error.back() / std::max(size, scale[c]));
  }
  return worst;
}

/// A motion from steady sliding stays there by the equations, though whatever disturbed it might grow.
std::string why_nothing_grows(const StructureModel& model) {
  constexpr int most_coordinates = 100;  // beyond, their modes would take longer than the motion
  if (model.start.kind != Start::Kind::steady || !model.structure.constant()) return "";
  if (model.structure.size() > most_coordinates) return "";
  for (const auto& contact : model.structure.contacts)
    if (contact.speed.level() == 0 && !contact.frictionless()) return "";
  const auto sliding = steady::stability(model.structure);
  if (sliding.stable || sliding.marginal) return "";
  return fmt::format(
      "steady sliding is unstable: what disturbs it grows with {:.3g} 1/s, but nothing does; to see it grow, start "
      "beside "
      "it, run.start = {{ coordinates = [ … ] }}",
      sliding.modes.front().growth_rate());
}

}  // namespace

Run run_structure(const StructureModel& model, const RunOptions& options) {
  require(options.tolerance, {1e-12, 0.1}, "tolerance", "relative accuracy of a run", "1");
  if (options.solver != "auto" && options.solver != "events")
    throw InputError(fmt::format("solver '{}' does not serve a structure; use auto or events", options.solver));
  const auto times = sample_times(options);
  // Two passes show the error of the coarser; where that is above the tolerance, a third shows that of the second.
  constexpr double finer = 1.0 / 30;
  constexpr int most_passes = 4;
  double tolerance = 0.1 * options.tolerance, worst = infinity;
  Run result;
  std::unique_ptr<Pass> coarse, fine = std::make_unique<Pass>(model, options, times, tolerance);
  result.cost = fine->cost;
  for (int pass = 1; pass < most_passes && fine->outcome.complete() && worst > options.tolerance; ++pass) {
    tolerance *= finer;
    coarse = std::move(fine);
    fine = std::make_unique<Pass>(model, options, times, tolerance);
    result.cost.steps += fine->cost.steps, result.cost.evaluations += fine->cost.evaluations;
    worst = compare(*fine, *coarse, times, tolerance, result.column_error);
  }
  if (!coarse) result.column_error.assign(fine->columns.names.size(), infinity);
  result.outcome = fine->outcome;
  result.solver = "events";
  result.why = "smooth pieces of slip by collocation of order 9, switches of each contact located to rounding";
  result.remark = why_nothing_grows(model);
  result.column_names = fine->columns.names;
  result.column_units = fine->columns.units;
  result.columns = fine->columns.values;
  result.events = fine->events;
  const std::size_t samples = result.columns[0].size();
  result.time.assign(times.begin(), times.begin() + long(samples));
  for (std::size_t c = 0; c < result.columns.size() && samples > 0; ++c) {
    const auto [low, high] = std::ranges::minmax(result.columns[c]);
    result.metrics[result.column_names[c] + "_min"] = low, result.metrics[result.column_names[c] + "_max"] = high;
  }
  for (std::size_t c = 0; c < fine->stick_time.size(); ++c)
    result.metrics[numbered(fine->system, "stick_time", fine->system.friction_contact(int(c)))] = fine->stick_time[c];
  for (int j = 0; j < fine->system.friction_contacts(); ++j) {
    if (!fine->system.follows_motion(j)) continue;
    result.metrics[numbered(fine->system, "open_time", j)] = fine->energy.open_time[j];
    if (fine->energy.pressed[j] > 0 && !model.structure.contacts[j].frictionless())
      result.metrics[numbered(fine->system, "apparent_friction", j)] =
          fine->energy.impulse[j] / fine->energy.pressed[j];
  }
  double time_error = coarse && fine->events.size() == coarse->events.size() ? 0 : infinity;
  for (std::size_t i = 0; coarse && i < std::min(fine->events.size(), coarse->events.size()); ++i)
    time_error = std::max(time_error, std::abs(fine->events[i].time - coarse->events[i].time));
  result.metrics["event_time_error"] = time_error;
  result.metrics["friction_work"] = fine->energy.heat;
  if (fine->system.stops() > 0) result.metrics["impact_work"] = fine->energy.impacts;
  result.metrics["energy_residual"] = fine->energy_residual;
  if (fine->system.contacts() > 1) result.metrics["choices"] = double(fine->choices);
  if (result.outcome.complete() && worst > options.tolerance)
    result.outcome = {Ending::tolerance_not_met, fmt::format("the motion is known to {:.1e} of its size only", worst)};
  return result;
}

}  // namespace rosin::analysis::motion
