/// Distances of returns from known attractors, and what is done where a motion comes near none.
#include "analysis/basins/recognition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/cycles/motion_range.hpp"
#include "analysis/cycles/section_map.hpp"
#include "analysis/motion/structure_record.hpp"
#include "analysis/steady/structure_stability.hpp"

namespace rosin::analysis::basins {

using cycles::SectionMap, cycles::StructureCycle;
using motion::Follower;
using oscillators::StructureSystem;

namespace {

constexpr double far_away = 1e6;  ///< in natural sizes, or those of the start: a motion that goes on growing
constexpr double at_rest = 1e-6;  ///< velocity, in natural sizes

/// A motion that comes nearer to an attractor from period to period.
class Approach {
 public:
  void forget() { distances_.clear(); }
  /// True once it is within the radius and was farther away one period before, several returns in turn.
  /// \param floor   distance that the tolerance of steps leaves
  /// \param points  returns in a period
  bool add(double distance, double radius, double floor, std::size_t points) {
    constexpr std::size_t in_turn = 4;
    if (!(distance < radius)) {
      forget();
      return false;
    }
    distances_.push_back(distance);
    if (distances_.size() < points + in_turn) return false;
    for (std::size_t i = distances_.size() - in_turn; i < distances_.size(); ++i)
      if (distances_[i] > floor && distances_[i] >= distances_[i - points]) return false;
    return true;
  }

