/// Starts shared out to threads; attractors are found from fixed starts first, so that labels do not depend on threads.
#include "analysis/basins/basin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "analysis/basins/refined_borders.hpp"
#include "core/random.hpp"
#include "core/workers.hpp"

namespace rosin::analysis::basins {

namespace {

constexpr std::size_t at_a_time = 16;  ///< starts that are identified before what they came to is known to the others
constexpr std::size_t least_batch = 64;
constexpr std::size_t least_sample = 16;  ///< of an interrupted search: fewer starts show no shares

/// Starts in no order: the first of them stand for all.
void mix(std::vector<std::size_t>& starts) {
  std::ranges::sort(starts, {}, [](std::size_t i) { return splitmix(splitmix_step * (i + 1)); });
}

/// Starts that took the label of their neighbours, and are followed in the end.
std::vector<std::size_t> sample_of(std::vector<std::size_t> filled) {
  constexpr std::size_t fewest = 100, one_in = 100;
  mix(filled);
  filled.resize(std::min(filled.size(), std::max(fewest, filled.size() / one_in)));
  return filled;
}

class Search {
 public:
  Search(Recogniser& recogniser, const BasinTask& task, const std::function<void(std::size_t, std::size_t)>& progress)
      : recogniser_(recogniser), task_(task), progress_(progress) {}

  /// Labels of all starts, as far as they are done where the search is stopped.
  void label(const std::vector<std::vector<double>>& starts, std::vector<int>& labels) {
    labels.assign(starts.size(), Recogniser::unknown);
    std::vector<std::size_t> all(starts.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    label(starts, all, labels);
  }
  /// The same of some of the starts.
  void label(const std::vector<std::vector<double>>& starts, std::vector<std::size_t> open, std::vector<int>& labels) {
    Work work{starts, labels};
    mix(open);
    if (order_.empty()) order_ = open;
    // Batch after batch to its end, slow starts too: where the search is stopped, no more than the last one lacks some.
    for (std::size_t next = 0, size = 0; next < open.size(); next += size) {
      size = std::min(std::max(least_batch, next / 8), open.size() - next);
      finish(work, {open.begin() + long(next), open.begin() + long(next + size)});
    }
  }
  /// Of the starts that were labelled first, those before the first that is not done: in no order, and whatever time
  /// each takes, they stand for all.
  std::vector<std::size_t> fair_sample(const std::vector<int>& labels) const {
    return {order_.begin(), std::ranges::find(order_, Recogniser::unknown, [&](std::size_t i) { return labels[i]; })};
  }
  std::size_t done() const { return done_; }

  /// One start, at a tolerance of steps.
  int label(const std::vector<double>& start, double tolerance) {
    const int label = recogniser_.recognise(start, tolerance);
    return label != Recogniser::unknown ? label : recogniser_.add(recogniser_.identify(start));
  }

 private:
  struct Work {
    const std::vector<std::vector<double>>& starts;
    std::vector<int>& labels;
  };

  void finish(Work& work, std::vector<std::size_t> open) {
    const auto first = [&] {
      return std::vector<std::size_t>{open.begin(), open.begin() + long(std::min(at_a_time, open.size()))};
    };
    if (!std::exchange(begun_, true)) identify(work, first(), false);
    for (std::size_t known = 0; keep_unlabelled(work, open);) {
      if (recogniser_.known().size() > known) {
        known = recogniser_.known().size();
        recognise(work, open);
        continue;
      }
      identify(work, first(), true);
    }
  }

  static bool keep_unlabelled(const Work& work, std::vector<std::size_t>& open) {
    std::erase_if(open, [&](std::size_t i) { return work.labels[i] != Recogniser::unknown; });
    return !open.empty();
  }

  void set(Work& work, std::size_t i, int label) {
    const std::scoped_lock lock(mutex_);
    work.labels[i] = label;
    if (label == Recogniser::unknown) return;
    ++done_;
    if (progress_) progress_(done_, work.starts.size());
  }

  void recognise(Work& work, const std::vector<std::size_t>& open) {
    in_parallel(task_.threads, open.size(), [&](std::size_t k) {
      set(work, open[k], recogniser_.recognise(work.starts[open[k]], recogniser_.step_tolerance()));
    });
  }

  /// \param tried  they were not recognised among all that is known
  void identify(Work& work, std::vector<std::size_t> open, bool tried) {
    std::vector<Recogniser::Identified> found(open.size());
    in_parallel(task_.threads, open.size(), [&](std::size_t k) {
      const auto& start = work.starts[open[k]];
      found[k] = recogniser_.identify(start);
      if (found[k].cycle || tried) return;
      if (const int label = recogniser_.recognise(start, recogniser_.step_tolerance()); label != Recogniser::unknown)
        found[k] = {label, {}, ""};
    });
    for (std::size_t k = 0; k < open.size(); ++k) set(work, open[k], recogniser_.add(found[k]));
  }

  Recogniser& recogniser_;
  const BasinTask& task_;
  const std::function<void(std::size_t, std::size_t)> progress_;
  std::mutex mutex_;
  std::vector<std::size_t> order_;  ///< of the starts that were labelled first
  std::size_t done_ = 0;
  bool begun_ = false;  ///< some attractors are known
};

/// Halving the interval between a disturbance that returns and one that does not.
class ThresholdSearch {
 public:
  ThresholdSearch(const oscillators::Structure& structure, Search& search, const std::vector<double>& sliding,
                  const Disturbance& disturbance)
      : system_(structure), search_(search), disturbance_(disturbance) {
    coordinates_ = Eigen::Map<const Eigen::VectorXd>(sliding.data(), system_.coordinates());
  }

