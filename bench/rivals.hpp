/// General-purpose integrators applied to the slider's cycle the way a competent user applies them.
///
/// From near-stick, passages through v = V (v rising) until two successive ones agree, then one period is measured. Or
/// the same with an accelerated return map, so that integrator and algorithm can be told apart.
#pragma once
#include <algorithm>
#include <string>

#include "bench/slider_problem.hpp"

namespace bench {

/// What every solver is asked for.
struct Reading {
  double period = 0;          ///< s
  double stick_fraction = 0;  ///< part of the period with |v| <= 0.1 V
  double loop_area = 0;       ///< |∮ (μ − μ_ss(v)) dv|, m/s
  bool steady = false;        ///< the motion died out
  int passages = 0;
  std::string failure;  ///< empty: there is a result
};

inline constexpr int most_passages = 200;
inline constexpr double died_out = 1e-4;  ///< largest |v − V|/V of a passage below which sliding is steady

/// What is compared of successive passages. The period alone would not do: small motions have nearly the period of the
/// free slider whatever their amplitude. The state is compared ten times less strictly, because friction hangs on 0.1
/// of its logarithm (b/μ), and its returns are noisier than the period.
struct Passage {
  double period, displacement, psi;
};
inline bool agrees(const Problem& p, const Passage& now, const Passage& last, double tolerance) {
  const double size = std::max(std::abs(now.displacement), p.V * std::sqrt(p.m / p.k));
  return std::abs(now.period - last.period) <= tolerance * now.period &&
         std::abs(now.displacement - last.displacement) <= tolerance * size &&
         std::abs(now.psi - last.psi) <= 10 * tolerance * now.psi;
}

struct Start {
  double x, v, psi;
};
/// Moving with the drive but for 1e-3 of its speed, spring and state as in steady sliding.
inline Start near_stick(const Problem& p) {
  return {p.N * p.steady_friction(p.V) / p.k, 1e-3 * p.V, p.steady_state(p.V)};
}

/// How the cycle is found from the start.
enum class Search {
  follow,      ///< passage after passage until two agree
  accelerate,  ///< Anderson mixing of depth 2 on the section point (x, ln ψ), plain passages where it does not help
};

/// CVODE, BDF with dense exact Jacobian and root finding. `passages`: measure after as many instead of waiting until
/// they agree, for a start on a cycle.
template <class Form>
Reading run_cvode(const Problem&, double tolerance, const Start&, Search, int passages = 0);
/// ARKODE's default diagonally implicit Runge-Kutta method (order 4), dense exact Jacobian and root finding.
template <class Form>
Reading run_arkode(const Problem&, double tolerance, const Start&, Search);
/// Boost.odeint, rosenbrock4 with dense output; the section is found on it by bisection.
template <class Form>
Reading run_rosenbrock(const Problem&, double tolerance, const Start&, Search);

/// Largest deviation of the analytic Jacobians from differences, over points of a motion: a check of this file's own.
double jacobian_defect();

}  // namespace bench
