/// Implicit steps of Newmark's family with the contacts' rows solved for alone, and explicit ones.
#include "analysis/motion/stepper.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace rosin::analysis::motion {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using oscillators::StationForces, oscillators::Structure;
using Sparse = Eigen::SparseMatrix<double>;

VectorXd external_force(const Structure& structure, const StationForces& contacts, double t) {
  VectorXd f = contacts.dead_load(t);
  for (std::size_t i = 0; i < structure.force.size(); ++i) f[Eigen::Index(i)] += structure.force[i].value(t);
  return f;
}

/// (1 − α_m) M a₊ + α_m M a = (1 − α_f) R₊ + α_f R with all other forces R, q₊ = q + h v + h² ((½ − β) a + β a₊),
/// v₊ = v + h ((1 − γ) a + γ a₊).
struct Weights {
  double alpha_m = 0, alpha_f = 0, beta = 0.25, gamma = 0.5;
};

Weights weights_of(const Stepping& stepping) {
  if (stepping.scheme == Scheme::average_acceleration) return {};
  const double rho = stepping.spectral_radius;
  Weights w{(2 * rho - 1) / (rho + 1), rho / (rho + 1)};
  w.gamma = 0.5 - w.alpha_m + w.alpha_f;
  w.beta = std::pow(1 - w.alpha_m + w.alpha_f, 2) / 4;
  return w;
}

class ImplicitStepper final : public Stepper {
 public:
  ImplicitStepper(const Structure& structure, const StationForces& contacts, const Stepping& stepping,
                  const VectorXd& q, const VectorXd& v)
      : structure_(structure),
        contacts_(contacts),
        h_(stepping.step),
        w_(weights_of(stepping)),
        M_(structure.M.sparseView()),
        C_(structure.C.sparseView()),
        K_(structure.K.sparseView()) {
    q_ = q, v_ = v;
    const Sparse A = (1 - w_.alpha_m) * M_ + (1 - w_.alpha_f) * h_ * (w_.gamma * C_ + w_.beta * h_ * K_);
    lu_.compute(A);
    const Sparse& B = contacts_.rows();
    from_rows_ = lu_.solve(MatrixXd(B.transpose()));
    G_ = B * from_rows_;
    place_ = B * q_, rate_ = B * v_;
    contacts_.evaluate(0, place_, rate_, forces_);
    others_ = other_forces(0, q_, v_);
    const Eigen::SparseLU<Sparse> of_mass(M_);
    a_ = of_mass.solve(others_ + B.transpose() * forces_.value);
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
  }

  Outcome advance() override {
    const Sparse& B = contacts_.rows();
    const double t = t_ + h_, kept = 1 - w_.alpha_f;
    const VectorXd q = q_ + h_ * v_ + h_ * h_ * (0.5 - w_.beta) * a_, v = v_ + h_ * (1 - w_.gamma) * a_;
    // Without the contacts at the end of the step.
    const VectorXd a = lu_.solve(kept * other_forces(t, q, v) + w_.alpha_f * (others_ + B.transpose() * forces_.value) -
                                 w_.alpha_m * (M_ * a_));
    const VectorXd place = B * q, rate = B * v, free = B * a;
    const double by_place = w_.beta * h_ * h_, by_rate = w_.gamma * h_;
    // Accelerations of the rows: x = free + kept G f(place + β h² x, rate + γ h x).
    VectorXd x = B * a_;
    const auto residual = [&](const VectorXd& x, StationForces::Forces& forces) -> VectorXd {
      contacts_.evaluate(t, place + by_place * x, rate + by_rate * x, forces);
      return x - free - kept * (G_ * forces.value);
    };
    VectorXd r = residual(x, forces_);
    constexpr int most_iterations = 60;
    constexpr double rounding = 1e-14, least_part = 1e-4;
    for (int iteration = 0;; ++iteration) {
      const double size = r.cwiseAbs().maxCoeff(), terms = x.cwiseAbs().maxCoeff() + free.cwiseAbs().maxCoeff() +
                                                           (G_.cwiseAbs() * forces_.value.cwiseAbs()).maxCoeff();
      if (size <= accuracy * (x.cwiseAbs().maxCoeff() + free.cwiseAbs().maxCoeff()) || size <= rounding * terms) break;
      if (iteration == most_iterations || !std::isfinite(size))
        return {std::isfinite(size) ? Ending::tolerance_not_met : Ending::not_finite,
                fmt::format("Newton's method did not solve the step to t = {:.9g} s of {:.3g} s; give a shorter one", t,
                            h_)};
      ++iterations_;
      const MatrixXd slope = MatrixXd::Identity(x.size(), x.size()) -
                             kept * G_ * (by_place * forces_.by_place + by_rate * forces_.by_rate);
      const VectorXd change = -slope.partialPivLu().solve(r);
      // Slopes jump where a station opens or begins to slip: a shorter change then goes further.
      double part = 1;
      VectorXd next_r;
      for (;; part /= 2) {
        next_r = residual(x + part * change, forces_);
        if (next_r.norm() < r.norm() || part < least_part) break;
      }
      const bool stalls = next_r.norm() >= r.norm();
      x += part * change, r = next_r;
      if (stalls && size <= 1e3 * rounding * terms) break;
    }
    a_ = a + kept * (from_rows_ * forces_.value);
    q_ = q + by_place * a_, v_ = v + by_rate * a_;
    t_ = t;
    others_ = other_forces(t_, q_, v_);
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
    return {};
  }

