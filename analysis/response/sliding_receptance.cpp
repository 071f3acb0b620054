/// Dense complex solves of the equations linearised in steady sliding.
#include "analysis/response/sliding_receptance.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "analysis/steady/structure_stability.hpp"
#include "analysis/steady/verdict.hpp"

namespace rosin::analysis::response {

using Complex = std::complex<double>;
using Eigen::VectorXd;
using oscillators::Structure;
using oscillators::StructureSystem;

namespace {

const oscillators::FrictionContact& friction_contact(const Structure& structure, int contact) {
  const int count = int(structure.contacts.size());
  if (contact < 0 || contact >= count)
    throw InputError(fmt::format("frf.contact = {}: the structure has contacts 1 … {}", contact + 1, count));
  const auto& chosen = structure.contacts[std::size_t(contact)];
  if (chosen.frictionless())
    throw InputError(fmt::format(
        "frf.contact = {}: that contact presses without friction, which has no response to slip rate", contact + 1));
  return chosen;
}

/// In the modes of slip along its surfaces, which move at their levels.
StructureSystem sliding(Structure structure) {
  StructureSystem system(steady::frozen(std::move(structure)), Unknowns::states);
  steady::require_sliding(system.structure());
  system.slide();
  return system;
}

}  // namespace

oscillators::Model contact_in_sliding(const Structure& structure, int contact) {
  const auto& chosen = friction_contact(structure, contact);
  oscillators::Model model;
  model.law = chosen.law, model.lambda = chosen.lambda;
  model.contact_stiffness = chosen.stiffness, model.load_memory = chosen.load_memory;
  const auto system = sliding(structure);
  model.drive = {chosen.speed, system.normal_load(contact, 0, system.steady(0).data()), 0.0};
  return model;
}

SlidingReceptance::SlidingReceptance(const Structure& moving, int contact)
    : tangential_(friction_contact(moving, contact).tangential) {
  const auto system = sliding(moving);
  const auto y = system.steady(0);
  const int size = system.size();
  J_.resize(size, size), mass_.resize(size), force_.resize(size);
  VectorXd unforced(size);
  system.linearise(0, y.data(), unforced.data(), J_.data());
  system.mass(0, mass_.data());
  // Forces enter to the first power: beside one that is large enough the others are nothing.
  constexpr double large = 0x1p200;
  auto forced = moving;
  forced.force.assign(std::size_t(moving.size()), 0.0);
  for (int i = 0; i < moving.size(); ++i) forced.force[std::size_t(i)] = large * tangential_[i];
  sliding(std::move(forced)).evaluate(0, y.data(), force_.data());
  force_ = (force_ - unforced) / large;
  if (!J_.allFinite() || !force_.allFinite())
    throw InputError("steady sliding cannot be linearised here: its derivatives are not finite");
}

SlidingReceptance::Answer SlidingReceptance::operator()(Complex s) const {
  const auto size = J_.rows(), n = tangential_.size();
  Eigen::MatrixXcd A = -J_.cast<Complex>();
  A.diagonal() += s * mass_.cast<Complex>();
  Eigen::VectorXcd b = force_.cast<Complex>();
  for (Eigen::Index i = 0; i < size; ++i) {  // rows have units of their own
    const double largest = A.row(i).cwiseAbs().maxCoeff();
    if (largest > 0) A.row(i) /= largest, b[i] /= largest;
  }
  const Eigen::MatrixXcd inverse = A.partialPivLu().inverse();
  Eigen::VectorXcd x = inverse * b;
  x += inverse * (b - A * x);
  // Each entry of the equations is known to some units of its last digit.
  constexpr double known = 1e-14;
  const VectorXd left = known * (A.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs());
  const VectorXd error = inverse.cwiseAbs() * left;
  Answer answer{{x.begin(), x.begin() + n}, {error.begin(), error.begin() + n}, 0, 0};
  answer.contact = tangential_.cast<Complex>().dot(x.head(n));
  answer.contact_error = tangential_.cwiseAbs().dot(error.head(n));
  return answer;
}

}  // namespace rosin::analysis::response
