/// Curves in two parameters: Hopf points of steady sliding, folds, period doublings, tori and grazing of cycles.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/branches/branch.hpp"

namespace rosin::analysis::branches {

/// The oscillator at values of the branch's parameter p and of a second one, q.
using Family2 = std::function<std::unique_ptr<Oscillator>(double p, double q)>;

struct LocusOptions {
  ParameterScale p, q;
  double tolerance = 1e-8;  ///< relative
  int points = 40;          ///< steps over the range of q
};

struct LocusPoint {
  double p, q;
  double p_error, q_error;                ///< absolute; the point lies on the curve within them
  std::map<std::string, double> metrics;  ///< "angular_frequency" (rad/s), or those of the cycle
};

/// A curve, from one end to the other.
struct Locus {
  std::string kind;  ///< "hopf", "fold", "period-doubling", "torus", "grazing"
  std::vector<LocusPoint> points;
  std::string begins, ends;  ///< why there; empty: at the end of a range
};

/// The Hopf points through a crossing at q, as far as both parameters stay in their ranges, round turning points.
Locus hopf_locus(const Family2&, const steady::Crossing&, double q, const LocusOptions&);

/// The special points of cycles of one kind that go on from one at q, as far as both parameters stay in their ranges,
/// round turning points: at each value of that parameter along which the curve runs, the branch over the other is cut
/// across near the last of them, and followed a little in both directions. A curve ends at a cusp.
Locus cycle_locus(const Family2&, const SpecialPoint&, double q, const LocusOptions&);

struct Loci {
  Outcome outcome;  ///< interrupted: the curves that were followed until then
  std::vector<Locus> curves;
};

/// Through every Hopf point of the branches, which were followed at q, and every special point of their cycles but
/// those of switching-sliding; one curve where several lie on it.
Loci find_loci(const Family2&, const Branches&, double q, const LocusOptions&);

}  // namespace rosin::analysis::branches
