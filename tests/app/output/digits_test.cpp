/// Digits of numbers by their errors.
#include "app/output/digits.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin::app::output;

TEST_CASE("numbers have digits down to the decade of their errors", "[output]") {
  CHECK(digits_by_error(22.587055801, 3e-8) == "22.58705580");
  CHECK(digits_by_error(12345.6, 20) == "12350");
  CHECK(digits_by_error(1.2345e9, 2e7) == "1.23e+09");
  CHECK(digits_by_error(2e-6, 3e-5) == "0");
  CHECK(digits_by_error(0.25, NAN) == "0.25");
  CHECK(with_error(19.1, 0.0007) == "19.1000 ± 0.0007");
  CHECK(with_error(0.01, 2e-12) == "0.010000000000 ± 2e-12");
  CHECK(with_error(95.4, 1.4) == "95 ± 1");
  CHECK(with_error(50, 12) == "50 ± 10");
  CHECK(with_error(0.123456, 0) == "0.1235");
}
