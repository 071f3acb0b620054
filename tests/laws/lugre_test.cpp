/// LuGre: steady curve, frequency response about steady sliding, presliding stiffness and the Dahl limit.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "analysis/cycles/cycle.hpp"
#include "analysis/steady/stability.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("lugre: the steady curve is Stribeck's", "[laws][lugre]") {
  const auto law = laws::preset(*laws::find_law("lugre"), "canudas-de-wit");
  const auto curve = laws::preset(*laws::find_law("stribeck"), "canudas-de-wit");
  for (const double v : {1e-6, 1e-3, 0.1}) {
    CHECK(law->steady_friction({v, 1}).friction == Approx(curve->steady_friction({v, 1}).friction).epsilon(1e-14));
    CHECK(law->steady_friction({v, 1}).slope == Approx(curve->steady_friction({v, 1}).slope).epsilon(1e-10));
  }
}

TEST_CASE("lugre: friction answers a small oscillation of the slip rate with memory", "[laws][lugre]") {
  // dF/dv = F_v + F_z g_v/(i w - g_z) at v = 1 mm/s and N = 10 N; sigma0 1e5 N/m, sigma1 30 N s/m, sigma2 0.4 N s/m.
  const auto law = laws::find_law("lugre")->with("sigma0", 1e4)->with("sigma1", 3.0)->with("sigma2", 0.04);
  const auto contact = law->contact({.unknowns = Unknowns::states});
  double z, weight, g, F;
  Slopes<double> s;
  contact->steady(0, 1e-3, 10, &z, &weight);
  contact->linearise({1e-3, 10, 0, 1}, &z, &g, F, s);
  const struct {
    double omega, re, im;
  } expected[] = {{0.1, -735.35061134764, 2.4558465913167},
                  {1, -734.53271053148, 24.530919999731},
                  {10, -661.07385420437, 220.5691427977},
                  {100, -65.234186939112, 198.97526235995},
                  {1000, -6.7962298835116, 21.632682083357}};  // 40-digit arithmetic
  for (const auto& e : expected) {
    const auto Z = s.F_u + s.F_z[0] * s.g_u[0] / (std::complex<double>(0, e.omega) - s.g_z[0]);
    CHECK(Z.real() == Approx(e.re).epsilon(1e-9));
    CHECK(Z.imag() == Approx(e.im).epsilon(1e-9));
  }
}

TEST_CASE("lugre: a slider's eigenvalues are roots of the characteristic polynomial", "[laws][lugre]") {
  // (m s^2 + c s + k) + s Z(s) = 0 with the response Z = F_v + F_z g_v/(s - g_z).
  oscillators::Model model;
  model.law = laws::find_law("lugre");
  model.slider = {.mass = 1, .stiffness = 1000, .damping = 0.1};
  model.drive = {1e-4, 10.0, 0.0};
  const double V = 1e-4, N = 10, g = 0.3 + 0.1 * std::exp(-0.01), g_v = -0.1 * 2 * V / 1e-6 * std::exp(-0.01);
  const double z_z = -1e5 * V / g, z_v = V * g_v / g;  // of dz/dt, at steady z = g/sigma0
  const double F_z = N * (1e5 + 100 * z_z), F_v = N * (100 * z_v + 0.4);
  const auto found = analysis::steady::stability(model).eigenvalues;
  REQUIRE(found.size() == 3);
  for (const auto s : found) {
    const auto rest = (s * s + 0.1 * s + 1000.0) * (s - z_z) + s * (F_v * (s - z_z) + F_z * z_v);
    const double size = std::pow(std::abs(s), 3) + 1000 * std::abs(s) + std::abs(1000 * z_z) +
                        std::abs(s) * std::abs(F_v * z_z) + std::norm(s) * std::abs(F_v - z_z);
    CHECK(std::abs(rest) < 1e-12 * size);
  }
}

TEST_CASE("lugre: mirrored bristles, rest without force, and the Dahl model as a limit", "[laws][lugre]") {
  const auto law = laws::find_law("lugre");
  CHECK(law->states()[0].parity == Parity::odd);
  CHECK(law->rest(1) == std::vector{0.0});
  CHECK(law->friction({0, 1}, std::vector{1e-6}) == Approx(0.1));  // presliding: sigma0 z
  const auto plain = law->with("sigma1", 0.0)->with("sigma2", 0.0)->with("mu_s", 0.3), dahl = laws::find_law("dahl");
  for (const double v : {-2e-3, 1e-5}) {
    const std::vector<double> state{1.3e-6};
    CHECK(plain->friction({v, 1}, state) == dahl->friction({v, 1}, state));
    CHECK(plain->rate({v, 1}, state)[0] == Approx(dahl->rate({v, 1}, state)[0]).epsilon(1e-14));
  }
}

TEST_CASE("lugre: a drive in the other direction has the mirrored cycle", "[laws][lugre]") {
  oscillators::Model model;
  model.law = laws::find_law("lugre");
  model.slider = {.mass = 1, .stiffness = 1000, .damping = 0.1};
  model.drive = {1e-4, 10.0, 0.0};
  const auto forward = analysis::cycles::find_cycle(model, {.tolerance = 1e-6});
  model.drive.speed = -1e-4;
  const auto backward = analysis::cycles::find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(forward.outcome.complete());
  CHECK(backward.metrics.period == forward.metrics.period);
  REQUIRE(forward.section_state.size() == 1);
  CHECK(forward.section_state[0] > 0);
  CHECK(backward.section_state[0] == -forward.section_state[0]);
  CHECK(backward.orbit.back().state[0] == -forward.orbit.back().state[0]);
}
