/// Overflow-free functions: against 80-bit arithmetic where that suffices, against limits where it overflows.
#include "core/maths.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace rosin;

TEST_CASE("asinh_exp is asinh(v e^E), odd, without overflow", "[core][maths]") {
  for (double v = 1e-30; v < 1e30; v *= 13)
    for (double E = -300; E <= 300; E += 17.3) {
      CAPTURE(v, E);
      const long double exact = std::asinh((long double)(v)*std::exp((long double)(E)));
      // The sum ln v + E carries the rounding of its larger term.
      const double scale = std::max(double(exact), 1.0) + (std::abs(std::log(v)) + std::abs(E)) * (exact > 1 ? 1 : 0);
      if (double(exact) > 1)
        CHECK(std::abs(asinh_exp(v, E) - double(exact)) <= 4e-16 * scale);
      else
        CHECK(asinh_exp(v, E) == Approx(double(exact)).epsilon(1e-15));
      CHECK(asinh_exp(-v, E) == -asinh_exp(v, E));
    }
  CHECK(asinh_exp(0.0, 1000.0) == 0);
  for (const double E : {400.0, 1000.0, 1e6})  // e^E is no double: ln 2v + E
    CHECK(asinh_exp(3e-6, E) == Approx(std::log(6e-6) + E).epsilon(1e-15));
  CHECK(asinh_exp(1e-320, 800.0) == Approx(std::log(2e-320) + 800).epsilon(1e-15));
  CHECK(std::isnan(asinh_exp(std::nan(""), 1.0)));
  CHECK(std::isnan(asinh_exp(1.0, std::nan(""))));
}

TEST_CASE("a contact that holds nothing has slopes within the range of numbers", "[core][maths]") {
  using Slope = Dual<double, 2>;
  for (const double E : {-490.0, -700.0, -1e4}) {
    const auto friction = asinh_exp(Slope::variable(10.0, 0), Slope::variable(E, 1));
    CHECK(friction.value < 1e-200);
    const auto rate = sinh_exp(Slope::variable(friction.value, 0), Slope::variable(E, 1));
    CHECK(rate.value == Approx(10).epsilon(1e-13));
    CHECK(rate.slope[0] * friction.slope[0] == Approx(1).epsilon(1e-13));
  }
  CHECK(std::isnan(sinh_exp(1.0, std::nan(""))));
}

TEST_CASE("asinh_exp meets its logarithmic branch without a step, in value and slope", "[core][maths]") {
  using Slope = Dual<double, 2>;
  for (const double E : {-50.0, 0.0, 60.0, 900.0}) {
    const double v = std::exp(20 - E);
    if (v == 0) continue;
    const auto below = asinh_exp(Slope::variable(v * (1 - 1e-12), 0), Slope::variable(E, 1));
    const auto above = asinh_exp(Slope::variable(v * (1 + 1e-12), 0), Slope::variable(E, 1));
    CHECK(above.value - below.value == Approx(2e-12).margin(2e-14));
    CHECK(above.slope[0] == Approx(below.slope[0]).epsilon(3e-12));
    CHECK(above.slope[1] == Approx(below.slope[1]).epsilon(1e-14));
  }
}

TEST_CASE("sinh_exp inverts asinh_exp over hundreds of decades", "[core][maths]") {
  for (const double E : {-100.0, 0.0, 60.0, 650.0, 1000.0})
    for (double v = 1e-300; v < 1e100; v *= 1e7) {
      CAPTURE(v, E);
      const double p = asinh_exp(v, E);
      if (p < 1e-290 || p > 700 + E) continue;  // below, p is subnormal; above, nothing that a contact meets
      // dv/v = coth(p) dp: the rounding of p and E is magnified by their size.
      CHECK(sinh_exp(p, E) == Approx(v).epsilon(4e-16 * (2 + p + std::abs(E))));
      CHECK(sinh_exp(-p, E) == -sinh_exp(p, E));
    }
  CHECK(sinh_exp(0.0, 5.0) == 0);
  CHECK(sinh_exp(1e-20, 0.0) == Approx(1e-20).epsilon(1e-15));    // no cancellation of e^p and e^-p
  CHECK(sinh_exp(1000.0, 1000.0) == Approx(0.5).epsilon(1e-15));  // neither factor is a double
}

TEST_CASE("asinh_exp and sinh_exp: partial derivatives in closed form", "[core][maths]") {
  using Slope = Dual<double, 2>;
  for (const double v : {-2.0, -1e-3, 1e-9, 0.3, 5.0})
    for (const double E : {-3.0, 0.0, 8.0}) {
      CAPTURE(v, E);
      const double x = v * std::exp(E), root = std::sqrt(1 + x * x);
      const auto p = asinh_exp(Slope::variable(v, 0), Slope::variable(E, 1));
      CHECK(p.slope[0] == Approx(std::exp(E) / root).epsilon(1e-14));
      CHECK(p.slope[1] == Approx(x / root).epsilon(1e-14));
      const auto back = sinh_exp(Slope::variable(p.value, 0), Slope::variable(E, 1));
      CHECK(back.slope[0] == Approx(root * std::exp(-E)).epsilon(1e-13));
      CHECK(back.slope[1] == Approx(-v).epsilon(1e-13));
    }
  const auto rest = asinh_exp(Slope::variable(0.0, 0), Slope::variable(3.0, 1));
  CHECK(rest.slope[0] == Approx(std::exp(3)).epsilon(1e-15));
  CHECK(rest.slope[1] == 0);
}

TEST_CASE("asinh, sign, x ln x and powers at their limits", "[core][maths]") {
  for (double x = 1e-300; x < 1e150; x *= 1e5) {
    CHECK(rosin::asinh(x) == Approx(std::asinh(x)).epsilon(1e-15));
    CHECK(rosin::asinh(-x) == -rosin::asinh(x));
  }
  CHECK(sign(-3.0) == -1);
  CHECK(sign(0.0) == 0);
  CHECK(sign(2.0) == 1);
  CHECK(xlogx(0.0) == 0);
  CHECK(xlogx(1.0) == 0);
  CHECK(xlogx(0.5) == Approx(0.5 * std::log(0.5)).epsilon(1e-15));
  CHECK(power(0.0, 2.0) == 0);
  CHECK(power(3.0, 2.5) == Approx(std::pow(3.0, 2.5)).epsilon(1e-14));
  CHECK(power(Dual<double, 1>::variable(3.0, 0), Dual<double, 1>(2.0)).slope[0] == Approx(6.0).epsilon(1e-14));
}

TEST_CASE("arctan is that of 80-bit arithmetic, with its slope", "[core][maths]") {
  using Slope = Dual<double, 1>;
  for (double x = 1e-300; x < 1e300; x *= 1.7) {
    CAPTURE(x);
    const auto exact = (long double)(x);
    CHECK(arctan(x) == Approx(double(std::atan(exact))).epsilon(4e-16));
    CHECK(arctan(-x) == -arctan(x));
    if (x < 1e150)
      CHECK(arctan(Slope::variable(x, 0)).slope[0] == Approx(double(1 / (1 + exact * exact))).epsilon(4e-16));
  }
  CHECK(arctan(0.0) == 0);
  CHECK(arctan(Slope::variable(0.0, 0)).slope[0] == 1);
  CHECK(arctan(std::numeric_limits<double>::infinity()) == std::acos(0.0));
  CHECK(std::isnan(arctan(std::nan(""))));
}
