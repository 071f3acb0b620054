/// Sharing the work for a plane out to threads.
#pragma once
#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

#include "analysis/adaptive_map.hpp"

namespace rosin::analysis {

/// Calls f(k) for k < count from several threads.
template <class F>
void in_parallel(int threads, std::size_t count, const std::stop_token& stop, F f) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    while (!stop.stop_requested()) {
      const std::size_t k = next.fetch_add(1);
      if (k >= count) return;
      f(k);
    }
  };
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(work);
  work();
}

/// A part of the plane, and the work that it is expected to take, in any unit.
template <class Part>
struct Job {
  Part what;
  double work = 1;
};

/// Computes all jobs, `together` at a time, in groups that take alike long, so that the first foretell the time of the
/// others. `compute(group, advanced)` returns what `finish` takes over with the group's share of the work; until then
/// it may call `advanced(work)` for parts of it.
template <class Part, class Compute>
void work_in_groups(const std::vector<Job<Part>>& jobs, std::size_t together, int threads, const std::stop_token& stop,
                    const std::function<void(FinishedPoints&, double work)>& finish, Compute compute) {
  struct Group {
    std::vector<const Job<Part>*> jobs;
    double work = 0;
  };
  std::vector<Group> groups((jobs.size() + together - 1) / together);
  std::vector<const Job<Part>*> order;
  double all = 0;
  for (const auto& job : jobs) {
    order.push_back(&job);
    all += job.work;
  }
  std::ranges::stable_sort(order, std::greater(), &Job<Part>::work);
  for (const auto* job : order) {
    auto& group = *std::ranges::min_element(
        groups, {}, [&](const Group& g) { return g.jobs.size() < together ? g.work : infinity; });
    group.jobs.push_back(job);
    group.work += job->work;
  }
  FinishedPoints finished;
  finish(finished, 0);
  in_parallel(threads, groups.size(), stop, [&](std::size_t k) {
    double left = groups[k].work;
    const auto advanced = [&](double work) {
      FinishedPoints none;
      const double part = std::min(work, left);
      left -= part;
      finish(none, part / all);
    };
    FinishedPoints finished = compute(groups[k].jobs, advanced);
    if (!stop.stop_requested() || !finished.empty()) finish(finished, left / all);
  });
}

}  // namespace rosin::analysis
