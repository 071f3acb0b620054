/// The ensemble solver: 32 systems in SIMD lanes, each with its own time, step, tolerance and events.
///
/// A Rosenbrock pair, so that a step costs one linearisation, one factorisation and a fixed number of evaluations in
/// every lane. What one lane does is independent of its neighbours, to the last bit.
#pragma once
#include <array>
#include <cstdint>

#include "core/lane_system.hpp"
#include "solvers/lanes/rosenbrock_tableau.hpp"

namespace rosin::solvers::lanes {

class Ensemble {
 public:
  using Method = Rodas5;
  static constexpr int unrolled = 8;   ///< systems up to this size have their own code
  static constexpr int capacity = 18;  ///< most unknowns: two of the mechanics and all that a contact may have

  /// \throws InputError for more unknowns than `capacity`.
  explicit Ensemble(const LaneSystem&);

  /// As LaneWork::use_packs, of the steps; the system has its own.
  void use_packs(int packs) { packs_ = packs; }
  /// Begins at y in one lane. Errors are measured by `tolerance` times the system's scale.
  void start(int lane, const double* y, double tolerance, double first_step);
  /// Steps of each lane must not exceed `longest` (s).
  void bound_steps(const Lanes& longest) { longest_ = longest; }

  /// Tries one step in every lane; lanes where it fails keep their state and try a shorter one next time.
  void attempt();
  /// True if the last try succeeded. Lanes that nobody started try too; their results have no meaning.
  bool accepted(int lane) const { return accepted_[lane / pack_width].truth[lane % pack_width] != 0; }
  const Mask& accepted_of_pack(int p) const { return accepted_[p]; }

  /// Takes back the last step of a lane, which succeeded; the next try has `theta` of its length.
  void retake(int lane, double theta);
  /// Places a lane at `theta` (about 1) of its last step by the dense output, and makes it go on from there.
  void adjust(int lane, double theta);

  double time(int lane) const { return time_[lane]; }
  const Lanes& times() const { return time_; }
  /// Length of the last try.
  const Lanes& length() const { return length_; }
  double next_length(int lane) const { return h_[lane]; }
  /// Unknown i of all lanes now, and before the last try.
  const Lanes& unknown(int i) const { return y_[i]; }
  const Lanes* unknowns() const { return y_.data(); }
  const Lanes& unknown_before(int i) const { return before_[i]; }
  /// Unknown i of one lane at `theta` of the last step that succeeded, and its derivative by theta.
  double interpolate(int lane, int i, double theta) const { return polynomial(lane, i).value(theta); }
  double slope(int lane, int i, double theta) const { return polynomial(lane, i).slope(theta); }
  /// The dense output of unknown i over the last try: y(θ) = (1−θ) y + θ (y₁ + (1−θ)(k₁ + θ(k₂ + θ k₃))).
  template <class Real>
  struct Polynomial {
    Real y0, y1, k[3];
    ROSIN_INLINE Real value(const Real& theta) const {
      return (1.0 - theta) * y0 + theta * (y1 + (1.0 - theta) * (k[0] + theta * (k[1] + theta * k[2])));
    }
    /// dy/dθ.
    ROSIN_INLINE Real slope(const Real& theta) const {
      const Real inner = k[0] + theta * (k[1] + theta * k[2]);
      return y1 - y0 + (1.0 - 2.0 * theta) * inner + theta * (1.0 - theta) * (k[1] + 2.0 * theta * k[2]);
    }
    /// ∫ y dθ over the step.
    ROSIN_INLINE Real mean() const { return 0.5 * (y0 + y1) + bulge(); }
    /// ∫ y dx over the step, exact but for rounding.
    ROSIN_INLINE Real integral_by(const Polynomial& x) const {
      const Real *a = x.k, *b = k;
      const Real dx = x.y1 - x.y0;
      return 0.5 * (y0 + y1) * dx + bulge() * dx - (y1 - y0) * x.bulge() +
             (1.0 / 60) * (b[0] * (a[1] + a[2]) - a[0] * (b[1] + b[2])) + (1.0 / 210) * (b[1] * a[2] - b[2] * a[1]);
    }

   private:
    /// ∫ θ(1−θ)(k₁ + θ(k₂ + θ k₃)) dθ.
    ROSIN_INLINE Real bulge() const { return (1.0 / 6) * k[0] + (1.0 / 12) * k[1] + (1.0 / 20) * k[2]; }
  };
  Polynomial<double> polynomial(int lane, int i) const;
  /// The same for all lanes of pack p.
  ROSIN_INLINE Polynomial<Pack> polynomial_of_pack(int p, int i) const;

 private:
  template <class Size>
  void try_step(Size n);
  template <class Size>
  void factorise_pack(Size n, int p);
  template <int s, class Size>
  void solve_stage(Size n, int p);
  template <class Size>
  void decide(Size n, int p);

  const LaneSystem& system_;
  int size_, packs_ = lane_packs;
  std::array<Lanes, capacity> y_, before_, tried_, stage_, f_, mass_, scale_;
  std::array<Lanes, capacity * capacity> factors_;  ///< LU without pivoting; the diagonal holds reciprocals
  std::array<std::array<Lanes, capacity>, Method::stages> U_;
  Lanes h_, longest_, time_, time_before_, tolerance_;
  Lanes length_;                            ///< of the last try
  Lanes accepted_error_, accepted_length_;  ///< of the last success, for the predictive step control; length 0: none
  std::array<Mask, lane_packs> accepted_{};
};

ROSIN_INLINE Ensemble::Polynomial<Pack> Ensemble::polynomial_of_pack(int p, int i) const {
  Polynomial<Pack> q{before_[i].pack[p], tried_[i].pack[p], {0.0, 0.0, 0.0}};
  ROSIN_UNROLL
  for (int term = 0; term < Method::dense_terms; ++term) ROSIN_UNROLL
  for (int s = 0; s < Method::stages; ++s) q.k[term] = q.k[term] + Method::dense[term][s] * U_[s][i].pack[p];
  return q;
}

}  // namespace rosin::solvers::lanes
