/// Planes of metrics compared in units of their noise.
#include "analysis/inference/discrimination.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rosin::analysis::inference {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Reading {
  double value = nothing, error = 0;
};

/// Metrics at the points of a member's plane, of the motion that it settles on from its start.
class Readings {
 public:
  Readings(const Varied& member, const planes::Map& map) : member_(member), map_(map) {}
  Reading operator()(std::size_t i, std::size_t metric) {
    const auto& point = map_.points[i];
    const auto& asked = map_.metrics[metric];
    if (point.regime == planes::Regime::failed) return {};
    // What a structure's metrics say of steady sliding itself is known of stable points too.
    if (point.regime != planes::Regime::stable || (!asked.member && std::isfinite(asked.value(point))))
      return {asked.value(point), asked.error(point)};
    if (i != at_) at_ = i, sliding_ = at(i).in_steady_sliding();
    const auto found = sliding_.find(asked.name);
    return found == sliding_.end() ? Reading{} : Reading{found->second, 0};
  }

 private:
  Varied at(std::size_t i) const {
    const std::size_t nx = map_.x.values.size();
    return member_.with(map_.x.parameter, map_.x.values[i % nx]).with(map_.y.parameter, map_.y.values[i / nx]);
  }

  const Varied& member_;
  const planes::Map& map_;
  std::size_t at_ = std::size_t(-1);
  std::map<std::string, double> sliding_;  ///< at that point
};

/// Of each member.
std::vector<Readings> readings_of(std::span<const Varied> members, const std::vector<planes::Map>& maps) {
  std::vector<Readings> readings;
  for (std::size_t k = 0; k < members.size(); ++k) readings.emplace_back(members[k], maps[k]);
  return readings;
}

double deviation(const Noise& noise, double value) { return std::hypot(noise.absolute, noise.relative * value); }

/// The smaller divergence of a pair of normal distributions, and its error.
Reading divergence(const Reading& a, const Reading& b, const Noise& noise) {
  if (!std::isfinite(a.value) || !std::isfinite(b.value)) return {0, 0};
  const double distance = a.value - b.value, error = a.error + b.error;
  double least = infinity, its_error = 0;
  for (const auto& [from, to] : {std::pair{deviation(noise, a.value), deviation(noise, b.value)},
                                 std::pair{deviation(noise, b.value), deviation(noise, a.value)}}) {
    if (from == 0 || to == 0)  // relative noise of a metric that is zero: take the other's
      continue;
    const double ratio = from / to;
    const double value = 0.5 * (ratio * ratio - 1) - std::log(ratio) + 0.5 * distance * distance / (to * to);
    if (value < least) {
      least = value;
      its_error = (std::abs(distance) + 0.5 * error) * error / (to * to);
    }
  }
  if (least < infinity) return {least, its_error};
  const double sigma = std::max(deviation(noise, a.value), deviation(noise, b.value));
  if (sigma == 0) return {0, 0};  // both are zero
  return {0.5 * distance * distance / (sigma * sigma), (std::abs(distance) + 0.5 * error) * error / (sigma * sigma)};
}

void check(const Varied& member, const DesignOptions& options) {
  if (options.noise.empty()) throw InputError("no metric is measured: give the noise of at least one");
  for (const auto& noise : options.noise) {
    member.metrics({noise.metric});
    if (!(noise.absolute >= 0) || !(noise.relative >= 0) || !(noise.absolute + noise.relative > 0))
      throw InputError(fmt::format(
          "noise of '{}': absolute = {} and relative = {} must not be negative, nor both 0 (standard deviation)",
          noise.metric, noise.absolute, noise.relative));
  }
  require(options.confidence, {0.5, 1 - 1e-12}, "confidence", "probability of the right decision", "1");
}

planes::MapOptions map_options(const DesignOptions& options) {
  planes::MapOptions map;
  map.x = options.x;
  map.y = options.y;
  for (const auto& noise : options.noise) map.metrics.push_back(noise.metric);
  map.tolerance = options.tolerance;
  map.stick_threshold = options.stick_threshold;
  map.threads = options.threads;
  map.exact = true;  // differences of interpolated planes would show the seams of their patches
  return map;
}

/// The maps of the members one after the other, as one piece of work.
std::vector<planes::Map> maps_of(std::span<const Varied> members, std::span<const planes::MapOptions> options,
                                 const planes::MapHooks& hooks, Outcome& outcome) {
  std::vector<planes::Map> maps;
  for (std::size_t k = 0; k < members.size(); ++k) {
    planes::MapHooks own;
    if (hooks.progress)
      own.progress = [&](const planes::MapProgress& p) {
        hooks.progress({k * p.total + p.done, members.size() * p.total, (double(k) + p.work) / double(members.size())});
      };
    maps.push_back(members[k].map(options[k], own));
    if (maps.back().outcome.ending == Ending::interrupted) {
      outcome = maps.back().outcome;
      break;
    }
  }
  return maps;
}

Design prepared(const DesignOptions& options) {
  Design design;
  design.x = options.x;
  design.y = options.y;
  const std::size_t points = options.x.values.size() * options.y.values.size();
  design.information.assign(points, 0);
  design.information_error.assign(points, 0);
  design.by_metric.assign(options.noise.size(), std::vector<double>(points, 0.0));
  return design;
}

/// No information at this point.
void blank(Design& design, std::size_t i) {
  for (auto* plane : {&design.information, &design.information_error}) (*plane)[i] = nothing;
  for (auto& part : design.by_metric) part[i] = nothing;
}

