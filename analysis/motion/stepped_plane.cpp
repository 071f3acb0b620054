/// The slider in the plane as an oscillator followed by steps.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/motion/stepped_oscillator.hpp"

namespace rosin::analysis::motion {

using solvers::stick_slip::PlaneSolver;
using solvers::stick_slip::PlaneVector;

namespace {

class PlaneMotion final : public SteppedMotion {
 public:
  PlaneMotion(const PlaneModel& model, double tolerance)
      : surface_(model.mass.surface_velocity), solver_(solver_of(model, tolerance, usual_stick_threshold)) {}

  void start(double t, const std::vector<double>& y) override { solver_->start(t, y); }
  Outcome advance(double limit) override {
    solvers::stick_slip::Switch what;
    return solver_->advance(limit, what);
  }
  double time_before() const override { return solver_->time_before(); }
  double time() const override { return solver_->time(); }
  std::vector<double> state() const override { return solver_->state(); }
  int parts() const override { return solver_->parts(); }
  void observe(double t, bool near, double* row) override {
    const auto seen = solver_->at(t, near);
    const auto &x = seen.displacement, &v = seen.velocity, &F = seen.friction;
    const double w[] = {v[0] - surface_[0], v[1] - surface_[1]};
    const double values[] = {x[0],
                             x[1],
                             v[0],
                             v[1],
                             F[0],
                             F[1],
                             solver_->sticking() ? 1.0 : 0.0,
                             std::hypot(w[0], w[1]),
                             -(F[0] * w[0] + F[1] * w[1])};
    std::ranges::copy(values, row);
  }

 private:
  PlaneVector surface_;
  std::unique_ptr<PlaneSolver> solver_;
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
  oscillator.start = start_of(model);
  oscillator.size = sizes_of(model);
  oscillator.motion = [model](double tolerance, bool finer) {
    constexpr double by = 1.0 / 30;
    return std::make_unique<PlaneMotion>(model, std::clamp(1e-3 * tolerance * (finer ? by : 1), 1e-13, 1e-9));
  };
  oscillator.starts.assign(oscillator.channels.begin(), oscillator.channels.begin() + 4);
  oscillator.start_sizes.assign(oscillator.size.begin(), oscillator.size.begin() + 4);
  oscillator.start_at = [model](std::span<const std::optional<double>> values) {
    auto from = model;
    double* const numbers[] = {&from.displacement[0], &from.displacement[1], &from.velocity[0], &from.velocity[1]};
    for (std::size_t i = 0; i < std::size(numbers); ++i) *numbers[i] = values[i].value_or(*numbers[i]);
    return start_of(from);
  };
  return oscillator;
}

}  // namespace rosin::analysis::motion
