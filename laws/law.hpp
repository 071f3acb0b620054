/// Friction laws: what a law is, how it is asked, and the adapter that turns one written law into all its forms.
///
/// A law is a small value type over a scalar type (see docs/write-a-law.md and examples/your_own_law.cpp). It states
///   card, parameters                          what it is
///   friction(at[, state])                     coefficient of friction
///   states, rate(at, state), steady(at)       only with states: −G, and the state of steady sliding
///   rest(at)                                  only where the state after long rest is not that of slowest creep
///   size()                                    only where a state that is not logarithmic may be 0 in steady sliding
///   slip_rate(mu, at, state)                  only where v can be solved from μ
///   linear()                                  only if set-valued and μ in motion may be c + slope·v: then c and slope
///   static_limit(at[, state])                 only if set-valued at rest; then the law is asked for v ≥ 0 alone, and
///                                             v = 0 means stick
///   after_stop(state)                         only if set-valued: what a stop makes of the states
///   kink(state)                               only where friction or rates have a kink in the states, all of them
///                                             linear: changes sign there, in numbers of the size of 1
/// General form: F = N·μ(v, ψ, N), λ·ψ̇ = −G(v, ψ, N). Signs: v > 0 along the drive, F on the slider along v.
#pragma once
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/contact.hpp"
#include "core/error.hpp"
#include "core/maths.hpp"
#include "core/parameters.hpp"
#include "core/with_log.hpp"

namespace rosin {

/// The conditions at a contact that a law answers for.
template <class Real>
struct Sliding {
  Real slip_rate;    ///< v, m/s
  Real normal_load;  ///< N, newton
};

/// Friction in motion that is linear in the speed: μ = constant + slope·|v| (slope in s/m).
struct LinearFriction {
  double constant, slope;
};

/// A named set of published parameter values.
struct Preset {
  std::string name, source;
  std::vector<Value> values;  ///< in the order of the parameters
};

/// A law of the catalogue with values of its parameters.
struct LawByName {
  std::string_view name;
  std::vector<Value> values;
};

/// A friction law with its parameter values: immutable, shared, and asked through double-valued functions or, by
/// solvers, through contacts. States are in natural units, in the order of `states()`.
class FrictionLaw {
 public:
  virtual ~FrictionLaw() = default;

  virtual const Card& card() const = 0;
  /// What is computed only nearly, and how nearly; empty if nothing is.
  virtual std::string_view approximation() const { return card().approximation; }
  virtual const std::vector<Quantity>& parameters() const = 0;
  virtual const std::vector<Quantity>& states() const = 0;
  virtual const std::vector<Preset>& presets() const = 0;
  /// Values in the order of `parameters()`.
  virtual const std::vector<Value>& values() const = 0;
  /// The same law with other values. \throws InputError for a value outside its range or of the wrong kind.
  virtual std::shared_ptr<const FrictionLaw> with(std::vector<Value> values) const = 0;

  virtual bool has_slip_rate() const = 0;
  /// True where the force at rest is any value up to ±static_limit·N (Coulomb, friction curves).
  virtual bool set_valued() const = 0;

