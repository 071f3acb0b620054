/// Borders of steady sliding in normal load, their criticality, and the folds below subcritical ones.
#include "analysis/cycles/coexistence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "analysis/cycles/return_map.hpp"
#include "analysis/steady/curve.hpp"
#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

namespace {

constexpr std::string_view load_path = "drive.normal_load";

/// The load, relative to the Hopf load, at which a cycle has the given size. Broyden's method solves for the load and
/// the direction of the start on the section together; the Jacobian of one size starts the next.
class LoadOfCycle {
 public:
  LoadOfCycle(const Model& model, double hopf_load) : model_(model), hopf_load_(hopf_load) {}

  /// ln(N/N_H), to about 1e-9.
  std::optional<double> operator()(double size) {
    Eigen::VectorXd residual, next;
    if (unknowns_.size() == 0 && !align(size)) return std::nullopt;
    if (!miss(size, unknowns_, residual)) return std::nullopt;
    if (jacobian_.size() == 0 && !measure_jacobian(size, residual)) return std::nullopt;
    const Eigen::Index load = unknowns_.size() - 1;
    constexpr int most = 30, patience = 10;
    for (int i = 0; i < most; ++i) {
      // Updates from long steps may have spoilt the Jacobian.
      if (i > 0 && i % patience == 0 && !measure_jacobian(size, residual)) return std::nullopt;
      Eigen::VectorXd step = -solve_linear(jacobian_, residual);
      const double length = step.norm();
      if (!std::isfinite(length)) return std::nullopt;
      if (length > 0.1) step *= 0.1 / length;
      unknowns_ += step;
      if (length < 1e-4 && std::abs(step[load]) < 1e-8) return unknowns_[load];
      if (!miss(size, unknowns_, next)) return std::nullopt;
      if (length > 1e-6)  // shorter steps would fit noise
        jacobian_ += (next - residual - jacobian_ * step) * step.transpose() / step.squaredNorm();
      residual = next;
    }
    return std::nullopt;
  }

 private:
  /// End of a return whose start differs from steady sliding by `start` times the size; both in units of the section's
  /// scale and the size.
  static std::optional<Eigen::VectorXd> image(ReturnMap& map, const Eigen::VectorXd& start, double size) {
    const auto steady = map.system().steady(0);
    const auto returned = map.follow(map.moved(steady, start.cwiseProduct(map.scale()), size), 1e-10, 1, true);
    if (!returned.outcome.complete()) return std::nullopt;
    return map.difference(returned.end, steady).cwiseQuotient(map.scale()) / size;
  }
  /// Sets the direction of the motion at the Hopf load, after two returns.
  bool align(double size) {
    ReturnMap map(model_.with(load_path, hopf_load_));
    const Eigen::Index n = map.scale().size();
    Eigen::VectorXd direction = Eigen::VectorXd::Unit(n, 0);
    for (int i = 0; i < 2; ++i) {
      const auto end = image(map, direction, size);
      if (!end || !(end->norm() > 0)) return false;
      direction = end->normalized();
    }
    unknowns_ = Eigen::VectorXd::Zero(n + 1);
    unknowns_.head(n) = direction;
    return true;
  }
  /// Residual: the change in one return from the given size, in units of the size, and |direction|² − 1. `at`:
  /// direction, in the scale of the section, and ln(N/N_H).
  bool miss(double size, const Eigen::VectorXd& at, Eigen::VectorXd& residual) const {
    const Eigen::Index n = at.size() - 1;
    const Eigen::VectorXd start = at.head(n);
    ReturnMap map(model_.with(load_path, hopf_load_ * std::exp(at[n])));
    const auto end = image(map, start, size);
    if (!end) return false;
    residual.resize(n + 1);
    residual.head(n) = *end - start;
    residual[n] = start.squaredNorm() - 1;
    return residual.allFinite();
  }
  bool measure_jacobian(double size, const Eigen::VectorXd& residual) {
    constexpr double step = 1e-4;
    const Eigen::Index n = unknowns_.size();
    jacobian_.resize(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      Eigen::VectorXd moved = unknowns_ + step * Eigen::VectorXd::Unit(n, k), there;
      if (!miss(size, moved, there)) return false;
      jacobian_.col(k) = (there - residual) / step;
    }
    return true;
  }

  const Model& model_;
  double hopf_load_;
  Eigen::VectorXd unknowns_;  ///< direction and ln(N/N_H) of the last size
  Eigen::MatrixXd jacobian_;
};

/// All parameters but the load.
std::vector<double> key_of(const Model& model) {
  std::vector<double> key;
  for (const auto& p : model.parameters())
    if (p.name != load_path) key.push_back(model.get(p.name));
  return key;
}

}  // namespace

