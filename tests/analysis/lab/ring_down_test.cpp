/// Ring-downs in closed form: a damper, dry friction, and a joint that yields behind a spring.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/lab/experiment.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::lab;

namespace {

constexpr double pi = std::numbers::pi;

Task task_of(std::vector<Value> coulomb, double load, double damping = 0) {
  auto task = task_for(find_experiment("ring-down"), laws::find_law("coulomb")->with(std::move(coulomb)));
  task.model.slider = {2, 50, damping};
  task.model.drive.normal_load = load;
  task.settings.set("amplitude", 0.1);
  return task;
}

Table swings_of(const Task& task) {
  const auto result = find_experiment("ring-down").perform(task);
  INFO(result.outcome.detail);
  REQUIRE(result.outcome.complete());
  REQUIRE(result.tables.size() == 1);
  return result.tables[0];
}

void check(const Table& table, std::size_t column, std::size_t row, double expected) {
  INFO(table.columns[column] << " of swing " << row);
  const double value = table.values[column][row], error = table.values[column + 3][row];
  CHECK(error < 1e-6 * std::abs(expected));
  CHECK(std::abs(value - expected) <= error + 1e-12 * std::abs(expected));
}

}  // namespace

TEST_CASE("a damper takes the same part of each swing", "[lab]") {
  auto task = task_of({0.3, 0.3}, 1e-12, 0.4);
  const auto table = swings_of(task);
  REQUIRE(table.values[0].size() == 39);
  const double ratio = 0.4 / (2 * std::sqrt(2.0 * 50)), frequency = std::sqrt(25 * (1 - ratio * ratio)) / (2 * pi);
  for (const std::size_t row : {0, 10, 30}) {
    check(table, 1, row, frequency);
    check(table, 2, row, ratio);
  }
}

TEST_CASE("dry friction takes the same length of each swing, and leaves the frequency", "[lab]") {
  const double f = 0.3 * 0.5, lost = 2 * f / 50;  // m, of a turn's displacement by the next
  const auto table = swings_of(task_of({0.3, 0.3}, 0.5));
  for (const std::size_t row : {0, 5, 10}) {
    // Ranges of half swings after the first turn at −(0.1 − lost).
    const double first = 2 * (0.1 - lost * (double(row) + 1)) - lost, second = first - 2 * lost;
    const double decrement = std::log(first / second);
    check(table, 0, row, std::sqrt(first * second) / 2);
    check(table, 1, row, 5 / (2 * pi));
    check(table, 2, row, decrement / std::hypot(decrement, pi));
  }
}

TEST_CASE("a joint that yields is softer and damps more at large amplitudes, piece by piece exact", "[lab]") {
  const double m = 2, k = 50, joint = 30, f = 0.6;
  auto task = task_of({0.3, 0.3}, 2.0);
  task.model.contact_stiffness.tangential = joint;
  const auto table = swings_of(task);
  // From a turn at x, where the joint bears −f: stick until it bears f, and then slip about f/k.
  double x = 0;
  const double stuck = std::sqrt((k + joint) / m), free = std::sqrt(k / m);
  const auto half_swing = [&](double& turn) {
    const double middle = (f - joint * turn) / (k + joint), reach = turn + middle;  // of the oscillation in stick
    const double way = 2 * f / joint;
    if (way >= 2 * reach) return turn = 2 * reach - turn, pi / stuck;
    const double angle = std::acos(1 - way / reach), speed = stuck * reach * std::sin(angle);
    const double left = turn - way - f / k;
    const double amplitude = std::hypot(left, speed / free);
    const double duration = angle / stuck + (pi - std::atan2(speed / free, left)) / free;
    // At the turn on the other side.
    turn = amplitude - f / k;
    return duration;
  };
  // The first half swing begins with a joint that is relaxed.
  {
    const double middle = joint * 0.1 / (k + joint), reach = 0.1 - middle, way = f / joint;
    const double angle = std::acos(1 - way / reach), speed = stuck * reach * std::sin(angle);
    x = std::hypot(0.1 - way - f / k, speed / free) - f / k;
  }
  std::vector<double> turns = {x}, durations;
  for (int i = 0; i < 8; ++i) durations.push_back(half_swing(x)), turns.push_back(x);
  for (const std::size_t row : {0, 1, 2, 4}) {
    const double first = turns[row] + turns[row + 1], second = turns[row + 1] + turns[row + 2];
    const double decrement = std::log(first / second);
    check(table, 0, row, std::sqrt(first * second) / 2);
    check(table, 1, row, 1 / (durations[row] + durations[row + 1]));
    check(table, 2, row, decrement / std::hypot(decrement, pi));
  }
}

TEST_CASE("a ring-down that sticks at once, and shapes that do not fit, are told", "[lab]") {
  auto task = task_of({0.3, 0.3}, 50);
  const auto result = find_experiment("ring-down").perform(task);
  CHECK(result.tables.empty());
  REQUIRE(result.warnings.size() == 1);
  CHECK_THAT(result.warnings[0], Catch::Contains("comes to rest after 0 turns"));
  task.settings.set("shape", std::vector<double>{1, 2});
  CHECK_THROWS_WITH(find_experiment("ring-down").perform(task), Catch::Contains("lab.shape has 2 numbers"));
  auto loose = task_of({0.3, 0.3}, 1);
  loose.model.slider = {2, 0, 0.4};
  CHECK_THROWS_WITH(find_experiment("ring-down").perform(loose), Catch::Contains("needs a spring"));
}
