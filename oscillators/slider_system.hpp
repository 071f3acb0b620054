/// The slider's equations: mechanics and contact assembled into a System.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/switching.hpp"
#include "oscillators/contact_rows.hpp"
#include "oscillators/model.hpp"

namespace rosin::oscillators {

/// Mechanical unknowns, before those of the contact.
enum class Mechanics {
  inertial,  ///< (x, u): m u̇ = m V̇ + k x + c (V − u) − F − f, ẋ = V − u
  damped,    ///< (x): no mass; u = V − (F + f − k x)/c
  elastic,   ///< none: no mass, no damper; k x = F + f, the spring acts in series with the contact
};

/// Observable quantities of the slider at one instant.
struct Observation {
  double displacement, velocity, slip_rate, friction_force, friction_coefficient;
  double acceleration;        ///< m/s², by the equation of motion; NaN without mass
  std::vector<double> state;  ///< natural units
};

/// A slider with one contact. u = V − ẋ is the slip rate that the slider imposes.
class SliderSystem final : public SwitchingSystem {
 public:
  /// `unknowns`: unknowns of the contact; states replace Unknowns::friction for laws without explicit slip rate.
  explicit SliderSystem(Model model, Unknowns unknowns = Unknowns::friction);

  int size() const override { return mechanical_ + rows_.contact->unknowns(); }
  void mass(double t, double* m) const override;
  void evaluate(double t, const double* y, double* f) const override;
  void linearise(double t, const double* y, double* f, double* jacobian) const override;
  void scale(const double* y, double* s) const override;
  std::string unknown(int i) const override;
  double next_break(double t) const override;
  void cross_break(double t, double* y) const override;
  /// Limits the additional creep (see ContactRows) for a motion of this duration (s). The creep makes friction lag
  /// behind a change of load by creep·m/N, the time in which the mass takes up the creep rate; the limit keeps this lag
  /// below 1e-12 of the duration.
  void limit_creep_for(double duration);
  /// Takes y at t = 0 as the origin of displacement and forces if the forces balance in it during slip. The balance is
  /// then exact, where k x − F would keep the rounding error of both. Sets the displacement of y to 0; does nothing
  /// where forces do not balance.
  void measure_from_balance(std::vector<double>& y);
  bool autonomous() const override { return is_constant_; }
  void kinks(double t, const double* y, std::vector<double>& values) const override;
  /// Sets whether a reversal of the contact's slip counts as a kink, because the rates of states have one there.
  void mark_reversals(bool yes) { marks_reversals_ = yes; }
  double resolution() const override;
  bool has_flow() const override { return flow_ != nullptr; }
  void flow(const Pack& t, const Pack* y, Pack* rate, Pack& pace) const override;
  void restore(double t, double* y) const override;

  const Model& model() const { return model_; }
  Mechanics mechanics() const { return mechanics_; }
  const ContactSetup& contact_setup() const { return rows_.setup; }
  /// Index of the slip rate among the unknowns, or −1 where it is no unknown.
  int slip_rate_index() const { return mechanics_ == Mechanics::inertial ? 1 : -1; }
  /// Index of the contact's own slip rate among the unknowns, or −1 where it is no unknown.
  int contact_slip_rate_index() const {
    return rows_.slip_rate_place() < 0 ? -1 : mechanical_ + rows_.slip_rate_place();
  }
  /// Index of the first state among the unknowns, if states are unknowns.
  int first_state() const { return mechanical_ + rows_.first_state(); }
  bool carries_friction() const { return rows_.carries_friction(); }
  /// Direct effect v·∂μ/∂v in steady sliding, the natural size of changes of a friction unknown.
  double direct_effect() const { return rows_.weight[0] / 10; }
  bool rigid() const { return rows_.rigid(); }

  /// The unknowns at displacement x, slip rate u and natural states; friction from the law where the contact is rigid,
  /// else `friction` (the force F in the contact spring).
  std::vector<double> unknowns_at(double t, double x, double u, std::span<const double> state, double friction) const;
  /// Steady sliding at time t.
  std::vector<double> steady(double t) const;
  /// Rest on a steady drive under a set-valued law, with natural `state`, loaded to `share` of the contact's limit.
  std::vector<double> loaded_at_rest(std::span<const double> state, double share) const;
  /// As scale() at rest, with scales up to ten times larger for states that hardly affect friction. For methods whose
  /// stiff unknowns are no more accurate than their error estimate.
  void relevance_scale(double* s) const;
  /// Makes friction in y agree with slip rate and states where it is algebraic; for constant drives.
  void make_consistent(double* y) const { cross_break(0, y); }
  /// Observable quantities at time t in y.
  Observation observe(double t, const double* y) const;
  /// Coefficient of friction, from the unknown or from the law.
  double friction_coefficient(double t, const double* y) const;
  /// Slip rate u at time t in y.
  double slip_rate(double t, const double* y) const;
  /// The slip rate of the contact itself, equal to u where the contact is rigid. Behind a contact spring the slider
  /// rings, and u crosses the drive speed many times during one stick, which the contact's slip rate does not.
  double contact_slip_rate(double t, const double* y) const;

