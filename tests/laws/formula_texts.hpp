/// Shipped laws spelled as text: what every use of a law from text is compared with.
#pragma once
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"

namespace rosin::tests::text {

using laws::find_law;
using laws::FormulaDescription;

/// Parameters of a shipped law under the same names.
inline FormulaDescription like(const FrictionLaw& law) {
  FormulaDescription text;
  text.title = "The same from text";
  for (std::size_t i = 0; i < law.values().size(); ++i)
    text.parameters.push_back({law.parameters()[i], std::get<double>(law.values()[i])});
  text.states = law.states();
  return text;
}

inline FormulaDescription spinodal() {
  auto law = like(*find_law("spinodal"));
  law.define = {{"E", "(mu0 + b*ln(c + psi/psi_ref))/a"}, {"psi_ref", "L/(L + v0*t_heal)"}};
  law.friction = "a*asinh_exp(v/(2*v0), E)";
  law.rate = {"(1 - psi)/t_heal - abs(v)*psi/L"};
  law.steady = {"1/(1 + abs(v)*t_heal/L)"};
  law.slip_rate = "2*v0*sinh_exp(mu/a, E)";
  return law;
}
/// Flow of a film heats it, and heat speeds the flow: in steady sliding stress and temperature depend on each other.
inline FormulaDescription hot_film() {
  auto law = like(*find_law("hot-film"));
  law.define = {{"T", "T_a + theta"},
                {"k_B", "1.380649e-23 J/kelvin"},
                {"E", "(E_a + N/A*V_a)/(k_B*T) - ln(d*K*T/(1 m/s))"},
                {"flow", "(1 m/s)*sinh_exp(tau/tau_star, E)"}};
  law.friction = "A*tau/N";
  law.rate = {"S/d*(v - flow)", "(R*A*tau*flow - theta)/time"};
  law.steady = {"tau_star*asinh_exp(v/(1 m/s), E)", ""};
  law.rest = {"0 Pa", "0 K"};
  law.size = {"tau_star", "T_a/(1 + E_a/(k_B*T_a))"};
  return law;
}
inline FormulaDescription ageing() {
  auto law = like(*find_law("ageing"));
  law.define = {{"E", "(mu0 + b*ln(v0*theta/L))/a"}};
  law.friction = "a*asinh_exp(v/(2*v0), E)";
  law.rate = {"1 - abs(v)*theta/L"};
  law.steady = {"L/abs(v)"};
  law.slip_rate = "2*v0*sinh_exp(mu/a, E)";
  return law;
}
inline FormulaDescription two_state_slip() {
  auto law = like(*find_law("two-state-slip"));
  law.define = {{"E", "(mu0 + b1*ln(v0*theta1/L1) + b2*ln(v0*theta2/L2))/a"},
                {"x1", "abs(v)*theta1/L1"},
                {"x2", "abs(v)*theta2/L2"}};
  law.friction = "a*asinh_exp(v/(2*v0), E)";
  law.rate = {"-x1*ln(max(x1, 1e-300))", "-x2*ln(max(x2, 1e-300))"};
  law.steady = {"L1/abs(v)", "L2/abs(v)"};
  law.slip_rate = "2*v0*sinh_exp(mu/a, E)";
  return law;
}
inline FormulaDescription stribeck() {
  auto law = like(*find_law("stribeck"));
  law.friction = "mu_d + (mu_s - mu_d)*exp(-(v/v_s)^exponent) + viscous*v";
  law.static_limit = "mu_s";
  return law;
}

/// Set-valued laws with states: what holds at rest depends on them, and a stop resets them.
inline FormulaDescription slip_distance() {
  auto law = like(*find_law("slip-distance")->with("mu_d", 0.2));
  law.friction = "mu_d + (mu_s - mu_d)*max(0, 1 - s/d_c)";
  law.static_limit = law.friction;
  law.rate = {"v*min(1, 2 - s/d_c)"};
  law.steady = {"2*d_c"};
  law.rest = law.after_stop = {"0 m"};
  law.kink = "1 - s/d_c";
  law.size = {"d_c"};
  return law;
}
inline FormulaDescription static_growth() {
  auto law = like(*find_law("static-growth")->with("mu_d", 0.2));
  law.friction = "mu_d";
  law.static_limit = "mu_s0 + beta*log10(1 + t/t_c)";
  law.rate = {"(1 - sign(v)) - sign(v)*t/t_c"};  // in stick v = 0
  law.steady = law.rest = law.after_stop = {"0 s"};
  law.size = {"t_c"};
  return law;
}

}  // namespace rosin::tests::text
