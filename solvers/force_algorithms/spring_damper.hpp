/// Spring-damper models: stick is an overdamped spring to the place where the velocity passed zero.
///
/// AABG: J. Antunes, F. Axisa, B. Beaufils & D. Guilbaud, IMechE C416 (1988), J. Fluids Struct. 4 (1990) 287. TR:
/// X. Tan & R. J. Rogers, with the integration taken back to where adherence and kinetic friction meet.
#pragma once
#include "solvers/force_algorithms/force_balance.hpp"

namespace rosin::solvers::force_algorithms {

/// The stiffness K_t, and C_t for its damping ratio.
template <int D>
struct Adhesion {
  explicit Adhesion(const stick_slip::DryMass<D>& mass, const Options& options) {
    stiffness = options.adherence_stiffness;
    if (stiffness == 0)
      for (const double k : mass.stiffness) stiffness = std::max(stiffness, 1e4 * k);
    damping = 2 * options.adherence_damping * std::sqrt(mass.mass * stiffness);
  }
  double stiffness, damping;
};

/// AABG-SDFM; `back_steps` makes it TR-SDFM.
///
/// AABG: just after the crossing the damper acts on a velocity of the wrong sign: a spike, and where C_t |V| exceeds
/// μs N the stick is refused. TR: entry is smooth, but where the restart exceeds μs N stick breaks at its first check.
template <int D, bool back_steps>
struct SpringDamper : Algorithm<D> {
  explicit SpringDamper(const Adhesion<D>& adhesion) : adhesion_(adhesion) {}

  stick_slip::Vector<D> friction(const SteppedMotion<D>&, double, const stick_slip::Vector<D>& z,
                                 const stick_slip::Vector<D>& w) const {
    stick_slip::Vector<D> F;
    for (int d = 0; d < D; ++d) F[d] = -adhesion_.stiffness * (z[d] - anchor_[d]) - adhesion_.damping * w[d];
    return F;
  }
  typename Algorithm<D>::Adherence adherence(const SteppedMotion<D>&, int d) const {
    return {adhesion_.stiffness, adhesion_.damping, anchor_[d]};
  }
  void begin_stick(SteppedMotion<D>& motion, std::size_t n, const stick_slip::Vector<D>& z) {
    anchor_ = z;
    motion.stick(n);
  }

  void decide(SteppedMotion<D>& motion, std::size_t n) {
    const auto& options = motion.options();
    const bool original = !back_steps && options.original;
    if (motion.state() == State::stick) {
      const double limit = original ? motion.dynamic_limit(n) : motion.static_limit(n);
      return adherence_force(motion, n) <= limit ? motion.keep(n) : motion.release(n);
    }
    if (motion.state() == State::micro_slip) return motion.end_micro_slip(n);
    const auto component = turned(motion, n);
    if (!component || (!original && length<D>(motion.balance(n)) > motion.static_limit(n)))
      return motion.slide_along(n, motion.slip(n));

    const auto kept = anchor_;
    const double before = motion.slip(n - 1)[*component], now = motion.slip(n)[*component];
    const double part = before == now ? 0 : before / (before - now);
    const auto z0 = motion.relative(n - 1), z1 = motion.relative(n);
    for (int d = 0; d < D; ++d) anchor_[d] = z0[d] + part * (z1[d] - z0[d]);
    const bool tested = !back_steps || options.refusal;
    if (tested && adherence_force(motion, n) > motion.static_limit(n)) {
      anchor_ = kept;
      return motion.slide_along(n, motion.slip(n));
    }
    std::size_t restart = n;
    if constexpr (back_steps) {
      const auto may_go_back = [&] { return restart > 0 && motion.state_of(restart - 1) != State::stick; };
      while (may_go_back() && adherence_force(motion, restart - 1) < motion.dynamic_limit(restart - 1)) --restart;
      if (options.restart_before && may_go_back()) --restart;
    }
    motion.stick(restart, static_cast<int>(n - restart));
  }

 private:
  double adherence_force(const SteppedMotion<D>& motion, std::size_t n) const {
    return length<D>(friction(motion, 0, motion.relative(n), motion.slip(n)));
  }
  Adhesion<D> adhesion_;
  stick_slip::Vector<D> anchor_{};
};

}  // namespace rosin::solvers::force_algorithms
