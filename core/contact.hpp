/// The one form in which any contact answers a solver: M·ż = g(u, N, z), F = F(u, N, z).
///
/// u is the relative speed that the oscillator imposes, N the normal load, z the contact's own unknowns and M a
/// diagonal mass. Solvers and oscillators see contacts only through this form and never a friction law.
#pragma once
#include <span>
#include <vector>

#include "core/dual.hpp"
#include "core/parameters.hpp"

namespace rosin {

/// Which unknowns a contact carries.
enum class Unknowns {
  friction,  ///< z = (μ, states): g₀ = u − v(μ, states); needs an explicit slip rate v, robust in near-stick
  states,    ///< z = (states): F = N·μ(u, states)
};

/// A spring with a damper beside it, in series with a law: F = k·e + c·ė, k = 1/(compliance + compliance_per_load/N),
/// c = damping + damping_per_load·N. Its deflection e is an unknown of the contact.
struct SeriesSpring {
  double compliance = 0;           ///< m/N
  double compliance_per_load = 0;  ///< m
  double damping = 0;              ///< N s/m
  double damping_per_load = 0;     ///< s/m
  bool present() const { return compliance > 0 || compliance_per_load > 0; }
};

/// What surrounds a law in a contact.
struct ContactSetup {
  double lambda = 1;               ///< clock factor of the states; 0: states in equilibrium, a friction curve
  double compliance = 0;           ///< 1/k_t of an undamped series spring independent of load, m/N
  double compliance_per_load = 0;  ///< N/k_t of an undamped series spring proportional to load, m
  Unknowns unknowns = Unknowns::friction;
  SeriesSpring spring = {};  ///< where it is damped, or no friction unknown carries it
  double load_memory = 0;    ///< α: at constant slip rate, states change so that dμ = −α dN/N
};

/// A direction in which the numbers that make a contact change.
struct ContactChange {
  std::vector<double> parameters = {};  ///< slope of each of the law's, in the order of its table; empty: they stand
  ContactSetup setup = {.lambda = 0};   ///< slope of each number of the setup
};

/// What the oscillator imposes on a contact.
template <class Real>
struct ContactInput {
  Real slip_rate;    ///< u, m/s
  Real normal_load;  ///< N, newton
  Real load_rate;    ///< dN/dt, N/s; matters to an undamped series spring that does not scale with load, and to states
                     ///< that remember the load
  Real direction;    ///< +1 or −1: direction of slip, used by set-valued laws only
};

/// ∂g/∂(z, u, N) and ∂F/∂(z, u, N). Row-major; `g_z` is unknowns × unknowns.
template <class Real>
struct Slopes {
  static constexpr int capacity = 16;  ///< most unknowns of one contact: of a law, its heat, and a spring
  Real g_z[capacity * capacity], g_u[capacity], g_N[capacity];
  Real F_z[capacity], F_u, F_N;
};

/// A contact evaluated in the scalar type Real: double, Lanes (32 systems at a time) or Tower (third derivatives).
template <class Real>
class ContactValues {
 public:
  virtual ~ContactValues() = default;
  /// Number of unknowns z.
  virtual int unknowns() const = 0;
  /// g (unknowns) and the friction force F in newton, positive along u.
  virtual void evaluate(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const = 0;
  /// Diagonal of M at load N: N/k_t for the friction row, λ for states, 1 for a deflection; 0 marks an algebraic row.
  virtual void mass(const Real& N, Real* m) const = 0;
};

/// As ContactValues, with first derivatives, starts and error weights.
template <class Real>
class Contact : public ContactValues<Real> {
 public:
  virtual void linearise(const ContactInput<Real>& in, const Real* z, Real* g, Real& F, Slopes<Real>& slopes) const = 0;
  /// Coefficient of steady sliding at slip rate u and load N.
  virtual void steady_friction(const Real& u, const Real& N, Real& mu) const = 0;
  /// Replaces the parameters of one lane (lane 0 of a double contact). `parameters` in the order of the law's table.
  /// Lists are shared by all lanes. \throws InputError if the setup changes the number of unknowns.
  virtual void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) = 0;
  /// Steady sliding at slip rate u and load N: z, and for each unknown the size that an error is measured by.
  virtual void steady(int lane, double u, double N, double* z, double* weight) const = 0;
  /// ∂μ/∂z of each state unknown at fixed slip rate, in steady sliding at u and N.
  virtual void friction_slopes(int lane, double u, double N, double* slopes) const = 0;
  /// What a sudden change of the load from N to `changed`, at slip rate v, makes of the unknowns of lane 0. By default
  /// nothing: only states that remember the load notice.
  virtual void change_load([[maybe_unused]] double v, [[maybe_unused]] double N, [[maybe_unused]] double changed,
                           [[maybe_unused]] double* z) const {}
};

/// A contact that carries friction, no spring and no memory of the load, as a flow: eight of its states at once.
class ContactFlow {
 public:
  virtual ~ContactFlow() = default;
  /// Number of unknowns z: μ and the states.
  virtual int unknowns() const = 0;
  /// Its own slip rate v and the rates g of its states (as unknowns, for λ = 1), and their slopes by z at a given load:
  /// `v_z` (unknowns) and `g_z` (states × unknowns, row-major).
  virtual void slip(const Pack& N, const Pack* z, Pack& v, Pack* g, Pack* v_z, Pack* g_z) const = 0;
};

}  // namespace rosin
