/// CVODE (SUNDIALS) behind the System interface: variable-order BDF with the exact Jacobian and root finding.
///
/// For systems without algebraic rows. rosin's own collocation is the default; this is its independent check and the
/// yardstick of the benches.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/error.hpp"
#include "core/system.hpp"

namespace rosin::solvers::steps {

class Cvode {
 public:
  /// Functions whose zeros are located, by (t, y) → values.
  using Roots = std::function<void(double t, const double* y, double* values)>;
  /// \throws InputError if the system has an algebraic row.
  Cvode(const System&, double tolerance, int roots = 0, Roots root_functions = {});
  ~Cvode();
  Cvode(Cvode&&) noexcept;

  void start(double t, std::span<const double> y);
  /// No step but the next, whose length is chosen, may be longer (s); infinity to lift the bound.
  void bound_step(double longest);
  /// One internal step; stops exactly at t_limit, or at a root (then `root_found()` tells which).
  Outcome step(double t_limit);
  double time() const;
  const std::vector<double>& state() const;
  /// The solution inside the last internal step (order of the method).
  void interpolate(double t, double* y) const;
  /// dy/dt of the method's own polynomial, at time().
  void rate(double* rate) const;
  /// Directions of the roots found by the last step (0: none, ±1: rising or falling); empty unless it ended at one.
  const std::vector<int>& root_found() const;
  struct Count {
    long steps = 0, evaluations = 0, jacobians = 0;
  };
  Count count() const;

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace rosin::solvers::steps
