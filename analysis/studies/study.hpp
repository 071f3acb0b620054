/// Studies of the force algorithms: thousands of random oscillators, each followed by every algorithm and exactly.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/studies/weibull.hpp"
#include "core/error.hpp"
#include "solvers/force_algorithms/options.hpp"

namespace rosin::analysis::studies {

struct StudyOptions {
  int dimensions = 1;  ///< or 2
  int cases = 1000;
  std::uint64_t seed = 1;
  std::vector<std::string> algorithms = {"o-fbfm", "r-fbfm", "aabg-sdfm", "tr-sdfm"};
  double start_factor = 4;           ///< x₀ = factor·(P + (Nc + Nv) μs)/k
  double duration_factor = 1;        ///< T = factor·4/(ζ ω₀)
  int steps_per_period = 1000;       ///< of the shortest period
  int most_sticks = 5;               ///< a motion ends with as many sticks
  double window_share = 2.5e-4;      ///< o-fbfm's window in units of the average speed of slip
  double window_threshold = 0.3758;  ///< x₀ of the Weibull distribution of o-fbfm's errors, which lie below it
  int show = -1;                     ///< the case whose motions are kept; −1: the first in which all stick
  int threads = 1;
};

/// What one motion shows.
struct Motion {
  int sticks = 0;
  double first_stick = 0;    ///< s; 0 without one
  double stick_share = 0;    ///< of the time followed
  double friction_work = 0;  ///< J
  double wear_rate = 0;      ///< mean of N |v|, W
  // Of algorithms, within the first stick:
  double smallest_error = 0, last_error = 0;  ///< smallest and last slip rate there, over a thousandth of the average
  double drift = 0;                           ///< m moved
  int back_steps = 0;
  int false_starts = 0;  ///< sticks that ended within five steps
};

struct StudyCase {
  std::vector<double> inputs;  ///< in the order of StudyResult::input_names
  double average_speed = 0;    ///< m/s, the sum of the amplitudes at the start
  Motion exact;
  std::vector<Motion> motions;  ///< by algorithm
};

struct AlgorithmStatistics {
  std::string name;
  int sticking_cases = 0, alone = 0;  ///< with a stick; with one where no other algorithm has
  int missed = 0, invented = 0;       ///< exact motions that stick and it does not; and the reverse
  int more_sticks = 0;                ///< cases with more sticks than the exact motion
  int false_starts = 0;
  std::vector<int> back_steps;  ///< histogram; the last entry counts 9 and more
  // Over cases in which every algorithm sticks:
  Summary smallest_error, last_error, drift, first_stick_error, stick_share_error, friction_work_error;
  struct Fits {
    Weibull moments, plot;
    WeibullLikelihood likelihood;
  };
  std::optional<Fits> weibull;  ///< of the smallest error; without a value where there are too few samples
};

/// Motions of one case, for pictures: the whole thinned out, and every step around the first stick.
struct ShownMotion {
  std::string name;  ///< "exact", or the algorithm's
  struct Point {
    double time;
    std::vector<double> displacement, velocity;
    bool stick;
  };
  std::vector<Point> whole, entry;
};

struct StudyResult {
  std::vector<std::string> input_names, input_units;
  std::vector<StudyCase> cases;
  int exact_sticking_cases = 0, common = 0;  ///< exact motions that stick; cases in which every algorithm does
  Summary exact_stick_share, exact_friction_work, exact_wear_rate;
  std::vector<AlgorithmStatistics> algorithms;
  double exact_seconds = 0, algorithm_seconds = 0;  ///< of processor time
  int shown_case = -1;
  std::vector<ShownMotion> shown;
  Outcome outcome;
};

/// One dimension. m 1 … 5 kg, ω₀ 2π … 100π rad/s, ζ 0.01 … 0.05, ω_e/ω₀ and ω_n/ω₀ 0 … 5, P/k 0 … 10 mm, N_v/N_c 0 … 1,
/// μd 0.15 … 0.40, μs/μd 1 … 2, drawn in this order, U = low + (high − low)·⌊g/2¹¹⌋·2⁻⁵³ with g from mt19937_64(seed).
///
/// Two dimensions: m as above, ω₀ₓ, ω₀ᵧ 2π … 200π rad/s, ζₓ, ζᵧ 0.01 … 0.05, ωₑₓ, ωₑᵧ, ω_n 0 … 90π rad/s, mean forces
/// over stiffness 0 … 1 mm and amplitudes 0 … 1.5 mm (x, then y), N_v/N_c, μd, μs/μd as above; the exact motion is that
/// of located events.
/// `progress(done)` is called from time to time. Asked to stop (core/stop.hpp), it ends "interrupted". \throws
/// InputError for options without meaning.
StudyResult study(const StudyOptions&, const std::function<void(int)>& progress = {});

}  // namespace rosin::analysis::studies
