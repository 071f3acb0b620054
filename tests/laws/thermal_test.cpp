/// Thermal friction: calibration, heat balance, frequency response, and steps in slip rate without a jump.
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "laws/catalogue.hpp"

using namespace rosin;

namespace {
double curve(double w) { return 0.35 + 0.4 * std::exp(-w / 0.01) + 0.45 * std::exp(-w / 0.1); }
/// Steady rise of temperature, K, with h0 = 1e-3 and h1 = 8e-3.
double rise(double w) { return curve(w) * w / (1e-3 + 8e-3 * w); }
/// The law's state for the temperature of steady sliding at w.
double state(double w) { return w / (1 + 8 * w); }
}  // namespace

TEST_CASE("thermal: steady sliding has the curve that the law is calibrated by", "[laws][thermal]") {
  const auto law = laws::find_law("thermal"), steady = laws::find_law("two-exponential");
  for (const double v : {1e-4, 0.01, 0.1, 1.0}) {
    CHECK(law->steady_friction({v, 2}).friction == Approx(steady->steady_friction({v, 2}).friction).epsilon(1e-15));
    CHECK(law->steady_friction({v, 2}).slope == Approx(steady->steady_friction({v, 2}).slope).epsilon(1e-13));
  }
  CHECK(law->steady_friction({0.1, 1}).friction == Approx(0.515563908499).epsilon(1e-11));
  CHECK(law->steady_friction({0.1, 1}).slope == Approx(-1.65727348246).epsilon(1e-11));
  CHECK(rise(0.1) == Approx(28.6424393611).epsilon(1e-11));
}

TEST_CASE("thermal: its state obeys the heat balance", "[laws][thermal]") {
  const auto law = laws::find_law("thermal");
  for (const double w : {1e-3, 0.02, 0.15, 2.0})
    for (const double v : {0.0, 0.01, 0.3, 5.0}) {
      const double h = 1e-5 * w,
                   slope = (8 * (rise(w + h / 2) - rise(w - h / 2)) - (rise(w + h) - rise(w - h))) / (6 * h);
      const double heating = (curve(w) * v - (1e-3 + 8e-3 * v) * rise(w)) / 5e-7;  // K/s
      const double w_y = (1 + 8 * w) * (1 + 8 * w);
      CHECK(law->rate({v, 1}, std::vector{state(w)})[0] * w_y * slope == Approx(heating).epsilon(1e-8));
    }
}

TEST_CASE("thermal: friction answers a small oscillation of the slip rate late, and not at once", "[laws][thermal]") {
  const auto law = laws::find_law("thermal");
  const auto contact = law->contact({.unknowns = Unknowns::states});
  double z, weight, g, F;
  Slopes<double> s;
  contact->steady(0, 0.1, 1, &z, &weight);
  contact->linearise({0.1, 1, 0, 1}, &z, &g, F, s);
  CHECK(s.F_u == 0);
  const struct {
    double omega, re, im;
  } expected[] = {{10, -1.657271211751, 0.0019398927594461},
                  {100, -1.657046442162, 0.019396296589377},
                  {1000, -1.6348732584456, 0.19136751873701},
                  {10000, -0.69922711115019, 0.81846930092721},
                  {100000, -0.012007918632334, 0.1405568035317}};  // 40-digit arithmetic
  for (const auto& e : expected) {
    const auto Z = s.F_u + s.F_z[0] * s.g_u[0] / (std::complex<double>(0, e.omega) - s.g_z[0]);
    CHECK(Z.real() == Approx(e.re).epsilon(1e-9));
    CHECK(Z.imag() == Approx(e.im).epsilon(1e-9));
  }
}

TEST_CASE("thermal: after a step in slip rate friction goes to the new curve without a jump", "[laws][thermal]") {
  const auto law = laws::find_law("thermal");
  const auto rate = [&](double w) { return law->rate({0.2, 1}, std::vector{w})[0]; };
  double w = state(0.05), last = curve(0.05);
  constexpr double h = 1e-6;
  for (int i = 0; i < 20000; ++i) {  // classical Runge-Kutta
    const double k1 = rate(w), k2 = rate(w + h / 2 * k1), k3 = rate(w + h / 2 * k2), k4 = rate(w + h * k3);
    w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    const double mu = law->friction({0.2, 1}, std::vector{w});
    REQUIRE(mu <= last);
    if (i == 0) CHECK(last - mu < 0.05 * (curve(0.05) - curve(0.2)));
    last = mu;
  }
  CHECK(last == Approx(curve(0.2)).epsilon(1e-9));
}

TEST_CASE("thermal: a contact of fixed area is hotter under more load", "[laws][thermal]") {
  const auto law = laws::find_law("thermal")->with("area_exponent", 0.0);
  CHECK(law->steady_friction({0.1, 1}).friction == Approx(0.515563908499).epsilon(1e-11));
  // Without what is swept away, five times the load heats as five times the speed.
  const auto still = law->with("h1", 0.0);
  CHECK(still->steady_friction({0.01, 5}).friction == Approx(curve(0.05)).epsilon(1e-14));
  CHECK(still->rate({0.01, 5}, std::vector{0.05})[0] == Approx(0).margin(1e-12));
  // 2.5 N at 0.1 m/s: 48.6 K, beyond the 43.75 K of fastest sliding at 1 N, so that friction is that of a hot contact.
  const double hot = law->steady({0.1, 2.5})[0];
  CHECK(0.35 * hot / 1e-3 == Approx(48.6111111111).epsilon(1e-11));
  CHECK(law->steady_friction({0.1, 2.5}).friction == 0.35);
  // Half the area by load: m = 1/2 under 4 N is a fixed area under 2 N.
  CHECK(law->with("area_exponent", 0.5)->steady_friction({0.03, 4}).friction ==
        Approx(law->steady_friction({0.03, 2}).friction).epsilon(1e-14));
}

TEST_CASE("thermal: a curve that falls too steeply for the heat balance is refused", "[laws][thermal]") {
  // For the curve of rosin the limit of h1/h0 is 11.9 s/m, at 0.2 m/s.
  const auto law = laws::find_law("thermal");
  CHECK_NOTHROW(law->with("h1", 11.8e-3));
  CHECK_THROWS_WITH(law->with("h1", 12.0e-3), Catch::Contains("h1") && Catch::Contains("11.9"));
}
