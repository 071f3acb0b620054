/// F tests of means over stretches of the motion, against what noise of the residuals gives them.
#include "analysis/inference/misfit.hpp"

#include <gsl/gsl_cdf.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace rosin::analysis::inference {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Of each point the class that it belongs to, or none.
constexpr int none = -1;
struct Classes {
  const char* where;
  std::vector<int> of;
};

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

/// Points at which a slip rate has jumped, or reversed: means over `window` samples on both sides differ by much more
/// than noise gives them and than they change within.
void find_changes(std::span<const double> u, std::size_t window, std::vector<std::size_t>& changes) {
  const double noise = roughness(u), half = double(window) / 2;
  const auto drift = [&](std::size_t begin) {
    const auto middle = window / 2;
    return std::abs(mean(u.subspan(begin + window - middle, middle)) - mean(u.subspan(begin, middle)));
  };
  std::vector<double> jump(u.size(), 0);
  for (std::size_t k = window; k + window <= u.size(); ++k) {
    const double before = mean(u.subspan(k - window, window)), after = mean(u.subspan(k, window));
    const double change = std::abs(after - before);
    constexpr double clear = 6, part = 0.2, steady = 2;
    if (change > clear * noise / std::sqrt(half) && change > part * std::max(std::abs(before), std::abs(after)) &&
        change > steady * (drift(k - window) + drift(k)))
      jump[k] = change;
  }
  for (std::size_t k = 0; k < jump.size(); ++k) {
    if (jump[k] == 0) continue;
    const auto begin = k - std::min(k, window), end = std::min(jump.size(), k + window + 1);
    const auto highest = std::max_element(jump.begin() + std::ptrdiff_t(begin), jump.begin() + std::ptrdiff_t(end));
    const bool known = std::ranges::any_of(changes, [&](std::size_t c) { return c + window > k && k + window > c; });
    if (std::size_t(highest - jump.begin()) == k && !known) changes.push_back(k);
  }
}

/// Stretches behind changes of the slip rate, each twice as long as the one before; changes of one kind share them
/// where there are many.
std::vector<Classes> behind_changes(std::span<const double> u) {
  std::vector<std::size_t> changes;
  for (const std::size_t window : {4u, 16u}) find_changes(u, window, changes);
  std::ranges::sort(changes);
  constexpr std::size_t few = 6;
  double fastest = 0;
  for (const double v : u) fastest = std::max(fastest, std::abs(v));
  std::vector<int> moving(u.size(), none), resting(u.size(), none);
  std::map<std::pair<int, int>, int> kinds;  // of rest and motion either way, before and after
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto begin = changes[i], end = i + 1 < changes.size() ? changes[i + 1] : u.size();
    const auto before = i > 0 ? changes[i - 1] : 0;
    const double slow = 1e-3 * fastest + 3 * roughness(u) / std::sqrt(double(end - begin));
    const auto state = [&](std::size_t from, std::size_t to) {
      const double rate = mean(u.subspan(from, to - from));
      return std::abs(rate) <= slow ? 0 : rate > 0 ? 1 : -1;
    };
    const int now = state(begin, end), then = state(before, begin);
    const double faster =
        std::abs(mean(u.subspan(begin, end - begin))) - std::abs(mean(u.subspan(before, begin - before)));
    const int kind = changes.size() <= few
                         ? int(i)
                         : kinds.try_emplace({then, 2 * now + (faster > 0)}, int(kinds.size())).first->second;
    constexpr int most = 64;  // stretches behind one change
    std::size_t length = 4, from = begin;
    for (int stretch = 0; from < end; ++stretch) {
      // The last one takes what would be less than half of the next.
      auto to = from + length;
      if (to + length > end) to = end;
      for (auto k = from; k < to; ++k) (now == 0 ? resting : moving)[k] = kind * most + stretch;
      from = to;
      if (stretch > 0) length *= 2;
    }
  }
  return {{"after changes of the slip rate", moving}, {"at rest", resting}};
}

/// Classes with as many values each; none where all values are the same.
std::vector<int> quantiles(std::span<const double> values, int classes) {
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  constexpr double same = 1e-3;
  const double spread = sorted.back() - sorted.front();
  std::vector<int> of;
  if (!(spread > same * std::max(std::abs(sorted.back()), std::abs(sorted.front()))))
    return std::vector<int>(values.size(), none);
  std::vector<double> edges;
  for (int i = 1; i < classes; ++i) {
    const double edge = sorted[sorted.size() * std::size_t(i) / std::size_t(classes)];
    if (edge - (edges.empty() ? sorted.front() : edges.back()) > same * spread) edges.push_back(edge);
  }
  for (const double v : values) of.push_back(int(std::ranges::upper_bound(edges, v) - edges.begin()));
  return of;
}

