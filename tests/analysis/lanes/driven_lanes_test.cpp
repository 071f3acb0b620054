/// Forced blocks in lanes against published points of the section, and against the motion of each by itself.
#include "analysis/lanes/driven_lanes.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/cycles/section_map.hpp"
#include "analysis/lanes/driven_exponents.hpp"
#include "analysis/planes/structure_map.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"

using namespace rosin;
using namespace rosin::analysis;
using lanes::DrivenBlock, lanes::DrivenLanes, lanes::DrivenMotion;

namespace {

oscillators::Structure forced(std::shared_ptr<const FrictionLaw> law, double speed, Signal::Harmonics force,
                              double damping = 0) {
  oscillators::Model model;
  model.law = std::move(law);
  model.slider = {1, 1, damping};
  model.drive.speed = speed, model.drive.normal_load = 1.0;
  model.drive.force = Signal(std::move(force));
  return oscillators::one_slider(model);
}

DrivenMotion to_follow(const oscillators::Structure& structure, int transient, int keep, double tolerance) {
  const auto block = DrivenBlock::of(structure);
  REQUIRE(block);
  DrivenMotion motion;
  motion.block = *block;
  motion.transient = transient, motion.keep = keep, motion.tolerance = tolerance;
  return motion;
}

std::shared_ptr<const FrictionLaw> hyperbolic() {
  return laws::find_law("hyperbolic")->with("mu_s", 1.0)->with("delta", 3.0);
}

}  // namespace

TEST_CASE("a forced block in lanes repeats after three periods where it was published to", "[lanes]") {
  // x″ + x + sgn friction 1/(1 + 3|v|), belt 0.1, force cos 2t/2: stroboscopic points of the period-3 motion, by two
  // integrators with events.
  std::vector<DrivenMotion> all(40, to_follow(forced(hyperbolic(), 0.1, {0, {{0.5, 2, 0}}}), 240, 3, 1e-11));
  for (std::size_t i = 0; i < all.size(); ++i) all[i].displacement = 0.02 * double(i);
  DrivenLanes(all[0].block).run(all);
  for (const auto& one : all) {
    REQUIRE(one.why.empty());
    REQUIRE(one.moments.size() == 3);
    bool meets = false;
    for (const auto& moment : one.moments)
      meets = meets || (std::abs(moment.displacement - 0.389727402283) < 1e-10 && moment.contact == ContactMode::stick);
    CHECK(meets);
  }
}

TEST_CASE("forced blocks in lanes move as each does by itself, under every law without a memory", "[lanes]") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  int near = 0, stuck = 0, backward = 0;
  for (const char* name : {"coulomb", "hyperbolic", "stribeck", "two-exponential"}) {
    std::vector<oscillators::Structure> structures;
    std::vector<DrivenMotion> all;
    std::vector<double> starts;
    for (int i = 0; i < 40; ++i) {
      Signal::Harmonics force{0.2 * share(random), {{2 * share(random), 0.4 + 2 * share(random), 6 * share(random)}}};
      if (name[0] == 'h') force.terms.push_back({share(random), 2 * force.terms[0].angular_frequency, 1});
      structures.push_back(forced(laws::find_law(name), share(random) - 0.2, force, 0.1 * share(random)));
      all.push_back(to_follow(structures.back(), 5, 3, 1e-12));
      all.back().displacement = share(random);
      starts.push_back(all.back().displacement);
    }
    DrivenLanes(all[0].block).run(all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      INFO(name << ' ' << i);
      REQUIRE(all[i].why.empty());
      REQUIRE(all[i].moments.size() == 3);
      cycles::SectionMap map(structures[i]);
      std::size_t moment = 0;
      double worst = 0;
      const auto outcome =
          map.follow_crossings({starts[i], 0}, 1e-11, [&](int crossing, double t, const std::vector<double>& y) {
            if (crossing <= 5) return false;
            const auto& here = all[i].moments[moment++];
            worst = std::max({worst, std::abs(here.displacement - y[0]), std::abs(here.slip_rate - y[1])});
            stuck += here.contact == ContactMode::stick, backward += here.contact == ContactMode::backward;
            return moment == 3 && t >= 0;
          });
      REQUIRE(outcome.complete());
      CHECK(worst < 1e-7);  // of motions that part at most a thousandfold in eight periods
      near += worst < 1e-9;
    }
  }
  CHECK(near > 140);
  CHECK(stuck > 50);
  CHECK(backward > 50);
}

