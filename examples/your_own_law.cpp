/// A friction law of your own: ten lines here, no change in the library.
///
/// Friction falls from a static to a sliding value over a slip distance L (Rabinowicz 1951) and recovers at rest within
/// t_heal. ψ is the healed fraction of the contacts, and a creep speed of 1 nm/s makes the force unique at v = 0:
///   μ = (mu + d·ψ)·v/(|v| + 1e-9 m/s),   λ ψ' = (1 − ψ)/t_heal − |v| ψ/L
#include <fmt/core.h>

#include <rosin/analysis/cycles/cycles.hpp>
#include <rosin/analysis/steady/steady.hpp>
#include <rosin/laws/adapter.hpp>

using namespace rosin;

// clang-format off
template <class Real = double>
struct Healing {
  static constexpr Card card{"healing", "Healing friction", R"(\mu + d\,\psi)", "Rabinowicz (1951)", "an example"};
  Real mu = 0.3, d = 0.1, L = 10e-6, t_heal = 10;
  static constexpr auto parameters = table(field(&Healing::mu, "mu", "1", {0, 2}, "friction after long slip"),
      field(&Healing::d, "d", "1", {0, 2}, "gain at rest"), field(&Healing::L, "L", "m", {1e-9, 1}, "memory"),
      field(&Healing::t_heal, "t_heal", "s", {1e-6, 1e9}, "healing time"));
  struct State { Real psi; };
  static constexpr auto states = table(field(&State::psi, "psi", "1", {0, 1}, "healed fraction of the contacts"));
  Real friction(Sliding<Real> at, State s) const { return (mu + d * s.psi) * at.slip_rate / (1e-9 + abs(at.slip_rate)); }
  State rate(Sliding<Real> at, State s) const { return {(1.0 - s.psi) / t_heal - abs(at.slip_rate) * s.psi / L}; }
  State steady(Sliding<Real> at) const { return {1.0 / (1.0 + abs(at.slip_rate) * t_heal / L)}; }
};
// clang-format on

int main() {
  // 1. The law, with other parameters than its defaults. A value outside its range is refused by name.
  const auto law = laws::make_law<Healing>()->with("d", 0.15);

  // 2. Its steady curve and slope: where the slope is negative, sliding can become unstable.
  fmt::print("slip rate (m/s)   steady friction   slope (s/m)\n");
  for (double v = 1e-8; v < 1e-3; v *= 10) {
    const auto steady = law->steady_friction({.slip_rate = v, .normal_load = 1});
    fmt::print("{:15.0e} {:17.5f} {:13.4g}\n", v, steady.friction, steady.slope);
  }

  // 3. What a solver sees: F and the rate of the state after a jump from 1 to 10 um/s at 2 N, with their derivatives.
  const auto contact = law->contact({.lambda = 1, .unknowns = Unknowns::states});
  double psi, size, g, F;
  Slopes<double> slopes;
  contact->steady(0, 1e-6, 2, &psi, &size);
  contact->linearise({.slip_rate = 1e-5, .normal_load = 2, .load_rate = 0, .direction = 1}, &psi, &g, F, slopes);
  fmt::print("\nafter the jump F = {:.4f} N, dpsi/dt = {:.4f} 1/s, dF/dpsi = {:.4f} N, d(dpsi/dt)/dpsi = {:.4f} 1/s\n",
             F, g, slopes.F_z[0], slopes.g_z[0]);

  // 4. Everything else follows: the load at which sliding on a spring loses stability, and the cycle beyond it.
  oscillators::Model machine{
      .law = law, .slider = {.mass = 1, .stiffness = 1e3}, .drive = {.speed = 1e-5, .normal_load = 1.0, .force = 0.0}};
  const auto hopf = analysis::steady::hopf_points(machine, "drive.normal_load");
  if (hopf.empty()) return 1;
  fmt::print("\nsliding at 10 um/s is unstable above {:.6g} N, {} ({:.4g} rad/s)\n", hopf[0].value,
             name(hopf[0].criticality), hopf[0].angular_frequency);
  const auto cycle = analysis::cycles::find_cycle(machine.with("drive.normal_load", 2 * hopf[0].value));
  if (!cycle.outcome.complete()) return 1;
  fmt::print("at twice that load it sticks and slips every {:.8g} ± {:.0e} s, up to {:.4g} m/s\n", cycle.metrics.period,
             cycle.error.period, cycle.metrics.slip_rate_max);
}
