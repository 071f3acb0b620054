/// Modes matched by shape and eigenvalue over values that are added where they are needed.
#include "analysis/steady/mode_windows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include "core/stop.hpp"

namespace rosin::analysis::steady {

namespace {

/// How much of one motion is in another: the modal assurance criterion |φᴴMψ|²/(φᴴMφ ψᴴMψ), M by its diagonal
/// (Allemang 2003, Sound Vib. 37(8), 14), less what the eigenvalues differ by. 1: the same.
double likeness(const ComplexMode& a, const ComplexMode& b, const std::vector<double>& inertia) {
  const double size = std::max(std::abs(a.eigenvalue), std::abs(b.eigenvalue));
  const double apart = size > 0 ? std::abs(a.eigenvalue - b.eigenvalue) / size : 0;
  std::complex<double> shared = 0;
  double of_a = 0, of_b = 0;
  for (std::size_t i = 0; i < std::min(a.shape.size(), b.shape.size()); ++i) {
    const double weight = i < inertia.size() ? inertia[i] : 1;
    shared += weight * std::conj(a.shape[i]) * b.shape[i];
    of_a += weight * std::norm(a.shape[i]), of_b += weight * std::norm(b.shape[i]);
  }
  const double alike = of_a > 0 && of_b > 0 ? std::norm(shared) / (of_a * of_b) : double(of_a == of_b);
  return alike * std::max(0.0, 1 - apart);
}

constexpr double same_mode = 0.5;

std::vector<const ComplexMode*> growing(const StructureStability& sliding) {
  std::vector<const ComplexMode*> modes;
  for (const auto& mode : sliding.modes)
    if (mode.grows()) modes.push_back(&mode);
  return modes;
}

/// For each of the first modes its continuation among the others, −1: none. The most alike first.
std::vector<int> continued(const std::vector<const ComplexMode*>& from, const std::vector<const ComplexMode*>& to,
                           const std::vector<double>& inertia) {
  struct Pair {
    double alike;
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < from.size(); ++a)
    for (std::size_t b = 0; b < to.size(); ++b)
      if (const double alike = likeness(*from[a], *to[b], inertia); alike > same_mode) pairs.push_back({alike, a, b});
  std::ranges::stable_sort(pairs, std::greater(), &Pair::alike);
  std::vector<int> next(from.size(), -1);
  std::vector<char> taken(to.size(), 0);
  for (const auto& [alike, a, b] : pairs)
    if (next[a] < 0 && !taken[b]) next[a] = int(b), taken[b] = 1;
  return next;
}

/// Of the parabola through (−1, a), (0, m) and (1, b): where it is lowest, if it comes near 0 there from above.
std::optional<double> dip(double a, double m, double b) {
  const double slope = (b - a) / 2, bend = (a + b) / 2 - m;
  if (!(bend > 0)) return std::nullopt;
  const double lowest = -slope / (2 * bend);
  constexpr double near = 0.1;
  if (std::abs(lowest) >= 1 || m - slope * slope / (4 * bend) > near * std::min({a, m, b})) return std::nullopt;
  return lowest;
}

/// What steady sliding is at values of the parameter, each computed once.
class Sampled {
 public:
  explicit Sampled(const std::function<StructureStability(double)>& stability_at) : stability_at_(stability_at) {}

  /// Nothing where there is no steady sliding.
  const StructureStability* at(double value) {
    auto found = known_.find(value);
    if (found == known_.end()) {
      end_if_stopped();
      std::optional<StructureStability> there;
      try {
        there = stability_at_(value);
      } catch (const oscillators::NoSteadySliding& none) {
        reason_ = none.what();
      }
      found = known_.emplace(value, std::move(there)).first;
    }
    return found->second ? &*found->second : nullptr;
  }
  const std::string& reason() const { return reason_; }
  std::vector<double> values() const {
    std::vector<double> list;
    for (const auto& [value, there] : known_)
      if (there) list.push_back(value);
    return list;
  }

 private:
  const std::function<StructureStability(double)>& stability_at_;
  std::map<double, std::optional<StructureStability>> known_;
  std::string reason_;
};

/// Adds values until each mode's growth is plain between neighbours.
class Refinement {
 public:
  Refinement(Sampled& sampled, double range, int most) : sampled_(sampled), range_(range), left_(most) {}

  void between(double low, double high, int depth = 0) {
    constexpr int deepest = 14;
    constexpr double finest = 1e-7;
    if (depth > deepest || high - low < finest * range_) return;
    const auto *a = sampled_.at(low), *b = sampled_.at(high);
    const double middle = 0.5 * (low + high);
    if (!a || !b || left_-- <= 0) return;
    const auto* m = sampled_.at(middle);
    if (!m) return;
    constexpr double coarse = 1.0 / 32;  // of the range: longer steps may leave no trace of what is between
    std::optional<double> lowest;
    if (high - low < coarse * range_) {
      const int changes = this->changes(*a, *m) + this->changes(*m, *b);
      if (changes == 1) return;
      if (changes == 0 && !(lowest = dip_of(*a, *m, *b))) return;
    }
    double split = lowest ? middle + *lowest * 0.5 * (high - low) : middle;
    if (left_ <= 0 || !(std::abs(split - middle) > finest * range_)) split = middle;
    if (split != middle && !sampled_.at(split)) split = middle;
    left_ -= split != middle;
    between(low, std::min(split, middle), depth + 1);
    if (split != middle) between(std::min(split, middle), std::max(split, middle), depth + 1);
    between(std::max(split, middle), high, depth + 1);
  }

