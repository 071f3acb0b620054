/// Basins of attraction: the motion that each of many starts comes to, and the disturbance of steady sliding from which
/// it does not come back.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/basins/recognition.hpp"
#include "analysis/cycles/stepped_cycle.hpp"

namespace rosin::analysis::basins {

/// Disturbances s of steady sliding along a direction.
struct Disturbance {
  Eigen::VectorXd coordinates, velocities;  ///< what s = 1 adds to them
  double from = 0, to = 1;                  ///< of s
  int points = 20;                          ///< values between which the first that does not return is looked for
};

struct BasinTask {
  std::vector<std::vector<double>> starts;  ///< unknowns of the structure
  /// Starts lie on a grid with so many in each row: only those at borders are followed, and the others take the label
  /// of their neighbours. 0: every start is followed.
  int refined_columns = 0;
  std::optional<Disturbance> disturbance;
  double tolerance = 1e-6;  ///< of cycles and of the threshold; steps are taken at a tenth of it
  int most_returns = 1000;  ///< within which a motion is recognised, or is irregular
  int threads = 1;
};

/// The smallest disturbance that does not return to steady sliding.
struct Threshold {
  double value, error;
  int beyond;  ///< number of the attractor that the motion comes to from there
};

struct Basins {
  Outcome outcome;
  /// Steady sliding, if it attracts, then all that any start came to.
  struct Basin {
    Attractor attractor;
    std::size_t count = 0;  ///< starts that come to it
    /// Of the starts of `shares_of`; the standard error of as many random starts. Of refined borders the sample's part
    /// of wrong labels is added.
    double share = 0, error = 0;
  };
  std::vector<Basin> basins;
  /// How many starts the shares stand for: all, or, of an interrupted search, those in no order that were done first;
  /// 0: there are no shares.
  std::size_t shares_of = 0;
  std::vector<int> labels;  ///< number of the basin of each start; −1: not done
  /// Of refined borders: which starts were followed; of the others a sample, followed in the end, and how many of it
  /// came to something else than their neighbours.
  std::vector<bool> followed;
  std::size_t sample = 0, sample_wrong = 0;
  std::optional<Threshold> threshold;
  std::string no_threshold;  ///< why there is none although one was asked for
};

/// Each start is followed until it is recognised. The result does not depend on the number of threads. Asked to stop,
/// it ends "interrupted" with the starts that are done.
/// \param progress  called with the number of starts done, from one thread at a time
/// \throws InputError where the drive has no period, and for disturbances of steady sliding that does not attract
Basins find_basins(const oscillators::Structure&, const BasinTask&,
                   const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// The same of an oscillator that is followed by steps, whose starts are its states: each is followed to its end.
/// Borders are not refined, and there is no threshold of a disturbance.
Basins find_basins(const motion::SteppedOscillator&, const BasinTask&,
                   const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// Numbers uniform between 0 and 1: two for each start, the same for the same seed on every machine.
std::vector<std::pair<double, double>> random_places(int count, std::uint64_t seed);

}  // namespace rosin::analysis::basins
