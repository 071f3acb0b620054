/// `rosin bench`: run time against true error, rosin and others on the same problem, in one run.
#pragma once
#include <string>
#include <vector>

namespace bench {

/// "cycle", "history", …
const std::vector<std::string>& names();

struct Settings {
  std::string what;                         ///< one of names()
  bool quick = false;                       ///< few tolerances and points: checks in seconds that everything works
  bool json = false;                        ///< the record on standard output instead of the tables
  bool quiet = false;                       ///< no progress
  std::string folder;                       ///< where record and pictures go
  double limit = 60;                        ///< s for all tolerances of one solver, repetitions not counted
  std::string python = "/usr/bin/python3";  ///< with SciPy, or it is left out
};

/// Runs one bench. \returns true if the solvers' references agree and no check found fault.
bool run(const Settings&);

}  // namespace bench