TEST_CASE("exponents in lanes are those of multipliers, and of independent averages", "[lanes]") {
  const auto at = [](const char* law, std::vector<Value> values, double speed, double amplitude, double damping) {
    motion::StructureModel model{
        forced(laws::find_law(law)->with(std::move(values)), speed, {0, {{amplitude, 2, 0}}}, damping), {}};
    model.start.kind = motion::Start::Kind::rest;
    return model;
  };
  const std::vector<Value> belt{1.0, 3.0};
  // Two that stick and repeat (multiplier -0.2574062 in three periods), one that does not (0.0731(4), by 4e5 s of an
  // integrator with saltation, and by the slope of the map from release to release).
  const std::vector<motion::StructureModel> models{at("hyperbolic", belt, 0.1, 0.5, 0),
                                                   at("hyperbolic", belt, 0.4, 0.5, 0)};
  const auto found = lanes::driven_exponents(models, {.duration = 20000, .transient = 400, .accuracy = 1e-9});
  REQUIRE((found[0] && found[1]));
  CHECK(found[0]->returns == 3);
  CHECK(std::abs(found[0]->value + 0.1439927) < 1e-7);
  CHECK(found[0]->error < 1e-7);
  CHECK(found[1]->returns == 0);
  CHECK(std::abs(found[1]->value - 0.0731) < 3 * std::hypot(found[1]->error, 0.0004));
  CHECK(found[1]->error < 0.003);

  // Dry friction on ground at rest turns slip round without stick: exponents by multipliers of the cycle. And contacts
  // that let go at a jump, 0.4 to 0.25.
  std::vector<motion::StructureModel> others{
      at("coulomb", {0.3, 0.3}, 0, 1.2, 0.02), at("coulomb", {0.4, 0.25}, 0.2, 0.9, 0.05),
      at("coulomb", {0.4, 0.25}, 0.05, 1.5, 0.05), at("coulomb", {0.3, 0.3}, 0.3, 2, 0.1)};
  const auto exponents = lanes::driven_exponents(others, {.duration = 600, .transient = 600, .accuracy = 1e-9});
  int compared = 0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto cycle = cycles::find_cycle(others[i], {.tolerance = 1e-9});
    INFO(i);
    REQUIRE(exponents[i]);
    if (!cycle.outcome.complete() || !(std::abs(cycle.multipliers.front()) > 1e-3)) continue;
    CHECK(exponents[i]->returns == cycle.returns);
    CHECK(std::abs(exponents[i]->value -
                   std::log(std::abs(cycle.multipliers.front())) / (cycle.returns * std::numbers::pi)) < 1e-6);
    ++compared;
  }
  CHECK(compared >= 2);
}

TEST_CASE("a point of a plane of exponents that is refused fails, and leaves the others", "[lanes]") {
  planes::MapOptions options;
  options.x = planes::make_axis("drive.speed", 0.1, 0.4, 4, false, {});
  options.y = planes::make_axis("drive.force.amplitude", 0.5, 0.6, 2, false, {});
  options.lyapunov.duration = 100, options.lyapunov.transient = 50;
  for (const std::size_t refused : {0, 5}) {
    const planes::StructureFamily family = [&](double speed, double amplitude) {
      if (speed == options.x.values[refused % 4] && amplitude == options.y.values[refused / 4])
        throw InputError("no such block");
      motion::StructureModel model{forced(hyperbolic(), speed, {0, {{amplitude, 2, 0}}}), {}};
      model.start.kind = motion::Start::Kind::rest;
      return model;
    };
    const auto metrics = planes::metrics_of_structure(forced(hyperbolic(), 0.1, {0, {{0.5, 2, 0}}}), {"lyapunov"});
    const auto map = planes::compute_structure_map(family, options, metrics);
    REQUIRE(map.outcome.complete());
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      CHECK((map.points[i].regime == planes::Regime::failed) == (i == refused));
      CHECK(std::isfinite(metrics[0].value(map.points[i])) == (i != refused));
    }
    CHECK(map.points[refused].why == "no such block");
  }
}
