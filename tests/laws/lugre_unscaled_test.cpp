/// LuGre bristles that the load does not stiffen: the scaled law at 1 N, and the answer to a change of load.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "analysis/response/frf.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using Complex = std::complex<double>;

TEST_CASE("lugre-unscaled: under 1 N it is lugre, and bristles do not notice more", "[laws][lugre-unscaled]") {
  const auto law = laws::find_law("lugre-unscaled"), scaled = laws::find_law("lugre");
  const std::vector<double> z{2e-6};
  CHECK(law->friction({3e-4, 1}, z) == scaled->friction({3e-4, 1}, z));
  CHECK(law->rate({3e-4, 1}, z) == scaled->rate({3e-4, 1}, z));
  for (const double N : {1.0, 20.0}) {
    CHECK(N * law->friction({0, N}, z) == Approx(1e5 * 2e-6 + 100 * 0).epsilon(1e-14));  // a spring of 1e5 N/m at rest
    const double g = 0.3 + 0.1 * std::exp(-0.09);
    CHECK(N * law->steady_friction({3e-4, N}).friction == Approx(N * g + 0.4 * 3e-4).epsilon(1e-14));
    CHECK(law->steady({3e-4, N})[0] == Approx(N * g / 1e5).epsilon(1e-14));
  }
}

TEST_CASE("lugre-unscaled: force follows slip rate and load as linear bristles do", "[laws][lugre-unscaled]") {
  const double s0 = 2e4, s1 = 30, s2 = 0.7, mu_s = 0.4, mu_d = 0.3, v_s = 1e-3, V = 7e-4, N = 12;
  oscillators::Model model;
  model.law = laws::find_law("lugre-unscaled")->with({s0, s1, s2, mu_s, mu_d, v_s});
  model.drive = {.speed = V, .normal_load = N, .force = 0.0};
  const analysis::response::FrictionResponse found(model);
  const double fall = (mu_s - mu_d) * std::exp(-(V / v_s) * (V / v_s)), g = N * (mu_d + fall),
               g_v = -2 * N * V / (v_s * v_s) * fall;
  for (const double omega : {0.1, 30.0, 1e4}) {
    const Complex s(0, omega), decay = s + s0 * V / g;
    const Complex Z = (s0 + s1 * s) * (V * g_v / g) / decay + s2, by_load = (s0 + s1 * s) * (V / N) / decay;
    CHECK(std::abs(found.tangential(s) / Z - 1.0) < 1e-12);
    CHECK(std::abs(found.normal(s) / by_load - 1.0) < 1e-12);
  }
}

TEST_CASE("lugre-unscaled: steady friction holds no rounding of the bristles' damping", "[laws][lugre-unscaled]") {
  // The damping of bristles that do not change is nothing, but a last digit of it here 4e-11 N of 4e-5 N.
  const double sigma1 = 5898849.5407037735, sigma2 = 6.1195880040115467e-06, mu_s = 2.980496119458929,
               mu_d = 0.030261505847599249, v_s = 0.88072098338894611;
  const auto law = laws::find_law("lugre-unscaled")->with({2632.4000166971405, sigma1, sigma2, mu_s, mu_d, v_s});
  for (double N = 1e-5; N < 2e-5; N *= 1.01)
    for (double v = 0.05; v < 0.1; v *= 1.03) {
      const auto steady = law->steady_friction({v, N});
      const double fall = (mu_s - mu_d) * std::exp(-(v / v_s) * (v / v_s));
      CHECK(steady.friction == Approx(mu_d + fall + sigma2 * v / N).epsilon(1e-14));
      CHECK(std::abs(steady.slope - (sigma2 / N - 2 * v / (v_s * v_s) * fall)) < 1e-14 * sigma2 / N);
    }
}