 private:
  static constexpr double accuracy = 1e-12;

  VectorXd other_forces(double t, const VectorXd& q, const VectorXd& v) const {
    return external_force(structure_, contacts_, t) - K_ * q - C_ * v;
  }

  const Structure& structure_;
  const StationForces& contacts_;
  double h_;
  Weights w_;
  Sparse M_, C_, K_;
  Eigen::SparseLU<Sparse> lu_;
  MatrixXd from_rows_, G_;
  VectorXd a_, others_, place_, rate_;
};

/// v₊ = v + h M⁻¹ (f − K q − C v + contacts(q, v)), q₊ = q + h v₊, v half a step before q.
class ExplicitStepper final : public Stepper {
 public:
  ExplicitStepper(const Structure& structure, const StationForces& contacts, const Stepping& stepping,
                  const VectorXd& q, const VectorXd& v)
      : structure_(structure),
        contacts_(contacts),
        h_(stepping.step),
        width_(stepping.stick_width),
        mass_(structure.M.diagonal()),
        C_(structure.C.sparseView()),
        K_(structure.K.sparseView()),
        rows_to_coordinates_(contacts.rows().transpose()),
        limits_(explicit_limits(structure, contacts, q)) {
    if (!structure.M.isDiagonal(0))
      throw InputError(
          "solver.scheme = \"explicit\" needs a diagonal mass matrix (oscillator.mass_matrix = \"lumped\")");
    if (h_ > limits_.slipping)
      throw InputError(fmt::format(
          "solver.step = {:.4g} s of explicit steps is longer than {:.6g} s, beyond which the fastest vibration of the "
          "structure grows without bound; give a shorter one, or an implicit scheme",
          h_, limits_.slipping));
    q_ = q, half_ = v, v_ = v;
    half_ -= h_ / 2 * acceleration();
    settle();
  }

  Outcome advance() override {
    half_ = next_half_;
    q_ += h_ * half_;
    t_ += h_;
    settle();
    if (!std::isfinite(kinetic_energy_)) return {Ending::not_finite, fmt::format("at t = {:.9g} s", t_)};
    if (h_ > limits_.sticking)
      for (std::size_t j = 0; j < contacts_.contacts().size(); ++j)
        if (const int slip = contacts_.contacts()[j].slip;
            forces_.value[slip] != 0 && std::abs(contacts_.speed(int(j), t_) - rate_[slip]) < width_)
          return {Ending::tolerance_not_met,
                  fmt::format("contact {} came to stick at t = {:.6g} s, where explicit steps must be shorter than "
                              "{:.3g} s",
                              j + 1, t_, limits_.sticking)};
    return {};
  }