 private:
  /// Modes that begin to grow, or cease to.
  static int changes(const StructureStability& a, const StructureStability& b) {
    const auto before = growing(a), after = growing(b);
    const auto next = continued(before, after, a.inertia);
    const auto kept = std::ranges::count_if(next, [](int k) { return k >= 0; });
    return int(before.size() + after.size() - 2 * std::size_t(kept));
  }

  /// Where some growth rate, its square, or the square of the distance of two neutral frequencies may pass 0.
  static std::optional<double> dip_of(const StructureStability& a, const StructureStability& m,
                                      const StructureStability& b) {
    const auto all = [](const StructureStability& s) {
      std::vector<const ComplexMode*> modes;
      for (const auto& mode : s.modes) modes.push_back(&mode);
      return modes;
    };
    const auto of_m = all(m), of_a = all(a), of_b = all(b);
    const auto to_a = continued(of_m, of_a, m.inertia), to_b = continued(of_m, of_b, m.inertia);
    struct Three {
      const ComplexMode *a, *m, *b;
    };
    std::vector<Three> neutral;
    for (std::size_t k = 0; k < of_m.size(); ++k) {
      if (to_a[k] < 0 || to_b[k] < 0) continue;
      const Three three{of_a[std::size_t(to_a[k])], of_m[k], of_b[std::size_t(to_b[k])]};
      const double ga = three.a->growth_rate(), gm = three.m->growth_rate(), gb = three.b->growth_rate();
      if (three.a->is_neutral() && three.m->is_neutral() && three.b->is_neutral()) {
        neutral.push_back(three);
        continue;
      }
      // Growth that may fail in between, or decay that may turn into growth.
      const double sign = gm > 0 ? 1 : -1;
      if (ga * sign <= 0 || gb * sign <= 0) continue;
      if (const auto place = dip(ga * sign, gm * sign, gb * sign)) return place;
      if (const auto place = dip(ga * ga, gm * gm, gb * gb)) return place;
    }
    std::ranges::sort(neutral, {}, [](const Three& t) { return t.m->eigenvalue.imag(); });
    for (std::size_t k = 0; k + 1 < neutral.size(); ++k) {
      const auto apart = [](const ComplexMode* x, const ComplexMode* y) {
        return std::norm(x->eigenvalue - y->eigenvalue);
      };
      const auto &x = neutral[k], &y = neutral[k + 1];
      if (const auto place = dip(apart(x.a, y.a), apart(x.m, y.m), apart(x.b, y.b))) return place;
    }
    return std::nullopt;
  }

  Sampled& sampled_;
  double range_;
  int left_;
};

/// The growth of one mode at any value, told from others by its likeness to what it is at the nearest value at which it
/// grew.
class Followed {
 public:
  Followed(Sampled& sampled, std::map<double, ComplexMode> trail) : sampled_(sampled), trail_(std::move(trail)) {}

  Leading operator()(double value) {
    const auto* there = sampled_.at(value);
    if (!there) return {NAN, NAN, NAN};
    const auto& like = nearest(value);
    double most = 0;
    for (const auto& mode : there->modes) most = std::max(most, likeness(like, mode, there->inertia));
    // Of modes that have just merged both are alike.
    const ComplexMode* found = nullptr;
    for (const auto& mode : there->modes)
      if (likeness(like, mode, there->inertia) >= 0.5 * most && (!found || mode.growth_rate() > found->growth_rate()))
        found = &mode;
    if (found->grows()) trail_[value] = *found;
    return {found->growth_rate(), found->error, std::abs(found->eigenvalue.imag())};
  }

 private:
  const ComplexMode& nearest(double value) const {
    auto above = trail_.lower_bound(value);
    if (above == trail_.begin()) return above->second;
    const auto below = std::prev(above);
    return above == trail_.end() || value - below->first < above->first - value ? below->second : above->second;
  }