  /// Coefficient of friction (0 at rest for set-valued laws). Mirrored motion, with the other sign of the slip rate and
  /// of odd states, has the other sign of friction.
  virtual double friction(Sliding<double> at, std::span<const double> state) const = 0;
  /// dψ/dt for λ = 1.
  virtual std::vector<double> rate(Sliding<double> at, std::span<const double> state) const = 0;
  /// ψ of steady sliding.
  virtual std::vector<double> steady(Sliding<double> at) const = 0;
  /// Slip rate at the given coefficient. \throws InputError if the law has no explicit slip rate.
  virtual double slip_rate(double mu, double normal_load, std::span<const double> state) const = 0;
  static constexpr double slowest_creep = 1e-12;  ///< m/s
  /// ψ after long rest, where a motion from rest begins: by default that of the slowest creep.
  virtual std::vector<double> rest(double normal_load) const = 0;
  /// Largest coefficient that holds at rest. \throws InputError if the law is not set-valued.
  virtual double static_limit(double normal_load, std::span<const double> state = {}) const = 0;
  /// Coefficients, if the law is set-valued and linear in the speed: motion then has a closed form between events.
  virtual std::optional<LinearFriction> linear() const { return std::nullopt; }
  /// The set-valued law that this one is at λ = 0 under that load, if its friction then jumps at rest.
  virtual std::shared_ptr<const FrictionLaw> without_clock(double /*normal_load*/) const { return nullptr; }
  /// ψ just after slip has stopped: as it was, or reset by laws that count from the last stop.
  virtual std::vector<double> after_stop(std::span<const double> state) const = 0;
  /// Changes sign, in numbers of the size of 1, where friction or the rates of the states have a kink in the states, at
  /// which a solver's step must end to keep its order; NaN where they have none. States are then linear.
  virtual double kink(std::span<const double> /*state*/) const { return NAN; }
  /// The same of the slip rate, of laws that have kinks in it.
  virtual double slip_kink(double /*slip_rate*/) const { return NAN; }

  /// Steady coefficient μ_ss(v) and its slope dμ_ss/dv (s/m).
  struct Steady {
    double friction, slope;
  };
  virtual Steady steady_friction(Sliding<double> at) const = 0;

  /// Contacts for solvers, with the wrappers that the setup asks for: load memory around the law, a series spring
  /// around both. \throws InputError if `Unknowns::friction` is asked of a law without slip_rate, and where a wrapper
  /// does not go with the law.
  std::unique_ptr<Contact<double>> contact(const ContactSetup&) const;
  std::unique_ptr<Contact<Lanes>> lanes(const ContactSetup&) const;
  /// Numbers that change have the slopes of `change` in the second direction of their towers (core/tower.hpp).
  std::unique_ptr<ContactValues<Tower>> tower(const ContactSetup&, const ContactChange& change = {}) const;

  /// \throws InputError for a law without slip_rate.
  virtual std::unique_ptr<ContactFlow> flow() const = 0;

  bool has_states() const { return !states().empty(); }
  /// True where a state is a deflection: friction then holds an elastic part, on which a mass may ring.
  bool deflects() const;
  /// Index of a parameter, or nothing.
  std::optional<std::size_t> find(std::string_view parameter) const;
  /// A scalar parameter by name. \throws InputError with the nearest name.
  double parameter(std::string_view name) const;
  /// The same law with one parameter changed. \throws InputError for an unknown name (with the nearest) or bad value.
  std::shared_ptr<const FrictionLaw> with(std::string_view name, Value value) const;

 private:
  /// The law's own contacts, without wrappers.
  virtual std::unique_ptr<Contact<double>> bare_contact(const ContactSetup&) const = 0;
  virtual std::unique_ptr<Contact<Lanes>> bare_lanes(const ContactSetup&) const = 0;
  virtual std::unique_ptr<ContactValues<Tower>> bare_tower(const ContactSetup&, const ContactChange&) const = 0;
};

namespace laws {

/// \throws InputError: the law has no slip rate to flow with.
[[noreturn]] void refuse_flow(const Card&);

/// The answer x of a law to a question. \throws InputError naming the question unless x is finite.
double finite_answer(const Card&, std::string_view question, Sliding<double> at, double x);

/// \throws InputError unless there is a value of the right kind, within its range, for each parameter.
void check_parameters(const Card&, std::span<const Quantity> parameters, std::span<const Value> values);

/// Law L as a FrictionLaw, with its default parameter values or with those of `law`. Defined in laws/adapter.hpp and
/// instantiated once in each shipped law's .cpp; for a law of your own, include the adapter.
template <template <class> class L>
std::shared_ptr<const FrictionLaw> make_law(const L<double>& law = {});

}  // namespace laws
}  // namespace rosin
