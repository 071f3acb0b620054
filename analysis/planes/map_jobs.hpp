/// Groups of parts of a plane, and how far the work for them has come.
#pragma once
#include <mutex>
#include <utility>
#include <vector>

#include "analysis/planes/parts.hpp"

namespace rosin::analysis::planes {

/// What is done of the work of all groups. Groups that are finished teach how far the expectations of the others are
/// off. For several threads.
class Ledger {
 public:
  /// `expected`: of each group. `usual`: what work takes of what is expected, as far as is known beforehand.
  Ledger(const std::vector<double>& expected, double usual);
  /// A group has done this much more. \returns what is done of all, 0 … 1.
  double advance(std::size_t group, double more);
  double finish(std::size_t group);

 private:
  double done_of_all() const;
  struct Entry {
    double expected, done = 0;
    bool finished = false;
  };
  std::mutex mutex_;
  std::vector<Entry> entries_;
  double usual_;
};

/// Parts in groups of at most `together` that are expected to take alike long, the longest first, and what each group
/// is expected to take. Of several `hands`, as much as a group of each is handed out part by part at the end, where
/// none then waits long for the others.
std::pair<std::vector<Group>, std::vector<double>> groups_of(const std::vector<std::size_t>& parts,
                                                             const std::vector<double>& expected, std::size_t together,
                                                             std::size_t hands);

}  // namespace rosin::analysis::planes
