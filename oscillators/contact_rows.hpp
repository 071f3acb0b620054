/// A contact as rows of an oscillator's equations: how it is set up, the order and sizes of its unknowns, and what
/// follows from them alone.
#pragma once
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/contact.hpp"
#include "laws/law.hpp"
#include "oscillators/model.hpp"

namespace rosin::oscillators {

/// States of logarithmic scale are carried as logarithms.
inline double to_unknown(const Quantity& state, double value) {
  return state.scale == Scale::log ? std::log(value) : value;
}
inline double to_state(const Quantity& state, double unknown) {
  return state.scale == Scale::log ? std::exp(unknown) : unknown;
}

/// The unknowns are (friction coefficient, states, slip rate of its own, deflection of its spring), each only where it
/// is one. In all functions z points to the first of them, u is the slip rate that the oscillator imposes (m/s), and N
/// the load (N).
struct ContactRows {
  /// \param unknowns  those asked for; a law without an explicit slip rate has its states
  /// \param own_compliance  of a spring that neither mass nor damper parts from the contact (m/N)
  /// \param imposed  whether u follows from coordinates; otherwise from friction, which is then an unknown
  ContactRows(std::shared_ptr<const FrictionLaw>, double lambda, double load_memory, const ContactStiffness&, Unknowns,
              double own_compliance = 0, bool imposed = true);

  std::shared_ptr<const FrictionLaw> law;
  ContactSetup setup;
  std::unique_ptr<Contact<double>> contact;
  int states = 0;              ///< of the law, among the unknowns
  std::vector<double> weight;  ///< sizes by which errors of the unknowns are measured
  double creep = 0;            ///< additional creep, m/s for a friction coefficient of 1 (friction_creep)

  /// Sets the sizes, which are those of steady sliding at this slip rate and load, and, beside a mass, the creep.
  void weigh(double slip_rate, double N, bool beside_mass);
  /// \throws InputError where friction does not depend on the slip rate that the spring in series leaves open, and no
  /// damper does
  void require_slip_rate(double slip_rate, double N, std::string_view advice = {}) const;

  bool carries_friction() const { return setup.unknowns == Unknowns::friction; }
  bool rigid() const { return setup.compliance == 0 && setup.compliance_per_load == 0 && !setup.spring.present(); }
  /// Dry friction behind a spring, whose end sticks and slips.
  bool is_elastic() const { return law->set_valued() && setup.spring.present(); }
  bool is_damped() const { return setup.spring.damping > 0 || setup.spring.damping_per_load > 0; }
  int first_state() const { return carries_friction() ? 1 : 0; }
  /// Place of the contact's own slip rate, −1 where it is no unknown.
  int slip_rate_place() const { return setup.spring.present() && !carries_friction() && !is_elastic() ? states : -1; }

  void scale(const double* z, double* s) const;
  std::string unknown(int i) const;
  /// The slip rate of the contact itself, which must have it or friction among its unknowns: behind a spring it is not
  /// u, and it is without the cancellation in V − ẋ.
  double own_slip_rate(double N, const double* z) const;
  /// Natural states; at λ = 0 those of steady sliding at the contact's slip rate v.
  std::vector<double> natural_states(double v, double N, const double* z) const;
  void read_states(const double* z, double* natural) const;
  void write_states(std::span<const double> natural, double* z) const;
  /// The limit of friction at rest (N).
  double limit_at_rest(double N, const double* z) const;
  /// The states after slip has come to rest.
  void stop(double* z) const;
  /// Sets friction, where it is an unknown, to that of u and the states.
  void make_friction_fit(double u, double N, double* z) const;
};

}  // namespace rosin::oscillators