  std::vector<double> start(double s) const {
    return system_.unknowns_at(0, coordinates_ + s * disturbance_.coordinates, s * disturbance_.velocities);
  }
  double scanned(std::size_t k) const {
    const double part = double(k) / double(disturbance_.points - 1);
    return disturbance_.from + (disturbance_.to - disturbance_.from) * part;
  }
  std::vector<std::vector<double>> scan() const {
    std::vector<std::vector<double>> starts;
    for (int k = 0; k < disturbance_.points; ++k) starts.push_back(start(scanned(std::size_t(k))));
    return starts;
  }

  /// Between the k-th scanned value, the first that does not return, and the one before it.
  Threshold find(std::size_t k, int beyond, double tolerance) {
    beyond_ = beyond;
    double low = scanned(k - 1), high = scanned(k);
    const double width = tolerance * std::abs(high);
    bisect(low, high, width, 0.1 * tolerance);
    const double coarse = 0.5 * (low + high);
    // Again at finer steps, from the interval opened until it holds the border of those.
    constexpr double finer = 1.0 / 30, wider = 8;
    const double fine = 0.1 * finer * tolerance;
    for (double reach = width; !returns(low, fine); reach *= wider) low = std::max(low - reach, scanned(k - 1));
    for (double reach = width; returns(high, fine); reach *= wider) high = std::min(high + reach, scanned(k));
    bisect(low, high, width, fine);
    const double value = 0.5 * (low + high);
    return {value, 0.5 * (high - low) + std::abs(value - coarse), beyond_};
  }

 private:
  bool returns(double s, double tolerance) {
    const int label = search_.label(start(s), tolerance);
    if (label != Recogniser::steady) beyond_ = label;
    return label == Recogniser::steady;
  }
  void bisect(double& low, double& high, double width, double tolerance) {
    while (std::abs(high - low) > width) {
      end_if_stopped();
      const double middle = 0.5 * (low + high);
      (returns(middle, tolerance) ? low : high) = middle;
    }
  }

