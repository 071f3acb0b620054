/// The slider in the plane as an oscillator followed by steps: events located, slip by collocation.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/motion/stepped_oscillator.hpp"
#include "laws/law.hpp"
#include "solvers/stick_slip/plane_stick_slip.hpp"

namespace rosin::analysis::motion {

using solvers::stick_slip::PlaneStickSlip;
using solvers::stick_slip::PlaneVector;

namespace {

class PlaneMotion final : public SteppedMotion {
 public:
  PlaneMotion(const PlaneModel& model, double tolerance)
      : surface_(model.mass.surface_velocity), solver_(model.mass, tolerance, slip_friction(model)) {}

  void start(double t, const std::vector<double>& y) override { solver_.start(t, {y[0], y[1]}, {y[2], y[3]}); }
  Outcome advance(double limit) override {
    solvers::stick_slip::Switch what;
    const auto outcome = solver_.advance(limit, what);
    sticks_ = solver_.sticking();
    return outcome;
  }
  double time_before() const override { return solver_.time_before(); }
  double time() const override { return solver_.time(); }
  std::vector<double> state() const override {
    const auto &x = solver_.displacement(), &v = solver_.velocity();
    return {x[0], x[1], v[0], v[1]};
  }
  int parts() const override {
    constexpr double radians = 0.5, most = 1e5;
    return int(std::min(std::ceil((time() - time_before()) * solver_.fastest() / radians) + 1, most));
  }
  void observe(double t, bool near, double* row) override {
    const auto [x, v, F] = solver_.at(t, near);
    const double w[] = {v[0] - surface_[0], v[1] - surface_[1]};
    const double values[] = {x[0],
                             x[1],
                             v[0],
                             v[1],
                             F[0],
                             F[1],
                             sticks_ ? 1.0 : 0.0,
                             sticks_ ? 0.0 : std::hypot(w[0], w[1]),
                             sticks_ ? 0.0 : -(F[0] * w[0] + F[1] * w[1])};
    std::ranges::copy(values, row);
  }

 private:
  PlaneVector surface_;
  PlaneStickSlip solver_;
  bool sticks_ = false;  ///< in the last step
};

}  // namespace

SteppedOscillator stepped(const PlaneModel& model) {
  const auto& mass = model.mass;
  const bool moves = mass.surface_velocity[0] != 0 || mass.surface_velocity[1] != 0;
  oscillators::Structure drive;  // its forces and its load
  drive.force = {mass.force[0], mass.force[1]};
  drive.contacts.emplace_back().normal_load = mass.load;
  using Kind = Channel::Kind;
  SteppedOscillator oscillator;
  oscillator.drive_period = common_period(drive);
  if (!oscillator.driven() && !moves)
    throw InputError(
        "nothing drives the slider: its surface rests, and neither force nor load varies (drive.speed, m/s)");
  oscillator.channels = {{"displacement_x", "m"},
                         {"displacement_y", "m"},
                         {"velocity_x", "m/s"},
                         {"velocity_y", "m/s"},
                         {"friction_x", "N"},
                         {"friction_y", "N"},
                         {"stick_fraction", "1", Kind::part},
                         {"slip_distance", "m", Kind::rate},
                         {"friction_work", "J", Kind::rate}};
  oscillator.coordinates = 2;
  oscillator.natural_period =
      2 * std::numbers::pi * std::sqrt(mass.mass / std::min(mass.stiffness[0], mass.stiffness[1]));
  oscillator.start = {model.displacement[0], model.displacement[1], model.velocity[0], model.velocity[1]};
  // As large as what the energy makes of each that the forces store in a spring.
  double force = mass.static_friction * mass.load.level();
  for (int d = 0; d < 2; ++d) {
    force +=
        std::abs(mass.force[d].level()) + std::abs(mass.surface_velocity[d]) * std::sqrt(mass.stiffness[d] * mass.mass);
    for (const auto& term : mass.force[d].piece(0).terms) force += std::abs(term.amplitude);
  }
  const double energy = force * force / std::min(mass.stiffness[0], mass.stiffness[1]);
  for (const double stiffness : {mass.stiffness[0], mass.stiffness[1], mass.mass, mass.mass})
    oscillator.size.push_back(std::sqrt(energy / stiffness));
  oscillator.motion = [model](double tolerance, bool finer) {
    constexpr double by = 1.0 / 30;
    return std::make_unique<PlaneMotion>(model, std::clamp(1e-3 * tolerance * (finer ? by : 1), 1e-13, 1e-9));
  };
  oscillator.starts.assign(oscillator.channels.begin(), oscillator.channels.begin() + 4);
  oscillator.start_sizes = oscillator.size;
  oscillator.start_at = [start = oscillator.start](std::span<const std::optional<double>> values) {
    auto state = start;
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = values[i].value_or(state[i]);
    return state;
  };
  return oscillator;
}

}  // namespace rosin::analysis::motion
