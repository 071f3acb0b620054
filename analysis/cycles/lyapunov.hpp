/// Lyapunov exponents of a structure: the mean rates at which neighbouring motions part, or come together.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "analysis/cycles/structure_cycle.hpp"

namespace rosin::analysis::cycles {

struct LyapunovOptions {
  double duration = 0;           ///< s, of the average; 0: as long as `tolerance` needs
  double transient = -1;         ///< s, before it; < 0: a tenth of the duration, or 100 returns
  double tolerance = 0;          ///< 1/s, wanted standard error of the largest exponent; 0: the duration decides
  double accuracy = 1e-8;        ///< relative, of the motion
  double stick_threshold = 0.1;  ///< ε of the cycle's metrics
  long most_steps = 5'000'000;   ///< of the average
  std::function<void(double part)> progress;
};

struct LyapunovSpectrum {
  Outcome outcome;
  /// What the exponents were taken from: "cycle", the multipliers of the periodic motion that the start leads to;
  /// "steady", the eigenvalues of steady sliding that it settles on; "average", the growth of disturbances.
  std::string from;
  std::vector<Exponent> exponents;  ///< the largest first, without those of clocks
  int clocks = 0;                   ///< zeros that are left out: the phase of the drive
  /// Mean of the divergence of the flow between switches (1/s). The exponents add up to it, and to what saltation
  /// adds, where none is −∞ (Liouville).
  double divergence = 0;
  double sum = 0;                      ///< of the finite exponents, 1/s
  double transient = 0, duration = 0;  ///< s, as followed; of a cycle its period
  long switches = 0;                   ///< of contacts and stops in that
  std::vector<double> stick_fraction;  ///< of each contact that can stick
  bool levelled = true;                ///< the standard error has stopped growing with the length of blocks
  std::vector<double> time;            ///< s, since the start of the average, or of the period
  /// [exponent][moment], of those that are finite: the running average (1/s); of a cycle the logarithm of the growth
  /// since its start.
  std::vector<std::vector<double>> course;
  StructureCycle cycle;  ///< that was looked for first
  struct Cost {
    long steps = 0, evaluations = 0;
  } cost;
};

/// The periodic motion is looked for first, in as many returns as the average would last. Where the motion goes on,
/// orthonormal disturbances are carried along it, exact through stick and impacts, and orthonormalised after each step
/// (Benettin, Galgani, Giorgilli & Strelcyn 1980); errors by blocks of growing length (Flyvbjerg & Petersen 1989).
/// \throws InputError where the drive has no period, for more than 64 unknowns, and for a start that does not fit.
LyapunovSpectrum lyapunov_spectrum(const motion::StructureModel&, const LyapunovOptions&);

/// The largest exponent of a motion without a period, from its start on: a disturbance is carried along two parts of
/// the motion until the sign is certain, or through `most_returns` in each. Nothing where the motion changes its size,
/// as one that settles slowly does, or cannot be followed. \param mean_return  s, between crossings of the section
/// where nothing drives the structure periodically
std::optional<Exponent> largest_exponent(const motion::StructureModel&, double mean_return, long most_returns);

/// How a search of so many returns ended that found no period: in chaos, or without a verdict.
/// \param unknown  the outcome where there is no exponent
Outcome outcome_of(const std::optional<Exponent>&, long returns, Outcome unknown);

/// Standard error of the mean of a series whose values depend on their neighbours: blocks are doubled until the
/// estimate levels, at 16 blocks at least; where it still falls there, it is a bound.
struct BlockedError {
  double value;
  bool levelled;
};
BlockedError blocked_error(std::vector<double> series);

}  // namespace rosin::analysis::cycles
