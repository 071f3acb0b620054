/// Eigenvalues of matrices whose entries lie decades apart.
#include "core/eigenpairs.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin;

TEST_CASE("eigenvalues of small matrices do not hang on the units of their unknowns", "[core]") {
  // Two oscillators, 3 and 40 rad/s, each weakly damped; the units are powers of two, so that nothing is rounded.
  SmallMatrix<double> even(4, 4);
  even << 0, 3, 0, 0, -3, -0.25, 0, 0, 0.5, 0, 0, 40, 0, 0, -40, -0.5;
  const Eigen::Vector4d unit(1, std::ldexp(1.0, 50), std::ldexp(1.0, -30), std::ldexp(1.0, 25));
  const SmallMatrix<double> uneven = unit.asDiagonal() * even * unit.cwiseInverse().asDiagonal();
  const auto pairs = small_eigenpairs(uneven, true);
  for (int k = 0; k < 4; ++k) {
    const auto z = pairs.values[k];
    const bool slow = std::abs(z) < 10;
    const double damping = slow ? 0.125 : 0.25, square = slow ? 9 : 1600;
    CHECK(z.real() == Approx(-damping).epsilon(1e-12));
    CHECK(std::abs(z.imag()) == Approx(std::sqrt(square - damping * damping)).epsilon(1e-14));
    const Eigen::Vector4cd vector = pairs.vectors.col(k).cwiseQuotient(unit.cast<std::complex<double>>());
    CHECK((even * vector - z * vector).norm() < 1e-13 * std::abs(z) * vector.norm());
  }
}
