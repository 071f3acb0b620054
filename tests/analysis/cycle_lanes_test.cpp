/// Cycles of many sliders at once are those found one by one, within the stated errors.
#include "analysis/cycle_lanes.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/stability.hpp"
#include "core/instruction_set.hpp"
#include "laws/adapter.hpp"
#include "laws/catalogue.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::tests::bristol_board;

namespace rosin::tests {
// clang-format off
/// A user's law, without an explicit slip rate.
template <class Real = double>
struct Healing {
  static constexpr Card card{"healing", "Healing friction", R"(\mu + d\,\psi)", "a test", "a test"};
  Real mu = 0.3, d = 0.1, L = 10e-6, t_heal = 10;
  static constexpr auto parameters = table(field(&Healing::mu, "mu", "1", {0, 2}, "friction after long slip"),
      field(&Healing::d, "d", "1", {0, 2}, "gain at rest"), field(&Healing::L, "L", "m", {1e-9, 1}, "memory"),
      field(&Healing::t_heal, "t_heal", "s", {1e-6, 1e9}, "healing time"));
  struct State { Real psi; };
  static constexpr auto states = table(field(&State::psi, "psi", "1", {0, 1}, "healed fraction"));
  Real friction(Sliding<Real> at, State s) const { return (mu + d * s.psi) * at.slip_rate / (1e-7 + abs(at.slip_rate)); }
  State rate(Sliding<Real> at, State s) const { return {(1.0 - s.psi) / t_heal - abs(at.slip_rate) * s.psi / L}; }
  State steady(Sliding<Real> at) const { return {1.0 / (1.0 + abs(at.slip_rate) * t_heal / L)}; }
};
// clang-format on
}  // namespace rosin::tests

namespace {

const LaneCycleOptions two_metrics{1e-6, 0.1, {"stick_fraction", "loop_area"}};

/// Random sliders under a law that slide unsteadily.
std::vector<Model> unstable_sliders(const std::shared_ptr<const FrictionLaw>& law, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  const auto decades = [&](double low, double high) {
    return std::pow(10, std::uniform_real_distribution<double>(low, high)(random));
  };
  std::vector<Model> models;
  while (models.size() < count) {
    Model model;
    model.law = law;
    model.lambda = decades(-3, 1.5);
    model.slider = {1, decades(-0.5, 0.5), models.size() % 3 == 0 ? decades(-4, -2) : 0};
    model.drive.speed = decades(-5.5, -4.5);
    model.drive.normal_load = decades(-5, 0);
    if (!stability(model).stable) models.push_back(model);
  }
  return models;
}

struct Tally {
  int found = 0, metrics = 0, outside = 0;
  double worst_error = 0;  ///< relative
};
Tally against_one_by_one(const std::vector<Model>& models, const std::vector<LaneCycle>& cycles) {
  Tally tally;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!cycles[i].found) continue;
    const Cycle fine = find_cycle(models[i], {.tolerance = 1e-9, .multipliers = false});
    if (!(fine.metrics.period > 0)) continue;
    ++tally.found;
    for (const char* name : {"period", "stick_fraction", "loop_area"}) {
      const auto& metric = find_metric(name);
      if (is_stick(metric) && cycles[i].ill_conditioned_stick) continue;
      const double difference = std::abs(cycles[i].metrics.*metric.member - fine.metrics.*metric.member);
      ++tally.metrics;
      tally.outside += !(difference <= cycles[i].error.*metric.member + fine.error.*metric.member);
      tally.worst_error =
          std::max(tally.worst_error, difference / size_of(metric, fine.metrics, models[i].drive.speed.level()));
    }
  }
  return tally;
}

}  // namespace

