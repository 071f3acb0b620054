/// A contact of one coordinate as the isotropic contact in the plane that it is along every line.
#pragma once
#include <functional>
#include <memory>

#include "core/contact.hpp"
#include "solvers/stick_slip/plane_solver.hpp"

namespace rosin::solvers::stick_slip {

/// A contact that is smooth through rest, and its one unknown that turns with the slip, which may be none: a
/// deflection, a stress, or the coefficient of friction that the contact carries. With u the slip rate, ζ that unknown
/// and ψ the others, a contact with
///   g_ζ(u, ζ) − g_ζ(u, 0) and F(u, ζ) − F(u, 0) even in u, g_ψ(u, ζ) even in both,
/// is in the plane, along the unit vectors û and ζ̂,
///   M ζ̇ = g_ζ(|u|, 0) û + [g_ζ(|u|, |ζ|) − g_ζ(|u|, 0)] ζ̂,  F = F(|u|, 0) û + [F(|u|, |ζ|) − F(|u|, 0)] ζ̂,
///   M ψ̇ = g_ψ(|u|, |ζ|).
/// Of bristles that is the isotropic form ż = u − (σ₀|u|/g(|u|)) z of Velenis, Tsiotras & Canudas-de-Wit (2005).
struct PlaneFriction {
  std::shared_ptr<const Contact<double>> contact;
  int turning = -1;  ///< place of ζ among the unknowns; −1: there is none
  /// Of a contact that carries friction: additional creep, over the slip rate that counts as fast, at the largest
  /// steady friction there and a thousand times slower. Without it friction would reverse within less than rounding
  /// resolves.
  double creep = 0;
  /// By the slip rate that counts as fast: slip slower than this (m/s) changes states by other rates, so that steps
  /// must end before it; 0: there is no such range.
  std::function<double(double fast)> near_rest = nullptr;
  std::function<double(double)> slip_kink = nullptr;          ///< as in SlipFriction
  std::function<double(const double*)> state_kink = nullptr;  ///< the same of the unknowns ψ, where no unknown turns
};

/// Unknowns of the plane: those of the contact in their order, the turning one as two, along x and y.
class PlaneContact {
 public:
  static constexpr int capacity = Slopes<double>::capacity + 1;

  /// \param slip_rate  that counts as fast; under that load its steady sliding gives the sizes of the unknowns
  PlaneContact(PlaneFriction, double slip_rate, double load);

  int unknowns() const { return along_ + (friction_.turning >= 0 ? 1 : 0); }
  const PlaneFriction& friction() const { return friction_; }
  /// Sizes by which errors in the unknowns are measured.
  const double* weight() const { return weight_; }
  void mass(double load, double* m) const;

  struct PlaneSlopes {
    double g_z[capacity][capacity], g_u[capacity][2], F_z[2][capacity], F_u[2][2];
  };
  /// Rows g of the unknowns z and friction F along u, and their slopes unless these are null.
  void evaluate(const PlaneVector& u, double load, const double* z, double* g, PlaneVector& F,
                PlaneSlopes* slopes) const;

 private:
  PlaneFriction friction_;
  int along_;         ///< unknowns of the contact along a line
  double creep_ = 0;  ///< m/s
  double weight_[capacity] = {};
};

}  // namespace rosin::solvers::stick_slip
