/// Growth of disturbances over periods of the force.
#include "analysis/lanes/driven_exponents.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/lanes/driven_lanes.hpp"
#include "analysis/motion/recurrence.hpp"

namespace rosin::analysis::lanes {

namespace {

/// Logarithm of the larger multiplier of the motion over `n` periods, from the last 2n before `end`, in which a
/// disturbance goes from one direction to a second and a third: M² = tr M − det.
double multiplier(const std::vector<DrivenMotion::Growth>& growth, long end, long n) {
  const auto cross = [](const auto& a, const auto& b) { return a.along * b.across - a.across * b.along; };
  const auto sum = [&](long from, long to) {
    double all = 0;
    for (long i = from; i < to; ++i) all += growth[std::size_t(i)].logarithm;
    return all;
  };
  const auto &first = growth[std::size_t(end - 2 * n - 1)], &second = growth[std::size_t(end - n - 1)],
             &third = growth[std::size_t(end - 1)];
  const double before = sum(end - 2 * n, end - n), last = sum(end - n, end), apart = cross(first, second);
  constexpr double parallel = 1e-5;  // the disturbance has come to the direction that grows most
  if (std::abs(apart) < parallel) return last;
  // In units of what the last n periods make of a disturbance.
  const double trace = cross(first, third) / apart;
  const double determinant = std::exp(before - last) * cross(second, third) / apart;
  const double discriminant = 0.25 * trace * trace - determinant;
  const double modulus = discriminant < 0 ? std::sqrt(determinant) : 0.5 * std::abs(trace) + std::sqrt(discriminant);
  return last + std::log(modulus);
}

DrivenExponent exponent_of(const DrivenMotion& motion) {
  const auto& growth = motion.growth;
  const double T = motion.block.period;
  std::vector<std::vector<double>> columns(2);
  for (const auto& at : motion.moments) columns[0].push_back(at.displacement), columns[1].push_back(at.slip_rate);
  const int returns = motion::recurrence_of(columns, int(growth.size()) / 4);
  if (returns == 0) {
    std::vector<double> series;
    for (const auto& at : growth) series.push_back(at.logarithm);
    const double mean = std::accumulate(series.begin(), series.end(), 0.0) / double(series.size());
    return {mean / T, cycles::blocked_error(std::move(series)).value / T, 0};
  }
  const long end = long(growth.size());
  const double last = multiplier(growth, end, returns), before = multiplier(growth, end - returns, returns);
  // Besides, what the steps of a period err by.
  return {last / (returns * T), std::abs(last - before) / (returns * T) + 10 * motion.tolerance / T, returns};
}

}  // namespace

bool serves_exponents(const motion::StructureModel& model, const cycles::LyapunovOptions& options) {
  return options.duration > 0 && DrivenBlock::of(model.structure).has_value();
}

std::vector<std::optional<DrivenExponent>> driven_exponents(std::span<const motion::StructureModel> models,
                                                            const cycles::LyapunovOptions& options) {
  std::vector<std::optional<DrivenExponent>> found(models.size());
  std::vector<DrivenMotion> motions;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < models.size(); ++i) {
    auto block = serves_exponents(models[i], options) ? DrivenBlock::of(models[i].structure) : std::nullopt;
    if (!block || (!motions.empty() && !DrivenLanes::alike(motions.front().block, *block))) continue;
    std::vector<double> y;
    try {
      y = motion::starting_point(oscillators::StructureSystem(models[i].structure), models[i].start);
    } catch (const InputError&) {
      continue;  // a start that does not fit
    }
    const double T = block->period, transient = options.transient < 0 ? 0.1 * options.duration : options.transient;
    constexpr int fewest = 32;  // periods of the force: blocks of an error need them
    motions.push_back({.block = std::move(*block),
                       .displacement = y[0],
                       .slip_rate = y[1],
                       .tolerance = 0.1 * options.accuracy,
                       .transient = int(std::ceil(transient / T)),
                       .keep = std::max(fewest, int(std::ceil(options.duration / T)))});
    of.push_back(i);
  }
  if (!motions.empty()) DrivenLanes(motions.front().block, true).run(motions);
  for (std::size_t m = 0; m < motions.size(); ++m)
    if (motions[m].why.empty()) found[of[m]] = exponent_of(motions[m]);
  return found;
}

}  // namespace rosin::analysis::lanes
