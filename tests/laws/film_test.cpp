/// Eyring film: steady stress, relaxation in closed form, elastic stiffness, and Coulomb friction as a limit.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("film: steady stress is an inverse hyperbolic sine, shifted by pressure", "[laws][film]") {
  const auto law = laws::find_law("film");
  for (const double N : {0.1, 1.0, 3.0})
    for (const double v : {1e-12, 1e-9, 1e-4, -1e-4}) {
      const double tau = 1e6 * std::asinh(v / 1e-9 * std::exp(N / 1e-8 / 5e7));
      CHECK(law->steady({v, N})[0] == Approx(tau).epsilon(1e-12));
      CHECK(law->friction({v, N}, law->steady({v, N})) * N == Approx(1e-8 * tau).epsilon(1e-12));
    }
}

TEST_CASE("film: at rest stress relaxes as an Eyring element does", "[laws][film]") {
  // With p = tau/tau*: dp/dt = -k sinh p gives tanh(p/2) = tanh(p0/2) e^{-k t}; so k = -rate/(tau* sinh p).
  const auto law = laws::find_law("film");
  const double N = 1, k = 1e9 / 1e-9 * 1e-9 * std::exp(-N / 1e-8 / 5e7) / 1e6, start = 3;
  for (const double t : {0.0, 0.3 / k, 2 / k}) {
    const auto p = [&](double at) { return 2 * std::atanh(std::tanh(start / 2) * std::exp(-k * at)); };
    const double h = 1e-4 / k;
    const double slope = (8 * (p(t + h / 2) - p(t - h / 2)) - (p(t + h) - p(t - h))) / (6 * h);
    CHECK(law->rate({0, N}, std::vector{1e6 * p(t)})[0] == Approx(1e6 * slope).epsilon(1e-9));
  }
  // Fast shear is elastic, with stiffness S A/d.
  CHECK(law->rate({1, N}, std::vector{0.0})[0] * 1e-8 == Approx(1e9 * 1e-8 / 1e-9).epsilon(1e-12));
}

TEST_CASE("film: with a sharper activation it becomes Coulomb friction", "[laws][film]") {
  // tau* -> 0 with the stress at 1 um/s held at 10 MPa: a decade of slip rate then adds tau* ln 10.
  const auto left = [](double tau_star) {
    const auto law = laws::find_law("film")
                         ->with("tau_star", tau_star)
                         ->with("v0", 1e-6 / std::sinh(1e7 / tau_star) * std::exp(2.0));
    const double at = law->steady_friction({1e-6, 1}).friction;
    CHECK(at == Approx(0.1).epsilon(1e-10));
    return law->steady_friction({1e-5, 1}).friction / at - 1;
  };
  CHECK(left(2e5) == Approx(2e5 * std::log(10.0) / 1e7).epsilon(1e-9));
  CHECK(left(4e5) / left(2e5) == Approx(2).epsilon(1e-6));
}
