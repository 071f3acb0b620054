/// Orthogonal iteration round the factors: a periodic Schur form, block by block of like moduli.
#include "core/product_eigenvalues.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/eigenpairs.hpp"

namespace rosin {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using Complex = std::complex<double>;

namespace {

struct Factored {
  MatrixXd Q, R;
};

Factored factored(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  const Index n = A.cols();
  return {qr.householderQ() * MatrixXd::Identity(A.rows(), n), qr.matrixQR().topRows(n).triangularView<Eigen::Upper>()};
}

/// An orthogonal matrix in no relation to anything: no column lies in the null space of a factor.
MatrixXd some_orthogonal(Index n) {
  MatrixXd A(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) A(i, j) = std::cos(1.0 + 0.7 * double(i) + 2.3 * double(j) * double(i + 1));
  return factored(A).Q;
}

/// Where blocks of the triangular form begin: their moduli differ tenfold at least, so that each round makes the
/// coupling of two blocks smaller by that.
std::vector<Index> blocks(const VectorXd& log_modulus) {
  const double apart = std::log(10.0);
  std::vector<Index> begins{0};
  for (Index j = 1; j < log_modulus.size(); ++j)
    if (log_modulus.head(j).minCoeff() - log_modulus.tail(log_modulus.size() - j).maxCoeff() > apart)
      begins.push_back(j);
  begins.push_back(log_modulus.size());
  return begins;
}

}  // namespace

std::vector<Complex> product_eigenvalues(const std::vector<MatrixXd>& factors) {
  const Index n = factors.empty() ? 0 : factors.front().cols();
  if (n == 0) return {};
  if (!std::ranges::all_of(factors, [](const MatrixXd& A) { return A.allFinite(); }))
    return std::vector<Complex>(std::size_t(n), NAN);
  // Q_k R_k = A_k Q_{k−1}: round after round the columns of Q_0 turn into those of the product's Schur form.
  MatrixXd begin, end = some_orthogonal(n);
  std::vector<MatrixXd> R(factors.size());
  std::vector<Index> begins;
  constexpr int most_rounds = 60;
  constexpr double coupled = 1e-14, nothing = 1e-300;
  VectorXd mean = VectorXd::Zero(n);
  for (int round = 0; round < most_rounds; ++round) {
    begin = end;
    VectorXd log_modulus = VectorXd::Zero(n);
    for (std::size_t k = 0; k < factors.size(); ++k) {
      auto [Q, triangle] = factored(factors[k] * end);
      for (Index j = 0; j < n; ++j) log_modulus[j] += std::log(std::max(std::abs(triangle(j, j)), nothing));
      R[k] = std::move(triangle), end = std::move(Q);
    }
    mean = round < 2 ? log_modulus : VectorXd(0.5 * (mean + log_modulus));  // those of a pair vary from round to round
    begins = blocks(mean);
    const MatrixXd turn = begin.transpose() * end;
    double coupling = 0;
    for (std::size_t b = 1; b + 1 < begins.size(); ++b) {
      const Index j = begins[b];
      coupling = std::max(coupling, turn.bottomLeftCorner(n - j, j).cwiseAbs().maxCoeff());
    }
    if (round > 2 && coupling < coupled) break;
  }
  const MatrixXd turn = begin.transpose() * end;
  std::vector<Complex> values;
  for (std::size_t b = 0; b + 1 < begins.size(); ++b) {
    const Index first = begins[b], size = begins[b + 1] - first;
    MatrixXd block = MatrixXd::Identity(size, size);
    double log_size = 0;
    const auto multiply = [&](const MatrixXd& A) {
      block = A.block(first, first, size, size) * block;
      const double largest = block.cwiseAbs().maxCoeff();
      if (!(largest > 0)) return;
      block /= largest, log_size += std::log(largest);
    };
    for (const auto& triangle : R) multiply(triangle);
    multiply(turn);
    const auto found = eigenpairs(block).values;
    for (Index j = 0; j < size; ++j) values.push_back(found[j] * std::exp(log_size));
  }
  std::ranges::sort(values, [](auto a, auto b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) > std::abs(b) : a.imag() > b.imag();
  });
  return values;
}

}  // namespace rosin
