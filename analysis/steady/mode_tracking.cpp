/// Shift-and-invert Krylov spaces from both sides, and the two-sided Rayleigh quotient of a quadratic pencil.
#include "analysis/steady/mode_tracking.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/eigenpairs.hpp"
#include "core/error.hpp"

namespace rosin::analysis::steady {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd, Eigen::VectorXcd, Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using SparseComplex = Eigen::SparseMatrix<Complex>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

struct Estimate {
  Complex eigenvalue;
  VectorXcd vector;
};

/// How many to follow so that none is left out whose modulus is that of the last: modes that merge grow and decay with
/// one frequency, and rounding would choose between them.
std::size_t whole_window(const std::vector<Estimate>& ascending, int count) {
  constexpr double alike = 1.01;
  std::size_t size = std::min(ascending.size(), std::size_t(count));
  while (size > 0 && size < ascending.size() &&
         std::abs(ascending[size].eigenvalue) < alike * std::abs(ascending[std::size_t(count) - 1].eigenvalue))
    ++size;
  return size;
}

/// Eigenvalues of smallest modulus with Im λ ≥ 0, by Arnoldi's method for 1/λ on (x, λx/ω): a step solves
/// −K x₁ = ω M b + C a, and x₂ = a/ω for (a, b).
std::vector<Estimate> from_krylov_space(const QuadraticPencil& pencil, int count) {
  const auto n = pencil.M.rows();
  const Eigen::SparseLU<Sparse> lu(pencil.K);
  if (lu.info() != Eigen::Success)
    throw InputError("the stiffness of steady sliding has no inverse: something moves that no spring holds (N/m)");
  // A start that no symmetry leaves modes out of.
  VectorXd start = VectorXd::NullaryExpr(2 * n, [](Eigen::Index i) { return 1 + std::sin(1.7 * double(i * i % 97)); });
  // ω of the slowest motion, so that both halves of a vector are of a size.
  VectorXd slow = start.head(n);
  double omega = 1;
  for (int k = 0; k < 5; ++k) {
    slow = lu.solve(pencil.M * slow.normalized());
    omega = 1 / std::sqrt(slow.norm());
  }
  const auto most = std::min<Eigen::Index>(2 * n, 4 * count + 40);
  MatrixXd V = MatrixXd::Zero(2 * n, most + 1), H = MatrixXd::Zero(most + 1, most);
  V.col(0) = start.normalized();
  Eigen::Index size = 0;
  while (size < most) {
    const auto a = V.col(size).head(n), b = V.col(size).tail(n);
    VectorXd w(2 * n);
    w.head(n) = -lu.solve(omega * (pencil.M * b) + pencil.C * a);
    w.tail(n) = a / omega;
    const double before = w.norm();
    for (int twice = 0; twice < 2; ++twice) {
      const VectorXd along = V.leftCols(size + 1).transpose() * w;
      w -= V.leftCols(size + 1) * along;
      H.col(size).head(size + 1) += along;
    }
    const double left = w.norm();
    ++size;
    if (left <= 1e-14 * before) break;
    H(size, size - 1) = left;
    V.col(size) = w / left;
  }
  const auto pairs = eigenpairs(H.topLeftCorner(size, size), true);
  std::vector<std::pair<Complex, Eigen::Index>> values;
  for (Eigen::Index k = 0; k < pairs.values.size(); ++k)
    if (const Complex value = 1.0 / pairs.values[k]; value.imag() >= 0 && std::isfinite(std::abs(value)))
      values.emplace_back(value, k);
  std::ranges::sort(values, {}, [](const auto& value) { return std::abs(value.first); });
  std::vector<Estimate> found;
  for (const auto& [value, k] : values)
    found.push_back({value, (V.topLeftCorner(n, size) * pairs.vectors.col(k)).normalized()});
  // One more, which tells how far the last is known.
  found.resize(std::min(found.size(), whole_window(found, count) + 1));
  return found;
}

class TwoSided {
 public:
  explicit TwoSided(const QuadraticPencil& pencil) : pencil_(pencil) {}

