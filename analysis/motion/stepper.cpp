/// Implicit steps of Newmark's family with the contacts' rows solved for alone, and explicit ones.
#include "analysis/motion/stepper.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "analysis/motion/row_solver.hpp"

namespace rosin::analysis::motion {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using oscillators::StationForces, oscillators::Structure;
using Sparse = Eigen::SparseMatrix<double>;
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;  // whose products gather

/// Dead loads and the drive's forces, which mostly stay the same.
class ExternalForce {
 public:
  ExternalForce(const Structure& structure, const StationForces& contacts)
      : structure_(structure), contacts_(contacts), constant_(structure.constant()) {
    sum_ = sum(0);
  }
  const VectorXd& at(double t) {
    if (!constant_) sum_ = sum(t);
    return sum_;
  }

 private:
  VectorXd sum(double t) const {
    VectorXd f = contacts_.dead_load(t);
    for (std::size_t i = 0; i < structure_.force.size(); ++i) f[Eigen::Index(i)] += structure_.force[i].value(t);
    return f;
  }
  const Structure& structure_;
  const StationForces& contacts_;
  bool constant_;
  VectorXd sum_;
};

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
      : contacts_(contacts),
        external_(structure, contacts),
        h_(stepping.step),
        w_(weights_of(stepping)),
        M_(structure.M.sparseView()),
        C_(structure.C.sparseView()),
        K_(structure.K.sparseView()),
        B_(contacts.rows()) {
    q_ = q, v_ = v;
    const SparseRows A = (1 - w_.alpha_m) * M_ + (1 - w_.alpha_f) * h_ * (w_.gamma * C_ + w_.beta * h_ * K_);
    lu_.compute(Sparse(A));
    from_rows_ = (1 - w_.alpha_f) * lu_.solve(MatrixXd(B_.transpose()));
    rows_.emplace(contacts, B_ * from_rows_, w_.beta * h_ * h_, w_.gamma * h_);
    contacts.evaluate(0, B_ * q_, B_ * v_, forces_);
    all_forces_ = other_forces(0, q_, v_) + B_.transpose() * forces_.value;
    const Eigen::SparseLU<Sparse> of_mass{Sparse(M_)};
    a_ = of_mass.solve(all_forces_);
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
  }

  Outcome advance() override {
    const double t = t_ + h_;
    q_ += h_ * v_ + h_ * h_ * (0.5 - w_.beta) * a_, v_ += h_ * (1 - w_.gamma) * a_;
    // Without the contacts at the end of the step.
    VectorXd from = (1 - w_.alpha_f) * other_forces(t, q_, v_);
    if (w_.alpha_f != 0) from += w_.alpha_f * all_forces_;
    if (w_.alpha_m != 0) from -= w_.alpha_m * (M_ * a_);
    x_ = B_ * a_;
    a_ = lu_.solve(from);
    rows_->place = B_ * q_, rows_->rate = B_ * v_, rows_->free = B_ * a_;
    if (const auto outcome = rows_->solve(t, x_, forces_); !outcome.complete()) return outcome;
    a_ += from_rows_ * forces_.value;
    q_ += w_.beta * h_ * h_ * a_, v_ += w_.gamma * h_ * a_;
    t_ = t, iterations_ = rows_->iterations();
    if (w_.alpha_f != 0) all_forces_ = other_forces(t_, q_, v_) + B_.transpose() * forces_.value;
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
    return {};
  }

  VectorXd state() const override {
    VectorXd all(3 * q_.size());
    all << q_, v_, a_;
    return all;
  }
  void start(double t, const VectorXd& state) override {
    const auto n = q_.size();
    t_ = t, q_ = state.head(n), v_ = state.segment(n, n), a_ = state.tail(n);
    contacts_.evaluate(t_, B_ * q_, B_ * v_, forces_);
    all_forces_ = other_forces(t_, q_, v_) + B_.transpose() * forces_.value;
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
  }

 private:
  VectorXd other_forces(double t, const VectorXd& q, const VectorXd& v) {
    VectorXd f = external_.at(t);
    f.noalias() -= K_ * q;
    f.noalias() -= C_ * v;
    return f;
  }

  const StationForces& contacts_;
  ExternalForce external_;
  double h_;
  Weights w_;
  SparseRows M_, C_, K_, B_;
  Eigen::SparseLU<Sparse> lu_;
  MatrixXd from_rows_;  ///< accelerations by forces on the rows at the end of the step
  std::optional<RowSolver> rows_;
  VectorXd a_, all_forces_, x_;
};

