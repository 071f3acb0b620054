/// Motion in the plane under friction that remembers and is smooth through rest: a contact that holds creeps.
#pragma once
#include <memory>
#include <vector>

#include "solvers/steps/collocation.hpp"
#include "solvers/stick_slip/plane_contact.hpp"

namespace rosin::solvers::stick_slip {

/// Solves m ẍᵢ + cᵢ ẋᵢ + kᵢ xᵢ = fᵢ(t) + Fᵢ by collocation, friction F that of a PlaneContact at slip rate u = V − ẋ,
/// which is along F as on a line. Unknowns are x, u and those of the contact: next to rest u keeps its digits, which
/// ẋ would lose beside V.
class PlaneCreep final : public PlaneSolver {
 public:
  /// `tolerance`: relative tolerance of displacements and times. `stick_threshold`: slower than this part of
  /// reference_speed() counts as stick, and steps end where it begins and ends; 0: nothing does. \throws InputError for
  /// parameters that are not above 0, and loads that fall to 0 or below.
  PlaneCreep(PlaneMass, PlaneFriction, double tolerance = 1e-12, double stick_threshold = 0);
  ~PlaneCreep() override;

  /// Sizes of the entries of a state, by which errors are measured.
  std::vector<double> sizes() const;
  /// The slip rate that counts as fast: that of the surface, or on one at rest a part of what forces make.
  double reference_speed() const { return reference_speed_; }

  void start(double t, const std::vector<double>& state) override;
  std::vector<double> state() const override;
  Outcome advance(double limit, Switch& switched) override;
  int parts() const override;
  Seen at(double t, bool near = false) override;
  bool sticking() const override { return sticks_; }
  double stick_time() const override { return stick_time_; }
  long steps() const override;

 private:
  class Motion;
  void take(const std::vector<double>& y);

  double reference_speed_, stick_speed_;
  PlaneContact contact_;
  double near_rest_ = 0;  ///< m/s
  std::unique_ptr<Motion> motion_;
  std::unique_ptr<steps::Collocation> collocation_;
  bool fresh_ = true;  ///< a new piece of the drive begins at t1_
  bool sticks_ = false;
  double stick_time_ = 0;
  std::vector<double> y_;
};

}  // namespace rosin::solvers::stick_slip
