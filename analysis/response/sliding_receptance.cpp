/// Dense complex solves of the equations linearised in steady sliding.
#include "analysis/response/sliding_receptance.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "analysis/steady/linearised.hpp"
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
  if (chosen.ring)
    throw InputError(
        fmt::format("frf.contact = {}: inside a ring the direction of slip turns with the motion, and a response to "
                    "slip rate has none",
                    contact + 1));
  return chosen;
}

/// In the modes of slip along its surfaces, which move at their levels.
StructureSystem sliding(Structure structure) {
  StructureSystem system(steady::frozen(std::move(structure)), Unknowns::states);
  steady::require_sliding(system.structure());
  system.slide();
  return system;
}

/// M ẏ = J y + b F, and where the slip is read.
struct Linearised {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor J;
  VectorXd mass, force, tangential;
  SlidingReceptance::Answer answer(Complex s) const;
};

SlidingReceptance::Answer Linearised::answer(Complex s) const {
  const auto size = J.rows(), n = tangential.size();
  Eigen::MatrixXcd A = -J.cast<Complex>();
  A.diagonal() += s * mass.cast<Complex>();
  Eigen::VectorXcd b = force.cast<Complex>();
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
  SlidingReceptance::Answer answer{{x.begin(), x.begin() + n}, {error.begin(), error.begin() + n}, 0, 0};
  answer.contact = tangential.cast<Complex>().dot(x.head(n));
  answer.contact_error = tangential.cwiseAbs().dot(error.head(n));
  return answer;
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

SlidingReceptance sliding_receptance(const Structure& moving, int contact) {
  Linearised equations{{}, {}, {}, friction_contact(moving, contact).tangential};
  auto& [J, mass, force, tangential] = equations;
  const auto system = sliding(moving);
  auto at = steady::linearise(system, system.steady(0));
  J = std::move(at.J), mass = std::move(at.mass), force.resize(system.size());
  // Forces enter to the first power: beside one that is large enough the others are nothing.
  constexpr double large = 0x1p200;
  auto forced = moving;
  forced.force.assign(std::size_t(moving.size()), 0.0);
  for (int i = 0; i < moving.size(); ++i) forced.force[std::size_t(i)] = large * tangential[i];
  sliding(std::move(forced)).evaluate(0, at.y.data(), force.data());
  force = (force - at.f) / large;
  if (!J.allFinite() || !force.allFinite())
    throw InputError("steady sliding cannot be linearised here: its derivatives are not finite");
  return {moving.names, [equations = std::move(equations)](Complex s) { return equations.answer(s); }};
}

}  // namespace rosin::analysis::response
