/// Steady sliding along a parameter, the Hopf points on the way, and the branches of cycles: born there, doubled, or
/// followed from a motion that has settled.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "analysis/branches/continuation.hpp"
#include "analysis/branches/normal_form.hpp"
#include "analysis/branches/oscillator.hpp"
#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/structure_start.hpp"
#include "analysis/steady/thresholds.hpp"

namespace rosin::analysis::branches {

/// A motion that has settled on a cycle.
struct Settled {
  Outcome outcome;
  std::vector<double> y;  ///< unknowns of the oscillator
  double period = 0;      ///< s
  int turns = 1;          ///< periods of the drive
};
/// From the model's start. \throws InputError as find_cycle().
Settled settle(const motion::StructureModel&, double tolerance);
/// Whether the motion of a slider settles as that of a structure of one coordinate.
bool settles_as_structure(const oscillators::Model&);
/// From the start, else from stick, or under a periodic drive from steady sliding.
Settled settle(const oscillators::Model&, double tolerance, const std::optional<motion::Start>& = {});

struct BranchOptions {
  ParameterScale parameter;
  double tolerance = 1e-8;      ///< relative; 1e-5 at most is used
  int most_points = 1000;       ///< of each branch
  double longest_step = 0.05;   ///< 1 is the range of the parameter, or the size of the cycle
  int doublings = 1;            ///< how many period doublings one after another are followed
  std::vector<double> at = {};  ///< values at which points are wanted
  bool cycles = true;           ///< whether those born at Hopf points are followed
};

/// Steady sliding at a value.
struct SteadyPoint {
  double value;
  bool stable;
  std::vector<std::complex<double>> eigenvalues;  ///< 1/s, largest real part first
  std::vector<double> slip_rates;                 ///< m/s
  std::string why;                                ///< there is no steady sliding; else empty
};

struct CycleBranch {
  std::string from;                     ///< "hopf", "period-doubling", "cycle"
  double from_value;                    ///< of the parameter
  int parent = -1;                      ///< the branch that doubles
  std::optional<double> to_value = {};  ///< of the Hopf point or the period doubling that it ends at
  Branch branch;
};

struct Branches {
  Outcome outcome;  ///< interrupted: what was found until then
  std::vector<SteadyPoint> steady;
  std::vector<steady::Crossing> crossings;  ///< of steady sliding: Hopf points, and divergence (frequency 0)
  std::vector<std::optional<SmallCycles>> small_cycles;  ///< of the normal form at each crossing; empty: not asked
  std::vector<CycleBranch> cycles;
  std::vector<std::string> notes;  ///< what could not be followed, and why
  long steps = 0, residuals = 0;
};

/// What the normal form has at the Hopf point that a branch is born at.
const SmallCycles* small_cycles_of(const Branches&, const CycleBranch&);

/// Steady sliding over the range and every branch that is born at its Hopf points.
/// \param crossings  where it loses or regains stability, if that is known better than from eigenvalues at the values
Branches from_steady_sliding(const Family&, const BranchOptions&,
                             const std::optional<std::vector<steady::Crossing>>& crossings = {});
/// The Hopf points of a slider in the range, as hopf_points() has them.
std::vector<steady::Crossing> crossings_of(const oscillators::Model&, std::string_view parameter,
                                           const ParameterScale& range);
/// \throws InputError where the period of the drive jumps along the parameter, as where the frequency of one of several
/// terms moves.
void require_continuous_period(const Family&, const ParameterScale&, double value);
/// The branch through a cycle, in both directions of the parameter.
Branches from_cycle(const Family&, const Settled&, double value, const BranchOptions&);

}  // namespace rosin::analysis::branches