Design::Best best_of(const Design& design, const std::vector<double>& information, double confidence) {
  Design::Best best;
  const std::size_t nx = design.x.values.size();
  for (std::size_t i = 0; i < information.size(); ++i)
    if (information[i] > best.information) best = {design.x.values[i % nx], design.y.values[i / nx], information[i], 0};
  best.repeats = repeats_needed(best.information, confidence);
  return best;
}

void finish(Design& design, const DesignOptions& options) {
  design.best = best_of(design, design.information, options.confidence);
  for (const auto& part : design.by_metric) design.best_by_metric.push_back(best_of(design, part, options.confidence));
  if (design.failed > 0)
    design.outcome = {Ending::budget_spent, fmt::format("{} of {} points have no result for every member",
                                                        design.failed, design.information.size())};
}

}  // namespace

double repeats_needed(double information, double confidence) {
  if (!(information > 0)) return infinity;
  const double z = gsl_cdf_ugaussian_Pinv(confidence);
  return std::max(1.0, std::ceil(2 * z * z / information));
}

Design discriminate(std::span<const Varied> members, const DesignOptions& options, const planes::MapHooks& hooks) {
  if (members.size() < 2) throw InputError("two members at least are needed to tell apart");
  check(members.front(), options);
  Design design = prepared(options);
  design.maps = maps_of(members, std::vector(members.size(), map_options(options)), hooks, design.outcome);
  if (design.maps.size() < members.size() || !design.outcome.complete()) return design;
  auto readings = readings_of(members, design.maps);
  for (std::size_t i = 0; i < design.information.size(); ++i) {
    if (std::ranges::any_of(design.maps,
                            [&](const auto& map) { return map.points[i].regime == planes::Regime::failed; })) {
      ++design.failed;
      blank(design, i);
      continue;
    }
    double hardest = infinity;
    std::vector<double> hardest_by_metric(options.noise.size(), infinity);
    for (std::size_t a = 0; a < members.size(); ++a)
      for (std::size_t b = a + 1; b < members.size(); ++b) {
        double sum = 0, error = 0;
        for (std::size_t m = 0; m < options.noise.size(); ++m) {
          const auto part = divergence(readings[a](i, m), readings[b](i, m), options.noise[m]);
          hardest_by_metric[m] = std::min(hardest_by_metric[m], part.value);
          sum += part.value;
          error += part.error;
        }
        if (!(sum < hardest)) continue;
        hardest = sum;
        design.information[i] = sum;
        design.information_error[i] = error;
      }
    for (std::size_t m = 0; m < hardest_by_metric.size(); ++m) design.by_metric[m][i] = hardest_by_metric[m];
  }
  for (const double information : design.information)
    design.repeats.push_back(std::isnan(information) ? nothing : repeats_needed(information, options.confidence));
  finish(design, options);
  return design;
}

Design inform(const Varied& model, const std::string& parameter, const DesignOptions& options,
              const planes::MapHooks& hooks) {
  check(model, options);
  constexpr double half_step = 0.01;  // of ln(parameter)
  Design design = prepared(options);
  std::vector<Varied> members;
  std::vector<planes::MapOptions> planes;
  for (const int side : {-1, 1}) {
    const double factor = std::exp(side * half_step);
    planes::MapOptions plane = map_options(options);
    bool on_axis = false;
    for (planes::Axis* axis : {&plane.x, &plane.y})
      if (axis->parameter == parameter) {
        on_axis = true;
        for (double& value : axis->values) value *= factor;
      }
    const double value = model.get(parameter);
    if (!on_axis && !(value > 0))
      throw InputError(fmt::format("{} = {} must be positive for information about its logarithm", parameter, value));
    members.push_back(on_axis ? model : model.with(parameter, factor * value));
    planes.push_back(std::move(plane));
  }
  design.maps = maps_of(members, planes, hooks, design.outcome);
  if (design.maps.size() < members.size() || !design.outcome.complete()) return design;
  auto readings = readings_of(members, design.maps);
  for (std::size_t i = 0; i < design.information.size(); ++i) {
    const auto &low = design.maps[0].points[i], &high = design.maps[1].points[i];
    const bool failed = low.regime == planes::Regime::failed || high.regime == planes::Regime::failed;
    // Across a border metrics jump: a difference is no derivative there.
    const bool jumps = (low.regime == planes::Regime::stable) != (high.regime == planes::Regime::stable);
    if (failed || jumps) {
      design.failed += failed;
      blank(design, i);
      continue;
    }
    for (std::size_t m = 0; m < options.noise.size(); ++m) {
      const auto a = readings[0](i, m), b = readings[1](i, m);
      if (!std::isfinite(a.value) || !std::isfinite(b.value)) continue;
      const auto& noise = options.noise[m];
      const double sigma = deviation(noise, 0.5 * (a.value + b.value));
      if (sigma == 0) continue;
      // N(m, σ²): (dm/dq)²/σ² + 2 (d ln σ/dq)², q = ln p (S. M. Kay, Fundamentals of Statistical Signal Processing,
      // 1993, eq. 3.31). d ln σ = relative² m dm/σ².
      const double mean = (b.value - a.value) / (2 * half_step) / sigma;
      const double of_noise = noise.relative * noise.relative * 0.5 * std::abs(a.value + b.value) / sigma;
      const double factor = 1 + 2 * of_noise * of_noise;
      const double error = (a.error + b.error) / (2 * half_step) / sigma;
      const double information = factor * mean * mean;
      design.by_metric[m][i] = information;
      design.information[i] += information;
      design.information_error[i] += factor * (2 * std::abs(mean) + error) * error;
    }
  }
  finish(design, options);
  return design;
}

}  // namespace rosin::analysis::inference
