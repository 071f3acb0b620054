/// Interpolation between the cycles of a tile.
#include "analysis/lanes/neighbours.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/lanes/interpolant.hpp"

namespace rosin::analysis::lanes {

using Eigen::MatrixXd;
using Eigen::VectorXd;

int phase_of(int column, int row, int coarsest) {
  const auto power = [&](int i) {
    int p = 1;
    while (p < coarsest && i % (2 * p) == 0) p *= 2;
    return p;
  };
  const int x = power(column), y = power(row), stride = std::min(x, y);
  int level = 0;
  for (int s = coarsest; s > stride; s /= 2) ++level;
  return 2 * level - (level > 0 && x != y);
}

int Tile::place(const GridPlace& at) {
  const auto [found, is_new] = rows_[at.row].try_emplace(at.column, int(points_.size()));
  if (is_new) {
    columns_[at.column][at.row] = found->second;
    points_.push_back({at.column, at.row, at.phase});
  }
  return found->second;
}

std::vector<Tile::Neighbour> Tile::line(int point, bool along_row) const {
  constexpr int most = 2;  // on either side
  const Point& here = points_[point];
  const auto& all = along_row ? rows_.at(here.row) : columns_.at(here.column);
  const int at = along_row ? here.column : here.row;
  std::vector<Neighbour> found;
  const auto takes = [&](const auto& entry) {
    const Point& other = points_[entry.second];
    if (!other.cycle && !(other.looked_for && other.phase < here.phase)) return false;
    found.push_back({entry.first - at, entry.second});
    return true;
  };
  int count = 0;
  for (auto it = all.upper_bound(at); it != all.end() && count < most; ++it) count += takes(*it);
  count = 0;
  for (auto it = std::make_reverse_iterator(all.lower_bound(at)); it != all.rend() && count < most; ++it)
    count += takes(*it);
  std::ranges::stable_sort(found, {}, [](const Neighbour& n) { return std::abs(n.distance); });
  return found;
}

std::optional<KnownCycle> Tile::advice(int point, std::span<const std::vector<Neighbour>> lines) const {
  constexpr double farthest = 3;  // sum of absolute weights beyond which extrapolation is unreliable
  struct Adviser {
    double weight;
    const KnownCycle* cycle;
    bool near;  ///< one of the two nearest on its line, whose errors are alike
  };
  std::vector<Adviser> advisers;
  struct Derivative {
    MatrixXd value;
    double error;
  };
  std::vector<Derivative> derivatives;  // one for each line
  for (auto line : lines) {
    std::erase_if(line, [&](const Neighbour& n) { return !points_[n.point].cycle; });
    if (line.size() < 2) continue;
    const auto known = [&](std::size_t k) -> const KnownCycle& { return *points_[line[k].point].cycle; };
    for (std::size_t k = 1; k < line.size(); ++k)
      if (known(k).fixed_point.size() != known(0).fixed_point.size()) return std::nullopt;  // of another kind
    std::vector<int> places;
    for (const auto& n : line) places.push_back(n.distance);
    const auto weights = lagrange_weights(places, 0);
    double sum = 0;
    for (const double weight : weights) sum += std::abs(weight);
    if (sum > farthest) continue;
    // Errors of cubics grow with the fourth power of the distance.
    for (std::size_t k = 0; k < line.size(); ++k)
      advisers.push_back({weights[k] * std::pow(line.front().distance, -4.0), &known(k), k < 2});
    const auto derivative_through = [&](std::size_t count) {
      const auto through = lagrange_weights({places.begin(), places.begin() + long(count)}, 0);
      MatrixXd sum = through[0] * known(0).derivative;
      for (std::size_t k = 1; k < count; ++k) sum += through[k] * known(k).derivative;
      return sum;
    };
    const MatrixXd all = derivative_through(line.size());
    // The change by one more point, or half of the value.
    double error = 0.5 * (known(0).derivative - known(1).derivative).norm();
    if (line.size() > 2) error = std::min(error, (all - derivative_through(line.size() - 1)).norm());
    for (std::size_t k = 0; k < line.size(); ++k) error = std::max(error, known(k).derivative_error);
    derivatives.push_back({all, error});
  }
  if (advisers.empty()) return std::nullopt;
  KnownCycle advice = *advisers.front().cycle;
  advice.fixed_point.setZero();
  advice.derivative.setZero();
  advice.sensitivity.setZero();
  advice.derivative_error = 0;
  const int halvings = (points_[point].phase + 1) / 2;
  const bool found_anew = halvings % 3 == 1;
  if (found_anew) advice.error_rate.resize(0);
  advice.expected_rate = 0;
  double sum = 0;
  for (const auto& [weight, cycle, near] : advisers) {
    if (cycle->fixed_point.size() != advice.fixed_point.size()) return std::nullopt;  // of another kind
    advice.fixed_point += weight * cycle->fixed_point;
    advice.derivative += weight * cycle->derivative;
    advice.sensitivity += weight * cycle->sensitivity;
    advice.amplitude = std::min(advice.amplitude, cycle->amplitude);
    if (near && cycle->error_rate.size() == 0) advice.error_rate.resize(0);
    if (near && advice.error_rate.size() > 0) advice.error_rate = advice.error_rate.cwiseMax(cycle->error_rate);
    if (near && cycle->error_rate.size() > 0)
      advice.expected_rate = std::max(advice.expected_rate, cycle->error_rate.maxCoeff());
    sum += weight;
  }
  advice.fixed_point /= sum;
  advice.derivative /= sum;
  advice.sensitivity /= sum;
  for (const auto& [value, error] : derivatives)
    advice.derivative_error = std::max({advice.derivative_error, error, (value - advice.derivative).norm()});
  return advice;
}

Neighbours::Neighbours(std::span<const std::size_t> members, std::span<const GridPlace> places) : places_(places) {
  std::map<std::pair<Tile*, int>, std::size_t> who;
  for (const std::size_t i : members) {
    members_[i];
    if (places.empty()) continue;
    Tile& tile = *places[i].tile;
    const int point = members_[i].point = tile.place(places[i]);
    tile[point].looked_for = true;
    who[{&tile, point}] = i;
  }
  for (auto& [i, member] : members_) {
    for (const bool along_row : {true, false}) {
      if (places.empty()) break;
      Tile& tile = *places[i].tile;
      member.lines[along_row] = tile.line(member.point, along_row);
      for (const auto& neighbour : member.lines[along_row])
        if (const auto other = who.find({&tile, neighbour.point}); other != who.end()) {
          ++member.waits_for;
          members_[other->second].waiting.push_back(i);
        }
    }
    if (member.waits_for == 0) make_ready(i);
  }
  for (const auto& [at, i] : who) (*at.first)[at.second].looked_for = false;
}

void Neighbours::make_ready(std::size_t i) {
  if (places_.empty()) return void(ready_.insert({0, 0, i}));
  const Member& member = members_.at(i);
  Tile& tile = *places_[i].tile;
  long longest = 0;
  for (const auto& line : member.lines)
    for (const auto& neighbour : line) longest = std::max(longest, tile[neighbour.point].tries);
  ready_.insert({places_[i].phase, longest, i});
}

std::optional<std::size_t> Neighbours::next() {
  if (ready_.empty()) return std::nullopt;
  const std::size_t i = ready_.begin()->slider;
  ready_.erase(ready_.begin());
  return i;
}

std::optional<KnownCycle> Neighbours::advice(std::size_t i) const {
  if (places_.empty()) return std::nullopt;
  const Member& member = members_.at(i);
  return places_[i].tile->advice(member.point, member.lines);
}

void Neighbours::finished(std::size_t i, std::optional<KnownCycle> cycle, long tries) {
  if (places_.empty()) return;
  const Member& member = members_.at(i);
  auto& point = (*places_[i].tile)[member.point];
  point.cycle = std::move(cycle);
  point.tries = tries;
  for (const std::size_t other : member.waiting)
    if (--members_.at(other).waits_for == 0) make_ready(other);
}

}  // namespace rosin::analysis::lanes