namespace {

/// The minimum of a smooth function, by parabolas through the three lowest places until two agree.
struct Minimum {
  double at = 0, value = 0, error = 0;
};
template <class F>
std::optional<Minimum> minimum_near(F f, double centre, double width) {
  struct Place {
    double at, value;
  };
  std::vector<Place> places;
  const auto look = [&](double at) {
    const std::optional<double> value = f(at);
    if (value) places.push_back({at, *value});
    return value.has_value();
  };
  for (const double at : {centre, centre - width, centre + width})
    if (!look(at)) return std::nullopt;
  std::optional<double> last;
  for (int i = 0; i < 12; ++i) {
    std::ranges::sort(places, {}, &Place::value);
    const auto [x0, f0] = places[0];
    const auto [x1, f1] = places[1];
    const auto [x2, f2] = places[2];
    const double slope = (f1 - f0) / (x1 - x0), bend = ((f2 - f0) / (x2 - x0) - slope) / (x2 - x1);
    if (!(bend > 0)) return std::nullopt;
    const double at = 0.5 * (x0 + x1 - slope / bend);
    const double lowest = f0 + slope * (at - x0) + bend * (at - x0) * (at - x1);
    if (std::abs(at - centre) > 4 * width) return std::nullopt;
    // The parabola must agree with the last one and with the lowest place. The tolerance is tighter for a shallow
    // minimum, because its root is used too.
    const double known = std::clamp(3e-5 * std::abs(lowest), 3e-9, 1e-7);
    if (last && std::abs(lowest - *last) < known && f0 - lowest < 30 * known)
      return Minimum{at, lowest, std::abs(lowest - *last) + known};
    last = lowest;
    double next = at;
    for (const auto& place : places)
      if (std::abs(place.at - next) < 0.01 * width) next = at + (at > x0 ? 0.02 : -0.02) * width;
    if (!look(next)) return std::nullopt;
  }
  return std::nullopt;
}

constexpr double growth = 1.5;  ///< from one size of cycles to the next

}  // namespace

Fold fold_below(const Model& model, double hopf_load, double near_size) {
  LoadOfCycle load_of(model, hopf_load);
  const auto by_log_size = [&](double log_size) { return load_of(std::exp(log_size)); };
  const auto polished = [&](double size) -> Fold {
    const auto least = minimum_near(by_log_size, std::log(size), 0.5 * std::log(growth));
    if (!least || !(least->value < 0)) return {};
    return {least->value, least->error, std::exp(least->at)};
  };
  if (near_size > 0)
    if (const Fold fold = polished(near_size); fold.size > 0) return fold;
  // From small cycles upwards until the load has passed its minimum.
  double best = 0, best_size = 0;
  for (double size = 0.01; size < 100; size *= growth) {
    const auto ratio = load_of(size);
    if (!ratio) break;
    if (*ratio < best)
      best = *ratio, best_size = size;
    else if (best < 0 && size > 2 * best_size)
      break;
  }
  if (!(best < 0)) return {};
  if (const Fold fold = polished(best_size); fold.size > 0) return fold;
  const auto objective = [&](double log_size) { return by_log_size(log_size).value_or(1.0); };
  const auto [at, lowest] =
      boost::math::tools::brent_find_minima(objective, std::log(best_size / growth), std::log(best_size * growth), 24);
  return {std::min(lowest, best), 1e-6, std::exp(at)};
}

double fold_of_cycles(const Model& model, double hopf_load) {
  const Fold fold = fold_below(model, hopf_load);
  return fold.size > 0 ? hopf_load * std::exp(fold.log_ratio) : 0;
}

std::optional<steady::HopfPoint> border_in_load(const Model& model) {
  if (const auto closed = steady::hopf_at_critical_load(model)) return closed;
  std::optional<steady::HopfPoint> hopf;
  // From a load that does not depend on the model's own.
  if (const auto closed = steady::critical_load(model)) {
    const auto points = steady::hopf_points(model.with(load_path, closed->normal_load), load_path, 0.01);
    if (!points.empty()) hopf = points.front();
  } else if (!steady::critical_load_is_closed(model)) {
    for (const auto& point : steady::hopf_points(model.with(load_path, 1.0), load_path))
      if (!hopf || point.value < hopf->value) hopf = point;
  }
  return hopf;
}