TEST_CASE("every law with states finds its cycles in lanes, a user's too", "[cycle-lanes][long]") {
  std::vector<std::shared_ptr<const FrictionLaw>> with_states = {laws::make_law<rosin::tests::Healing>()};
  for (const auto& law : laws::catalogue())
    if (law->has_states() && !law->set_valued() && !law->deflects()) with_states.push_back(law);
  for (const auto& law : with_states) {
    const auto models = unstable_sliders(law, 40, 3);
    const auto cycles = find_cycles(models, two_metrics);
    const Tally tally = against_one_by_one(models, cycles);
    INFO(law->card().name << ": " << tally.found << " found, worst error " << tally.worst_error);
    CHECK(tally.found >= 36);
    CHECK(tally.outside <= 2);
    CHECK(tally.worst_error < 2e-6);
  }
}

TEST_CASE("a contact spring is no obstacle", "[cycle-lanes]") {
  auto models = unstable_sliders(laws::find_law("spinodal"), 20, 5);
  for (auto& model : models) {  // undamped, the slider would ring on the contact spring through each stick
    model.contact_stiffness.tangential = 30 * model.slider.stiffness;
    model.slider.damping = 1;
  }
  const auto cycles = find_cycles(models, two_metrics);
  const Tally tally = against_one_by_one(models, cycles);
  CHECK(tally.found >= 3);  // elsewhere the damper stills the motion, or the ringing hides the threshold
  CHECK(tally.outside <= 1);
}

TEST_CASE("Fig 1 in lanes, with every metric", "[cycle-lanes]") {
  LaneCycleOptions options;
  options.tolerance = 1e-7;
  for (const auto& metric : metric_names()) options.metrics.emplace_back(metric.name);
  const std::vector<Model> models = {bristol_board(1e-4, 10)};
  const auto cycle = find_cycles(models, options).front();
  REQUIRE(cycle.found);
  CHECK(std::abs(cycle.metrics.period - 22.5870557971588) <= cycle.error.period);
  CHECK(std::abs(cycle.metrics.stick_fraction - 0.58437850800302) <= cycle.error.stick_fraction);
  CHECK(std::abs(cycle.metrics.loop_area - 4.1717663824344e-06) <= cycle.error.loop_area);
  const Cycle fine = find_cycle(models.front(), {.tolerance = 1e-10});
  for (const auto& metric : metric_names()) {
    INFO(metric.name);
    CHECK(std::abs(cycle.metrics.*metric.member - fine.metrics.*metric.member) <= cycle.error.*metric.member);
    CHECK(cycle.error.*metric.member <= options.tolerance * size_of(metric, fine.metrics, 1e-5));
  }
}

TEST_CASE("company, threads and instruction sets leave no trace", "[cycle-lanes]") {
  const auto models = unstable_sliders(laws::find_law("spinodal"), 40, 11);
  const auto together = find_cycles(models, two_metrics);
  const auto same = [](const LaneCycle& a, const LaneCycle& b) {
    return a.found == b.found && a.tries == b.tries &&
           (!a.found || (a.metrics.period == b.metrics.period && a.metrics.loop_area == b.metrics.loop_area &&
                         a.error.period == b.error.period));
  };
  for (const std::size_t i : {0ul, 7ul, 23ul, 39ul})
    CHECK(same(find_cycles(std::span(models).subspan(i, 1), two_metrics).front(), together[i]));
  const InstructionSet best = instruction_set();
  for (const auto set : {InstructionSet::baseline, InstructionSet::v3}) {
    use_instruction_set(set);
    const auto cycles = find_cycles(models, two_metrics);
    for (std::size_t i = 0; i < models.size(); ++i) CHECK(same(cycles[i], together[i]));
  }
  use_instruction_set(best);
}

TEST_CASE("lanes leave to others what they cannot serve, and say so by finding nothing", "[cycle-lanes]") {
  auto massless = bristol_board(1e-4, 10);
  massless.slider.mass = 0;
  massless.slider.damping = 1;
  auto coulomb = bristol_board(1e-4, 1);
  coulomb.law = laws::find_law("coulomb");
  const auto stable = bristol_board(1e-6, 90);  // decays onto steady sliding
  const std::vector<Model> models = {massless, coulomb, stable};
  for (const auto& cycle : find_cycles(models, two_metrics)) CHECK_FALSE(cycle.found);
  CHECK_THROWS_AS(find_cycles(models, {1e-6, 0.1, {"stick_fracton"}}), InputError);
}
