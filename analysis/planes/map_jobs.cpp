/// How far the work for a plane has come.
#include "analysis/planes/map_jobs.hpp"

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

}  // namespace rosin::analysis::planes
