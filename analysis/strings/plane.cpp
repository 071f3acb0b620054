/// Pixels, their neighbours, and limits in closed form.
#include "analysis/strings/plane.hpp"

#include <algorithm>
#include <cmath>

namespace rosin::analysis::strings {

std::vector<Pixel> bow_plane(std::span<const BowedStringModel> models, const PlaneOptions& options,
                             const std::function<void(std::size_t, std::size_t)>& finished) {
  auto how = options.bowing;
  how.keep_slips = false;
  const auto pass = [&](std::span<const BowedStringModel> these, std::size_t number) {
    return bow(these, how, options.threads, [&](std::size_t i) {
      if (finished) finished(i, number);
    });
  };
  std::vector<Pixel> pixels;
  for (auto& bowing : pass(models, 0)) pixels.push_back({std::move(bowing), NAN, true});
  for (std::size_t k = 0; k < options.finer.size(); ++k) {
    std::vector<BowedStringModel> fine;
    for (const auto& model : models) fine.push_back(finer(model, options.finer[k]));
    const auto again = pass(fine, k + 1);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      auto& pixel = pixels[i];
      const double change = std::abs(again[i].transient.length - pixel.bowing.transient.length);
      pixel.length_error = std::isnan(pixel.length_error) ? change : std::max(pixel.length_error, change);
      pixel.reproducible = pixel.reproducible && change <= options.within &&
                           again[i].outcome.complete() == pixel.bowing.outcome.complete();
    }
  }
  return pixels;
}

PlaneStatistics statistics_of(std::span<const Pixel> pixels, std::size_t width, double good, double most) {
  PlaneStatistics result;
  const auto is_good = [&](std::size_t i) { return pixels[i].bowing.transient.length < good; };
  const std::size_t height = pixels.size() / width;
  int pairs = 0, edges = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto& pixel = pixels[i];
    if (!pixel.bowing.outcome.complete()) ++result.failed;
    if (is_good(i)) ++result.good;
    if (pixel.bowing.transient.length < most) ++result.shorter_than_most;
    if (pixel.reproducible) ++result.reproducible;
    if (pixel.reproducible && is_good(i)) ++result.good_and_reproducible;
    const std::size_t x = i % width, y = i / width;
    int neighbours = 0, others = 0;
    for (std::size_t b = y == 0 ? 0 : y - 1; b <= std::min(y + 1, height - 1); ++b)
      for (std::size_t a = x == 0 ? 0 : x - 1; a <= std::min(x + 1, width - 1); ++a) {
        if (a == x && b == y) continue;
        ++neighbours;
        others += is_good(b * width + a) != is_good(i);
      }
    if (neighbours > 0 && others >= 0.75 * neighbours) ++result.speckles;
    if (x + 1 < width) ++pairs, edges += is_good(i) != is_good(i + 1);
    if (y + 1 < height) ++pairs, edges += is_good(i) != is_good(i + width);
  }
  result.edge_density = pairs > 0 ? double(edges) / pairs : 0;
  return result;
}

PlaneDifference difference(std::span<const Pixel> a, std::span<const Pixel> b, double good) {
  PlaneDifference result;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!a[i].reproducible || !b[i].reproducible) continue;
    ++result.compared;
    result.differ += (a[i].bowing.transient.length < good) != (b[i].bowing.transient.length < good);
  }
  return result;
}

double friction_at_rest(const FrictionLaw& law, double normal_load) {
  constexpr double creep = 1e-6;  // m/s
  return law.set_valued() ? law.static_limit(normal_load, law.rest(normal_load))
                          : law.steady_friction({creep, normal_load}).friction;
}

GuettlerRays guettler_rays(const oscillators::BowedString& string, double at_rest, double difference, double periods) {
  const double beta = string.bow_position, scale = string.impedance * string.period();  // N/a = x Z₀ T₀
  const double lower = 4 * at_rest * (1 - beta) / (beta * difference * difference);
  // x = (2/(β Δμ)) (√(μ_s β (1 − β) x) + n), a quadratic equation of √x.
  const double p = 2 / (beta * difference) * std::sqrt(at_rest * beta * (1 - beta));
  const double q = 2 * periods / (beta * difference);
  const double root = 0.5 * (p + std::sqrt(p * p + 4 * q));
  return {lower * scale, root * root * scale};
}

SchellengLimits schelleng_limits(const BowedStringModel& model, double bow_speed) {
  const auto& string = model.string;
  const auto& law = *model.law;
  const double beta = string.bow_position, N = std::max(model.load.value(0), 1e-3);
  const double falls = friction_at_rest(law, N) - law.steady_friction({bow_speed / beta, N}).friction;
  if (!(falls > 0)) return {0, INFINITY};
  const double Z = string.impedance;
  return {std::isfinite(string.bridge_resistance)
              ? Z * Z * bow_speed / (2 * beta * beta * string.bridge_resistance * falls)
              : 0,
          2 * Z * bow_speed / (beta * falls)};
}

}  // namespace rosin::analysis::strings