 private:
  std::vector<double> distances_;
};

}  // namespace

std::string name(Attractor::Kind kind) {
  constexpr const char* names[] = {"steady", "rest", "cycle", "escape", "irregular"};
  return names[int(kind)];
}

Recogniser::Recogniser(oscillators::Structure structure, double tolerance, int most_returns)
    : structure_(std::move(structure)), tolerance_(tolerance), most_returns_(most_returns) {
  SectionMap map(structure_);
  driven_ = map.driven();
  const auto& system = map.system();
  const std::vector<double> origin(system.size());
  std::vector<double> natural(system.size());
  system.scale(origin.data(), natural.data());
  natural_ = Eigen::Map<const Eigen::VectorXd>(natural.data(), system.size());
  known_.resize(first_cycle);
  known_[steady].kind = Attractor::Kind::steady, known_[rest].kind = Attractor::Kind::rest;
  known_[escape].kind = Attractor::Kind::escape, known_[irregular].kind = Attractor::Kind::irregular;
  if (!driven_) find_steady_sliding();
}

/// Leaves steady sliding without a place where it does not attract, or there is none.
void Recogniser::find_steady_sliding() {
  try {
    const auto stability = steady::stability(structure_);
    if (!stability.stable || stability.marginal) return;
    const StructureSystem system(structure_);
    auto& sliding = known_[steady];
    sliding.points = {system.steady(0)};
    // By coordinates and speeds: what else there is follows them.
    sliding.size = Eigen::VectorXd::Constant(system.size(), infinity);
    sliding.size.head(2 * system.coordinates()) = natural_.head(2 * system.coordinates());
    const auto& slowest = stability.modes.front();
    sliding.metrics["growth_rate"] = {slowest.growth_rate(), slowest.error, "1/s"};
    for (int i = 0; i < system.coordinates(); ++i)
      sliding.metrics[structure_.names[std::size_t(i)] + "_mean"] = {stability.coordinates[std::size_t(i)], 0, "m"};
    set_radii();
  } catch (const InputError&) {  // a contact on a surface at rest, or a structure that no spring holds
  }
}

const std::vector<double>& Recogniser::steady_sliding() const {
  if (driven_) throw InputError("under a drive that varies there is no steady sliding to be disturbed");
  if (!sliding_attracts()) {
    const auto stability = steady::stability(structure_);  // which throws where there is none
    throw InputError(
        fmt::format("steady sliding does not attract (growth rate {:.6g} 1/s): every disturbance leaves it",
                    stability.modes.front().growth_rate()));
  }
  return known_[steady].points.front();
}

double Recogniser::distance_from(int attractor, const std::vector<double>& y) const {
  double nearest = infinity;
  for (const auto& point : known_[std::size_t(attractor)].points)
    nearest = std::min(nearest, cycles::distance(y, point, known_[std::size_t(attractor)].size));
  return nearest;
}

/// Well below the distance from any other attractor.
void Recogniser::set_radii() {
  constexpr double largest = 0.05, of_distance = 0.1;
  for (int k = 0; k < int(known_.size()); ++k) {
    double apart = infinity;
    for (int other = 0; other < int(known_.size()); ++other)
      if (other != k)
        for (const auto& point : known_[std::size_t(other)].points) apart = std::min(apart, distance_from(k, point));
    known_[std::size_t(k)].radius = std::min(largest, of_distance * apart);
  }
}

bool Recogniser::stands(const StructureSystem& system, double t, const std::vector<double>& y) const {
  bool all_stick = system.contacts() == system.friction_contacts();
  for (int c = 0; c < system.contacts(); ++c) all_stick = all_stick && system.mode(c) == ContactMode::stick;
  const auto velocity = system.velocity(t, y.data());
  double fastest = 0;
  for (int i = 0; i < system.coordinates(); ++i)
    fastest = std::max(fastest, std::abs(velocity[i]) / natural_[system.coordinates() + i]);
  return all_stick || fastest < at_rest;
}

int Recogniser::recognise(const std::vector<double>& start, double tolerance) const {
  SectionMap map(structure_);
  map.watch(watched_);
  auto& system = map.system();
  const auto n = std::size_t(system.coordinates());
  const double floor = 1e3 * tolerance;
  int label = unknown;
  const auto is_far = [&](const std::vector<double>& y) {
    for (std::size_t i = 0; i < n; ++i)
      if (!(std::abs(y[i]) < far_away * std::max(natural_[Eigen::Index(i)], std::abs(start[i])))) return true;
    return false;
  };
  bool sticks = false, slips = false;  // since the last return
  std::vector<double> end = start, before = start;
  double time = 0;
  const auto observe = [&](Follower::Step& step, std::span<const Follower::Event>) {
    end = step.state(), time = step.time();
    for (int c = 0; c < system.contacts(); ++c) (system.mode(c) == ContactMode::stick ? sticks : slips) = true;
    if (system.contacts() < system.friction_contacts()) slips = true;
  };
  std::vector<Approach> approach(known_.size());
  int rests = 0;
  const auto crossed = [&](int crossing, double, const std::vector<double>& y) {
    if (is_far(y)) label = escape;
    for (int k = 0; k < int(known_.size()) && label == unknown; ++k) {
      auto& coming = approach[std::size_t(k)];
      const auto& attractor = known_[std::size_t(k)];
      if (attractor.points.empty()) continue;
      if (k == steady && sticks) coming.forget();
      if (coming.add(distance_from(k, y), attractor.radius, floor, attractor.points.size())) label = k;
    }
    // Held by all its contacts a driven structure may still return, to where it was.
    constexpr int long_enough = 3;
    rests = !slips && cycles::distance(y, before, natural_) < at_rest ? rests + 1 : 0;
    if (label == unknown && rests == long_enough) label = rest;
    sticks = slips = false;
    before = y;
    return label != unknown || crossing >= most_returns_;
  };
  const auto outcome = map.follow_crossings(start, tolerance, crossed, observe);
  if (label != unknown) return label;
  if (outcome.ending == Ending::unbounded || is_far(end)) return escape;
  if (outcome.ending != Ending::reached_end) return unknown;
  if (sliding_attracts() && distance_from(steady, end) < known_[steady].radius) return steady;
  return stands(system, time, end) ? int(rest) : int(unknown);
}

Recogniser::Identified Recogniser::identify(const std::vector<double>& start) const {
  cycles::StructureCycleOptions options;
  options.tolerance = tolerance_, options.max_cycles = most_returns_;
  motion::StructureModel model{structure_, {}};
  model.start.unknowns = start;
  StructureCycle cycle;
  try {
    cycle = cycles::find_cycle(model, options);
  } catch (const InputError& error) {
    cycle.outcome = {Ending::none_exists, error.what()};
  }
  constexpr double contraction = 1e-5;
  const bool attracts = cycle.multipliers.empty() || std::abs(cycle.multipliers.front()) < 1 - contraction;
  if (cycle.returns > 0 && attracts) return {unknown, std::move(cycle), ""};
  if (cycle.returns > 0) return {irregular, {}, "periodic motion that does not attract: beside it there are others"};
  if (cycle.outcome.ending == Ending::unbounded) return {escape, {}, ""};
  return {irregular, {}, cycle.outcome.detail};
}

int Recogniser::add(const Identified& found) {
  if (!found.cycle) {
    auto& detail = known_[std::size_t(found.label)].detail;
    if (detail.empty()) detail = found.detail;
    return found.label;
  }
  const auto& cycle = *found.cycle;
  for (int k = first_cycle; k < int(known_.size()); ++k)
    if (is_same(known_[std::size_t(k)], cycle)) return k;
  if (known_.size() == first_cycle)
    watched_ = cycles::coordinate_of_section(structure_, [&](int i) {
      return (cycle.coordinate_max[std::size_t(i)] - cycle.coordinate_min[std::size_t(i)]) / natural_[i];
    });
  Attractor attractor;
  attractor.kind = Attractor::Kind::cycle;
  attractor.metrics = cycle.metrics;
  for (std::size_t c = 0; c < cycle.columns.size(); ++c)
    for (const auto& coordinate : structure_.names)
      if (cycle.column_names[c] == coordinate || cycle.column_names[c] == motion::velocity_name(coordinate))
        attractor.orbit[cycle.column_names[c]] = cycle.columns[c];
  take_section_of(cycle, attractor);
  known_.push_back(std::move(attractor));
  set_radii();
  return int(known_.size()) - 1;
}

/// By its period and the extremes of its coordinates: under a periodic drive one motion may begin at several of its
/// points.
bool Recogniser::is_same(const Attractor& known, const StructureCycle& cycle) const {
  constexpr double same = 1e-4;
  const auto differs = [&](const std::string& name, double size) {
    return std::abs(known.metrics.at(name).value - cycle.metrics.at(name).value) > same * size;
  };
  double widest = 0;
  for (std::size_t i = 0; i < cycle.coordinate_max.size(); ++i)
    widest = std::max(widest, cycle.coordinate_max[i] - cycle.coordinate_min[i]);
  return !differs("period", cycle.metrics.at("period").value) &&
         std::ranges::none_of(structure_.names, [&](const std::string& coordinate) {
           return differs(coordinate + "_max", widest) || differs(coordinate + "_min", widest);
         });
}

/// The points of the section that a period goes through.
void Recogniser::take_section_of(const StructureCycle& cycle, Attractor& attractor) const {
  SectionMap map(structure_);
  map.watch(watched_);
  cycles::MotionRange range(map.system());
  range.begin(cycle.start);
  constexpr double aside = 1e-6;
  const double period = cycle.metrics.at("period").value;
  map.follow_crossings(
      cycle.start, step_tolerance(),
      [&](int crossing, double t, const std::vector<double>& y) {
        if (!driven_ && t > (1 + aside) * period) return true;
        attractor.points.push_back(y);
        return driven_ ? crossing >= cycle.returns : t > (1 - aside) * period;
      },
      [&](Follower::Step& step, std::span<const Follower::Event>) { range.add(step.state()); });
  if (attractor.points.empty()) attractor.points = {cycle.start};
  attractor.size = range.size();
}

}  // namespace rosin::analysis::basins
