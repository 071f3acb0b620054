/// Cutting planes, sharing the pieces out, and collecting what is found.
#include "analysis/planes/parts.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "analysis/planes/forecast.hpp"
#include "analysis/planes/map_jobs.hpp"
#include "core/workers.hpp"

namespace rosin::analysis::planes {

Partition::Partition(Pieces columns, Pieces rows, Together together)
    : columns_(std::move(columns)), rows_(std::move(rows)), together_(together) {
  width_ = std::size_t(columns_.back().second);
}

std::array<int, 2> Partition::size(std::size_t part) const {
  const auto [x0, x1] = columns_[part % columns_.size()];
  const auto [y0, y1] = rows_[part / columns_.size()];
  return {x1 - x0, y1 - y0};
}

std::vector<int> Partition::shares(int count) const {
  if (std::size_t(count) > this->count())
    throw InputError(
        fmt::format("a plane of {} parts has no {} shares; at most {}", this->count(), count, this->count()));
  // Of a lattice of parts (c, r) those whose c α + r β, less its whole part, falls into an interval lie scattered
  // evenly if 1, α, β are hardly related: powers of the inverse of the root of x³ = x + 1, the least Pisot number.
  constexpr double alpha = 0.7548776662466927, beta = 0.5698402909980532;
  std::vector<double> place(this->count());
  for (std::size_t part = 0; part < place.size(); ++part) {
    const double along = double(part % columns_.size()) * alpha + double(part / columns_.size()) * beta;
    place[part] = along - std::floor(along);
  }
  std::vector<std::size_t> order(place.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t part) { return place[part]; });
  std::vector<int> shares(place.size());
  for (std::size_t k = 0; k < order.size(); ++k) shares[order[k]] = int(k * std::size_t(count) / order.size());
  return shares;
}

namespace {

/// Even pieces of `from` values each at most, then each extra value by itself.
Partition::Pieces even_pieces(const Axis& axis, int edge) {
  Partition::Pieces pieces;
  const int n = axis.regular, parts = (n + edge - 1) / edge;
  for (int k = 0; k < parts; ++k) pieces.emplace_back(int(long(n) * k / parts), int(long(n) * (k + 1) / parts));
  for (int i = n; i < int(axis.values.size()); ++i) pieces.emplace_back(i, i + 1);
  return pieces;
}

std::size_t alone(std::size_t, std::size_t) { return 1; }

/// Points that lanes follow, of which few wait for the last in a group.
std::size_t lanes_full(std::size_t open, std::size_t threads) {
  constexpr std::size_t most = 8 * lane_count, groups_of_each = 4;
  return std::clamp<std::size_t>(open / (groups_of_each * threads), 1, most);
}

/// Four keep the lanes full, and take an eighth less time than one by one; but threads that have few groups each wait
/// for the last of them.
std::size_t tiles_together(std::size_t open, std::size_t threads) {
  constexpr std::size_t most = 4, groups_of_each = 4;
  return threads == 1 ? most : std::clamp<std::size_t>(open / (groups_of_each * threads), 1, most);
}

/// As few groups as keep the lanes full, and as many for one thread as for another.
std::size_t patches_together(std::size_t open, std::size_t threads) {
  constexpr std::size_t most = 16;
  const std::size_t groups = std::max<std::size_t>(threads * ((open + most * threads - 1) / (most * threads)), 1);
  return std::max<std::size_t>((open + groups - 1) / groups, 1);
}

}  // namespace

Partition::Pieces patches_along(const Axis& axis) {
  constexpr int fewest = 3;     // patches along one axis: together they keep the lanes full
  constexpr int longest = 160;  // intervals of a patch
  Partition::Pieces pieces;
  const int n = axis.regular - 1, parts = std::clamp(n, 1, std::max(fewest, (n + longest - 1) / longest));
  for (int k = 0; k < parts; ++k) pieces.emplace_back(n * k / parts, n * (k + 1) / parts + (k + 1 == parts));
  for (int i = axis.regular; i < int(axis.values.size()); ++i) pieces.emplace_back(i, i + 1);
  return pieces;
}

Partition partition_of(const MapOptions& options, bool structure, bool in_lanes) {
  if (structure) {
    // Points take long, so that each is a part; of large planes as many as keep the costs of parts a short list.
    constexpr std::size_t most = 1 << 16;
    const std::size_t points = options.x.values.size() * options.y.values.size();
    return {even_pieces(options.x, int((points + most - 1) / most)), even_pieces(options.y, 1),
            in_lanes ? lanes_full : alone};
  }
  constexpr int edge = 32;  // most points of a tile along one axis
  return interpolates(options) ? Partition(patches_along(options.x), patches_along(options.y), patches_together)
                               : Partition(even_pieces(options.x, edge), even_pieces(options.y, edge), tiles_together);
}

