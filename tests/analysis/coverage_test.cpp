/// How often stated errors of cycles cover the true ones: counted on random cycles of all laws, and on a plane in
/// lanes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/studies/stress.hpp"
#include "laws/catalogue.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;

namespace {

/// Stated errors that were compared with a much finer solution, and those that held.
struct Coverage {
  long cycles = 0, cycles_covered = 0, numbers = 0, covered = 0;
  double worst = 0;      ///< largest ratio of difference to stated error
  std::string worst_at;  ///< which number of which law

  void compare(const FrictionLaw& law, const cycles::Metrics& metrics, const cycles::Metrics& error,
               bool ill_conditioned_stick, const cycles::Cycle& reference) {
    bool all = true;
    for (const auto& metric : cycles::metric_names()) {
      const auto m = metric.member;
      if (!std::isfinite(metrics.*m)) continue;  // not asked for
      if (cycles::is_stick(metric) && (ill_conditioned_stick || reference.ill_conditioned_stick)) continue;
      const double difference = std::abs(metrics.*m - reference.metrics.*m);
      const double stated = error.*m + reference.error.*m;
      const bool holds = difference <= stated;
      ++numbers;
      covered += holds;
      all &= holds;
      if (!holds && difference / stated > worst) {
        worst = difference / stated;
        worst_at = std::string(metric.name) + " of " + std::string(law.card().name);
      }
    }
    ++cycles;
    cycles_covered += all;
  }
  double share() const { return double(covered) / double(numbers); }
};

/// Random sliders that settle on a cycle along the drive, with that cycle at 1e-10.
struct Known {
  std::vector<Model> models;
  std::vector<cycles::Cycle> cycles;
};
Known random_cycles(std::size_t count) {
  Known known;
  for (long index = 0; known.models.size() < count; ++index) {
    const auto scene = studies::draw_scene(laws::catalogue(), 77, index);
    if (scene.question != studies::Question::cycle) continue;
    try {
      Model model = studies::model_of(scene);
      if (!(model.drive.speed.level() > 0)) continue;
      auto cycle = cycles::find_cycle(model, {.tolerance = 1e-10});
      if (!(cycle.metrics.period > 0)) continue;
      known.models.push_back(std::move(model));
      known.cycles.push_back(std::move(cycle));
    } catch (const InputError&) {
    }
  }
  return known;
}

Coverage of_find_cycle(const Known& known) {
  Coverage coverage;
  for (std::size_t i = 0; i < known.models.size(); ++i) {
    const auto cycle = cycles::find_cycle(known.models[i], {.tolerance = 1e-6});
    if (cycle.outcome.complete())
      coverage.compare(*known.models[i].law, cycle.metrics, cycle.error, cycle.ill_conditioned_stick, known.cycles[i]);
  }
  return coverage;
}

/// Cycles that lanes find, but for those that settle on another cycle of the same slider.
Coverage of_lanes(const Known& known) {
  const auto found = lanes::find_cycles(known.models, lanes::every_metric());
  Coverage coverage;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i].found && std::abs(found[i].metrics.period / known.cycles[i].metrics.period - 1) < 0.1)
      coverage.compare(*known.models[i].law, found[i].metrics, found[i].error, found[i].ill_conditioned_stick,
                       known.cycles[i]);
  return coverage;
}

/// The board's plane of load and λ, where sliding is unstable.
Known plane_cycles(int side) {
  Known known;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const Model model =
          tests::bristol_board(std::pow(10.0, -6 + 5 * (i + 0.5) / side), std::pow(10.0, -4 + 6 * (j + 0.5) / side));
      auto cycle = cycles::find_cycle(model, {.tolerance = 1e-10});
      if (!(cycle.metrics.period > 0)) continue;
      known.models.push_back(model);
      known.cycles.push_back(std::move(cycle));
    }
  return known;
}

void report(const char* what, const Coverage& c) {
  UNSCOPED_INFO(what << ": " << c.covered << " of " << c.numbers << " stated errors hold, all of " << c.cycles_covered
                     << " of " << c.cycles << " cycles; worst ratio " << c.worst << ", " << c.worst_at);
}

void check(std::size_t count, int side) {
  const auto known = random_cycles(count);
  const auto cycles = of_find_cycle(known), lanes = of_lanes(known), points = of_lanes(plane_cycles(side));
  report("find_cycle on random cycles", cycles);
  report("lanes on random cycles", lanes);
  report("lanes on a plane", points);
  CHECK(cycles.share() >= 0.99);
  CHECK(lanes.share() >= 0.98);
  CHECK(points.share() >= 0.99);
  CHECK(std::max({cycles.worst, lanes.worst, points.worst}) < 10);
}

}  // namespace

TEST_CASE("stated errors of cycles cover the true ones", "[coverage][long]") { check(12, 3); }

// The larger set: rosin_tests "[coverage-large]" -s
TEST_CASE("stated errors of many cycles cover the true ones", "[.][coverage-large]") { check(200, 14); }
