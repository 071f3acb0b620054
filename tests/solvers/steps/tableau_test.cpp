/// Order conditions of every tableau, tree by tree (Butcher 1963): of collocation by Gauss and Radau, and of the
/// Rosenbrock pair with its embedded solution and its dense output.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "solvers/lanes/rosenbrock_tableau.hpp"
#include "solvers/steps/gauss_tableau.hpp"
#include "solvers/steps/radau_tableau.hpp"

using namespace rosin::solvers;
using namespace rosin::solvers::steps;

namespace {

/// A rooted tree, which stands for one term of a derivative of f.
struct Tree {
  std::vector<Tree> branches;
  int order() const {
    int sum = 1;
    for (const Tree& branch : branches) sum += branch.order();
    return sum;
  }
  /// γ(t): the order times the densities of the branches.
  double density() const {
    double product = order();
    for (const Tree& branch : branches) product *= branch.density();
    return product;
  }
};

/// Trees of an order, each once: branches are taken in the order of the list of smaller trees.
std::vector<Tree> trees(int order) {
  if (order == 1) return {Tree{}};
  std::vector<Tree> smaller, found;
  for (int size = 1; size < order; ++size)
    for (Tree& tree : trees(size)) smaller.push_back(std::move(tree));
  const auto grow = [&](const auto& self, Tree tree, std::size_t from) -> void {
    const int size = tree.order();
    if (size == order) found.push_back(tree);
    for (std::size_t k = from; k < smaller.size(); ++k) {
      if (size + smaller[k].order() > order) continue;
      tree.branches.push_back(smaller[k]);
      self(self, tree, k);
      tree.branches.pop_back();
    }
  };
  grow(grow, Tree{}, 0);
  return found;
}

/// k_i = h f(y + Σ α_ij k_j) + h J Σ (β − α)_ij k_j: Runge and Kutta's where β = α, else Rosenbrock's (Hairer & Wanner
/// 1996, IV.7), in which a branch that is alone on its vertex goes with β.
struct Method {
  Eigen::MatrixXd alpha, beta;

  Eigen::VectorXd weight(const Tree& tree) const {
    Eigen::VectorXd product = Eigen::VectorXd::Ones(alpha.rows());
    const auto& way = tree.branches.size() == 1 ? beta : alpha;
    for (const Tree& branch : tree.branches) product = product.cwiseProduct(way * weight(branch));
    return product;
  }
  /// Largest |Σ b_i Φ_i(t) − θ^order/γ(t)| over the trees of an order.
  double defect(const Eigen::VectorXd& b, int order, double theta = 1) const {
    double most = 0;
    for (const Tree& tree : trees(order))
      most = std::max(most, std::abs(b.dot(weight(tree)) - std::pow(theta, order) / tree.density()));
    return most;
  }
};

}  // namespace

TEST_CASE("there are as many rooted trees as Cayley counted", "[tableau]") {
  const std::size_t counted[] = {1, 1, 2, 4, 9, 20, 48, 115};
  for (int order = 1; order <= 8; ++order) CHECK(trees(order).size() == counted[order - 1]);
}

TEST_CASE("collocation by Gauss has order 16 and by Radau order 9", "[tableau]") {
  const auto& G = GaussTableau::get();
  constexpr int s = GaussTableau::stages;
  Eigen::MatrixXd A(s, s);
  Eigen::VectorXd b(s);
  for (int i = 0; i < s; ++i) {
    b[i] = G.b.block[i];
    for (int j = 0; j < s; ++j) A(i, j) = G.a[std::size_t(j)].block[i];
  }
  const Method gauss{A, A};
  for (int order = 1; order <= 8; ++order) CHECK(gauss.defect(b, order) < 1e-14);

  const auto& R = RadauTableau::get();
  constexpr int r = RadauTableau::stages;
  Eigen::MatrixXd inverse(r, r);
  Eigen::VectorXd weights(r);
  for (int i = 0; i < r; ++i) {
    weights[i] = R.b[std::size_t(i)];
    for (int j = 0; j < r; ++j) inverse(i, j) = R.a_inverse[std::size_t(i)][std::size_t(j)];
  }
  const Eigen::MatrixXd a = inverse.inverse();
  const Method radau{a, a};
  for (int order = 1; order <= 8; ++order) CHECK(radau.defect(weights, order) < 1e-14);
  // Σ_j a_ij c_j^(k−1) = c_i^k/k up to k = s, Σ b_i c_i^(k−1) = 1/k up to 2s − 1, and no further.
  for (int k = 1; k <= 2 * r; ++k) {
    double sum = 0;
    for (int i = 0; i < r; ++i) {
      sum += weights[i] * std::pow(R.c[std::size_t(i)], k - 1);
      double stage = 0;
      for (int j = 0; j < r; ++j) stage += a(i, j) * std::pow(R.c[std::size_t(j)], k - 1);
      if (k <= r) CHECK(std::abs(stage - std::pow(R.c[std::size_t(i)], k) / k) < 1e-14);
    }
    CHECK((std::abs(sum - 1.0 / k) < 1e-14) == (k < 2 * r));
  }
  // The end of the step is the last stage, and the polynomial through the stages passes through them.
  for (int i = 0; i < r; ++i) CHECK(a(r - 1, i) == Approx(weights[i]).epsilon(1e-13));
  for (int i = 0; i < r; ++i) {
    std::array<double, r + 1> values{};
    values[std::size_t(i) + 1] = 1;
    for (int j = 0; j < r; ++j)
      CHECK(R.interpolate(values, R.c[std::size_t(j)]) == Approx(i == j ? 1 : 0).margin(1e-13));
  }
}

