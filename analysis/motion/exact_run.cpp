/// The closed form applied to a slider: twice, in double and in extended arithmetic, whose difference is the error.
#include "analysis/motion/exact_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/motion/motion_record.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::motion {

using solvers::stick_slip::DryOscillator;
using solvers::stick_slip::Exact;
using solvers::stick_slip::Switch;

std::variant<DryOscillator, std::string> dry_oscillator(const Model& model) {
  const auto& law = *model.law;
  const auto& [mass, stiffness, damping] = model.slider;
  const auto& [speed, load, force] = model.drive;
  if (!law.set_valued()) return fmt::format("law '{}' is smooth at rest", law.card().name);
  const auto friction = law.linear();
  if (!friction) return fmt::format("friction of law '{}' is not linear in the slip rate", law.card().name);
  if (!oscillators::SliderSystem(model).rigid()) return "the contact has a spring of its own";
  if (!(mass > 0 && stiffness > 0)) return "a mass and a spring are needed, above 0";
  if (friction->slope != 0 && !load.constant()) return "friction is viscous per load, and the load varies";
  if (friction->slope < 0) return "friction that falls with speed makes motion grow";
  const double limit = law.static_limit(load.level());
  return DryOscillator{
      mass,  stiffness, damping, limit, friction->constant, friction->slope == 0 ? 0 : friction->slope * load.level(),
      speed, load,      force};
}

namespace {

// displacement, velocity, slip_rate, friction_force, friction_coefficient, acceleration
constexpr int columns = 6, velocity = 1, slip_rate = 2, friction_force = 3, acceleration = 5;

template <class Real>
struct ExactPass {
  MotionRecord record;
  std::vector<RunEvent> events;
  bool extremes_of_samples = false;  ///< of a part of the motion that has too many oscillations
  Outcome outcome;

  ExactPass(Exact<Real>& solver, const DryOscillator& oscillator, const RunOptions& options,
            const std::vector<double>& times, std::array<double, 2> start, const SlipColumns& slips)
      : record(columns, 0, times, {slips}), oscillator_(oscillator) {
    try {
      follow(solver, options, std::max(options.duration, times.back()), start);
    } catch (const Stopped&) {
      outcome = {Ending::interrupted, fmt::format("{} of {} samples are kept", record.samples(), times.size())};
    }
  }

 private:
  void follow(Exact<Real>& solver, const RunOptions& options, double end, std::array<double, 2> start) {
    const auto row = [&](double t, double* to) {
      const auto seen = solver.at(std::clamp(Real(t), solver.time_before(), solver.time()));
      const Real values[] = {seen.displacement,
                             seen.velocity,
                             seen.slip_rate,
                             seen.friction_force,
                             seen.load > 0 ? seen.friction_force / seen.load : 0,
                             (seen.friction_force + oscillator_.force.value(t) -
                              oscillator_.stiffness * seen.displacement - oscillator_.damping * seen.velocity) /
                                 oscillator_.mass};
      std::ranges::copy(values, to);
    };
    long parts_left = most_parts;
    solver.audit(most_parts);
    solver.start(0, start[0], start[1]);
    for (long pieces = 0; solver.time() < end; ++pieces) {
      if (pieces == options.most_steps) {
        outcome = {Ending::budget_spent,
                   fmt::format("{} pieces at t = {:.9g} s", pieces, static_cast<double>(solver.time()))};
        return;
      }
      const Switch what = solver.advance(end);
      const double displacement = double(solver.at(solver.time()).displacement);
      if (!std::isfinite(displacement)) {
        outcome = {Ending::not_finite, fmt::format("displacement at t = {:.9g} s", double(solver.time()))};
        return;
      }
      record.step(double(solver.time_before()), double(solver.time()), inside(solver, parts_left), row);
      if (what == Switch::none) continue;
      if (what != Switch::reversal) record.switched(0, what == Switch::slip);
      events.push_back({double(solver.time()), name(what), displacement});
    }
    record.rest(end, true, row);
  }

