/// Static shapes of the coordinates that contacts move, and modes of the others.
#include "oscillators/block_reduction.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "core/error.hpp"

namespace rosin::oscillators {

using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

/// What is inside, with the contacts held.
struct Held {
  MatrixXd M, K;
  Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes;
  Eigen::LLT<MatrixXd> springs;
};

/// Members of a family of scenes ask for the modes of the same block, over and over: the last ones are kept.
std::shared_ptr<const Held> held(MatrixXd M, MatrixXd K) {
  static std::mutex guard;
  static std::shared_ptr<const Held> last;
  const std::scoped_lock lock(guard);
  if (last && last->M.rows() == M.rows() && last->M == M && last->K == K) return last;
  auto now = std::make_shared<Held>();
  now->modes.compute(K, M), now->springs.compute(K);
  if (now->modes.info() != Eigen::Success || now->springs.info() != Eigen::Success)
    throw InputError("with its contacts held the structure still moves: springs must hold the rest (stiffness, N/m)");
  now->M = std::move(M), now->K = std::move(K);
  return last = now;
}

}  // namespace

Reduction::Reduction(Structure from, int count) : whole(std::move(from)), modes(count) {
  std::vector<int> inside;
  for (int i = 0; i < whole.size(); ++i)
    (std::ranges::any_of(whole.contacts,
                         [&](const FrictionContact& contact) {
                           return contact.tangential[i] != 0 ||
                                  (contact.normal.size() > 0 && !contact.normal.row(i).isZero(0));
                         })
         ? touching
         : inside)
        .push_back(i);
  const auto first = Eigen::Index(touching.size());
  if (modes < 0 || modes > int(inside.size()))
    throw InputError(
        fmt::format("modes must be 0 to {} (1), the coordinates that no contact moves, got {}", inside.size(), modes));
  // The weight sinks the interior by a shape of its own, which all modes together make up.
  const bool sinks = modes < int(inside.size()) && !whole.contacts.empty() && whole.contacts[0].load_along.size() > 0;
  basis = MatrixXd::Zero(whole.size(), first + modes + (sinks ? 1 : 0));
  basis(touching, Eigen::seqN(0, first)).setIdentity();
  if (!inside.empty()) {
    const auto interior = held(whole.M(inside, inside), whole.K(inside, inside));
    for (const double squared : interior->modes.eigenvalues())
      frequency.push_back(std::sqrt(squared) / (2 * std::numbers::pi));
    basis(inside, Eigen::seqN(0, first)) = -interior->springs.solve(whole.K(inside, touching));
    const auto add = [&](Eigen::Index column, const VectorXd& shape) {
      Eigen::Index largest = 0;
      shape.cwiseAbs().maxCoeff(&largest);
      basis(inside, column) = shape / shape[largest];
    };
    const auto& shapes = interior->modes.eigenvectors();  // φᵀ M φ = 1, φᵀ K φ = ω²
    for (int k = 0; k < modes; ++k) add(first + k, shapes.col(k));
    if (sinks) {
      const VectorXd weight = whole.contacts[0].load_along(inside), sunk = interior->springs.solve(weight);
      const auto kept = shapes.leftCols(modes);
      add(first + modes, sunk - kept * (interior->modes.eigenvalues().head(modes).cwiseInverse().asDiagonal() *
                                        (kept.transpose() * weight)));
    }
  }

  const auto onto_basis = [&](const MatrixXd& matrix) -> MatrixXd {
    const MatrixXd all = basis.transpose() * (matrix.sparseView() * basis);
    return (all + all.transpose()) / 2;
  };
  reduced.M = onto_basis(whole.M), reduced.C = onto_basis(whole.C), reduced.K = onto_basis(whole.K);
  for (const int i : touching) reduced.names.push_back(whole.names[i]);
  for (int k = 1; k <= modes; ++k) reduced.names.push_back(fmt::format("mode_{}", k));
  if (sinks) reduced.names.push_back("sinking");
  reduced.functionals = whole.functionals;
  for (auto& functional : reduced.functionals) functional.row = basis.transpose() * functional.row;
  reduced.contacts = whole.contacts;
  for (auto& contact : reduced.contacts) {
    contact.tangential = basis.transpose() * contact.tangential;
    if (contact.normal.size() > 0) contact.normal = basis.transpose() * contact.normal;
    if (contact.load_along.size() > 0) contact.load_along = basis.transpose() * contact.load_along;
  }
}

VectorXd Reduction::coordinates(const VectorXd& displacements) const {
  const auto first = Eigen::Index(touching.size());
  VectorXd result = VectorXd::Zero(basis.cols());
  result.head(first) = displacements(touching);
  const VectorXd left = whole.M * (displacements - basis * result);
  for (Eigen::Index k = first; k < basis.cols(); ++k) result[k] = basis.col(k).dot(left) / reduced.M(k, k);
  return result;
}

}  // namespace rosin::oscillators
