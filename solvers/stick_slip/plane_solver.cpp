/// Scales and energies of a mass in the plane.
#include "solvers/stick_slip/plane_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rosin::solvers::stick_slip {

PlaneSolver::PlaneSolver(PlaneMass mass, double friction) : mass_(std::move(mass)) {
  const auto& m = mass_;
  double force = friction;
  const auto include_frequencies = [&](const Signal& signal) {
    for (const auto& term : signal.piece(0).terms) fastest_ = std::max(fastest_, term.angular_frequency);
  };
  include_frequencies(m.load);
  double slowest = infinity;
  for (int d = 0; d < 2; ++d) {
    if (!(m.mass > 0 && m.stiffness[d] > 0)) throw InputError("a plane slider needs a mass and two springs above 0");
    include_frequencies(m.force[d]);
    const double natural = std::sqrt(m.stiffness[d] / m.mass);
    fastest_ = std::max(fastest_, natural), slowest = std::min(slowest, natural);
    force += std::abs(m.force[d].level());
    for (const auto& term : m.force[d].piece(0).terms) force += std::abs(term.amplitude);
  }
  if (!m.load.within({1e-300, infinity}))
    throw InputError(
        fmt::format("in the plane the load must stay above 0; about a mean of {} N amplitudes may add up to "
                    "less than that",
                    m.load.level()));
  speed_scale_ = force / (m.mass * slowest);
}

PlaneVector PlaneSolver::balance(double t, const PlaneVector& x, const PlaneVector& v) const {
  PlaneVector R;
  for (int d = 0; d < 2; ++d) R[d] = mass_.force[d].value(t) - mass_.damping[d] * v[d] - mass_.stiffness[d] * x[d];
  return R;
}

double PlaneSolver::energy(const PlaneVector& x, const PlaneVector& v) const {
  double sum = 0;
  for (int d = 0; d < 2; ++d) sum += (mass_.mass * v[d] * v[d] + mass_.stiffness[d] * x[d] * x[d]) / 2;
  return sum;
}

void PlaneSolver::open_account() {
  friction_work_ = path_length_ = supplied_ = 0;
  energy_at_start_ = energy(x_, v_);
}

double PlaneSolver::energy_residual() const {
  return (energy(x_, v_) - energy_at_start_ + friction_work_ - supplied_) /
         (energy_at_start_ + friction_work_ + std::abs(supplied_) + 1e-300);
}

}  // namespace rosin::solvers::stick_slip