  /// y* P(λ) x and y* P′(λ) x.
  Complex value(const PencilMode& mode) const { return mode.left.dot(times(mode.eigenvalue, mode.right)); }
  Complex slope(const PencilMode& mode) const { return mode.left.dot(slope_times(mode.eigenvalue, mode.right)); }
  /// What rounding of the entries leaves of y* P(λ) x.
  double rounding(const PencilMode& mode) const {
    const double size = std::abs(mode.eigenvalue);
    const VectorXd x = mode.right.cwiseAbs(), y = mode.left.cwiseAbs();
    return epsilon * y.dot(size * size * (pencil_.M.cwiseAbs() * x) + size * (pencil_.C.cwiseAbs() * x) +
                           pencil_.K.cwiseAbs() * x);
  }
  /// What P(λ) x and y* P(λ) are of the rounding of their terms.
  double excess(const PencilMode& mode) const {
    const Complex z = mode.eigenvalue;
    const double size = std::abs(z),
                 allowed = epsilon * (size * size * pencil_.M.norm() + size * pencil_.C.norm() + pencil_.K.norm());
    const VectorXcd from_left = std::conj(z * z) * (pencil_.M.transpose() * mode.left) +
                                std::conj(z) * (pencil_.C.transpose() * mode.left) + pencil_.K.transpose() * mode.left;
    return std::max(times(z, mode.right).norm(), from_left.norm()) / allowed;
  }
  /// x ← P⁻¹ P′ x, y ← P⁻* P′* y.
  bool iterate(PencilMode& mode) const {
    const Complex z = mode.eigenvalue;
    const SparseComplex P =
        (z * z) * pencil_.M.cast<Complex>() + z * pencil_.C.cast<Complex>() + pencil_.K.cast<Complex>();
    const SparseComplex slope = (2.0 * z) * pencil_.M.cast<Complex>() + pencil_.C.cast<Complex>();
    Eigen::SparseLU<SparseComplex> lu(P);
    if (lu.info() != Eigen::Success) return false;  // λ is an eigenvalue to the last digit
    const VectorXcd x = lu.solve(slope * mode.right), y = lu.adjoint().solve(VectorXcd(slope.adjoint() * mode.left));
    if (!x.allFinite() || !y.allFinite()) return false;
    mode.right = x.normalized(), mode.left = y.normalized();
    return true;
  }

 private:
  VectorXcd times(Complex z, const VectorXcd& x) const {
    return (z * z) * (pencil_.M * x) + z * (pencil_.C * x) + pencil_.K * x;
  }
  VectorXcd slope_times(Complex z, const VectorXcd& x) const { return (2.0 * z) * (pencil_.M * x) + pencil_.C * x; }

  const QuadraticPencil& pencil_;
};

void refine(const TwoSided& two_sided, PencilMode& mode, double gap) {
  constexpr int most_iterations = 8;
  constexpr double rounded = 10;
  for (int iteration = 0;; ++iteration) {
    const Complex slope = two_sided.slope(mode), step = -two_sided.value(mode) / slope;
    // Where modes merge both slope and value are rounding.
    const bool moves = std::abs(step) < gap / 4;
    if (moves) mode.eigenvalue += step;
    const double doubt = two_sided.rounding(mode) / std::abs(slope);
    mode.error = std::min(doubt, std::sqrt(doubt * gap));
    const bool done = two_sided.excess(mode) < rounded;
    if (!done) mode.error = std::max(mode.error, moves ? std::abs(step) : infinity);
    if (done || iteration == most_iterations || !two_sided.iterate(mode)) break;
  }
}

}  // namespace

std::vector<PencilMode> lowest_modes(const QuadraticPencil& pencil, int count) {
  const auto right = from_krylov_space(pencil, count);
  const auto left = from_krylov_space({pencil.M.transpose(), pencil.C.transpose(), pencil.K.transpose()}, count);
  const TwoSided two_sided(pencil);
  std::vector<PencilMode> modes;
  for (std::size_t k = 0; k < whole_window(right, count); ++k) {
    const auto& [eigenvalue, vector] = right[k];
    const auto& other =
        *std::ranges::min_element(left, {}, [&](const Estimate& e) { return std::abs(e.eigenvalue - eigenvalue); });
    // Distance to the nearest other eigenvalue, the conjugate among them.
    double gap = eigenvalue.imag() != 0 ? 2 * std::abs(eigenvalue.imag()) : infinity;
    for (std::size_t i = 0; i < right.size(); ++i)
      if (i != k) gap = std::min(gap, std::abs(right[i].eigenvalue - eigenvalue));
    // y* P = 0 where Pᵀ ȳ = 0.
    PencilMode mode{eigenvalue, 0, vector, other.vector.conjugate()};
    refine(two_sided, mode, gap);
    modes.push_back(std::move(mode));
  }
  return modes;
}

PencilMode mode_near(const QuadraticPencil& pencil, Complex eigenvalue, const VectorXcd& right, double gap) {
  const TwoSided two_sided(pencil);
  // M, C and K are nearly symmetric, and one step shows the left vector: y ≈ x̄.
  PencilMode mode{eigenvalue, 0, right.normalized(), right.conjugate().normalized()};
  two_sided.iterate(mode);
  refine(two_sided, mode, gap);
  return mode;
}

}  // namespace rosin::analysis::steady
