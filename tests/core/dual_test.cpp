/// Dual numbers against derivatives in closed form, nested to third order and in packs.
#include "core/dual.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin;

namespace {

using First = Dual<double, 1>;
using Second = Dual<First, 1>;

Tower variable(double x) { return Tower::variable(Second::variable(First::variable(x, 0), 0), 0); }

/// f, f', f'', f''' from one evaluation, each within a few roundings.
void check_derivatives(const Tower& t, double f, double f1, double f2, double f3) {
  CHECK(t.value.value.value == Approx(f).epsilon(1e-14));
  CHECK(t.value.value.slope[0] == Approx(f1).epsilon(1e-14));
  CHECK(t.value.slope[0].value == Approx(f1).epsilon(1e-14));
  CHECK(t.slope[0].value.value == Approx(f1).epsilon(1e-14));
  CHECK(t.value.slope[0].slope[0] == Approx(f2).epsilon(1e-13));
  CHECK(t.slope[0].slope[0].value == Approx(f2).epsilon(1e-13));
  CHECK(t.slope[0].slope[0].slope[0] == Approx(f3).epsilon(1e-13));
}

}  // namespace

TEST_CASE("towers of functions: three derivatives in closed form", "[core][dual]") {
  for (const double x : {1e-3, 0.7, 4.0}) {
    CAPTURE(x);
    const double e = std::exp(x), r = std::sqrt(x), y = 1 + x;
    check_derivatives(exp(variable(x)), e, e, e, e);
    check_derivatives(expm1(variable(x)), std::expm1(x), e, e, e);
    check_derivatives(log(variable(x)), std::log(x), 1 / x, -1 / (x * x), 2 / (x * x * x));
    check_derivatives(log1p(variable(x)), std::log1p(x), 1 / y, -1 / (y * y), 2 / (y * y * y));
    check_derivatives(sqrt(variable(x)), r, 0.5 / r, -0.25 / (x * r), 0.375 / (x * x * r));
    check_derivatives(1.0 / variable(x), 1 / x, -1 / (x * x), 2 / (x * x * x), -6 / (x * x * x * x));
    check_derivatives(variable(x) * variable(x) * variable(x), x * x * x, 3 * x * x, 6 * x, 6);
    check_derivatives(abs(variable(-x)), x, -1, 0, 0);
    // d³/dx³ of x² e^x = (x² + 6x + 6) e^x
    check_derivatives(variable(x) * variable(x) * exp(variable(x)), x * x * e, (x * x + 2 * x) * e,
                      (x * x + 4 * x + 2) * e, (x * x + 6 * x + 6) * e);
  }
}

TEST_CASE("duals: each operation with duals and plain numbers on either side", "[core][dual]") {
  using Pair = Dual<double, 2>;
  const double x = 1.7, y = -0.6;
  const Pair a = Pair::variable(x, 0), b = Pair::variable(y, 1);
  const auto check = [](const Pair& d, double value, double by_x, double by_y) {
    CHECK(d.value == Approx(value).epsilon(1e-15));
    CHECK(d.slope[0] == Approx(by_x).epsilon(1e-15));
    CHECK(d.slope[1] == Approx(by_y).epsilon(1e-15));
  };
  check(a + b, x + y, 1, 1);
  check(a - b, x - y, 1, -1);
  check(-a, -x, -1, 0);
  check(a * b, x * y, y, x);
  check(a / b, x / y, 1 / y, -x / (y * y));
  check(a + 2.0, x + 2, 1, 0);
  check(2.0 - b, 2 - y, 0, -1);
  check(b - 2.0, y - 2, 0, 1);
  check(3.0 * a, 3 * x, 3, 0);
  check(b / 4.0, y / 4, 0, 0.25);
  check(4.0 / b, 4 / y, 0, -4 / (y * y));
  check(max(a, b), x, 1, 0);
  check(min(a, b), y, 0, 1);
  check(abs(b), -y, 0, -1);
  check(select(a < b, a, b), y, 0, 1);
  check(Pair(5.0), 5, 0, 0);
  CHECK((a > b && b < 0.0 && a > 0.0));
}

TEST_CASE("duals of packs differ per lane as duals of doubles do", "[core][dual]") {
  const auto f = [](const auto& x) { return log1p(exp(x) / (1.0 + x * x)) - sqrt(abs(x)) * expm1(-x); };
  Pack p;
  for (int i = 0; i < pack_width; ++i) p.block[i] = 0.37 * i - 1.2;
  const auto wide = f(Dual<Pack, 1>::variable(p, 0));
  for (int i = 0; i < pack_width; ++i) {
    const auto one = f(First::variable(p.block[i], 0));
    CHECK(wide.value.block[i] == Approx(one.value).epsilon(1e-14));
    CHECK(wide.slope[0].block[i] == Approx(one.slope[0]).epsilon(1e-14));
  }
}
