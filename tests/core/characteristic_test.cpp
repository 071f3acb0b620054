/// Eigenvalues by the expanded determinant: spread over many decades, for more unknowns, with errors that hold.
#include "core/characteristic.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin;

namespace {
/// An arrow: one row and column full, the rest diagonal, as memory in many parts that feed one unknown.
/// Its eigenvalues are the roots of s − a − Σ b_i c_i/(s − d_i).
struct Arrow {
  double a;
  std::vector<double> b, c, d;
  std::vector<double> matrix() const {
    const std::size_t n = d.size() + 1;
    std::vector<double> J(n * n, 0);
    J[0] = a;
    for (std::size_t i = 1; i < n; ++i) J[i] = b[i - 1], J[i * n] = c[i - 1], J[i * n + i] = d[i - 1];
    return J;
  }
  /// Distance to the next root, by one step of Newton's method in extended precision.
  double distance(std::complex<double> at) const {
    using Complex = std::complex<long double>;
    const Complex s = at;
    Complex value = s - Complex(a), slope = 1;
    for (std::size_t i = 0; i < d.size(); ++i) {
      const Complex term = Complex(static_cast<long double>(b[i]) * c[i]) / (s - Complex(d[i]));
      value -= term;
      slope += term / (s - Complex(d[i]));
    }
    return double(std::abs(value / slope));
  }
};
}  // namespace

TEST_CASE("twelve eigenvalues over thirty decades all keep their digits", "[characteristic]") {
  Arrow arrow{-3, {}, {}, {}};
  for (int i = 0; i < 11; ++i) {
    arrow.d.push_back(-std::pow(10.0, 3 * i - 15) * (1 + 0.1 * i));
    arrow.b.push_back(i % 2 ? -0.4 : 0.3);
    arrow.c.push_back((i % 3 ? 0.5 : -0.8) * std::abs(arrow.d.back()));
  }
  const std::vector<double> mass(12, 1.0);
  const auto roots = characteristic_roots(arrow.matrix(), mass);
  REQUIRE(roots.values.size() == 12);
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    CAPTURE(i, roots.values[i]);
    CHECK(arrow.distance(roots.values[i]) <= roots.errors[i]);
    CHECK(roots.errors[i] < 1e-11 * std::abs(roots.values[i]));
    sum += roots.values[i];
  }
  double trace = arrow.a;
  for (const double d : arrow.d) trace += d;
  CHECK(sum.real() == Approx(trace).epsilon(1e-14));
}

TEST_CASE("algebraic rows lower the number of eigenvalues", "[characteristic]") {
  // 0 = x + 2 y - z with x' = -x + z, y' = 3 z - 5 y: z eliminated.
  const std::vector<double> J{-1, 0, 1, 0, -5, 3, 1, 2, -1}, mass{1, 1, 0};
  const auto roots = characteristic_roots(J, mass);
  REQUIRE(roots.values.size() == 2);
  // x' = 2 y, y' = 3 x + y: s² - s - 6 = 0.
  const double least = std::min(roots.values[0].real(), roots.values[1].real());
  CHECK(least == Approx(-2).epsilon(1e-14));
  CHECK(roots.values[0].real() + roots.values[1].real() == Approx(1).epsilon(1e-14));
}

TEST_CASE("a double root where the slope vanishes is known within its error", "[characteristic]") {
  const std::vector<double> J{2, 0, 0, 0, 2, 0, 0, 0, -3}, mass{1, 1, 1};
  const auto roots = characteristic_roots(J, mass);
  REQUIRE(roots.values.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double exact = roots.values[i].real() > 0 ? 2 : -3;
    CHECK(std::abs(roots.values[i] - exact) <= roots.errors[i]);
    CHECK(std::abs(roots.values[i].real() - exact) <= roots.real_errors[i]);
    CHECK(roots.errors[i] < 1e-5);
  }
}
