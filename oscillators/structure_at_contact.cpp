/// Springs and displacements of a structure, seen from its contacts.
#include "oscillators/structure_at_contact.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

namespace rosin::oscillators {

using Eigen::MatrixXd, Eigen::VectorXd;

namespace {
std::vector<const FrictionContact*> with_friction(const Structure& structure) {
  std::vector<const FrictionContact*> list;
  for (const auto& contact : structure.contacts)
    if (!contact.frictionless()) list.push_back(&contact);
  if (list.empty()) throw InputError("the structure has no contact with friction");
  return list;
}
}  // namespace

VectorXd contact_displacement(const Structure& structure) {
  const auto contacts = with_friction(structure);
  if (contacts.size() == 1) return contacts.front()->tangential;
  const auto load = [](const FrictionContact& contact) { return contact.load_factor * contact.normal_load.level(); };
  double all = 0;
  for (const auto* contact : contacts) all += load(*contact);
  VectorXd mean = VectorXd::Zero(structure.size());
  for (const auto* contact : contacts)
    mean += (all > 0 ? load(*contact) / all : 1 / double(contacts.size())) * contact->tangential;
  return mean;
}

VectorXd spring_force(const Structure& structure) {
  const auto contacts = with_friction(structure);
  MatrixXd T(structure.size(), Eigen::Index(contacts.size())), M = structure.M;
  for (std::size_t j = 0; j < contacts.size(); ++j) T.col(Eigen::Index(j)) = contacts[j]->tangential;
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    if (M(i, i) == 0) M(i, i) = 1;  // a coordinate that touches alone, whose mass cancels
  const MatrixXd mobility = M.ldlt().solve(T);
  const VectorXd shares =
      MatrixXd(T.transpose() * mobility).completeOrthogonalDecomposition().solve(VectorXd::Ones(T.cols()));
  return structure.K.transpose() * (mobility * shares);
}

double stiffness_at_contact(const Structure& structure) {
  const auto along = contact_displacement(structure);
  const Eigen::FullPivLU<MatrixXd> springs(structure.K);
  return springs.isInvertible() ? 1 / along.dot(springs.solve(along)) : 0;
}

}  // namespace rosin::oscillators