double FoldLine::coordinate(double value) const { return logarithmic ? std::log(value) : value; }

double FoldLine::Stretch::log_ratio(double coordinate) const {
  const double t = (2 * coordinate - begin - end) / (end - begin);
  double b1 = 0, b2 = 0;  // Clenshaw
  for (std::size_t k = coefficients.size(); k-- > 1;) {
    const double b = 2 * t * b1 - b2 + coefficients[k];
    b2 = b1, b1 = b;
  }
  const double root = t * b1 - b2 + coefficients[0];
  return -root * root;
}

const FoldLine::Stretch* FoldLine::at(double value) const {
  if (logarithmic && !(value > 0)) return nullptr;
  const double c = coordinate(value);
  for (const auto& stretch : stretches)
    if (stretch.begin <= c && c <= stretch.end) return &stretch;
  return nullptr;
}

namespace {

/// The line along one stretch where the border is subcritical.
class StretchTracer {
 public:
  /// `closed_begin`, `closed_end`: the fold meets the border there.
  StretchTracer(std::function<Model(double)> model_at, double begin, double end, bool closed_begin, bool closed_end)
      : model_at_(std::move(model_at)), begin_(begin), end_(end) {
    if (closed_begin) roots_[0] = 0;
    if (closed_end) roots_[finest] = 0;
  }

  std::optional<FoldLine::Stretch> trace(double tolerance) {
    for (int intervals = 6; intervals < finest; intervals *= 2) {
      const int stride = finest / intervals;
      // From the middle outwards, so that each fold is near one that is known.
      for (int i = 0; i <= intervals; ++i) {
        const int k = intervals / 2 + (i % 2 == 0 ? i / 2 : -(i + 1) / 2);
        if (!root_at(k * stride)) return std::nullopt;
      }
      FoldLine::Stretch stretch{begin_, end_, std::vector<double>(intervals + 1), 0, 0};
      for (int j = 0; j <= intervals; ++j)
        for (int k = 0; k <= intervals; ++k) {
          const double halved = (j % intervals == 0 ? 0.5 : 1.0) * (k % intervals == 0 ? 0.5 : 1.0);
          stretch.coefficients[j] += 2.0 / intervals * halved * roots_.at(k * stride) *
                                     std::cos(std::numbers::pi * j * (intervals - k) / intervals);
        }
      // Held out: nodes of the next finer line near the ends and the middle.
      for (const int k : {1, intervals - 1, 2 * intervals - 1}) {
        const int place = k * stride / 2;
        const auto root = root_at(place);
        if (!root) return std::nullopt;
        stretch.error = std::max(stretch.error, std::abs(stretch.log_ratio(coordinate_at(place)) + *root * *root));
      }
      stretch.error = 2 * stretch.error + 2 * worst_fold_;
      stretch.folds = folds_;
      if (stretch.error <= tolerance || 2 * intervals == finest) return stretch;
    }
    return std::nullopt;
  }

 private:
  static constexpr int finest = 48;  ///< intervals of the Chebyshev points that are numbered here
  double position(int place) const { return -std::cos(std::numbers::pi * place / finest); }
  double coordinate_at(int place) const { return 0.5 * (begin_ + end_ + position(place) * (end_ - begin_)); }
  /// √(−ln(N_fold/N_Hopf)) at one of the points.
  std::optional<double> root_at(int place) {
    if (const auto known = roots_.find(place); known != roots_.end()) return known->second;
    const double t = position(place), coordinate = coordinate_at(place);
    const Model model = model_at_(coordinate);
    const auto hopf = border_in_load(model);
    if (!hopf) return std::nullopt;
    if (hopf->criticality == steady::Criticality::supercritical) return roots_[place] = 0;  // an end, to rounding
    // Sizes of cycles go with the root of the Lyapunov coefficient.
    double near = 0, nearest = 3;
    for (const auto& other : known_)
      if (std::abs(other.t - t) < nearest)
        nearest = std::abs(other.t - t),
        near = other.size * std::sqrt(hopf->first_lyapunov_coefficient / other.lyapunov);
    const Fold fold = fold_below(model, hopf->value, std::isfinite(near) ? near : 0);
    ++folds_;
    if (!(fold.size > 0)) return std::nullopt;
    known_.push_back({t, fold.size, hopf->first_lyapunov_coefficient});
    worst_fold_ = std::max(worst_fold_, fold.error);
    return roots_[place] = std::sqrt(-fold.log_ratio);
  }

