/// Reciprocating sliding: friction against displacement closes a loop, whose area is the energy of a cycle.
///
/// Where the force passes through zero the contact itself does not slip, so that the slope of the loop there is the
/// tangential stiffness in series with it (R. D. Mindlin, J. Appl. Mech. 16, 259-268, 1949, for partial slip; here one
/// contact).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/lab/tools.hpp"

namespace rosin::analysis::lab {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Trapezoids of force over displacement in [begin, end].
double loop_energy(const Record& record, double begin, double end) {
  const auto &t = record.time, &F = record.column("friction_force"), &x = record.column("stroke");
  const auto [first, last] = between(t, begin, std::nextafter(end, infinity));
  double energy = 0;
  for (std::size_t i = first + 1; i < last; ++i) energy += 0.5 * (F[i] + F[i - 1]) * (x[i] - x[i - 1]);
  return energy;
}

/// dF/dx where F first passes through zero after `begin`; infinite where it does so at once.
double slope_at_zero(const Record& record, double begin, double end) {
  const auto &t = record.time, &F = record.column("friction_force"), &x = record.column("stroke");
  const auto [first, last] = between(t, begin, end);
  for (std::size_t i = std::max<std::size_t>(first, 2); i + 2 < last; ++i)
    if (F[i - 1] * F[i] < 0 || F[i] == 0) {
      // the cubic through four points, differentiated at its zero (by differences of its inverse, x over F)
      const double slope = (F[i] - F[i - 1]) / (x[i] - x[i - 1]);
      const double wide = (F[i + 1] - F[i - 2]) / (x[i + 1] - x[i - 2]);
      return std::abs(wide / slope - 1) < 0.2 ? slope + (slope - wide) / 8 : infinity;
    }
  return infinity;
}

Result perform_reciprocation(const Task& task) {
  Result result;
  Task pulled = task;
  pulled.model.drive.force = 0.0;
  const auto machine = machine_of(pulled);
  const auto& settings = task.settings;
  const double X = settings.number("amplitude"), omega = two_pi * settings.number("frequency");
  const int cycles = settings.count("cycles"), samples = 4 * settings.count("samples");
  const Signal speed(Signal::Harmonics{0, {{X * omega, omega, 0}}});
  // Even in the phase near reversals, at which friction turns over at once: denser by a sine there.
  const double quarter = two_pi / omega / 4;
  std::vector<double> times = {0};
  for (int q = 0; q < 4 * cycles; ++q)
    for (int i = 1; i <= samples; ++i) {
      const double part = double(i) / samples, to_reversal = q % 2 == 0 ? 1 - std::pow(1 - part, 3) : std::pow(part, 3);
      times.push_back(quarter * (q + to_reversal));
    }
  // The last cycle begins at the reversal before last but one, so that it is closed.
  const double end = quarter * (4 * cycles - 1), begin = end - 4 * quarter, past_end = std::nextafter(end, infinity);
  if (const auto* model = machine->curve()) {
    std::vector<double> rates;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const bool reversal = i > 0 && i % samples == 0 && i / samples % 2 == 1;  // the motion before it goes on to it
      rates.push_back(reversal ? 1e-6 * rates.back() : X * omega * std::cos(omega * times[i]));
    }
    record_curve(result, *model, times, rates);
  } else {
    record_run(result, task, motion_of(*machine, speed), motion::Start{}, times,
               {{begin, past_end, true}, {begin, past_end, false}});
  }
  if (!result.outcome.complete()) return result;
  std::vector<double> stroke;
  for (const double t : result.record.time) stroke.push_back(X * std::sin(omega * t));
  result.record.add("stroke", "m", std::move(stroke));
  for (int q = 1; q <= 4 * cycles; ++q) result.record.breaks.push_back(quarter * q);

  read_off(result, task.sensor, [&](const Record& seen) -> std::vector<Reading> {
    const auto& F = seen.column("friction_force");
    const double most =
        std::max(extreme(seen, F, {begin, past_end, true}).value, -extreme(seen, F, {begin, past_end, false}).value);
    const double energy = loop_energy(seen, begin, end), stiffness = slope_at_zero(seen, begin, begin + 2 * quarter);
    return {{"energy_per_cycle", "J", "area of the last loop of force over stroke", energy},
            {"mean_friction", "1", "energy over 4 strokes and the load", energy / (4 * X * machine->normal_load())},
            {"force_max", "N", "largest friction force", most},
            {"contact_stiffness", "N/m", "slope of the loop at zero force, where the contact itself does not slip",
             std::isfinite(stiffness) ? stiffness : std::nan("")},
            {"previous_energy", "J", "area of the loop before", loop_energy(seen, begin - 4 * quarter, begin)}};
  });
  const auto& seen = result.record;
  const double now = result.reading("energy_per_cycle").value, before = result.reading("previous_energy").value;
  if (task.sensor.ideal() && std::abs(now - before) > 1e-3 * std::abs(now))
    result.warnings.push_back(
        fmt::format("the last two loops differ by {:.1e}: raise lab.cycles", std::abs(before / now - 1)));
  result.panels = {{.x_label = "stroke",
                    .x_unit = "m",
                    .y_label = "friction force F",
                    .y_unit = "N",
                    .curves = {{"", seen.column("stroke"), seen.column("friction_force")}}},
                   {.x_label = "slip rate v",
                    .x_unit = "m/s",
                    .y_label = "friction force F",
                    .y_unit = "N",
                    .curves = {{"", seen.column("slip_rate"), seen.column("friction_force")}}}};
  return result;
}

}  // namespace

Experiment reciprocation() {
  return {
      .name = "reciprocation",
      .title = "Reciprocating sliding",
      .settings = {{.quantity = {"amplitude", "m", {1e-12, 1e3}, "half of the stroke"}, .value = 1e-3},
                   {.quantity = {"frequency", "Hz", {1e-9, 1e6}, "strokes there and back per second"}, .value = 1.0},
                   {.quantity = {"cycles", "1", {3, 1000}, "cycles, of which the last is read"},
                    .value = 4.0,
                    .whole = true},
                   {.quantity = {"samples", "1", {8, 1e5}, "fours of samples of each quarter cycle"},
                    .value = 100.0,
                    .whole = true}},
      .slider = {.mass = 0, .stiffness = infinity, .damping = 0},
      .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
      .extra_columns = {"stroke"},
      .prescribed = {"drive.speed", "drive.force"},
      .protocol = perform_reciprocation};
}

}  // namespace rosin::analysis::lab
