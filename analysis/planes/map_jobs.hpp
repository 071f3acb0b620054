/// Sharing the work for a plane out to threads.
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "analysis/planes/adaptive_map.hpp"
#include "core/workers.hpp"

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

/// A part of the plane, and the work that it is expected to take, in step attempts.
template <class Part>
struct Job {
  Part what;
  double expected = 1;
};

/// Computes all jobs, `together` at a time, in groups that take alike long. `compute(group, advanced)` returns what
/// `finish` takes over with what is done of all work; until then it may call `advanced(work)` for parts of it.
/// \throws Stopped where it ends early; what was finished until then has been handed over.
template <class Part, class Compute>
void work_in_groups(const std::vector<Job<Part>>& jobs, std::size_t together, int threads, double usual,
                    const std::function<void(FinishedPoints&, double done)>& finish, Compute compute) {
  struct Group {
    std::vector<const Job<Part>*> jobs;
    double expected = 0;
  };
  std::vector<Group> groups((jobs.size() + together - 1) / together);
  std::vector<const Job<Part>*> order;
  for (const auto& job : jobs) order.push_back(&job);
  std::ranges::stable_sort(order, std::greater(), &Job<Part>::expected);
  for (const auto* job : order) {
    auto& group = *std::ranges::min_element(
        groups, {}, [&](const Group& g) { return g.jobs.size() < together ? g.expected : infinity; });
    group.jobs.push_back(job);
    group.expected += job->expected;
  }
  std::vector<double> of_groups;
  for (const auto& group : groups) of_groups.push_back(group.expected);
  Ledger ledger(of_groups, usual);
  FinishedPoints none;
  finish(none, 0);
  in_parallel(threads, groups.size(), [&](std::size_t k) {
    const auto advanced = [&](double more) {
      FinishedPoints nothing;
      finish(nothing, ledger.advance(k, more));
    };
    FinishedPoints finished = compute(groups[k].jobs, advanced);
    finish(finished, ledger.finish(k));
  });
}

}  // namespace rosin::analysis::planes
