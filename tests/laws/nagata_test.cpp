/// Law of Nagata et al. (2012): what the paper states of its age and friction, checked along arbitrary motion.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

namespace {
const double mu0 = 0.6, a = 0.05, b = 0.055, L = 1e-5, v0 = 1e-6, c = 2;
double age(const FrictionLaw& law, double v, double phi) {
  return phi * std::exp(-c * (law.friction({v, 1}, std::vector{phi}) - mu0) / b);
}
}  // namespace

TEST_CASE("nagata: steady friction is that of ageing, its state carries the stress", "[laws][nagata]") {
  const auto law = laws::find_law("nagata");
  const auto ageing = laws::find_law("ageing")->with("a", a)->with("b", b);
  for (const double v : {1e-9, 1e-6, 1e-3}) {
    CHECK(law->steady_friction({v, 1}).friction == Approx(ageing->steady_friction({v, 1}).friction).epsilon(1e-10));
    CHECK(law->steady_friction({v, 1}).slope == Approx((a - b) / v).epsilon(1e-8));
  }
  CHECK(law->steady({1e-9, 1})[0] == Approx(35111.9173421513132).epsilon(1e-10));  // L/v (v/v0)^(c(a-b)/b)
  CHECK(law->steady({1e-3, 1})[0] == Approx(0.00284803586843580165).epsilon(1e-10));
}

TEST_CASE("nagata: friction and age obey the paper's two equations in any motion", "[laws][nagata]") {
  const auto law = laws::find_law("nagata");
  for (const double v : {1e-8, 1e-5})
    for (const double phi : {0.3, 40.0})
      for (const double acceleration : {-3.0, 0.0, 2.0}) {  // dv/dt over v, 1/s
        const double theta = age(*law, v, phi), mu = law->friction({v, 1}, std::vector{phi});
        CHECK(mu == Approx(mu0 + a * std::log(v / v0) + b * std::log(v0 * theta / L)).epsilon(1e-8));
        const double phi_rate = law->rate({v, 1}, std::vector{phi})[0], h = 1e-4 / (3 + phi_rate / phi + v / L);
        const auto moved = [&](double t) { return std::pair{v * std::exp(acceleration * t), phi + phi_rate * t}; };
        const auto [v1, phi1] = moved(h);
        const auto [v2, phi2] = moved(-h);
        const double mu_rate =
            (law->friction({v1, 1}, std::vector{phi1}) - law->friction({v2, 1}, std::vector{phi2})) / (2 * h);
        const double theta_rate = (age(*law, v1, phi1) - age(*law, v2, phi2)) / (2 * h);
        const double stated = 1 - v * theta / L - c / b * theta * mu_rate;
        const double size = 1 + v * theta / L + std::abs(c / b * theta * mu_rate);
        CHECK(std::abs(theta_rate - stated) < 1e-6 * size);
      }
}

TEST_CASE("nagata: without stress weakening it is the ageing law, and stress hides part of the direct effect",
          "[laws][nagata]") {
  const auto ageing = laws::find_law("ageing"), same = laws::find_law("nagata")->with("c", 0.0)->with("a", 0.01);
  const auto law = same->with("b", 0.015);
  for (const double v : {1e-12, 1e-6, 1e-2}) {
    const std::vector<double> state{7.0};
    CHECK(law->friction({v, 1}, state) == Approx(ageing->friction({v, 1}, state)).epsilon(1e-14));
    CHECK(law->rate({v, 1}, state)[0] == Approx(ageing->rate({v, 1}, state)[0]).epsilon(1e-14));
  }
  const auto weakened = laws::find_law("nagata");
  const auto state = weakened->steady({1e-6, 1});
  const double jump = weakened->friction({1e-5, 1}, state) - weakened->friction({1e-6, 1}, state);
  CHECK(jump == Approx(a / (1 + c) * std::log(10.0)).epsilon(1e-10));
  CHECK_THROWS_WITH(weakened->with("b", 1e-3), Catch::Contains("law.c a/b = 100 is above 10"));
}
