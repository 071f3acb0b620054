/// What the collocation asks of the Jacobian of a system: to solve its stage equations, to judge rounding and growth.
/// Dense for small systems, banded for large ones that tell where entries stand.
#pragma once
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "core/system.hpp"
#include "solvers/steps/radau_tableau.hpp"

namespace rosin::solvers::steps {

class StageAlgebra {
 public:
  virtual ~StageAlgebra() = default;
  /// f at (t, y), and J = ∂f/∂y to be kept.
  virtual void linearise(double t, const double* y, double* f) = 0;
  /// Diagonal of J.
  virtual double own_slope(int row) const = 0;
  /// Σ|J_ij y_j| over j.
  virtual double size_of_terms(int row, const double* y) const = 0;
  /// J_aa x = r over the rows without mass, in place; entries of other rows are left alone. \returns false if J_aa is
  /// singular.
  virtual bool solve_algebraic(const std::vector<double>& mass, double* r) = 0;
  /// (λ M/h − J) for the real eigenvalue of A⁻¹ and one of each complex pair.
  virtual void factorise(double h, const std::vector<double>& mass) = 0;
  virtual void solve_real(double* x) = 0;
  virtual void solve_pair(int pair, std::complex<double>* x) = 0;
  /// True if an odd number of modes grows faster than `rate` (1/s) without oscillating (growth.hpp).
  virtual bool grows_faster(double rate, const std::vector<double>& mass) = 0;

  /// An attempted step whose matrices are factorised.
  struct Attempt {
    double length;
    double resolved_growth;  ///< largest growth z = λ·length resolved to the tolerance
    const std::vector<double>&y, &mass, &scale;
    std::span<const double> estimate;  ///< embedded estimate, filtered once
    double size;                       ///< size of the estimate, in scales
  };
  /// Error of oscillations that the step rings with, in scales (oscillations.hpp).
  virtual double error_of_oscillations(const Attempt&) = 0;
  /// The longest step that resolves the fastest growing oscillation at the last attempt.
  virtual double longest_step() const = 0;
  /// Accepts the last attempt.
  virtual void accept() = 0;
  /// Forgets what is known of oscillations.
  virtual void forget() = 0;
  /// Upper bound, for each unknown, of the errors by passed-over oscillations since construction.
  virtual std::span<const double> passed_over() const = 0;
};

/// \throws InputError for a system of more unknowns than fit, without a pattern or with one of far couplings.
std::unique_ptr<StageAlgebra> stage_algebra(const System&, const RadauTableau&, double tolerance);

}  // namespace rosin::solvers::steps
