/// Setup, sizes, names and states of one contact.
#include "oscillators/contact_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace rosin::oscillators {

ContactRows::ContactRows(std::shared_ptr<const FrictionLaw> of, double lambda, double load_memory,
                         const ContactStiffness& spring, Unknowns unknowns, double own_compliance, bool imposed)
    : law(std::move(of)) {
  setup.lambda = lambda;
  setup.load_memory = load_memory;
  if (spring.damped() || (!law->has_slip_rate() && (spring.present() || own_compliance > 0))) {
    setup.spring = {1 / spring.tangential, 1 / spring.per_load, spring.damping, spring.damping_per_load};
    if (law->has_slip_rate())
      setup.compliance = own_compliance;
    else
      setup.spring.compliance += own_compliance;  // the two springs act as one: neither has a damper in parallel
  } else {
    setup.compliance = 1 / spring.tangential + own_compliance;
    setup.compliance_per_load = 1 / spring.per_load;
  }
  // A friction unknown covers an undamped spring in series, and a slip rate that is no coordinate.
  const bool needs_friction = !rigid() || !imposed;
  setup.unknowns = law->has_slip_rate() && (unknowns == Unknowns::friction || needs_friction) ? Unknowns::friction
                                                                                              : Unknowns::states;
  contact = law->contact(setup);
  states = contact->unknowns() - first_state() -
           (!setup.spring.present()              ? 0
            : carries_friction() || is_elastic() ? 1
                                                 : 2);
}

void ContactRows::weigh(double slip_rate, double N, bool beside_mass) {
  weight.assign(Slopes<double>::capacity, 1.0);
  double z[Slopes<double>::capacity];
  contact->steady(0, slip_rate, N, z, weight.data());
  if (!beside_mass || !rigid() || !carries_friction()) return;
  // Friction that nearly vanishes in steady sliding may be large in stick.
  const auto [share, stuck] = friction_creep(setup.lambda);
  const double held = law->steady_friction({stuck * slip_rate, N}).friction;
  creep = share * slip_rate / std::max({std::abs(z[0]), 0.1 * weight[0], std::abs(held)});
}

void ContactRows::require_slip_rate(double slip_rate, double N, std::string_view advice) const {
  if (slip_rate_place() < 0) return;
  constexpr int most = Slopes<double>::capacity;
  Slopes<double> slopes;
  double z[most], size[most], g[most], F;
  contact->steady(0, slip_rate, N, z, size);
  contact->linearise({slip_rate, N, 0, 1}, z, g, F, slopes);
  if (slopes.g_z[states * contact->unknowns() + states] != 0) return;
  throw InputError(fmt::format(
      "law '{}' answers to the slip rate only by way of its states, so that an undamped spring in series leaves "
      "the slip rate of the contact open; give law.contact_stiffness.damping{}",
      law->card().name, advice));
}

void ContactRows::scale(const double* z, double* s) const {
  std::copy_n(weight.begin(), contact->unknowns(), s);
  // Friction that nearly vanishes in steady sliding may be large elsewhere.
  if (carries_friction()) s[0] = std::max(weight[0], 0.01 * std::abs(z[0]));
  // A linear state may grow far beyond its natural size: its own rounding error then limits its accuracy.
  for (int i = first_state(); i < first_state() + states; ++i)
    if (law->states()[std::size_t(i - first_state())].scale == Scale::linear) s[i] = std::max(s[i], std::abs(z[i]));
}

std::string ContactRows::unknown(int i) const {
  if (carries_friction() && i-- == 0) return "friction coefficient";
  if (i < states) return law->states()[std::size_t(i)].name;
  return i == slip_rate_place()
             ? "slip rate of the contact, which jumps where friction falls with it faster than the contact's damping "
               "resists"
             : "deflection of the contact";
}

double ContactRows::own_slip_rate(double N, const double* z) const {
  if (const int v = slip_rate_place(); v >= 0) return z[v];
  double natural[Slopes<double>::capacity];
  read_states(z, natural);
  return law->slip_rate(z[0], N, {natural, std::size_t(states)});
}

std::vector<double> ContactRows::natural_states(double v, double N, const double* z) const {
  if (states == 0 && law->has_states()) return law->steady({v, N});
  std::vector<double> state(std::size_t(states), 0.0);
  read_states(z, state.data());
  return state;
}

void ContactRows::read_states(const double* z, double* natural) const {
  z += first_state();
  for (int i = 0; i < states; ++i) natural[i] = to_state(law->states()[std::size_t(i)], z[i]);
}

void ContactRows::write_states(std::span<const double> natural, double* z) const {
  z += first_state();
  for (int i = 0; i < states; ++i) z[i] = to_unknown(law->states()[std::size_t(i)], natural[std::size_t(i)]);
}

double ContactRows::limit_at_rest(double N, const double* z) const {
  return N * (law->has_states() ? law->static_limit(N, natural_states(0, N, z)) : law->static_limit(N));
}

void ContactRows::stop(double* z) const {
  if (states > 0) write_states(law->after_stop(natural_states(0, 0, z)), z);
}

void ContactRows::make_friction_fit(double u, double N, double* z) const {
  const auto state = setup.lambda == 0 ? law->steady({u, N}) : natural_states(u, N, z);
  if (setup.lambda == 0) write_states(state, z);
  z[0] = law->friction({u, N}, state);
}

}  // namespace rosin::oscillators