  oscillators::StructureSystem system_;
  Search& search_;
  const Disturbance& disturbance_;
  Eigen::VectorXd coordinates_;
  int beyond_ = 0;
};

void find_threshold(const oscillators::Structure& structure, const BasinTask& task, const Recogniser& recogniser,
                    Search& search, Basins& result) {
  ThresholdSearch bisection(structure, search, recogniser.steady_sliding(), *task.disturbance);
  std::vector<int> labels;
  search.label(bisection.scan(), labels);
  const auto first =
      std::size_t(std::ranges::find_if(labels, [](int label) { return label != Recogniser::steady; }) - labels.begin());
  if (first == labels.size()) {
    result.no_threshold = fmt::format("every disturbance from {:g} to {:g} returns to steady sliding",
                                      task.disturbance->from, task.disturbance->to);
  } else if (first == 0) {
    result.no_threshold =
        fmt::format("the first disturbance, {:g}, does not return: give a smaller 'from'", task.disturbance->from);
  } else {
    result.threshold = bisection.find(first, labels[first], task.tolerance);
  }
}

/// A grid, of which only the borders are followed, and a sample of the rest.
void label_borders(const BasinTask& task, Search& search, Basins& result) {
  const auto columns = task.refined_columns;
  RefinedBorders borders(columns, int(task.starts.size()) / columns);
  const auto follow = [&](const std::vector<std::size_t>& starts, std::vector<int>& labels) {
    search.label(task.starts, starts, labels);
  };
  try {
    borders.find(follow, result.labels);
    const auto sample = sample_of(borders.filled());
    result.sample = sample.size();
    result.sample_wrong = borders.check(sample, follow, result.labels);
    result.followed = borders.followed();
  } catch (const Stopped&) {
    result.followed = borders.followed();
    throw;
  }
}

/// The known attractors that are of interest, in the order: steady sliding, rest, cycles by their share, and the rest.
/// \param sample  starts whose shares stand for all
void arrange(const std::vector<Attractor>& known, const std::vector<std::size_t>& sample, Basins& result) {
  std::vector<std::size_t> count(known.size()), sampled(known.size());
  for (const int label : result.labels)
    if (label >= 0) ++count[std::size_t(label)];
  for (const std::size_t i : sample) ++sampled[std::size_t(result.labels[i])];
  const auto all = result.shares_of = sample.size();
  std::vector<int> order;
  const auto beyond = result.threshold ? result.threshold->beyond : -1;
  for (int k = 0; k < int(known.size()); ++k)
    if (count[std::size_t(k)] > 0 || k == beyond || (k == Recogniser::steady && !known[std::size_t(k)].points.empty()))
      order.push_back(k);
  std::ranges::stable_sort(order, [&](int a, int b) {
    const auto &one = known[std::size_t(a)], &other = known[std::size_t(b)];
    return one.kind != other.kind ? one.kind < other.kind : count[std::size_t(a)] > count[std::size_t(b)];
  });
  std::vector<int> place(known.size(), -1);
  for (const int k : order) {
    place[std::size_t(k)] = int(result.basins.size());
    auto& basin = result.basins.emplace_back();
    basin.attractor = known[std::size_t(k)], basin.count = count[std::size_t(k)];
    if (all == 0) continue;
    const auto of = sampled[std::size_t(k)];
    basin.share = double(of) / double(all);
    // Laplace's rule: none, or all, of a few starts leave a doubt too.
    const double likely = double(of + 1) / double(all + 2);
    basin.error = std::sqrt(likely * (1 - likely) / double(all));
    if (result.followed.empty() || all < result.labels.size()) continue;
    const auto filled = std::size_t(std::ranges::count(result.followed, false));
    const double wrong = filled == 0 ? 0 : double(result.sample_wrong + 1) / double(result.sample + 2);
    basin.error = std::hypot(basin.error, wrong * double(filled) / double(all));
  }
  for (int& label : result.labels)
    if (label >= 0) label = place[std::size_t(label)];
  if (result.threshold) result.threshold->beyond = place[std::size_t(result.threshold->beyond)];
}

/// Attractors of an oscillator that is followed by steps: each start is followed to the end of its motion.
class SteppedRecogniser {
 public:
  SteppedRecogniser(const motion::SteppedOscillator& oscillator, const BasinTask& task) : oscillator_(oscillator) {
    options_.tolerance = task.tolerance, options_.max_cycles = task.most_returns;
    for (const auto kind :
         {Attractor::Kind::steady, Attractor::Kind::rest, Attractor::Kind::escape, Attractor::Kind::irregular})
      known_.emplace_back().kind = kind;
  }
  cycles::SteppedCycle follow(std::vector<double> start, bool errors = false) const {
    auto from = oscillator_;
    from.start = std::move(start);
    return cycles::find_cycle(from, options_, errors);
  }
  /// The label, of a cycle that is not yet known a new one.
  int add(const cycles::SteppedCycle& cycle) {
    using cycles::Settled;
    constexpr double sticks_always = 1 - 1e-9;  // but for rounding
    if (cycle.settled == Settled::escape) return Recogniser::escape;
    if (cycle.settled == Settled::rest ||
        (cycle.returns > 0 && cycle.metrics.at("stick_fraction").value > sticks_always))
      return Recogniser::rest;
    if (cycle.settled == Settled::sliding) {
      known_[Recogniser::steady].points = {cycle.start};
      return Recogniser::steady;
    }
    if (cycle.returns == 0 || !cycle.stable) {
      auto& detail = known_[Recogniser::irregular].detail;
      if (detail.empty()) detail = cycle.outcome.detail;
      return Recogniser::irregular;
    }
    for (int k = Recogniser::first_cycle; k < int(known_.size()); ++k)
      if (is_same(known_[std::size_t(k)], cycle)) return k;
    auto& attractor = known_.emplace_back();
    attractor.kind = Attractor::Kind::cycle;
    attractor.metrics = follow(cycle.start, true).metrics;
    if (attractor.metrics.empty()) attractor.metrics = cycle.metrics;
    for (std::size_t c = 0; c < cycle.columns.size(); ++c) attractor.orbit[cycle.column_names[c]] = cycle.columns[c];
    attractor.points = {cycle.start};
    return int(known_.size()) - 1;
  }
  const std::vector<Attractor>& known() const { return known_; }

