/// Groups that take alike long, and how far the work for a plane has come.
#include "analysis/planes/map_jobs.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <queue>

namespace rosin::analysis::planes {

Ledger::Ledger(const std::vector<double>& expected, double usual) : usual_(usual) {
  for (const double work : expected) entries_.push_back({work});
}

double Ledger::advance(std::size_t group, double more) {
  const std::scoped_lock lock(mutex_);
  entries_[group].done += more;
  return done_of_all();
}

double Ledger::finish(std::size_t group) {
  const std::scoped_lock lock(mutex_);
  entries_[group].finished = true;
  return done_of_all();
}

double Ledger::done_of_all() const {
  double expected = 0, experience = 0, taken = 0, done = 0, left = 0;
  for (const auto& entry : entries_) {
    expected += entry.expected;
    done += entry.done;
    if (!entry.finished) continue;
    experience += entry.expected;
    taken += entry.done;
  }
  const double trust = 0.5 * expected;  // in what is usual: groups differ
  const double ratio = (trust * usual_ + taken) / (trust + experience);
  bool finished = true;
  for (const auto& entry : entries_) {
    if (entry.finished) continue;
    finished = false;
    constexpr double at_least = 0.02;  // of a group is left until it is finished
    left += std::max(ratio * entry.expected - entry.done, at_least * entry.done);
  }
  return finished ? 1 : done / (done + left);
}

std::pair<std::vector<Group>, std::vector<double>> groups_of(const std::vector<std::size_t>& parts,
                                                             const std::vector<double>& expected, std::size_t together,
                                                             std::size_t hands) {
  std::vector<std::vector<std::size_t>> members((parts.size() + together - 1) / together);  // by place in `parts`
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t k) { return expected[k]; });
  // Groups by what they are expected to take, the least first, as long as they have room.
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> room;
  for (std::size_t g = 0; g < members.size(); ++g) room.emplace(0.0, g);
  for (const std::size_t k : order) {
    const auto [taken, g] = room.top();
    room.pop();
    members[g].push_back(k);
    if (members[g].size() < together) room.emplace(taken + expected[k], g);
  }
  const std::size_t split = hands > 1 ? std::min(hands, members.size()) : 0;
  const std::vector last(members.end() - std::ptrdiff_t(split), members.end());
  members.resize(members.size() - split);
  for (const auto& group : last)
    for (const std::size_t k : group) members.push_back({k});
  std::vector<Group> groups(members.size());
  std::vector<double> of_groups(members.size(), 0.0);
  for (std::size_t g = 0; g < members.size(); ++g) {
    groups[g].number = g;
    for (const std::size_t k : members[g]) groups[g].parts.push_back(parts[k]), of_groups[g] += expected[k];
  }
  return {std::move(groups), std::move(of_groups)};
}

}  // namespace rosin::analysis::planes
