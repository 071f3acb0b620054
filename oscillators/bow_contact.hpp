/// Contacts without mass between a bow and 32 strings at once, sampled in steps of one length: any friction law, with
/// the force that waves on the string leave to it.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "core/contact.hpp"
#include "laws/heat_flow.hpp"
#include "laws/law.hpp"

namespace rosin::oscillators {

/// A string answers a force f at the bow by the velocity f/Z at once, so that at each sample
///   f = Z (D − s),  f = F(s, N, ψ),
/// with D the speed of the bow against the string as waves alone would move it and s the slip rate. Where friction
/// falls with the slip rate there may be no solution or two with slip (Friedlander, Ann. N. Y. Acad. Sci. 1953). Then
/// contacts keep what they do as long as they can: stick until the force passes its limit at rest; slip, at the larger
/// of two slip rates, while there is one (McIntyre & Woodhouse 1979: hysteresis).
///
/// Heat flows through its kernel exactly at the mean of the heating at both ends of a step, which is predicted and then
/// corrected twice. Other states obey ψ̇ = g(s(ψ, D), ψ), an ordinary differential equation whose D goes evenly from
/// sample to sample. A two-stage Rosenbrock method advances it, L-stable and of second order for any Jacobian (ROS2:
/// Verwer et al., SIAM J. Sci. Comput. 20, 1999). Where friction has no limit at rest, slip rate and states are solved
/// together by the trapezoidal rule.
class BowContacts {
 public:
  /// \throws InputError for laws that carry what a bow has no place for
  BowContacts(std::shared_ptr<const FrictionLaw> law, double lambda, double step);

  /// One lane begins in stick at a load, rested, or slipping steadily at a slip rate.
  void rest(int lane, std::shared_ptr<const FrictionLaw> law, double normal_load);
  void slide(int lane, std::shared_ptr<const FrictionLaw> law, double normal_load, double slip_rate);
  /// Tells a lane another load.
  void set_load(int lane, double normal_load);

  /// One step: from the speeds D (m/s) and impedances Z (kg/s) to the forces f (N).
  void step(const Lanes& D, const Lanes& Z, Lanes& f);

  const Lanes& slip_rate() const { return slip_rate_; }  ///< s, m/s: of the bow against the string
  const Lanes& direction() const { return direction_; }  ///< ±1 in slip, 0 in stick
  /// States of the law in natural units; of laws by temperature alone, the rise of it (K).
  std::vector<double> states(int lane) const;
  static std::vector<Quantity> state_names(const FrictionLaw&);
  /// All that the next step depends on, each one number a lane, in an order of its own: the direction stands first.
  std::vector<Lanes*> memory();
  /// Steps at which no slip rate was found to the accuracy asked.
  const Lanes& unsolved() const { return unsolved_; }

  /// Slip rates below this part of the drive are rest, of laws that have no limit there.
  static constexpr double creep = 0.05;

 private:
  static constexpr int capacity = Slopes<double>::capacity;
  void solve_set_valued(const Lanes& D, const Lanes& Z, const Lanes* z, Lanes& slip_rate, Lanes& direction, Lanes& f);
  void slip(const Lanes& A, const Lanes& side, const Lanes& Z, const Lanes* z, Lanes& s, Lanes& trying);
  void follow_states(const Lanes& D, const Lanes& Z, Lanes* z);
  void step_heated(const Lanes& D, const Lanes& Z, Lanes& f);
  void step_smooth(const Lanes& D, const Lanes& Z, Lanes& f);
  void limits(const Lanes* z, Lanes& limit);
  void count_unsolved(const Lanes& open);
  ContactInput<Lanes> input(const Lanes& slip_rate, const Lanes& direction) const {
    return {slip_rate, load_, Lanes(0.0), direction};
  }

  std::shared_ptr<const FrictionLaw> laws_[lane_count];
  std::unique_ptr<Contact<Lanes>> contact_;
  ContactSetup setup_;
  int states_ = 0;
  bool set_valued_, one_friction_, limit_is_friction_, odd_;
  double step_;
  Lanes load_ = 1.0, limit_ = 0.0, slip_rate_ = 0.0, direction_ = 0.0, drive_ = 0.0, answer_ = 0.0, unsolved_ = 0.0;
  std::vector<Lanes> z_, rate_, scratch_;

  /// Of laws by temperature alone.
  struct Heat {
    explicit Heat(const laws::HeatFlow& like);
    void flow(const Lanes& heating, const Lanes& speed, Lanes* parts, Lanes& rise) const;
    std::vector<laws::HeatFlow> law;  ///< of each lane
    std::vector<const laws::HeatedFriction*> curve;
    Lanes h1 = 0.0, crowding = 1.0, heating = 0.0;  ///< heating: μ|v| times crowding
    std::vector<Lanes> parts, fades, answers;       ///< ϑ_k, e^{−step/τ_k}, (1 − e^{−step/τ_k}) ρ_k/h₀
  };
  void set_heat(int lane, double normal_load);
  std::optional<Heat> heat_;
};

}  // namespace rosin::oscillators