 private:
  /// By its period and the extremes of its coordinates, as far as they are known.
  bool is_same(const Attractor& known, const cycles::SteppedCycle& cycle) const {
    constexpr double same = 1e-4, times = 3;
    const auto differs = [&](const std::string& name, double size) {
      const auto &one = known.metrics.at(name), &other = cycle.metrics.at(name);
      return std::abs(one.value - other.value) > same * size + times * (one.error + other.error);
    };
    double widest = 0;
    for (std::size_t i = 0; i < cycle.coordinate_max.size(); ++i)
      widest = std::max(widest, cycle.coordinate_max[i] - cycle.coordinate_min[i]);
    bool differ = differs("period", cycle.metrics.at("period").value);
    for (int i = 0; i < oscillator_.coordinates; ++i)
      for (const char* end : {"_max", "_min"})
        differ = differ || differs(oscillator_.channels[std::size_t(i)].name + end, widest);
    return !differ;
  }

  const motion::SteppedOscillator& oscillator_;
  cycles::StructureCycleOptions options_;
  std::vector<Attractor> known_;
};

void check(const BasinTask& task) {
  require(task.tolerance, {1e-10, 1e-3}, "tolerance", "relative accuracy of cycles and of the threshold", "1");
  require(task.threads, {1, 4096}, "threads", "number of threads", "1");
}

}  // namespace

Basins find_basins(const motion::SteppedOscillator& oscillator, const BasinTask& task,
                   const std::function<void(std::size_t, std::size_t)>& progress) {
  check(task);
  const std::size_t total = task.starts.size();
  SteppedRecogniser recogniser(oscillator, task);
  Basins result;
  std::vector<std::optional<cycles::SteppedCycle>> ends(total);
  std::mutex mutex;
  std::size_t done = 0;
  try {
    in_parallel(task.threads, total, [&](std::size_t i) {
      ends[i] = recogniser.follow(task.starts[i]);
      const std::scoped_lock lock(mutex);
      if (progress) progress(++done, total);
    });
  } catch (const Stopped&) {
    result.outcome = {Ending::interrupted,
                      fmt::format("{} of {} starts are done; no shares, for those that are done "
                                  "are the first ones",
                                  std::ranges::count_if(ends, [](const auto& e) { return e.has_value(); }), total)};
  }
  std::vector<std::size_t> sample;
  for (std::size_t i = 0; i < total; ++i) {
    result.labels.push_back(ends[i] ? recogniser.add(*ends[i]) : int(Recogniser::unknown));
    if (result.outcome.complete()) sample.push_back(i);
  }
  arrange(recogniser.known(), sample, result);
  return result;
}

Basins find_basins(const oscillators::Structure& structure, const BasinTask& task,
                   const std::function<void(std::size_t, std::size_t)>& progress) {
  check(task);
  Recogniser recogniser(structure, task.tolerance, task.most_returns);
  Basins result;
  if (task.disturbance) (void)recogniser.steady_sliding();
  Search search(recogniser, task, progress);
  std::vector<std::size_t> sample;  // of starts whose shares stand for all
  const auto interrupted = [&](const std::string& shares) {
    result.outcome = {Ending::interrupted,
                      fmt::format("{} of {} starts are done{}", search.done(), task.starts.size(), shares)};
  };
  try {
    if (task.refined_columns > 0)
      label_borders(task, search, result);
    else
      search.label(task.starts, result.labels);
    sample.resize(task.starts.size());
    std::iota(sample.begin(), sample.end(), std::size_t{0});
  } catch (const Stopped&) {
    sample = search.fair_sample(result.labels);
    if (sample.size() < least_sample) sample.clear();
    interrupted(sample.empty() ? "; no shares, for those that are done are the quick ones"
                               : fmt::format("; shares are those of {} of them, in no order", sample.size()));
  }
  try {
    if (task.disturbance && result.outcome.complete()) {
      Search quiet(recogniser, task, {});
      find_threshold(structure, task, recogniser, quiet, result);
    }
  } catch (const Stopped&) {
    interrupted("; the threshold is not found");
  }
  arrange(recogniser.known(), sample, result);
  return result;
}

std::vector<std::pair<double, double>> random_places(int count, std::uint64_t seed) {
  std::vector<std::pair<double, double>> places;
  std::uint64_t counter = splitmix(seed);
  const auto next = [&] { return open_unit(splitmix(counter += splitmix_step)); };
  for (int i = 0; i < count; ++i) {
    const double x = next();
    places.emplace_back(x, next());
  }
  return places;
}

}  // namespace rosin::analysis::basins
