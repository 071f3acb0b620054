/// Basins against counts of independent integrations, and their border against the unstable cycle that forms it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/basins/basins.hpp"
#include "analysis/branches/branches.hpp"
#include "analysis/cycles/section_map.hpp"
#include "core/stop.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::basins;
using Kind = Attractor::Kind;

namespace {

using oscillators::Model;

/// m = k = 1 under a load of 1 N.
Model block(const char* law, std::vector<Value> parameters, double damping, double speed) {
  Model model;
  model.law = laws::find_law(law)->with(parameters);
  model.slider = {1, 1, damping};
  model.drive.normal_load = 1.0, model.drive.speed = speed;
  return model;
}

/// Friction 0.5 + 0.5 e^(−|v|/0.5), damping 0.1, m = k = N = 1: sliding attracts above 0.5 ln 10 = 1.1513, and
/// stick-slip exists beside it up to 1.8366.
Model two_motions(double speed) { return block("stribeck", {1.0, 0.5, 0.5, 1.0, 0.0}, 0.1, speed); }

std::vector<double> start_at(const oscillators::Structure& structure, double x, double v) {
  return oscillators::StructureSystem(structure).unknowns_at(0, Eigen::VectorXd::Constant(1, x),
                                                             Eigen::VectorXd::Constant(1, v));
}

std::vector<std::vector<double>> random_starts(const oscillators::Structure& structure, int count) {
  std::vector<std::vector<double>> starts;
  for (const auto& [a, b] : random_places(count, 1)) starts.push_back(start_at(structure, -2 + 4 * a, 2 * b));
  return starts;
}

const Basins::Basin& of(const Basins& found, Kind kind) {
  for (const auto& basin : found.basins)
    if (basin.attractor.kind == kind) return basin;
  FAIL("no " << name(kind));
  return found.basins.front();
}

}  // namespace

TEST_CASE("the share of stick-slip beside stable sliding", "[basin]") {
  // 0.6957 ± 0.0046 of 10 000 starts, counted independently.
  BasinTask task;
  const auto structure = oscillators::one_slider(two_motions(1.5));
  task.starts = random_starts(structure, 400);
  const auto found = find_basins(structure, task);
  REQUIRE(found.outcome.complete());
  REQUIRE(found.basins.size() == 2);
  const auto& sticks = of(found, Kind::cycle);
  CHECK(sticks.error == Approx(std::sqrt(0.6957 * 0.3043 / 400)).epsilon(0.05));
  CHECK(std::abs(sticks.share - 0.6957) < 3 * sticks.error);
  CHECK(std::abs(sticks.share + of(found, Kind::steady).share - 1) < 1e-14);
}

TEST_CASE("the smallest blow that ends steady sliding reaches just the unstable cycle", "[basin]") {
  const Model model = two_motions(1.5);
  const auto structure = oscillators::one_slider(model);
  const oscillators::StructureSystem system(structure);
  const double steady = system.steady(0)[0];
  // The unstable cycle of the branch, where it passes the place of steady sliding.
  analysis::branches::BranchOptions options;
  options.parameter = {1, 2, false}, options.at = {1.5};
  const auto branches = analysis::branches::from_steady_sliding(
      [&](double p) { return analysis::branches::oscillator_of(model.with("drive.speed", p)); }, options);
  double wanted = NAN;
  for (const auto& cycle : branches.cycles)
    for (const auto& point : cycle.branch.points) {
      if (!point.asked || point.view.stable) continue;
      oscillators::StructureSystem follows(structure);
      analysis::motion::Follower follower(follows, 1e-11);
      analysis::motion::Section section;
      section.value = [&](double, const double* y) { return steady - y[0]; };
      section.crossed = [&](double t, const std::vector<double>& y) {
        wanted = follows.velocity(t, y.data())[0];
        return true;
      };
      auto y = point.view.start;
      follower.follow(0, y, 10, &section);
    }
  REQUIRE(wanted > 0);
  BasinTask task;
  task.disturbance = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), 0, 2, 11};
  for (const double tolerance : {1e-6, 1e-8}) {
    task.tolerance = tolerance;
    const auto found = find_basins(structure, task);
    REQUIRE(found.threshold);
    CHECK(found.threshold->error < 3 * tolerance);
    CHECK(std::abs(found.threshold->value - wanted) < found.threshold->error);
    CHECK(found.basins[std::size_t(found.threshold->beyond)].attractor.kind == Kind::cycle);
  }
}

TEST_CASE("one force, two motions: starts tell them apart", "[basin]") {
  // Shaw (1986): stops at ±0.662376319, or at 0.115658177 and 1.119949243; pieces in closed form.
  auto model = block("coulomb", {0.45, 0.2}, 0, 0);
  model.drive.force = Signal(Signal::Harmonics{0, {{1, 0.19, 0}}});
  const auto structure = oscillators::one_slider(model);
  BasinTask task;
  for (const double x : {0.0, 0.66, 0.1, 0.6}) task.starts.push_back(start_at(structure, x, 0));
  const auto found = find_basins(structure, task);
  REQUIRE(found.basins.size() == 2);
  CHECK(found.labels[0] != found.labels[1]);
  const auto largest = [&](int start) {
    return found.basins[std::size_t(found.labels[std::size_t(start)])].attractor.metrics.at("displacement_max").value;
  };
  for (const int start : {0, 2}) CHECK(std::abs(largest(start) - 1.119949243) < 1e-9);
  for (const int start : {1, 3}) CHECK(std::abs(largest(start) - 0.662376319) < 1e-9);
}

