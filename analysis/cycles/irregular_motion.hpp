/// What is known of a motion that goes on without a period: until when the motion itself, and then its averages.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "analysis/cycles/exponent.hpp"
#include "analysis/cycles/stepped_cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "core/error.hpp"

namespace rosin::analysis::cycles {

struct IrregularMotion {
  Outcome outcome;
  std::string regime;  ///< "chaotic" or "quasi-periodic"; empty: neither is certain, and nothing below is known
  /// s, since the start: until then two passes, the second by finer steps, differ by less than a hundredth of the range
  /// of each coordinate. Infinite: they never did, or the motion is not chaotic.
  double known_until = infinity;
  double duration = 0;  ///< s, of the averages
  long returns = 0;     ///< in that: periods of the drive, or maxima of the coordinate that moves most
  /// With standard errors by blocks (blocked_error): of each column "…_mean" and "…_rms", about the mean; of parts of
  /// the time, such as "stick_fraction", the mean by their name; of what adds up, "…_rate".
  std::map<std::string, StructureCycle::Measure> averages;
  std::vector<double> coordinate_max, coordinate_min;  ///< that were seen, m
  std::vector<std::string> names, units;               ///< of the columns
  std::vector<double> time;                            ///< s, of the first returns
  std::vector<std::vector<double>> columns;            ///< [column][moment]
  std::vector<double> frequency;                       ///< Hz
  /// [column][frequency]: power spectral density on one side, unit²/Hz, by Hann windows of which each half is in the
  /// next (Welch 1967, IEEE Trans. Audio Electroacoust. 15, 70); empty of columns that are not always defined.
  std::vector<std::vector<double>> density;
  std::vector<std::string> density_units;
  double density_error = infinity;  ///< relative standard error of each value, where the spectrum is continuous
  long steps = 0;
};

/// Of a motion without a period: "chaotic" where neighbouring motions diverge by more than five errors of the largest
/// exponent; "quasi-periodic" where they neither diverge nor approach each other by a hundredth in a return; else
/// empty. \param mean_return  s
std::string regime_of(const Exponent&, double mean_return);

/// Follows the motion beyond a thousand returns from its start through ten thousand more.
/// \param exponent  the largest
/// \param tolerance  relative, of the motion; \param stick_threshold  ε of laws without stick
/// \throws InputError as find_cycle
IrregularMotion irregular_motion(const motion::StructureModel&, const Exponent& exponent, double tolerance,
                                 double stick_threshold);
/// The same by steps, from where the search ended.
IrregularMotion irregular_motion(const motion::SteppedOscillator&, const SteppedCycle& searched, double tolerance);

}  // namespace rosin::analysis::cycles
