/// A number that knows its logarithm.
#include "core/with_log.hpp"

#include <catch2/catch.hpp>

using namespace rosin;

TEST_CASE("a number made from its logarithm gives it back to the last digit, others compute it", "[with-log]") {
  for (const double logarithm : {-700.0, -0.1, 0.0, 1.0 / 3, 500.0}) {
    const auto x = WithLog<double>::from_log(logarithm);
    CHECK(log(x) == logarithm);
    CHECK(double(x) == std::exp(logarithm));
    CHECK(log(WithLog<double>(double(x))) == std::log(double(x)));
    CHECK(x * 2.0 == 2.0 * std::exp(logarithm));
  }
}

TEST_CASE("derivatives go with it, and in lanes too", "[with-log]") {
  using D = Dual<double, 2>;
  const auto z = D::variable(0.7, 1);
  const auto x = WithLog<D>::from_log(z);
  const D known = log(x), computed = log(D(x));
  CHECK(known.value == 0.7);
  CHECK(known.slope[1] == 1.0);
  CHECK(computed.slope[1] == Approx(1.0).epsilon(1e-15));
  CHECK((x * x).slope[1] == Approx(2 * std::exp(1.4)).epsilon(1e-15));

  const auto lanes = WithLog<Pack>::from_log(Pack(-3.25));
  CHECK(log(lanes).block[7] == -3.25);
  CHECK((lanes * Pack(2.0)).block[0] == Approx(2 * std::exp(-3.25)).epsilon(1e-15));
}
