/// Curves in two parameters: Hopf points of steady sliding, folds, period doublings, tori and grazing of cycles, and
/// the points on them at which the kind of onset changes.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/branches/branch.hpp"
#include "analysis/steady/stability.hpp"

namespace rosin::analysis::branches {

/// The oscillator at values of the branch's parameter p and of a second one, q.
using Family2 = std::function<std::unique_ptr<Oscillator>(double p, double q)>;

struct LocusOptions {
  ParameterScale p, q;
  double tolerance = 1e-8;  ///< relative
  int points = 40;          ///< steps over the range of q
  /// Of a Hopf point at (p, q) with that frequency (rad/s). Empty: Bautin points are not looked for.
  std::function<std::optional<steady::NormalFormCoefficient>(double p, double q, double angular_frequency)>
      normal_form = {};
};

struct LocusPoint {
  double p, q;
  double p_error, q_error;  ///< absolute; the point lies on the curve within them
  /// "angular_frequency" (rad/s) and, if it is known, "first_lyapunov_coefficient", or those of the cycle
  std::map<std::string, double> metrics;
};

/// A point on a curve at which a second condition holds.
struct LocusEvent {
  /// "bautin": the first Lyapunov coefficient is 0. "zero-hopf": beside the pair a real eigenvalue is 0.
  /// "bogdanov-takens": the frequency is 0, and the curve ends. "resonance-1:1", …, "resonance-1:4": the pair of
  /// multipliers of a torus has a 1st, …, 4th power 1. "cusp": on a curve of folds the branch has no curvature; two
  /// folds meet there, and the curve goes on as that of the other.
  std::string kind;
  LocusPoint at;
};

/// A curve, from one end to the other.
struct Locus {
  std::string kind;  ///< "hopf", "fold", "period-doubling", "torus", "grazing"
  std::vector<LocusPoint> points;
  std::string begins, ends;             ///< why there; empty: at the end of a range
  std::vector<LocusEvent> events = {};  ///< in the order of the curve
};

/// The Hopf points through a crossing at q, as far as both parameters stay in their ranges, round turning points.
Locus hopf_locus(const Family2&, const steady::Crossing&, double q, const LocusOptions&);

/// The special points of cycles of one kind that go on from one at q, as far as both parameters stay in their ranges,
/// round turning points: at each value of that parameter along which the curve runs, the branch over the other is cut
/// across near the last of them, and followed a little in both directions.
/// Through a cusp, where two folds meet, it is followed by its length.
Locus cycle_locus(const Family2&, const SpecialPoint&, double q, const LocusOptions&);

struct Loci {
  Outcome outcome;  ///< interrupted: the curves that were followed until then
  std::vector<Locus> curves;
};

/// Through every Hopf point of the branches, which were followed at q, and every special point of their cycles but
/// those of switching-sliding; one curve where several lie on it.
Loci find_loci(const Family2&, const Branches&, double q, const LocusOptions&);

}  // namespace rosin::analysis::branches
