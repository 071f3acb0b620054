/// Options of the force algorithms.
#pragma once
#include <cstddef>

namespace rosin::solvers::force_algorithms {

/// Options of all algorithms; each takes what it needs.
struct Options {
  double step = 0;                 ///< s; 0: a thousandth of the shortest period
  bool closed_form = false;        ///< steps by the closed form of each state instead of Runge–Kutta
  bool micro_slip = true;          ///< leaving stick, friction opposes the force until the velocity follows it
  double window = 1e-4;            ///< O-FBFM: speed below which the mass counts as at rest, m/s
  double adherence_stiffness = 0;  ///< SDFM: K_t, N/m; 0: 1e4 k
  double adherence_damping = 1.5;  ///< SDFM: ζ_t = C_t/(2 √(m K_t))
  bool original = false;           ///< AABG: as published, without force balance, released at μd N
  bool refusal = true;             ///< TR: an entry whose adherence force exceeds μs N just after the crossing is none
  bool restart_before = true;      ///< TR: restart at the first step with |F_a| ≥ μd N, not at the one after it
  double transition_speed = 1e-3;  ///< VLFM, SVLFM: V_l below which friction falls to zero, m/s
  std::size_t most_sticks = 0;     ///< ends the motion with the end of as many sticks; 0: never
};

}  // namespace rosin::solvers::force_algorithms
