/// Borders of steady sliding in normal load, their criticality, and the folds below subcritical ones.
#include "analysis/coexistence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <optional>

#include "analysis/curve.hpp"
#include "analysis/return_map.hpp"

namespace rosin::analysis {

namespace {

constexpr std::string_view load_path = "drive.normal_load";

/// The load, relative to the Hopf load, at which a cycle has the given size: where the drift per passage vanishes.
/// The drift grows with the load, as sliding becomes more unstable.
class LoadOfCycle {
 public:
  LoadOfCycle(const Model& model, double hopf_load) : model_(model), hopf_load_(hopf_load) {}

  std::optional<double> operator()(double size) {
    double a = 0, fa, b = -1e-3, fb;
    if (!drift(size, a, fa) || !drift(size, b, fb)) return std::nullopt;
    // Secant in ln(N/N_H); the drift is close to linear.
    for (int i = 0; i < 30; ++i) {
      if (fa == fb) return std::nullopt;
      const double next = std::clamp(b - fb * (b - a) / (fb - fa), b - 0.05, b + 0.05);
      a = b, fa = fb, b = next;
      if (!drift(size, b, fb)) return std::nullopt;
      if (std::abs(b - a) < 1e-9) return b;
    }
    return std::nullopt;
  }

 private:
  bool drift(double size, double log_ratio, double& rate) {
    ReturnMap map(model_.with(load_path, hopf_load_ * std::exp(log_ratio)));
    const auto steady = map.system().steady(0);
    const auto length = [&](const Eigen::VectorXd& d) { return (d.array() / map.scale().array()).matrix().norm(); };
    if (direction_.size() == 0) direction_ = Eigen::VectorXd::Unit(map.scale().size(), 0) * map.scale()[0];
    // Passages from one and the same size: the first ones relax the fast directions, the last shows the drift.
    for (int k = 0; k < 4; ++k) {
      const auto passage = map.follow(map.moved(steady, direction_, size / length(direction_)), 1e-11, 1, true);
      if (!passage.outcome.complete()) return false;
      direction_ = map.difference(passage.end, steady);
      if (!(length(direction_) > 0)) return false;
      rate = std::log(length(direction_) / size);
    }
    return std::isfinite(rate);
  }

  const Model& model_;
  double hopf_load_;
  Eigen::VectorXd direction_;  ///< of the slow mode on the section, carried from one size to the next
};

/// All parameters but the load.
std::vector<double> key_of(const Model& model) {
  std::vector<double> key;
  for (const auto& p : model.parameters())
    if (p.name != load_path) key.push_back(model.get(p.name));
  return key;
}

}  // namespace

double fold_of_cycles(const Model& model, double hopf_load) {
  LoadOfCycle load_of(model, hopf_load);
  // From small cycles upwards until the load has passed its minimum.
  constexpr double growth = 1.2;
  double best = 0, best_size = 0, size = 0.01;
  for (; size < 100; size *= growth) {
    const auto ratio = load_of(size);
    if (!ratio) break;
    if (*ratio < best)
      best = *ratio, best_size = size;
    else if (best < 0 && size > 2 * best_size)
      break;
  }
  if (!(best < 0)) return 0;
  const auto objective = [&](double log_size) { return load_of(std::exp(log_size)).value_or(1.0); };
  const auto [at, lowest] =
      boost::math::tools::brent_find_minima(objective, std::log(best_size / growth), std::log(best_size * growth), 24);
  return hopf_load * std::exp(std::min(lowest, best));
}

CoexistenceSearch::Border CoexistenceSearch::border(const Model& model) {
  const auto key = key_of(model);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto it = known_.find(key); it != known_.end()) return it->second;
  }
  // Computed from a load that is the same for all points of the row, so that the answer is too.
  Border border;
  std::optional<HopfPoint> hopf;
  if (const auto closed = critical_load(model)) {
    const auto points = hopf_points(model.with(load_path, closed->normal_load), load_path, 0.5);
    if (!points.empty()) hopf = points.front();
  } else {
    for (const auto& point : hopf_points(model.with(load_path, 1.0), load_path))
      if (!hopf || point.value < hopf->value) hopf = point;
  }
  if (hopf) {
    border.hopf_load = hopf->value;
    border.subcritical = hopf->criticality != Criticality::supercritical;
    if (border.subcritical) border.fold_load = fold_of_cycles(model, hopf->value);
  }
  const std::scoped_lock lock(mutex_);
  return known_.emplace(key, border).first->second;
}

Coexistence CoexistenceSearch::ask(const Model& model) {
  using enum Coexistence::Answer;
  const auto& law = *model.law;
  const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
  if (N == 0) return {none, "no load, no friction"};
  if (law.set_valued()) return {possible, "the law is set-valued at rest: stick may coexist with sliding"};
  if (!weakens_somewhere(law, N)) return {none, "friction strengthens with slip rate everywhere"};
  if (law.steady_friction({V, N}).slope * V >= 0) return {possible, "the drive lies outside the weakening branch"};
  const Border found = border(model);
  if (found.hopf_load <= N) return {possible, "no Hopf point above this load"};
  if (!found.subcritical) return {none, "the border of stability is supercritical"};
  if (found.fold_load > 0 && N < found.fold_load) return {none, "below the fold of cycles at the subcritical border"};
  return {possible, "between the fold of cycles and the subcritical border"};
}

}  // namespace rosin::analysis
