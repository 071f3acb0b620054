/// Ring-down: a machine is displaced and let go. Each swing has a frequency and a damping ratio of its own, since
/// joints that slip grow softer with the amplitude and damp in proportion to the loop of friction.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/lab/tools.hpp"
#include "analysis/motion/follower.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/structure_stability.hpp"

namespace rosin::analysis::lab {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using motion::Follower;
using oscillators::Structure;

/// The machine on surfaces at rest, which nothing drives.
Structure left_alone(const Task& task) {
  Task free = task;
  free.model.drive.speed = 0.0, free.model.drive.force = 0.0;
  auto structure = steady::frozen(free.structure ? *free.structure : oscillators::one_slider(free.model));
  for (auto& contact : structure.contacts) contact.speed = 0.0;
  return structure;
}

/// The slowest oscillation of the machine while its joints stick.
struct Mode {
  double period;   ///< s
  VectorXd shape;  ///< 1 where it moves most
};

Mode slowest_mode(const Structure& structure) {
  MatrixXd K = (structure.K + structure.K.transpose()) / 2;
  for (const auto& contact : structure.contacts) {
    const double load = contact.load_factor * contact.normal_load.level();
    if (!contact.frictionless() && contact.stiffness.present() && load > 0)
      K += contact.tangential * contact.tangential.transpose() / contact.stiffness.compliance(load);
  }
  std::vector<int> heavy, massless;
  for (int i = 0; i < structure.size(); ++i) (structure.M(i, i) > 0 ? heavy : massless).push_back(i);
  if (heavy.empty()) throw InputError("ring-down needs a mass: a machine without one does not swing");
  // Coordinates without mass follow at once.
  const MatrixXd follow = massless.empty()
                              ? MatrixXd(0, Eigen::Index(heavy.size()))
                              : MatrixXd(-MatrixXd(K(massless, massless)).ldlt().solve(MatrixXd(K(massless, heavy))));
  const MatrixXd condensed =
      massless.empty() ? MatrixXd(K(heavy, heavy)) : MatrixXd(K(heavy, heavy) + MatrixXd(K(heavy, massless)) * follow);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(condensed, MatrixXd(structure.M(heavy, heavy)));
  constexpr double rigid = 1e-12;  // of the largest eigenvalue
  for (Eigen::Index m = 0; m < modes.eigenvalues().size(); ++m) {
    const double square = modes.eigenvalues()[m];
    if (!(square > rigid * modes.eigenvalues().cwiseAbs().maxCoeff()) || !(square > 0)) continue;
    VectorXd shape = VectorXd::Zero(structure.size());
    shape(heavy) = modes.eigenvectors().col(m);
    if (!massless.empty()) shape(massless) = follow * modes.eigenvectors().col(m);
    Eigen::Index most = 0;
    shape.cwiseAbs().maxCoeff(&most);
    return {2 * std::numbers::pi / std::sqrt(square), shape / shape[most]};
  }
  throw InputError("ring-down needs a spring: nothing brings this machine back");
}

/// Moments at which a coordinate turns, by its velocity: the start, then up to so many, until `longest`.
std::vector<double> turns(const motion::StructureModel& model, int coordinate, int most, double period, double longest,
                          double tolerance) {
  constexpr double aside = 0.01;  // of a period, in which no swing of the coordinate turns back
  oscillators::StructureSystem system(model.structure);
  std::vector<double> y = motion::starting_point(system, model.start), scale(y.size()), found = {0};
  system.scale(y.data(), scale.data());
  double side = y[std::size_t(coordinate)] > 0 ? -1 : 1;  // of the velocity until the next turn
  for (; int(found.size()) <= most; side = -side) {
    const motion::Section turning{
        .value = [&](double time, const double* at) { return side * system.velocity(time, at)[coordinate]; },
        .scale = scale[std::size_t(system.coordinates() + coordinate)],
        .crossed = [](double, const std::vector<double>&) { return true; }};
    Follower follower(system, tolerance);
    const double begin = found.back() + aside * period;
    if (!follower.follow(found.back(), y, begin).complete()) break;
    // Where it rests, it does so for good.
    if (follower.follow(begin, y, longest, &turning).ending != Ending::event) break;
    found.push_back(follower.time());
  }
  return found;
}

/// Each swing between three turns.
std::vector<Reading> swings(const Record& record, const std::string& column, const std::vector<double>& turn,
                            const std::vector<double>& turn_error) {
  const auto& x = record.column(column);
  std::vector<Extreme> extremes;
  for (std::size_t i = 1; i + 1 < turn.size(); ++i) {
    const auto at = std::ranges::lower_bound(record.time, turn[i]) - record.time.begin();
    const auto before = std::ranges::lower_bound(record.time, turn[i - 1]) - record.time.begin();
    const bool maximum = at < std::ptrdiff_t(x.size()) && x[std::size_t(at)] > x[std::size_t(before)];
    extremes.push_back(extreme(record, x, {(turn[i - 1] + turn[i]) / 2, (turn[i] + turn[i + 1]) / 2, maximum}));
  }
  std::vector<Reading> readings;
  for (std::size_t i = 0; i + 2 < extremes.size(); ++i) {
    const double first = std::abs(extremes[i + 1].value - extremes[i].value),
                 second = std::abs(extremes[i + 2].value - extremes[i + 1].value);
    const double duration = extremes[i + 2].time - extremes[i].time, decrement = std::log(first / second);
    readings.push_back({"amplitude", "m", "", std::sqrt(first * second) / 2});
    readings.push_back(
        {"frequency", "Hz", "", 1 / duration, (turn_error[i + 1] + turn_error[i + 3]) / (duration * duration)});
    readings.push_back({"damping_ratio", "1", "", decrement / std::hypot(decrement, std::numbers::pi)});
  }
  return readings;
}

Result perform_ring_down(const Task& task) {
  Result result;
  const auto& settings = task.settings;
  motion::StructureModel model{left_alone(task), {}};
  const auto mode = slowest_mode(model.structure);
  VectorXd shape = mode.shape;
  if (settings.given("shape")) {
    const auto& list = settings.list("shape");
    if (int(list.size()) != model.structure.size())
      throw InputError(
          fmt::format("lab.shape has {} numbers, and the machine {} coordinates", list.size(), model.structure.size()));
    shape = Eigen::Map<const VectorXd>(list.data(), Eigen::Index(list.size()));
  }
  Eigen::Index most = 0;
  if (!(shape.cwiseAbs().maxCoeff(&most) > 0)) throw InputError("lab.shape displaces nothing");
  const VectorXd displaced = settings.number("amplitude") / std::abs(shape[most]) * shape;
  model.start.kind = motion::Start::Kind::rest;
  model.start.coordinates.assign(displaced.begin(), displaced.end());
  model.start.velocities.assign(std::size_t(displaced.size()), 0.0);

  constexpr double slower = 2, finer = 1.0 / 30;  // joints that slip are softer
  const int count = settings.count("swings"), samples = 2 * settings.count("samples");
  const double longest = slower * (count + 1) * mode.period;
  const auto turn = turns(model, int(most), 2 * count + 2, mode.period, longest, finer * task.tolerance),
             coarse = turns(model, int(most), 2 * count + 2, mode.period, longest, task.tolerance);
  std::vector<double> turn_error;
  for (std::size_t i = 0; i < turn.size(); ++i)
    turn_error.push_back(i < coarse.size() ? std::abs(turn[i] - coarse[i]) : infinity);
  std::vector<double> times = {0};
  for (std::size_t i = 1; i < turn.size(); ++i)
    for (int k = 1; k <= samples; ++k)
      times.push_back(
          k == samples ? turn[i] : std::lerp(turn[i - 1], turn[i], (1 - std::cos(std::numbers::pi * k / samples)) / 2));
  if (turn.size() < 2) times.push_back(mode.period);
  const bool jumps = std::ranges::any_of(model.structure.contacts, [](const auto& c) { return c.law->set_valued(); });
  record_run(result, task,
             {[&model](const motion::RunOptions& options) { return motion::run_structure(model, options); }, jumps}, {},
             times);
  if (task.sensor.ideal()) result.record.breaks.insert(result.record.breaks.end(), turn.begin(), turn.end());
  if (!result.outcome.complete()) return result;
  constexpr std::size_t fewest = 5;  // turns of one swing after the first half, and what shows the last of them
  if (turn.size() < fewest) {
    result.warnings.push_back(fmt::format(
        "the machine comes to rest after {} turns: give lab.amplitude more, for frequency and damping of a swing",
        turn.size() - 1));
    return result;
  }
  const auto& column = model.structure.names[std::size_t(most)];
  read_off(result, task.sensor, [&](const Record& seen) { return swings(seen, column, turn, turn_error); });
  Table table{"swings",
              {"amplitude", "frequency", "damping_ratio", "amplitude_error", "frequency_error", "damping_ratio_error"},
              {"m", "Hz", "1", "m", "Hz", "1"},
              std::vector<std::vector<double>>(6)};
  for (std::size_t i = 0; i < result.readings.size(); ++i) {
    table.values[i % 3].push_back(result.readings[i].value);
    table.values[3 + i % 3].push_back(result.readings[i].error);
  }
  result.readings.clear();
  const auto add = [&](const char* name, const char* unit, const char* meaning, std::size_t quantity, std::size_t row) {
    result.readings.push_back({name, unit, meaning, table.values[quantity][row], table.values[3 + quantity][row]});
  };
  const std::size_t last = table.values[0].size() - 1;
  const auto most_damped = std::size_t(std::ranges::max_element(table.values[2]) - table.values[2].begin());
  add("amplitude_first", "m", "amplitude of the first swing, after half of one", 0, 0);
  add("frequency_first", "Hz", "frequency of the first swing", 1, 0);
  add("damping_ratio_first", "1", "damping ratio of the first swing", 2, 0);
  add("amplitude_last", "m", "amplitude of the last swing", 0, last);
  add("frequency_last", "Hz", "frequency of the last swing", 1, last);
  add("damping_ratio_last", "1", "damping ratio of the last swing", 2, last);
  add("damping_ratio_max", "1", "largest damping ratio", 2, most_damped);
  add("amplitude_of_most_damping", "m", "amplitude at which it is", 0, most_damped);
  const auto& seen = result.record;
  result.panels = {{.x_label = "time",
                    .x_unit = "s",
                    .y_label = "displacement x",
                    .y_unit = "m",
                    .curves = {{"", seen.time, seen.column(column)}}},
                   {.x_label = "amplitude X",
                    .x_unit = "m",
                    .y_label = "frequency f",
                    .y_unit = "Hz",
                    .x_decades = true,
                    .curves = {{"", table.values[0], table.values[1], true}}},
                   {.x_label = "amplitude X",
                    .x_unit = "m",
                    .y_label = "damping ratio ζ",
                    .y_unit = "1",
                    .x_decades = true,
                    .curves = {{"", table.values[0], table.values[2], true}}}};
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace

Experiment ring_down() {
  return {.name = "ring-down",
          .title = "Ring-down",
          .settings = {{.quantity = {"amplitude", "m", {1e-12, 1e3}, "displacement from which the machine is let go"},
                        .value = 1e-3},
                       {.quantity = {"swings", "1", {1, 10'000}, "swings that are read, unless it comes to rest"},
                        .value = 20.0,
                        .whole = true},
                       {.quantity = {"shape",
                                     "1",
                                     {-1e12, 1e12},
                                     "displacement of each coordinate; else the slowest mode while joints stick",
                                     Scale::linear,
                                     true}},
                       {.quantity = {"samples", "1", {8, 1e5}, "pairs of samples of each half swing"},
                        .value = 32.0,
                        .whole = true}},
          .slider = {.mass = 1, .stiffness = 1e3, .damping = 0},
          .drive = {.speed = 0.0, .normal_load = 1.0, .force = 0.0},
          .extra_columns = {},
          .prescribed = {"drive.speed", "drive.force", "oscillator.force"},
          .protocol = perform_ring_down};
}

}  // namespace rosin::analysis::lab
