/// The slider as an oscillator whose energy tells where slip ends.
#pragma once
#include "oscillators/slider_system.hpp"
#include "solvers/stick_slip/free_swings.hpp"

namespace rosin::analysis::motion {

class SliderSwings final : public solvers::stick_slip::FreeSwings {
 public:
  /// \param slider  outlives this
  explicit SliderSwings(const oscillators::SliderSystem& slider) : slider_(slider) {}
  /// For a solver: nullptr where the slider does not swing freely.
  const FreeSwings* present() const { return slider_.swings_freely() ? this : nullptr; }
  double swing(const double* y) const override { return slider_.swing(y); }
  void set_swing(double swing, double* y) const override { slider_.set_swing(swing, y); }
  double velocity_at_rest() const override { return slider_.model().drive.speed.level(); }
  double swing_of_drive() const override {
    const auto& s = slider_.model().slider;
    return velocity_at_rest() * std::sqrt(s.mass / s.stiffness);
  }
  double power(double t, const double* y) const override { return slider_.swing_power(t, y); }

 private:
  const oscillators::SliderSystem& slider_;
};

}  // namespace rosin::analysis::motion
