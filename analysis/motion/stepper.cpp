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
    from_rows_ = lu_.solve(MatrixXd(B_.transpose()));
    G_ = (1 - w_.alpha_f) * (B_ * from_rows_);
    from_rows_ *= 1 - w_.alpha_f;
    largest_ = G_.cwiseAbs();
    place_ = B_ * q_, rate_ = B_ * v_;
    contacts_.evaluate(0, place_, rate_, forces_);
    all_forces_ = other_forces(0, q_, v_) + B_.transpose() * forces_.value;
    const Eigen::SparseLU<Sparse> of_mass{Sparse(M_)};
    a_ = of_mass.solve(all_forces_);
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
  }

  Outcome advance() override {
    const double t = t_ + h_, by_place = w_.beta * h_ * h_, by_rate = w_.gamma * h_;
    q_ += h_ * v_ + h_ * h_ * (0.5 - w_.beta) * a_, v_ += h_ * (1 - w_.gamma) * a_;
    // Without the contacts at the end of the step.
    VectorXd from = (1 - w_.alpha_f) * other_forces(t, q_, v_);
    if (w_.alpha_f != 0) from += w_.alpha_f * all_forces_;
    if (w_.alpha_m != 0) from -= w_.alpha_m * (M_ * a_);
    x_ = B_ * a_;
    a_ = lu_.solve(from);
    place_ = B_ * q_, rate_ = B_ * v_, free_ = B_ * a_;
    if (const auto outcome = solve_rows(t, by_place, by_rate); !outcome.complete()) return outcome;
    a_ += from_rows_ * forces_.value;
    q_ += by_place * a_, v_ += by_rate * a_;
    t_ = t;
    if (w_.alpha_f != 0) all_forces_ = other_forces(t_, q_, v_) + B_.transpose() * forces_.value;
    kinetic_energy_ = v_.dot(M_ * v_) / 2;
    return {};
  }

 private:
  static constexpr double accuracy = 1e-12;

  /// Accelerations x of the rows: x = free + G f(place + β h² x, rate + γ h x), by Newton's method from x_ on.
  Outcome solve_rows(double t, double by_place, double by_rate) {
    evaluate(t, by_place, by_rate, x_, r_);
    constexpr int most_iterations = 60;
    constexpr double rounding = 1e-14, least_part = 1e-4;
    const double free = free_.cwiseAbs().maxCoeff();
    for (int iteration = 0;; ++iteration) {
      const double size = r_.cwiseAbs().maxCoeff(), known = x_.cwiseAbs().maxCoeff() + free;
      if (size <= accuracy * known) break;
      const double terms = known + (largest_ * forces_.value.cwiseAbs()).maxCoeff();
      if (size <= rounding * terms) break;
      if (iteration == most_iterations || !std::isfinite(size))
        return {std::isfinite(size) ? Ending::tolerance_not_met : Ending::not_finite,
                fmt::format("Newton's method did not solve the step to t = {:.9g} s of {:.3g} s; give a shorter one", t,
                            h_)};
      ++iterations_;
      find_change(by_place, by_rate);
      // Slopes jump where a station opens or begins to slip: a shorter change then goes further.
      const double norm = r_.norm();
      double part = 1;
      for (;; part /= 2) {
        next_x_ = x_ + part * change_;
        evaluate(t, by_place, by_rate, next_x_, next_r_);
        if (next_r_.norm() < norm || part < least_part) break;
      }
      const bool stalls = next_r_.norm() >= norm;
      x_.swap(next_x_), r_.swap(next_r_);
      if (stalls && size <= 1e3 * rounding * terms) break;
    }
    return {};
  }

  void evaluate(double t, double by_place, double by_rate, const VectorXd& x, VectorXd& residual) {
    at_place_ = place_ + by_place * x, at_rate_ = rate_ + by_rate * x;
    contacts_.evaluate(t, at_place_, at_rate_, forces_);
    residual = x - free_;
    residual.noalias() -= G_ * forces_.value;
  }

  /// The change of x by (1 − G D) change = −r, where the slopes D of forces have columns of their own: friction that
  /// slides answers to no acceleration along the surface, and an open station to none, so that fewer are solved for.
  void find_change(double by_place, double by_rate) {
    const auto size = x_.size();
    felt_.clear();
    columns_.resize(size, size);
    const auto slope = [&](int i, int k) {
      return by_place * forces_.by_place(i, k) + by_rate * forces_.by_rate(i, k);
    };
    for (const auto& [slip, first, stations, area] : contacts_.contacts()) {
      if (const double own = slope(slip, slip); own != 0) {
        columns_.col(Eigen::Index(felt_.size())) = own * G_.col(slip);
        felt_.push_back(slip);
      }
      for (int s = first; s < first + stations; ++s) {
        const double own = slope(s, s), friction = slope(slip, s);
        if (own == 0 && friction == 0) continue;
        columns_.col(Eigen::Index(felt_.size())) = own * G_.col(s) + friction * G_.col(slip);
        felt_.push_back(s);
      }
    }
    change_ = -r_;
    const auto count = Eigen::Index(felt_.size());
    if (count == 0) return;
    few_.resize(count, count), of_few_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      few_.row(i) = -columns_.row(felt_[std::size_t(i)]).head(count);
      few_(i, i) += 1;
      of_few_[i] = -r_[felt_[std::size_t(i)]];
    }
    few_lu_.compute(few_);
    of_few_ = few_lu_.solve(of_few_).eval();
    change_.noalias() += columns_.leftCols(count) * of_few_;
  }

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
  MatrixXd from_rows_, G_, largest_;  ///< times the weight of the forces at the end of the step; |G|
  VectorXd a_, all_forces_;
  // Of a step: rows without the contacts, and what Newton's method works on.
  VectorXd place_, rate_, free_, x_, r_, next_x_, next_r_, change_, at_place_, at_rate_, of_few_;
  std::vector<int> felt_;  ///< rows on which forces depend
  MatrixXd columns_, few_;
  Eigen::PartialPivLU<MatrixXd> few_lu_;
};

/// v₊ = v + h M⁻¹ (f − K q − C v + contacts(q, v)), q₊ = q + h v₊, v half a step before q.
class ExplicitStepper final : public Stepper {
 public:
  ExplicitStepper(const Structure& structure, const StationForces& contacts, const Stepping& stepping,
                  const VectorXd& q, const VectorXd& v)
      : contacts_(contacts),
        external_(structure, contacts),
        h_(stepping.step),
        width_(stepping.stick_width),
        mass_(structure.M.diagonal()),
        B_(contacts.rows()),
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
    place_ = B_ * q_, rate_ = B_ * half_;
    contacts_.evaluate(t_, place_, rate_, forces_);
    return (external_.at(t_) - K_ * q_ - C_ * half_ + rows_to_coordinates_ * forces_.value).cwiseQuotient(mass_);
  }
  /// Velocity and energy in the middle of the half steps, of second order in h.
  void settle() {
    next_half_ = half_ + h_ * acceleration();
    v_ = (half_ + next_half_) / 2;
    kinetic_energy_ = half_.dot(mass_.cwiseProduct(next_half_)) / 2;
    ++iterations_;
  }

  const StationForces& contacts_;
  ExternalForce external_;
  double h_, width_;
  VectorXd mass_;
  SparseRows B_, C_, K_, rows_to_coordinates_;
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
