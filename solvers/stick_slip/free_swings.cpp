/// The account of a slip's energy, and what it tells of the end of slip.
#include "solvers/stick_slip/free_swings.hpp"

#include <cmath>
#include <limits>

namespace rosin::solvers::stick_slip {

void SlipEnergy::begin_at_rest(const double* y) {
  done_ = {};
  before_.reset();
  if (!swings_) return;
  before_ = swings_->swing(y);
}

SlipEnergy::Work SlipEnergy::with(const steps::Collocation& step) const {
  Work work = done_;
  stage_.resize(step.state().size());  // only for the first step of all
  for (int i = 0; i < steps::Collocation::stages; ++i) {
    step.stage(i, stage_.data());
    const double weight = steps::RadauTableau::get().b[i] * step.length();
    const double power = weight * swings_->power(step.stage_time(i), stage_.data());
    work.sum += power, work.size += std::abs(power);
  }
  return work;
}

void SlipEnergy::add(const steps::Collocation& step) {
  if (before_) done_ = with(step);
}

/// The swing that friction turns by itself, so that slip does no more than touch rest.
double SlipEnergy::turning_swing(double t, const double* y) const {
  return std::abs(swings_->power(t, y) / (2 * swings_->velocity_at_rest()));
}

/// The swing at rest is then wider than where friction alone turns it.
bool SlipEnergy::rests(const steps::Collocation& step, double t, const double* y) const {
  const Work work = with(step);
  const double turn = turning_swing(t, y);
  return *before_ * *before_ + work.sum + in_doubt_ * work.size > turn * turn;
}

/// Short of steady sliding, to which the spring turns it.
std::optional<SlipEnergy::Rest> SlipEnergy::put_at_rest(const steps::Collocation& step, double direction,
                                                        double* y) const {
  constexpr double digit = std::numeric_limits<double>::epsilon(), digits = 4 * digit, least = 1e-15;
  const Work work = with(step);
  const double before = *before_ * *before_, square = before + work.sum;
  if (!(square > 0)) return std::nullopt;
  const double seen = swings_->swing(y), V = swings_->velocity_at_rest();
  double swing = -direction * std::sqrt(square);
  if (constexpr double alike = 0.1; std::abs(seen + swing) < alike * std::abs(swing)) swing = -swing;
  swings_->set_swing(swing, y);
  const double error = std::max(tolerance_, least) * work.size + digits * before;
  // Slip that does no more than touch rest ends at the place where friction turns it: of how near it has come to that
  // the last digits of its swing tell, and of the place itself then not even the energy.
  const double turn = turning_swing(step.time(), step.state().data()), beyond = std::sqrt(square) - turn;
  const double place = std::hypot(beyond, std::sqrt(digit) * swings_->swing_of_drive()) - std::abs(beyond);
  const double known = error / (2 * std::abs(swing)) + turn / std::abs(swing) * place;
  return Rest{.later = (swing - seen) / V, .known = known / std::abs(V)};
}

}  // namespace rosin::solvers::stick_slip
