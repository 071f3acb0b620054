/// Whether a cycle can coexist with stable steady sliding, decided without integration where that is possible.
#pragma once
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "analysis/stability.hpp"

namespace rosin::analysis {

/// What is known of cycles beside stable steady sliding.
struct Coexistence {
  enum class Answer {
    none,      ///< no cycle: the border in load is supercritical, or lies beyond the fold of cycles
    possible,  ///< must be looked for by integration
  } answer;
  std::string reason;
};

/// Answers for many points of one plane; remembers borders and folds of points that differ in normal load only.
/// Thread-safe; answers do not depend on the order of the questions.
class CoexistenceSearch {
 public:
  Coexistence ask(const Model& model);

 private:
  struct Border {
    double hopf_load = 0;  ///< 0: none above
    bool subcritical = false;
    double fold_load = 0;  ///< lowest load with a cycle, where subcritical; 0: not found
  };
  Border border(const Model& model);
  std::mutex mutex_;
  std::map<std::vector<double>, Border> known_;
};

/// The lowest normal load at which cycles exist beside stable sliding below a subcritical Hopf load: the fold of
/// cycles, to about 1e-6 relative. 0 if it cannot be followed. One slow direction of the return map is assumed.
double fold_of_cycles(const Model& model, double hopf_load);

}  // namespace rosin::analysis
