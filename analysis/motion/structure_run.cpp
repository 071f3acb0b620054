/// A structure followed from break to break of its drive and from switch to switch of its contacts, and sampled.
#include "analysis/motion/structure_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/motion/follower.hpp"
#include "analysis/motion/motion_record.hpp"
#include "analysis/motion/stated_error.hpp"
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
    for (auto* sums : {&impulse, &pressed, &open_time, &wear}) sums->assign(system.friction_contacts(), 0.0);
  }

  double energy(double t, const double* y) const {
    const VectorXd v = system_.velocity(t, y);
    const Eigen::Map<const VectorXd> q(y, system_.coordinates());
    return 0.5 * (v.dot(mass_ * v) + q.dot(symmetric_ * q));
  }
  /// The last step, in the modes that it was taken in.
  void add(const solvers::steps::Collocation& step) {
    duration += step.length();
    if (!system_.structure().sampled.empty()) add_sample(step);
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
      add(system_.limit_power(t, y_.data()));
      for (int j = 0; j < system_.friction_contacts(); ++j) {
        const double N = system_.normal_load(j, t, y_.data());
        wear[j] += weight * N * std::abs(system_.contact_slip_rate(j, t, y_.data()));
        if (system_.follows_motion(j)) {
          impulse[j] += weight * force_[j], pressed[j] += weight * N;
          open_time[j] += weight * system_.open_fraction(j, t, y_.data());
        }
        add(force_[j] * system_.speed_along(j, y_.data(), v));
        heat += weight * force_[j] * system_.slip_rate(j, t, y_.data());
      }
      work_ += weight * power;
      turned_over_ += weight * size;
    }
  }
  /// Elastic energy is counted with the force that a servo holds, q u: what a sample makes of it is no work.
  void add_sample(const solvers::steps::Collocation& step) {
    const double before = energy(step.time_before(), step.state_before().data());
    work_ += before - last_, last_ = energy(step.time(), step.state().data());
  }
  void add_impact(const MotionEvent& event) {
    const auto& stop = system_.structure().stops[event.stop];
    const double e = stop.restitution;
    const double lost = 0.5 * mass_[stop.coordinate].begin()->value * (1 - e * e) * event.speed * event.speed;
    impacts += lost, work_ -= lost, turned_over_ += lost;
  }
  void begin(double t, const double* y) { last_ = before_ = energy(t, y), largest_ = before_; }
  /// Part of what was turned over that the balance leaves open.
  double residual(double t, const double* y) const {
    const double now = system_.structure().sampled.empty() ? energy(t, y) : last_,
                 throughput = turned_over_ + std::max(largest_, now);
    return throughput > 0 ? std::abs(now - before_ - work_) / throughput : 0;
  }
  std::vector<double> impulse, pressed;  ///< N s, of friction and of the load of each contact
  std::vector<double> open_time;         ///< s, by the part of its area that was open
  std::vector<double> wear;              ///< J, ∫ N |v| dt of each contact
  double duration = 0;                   ///< s
  double heat = 0;                       ///< J, that friction has turned slip into
  double impacts = 0;                    ///< J, lost in impacts

 private:
  const StructureSystem& system_;
  oscillators::SparseRows mass_, symmetric_, skew_;
  std::vector<double> force_, y_;
  double before_ = 0, last_ = 0, largest_ = 0, work_ = 0, turned_over_ = 0;  ///< J; last_: at the end of the last step
};

/// Where slip of contacts under smooth laws reverses.
class Reversals {
 public:
  explicit Reversals(const StructureSystem& system) : system_(system), y_(system.size()) {
    const auto& contacts = system.structure().contacts;
    for (int j = 0; j < int(contacts.size()); ++j)
      if (!contacts[j].law->set_valued() && !contacts[j].frictionless()) contacts_.push_back({j, 0});
  }
  /// Those within the last step, in the order of time.
  std::vector<RunEvent> in(solvers::steps::Collocation& step) {
    std::vector<RunEvent> found;
    for (auto& [contact, side] : contacts_) {
      const auto slip_rate = [&, j = contact](double t, const double* y) { return system_.slip_rate(j, t, y); };
      double low = 0, before = slip_rate(step.time_before(), step.state_before().data());
      if (side == 0) side = before;
      for (int i = 0; i < solvers::steps::Collocation::stages; ++i) {
        step.stage(i, y_.data());
        const double here = slip_rate(step.stage_time(i), y_.data());
        if (here * side < 0) {
          // The step before may have ended at the reversal itself.
          const auto theta =
              before * side > 0 ? step.locate(slip_rate, low, step.node(i), before, here) : std::optional(low);
          if (theta && step.solve_at(*theta, y_.data())) found.push_back(event(step.time_at(*theta), contact));
        }
        if (here != 0) side = here;
        low = step.node(i), before = here;
      }
    }
    std::ranges::sort(found, {}, &RunEvent::time);
    return found;
  }