void Desk::points(FinishedPoints& found) {
  if (found.empty() && work_ == 0) return;
  Report report;
  report.group = group_.number;
  report.work = std::exchange(work_, 0);
  report.points.swap(found);
  queue_.take(std::move(report));
}

void Desk::work(std::size_t part, double attempts) {
  attempts_[part] += attempts;
  work_ += attempts;
}

void Desk::finish(const Partition& partition, double seconds) {
  double all = 0;
  const auto weigh = [&](std::size_t part) {
    const auto [columns, rows] = partition.size(part);
    return attempts_[part] + Forecast::judging * columns * rows;
  };
  for (const std::size_t part : group_.parts) all += weigh(part);
  Report report;
  report.group = group_.number;
  report.finished = true;
  for (const std::size_t part : group_.parts) report.costs.push_back({part, seconds * weigh(part) / all});
  queue_.take(std::move(report));
}

namespace {

/// Processor time of this thread, s.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Groups of the open parts, and the plane that what is found goes to.
class WholeQueue : public Queue {
 public:
  WholeQueue(Map& map, const MapHooks& hooks, std::vector<Group> groups, const std::vector<double>& expected,
             double usual)
      : map_(map), hooks_(hooks), groups_(std::move(groups)), ledger_(expected, usual) {
    done_ = std::size_t(std::ranges::count_if(map.points, &MapPoint::done));
    if (hooks_.progress) hooks_.progress({done_, map_.points.size(), 0});
  }

  Group next() override {
    const std::size_t k = next_.fetch_add(1);
    return k < groups_.size() ? groups_[k] : Group{};
  }

  void take(Report report) override {
    std::vector<std::size_t> fresh;
    const std::scoped_lock lock(mutex_);
    for (auto& [i, point] : report.points) {
      if (map_.points[i].done) continue;  // known from before
      map_.points[i] = std::move(point);
      fresh.push_back(i);
    }
    done_ += fresh.size();
    if (hooks_.finished && !fresh.empty()) hooks_.finished(fresh, map_.points);
    if (hooks_.costs && !report.costs.empty()) hooks_.costs(report.costs);
    if (report.work > 0) work_ = std::max(work_, ledger_.advance(report.group, report.work));
    if (report.finished) work_ = std::max(work_, ledger_.finish(report.group));
    if (hooks_.progress) hooks_.progress({done_, map_.points.size(), work_});
  }

 private:
  Map& map_;
  const MapHooks& hooks_;
  std::vector<Group> groups_;
  Ledger ledger_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::size_t done_ = 0;
  double work_ = 0;
};

/// Of the process that does not lead.
class NoQueue : public Queue {
 public:
  Group next() override { return {}; }
  void take(Report) override {}
};

}  // namespace

void compute_parts(const Partition& partition, const Expectation& expectation, const MapOptions& options,
                   const MapHooks& hooks, Map& map,
                   const std::function<void(const std::vector<std::size_t>&, Desk&)>& compute) {
  const auto compute_groups = [&](Queue& queue) {
    for (Group group; !(group = queue.next()).parts.empty();) {
      end_if_stopped();
      Desk desk(queue, group);
      const double begin = thread_seconds();
      compute(group.parts, desk);
      desk.finish(partition, thread_seconds() - begin);
    }
  };
  if (hooks.crew && !hooks.crew->leads()) {
    NoQueue none;
    return hooks.crew->work(none, options.threads, compute_groups);
  }
  for (std::size_t i = 0; hooks.known && i < map.points.size(); ++i)
    if (auto known = hooks.known(i)) map.points[i] = std::move(*known);
  std::vector<int> shares(partition.count(), 0);
  if (options.share.count > 1) shares = partition.shares(options.share.count);
  std::vector<std::size_t> open;
  for (std::size_t part = 0; part < partition.count(); ++part) {
    bool missing = false;
    partition.for_each(part, [&](std::size_t i, int, int) { missing |= !map.points[i].done; });
    if (missing && shares[part] == options.share.index) open.push_back(part);
  }
  std::vector<double> expected(open.size(), 1.0);
  if (expectation.attempts)
    in_parallel(options.threads, open.size(), [&](std::size_t k) { expected[k] = expectation.attempts(open[k]); });
  const std::size_t hands = std::size_t(options.threads) * std::size_t(hooks.crew ? hooks.crew->processes() : 1);
  auto [groups, of_groups] = groups_of(open, expected, partition.together(open.size(), hands), hands);
  WholeQueue queue(map, hooks, std::move(groups), of_groups, expectation.usual);
  if (hooks.crew) return hooks.crew->work(queue, options.threads, compute_groups);
  in_threads(options.threads, [&](int) { compute_groups(queue); });
}

}  // namespace rosin::analysis::planes
