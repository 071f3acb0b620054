/// The stress suite: random scenes over ten decades, each certified by a second method, refused, or a typed failure.
///
/// A scene depends on (seed, index) alone, so that any one can be drawn and judged again.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "oscillators/model.hpp"

namespace rosin::analysis::studies {

using oscillators::Model;

/// What is asked of a scene.
enum class Question { stability, cycle, run };
std::string name(Question);

/// One random scene as plain settings, which may be such that no model takes them.
struct StressScene {
  std::uint64_t seed = 1;
  long index = 0;
  std::shared_ptr<const FrictionLaw> law;  ///< with any values: `settings` hold those of the scene
  /// Path ("law.a", "drive.speed", …) and value, in the order in which they are set.
  std::vector<std::pair<std::string, Value>> settings;
  Question question = Question::cycle;
  motion::RunOptions run;  ///< of a run
};

/// The laws that scenes are drawn from.
using Laws = std::vector<std::shared_ptr<const FrictionLaw>>;

/// Scene `index` of a seed: one of the laws, a slider, a drive, and a question.
StressScene draw_scene(const Laws&, std::uint64_t seed, long index);

/// The scene's model. \throws InputError where a setting is out of range or parts do not fit together.
Model model_of(const StressScene&);

enum class Verdict {
  certified,    ///< two methods or tolerances agree within the errors they state
  less_exact,   ///< the same, with errors above the tolerance asked for, which is said, but of use
  none_exists,  ///< both say that what was asked for does not exist
  refused,      ///< an InputError says why
  failed,       ///< a typed failure: short of the tolerance or the budget, and said
  wrong,        ///< numbers differ by more than ten times the stated errors
  not_finite,   ///< a result that was called complete holds NaN or infinity
  crashed,      ///< an exception that is not an InputError
};
std::string name(Verdict);

struct Judgement {
  Verdict verdict = Verdict::failed;
  std::string reason;      ///< why, with numbers
  double error_ratio = 0;  ///< largest difference over stated error among the numbers compared; 0: nothing compared
  double seconds = 0;      ///< wall clock
};

/// Asks the scene's question twice and compares; never throws.
Judgement judge(const StressScene&);

struct StressOptions {
  Laws laws;
  std::uint64_t seed = 1;
  long first = 0, scenes = 1000;
  int threads = 1;
  double longest = 300;  ///< s of wall clock, after which a scene counts as hung
};
struct StressObservers {
  std::function<void(const StressScene&, const Judgement&)> finished;  ///< called by one thread at a time
  std::function<void(const StressScene&)> hung;  ///< a scene that outlives `longest`; must not return to it
};

/// How often something was said, and the first scene that said it.
struct Tally {
  long count = 0, example = -1;
};
struct StressReport {
  long scenes = 0, certified = 0, none_exists = 0, wrong = 0, not_finite = 0, crashed = 0;
  std::map<std::string, Tally> less_exact, refused, failures, alarms;  ///< by reason without its numbers
  std::map<std::string, Tally> questions;
  long compared = 0, covered = 0;                ///< scenes with numbers compared, and those within the stated errors
  double worst_error_ratio = 0;                  ///< among the certified
  double seconds = 0;                            ///< summed over scenes
  std::vector<std::pair<double, long>> slowest;  ///< seconds, index; slowest first
  bool complete = true;                          ///< false where it was stopped

  static long sum(const std::map<std::string, Tally>&);
  long failed() const { return sum(failures); }
  long refusals() const { return sum(refused); }
  /// Failures among the scenes that were not refused.
  double failure_share() const;
  double coverage() const { return compared > 0 ? double(covered) / double(compared) : 1; }
  /// Nothing wrong, not finite or crashed, and fewer than one failure in a hundred.
  bool passed() const;
};

/// Judges scenes first … first + scenes − 1. The report does not depend on the number of threads.
StressReport stress(const StressOptions&, const StressObservers& = {});

}  // namespace rosin::analysis::studies
