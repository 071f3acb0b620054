/// The closed form applied to a slider: twice, in double and in extended arithmetic, whose difference is the error.
#include "analysis/motion/exact_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

constexpr int columns = 5;  // displacement, velocity, slip_rate, friction_force, friction_coefficient
constexpr int velocity = 1, slip_rate = 2;

template <class Real>
struct Pass {
  std::array<std::vector<Real>, columns> samples;
  std::vector<Real> event_times;
  Outcome outcome;

  Pass(Exact<Real>& solver, const RunOptions& options, const std::vector<double>& times, std::array<double, 2> start,
       std::vector<RunEvent>* events) {
    const double end = std::max(options.duration, times.back());
    std::size_t next = 0;
    const auto sample_until = [&](Real t, bool closed) {
      for (; next < times.size() && (times[next] < t || (closed && times[next] == t)); ++next) {
        if (Listening::stop_asked()) return;
        const auto seen = solver.at(times[next]);
        const Real values[] = {seen.displacement, seen.velocity, seen.slip_rate, seen.friction_force,
                               seen.load > 0 ? seen.friction_force / seen.load : 0};
        for (int c = 0; c < columns; ++c) samples[c].push_back(values[c]);
      }
    };
    constexpr double most_parts = 200'000;  // by which works take no longer than the motion itself may
    solver.audit(most_parts);
    solver.start(0, start[0], start[1]);
    for (long pieces = 0; solver.time() < end; ++pieces) {
      if (pieces == options.most_steps) {
        outcome = {Ending::budget_spent,
                   fmt::format("{} pieces at t = {:.9g} s", pieces, static_cast<double>(solver.time()))};
        return;
      }
      if (Listening::stop_asked()) {
        outcome = {Ending::interrupted, fmt::format("{} of {} samples are kept", next, times.size())};
        return;
      }
      const Switch what = solver.advance(end);
      const double displacement = double(solver.at(solver.time()).displacement);
      if (!std::isfinite(displacement)) {
        outcome = {Ending::not_finite, fmt::format("displacement at t = {:.9g} s", double(solver.time()))};
        return;
      }
      sample_until(solver.time(), false);
      if (what == Switch::none) continue;
      event_times.push_back(solver.time());
      if (events) events->push_back({double(solver.time()), name(what), displacement});
    }
    sample_until(end, true);
    if (next < times.size())
      outcome = {Ending::interrupted, fmt::format("{} of {} samples are kept", next, times.size())};
  }
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
  Exact<long double> fine_solver(oscillator);
  const Pass<long double> fine(fine_solver, options, times, start, &result.events);
  Exact<double> coarse_solver(oscillator);
  const Pass<double> coarse(coarse_solver, options, times, start, nullptr);

  result.outcome = fine.outcome;
  double worst = 0;
  for (int c = 0; c < columns; ++c) {
    // Velocity is the drive's speed less the slip rate, and may be nothing but rounding.
    double size = c == velocity || c == slip_rate ? std::abs(oscillator.speed.level()) : 0, difference = 0;
    std::vector<double> values(fine.samples[c].begin(), fine.samples[c].end());
    for (std::size_t i = 0; i < values.size(); ++i) {
      size = std::max(size, std::abs(values[i]));
      difference = i < coarse.samples[c].size()
                       ? std::max(difference, std::abs(double(fine.samples[c][i] - coarse.samples[c][i])))
                       : infinity;
    }
    const double error = difference + std::numeric_limits<double>::epsilon() * size;
    if (size > 0) worst = std::max(worst, error / size);
    result.columns.push_back(std::move(values));
    result.column_error.push_back(error);
  }
  if (result.outcome.complete() && worst > options.tolerance)
    result.outcome = {Ending::tolerance_not_met,
                      fmt::format("rounding changes the motion by {:.1e} of its size: events nearly coincide", worst)};
  double time_error = fine.event_times.size() == coarse.event_times.size() ? 0 : infinity;
  for (std::size_t i = 0; i < fine.event_times.size() && i < coarse.event_times.size(); ++i)
    time_error = std::max(time_error, std::abs(double(fine.event_times[i] - coarse.event_times[i])));

  auto& metrics = result.metrics;
  const auto& works = fine_solver.works();
  metrics["event_time_error"] = time_error;
  metrics["stick_time"] = double(fine_solver.stick_time());
  if (fine_solver.audits()) {
    metrics["friction_work"] = double(works.friction);
    metrics["damper_work"] = double(works.damper);
    metrics["force_work"] = double(works.force);
    metrics["surface_work"] = double(works.surface);
    metrics["energy_residual"] = double(coarse_solver.works().residual);
  } else {
    result.remark = fmt::format("works are not summed up over so many swings; shorten run.duration, {:.3g} s", end);
  }
  if (std::isfinite(double(fine_solver.decision_margin())))
    metrics["decision_margin"] = double(fine_solver.decision_margin());
  if (fine_solver.chatter_events() > 0) {
    metrics["chatter_events"] = double(fine_solver.chatter_events());
    metrics["chatter_time"] = double(fine_solver.chatter_time());
  }
  result.cost.steps = coarse_solver.pieces();
}

}  // namespace rosin::analysis::motion
