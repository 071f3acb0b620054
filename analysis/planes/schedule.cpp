/// List scheduling (R. L. Graham, Bell Syst. Tech. J. 45, 1563, 1966: at most twice as long as the best schedule).
#include "analysis/planes/schedule.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

#include "analysis/planes/map_jobs.hpp"

namespace rosin::analysis::planes {

Schedule schedule(std::span<const double> groups, std::size_t processes, double answer, double wait) {
  std::priority_queue<double, std::vector<double>, std::greater<>> free;  // when each process is
  for (std::size_t p = 0; p < std::min(processes, groups.size()); ++p) free.push(0);
  double work = 0, last = 0, answered = 0;
  for (const double seconds : groups) {
    const double asked = free.top();
    free.pop();
    answered = std::max(answered, asked) + answer;
    const double end = answered + wait + seconds;
    free.push(end);
    work += seconds;
    last = std::max(last, end);
  }
  return {last, last > 0 ? work / (double(processes) * last) : 1};
}

Schedule schedule(const Partition& partition, std::span<const double> seconds, std::size_t processes) {
  constexpr double answer = 20e-6;  // s, in which rank 0 takes a report over and hands a group out
  constexpr double wait = 2e-3;     // s, in which both look at their letters
  std::vector<std::size_t> parts(partition.count());
  std::iota(parts.begin(), parts.end(), std::size_t{0});
  const std::vector<double> alike(parts.size(), 1.0);
  std::vector<double> groups;
  for (const auto& group : groups_of(parts, alike, partition.together(parts.size(), processes), processes).first) {
    double all = 0;
    for (const std::size_t part : group.parts) all += seconds[part];
    groups.push_back(all);
  }
  return schedule(groups, processes, answer, wait);
}

std::vector<double> filled_up(const std::map<std::size_t, double>& known, std::size_t parts) {
  std::vector<double> seconds(parts);
  auto next = known.begin();
  for (std::size_t part = 0; part < parts; ++part) {
    if (const auto here = known.find(part); here != known.end()) {
      seconds[part] = here->second;
      continue;
    }
    seconds[part] = next->second;
    if (++next == known.end()) next = known.begin();
  }
  return seconds;
}

}  // namespace rosin::analysis::planes
