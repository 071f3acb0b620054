/// Laws from text in runs, in the laboratory and in designs: the numbers of the compiled laws that they spell.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/inference/discrimination.hpp"
#include "analysis/lab/experiment.hpp"
#include "analysis/motion/run.hpp"
#include "tests/bristol_board.hpp"
#include "tests/laws/formula_texts.hpp"

using namespace rosin;
using namespace rosin::analysis;
using laws::find_law;
using laws::make_formula;
using oscillators::Model;

namespace {

struct Pair {
  std::shared_ptr<const FrictionLaw> text, compiled;
};

/// Readings of an experiment by both laws, with its own protocol and these settings.
void check_experiment(const char* name, const Pair& pair, std::vector<std::pair<const char*, Value>> settings = {}) {
  const auto& experiment = lab::find_experiment(name);
  const auto done = [&](std::shared_ptr<const FrictionLaw> law) {
    auto task = lab::task_for(experiment, std::move(law));
    for (const auto& [key, value] : settings) task.settings.set(key, value);
    return experiment.perform(task);
  };
  const auto text = done(pair.text), compiled = done(pair.compiled);
  INFO(name << ": " << text.outcome.detail);
  REQUIRE(compiled.outcome.complete());
  REQUIRE(text.outcome.complete());
  REQUIRE(text.readings.size() == compiled.readings.size());
  for (std::size_t i = 0; i < text.readings.size(); ++i) {
    const auto &a = text.readings[i], &b = compiled.readings[i];
    INFO(a.name << " = " << a.value << " ± " << a.error << " from text, " << b.value << " compiled");
    CHECK(a.name == b.name);
    CHECK((std::isnan(a.value) == std::isnan(b.value)));
    if (!std::isnan(b.value)) CHECK(std::abs(a.value - b.value) <= 1e-9 * std::abs(b.value) + a.error + b.error);
  }
}

}  // namespace

TEST_CASE("stick-slip of a set-valued law from text is that of the compiled law", "[formula]") {
  for (const auto& [text, compiled] :
       {Pair{make_formula(tests::text::slip_distance()), find_law("slip-distance")->with("mu_d", 0.2)},
        Pair{make_formula(tests::text::static_growth()), find_law("static-growth")->with("mu_d", 0.2)}}) {
    INFO(compiled->card().name);
    Model model;
    model.slider = {1, 2000, 1};
    model.drive = {.speed = 1e-3, .normal_load = 5.0, .force = 0.0};
    motion::RunOptions how;
    how.start.kind = motion::Start::Kind::rest;
    how.duration = 6;
    how.samples = 61;
    how.tolerance = 1e-9;
    model.law = text;
    const auto a = motion::run(model, how);
    const auto text_cycle = cycles::find_cycle(model, {});
    model.law = compiled;
    const auto b = motion::run(model, how);
    const auto cycle = cycles::find_cycle(model, {});
    REQUIRE(a.outcome.complete());
    REQUIRE(a.events.size() == b.events.size());
    CHECK(a.events.size() > 4);
    for (std::size_t i = 0; i < a.events.size(); ++i) {
      CHECK(a.events[i].kind == b.events[i].kind);
      CHECK(a.events[i].time == Approx(b.events[i].time).epsilon(1e-12));
    }
    for (std::size_t k = 0; k < a.columns.size(); ++k) {
      double size = 0;
      for (const double x : b.columns[k]) size = std::max(size, std::abs(x));
      for (std::size_t i = 0; i < a.time.size(); ++i) {
        INFO(a.column_names[k] << " at " << a.time[i] << " s");
        CHECK(std::abs(a.columns[k][i] - b.columns[k][i]) <= 1e-12 * size);
      }
    }
    CHECK(text_cycle.metrics.period == Approx(cycle.metrics.period).epsilon(1e-12));
  }
}

TEST_CASE("experiments on laws from text read what they read on the compiled laws", "[formula][lab]") {
  const Pair ageing{make_formula(tests::text::ageing()), find_law("ageing")},
      board{make_formula(tests::text::spinodal()), find_law("spinodal")},
      curve{make_formula(tests::text::stribeck()), find_law("stribeck")},
      growth{make_formula(tests::text::static_growth()), find_law("static-growth")->with("mu_d", 0.2)};
  check_experiment("velocity-step", ageing);
  check_experiment("slide-hold-slide", ageing, {{"hold_times", std::vector<double>{1, 10, 100}}});
  check_experiment("inclined-plane", board);
  check_experiment("inclined-plane", curve);
  check_experiment("inclined-plane", growth);
}

TEST_CASE("a design tells a law from text from others as it tells the compiled law", "[formula]") {
  auto compiled = tests::bristol_board(1e-4, 1), text = compiled, slow = compiled;
  text.law = make_formula(tests::text::spinodal())->with(compiled.law->values());
  slow.lambda = 2;
  const inference::DesignOptions options{.x = planes::make_axis("drive.normal_load", 1e-3, 1e-2, 2, true, {}),
                                         .y = planes::make_axis("drive.speed", 3e-6, 1e-5, 2, true, {}),
                                         .noise = {{"period", 0, 0.01}},
                                         .tolerance = 1e-4};
  const auto told = [&](const Model& a, const Model& b) {
    return inference::discriminate(std::vector<planes::Varied>{a, b}, options);
  };
  const auto alike = told(compiled, text), one = told(compiled, slow), other = told(text, slow);
  REQUIRE(one.information.size() == other.information.size());
  double largest = 0;
  for (std::size_t i = 0; i < one.information.size(); ++i) {
    CHECK(alike.information[i] < 1e-4);
    CHECK(other.information[i] == Approx(one.information[i]).epsilon(0.05));
    largest = std::max(largest, one.information[i]);
  }
  CHECK(largest > 1);
}
