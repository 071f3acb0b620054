/// Whether a cycle can coexist with stable steady sliding, decided without integration where that is possible.
#pragma once
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "analysis/steady/stability.hpp"

namespace rosin::analysis::cycles {

using oscillators::Model;

/// What is known of cycles beside stable steady sliding.
struct Coexistence {
  enum class Answer {
    none,      ///< no cycle: the border in load is supercritical, or lies beyond the fold of cycles
    possible,  ///< must be looked for by integration
  } answer;
  std::string reason;
};

/// The fold of cycles below a subcritical Hopf load: the lowest load at which cycles exist beside stable sliding.
struct Fold {
  double log_ratio = 0;  ///< ln(N_fold/N_Hopf), negative; 0: could not be followed
  double error = 0;      ///< of it, absolute
  double size = 0;       ///< of the cycle there, in units of the system's scale
};
/// `near_size`: of the cycle at a fold nearby, if one is known. One slow direction of the return map is assumed.
Fold fold_below(const Model& model, double hopf_load, double near_size = 0);
/// The load of the fold, to about 1e-8 relative; 0 if it cannot be followed.
double fold_of_cycles(const Model& model, double hopf_load);

/// The lowest Hopf point in normal load, if there is one.
std::optional<steady::HopfPoint> border_in_load(const Model& model);

/// The fold of cycles as a function of one other parameter, wherever the border in load is subcritical.
struct FoldLine {
  /// One stretch of it: √(−ln(N_fold/N_Hopf)), which is smooth and vanishes where the border turns supercritical, as a
  /// Chebyshev series in the coordinate (logarithm of the parameter, or itself).
  struct Stretch {
    double begin, end;  ///< coordinates
    std::vector<double> coefficients;
    double error;  ///< largest of ln N_fold
    int folds;     ///< that were searched for
    double log_ratio(double coordinate) const;
  };
  std::vector<Stretch> stretches;
  std::vector<std::string> problems;  ///< stretches that could not be followed
  bool logarithmic = true;
  double coordinate(double value) const;
  const Stretch* at(double value) const;  ///< nullptr: none there
};
/// Traces it for values between `from` and `to`, looked for at `samples` places; `tolerance`: of ln N_fold.
FoldLine trace_folds(const Model& model, std::string_view parameter, double from, double to, bool logarithmic,
                     int samples, double tolerance);

/// Answers for many points of one plane; remembers borders and folds of points that differ in normal load only.
/// Thread-safe; answers do not depend on the order of the questions.
class CoexistenceSearch {
 public:
  /// For points that have no border in common: where motion dies out soon, a cycle is possible, because the border and
  /// the fold beside it cost more than to look for the cycle itself.
  CoexistenceSearch() = default;
  /// For points that differ in normal load and in `parameter`. Takes folds from a line that was traced, where it
  /// reaches, instead of searching for each.
  CoexistenceSearch(std::string parameter, FoldLine line) : parameter_(std::move(parameter)), line_(std::move(line)) {}
  /// Of a model whose steady sliding is stable.
  Coexistence ask(const Model& model);

 private:
  struct Border {
    double hopf_load = 0;  ///< 0: none above
    bool subcritical = false;
    double fold_load = 0;  ///< lowest load with a cycle, where subcritical; 0: not found
  };
  Border border(const Model& model);
  std::string parameter_;
  FoldLine line_;
  std::mutex mutex_;
  std::map<std::vector<double>, Border> known_;
};

}  // namespace rosin::analysis::cycles