  /// Times within the last piece that resolve its fastest oscillation.
  std::vector<double> inside(const Exact<Real>& solver, long& parts_left) {
    constexpr double radians = 0.5;
    const double from = double(solver.time_before()), to = double(solver.time()), rate = double(solver.fastest());
    const double parts = std::ceil((to - from) * rate / radians) + 1;
    std::vector<double> times;
    if (!(parts < double(parts_left))) {
      extremes_of_samples = true;
      return times;
    }
    parts_left -= long(parts);
    for (double k = 1; k < parts; ++k) times.push_back(std::lerp(from, to, k / parts));
    return times;
  }

  const DryOscillator& oscillator_;
  static constexpr long most_parts =
      200'000;  ///< by which extremes and works take no longer than the motion itself may
};

}  // namespace

void run_exactly(const Model& model, const DryOscillator& oscillator, const RunOptions& options,
                 const std::vector<double>& times, Run& result) {
  const oscillators::SliderSystem system(model);
  const auto y = starting_point(system, options.start);
  const std::array<double, 2> start = {y[0], oscillator.speed.value(0) - y[1]};
  const double frequency = std::sqrt(oscillator.stiffness / oscillator.mass),
               end = std::max(options.duration, times.back());
  if (!(frequency * end < 1e13))  // a thousandth of a radian would be rounding
    throw InputError(
        fmt::format("a natural frequency of {:.3g} rad/s over {:.3g} s is beyond what the clock resolves; "
                    "at most {:.3g} s can be followed",
                    frequency, end, 1e13 / frequency));
  const auto slips = slip_columns(model, 0);
  Exact<long double> fine_solver(oscillator);
  ExactPass<long double> fine(fine_solver, oscillator, options, times, start, slips);
  Exact<double> coarse_solver(oscillator);
  const ExactPass<double> coarse(coarse_solver, oscillator, options, times, start, slips);

  result.outcome = fine.outcome;
  double worst = 0;
  std::vector<ErrorRule> rules;
  for (int c = 0; c < columns; ++c) {
    // Velocity is the drive's speed less the slip rate, and may be nothing but rounding.
    // So may the acceleration, in which friction and the spring cancel.
    const double least = c == velocity || c == slip_rate ? std::abs(oscillator.speed.level())
                         : c == acceleration             ? fine.record.size(friction_force) / oscillator.mass
                                                         : 0;
    const double size = std::max(least, fine.record.size(c));
    rules.push_back({1, 0, std::numeric_limits<double>::epsilon() * size});
    const double error =
        rules.back().error(largest_difference(coarse.record.columns()[c], fine.record.columns()[c]), size);
    if (size > 0) worst = std::max(worst, error / size);
    result.column_error.push_back(error);
  }
  state_what_is_seen(fine.record, &coarse.record, rules, result);
  result.columns = fine.record.columns();
  result.events = std::move(fine.events);
  state_event_errors(result, coarse.events, {});
  if (result.outcome.complete() && worst > options.tolerance)
    result.outcome = {Ending::tolerance_not_met,
                      fmt::format("rounding changes the motion by {:.1e} of its size: events nearly coincide", worst)};
  auto& metrics = result.metrics;
  const auto& works = fine_solver.works();
  metrics["stick_time"] = double(fine_solver.stick_time());
  if (fine_solver.audits()) {
    metrics["friction_work"] = double(works.friction);
    metrics["wear_work_rate"] = double(works.wear) / end;
    metrics["damper_work"] = double(works.damper);
    metrics["force_work"] = double(works.force);
    metrics["surface_work"] = double(works.surface);
    metrics["energy_residual"] = double(coarse_solver.works().residual);
  } else {
    result.remark =
        fmt::format("works are not summed up over so many oscillations; shorten run.duration, {:.3g} s", end);
  }
  if (fine.extremes_of_samples)
    result.remark += fmt::format("{}extremes are those of the samples, for so many oscillations are not looked through",
                                 result.remark.empty() ? "" : "; ");
  if (std::isfinite(double(fine_solver.decision_margin())))
    metrics["decision_margin"] = double(fine_solver.decision_margin());
  if (fine_solver.chatter_events() > 0) {
    metrics["chatter_events"] = double(fine_solver.chatter_events());
    metrics["chatter_time"] = double(fine_solver.chatter_time());
  }
  result.cost.steps = coarse_solver.pieces();
}

}  // namespace rosin::analysis::motion