 private:
  VectorXd acceleration() {
    place_ = contacts_.rows() * q_, rate_ = contacts_.rows() * half_;
    contacts_.evaluate(t_, place_, rate_, forces_);
    return (external_force(structure_, contacts_, t_) - K_ * q_ - C_ * half_ + rows_to_coordinates_ * forces_.value)
        .cwiseQuotient(mass_);
  }
  /// Velocity and energy in the middle of the half steps, of second order in h.
  void settle() {
    next_half_ = half_ + h_ * acceleration();
    v_ = (half_ + next_half_) / 2;
    kinetic_energy_ = half_.dot(mass_.cwiseProduct(next_half_)) / 2;
    ++iterations_;
  }

  const Structure& structure_;
  const StationForces& contacts_;
  double h_, width_;
  VectorXd mass_;
  Sparse C_, K_, rows_to_coordinates_;
  StepLimits limits_;
  VectorXd half_, next_half_, place_, rate_;
};

/// Largest eigenvalue of M⁻¹ A with its vector, by iteration of powers.
struct Largest {
  double value;
  VectorXd vector;
};
Largest largest_eigenvalue(const Sparse& A, const VectorXd& mass) {
  VectorXd x = VectorXd::LinSpaced(A.rows(), 1, 2).array().sin() + VectorXd::LinSpaced(A.rows(), 0, 700).array().cos();
  double value = 0;
  constexpr int most = 3000;
  constexpr double settled = 1e-10;
  for (int k = 0; k < most; ++k) {
    x.normalize();
    const VectorXd y = (A * x).cwiseQuotient(mass);
    const double now = x.dot(A * x) / x.dot(mass.cwiseProduct(x));
    const bool done = std::abs(now - value) <= settled * std::abs(now);
    value = now;
    if (done || y.isZero(0)) break;
    x = y;
  }
  return {value, x.normalized()};
}

}  // namespace

StepLimits explicit_limits(const Structure& structure, const StationForces& contacts, const VectorXd& q) {
  const Sparse &B = contacts.rows(), K = structure.K.sparseView(), C = structure.C.sparseView();
  const VectorXd mass = structure.M.diagonal();
  const auto slopes = [&](bool at_rest) {
    VectorXd rate = VectorXd::Zero(B.rows());
    for (std::size_t j = 0; j < contacts.contacts().size() && at_rest; ++j)
      rate[contacts.contacts()[j].slip] = contacts.speed(int(j), 0);
    StationForces::Forces forces;
    contacts.evaluate(0, B * q, rate, forces);
    return std::pair<Sparse, Sparse>(forces.by_place.sparseView(), forces.by_rate.sparseView());
  };
  const auto symmetric = [](const Sparse& A) -> Sparse { return (A + Sparse(A.transpose())) / 2; };
  const auto [by_place, by_rate] = slopes(false);
  const Sparse stiffness = symmetric(K - Sparse(B.transpose() * by_place * B)),
               damping = symmetric(C - Sparse(B.transpose() * by_rate * B));
  const auto fastest = largest_eigenvalue(stiffness, mass);
  const double omega = std::sqrt(std::max(fastest.value, 0.0)),
               of_mass = fastest.vector.dot(mass.cwiseProduct(fastest.vector));
  const double xi = fastest.vector.dot(damping * fastest.vector) / (2 * omega * of_mass);
  const auto resting = slopes(true);
  const Sparse held = symmetric(C - Sparse(B.transpose() * resting.second * B));
  return {2 / omega * (std::sqrt(1 + xi * xi) - xi), 2 / largest_eigenvalue(held, mass).value};
}

std::unique_ptr<Stepper> make_stepper(const Structure& structure, const StationForces& contacts,
                                      const Stepping& stepping, const VectorXd& q, const VectorXd& v) {
  require(stepping.step, {1e-15, 1e15}, "solver.step", "length of a step", "s");
  if (!structure.stops.empty()) throw InputError("steps of a given length do not serve structures with end stops");
  for (std::size_t j = 0; j < structure.contacts.size(); ++j)
    if (structure.contacts[j].law->set_valued() && !structure.contacts[j].frictionless())
      throw InputError(fmt::format(
          "contact {}: steps of a given length need friction that rises through rest (solver.smoothing)", j + 1));
  if (stepping.scheme == Scheme::explicit_steps)
    return std::make_unique<ExplicitStepper>(structure, contacts, stepping, q, v);
  return std::make_unique<ImplicitStepper>(structure, contacts, stepping, q, v);
}

}  // namespace rosin::analysis::motion
