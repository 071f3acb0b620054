/// Whether a structure's vibration sets in softly or with a jump, where steady sliding loses its stability.
#pragma once
#include <complex>
#include <functional>
#include <optional>

#include "analysis/steady/stability.hpp"
#include "analysis/steady/thresholds.hpp"

namespace rosin::analysis::steady {

struct StructureHopf {
  Criticality criticality;  ///< degenerate: the coefficient is 0 within its error
  /// As that of HopfPoint, Re c₁/ω, w scaled so that the slip rate of the first contact is V(1 + |w| cos ωt), and what
  /// differences of the right-hand side leave open.
  double first_lyapunov_coefficient, error;
  /// Of the small cycle, |w| over the root of the distance of the parameter from the threshold: above it where growth
  /// and criticality go so, else below. 0: degenerate.
  double amplitude;
};

/// Re c₁/|ω| of the mode with that eigenvalue: exact in the sense of the normal form where Re s = 0, continued from
/// there elsewhere, with s itself in its equations. Nothing where the pair is double or no slip moves with it.
std::optional<NormalFormCoefficient> normal_form(const oscillators::Structure&, std::complex<double> eigenvalue);

/// At a crossing of the structures along a parameter. Nothing where no pair of eigenvalues crosses by itself: where
/// undamped modes merge, or a real one passes 0.
std::optional<StructureHopf> hopf_at(const std::function<oscillators::Structure(double)>&, const Crossing&);

}  // namespace rosin::analysis::steady