 private:
  RunEvent event(double t, int contact) const {
    const auto& direction = system_.structure().contacts[contact].tangential;
    return {.time = t,
            .kind = "reversal",
            .displacement =
                direction.dot(Eigen::Map<const VectorXd>(y_.data(), system_.coordinates())) / direction.squaredNorm(),
            .contact = system_.friction_contacts() > 1 ? contact + 1 : 0,
            .coordinate = 0,
            .speed = 0};
  }
  const StructureSystem& system_;
  std::vector<double> y_;
  struct At {
    int contact;
    double side;  ///< the last slip rate that was not 0
  };
  std::vector<At> contacts_;
};

/// The contacts whose slips are listed: those on a surface of constant speed.
std::vector<SlipColumns> slip_columns(const StructureSystem& system, const StructureRecord& columns,
                                      double stick_threshold) {
  std::vector<SlipColumns> list;
  for (int j = 0; j < system.friction_contacts(); ++j) {
    const auto& contact = system.structure().contacts[std::size_t(j)];
    if (contact.frictionless() || contact.ring || !contact.speed.constant()) continue;
    const auto slip_rate = std::ranges::find(columns.names, numbered(system, "slip_rate", j)) - columns.names.begin();
    list.push_back({.slip_rate = std::size_t(slip_rate),
                    .displacement = columns.names.size() + std::size_t(j),
                    .speed = contact.speed.level(),
                    .stick_threshold = contact.law->set_valued() ? 0 : stick_threshold,
                    .contact = system.friction_contacts() > 1 ? j + 1 : 0});
  }
  return list;
}

/// One pass at one tolerance.
struct StructurePass {
  StructureSystem system;
  StructureRecord columns;
  MotionRecord record;
  EnergyAudit energy;
  std::vector<RunEvent> events;
  std::vector<double> stick_time;  ///< s, of each set-valued contact
  Outcome outcome;
  Run::Cost cost;
  long choices = 0;
  double energy_residual = 0;

  StructurePass(const StructureModel& model, const RunOptions& options, const std::vector<double>& times,
                double tolerance, double stick_threshold)
      : system(model.structure),
        columns(system),
        record(columns.names.size(), std::size_t(system.friction_contacts()), times,
               slip_columns(system, columns, stick_threshold)),
        energy(system),
        stick_time(system.contacts()) {
    try {
      follow(starting_point(system, model.start), options, times, tolerance);
    } catch (const Stopped&) {  // samples until then are good
      outcome = {Ending::interrupted, fmt::format("{} of {} samples are kept", record.samples(), times.size())};
    }
  }

 private:
  /// The columns, then the displacement along each contact.
  void observe(double t, const double* y, double* row) {
    columns.observe(t, y, seen);
    std::ranges::copy(seen, row);
    const Eigen::Map<const VectorXd> q(y, system.coordinates());
    for (int j = 0; j < system.friction_contacts(); ++j) row[seen.size() + std::size_t(j)] = system.along(j, q);
  }
  void follow(std::vector<double> y, const RunOptions& options, const std::vector<double>& times, double tolerance) {
    const double end = std::max(options.duration, times.back());
    energy.begin(0, y.data());
    Follower follower(system, tolerance);
    follower.most_steps = options.most_steps;
    Reversals reversals(system);
    follower.observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
      energy.add(step);
      for (int c = 0; c < system.contacts(); ++c)
        if (system.mode(c) == ContactMode::stick) stick_time[c] += step.length();
      const auto note = [&](std::span<const Follower::Event> some) {
        for (const auto& event : some) {
          events.push_back(event_of(system, event));
          if (event.kind == "impact") energy.add_impact(event);
          if (event.kind == "stick" || event.kind == "slip")
            record.switched(events.back().contact, event.kind == "slip");
        }
      };
      // Where the drive jumps contacts switch before the step, else at its end.
      const auto inside =
          std::ranges::find_if(switches, [&](const auto& event) { return event.time > step.time_before(); });
      note({switches.begin(), inside});
      for (auto& event : reversals.in(step)) events.push_back(std::move(event));
      record.step(step, [&](double t, const double* z, double* row) { observe(t, z, row); });
      note({inside, switches.end()});
      if (options.progress) options.progress(step.time() / end);
    };
    outcome = follower.follow(0, y, end);
    cost = {follower.count().steps, follower.count().evaluations};
    choices = follower.count().choices;
    if (!outcome.complete()) return;
    energy_residual = energy.residual(end, y.data());
    record.rest(end, true, [&](double t, double* row) { observe(t, y.data(), row); });
  }

  std::vector<double> seen;  ///< scratch
};

