/// Steady sliding, its eigenvalues, and the Hopf points where it loses stability.
///
/// Exact linear algebra on the linearised contact; no integration. Sources: Rice & Ruina (1983); Woodhouse, Putelat &
/// McKay (2015), eqs 3.1-3.5.
#pragma once
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "oscillators/model.hpp"
#include "oscillators/slider_system.hpp"

namespace rosin::analysis::steady {

using oscillators::Model;

/// Steady sliding at the drive's speed and load (levels of the signals).
struct SteadySliding {
  double slip_rate;  ///< m/s
  double friction_coefficient;
  double friction_force;      ///< N
  double displacement;        ///< m; 0 for an imposed slip rate
  std::vector<double> state;  ///< natural units, in the order of the law's states
};
/// \throws InputError at zero drive speed or where the law has no finite steady state.
SteadySliding steady_sliding(const Model&);

struct Stability {
  SteadySliding steady;
  std::vector<std::complex<double>> eigenvalues;  ///< 1/s, largest real part first
  std::vector<double> eigenvalue_errors;          ///< absolute, 1/s: what rounding of the linearised equations allows
  bool stable;                                    ///< all real parts < 0
  /// Steady sliding is a continuum of equilibria or marginal (undamped Coulomb friction): |Re| within rounding of 0.
  bool marginal;
};
Stability stability(const Model&);

enum class Criticality { supercritical, subcritical, degenerate };
std::string name(Criticality);

/// Re c₁/ω of the normal form ẇ = iω w + c₁ w|w|², w scaled so that the slip rate of the first contact is
/// V(1 + |w| cos ωt), and its error.
struct NormalFormCoefficient {
  double value, error;
};
/// Of sliding at a Hopf point with that frequency (rad/s), by exact derivatives. Nothing where the pair is double.
std::optional<NormalFormCoefficient> normal_form(const Model&, double angular_frequency);

/// A parameter value at which a pair of eigenvalues ±iω crosses the imaginary axis.
struct HopfPoint {
  std::string parameter;
  double value;
  double value_error;        ///< absolute estimate
  double angular_frequency;  ///< rad/s
  Criticality criticality;
  /// Re c₁/ω of the normal form ẇ = iω w + c₁ w|w|², w scaled so that the slip rate is V(1 + |w| cos ωt):
  /// dimensionless, negative: stable small cycles on the unstable side (supercritical).
  double first_lyapunov_coefficient;
  bool closed_form;  ///< value from the closed form (single-state laws), else located numerically
};

/// The Hopf point at the critical load, where that has a closed form which the eigenvalues on both sides bear out.
/// \throws as hopf_points().
std::optional<HopfPoint> hopf_at_critical_load(const Model&);

/// Hopf points in one parameter, nearest (in ratio) to the model's value first; empty if there is none within
/// `decades` of it. Any law, any parameter path.
std::vector<HopfPoint> hopf_points(const Model&, std::string_view parameter, double decades = 12);

/// The critical normal load of a law with one state on a slider with mass, in closed form (N, rad/s); nothing where
/// steady sliding is stable at every load or unstable at every load. Woodhouse et al. (2015), eq 3.5, with a series
/// contact spring; undamped.
struct CriticalLoad {
  double normal_load, angular_frequency;
};
std::optional<CriticalLoad> critical_load(const Model&);
/// True where that decides: where there is no critical load, there is no Hopf point in load.
bool critical_load_is_closed(const Model&);
/// Whether steady sliding is stable, where the closed form shows that beyond rounding.
std::optional<bool> surely_stable(const Model&);

}  // namespace rosin::analysis::steady
