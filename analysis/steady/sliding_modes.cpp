/// Newton's method on sparse tangents, and the pencil of small motions about where it ends.
#include "analysis/steady/sliding_modes.hpp"

#include <fmt/format.h>

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "analysis/steady/verdict.hpp"

namespace rosin::analysis::steady {

namespace {

using Eigen::VectorXd;
using oscillators::StationForces, oscillators::Structure;
using Sparse = Eigen::SparseMatrix<double>;

class Sliding {
 public:
  Sliding(const Structure& structure, const StationForces& contacts)
      : contacts_(contacts), K_(structure.K.sparseView()), load_(contacts.dead_load(0)) {
    for (std::size_t i = 0; i < structure.force.size(); ++i) load_[Eigen::Index(i)] += structure.force[i].value(0);
    still_ = VectorXd::Zero(contacts.size());
  }

  /// Where stations that all bear the same pressure, and answer as they do there, would balance the dead load.
  VectorXd pressed(const Structure& structure) const {
    const Sparse& B = contacts_.rows();
    VectorXd force = load_, stiffness = VectorXd::Zero(B.rows());
    for (std::size_t j = 0; j < contacts_.contacts().size(); ++j) {
      const auto& contact = contacts_.contacts()[j];
      if (!contact.presses()) continue;
      const double pressure = contacts_.load(int(j), 0) / contact.area;
      const NormalLaw& law = *structure.contacts[j].normal_law;
      const double a = law.approach_under(pressure), by_approach = law.at(a, 0, pressure).pressure_by_approach;
      for (int s = contact.first; s < contact.first + contact.stations; ++s) {
        stiffness[s] = contacts_.area(s) * by_approach;
        // The station's place is gap + a: −A (p + p′ (s − gap − a)).
        const double place = a - contacts_.approach(s, still_);
        force -= B.row(s).transpose() * (contacts_.area(s) * pressure - stiffness[s] * place);
      }
    }
    const Sparse slope = K_ + Sparse(B.transpose() * stiffness.asDiagonal() * B);
    return solve(slope, force);
  }

  /// Newton's method from q with a part of the friction. \returns whether it got there
  bool balance(double friction, VectorXd& q) const {
    constexpr int most_iterations = 40;
    constexpr double rounding = 1e-13, least_part = 1e-3;
    constexpr double balanced = 1e-9, of_use = 1e-6;  // parts of the loads
    StationForces::Forces forces;
    VectorXd size, r = residual(friction, q, forces, size);
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
      if ((r.cwiseAbs() - rounding * size).maxCoeff() <= 0 && balances(r, forces, balanced)) return true;
      const VectorXd change = solve(tangent(forces), r);
      if (!change.allFinite()) return false;
      double part = 1;
      VectorXd next;
      const double before = r.norm(), rounded = rounding * size.norm();
      for (; part > least_part; part /= 2) {
        next = residual(friction, q + part * change, forces, size);
        if (next.norm() < before || next.norm() < rounded) break;
      }
      if (part <= least_part) return false;
      q += part * change, r = next;
      if (r.norm() < rounded && r.norm() >= before / 2) return balances(r, forces, of_use);  // rounding is reached
    }
    return false;
  }

  /// Up to a part of the loads. A block that friction tips over goes so far that rounding of K q is more than its
  /// weight: that is no balance. One on a soft spring goes far, too, and rounding is a small part of its weight.
  bool balances(const VectorXd& residual, const StationForces::Forces& forces, double part) const {
    return residual.norm() <= part * (load_.norm() + (contacts_.rows().transpose() * forces.value).norm());
  }

  /// −∂R/∂q at the forces.
  Sparse tangent(const StationForces::Forces& forces) const {
    const Sparse& B = contacts_.rows();
    return K_ - Sparse(B.transpose() * Sparse(forces.by_place.sparseView()) * B);
  }
  VectorXd residual(double friction, const VectorXd& q, StationForces::Forces& forces, VectorXd& size) const {
    const Sparse& B = contacts_.rows();
    contacts_.evaluate(0, B * q, still_, forces, friction);
    size = K_.cwiseAbs() * q.cwiseAbs() + load_.cwiseAbs() + B.cwiseAbs().transpose() * forces.value.cwiseAbs();
    return load_ - K_ * q + B.transpose() * forces.value;
  }

 private:
  static VectorXd solve(const Sparse& A, const VectorXd& b) {
    const Eigen::SparseLU<Sparse> lu(A);
    if (lu.info() != Eigen::Success)
      throw oscillators::NoSteadySliding(
          "K has no inverse: a structure that no spring holds has no steady sliding (stiffness, N/m)");
    return lu.solve(b);
  }

  const StationForces& contacts_;
  Sparse K_;
  VectorXd load_, still_;
};

}  // namespace

VectorXd steady_sliding(const Structure& structure, const StationForces& contacts) {
  const Sliding sliding(structure, contacts);
  VectorXd q = sliding.pressed(structure);
  constexpr double least_part = 1e-3;
  double reached = 0;
  for (double part = 1; reached < 1;) {
    VectorXd next = q;
    const double friction = std::min(1.0, reached + part);
    if (sliding.balance(friction, next)) {
      reached = friction, q = next;
      continue;
    }
    part /= 4;
    if (part < least_part)
      throw oscillators::NoSteadySliding(
          fmt::format("no steady sliding was found with more than {:.3g} of the friction", reached));
  }
  return q;
}

QuadraticPencil pencil_of_sliding(const Structure& structure, const StationForces& contacts,
                                  const StationForces::Forces& forces) {
  const Sparse& B = contacts.rows();
  QuadraticPencil pencil{structure.M.sparseView(), structure.C.sparseView(), structure.K.sparseView()};
  pencil.K -= Sparse(B.transpose() * Sparse(forces.by_place.sparseView()) * B);
  pencil.C -= Sparse(B.transpose() * Sparse(forces.by_rate.sparseView()) * B);
  return pencil;
}

StructureStability lowest_modes_of_sliding(const Structure& moving, int count) {
  const Structure structure = frozen(moving);
  require_sliding(structure);
  const StationForces contacts(structure);
  const VectorXd q = steady_sliding(structure, contacts);
  StructureStability result;
  result.coordinates.assign(q.begin(), q.end());
  const VectorXd inertia = structure.M.diagonal();
  result.inertia.assign(inertia.begin(), inertia.end());
  const Sparse& B = contacts.rows();
  StationForces::Forces forces;
  contacts.evaluate(0, B * q, VectorXd::Zero(B.rows()), forces);
  for (std::size_t j = 0; j < contacts.contacts().size(); ++j) {
    const auto& [slip, first, stations, area] = contacts.contacts()[j];
    result.contacts.push_back({stations > 0 ? -forces.value.segment(first, stations).sum() : contacts.load(int(j), 0),
                               forces.value[slip], contacts.speed(int(j), 0)});
  }
  const auto pencil = pencil_of_sliding(structure, contacts, forces);
  double most = -infinity, error_of_most = 0;
  for (auto& mode : lowest_modes(pencil, count)) {
    const auto value = mode.eigenvalue;
    if (value.real() > most) most = value.real(), error_of_most = mode.error;
    result.eigenvalues.push_back(value);
    if (value.imag() != 0) result.eigenvalues.push_back(std::conj(value));
    Eigen::Index largest = 0;
    mode.right.cwiseAbs().maxCoeff(&largest);
    mode.right /= std::complex<double>(mode.right[largest]);
    result.modes.push_back({value, mode.error, {mode.right.begin(), mode.right.end()}});
  }
  conclude(result, most, error_of_most);
  return result;
}

}  // namespace rosin::analysis::steady