/// Errors of the columns by the largest differences of two passes, with what the finer leaves: two passes may agree by
/// chance. \returns the largest error of a coordinate or velocity as a part of its size, which is its natural size
/// where it hardly moves.
double compare(const StructurePass& fine, const StructurePass& coarse, const std::vector<double>& times,
               const ErrorRule& rule, double asked, std::vector<double>& error) {
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
  for (std::size_t c = 0; c < fine.record.columns().size(); ++c) {
    const auto &values = fine.record.columns()[c], &others = coarse.record.columns()[c];
    const double size = fine.record.size(c);
    double difference = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (at_impact[i] && int(c) >= n) continue;
      difference = i < others.size() ? std::max(difference, std::abs(values[i] - others[i])) : infinity;
    }
    error.push_back(rule.error(difference, size));
    if (int(c) < 2 * n) worst = std::max(worst, error.back() / std::max(size, scale[c]));
    error.back() = with_caution(error.back(), size, asked);
  }
  return worst;
}

/// A motion from steady sliding stays there by the equations, though whatever disturbed it might grow.
std::string why_nothing_grows(const StructureModel& model) {
  constexpr int most_coordinates = 100;  // beyond, their modes would take longer than the motion
  if (model.start.kind != Start::Kind::steady || !model.structure.constant()) return "";
  if (model.structure.size() > most_coordinates || model.start.beside.size() > 0) return "";
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

Run run_structure(const StructureModel& model, const RunOptions& options, double stick_threshold) {
  require(options.tolerance, {1e-12, 0.1}, "tolerance", "relative accuracy of a run", "1");
  if (options.solver != "auto" && options.solver != "events")
    throw InputError(fmt::format("solver '{}' does not serve a structure; use auto or events", options.solver));
  const auto times = sample_times(options);
  // Two passes show the error of the coarser; where that is above the tolerance, a third shows that of the second.
  constexpr double finer = 1.0 / 30;
  constexpr int most_passes = 4;
  double tolerance = 0.1 * options.tolerance, worst = infinity;
  ErrorRule rule;
  Run result;
  std::unique_ptr<StructurePass> coarse,
      fine = std::make_unique<StructurePass>(model, options, times, tolerance, stick_threshold);
  result.cost = fine->cost;
  for (int pass = 1; !options.once && pass < most_passes && fine->outcome.complete() && worst > options.tolerance;
       ++pass) {
    tolerance *= finer;
    coarse = std::move(fine);
    fine = std::make_unique<StructurePass>(model, options, times, tolerance, stick_threshold);
    result.cost.steps += fine->cost.steps, result.cost.evaluations += fine->cost.evaluations;
    constexpr double cautious = 3;  // the coarser pass differs from the truth by the differences of finer ones too
    rule = {cautious, std::max(3 * tolerance, 0.01 * options.tolerance)};
    worst = compare(*fine, *coarse, times, rule, options.tolerance, result.column_error);
  }
  if (!coarse) result.column_error.assign(fine->columns.names.size(), infinity);
  result.outcome = fine->outcome;
  result.solver = "events";
  result.why = "smooth pieces of slip by collocation of order 9, switches of each contact located to rounding";
  result.remark = why_nothing_grows(model);
  result.column_names = fine->columns.names;
  result.column_units = fine->columns.units;
  state_what_is_seen(fine->record, coarse.get() ? &coarse->record : nullptr,
                     std::vector<ErrorRule>(result.column_names.size(), rule), result);
  result.columns = fine->record.columns();
  result.events = fine->events;
  state_event_errors(result, coarse ? coarse->events : std::vector<RunEvent>{}, rule, options.tolerance);
  result.time.assign(times.begin(), times.begin() + long(fine->record.samples()));
  for (std::size_t c = 0; c < fine->stick_time.size(); ++c)
    result.metrics[numbered(fine->system, "stick_time", fine->system.friction_contact(int(c)))] = fine->stick_time[c];
  for (int j = 0; j < fine->system.friction_contacts(); ++j) {
    if (!fine->system.follows_motion(j)) continue;
    result.metrics[numbered(fine->system, "open_time", j)] = fine->energy.open_time[j];
    if (fine->energy.pressed[j] > 0 && !model.structure.contacts[j].frictionless())
      result.metrics[numbered(fine->system, "apparent_friction", j)] =
          fine->energy.impulse[j] / fine->energy.pressed[j];
  }
  for (int j = 0; j < fine->system.friction_contacts(); ++j) {
    if (model.structure.contacts[j].frictionless()) continue;
    const auto rate = [&](const StructurePass& pass) { return pass.energy.wear[j] / pass.energy.duration; };
    const auto name = numbered(fine->system, "wear_work_rate", j);
    const double here = result.metrics[name] = rate(*fine);
    result.metric_error[name] = coarse ? rule.error(std::abs(here - rate(*coarse)), here) : infinity;
  }
  result.metrics["friction_work"] = fine->energy.heat;
  if (fine->system.stops() > 0) result.metrics["impact_work"] = fine->energy.impacts;
  result.metrics["energy_residual"] = fine->energy_residual;
  if (fine->system.contacts() > 1) result.metrics["choices"] = double(fine->choices);
  if (!options.once && result.outcome.complete() && worst > options.tolerance)
    result.outcome = {Ending::tolerance_not_met, fmt::format("the motion is known to {:.1e} of its size only", worst)};
  return result;
}

}  // namespace rosin::analysis::motion