  Sampled& sampled_;
  std::map<double, ComplexMode> trail_;
};

/// Continues each branch of eigenvalues to the nearest of the next ones.
std::vector<std::complex<double>> in_order_of(const std::vector<std::complex<double>>& before,
                                              std::vector<std::complex<double>> now) {
  std::vector<std::complex<double>> ordered;
  for (const auto& z : before) {
    if (now.empty()) break;
    const auto nearest = std::ranges::min_element(now, {}, [&](auto w) { return std::abs(w - z); });
    ordered.push_back(*nearest);
    now.erase(nearest);
  }
  ordered.insert(ordered.end(), now.begin(), now.end());
  return ordered;
}

/// A mode that grows at values side by side.
struct Growing {
  std::map<double, ComplexMode> at;
  std::optional<double> calm_before, calm_after;  ///< neighbours at which it does not grow
};

std::vector<Growing> growing_over(Sampled& sampled, const std::vector<double>& values) {
  std::vector<Growing> all;
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& now = *sampled.at(values[i]);
    const auto modes = growing(now);
    std::vector<const ComplexMode*> last;
    for (const auto k : open) last.push_back(&all[k].at.rbegin()->second);
    const auto next = continued(last, modes, now.inertia);
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (next[k] < 0) {
        all[open[k]].calm_after = values[i];
        continue;
      }
      all[open[k]].at[values[i]] = *modes[std::size_t(next[k])];
      still.push_back(open[k]);
    }
    open = std::move(still);
    for (std::size_t k = 0; k < modes.size(); ++k) {
      if (std::ranges::find(next, int(k)) != next.end()) continue;
      open.push_back(all.size());
      auto& begun = all.emplace_back();
      begun.at[values[i]] = *modes[k];
      if (i > 0) begun.calm_before = values[i - 1];
    }
  }
  return all;
}

/// Nothing if the mode grows at the neighbour too, by parting from another or merging with it.
std::optional<Threshold> edge_of(Sampled& sampled, const Growing& mode, double calm, bool onset) {
  Followed followed(sampled, mode.at);
  if (followed(calm).grows()) return std::nullopt;
  // Up to where growth rises from the edge: the threshold is continued from there.
  std::optional<double> reach;
  double most = 0;
  const auto visit = [&](const auto& value_and_mode) {
    const auto& [value, there] = value_and_mode;
    if (there.growth_rate() < most) return false;
    reach = value, most = there.growth_rate();
    return true;
  };
  if (onset)
    std::ranges::find_if_not(mode.at, visit);
  else
    std::ranges::find_if_not(mode.at | std::views::reverse, visit);
  const auto found = locate([&](double value) { return followed(value); }, calm, *reach);
  const auto* there = sampled.at(found.value);
  // Next to a value without steady sliding.
  for (double aside = found.error; !there; aside *= 2) there = sampled.at(found.value - aside);
  return Threshold{found, *there};
}

/// Windows over the values, ascending.
std::vector<ModeWindow> windows_of(Sampled& sampled, const std::vector<double>& values) {
  std::vector<ModeWindow> windows;
  for (const auto& mode : growing_over(sampled, values)) {
    ModeWindow window;
    if (mode.calm_before) {
      window.onset = edge_of(sampled, mode, *mode.calm_before, true);
      if (!window.onset) continue;  // a part of another's window
    }
    if (mode.calm_after) window.end = edge_of(sampled, mode, *mode.calm_after, false);
    const auto fastest =
        std::ranges::max_element(mode.at, {}, [](const auto& there) { return there.second.growth_rate(); });
    window.at = fastest->first, window.fastest = fastest->second;
    windows.push_back(std::move(window));
  }
  return windows;
}

/// Edges of windows at which no other mode grows.
std::vector<Threshold> thresholds_of(const std::vector<ModeWindow>& windows) {
  std::vector<Threshold> thresholds;
  const auto covered = [&](std::size_t by, std::size_t window, double value) {
    const auto& w = windows[by];
    const double low = w.onset ? w.onset->value : -infinity, high = w.end ? w.end->value : infinity;
    // Of two that begin together the first counts.
    return by != window && (by < window ? low <= value && value <= high : low < value && value < high);
  };
  for (std::size_t i = 0; i < windows.size(); ++i)
    for (const auto* edge : {&windows[i].onset, &windows[i].end}) {
      if (!*edge) continue;
      bool alone = true;
      for (std::size_t j = 0; j < windows.size(); ++j) alone = alone && !covered(j, i, (*edge)->value);
      if (alone) thresholds.push_back(**edge);
    }
  std::ranges::sort(thresholds, {}, &Threshold::value);
  return thresholds;
}

}  // namespace

Scan scan(const std::function<StructureStability(double)>& stability_at, const std::vector<double>& values,
          int most_added) {
  Scan result;
  Sampled sampled(stability_at);
  for (const double value : values) {
    const auto* there = sampled.at(value);
    if (!there) {
      result.without.push_back(value);
      continue;
    }
    result.values.push_back(value);
    result.unstable_modes.push_back(there->unstable_modes());
    result.eigenvalues.push_back(
        result.eigenvalues.empty() ? there->eigenvalues : in_order_of(result.eigenvalues.back(), there->eigenvalues));
  }
  if (result.values.empty())
    throw InputError("no value of the scan has steady sliding" +
                     (sampled.reason().empty() ? "" : ": " + sampled.reason()));
  Refinement refinement(sampled, result.values.back() - result.values.front(), most_added);
  for (std::size_t i = 0; i + 1 < result.values.size(); ++i) refinement.between(result.values[i], result.values[i + 1]);
  result.windows = windows_of(sampled, sampled.values());
  result.thresholds = thresholds_of(result.windows);
  return result;
}

}  // namespace rosin::analysis::steady