TEST_CASE("Radau's embedded estimate has order 5, with a weight of 1/γ at the start", "[tableau]") {
  // err = h/γ f₀ + Σ e_i Z_i, Z = h A f: of slopes θ^(k−1) nothing is left up to k = 5.
  const auto& R = RadauTableau::get();
  constexpr int r = RadauTableau::stages;
  for (int k = 1; k <= r + 1; ++k) {
    double estimate = k == 1 ? 1 / R.gamma : 0;
    for (int i = 0; i < r; ++i) estimate += R.error_weights[std::size_t(i)] * std::pow(R.c[std::size_t(i)], k) / k;
    INFO(k << ": " << estimate);
    CHECK((std::abs(estimate) < 1e-13) == (k <= r));
  }
}

TEST_CASE("Rodas5 has order 5, its embedded solution and its dense output order 4", "[tableau]") {
  // In Hairer & Wanner's transformed form: C = diag(1/γ) − Γ⁻¹, a = α Γ⁻¹, m = b Γ⁻¹.
  constexpr int s = lanes::Rodas5::stages;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(s, s), C = a;
  for (int i = 0; i < s; ++i)
    for (int j = 0; j < i; ++j) a(i, j) = lanes::Rodas5::a[i][j], C(i, j) = lanes::Rodas5::c[i][j];
  const Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(s, s) / lanes::Rodas5::gamma - C, Gamma = inverse.inverse();
  const Eigen::MatrixXd alpha = a * Gamma;
  const Method rodas{alpha, alpha + Gamma};
  const auto natural = [&](const Eigen::VectorXd& m) { return Eigen::VectorXd(Gamma.transpose() * m); };
  const Eigen::VectorXd embedded = a.row(s - 1);
  Eigen::VectorXd end = embedded;
  end[s - 1] += 1;
  constexpr double digits = 1e-13;  // of coefficients up to 318 with sixteen digits
  for (int order = 1; order <= 6; ++order) {
    INFO("order " << order << ": " << rodas.defect(natural(end), order) << ", embedded "
                  << rodas.defect(natural(embedded), order));
    CHECK((rodas.defect(natural(end), order) < digits) == (order <= 5));
    CHECK((rodas.defect(natural(embedded), order) < digits) == (order <= 4));
    for (const double theta : {0.1, 0.35, 0.8}) {
      Eigen::VectorXd dense = theta * end;
      for (int k = 0; k < lanes::Rodas5::dense_terms; ++k)
        for (int j = 0; j < s; ++j) dense[j] += theta * (1 - theta) * std::pow(theta, k) * lanes::Rodas5::dense[k][j];
      INFO("at " << theta << ": " << rodas.defect(natural(dense), order, theta));
      CHECK((rodas.defect(natural(dense), order, theta) < digits) == (order <= 4));
    }
  }
  for (int i = lanes::Rodas5::chained_from; i < s; ++i) {  // Y_i = Y_{i−1} + U_{i−1}
    Eigen::VectorXd expected = a.row(i - 1);
    expected[i - 1] += 1;
    CHECK(a.row(i).transpose() == expected);
  }
}