TEST_CASE("what rests and what grows without bound are told apart", "[basin]") {
  // m x″ = x − μ sgn x′: from rest it stays within |x| ≤ μ_s, and leaves for ever beyond.
  auto structure = oscillators::one_slider(block("coulomb", {0.5, 0.5}, 0.1, 0));
  structure.K(0, 0) = -1;
  BasinTask task;
  for (const double x : {-0.6, -0.49, 0.0, 0.49, 0.51, 2.0}) task.starts.push_back(start_at(structure, x, 0));
  const auto found = find_basins(structure, task);
  REQUIRE(found.basins.size() == 2);
  CHECK(found.basins[0].attractor.kind == Kind::rest);
  CHECK(found.basins[1].attractor.kind == Kind::escape);
  CHECK(found.labels == std::vector<int>{1, 0, 0, 0, 1, 1});
}

TEST_CASE("what no start settles on is counted as irregular: undamped sliding swings as it started", "[basin]") {
  const auto structure = oscillators::one_slider(block("coulomb", {0.5, 0.5}, 0, 1));
  BasinTask task;
  task.most_returns = 100;
  for (const double x : {0.6, 1.0, 1.4}) task.starts.push_back(start_at(structure, x, 0));
  const auto found = find_basins(structure, task);
  REQUIRE(found.basins.size() == 1);
  CHECK(found.basins[0].attractor.kind == Kind::irregular);
  CHECK_THAT(found.basins[0].attractor.detail, Catch::Contains("no period within 100 returns"));
}

TEST_CASE("labels do not depend on the number of threads", "[basin]") {
  const auto structure = oscillators::one_slider(two_motions(1.5));
  BasinTask task;
  task.starts = random_starts(structure, 60);
  const auto one = find_basins(structure, task);
  task.threads = 3;
  CHECK(find_basins(structure, task).labels == one.labels);
}

TEST_CASE("a basin that is asked to stop keeps the starts that are done", "[basin]") {
  const auto structure = oscillators::one_slider(two_motions(1.5));
  BasinTask task;
  task.starts = random_starts(structure, 60);
  std::stop_source source;
  const Listening listening(source.get_token());
  const auto found = find_basins(structure, task, [&](std::size_t done, std::size_t total) {
    CHECK(total == 60);
    if (done == 30) source.request_stop();
  });
  CHECK(found.outcome.ending == Ending::interrupted);
  CHECK(found.labels.size() == 60);
  CHECK(std::ranges::count(found.labels, -1) == 30);
}

TEST_CASE("steady sliding that repels has no disturbance that returns", "[basin]") {
  BasinTask task;
  task.disturbance = {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), 0, 2, 11};
  CHECK_THROWS_WITH(find_basins(oscillators::one_slider(two_motions(1.0)), task), Catch::Contains("does not attract"));
  const auto fast = find_basins(oscillators::one_slider(two_motions(1.9)), task);
  CHECK_FALSE(fast.threshold);
  CHECK(fast.no_threshold == "every disturbance from 0 to 2 returns to steady sliding");
}

TEST_CASE("two coupled blocks end where long motions do", "[basin]") {
  const auto contact = oscillators::contact_of(two_motions(1.3));
  const auto structure = oscillators::chain({{1, 1}, {1.2}, {0.02}, {1, 1.1}, {0.1, 0.1}}, {contact, contact});
  const oscillators::StructureSystem system(structure);
  BasinTask task;
  for (const auto& [x, v] : {std::pair{0.5, 0.0}, {0.8, 0.3}, {-1.5, 1.0}, {2.5, -1.0}, {0.5, -1.5}})
    task.starts.push_back(system.unknowns_at(0, Eigen::Vector2d(x, 0.5), Eigen::Vector2d(0, v)));
  const auto found = find_basins(structure, task);
  REQUIRE(found.basins.size() == 2);
  CHECK(found.basins[0].count > 0);
  CHECK(found.basins[1].count > 0);
  analysis::cycles::SectionMap map(structure);
  for (std::size_t i = 0; i < task.starts.size(); ++i) {
    std::vector<double> end;
    map.follow_crossings(task.starts[i], 1e-7, [&](int crossing, double, const std::vector<double>& y) {
      end = y;
      return crossing == 150;
    });
    const auto& there = found.basins[std::size_t(found.labels[i])].attractor.points.front();
    for (std::size_t k = 0; k < 4; ++k) CHECK(std::abs(end[k] - there[k]) < 1e-2);
  }
}

TEST_CASE("refined borders are those of the full grid, and most starts are not followed", "[basin][long]") {
  const auto structure = oscillators::one_slider(two_motions(1.5));
  BasinTask task;
  const int columns = 81, rows = 65;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      task.starts.push_back(start_at(structure, -2 + 5.0 * i / (columns - 1), -2 + 4.0 * j / (rows - 1)));
  const auto full = find_basins(structure, task);
  task.refined_columns = columns;
  const auto refined = find_basins(structure, task);
  REQUIRE(refined.outcome.complete());
  CHECK(refined.labels == full.labels);
  CHECK(full.followed.empty());
  REQUIRE(refined.followed.size() == task.starts.size());
  CHECK(std::ranges::count(refined.followed, true) < 0.45 * double(task.starts.size()));
  CHECK(refined.sample == 100);
  CHECK(refined.sample_wrong == 0);
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(refined.basins[k].share == full.basins[k].share);
    CHECK(refined.basins[k].error > full.basins[k].error);
  }
}
