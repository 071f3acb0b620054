/// Reversals of slip under drives that vary: rate-and-state friction far stronger than its direct effect, and bristles.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/motion/run.hpp"
#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using rosin::tests::slider_under;

namespace {

Model board(const std::string& law) {
  Model model;
  model.slider = {.mass = 1.148, .stiffness = 1.943, .damping = 0};
  model.drive = {.speed = 0.427, .normal_load = 1.257, .force = 0.0};
  model.law = laws::find_law(law)->with("mu0", 0.6)->with("a", 0.01)->with("b", 0.015)->with("L", 0.035);
  model.law = model.law->with("v0", 0.072);
  if (law == "kato-tullis") model.law = model.law->with("v_c", 1e-3);
  if (law == "spinodal") model.law = model.law->with("c", 1e-3)->with("t_heal", 10.0);
  return model;
}

StructureModel as_structure(const Model& model, const Start& start) {
  StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = Start::Kind::given;
  structure.start.coordinates = {start.displacement}, structure.start.velocities = {start.velocity};
  return structure;
}

}  // namespace

TEST_CASE("a force of a millionth of a newton changes a motion with reversals by a millionth", "[varying-reversal]") {
  RunOptions options;
  options.duration = 20, options.samples = 20, options.tolerance = 1e-6;
  options.start = {Start::Kind::given, 0.0, -0.8, {}, {}};
  auto model = board("ageing");
  const auto alone = run(model, options);
  model.drive.force = Signal(Signal::Harmonics{0, {{1e-6, 1.1, 0}}});
  for (const auto& disturbed : {run(model, options), run_structure(as_structure(model, options.start), options)}) {
    INFO(disturbed.outcome.detail);
    REQUIRE(disturbed.outcome.complete());
    CHECK(std::abs(disturbed.columns[0].back() - alone.columns[0].back()) < 1e-5);
    CHECK(std::ranges::count(disturbed.events, "reversal", &RunEvent::kind) == 2);
  }
}

TEST_CASE("slip reverses under a load that swings, by five laws from any start", "[varying-reversal]") {
  std::mt19937_64 random(3);
  const auto real = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  for (const char* law : {"ageing", "slip", "prz", "spinodal", "kato-tullis"}) {
    for (int k = 0; k < 6; ++k) {
      auto model = board(law);
      model.drive.normal_load = Signal(Signal::Harmonics{1.257, {{real(0.1, 0.6), real(0.5, 3), 0}}});
      RunOptions options;
      options.duration = 12, options.samples = 12, options.tolerance = 1e-6;
      options.start = {Start::Kind::given, real(-0.5, 0.5), real(-1, 1), {}, {}};
      const auto slider = run(model, options);
      const auto structure = run_structure(as_structure(model, options.start), options);
      INFO(law << " from " << *options.start.displacement << " m, " << *options.start.velocity
               << " m/s: " << slider.outcome.detail << " | " << structure.outcome.detail);
      CHECK(slider.outcome.complete());
      CHECK(structure.outcome.complete());
      if (!slider.outcome.complete() || !structure.outcome.complete()) continue;
      for (std::size_t i = 0; i < slider.time.size(); ++i)
        CHECK(std::abs(slider.columns[0][i] - structure.columns[0][i]) <=
              slider.column_error[0] + structure.column_error[0]);
    }
  }
}

TEST_CASE("bristles of a structure reverse as those of the slider, in steps that end there", "[varying-reversal]") {
  const auto model = slider_under("lugre", {60.0, 0.6, 0.05, 0.5, 0.35, 0.1}, {1.1, 1.3, 0}, 0.1, 3);
  RunOptions options;
  options.duration = 30, options.samples = 60, options.start = {Start::Kind::given, 0.2, 0.0, {}, {}};
  for (const double tolerance : {1e-6, 1e-9}) {
    options.tolerance = tolerance;
    const auto slider = run(model, options), structure = run_structure(as_structure(model, options.start), options);
    INFO(structure.outcome.detail);
    REQUIRE(structure.outcome.complete());
    REQUIRE(slider.events.size() == 38);
    REQUIRE(structure.events.size() == 38);
    CHECK(structure.events[0].time == Approx(0.10965678018).margin(1e-6));
    CHECK(structure.events[1].time == Approx(0.33237324048).margin(1e-6));
    for (int c : {0, 1})
      for (std::size_t i = 0; i < slider.time.size(); ++i)
        CHECK(std::abs(slider.columns[c][i] - structure.columns[c][i]) <=
              slider.column_error[c] + structure.column_error[c]);
  }
}