std::vector<Classes> classes_of(const Measurement& m, const std::vector<double>& u) {
  auto all = behind_changes(u);
  constexpr int rates = 8, loads = 6;
  // Rising or falling in magnitude: friction that remembers is another on the way back.
  constexpr std::size_t reach = 3;
  auto phase = quantiles(u, rates);
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double before = u[k - std::min(k, reach)], after = u[std::min(u.size() - 1, k + reach)];
    if (phase[k] != none) phase[k] = 2 * phase[k] + (std::abs(after) > std::abs(before));
  }
  all.push_back({"by slip rate and phase", phase});
  if (m.kind == Measurement::Kind::record) {
    const auto load = imposed_normal_load(m);
    all.push_back({"by normal load", quantiles(load, loads)});
  }
  return all;
}

/// Indicators of the classes that hold enough points, as columns.
MatrixXd columns_of(const std::vector<int>& classes, const std::vector<char>& apart) {
  std::map<int, int> count;
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (classes[k] != none && (apart.empty() || !apart[k])) ++count[classes[k]];
  std::erase_if(count, [](const auto& entry) {
    constexpr int fewest = 4;
    return entry.second < fewest;
  });
  Index column = 0;
  for (auto& [name, number] : count) number = int(column++);
  MatrixXd columns = MatrixXd::Zero(Index(classes.size()), column);
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (const auto found = count.find(classes[k]); found != count.end()) columns(Index(k), found->second) = 1;
  return columns;
}

}  // namespace

Told tell_misfit(const Measurement& m, const std::vector<double>& slip_rate, const Leftover& part) {
  const auto n = Index(part.residual.size()), p = Index(part.slopes.size()) / n;
  const auto points = n - Index(std::ranges::count(part.apart, 1));
  constexpr double by_chance = 1e-3;
  Told told{{}, part.noise};
  double clearest = 0;  // fall of χ²
  const auto families = classes_of(m, slip_rate);
  for (const auto& family : families) {
    const auto columns = columns_of(family.of, part.apart);
    if (columns.cols() < 2 || points < 2 * (p + columns.cols())) continue;
    Rows all(n, p + columns.cols());
    all << Eigen::Map<const Rows>(part.slopes.data(), n, p), columns;
    for (Index j = 0; j < all.cols(); ++j)
      if (const double size = all.col(j).norm(); size > 0) all.col(j) /= size;
    std::vector<Leftover> beside = {part};
    beside[0].slopes.assign(all.data(), all.data() + all.size());
    beside[0].unknown = beside[0].series = true;
    find_noise(beside);
    const auto noise = beside[0].noise;
    auto& [residual, slopes, _, unknown, series, apart] = beside[0];
    whiten(residual, 1, noise.correlation, apart);
    whiten(slopes, std::size_t(all.cols()), noise.correlation, apart);
    Eigen::Map<VectorXd> r(residual.data(), n);
    Eigen::Map<Rows> J(slopes.data(), n, all.cols());
    for (Index k = 0; k < n; ++k)
      if (!apart.empty() && apart[std::size_t(k)]) r[k] = 0, J.row(k).setZero();
    const auto left = [&](const MatrixXd& matrix, Index& rank) {
      Eigen::ColPivHouseholderQR<MatrixXd> solver(matrix);
      solver.setThreshold(1e-9);
      rank = solver.rank();
      return (r - matrix * solver.solve(r)).squaredNorm();
    };
    Index fewer = 0, more = 0;
    const double without = left(J.leftCols(p), fewer), with = left(J, more);
    const double degrees = double(more - fewer), rest = double(points - more);
    if (!(degrees > 0) || !(rest > 0) || !(with > 0)) continue;
    const double variance = with / rest, fall = (without - with) / variance - degrees;
    const double probability =
        gsl_cdf_fdist_Q((without - with) / degrees / variance, degrees, rest) * double(families.size());
    if (!told.misfit && noise.size < told.noise.size) told.noise = noise;
    if (!(probability < by_chance) || !(fall > clearest)) continue;
    clearest = fall;
    told = {Misfit{family.where, std::sqrt(fall * variance / double(points)), probability}, noise};
  }
  return told;
}

}  // namespace rosin::analysis::inference