  /// Second and third derivative of f along a direction d: d²f(y + ε d)/dε² and d³f(y + ε d)/dε³ at ε = 0.
  void expand(double t, const double* y, const double* direction, double* second, double* third) const;
  /// ∂(contact slip rate)/∂y.
  void slip_rate_gradient(double t, const double* y, double* gradient) const;

  int contacts() const override { return set_valued_ ? 1 : 0; }
  /// The mode of a set-valued law; under a spring of infinite stiffness the direction of the drive.
  ContactMode mode(int = 0) const override { return mode_; }
  void set_mode(int, ContactMode mode) override { mode_ = mode; }
  int slip_rate_unknown(int) const override { return slip_rate_index(); }
  double displacement(int, const double* y) const override { return y[0]; }
  double reference_speed(int = 0) const override { return reference_speed_; }
  void held(double t, const double* y, Held* held) const override;
  void slip_accelerations(double t, const double* y, double* acceleration) const override;
  void stop(int, double* y) const override;
  void release(int, double t, double* y) const override;
  /// The force and the limit of `held`.
  double holding_force(double t, const double* y) const;
  double holding_limit(double t, const double* y) const;

  /// True where slip between two stops is a nearly free oscillation (a swing), whose end follows from its energy.
  bool swings_freely() const { return swings_freely_; }
  /// Displacement from steady sliding (m), and its assignment.
  double swing(const double* y) const { return y[0] - swing_center_; }
  void set_swing(double swing, double* y) const { y[0] = swing_center_ + swing; }
  /// Rate at which friction and damping change the squared amplitude of the oscillation, m²/s.
  double swing_power(double t, const double* y) const;

 private:
  struct Forcing {
    double speed, speed_rate, load, load_rate, force, force_rate;
  };
  Forcing forcing(double t) const;
  /// The same at eight times.
  struct LaneForcing {
    Pack speed, speed_rate, load, load_rate, force_rate;
    LaneForcing() = default;
    explicit LaneForcing(const Forcing& now)
        : speed(now.speed),
          speed_rate(now.speed_rate),
          load(now.load),
          load_rate(now.load_rate),
          force_rate(now.force_rate) {}
    void set(int lane, const Forcing& now) {
      speed.block[lane] = now.speed, speed_rate.block[lane] = now.speed_rate;
      load.block[lane] = now.load, load_rate.block[lane] = now.load_rate;
      force_rate.block[lane] = now.force_rate;
    }
  };
  double imposed_slip_rate(const Forcing&, const double* y, double F) const;
  /// m u̇ at displacement x, slip rate u and friction force F.
  double momentum_rate(const Forcing&, double x, double u, double F) const;
  void settle(double t, double* y) const;

  Model model_;
  Mechanics mechanics_;
  int mechanical_ = 0;  ///< number of mechanical unknowns
  ContactRows rows_;
  std::unique_ptr<ContactValues<Tower>> tower_;
  std::unique_ptr<ContactFlow> flow_;  ///< null where the system has no form as a flow
  ContactMode mode_ = ContactMode::forward;
  double reference_speed_;
  double displacement_scale_ = 1, state_clock_ = 1;
  struct Origin {
    double displacement, friction, force, drag;
  };
  Origin origin_{};  ///< origin of the displacement unknown, and the forces that balance there
  Forcing constant_{};
  LaneForcing constant_in_lanes_{};
  bool is_constant_, set_valued_, marks_reversals_ = false;
  bool swings_freely_ = false;
  /// Displacement and coefficient of friction in steady sliding, set where swings_freely_.
  double swing_center_ = 0, steady_coefficient_ = 0;
  bool sticking() const { return set_valued_ && mode_ == ContactMode::stick; }
  double holding_rounding(double t, const double* y) const;
};

/// Fills in the entries of a Jacobian that inertia couples: the rows of displacement and slip rate of a slider with
/// mass, and their columns in the rows of its contact. `jacobian`: derivative by these two and the contact's unknowns,
/// row-major; other entries stay as they are.
void couple_by_inertia(const Slider&, const Slopes<double>& contact, int contact_unknowns, double* jacobian);

}  // namespace rosin::oscillators
