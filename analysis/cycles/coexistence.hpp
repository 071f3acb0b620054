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

/// Whether cycles coexist with stable steady sliding.
struct Coexistence {
  enum class Answer {
    none,      ///< no cycle: the border in load is supercritical, or lies beyond the fold of cycles
    possible,  ///< integration must decide
  } answer;
  std::string reason;
};

/// The fold of cycles below a subcritical Hopf load: the lowest load at which cycles exist next to stable sliding.
struct Fold {
  double log_ratio = 0;  ///< ln(N_fold/N_Hopf), negative; 0: could not be followed
  double error = 0;      ///< absolute error of log_ratio
  double size = 0;       ///< size of the cycle there, in units of the system's scale
};
/// `near_size`: size of the cycle at a neighbouring fold, if known. One slow direction of the return map is assumed.
Fold fold_below(const Model& model, double hopf_load, double near_size = 0);
/// The load of the fold, to about 1e-8 relative; 0 if it cannot be followed.
double fold_of_cycles(const Model& model, double hopf_load);

/// The lowest Hopf point in normal load, if there is one.
std::optional<steady::HopfPoint> border_in_load(const Model& model);

/// The fold of cycles as a function of one other parameter, wherever the border in load is subcritical.
struct FoldLine {
  /// One stretch of the line: √(−ln(N_fold/N_Hopf)), which is smooth and vanishes where the border becomes
  /// supercritical, as a Chebyshev series in the coordinate (the parameter or its logarithm).
  struct Stretch {
    double begin, end;  ///< coordinates
    std::vector<double> coefficients;
    double error;  ///< largest error of ln N_fold
    int folds;     ///< number of folds that were searched for
    double log_ratio(double coordinate) const;
  };
  std::vector<Stretch> stretches;
  std::vector<std::string> problems;  ///< stretches that could not be followed
  bool logarithmic = true;
  double coordinate(double value) const;
  const Stretch* at(double value) const;  ///< nullptr: none there
};
/// Traces the line between the values `from` and `to`, from `samples` places; `tolerance`: of ln N_fold.
FoldLine trace_folds(const Model& model, std::string_view parameter, double from, double to, bool logarithmic,
                     int samples, double tolerance);

/// Answers for many points of one plane; remembers borders and folds of points that differ in normal load only.
/// Thread-safe; answers do not depend on the order of the questions.
class CoexistenceSearch {
 public:
  /// For points that have no border in common. Where motion dies out fast the answer is `possible`, because the border
  /// and its fold cost more than a search for the cycle.
  CoexistenceSearch() = default;
  /// For points that differ in normal load and in `parameter`. Folds come from the traced line where it reaches, and
  /// from a search of their own elsewhere.
  CoexistenceSearch(std::string parameter, FoldLine line) : parameter_(std::move(parameter)), line_(std::move(line)) {}
  /// The answer for a model whose steady sliding is stable.
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