/// v₊ = v + h a, q₊ = q + h v₊, v half a step before q, M a = f − K q − C v + contacts(q, (v + v₊)/2): friction on a
/// station answers to the mean of both velocities, so that stick sets no bound to the step.
class ExplicitStepper final : public Stepper {
 public:
  ExplicitStepper(const Structure& structure, const StationForces& contacts, const Stepping& stepping,
                  const VectorXd& q, const VectorXd& v)
      : contacts_(contacts),
        external_(structure, contacts),
        h_(stepping.step),
        mass_(structure.M.diagonal()),
        B_(contacts.rows()),
        C_(structure.C.sparseView()),
        K_(structure.K.sparseView()),
        from_rows_(mass_.cwiseInverse().asDiagonal() * Sparse(contacts.rows().transpose())),
        rows_(contacts, MatrixXd(B_ * from_rows_), 0, h_ / 2) {
    if (!structure.M.isDiagonal(0))
      throw InputError(
          "solver.scheme = \"explicit\" needs a diagonal mass matrix (oscillator.mass_matrix = \"lumped\", without "
          "oscillator.modes)");
    if (const double longest = longest_explicit_step(structure, contacts, q); h_ > longest)
      throw InputError(fmt::format(
          "solver.step = {:.4g} s of explicit steps is longer than {:.6g} s, beyond which the fastest vibration of the "
          "structure grows without bound; give a shorter one, or an implicit scheme",
          h_, longest));
    q_ = q, v_ = v;
    contacts_.evaluate(0, B_ * q_, B_ * v_, forces_);
    const VectorXd a = other_accelerations(0, v_) + from_rows_ * forces_.value;
    half_ = v_ - h_ / 2 * a, next_half_ = v_ + h_ / 2 * a;
    x_ = B_ * a;
    kinetic_energy_ = half_.dot(mass_.cwiseProduct(next_half_)) / 2;
  }

  Outcome advance() override {
    half_.swap(next_half_);
    q_ += h_ * half_;
    const VectorXd a = other_accelerations(t_ + h_, half_);
    rows_.place = B_ * q_, rows_.rate = B_ * half_, rows_.free = B_ * a;
    if (const auto outcome = rows_.solve(t_ + h_, x_, forces_); !outcome.complete()) return outcome;
    next_half_ = half_ + h_ * (a + from_rows_ * forces_.value);
    // Velocity and energy in the middle of the half steps, of second order in h.
    v_ = (half_ + next_half_) / 2;
    kinetic_energy_ = half_.dot(mass_.cwiseProduct(next_half_)) / 2;
    t_ += h_, iterations_ = rows_.iterations();
    if (!std::isfinite(kinetic_energy_)) return {Ending::not_finite, fmt::format("at t = {:.9g} s", t_)};
    return {};
  }

  VectorXd state() const override {
    VectorXd all(3 * q_.size());
    all << q_, half_, next_half_;
    return all;
  }
  void start(double t, const VectorXd& state) override {
    const auto n = q_.size();
    t_ = t, q_ = state.head(n), half_ = state.segment(n, n), next_half_ = state.tail(n);
    v_ = (half_ + next_half_) / 2;
    contacts_.evaluate(t_, B_ * q_, B_ * v_, forces_);
    kinetic_energy_ = half_.dot(mass_.cwiseProduct(next_half_)) / 2;
  }

 private:
  VectorXd other_accelerations(double t, const VectorXd& v) {
    VectorXd f = external_.at(t);
    f.noalias() -= K_ * q_;
    f.noalias() -= C_ * v;
    return f.cwiseQuotient(mass_);
  }

  const StationForces& contacts_;
  ExternalForce external_;
  double h_;
  VectorXd mass_;
  SparseRows B_, C_, K_, from_rows_;
  RowSolver rows_;
  VectorXd half_, next_half_, x_;
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

double longest_explicit_step(const Structure& structure, const StationForces& contacts, const VectorXd& q) {
  const Sparse &B = contacts.rows(), K = structure.K.sparseView(), C = structure.C.sparseView();
  const VectorXd mass = structure.M.diagonal();
  StationForces::Forces forces;
  contacts.evaluate(0, B * q, VectorXd::Zero(B.rows()), forces);
  const auto symmetric = [](const Sparse& A) -> Sparse { return (A + Sparse(A.transpose())) / 2; };
  const auto fastest =
      largest_eigenvalue(symmetric(K - Sparse(B.transpose() * Sparse(forces.by_place.sparseView()) * B)), mass);
  const double omega = std::sqrt(std::max(fastest.value, 0.0)),
               of_mass = fastest.vector.dot(mass.cwiseProduct(fastest.vector));
  const double xi = fastest.vector.dot(symmetric(C) * fastest.vector) / (2 * omega * of_mass);
  return 2 / omega * (std::sqrt(1 + xi * xi) - xi);
}

std::unique_ptr<Stepper> make_stepper(const Structure& structure, const StationForces& contacts,
                                      const Stepping& stepping, const VectorXd& q, const VectorXd& v) {
  require(stepping.step, {1e-15, 1e15}, "solver.step", "length of a step", "s");
  if (!structure.stops.empty()) throw InputError("steps of a given length do not serve structures with end stops");
  if (!structure.limited.empty() || !structure.sampled.empty())
    throw InputError("steps of a given length do not serve a servo with a limit or a sampling time");
  for (std::size_t j = 0; j < structure.contacts.size(); ++j)
    if (structure.contacts[j].law->set_valued() && !structure.contacts[j].frictionless())
      throw InputError(fmt::format(
          "contact {}: steps of a given length need friction that rises through rest (solver.smoothing)", j + 1));
  if (stepping.scheme == Scheme::explicit_steps)
    return std::make_unique<ExplicitStepper>(structure, contacts, stepping, q, v);
  return std::make_unique<ImplicitStepper>(structure, contacts, stepping, q, v);
}

}  // namespace rosin::analysis::motion