  struct Known {
    double t, size, lyapunov;
  };
  std::function<Model(double)> model_at_;
  double begin_, end_, worst_fold_ = 0;
  int folds_ = 0;
  std::vector<Known> known_;
  std::map<int, double> roots_;
};

}  // namespace

FoldLine trace_folds(const Model& model, std::string_view parameter, double from, double to, bool logarithmic,
                     int samples, double tolerance) {
  FoldLine line;
  line.logarithmic = logarithmic;
  double begin = line.coordinate(std::min(from, to)), end = line.coordinate(std::max(from, to));
  const auto model_at = [&](double coordinate) {
    return model.with(parameter, logarithmic ? std::exp(coordinate) : coordinate);
  };
  // Softness of the border: positive where it is subcritical; NaN where there is none, or none with a fold below it.
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto softness = [&](double coordinate) {
    try {
      const Model here = model_at(coordinate);
      if (here.law->set_valued() || !(here.drive.speed.level() > 0)) return nan;
      const auto hopf = border_in_load(here);
      return hopf && hopf->value > 0 ? hopf->first_lyapunov_coefficient : nan;
    } catch (const InputError&) {
      return nan;
    }
  };
  std::vector<double> places, soft;
  for (int i = 0; i < samples; ++i) {
    const double w = double(i) / (samples - 1);
    places.push_back(begin + (end - begin) * w);
    soft.push_back(softness(places.back()));
  }
  const auto border_between = [&](int i) {  // between places i and i + 1
    if (!std::isfinite(soft[i]) || !std::isfinite(soft[i + 1])) return soft[i] > 0 ? places[i] : places[i + 1];
    std::uintmax_t iterations = 60;
    const auto [l, h] = boost::math::tools::toms748_solve(softness, places[i], places[i + 1], soft[i], soft[i + 1],
                                                          boost::math::tools::eps_tolerance<double>(40), iterations);
    return 0.5 * (l + h);
  };
  for (int i = 0; i < samples; ++i) {
    if (!(soft[i] > 0)) continue;
    const int i_first = i;
    const double first = i == 0 ? places[0] : border_between(i - 1);
    while (i + 1 < samples && soft[i + 1] > 0) ++i;
    const double last = i + 1 < samples ? border_between(i) : places[i];
    if (!(last > first)) continue;
    if (auto stretch = StretchTracer(model_at, first, last, i_first > 0, i + 1 < samples).trace(tolerance))
      line.stretches.push_back(std::move(*stretch));
    else
      line.problems.push_back(fmt::format("the fold of cycles could not be followed for {} = {:.4g} … {:.4g}",
                                          parameter, logarithmic ? std::exp(first) : first,
                                          logarithmic ? std::exp(last) : last));
  }
  return line;
}

CoexistenceSearch::Border CoexistenceSearch::border(const Model& model) {
  const auto key = key_of(model);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto it = known_.find(key); it != known_.end()) return it->second;
  }
  // Computed from a load that is the same for all points of the row, so that the answer is too.
  Border border;
  if (const auto hopf = border_in_load(model)) {
    border.hopf_load = hopf->value;
    border.subcritical = hopf->criticality != steady::Criticality::supercritical;
    if (border.subcritical && !parameter_.empty()) {
      const double value = model.get(parameter_);
      const auto* traced = line_.at(value);
      border.fold_load = traced ? hopf->value * std::exp(traced->log_ratio(line_.coordinate(value)) - traced->error)
                                : fold_of_cycles(model, hopf->value);
    }
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
  const bool weakens = law.steady_friction({V, N}).slope * V < 0;
  if (!weakens && !steady::weakens_somewhere(law, N)) return {none, "friction strengthens with slip rate everywhere"};
  if (!weakens) return {possible, "the drive lies outside the weakening branch"};
  if (parameter_.empty()) {
    constexpr double slowly = 1e-3;
    const auto eigenvalues = steady::stability(model).eigenvalues;
    const auto leading = eigenvalues.empty() ? 0.0 : eigenvalues.front();
    if (-leading.real() > slowly * std::abs(leading.imag()))
      return {possible,
              "motion dies out soon, and whether all does is seen sooner than the border of stability is found"};
  }
  const Border found = border(model);
  if (found.hopf_load <= N) return {possible, "no Hopf point above this load"};
  if (!found.subcritical) return {none, "the border of stability is supercritical"};
  if (found.fold_load > 0 && N < found.fold_load) return {none, "below the fold of cycles at the subcritical border"};
  return {possible, "below the subcritical border, and not known to be below the fold of cycles"};
}

}  // namespace rosin::analysis::cycles
