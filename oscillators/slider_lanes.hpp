/// The slider's equations for 32 sliders of one kind at once.
#pragma once
#include <memory>

#include "core/lane_system.hpp"
#include "oscillators/slider_system.hpp"

namespace rosin::oscillators {

/// Sliders under constant drives that share law, mechanics and unknowns and differ in parameters: SliderSystem in
/// lanes, with the same unknowns in the same order.
class SliderLanes final : public LaneSystem {
 public:
  /// All lanes begin as `pattern`. \throws InputError if its drive varies with time.
  explicit SliderLanes(const SliderSystem& pattern);
  /// True if a lane can carry this slider.
  bool fits(const SliderSystem&) const;
  /// Gives one lane the parameters of a slider that fits.
  void load(int lane, const SliderSystem&);

  int size() const override { return mechanical_ + contact_->unknowns(); }
  void mass(Lanes* m) const override;
  void evaluate(const Lanes* y, Lanes* f) const override;
  void linearise(const Lanes* y, Lanes* f, Lanes* jacobian) const override;
  void scale(const Lanes* y, Lanes* s) const override;

  /// Slip rate of the contact, coefficient of friction.
  void contact_slip_rate(const Lanes* y, Lanes& v) const;
  void friction_coefficient(const Lanes* y, Lanes& mu) const;
  /// Coefficient of steady sliding at slip rate v.
  void steady_friction(const Lanes& v, Lanes& mu) const { contact_->steady_friction(v, load_, mu); }

 private:
  void mechanics(const Lanes* y, const Lanes& F, Lanes* f) const;
  void imposed_slip_rate(const Lanes* y, Lanes& u) const;

  std::shared_ptr<const FrictionLaw> law_;
  ContactSetup setup_;
  Mechanics mechanics_;
  int mechanical_;
  bool rigid_;
  int contact_slip_rate_;  ///< its index among the unknowns, or −1
  std::unique_ptr<Contact<Lanes>> contact_;
  Lanes mass_, stiffness_, damping_, speed_, load_, force_, direction_ = 1.0, none_ = 0.0;
  std::vector<Lanes> scale_;
};

}  // namespace rosin::oscillators
