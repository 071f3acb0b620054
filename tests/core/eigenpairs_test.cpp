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

TEST_CASE("eigenvalues that merge are known to the root of rounding, separate ones to rounding", "[eigenpairs]") {
  // [[1, 1], [δ², 1]] has 1 ± δ; for δ = 0 it has one eigenvector only.
  for (const double delta : {0.0, 1e-9, 1e-3, 0.5}) {
    Eigen::MatrixXd A(3, 3);
    A << 1, 1, 0, delta * delta, 1, 0, 0, 0, -2;
    const auto spectrum = spectrum_of(A);
    REQUIRE(spectrum.values.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto value = spectrum.values[i];
      const double error = value.real() < 0 ? std::abs(value + 2.0)
                                            : std::min(std::abs(value - 1.0 - delta), std::abs(value - 1.0 + delta));
      INFO(delta << ": " << value << " ± " << spectrum.errors[i]);
      CHECK(error <= spectrum.errors[i]);
      CHECK(spectrum.errors[i] <= (value.real() < 0 || delta > 0.1 ? 1e-14 : delta > 0 && delta > 1e-6 ? 1e-11 : 1e-6));
    }
  }
}

TEST_CASE("a matrix that is not finite has eigenvalues and vectors that are no numbers", "[eigenpairs]") {
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  A(1, 2) = std::numeric_limits<double>::quiet_NaN();
  const auto pairs = eigenpairs(A, true);
  CHECK(pairs.values.array().isNaN().all());
  CHECK(pairs.vectors.rows() == 3);
  CHECK(pairs.vectors.array().isNaN().all());
}
