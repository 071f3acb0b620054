/// Bowden-Tabor product: steady values in 40 digits, its first order in common with spinodal, and the area's limit.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("bowden-tabor: steady friction and its slope", "[laws][bowden-tabor]") {
  const auto law = laws::find_law("bowden-tabor");
  const struct {
    double v, mu, slope;
  } expected[] = {{1e-9, 0.204577142203468142, 54190273.460688},
                  {1e-6, 0.369486571201615379, -12990.456989049},
                  {1e-3, 0.245540494173152851, 6.6298386431607}};  // 40-digit arithmetic
  for (const auto& e : expected) {
    CHECK(law->steady_friction({e.v, 1}).friction == Approx(e.mu).epsilon(1e-14));
    CHECK(law->steady_friction({e.v, 1}).slope == Approx(e.slope).epsilon(1e-12));
  }
}

TEST_CASE("bowden-tabor: about the reference slip rate it is spinodal to first order", "[laws][bowden-tabor]") {
  // mu - spinodal = (ab/mu0) ln(v/v0) ln(c + psi/psi*), the cross term of the product.
  const auto product = laws::find_law("bowden-tabor");
  const auto sum = laws::find_law("spinodal")->with("c", product->parameter("c"));
  const double psi_ref = 1 / 101.0;
  for (const double x : {-2.0, 0.1, 3.0})
    for (const double y : {-1.0, 0.2, 2.0}) {
      const std::vector<double> state{psi_ref * (std::exp(y) - product->parameter("c"))};
      const Sliding<double> at{1e-6 * std::exp(x), 1};
      const double cross = 0.0349 * 0.0489 / 0.369 * x * y;
      CHECK(product->friction(at, state) - sum->friction(at, state) == Approx(cross).epsilon(1e-5));
    }
}

TEST_CASE("bowden-tabor: parameters that leave no contact are refused", "[laws][bowden-tabor]") {
  const auto law = laws::find_law("bowden-tabor");
  CHECK_NOTHROW(law->with("c", 1e-3));  // area 0.085 left
  CHECK_THROWS_WITH(law->with("c", 5e-4), Catch::Contains("1 + (b/mu0) ln c = -0.00727 must be positive") &&
                                              Catch::Contains("raise c above 0.000528"));
}
