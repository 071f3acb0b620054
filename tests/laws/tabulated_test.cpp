/// Tabulated curve: through its points, monotone between them, refused where the table is no curve.
#include "laws/tabulated.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/monotone_curve.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using Points = std::vector<double>;

TEST_CASE("tabulated: PCHIP values between the points", "[laws][tabulated]") {
  // Slopes of Fritsch & Butland (1984) by hand: -0.65, -0.1, 0, 0.2833...; Hermite values in 30-digit arithmetic.
  const auto law = laws::make_law<laws::Tabulated>({.slip_rates = {0, 1, 3, 4}, .coefficients = {1, 0.5, 0.4, 0.6}});
  CHECK(law->friction({0.5, 1}, {}) == Approx(0.68125).epsilon(1e-15));
  CHECK(law->friction({2, 1}, {}) == Approx(0.425).epsilon(1e-15));
  CHECK(law->friction({3.5, 1}, {}) == Approx(0.4645833333333333).epsilon(1e-15));
  CHECK(law->steady_friction({1, 1}).slope == Approx(-0.1).epsilon(1e-14));
  CHECK(law->steady_friction({3, 1}).slope == Approx(0).margin(1e-15));
  CHECK(law->static_limit(1) == 1);
  for (const double v : {4.0, 5.0, 1e9}) CHECK(law->friction({v, 1}, {}) == Approx(0.6).epsilon(1e-15));
  CHECK(law->steady_friction({5, 1}).slope == 0);
}

TEST_CASE("tabulated: never overshoots where a plain spline would", "[laws][tabulated]") {
  const Points x{0, 1, 2, 3, 3.01, 10}, y{1, 1, 1, 0.999, 0.2, 0.2};
  const MonotoneCurve curve(x, y);
  double last = 1;
  for (double v = 0; v < 10; v += 0.001) {
    CHECK(curve(v) <= last + 1e-15);
    CHECK(curve(v, 1) <= 1e-12);
    last = curve(v);
  }
  for (std::size_t i = 0; i < x.size(); ++i) CHECK(curve(x[i]) == Approx(y[i]).epsilon(1e-14));
  CHECK(std::isnan(curve(std::nan(""))));
}

TEST_CASE("tabulated: one scalar type after the other gives the same curve and derivatives", "[laws][tabulated]") {
  const MonotoneCurve curve(Points{0, 1, 3, 4}, Points{1, 0.5, 0.4, 0.6});
  const double x = 0.3;
  using First = Dual<double, 1>;
  using Second = Dual<First, 1>;
  const Tower t = curve(Tower::variable(Second::variable(First::variable(x, 0), 0), 0));
  CHECK(t.value.value.value == curve(x));
  CHECK(t.value.value.slope[0] == curve(x, 1));
  CHECK(t.value.slope[0].slope[0] == curve(x, 2));
  CHECK(t.slope[0].slope[0].slope[0] == curve(x, 3));
  Pack p(0.0);
  for (int lane = 0; lane < pack_width; ++lane) p.block[lane] = 0.7 * lane - 0.5;
  for (int lane = 0; lane < pack_width; ++lane) CHECK(curve(p).block[lane] == curve(0.7 * lane - 0.5));
}

TEST_CASE("tabulated: two points make a straight line, less or disorder is refused", "[laws][tabulated]") {
  const auto made = [](Points v, Points mu) { return laws::make_law<laws::Tabulated>({v, mu}); };
  CHECK(made({0.5, 1.5}, {0.4, 0.2})->friction({1, 1}, {}) == Approx(0.3).epsilon(1e-15));
  CHECK(made({0.5, 1.5}, {0.4, 0.2})->friction({0.1, 1}, {}) == 0.4);
  CHECK_THROWS_WITH(made({1}, {0.4}), Catch::Contains("at least 2 points"));
  CHECK_THROWS_WITH(made({0, 1, 2}, {0.4, 0.3}), Catch::Contains("has 3 values but law.friction has 2"));
  CHECK_THROWS_WITH(made({0, 1, 1}, {0.4, 0.3, 0.2}), Catch::Contains("law.slip_rate[2] = 1 does not exceed"));
  CHECK_THROWS_WITH(made({-1, 1}, {0.4, 0.3}), Catch::Contains("law.slip_rate = -1 is outside"));
  CHECK_THROWS_AS(made({0, INFINITY}, {0.4, 0.3}), InputError);
  CHECK_THROWS_AS(made({0, 1}, {0.4, NAN}), InputError);
  CHECK_THROWS_WITH(MonotoneCurve({0, NAN}, {0, 1}), Catch::Contains("x[1] = nan is not finite"));
}

TEST_CASE("tabulated: lanes of one batch share the table", "[laws][tabulated]") {
  const auto law = laws::find_law("tabulated");
  const ContactSetup setup{.unknowns = Unknowns::states};
  const auto other = laws::make_law<laws::Tabulated>({.slip_rates = {0, 1}, .coefficients = {0.4, 0.3}});
  CHECK_NOTHROW(law->lanes(setup)->load(3, law->values(), setup));
  CHECK_THROWS_AS(law->lanes(setup)->load(3, other->values(), setup), InputError);
  const auto contact = law->contact(setup);
  contact->load(0, other->values(), setup);  // alone, a contact may take another table
  double F;
  contact->evaluate({0.5, 2, 0, 1}, nullptr, nullptr, F);
  CHECK(F == Approx(0.7).epsilon(1e-15));
}
