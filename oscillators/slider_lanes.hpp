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
  /// True if the law is set-valued: each lane then slips in one direction, or sticks.
  bool switches() const { return switches_; }
  /// As SwitchingSystem::set_direction, of one lane: ±1 for slip, 0 for stick.
  void set_direction(int lane, double direction) { direction_.set(lane, direction); }
  const Lanes& direction() const { return direction_; }

  void use_packs(int packs) override;
  int size() const override { return mechanical_ + contact_->unknowns(); }
  void mass(Lanes* m) const override;
  void evaluate(const Lanes* y, Lanes* f) const override;
  void linearise(const Lanes* y, Lanes* f, Lanes* jacobian) const override;
  void scale(const Lanes* y, const Lanes* jacobian, Lanes* s) const override;

  /// Slip rate of the contact, coefficient of friction.
  void contact_slip_rate(const Lanes* y, Lanes& v) const;
  void friction_coefficient(const Lanes* y, Lanes& mu) const;
  /// The rate (1/s) at which slip feeds its own growth most, by itself or by way of one state, 0 where it does not, and
  /// the rate of change of the slip rate (m/s²).
  void pace(const Lanes* y, Lanes& growth_rate, Lanes& acceleration) const;

 private:
  template <class Kernel>
  void for_each_pack(const Kernel&) const;
  void mechanics(const Lanes* y, const Lanes& F, Lanes* f) const;
  void imposed_slip_rate(const Lanes* y, Lanes& u) const;
  void forgive_states(const Lanes* jacobian, Lanes* s) const;
  /// 1 in slip, 0 in stick.
  ROSIN_INLINE Pack slips(int p) const { return direction_.pack[p] * direction_.pack[p]; }

  static constexpr int capacity = Slopes<double>::capacity + 2;  ///< most unknowns
  std::shared_ptr<const FrictionLaw> law_;
  ContactSetup setup_;
  Mechanics mechanics_;
  int mechanical_;
  bool rigid_, switches_, forgives_;
  int contact_slip_rate_;  ///< its index among the unknowns, or −1
  std::unique_ptr<Contact<Lanes>> contact_;
  Lanes mass_{}, stiffness_{}, damping_{}, speed_{}, load_{}, force_{}, direction_ = 1.0, none_ = 0.0;
  std::vector<Lanes> scale_;
  Lanes loading_time_ = 0.0;  ///< in which the drive loads the contact by its direct effect, s
};

}  // namespace rosin::oscillators
