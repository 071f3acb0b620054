/// Designs of experiments: information against closed forms, against drawn measurements, and on the board's plane.
#include "analysis/inference/discrimination.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "analysis/cycles/structure_cycle.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/pin_on_disk.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::inference;
using oscillators::Model;
using rosin::tests::bristol_board;

namespace {
DesignOptions small_design() {
  DesignOptions options;
  options.x = planes::make_axis("drive.normal_load", 1e-3, 1e-1, 3, true, {});
  options.y = planes::make_axis("oscillator.stiffness", 0.5, 2, 2, true, {});
  options.noise = {{"stick_fraction", 0.01, 0}, {"period", 0, 0.002}};
  return options;
}
}  // namespace

TEST_CASE("repeats are those that decide rightly as often as asked", "[discrimination]") {
  CHECK(repeats_needed(0, 0.95) == infinity);
  CHECK(repeats_needed(100, 0.95) == 1);
  CHECK(repeats_needed(0.01, 0.95) == std::ceil(2 * 1.6448536269514722 * 1.6448536269514722 / 0.01));
  // Drawn measurements of two members half a standard deviation apart.
  const double d = 0.5;
  const int n = int(repeats_needed(0.5 * d * d, 0.95)), draws = 20000;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  int right = 0;
  for (int i = 0; i < draws; ++i) {
    double ratio = 0;  // of the likelihoods, the first member being true
    for (int k = 0; k < n; ++k) {
      const double x = normal(random);
      ratio += 0.5 * (x - d) * (x - d) - 0.5 * x * x;
    }
    right += ratio > 0;
  }
  CHECK(double(right) / draws > 0.95 - 0.005);
  CHECK(double(right) / draws < 0.96);
}

TEST_CASE("information between two clocks of the state is what their cycles and the noise give", "[discrimination]") {
  const auto options = small_design();
  const std::vector<Model> members{bristol_board(1e-3, 1), bristol_board(1e-3, 3)};
  const auto design = discriminate(std::vector<Varied>(members.begin(), members.end()), options);
  REQUIRE(design.outcome.complete());
  REQUIRE(design.information.size() == 6);
  double best = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    double expected = 0;
    std::vector<cycles::Cycle> cycles;
    for (const auto& member : members)
      cycles.push_back(cycles::find_cycle(member.with("drive.normal_load", options.x.values[i % 3])
                                              .with("oscillator.stiffness", options.y.values[i / 3]),
                                          {.tolerance = 1e-9}));
    const double ds = cycles[0].metrics.stick_fraction - cycles[1].metrics.stick_fraction;
    expected += 0.5 * ds * ds / (0.01 * 0.01);
    const double T0 = cycles[0].metrics.period, T1 = cycles[1].metrics.period;
    const auto divergence = [&](double from, double to) {
      const double r = from / to, distance = (T0 - T1) / (0.002 * to);
      return 0.5 * (r * r - 1) - std::log(r) + 0.5 * distance * distance;
    };
    expected += std::min(divergence(T0, T1), divergence(T1, T0));
    CHECK(std::abs(design.information[i] - expected) <= design.information_error[i] + 1e-6 * expected);
    CHECK(design.information_error[i] < 1e-2 * expected);
    CHECK(design.by_metric[0][i] + design.by_metric[1][i] == Approx(design.information[i]));
    best = std::max(best, design.information[i]);
  }
  CHECK(design.best.information == best);
  CHECK(design.best.repeats == 1);
}

TEST_CASE("a member against itself brings no information, and three members that of the closest pair",
          "[discrimination]") {
  const auto options = small_design();
  const Model one = bristol_board(1e-3, 1), other = bristol_board(1e-3, 2), third = bristol_board(1e-3, 10);
  const auto same = discriminate(std::vector<Varied>{one, one}, options);
  CHECK(same.best.information == 0);
  CHECK(same.best.repeats == infinity);
  const auto near = discriminate(std::vector<Varied>{one, other}, options),
             all = discriminate(std::vector<Varied>{one, other, third}, options);
  for (std::size_t i = 0; i < all.information.size(); ++i) CHECK(all.information[i] <= near.information[i]);
}

TEST_CASE("of three members each metric has its own hardest pair", "[discrimination]") {
  // The board at three clocks and other weights of its metrics: pairs differ in which metric tells them apart.
  const auto options = small_design();
  const std::vector<Varied> members{bristol_board(1e-3, 1), bristol_board(1e-3, 3), bristol_board(2e-3, 2)};
  const auto all = discriminate(members, options);
  std::vector<Design> pairs;
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
    pairs.push_back(discriminate(std::vector<Varied>{members[std::size_t(a)], members[std::size_t(b)]}, options));
  for (std::size_t i = 0; i < all.information.size(); ++i)
    for (std::size_t m = 0; m < options.noise.size(); ++m)
      CHECK(all.by_metric[m][i] ==
            std::min({pairs[0].by_metric[m][i], pairs[1].by_metric[m][i], pairs[2].by_metric[m][i]}));
}

TEST_CASE("noise that is a part of a metric tells of the parameter by its size too", "[discrimination]") {
  // Steady sliding has slip rate V: d ln m/d ln V = 1, so that relative noise r leaves 1/r² + 2 and absolute σ V²/σ².
  auto options = small_design();
  options.x = planes::make_axis("drive.normal_load", 1e-6, 2e-6, 2, true, {});
  options.noise = {{"slip_rate_mean", 0, 0.3}, {"slip_rate_max", 1e-5, 0}, {"slip_rate_min", 0.4, 0.3}};
  const Model board = bristol_board(1e-3, 2).with("oscillator.damping", 1.0);  // more than so little load feeds
  const double V = board.drive.speed.level();
  const auto design = inform(board, "drive.speed", options);
  REQUIRE(design.outcome.complete());
  REQUIRE(design.maps[0].points[0].regime == planes::Regime::stable);
  CHECK(design.by_metric[0][0] == Approx(1 / 0.09 + 2).epsilon(1e-4));
  CHECK(design.by_metric[1][0] == Approx(V * V / 1e-10).epsilon(1e-3));
  const double sigma = std::hypot(0.4, 0.3 * V), of_noise = 0.09 * V * V / (sigma * sigma);
  CHECK(design.by_metric[2][0] == Approx(V * V / (sigma * sigma) + 2 * of_noise * of_noise).epsilon(1e-3));
}

TEST_CASE("information on a parameter is the squared slope of the metrics over the noise", "[discrimination]") {
  auto options = small_design();
  options.noise = {{"period", 0.1, 0}};
  options.tolerance = 1e-8;
  const auto design = inform(bristol_board(1e-3, 2), "law.lambda", options);
  REQUIRE(design.outcome.complete());
  for (const std::size_t i : {1u, 4u}) {
    const auto period = [&](double lambda) {
      return cycles::find_cycle(bristol_board(1e-3, lambda)
                                    .with("drive.normal_load", options.x.values[i % 3])
                                    .with("oscillator.stiffness", options.y.values[i / 3]),
                                {.tolerance = 1e-10})
          .metrics.period;
    };
    // Richardson: differences over two steps leave an error of the fourth order.
    const double wide = (period(2 * std::exp(0.04)) - period(2 * std::exp(-0.04))) / 0.08,
                 narrow = (period(2 * std::exp(0.02)) - period(2 * std::exp(-0.02))) / 0.04;
    const double slope = (4 * narrow - wide) / 3;
    CHECK(design.information[i] == Approx(slope * slope / 0.01).epsilon(1e-3));
  }
  // On an axis: the same numbers where the axis passes through the same value.
  auto axis = options;
  axis.y = planes::make_axis("law.lambda", 2, 20, 2, true, {});
  const auto along = inform(bristol_board(1e-3, 1).with("oscillator.stiffness", 0.5), "law.lambda", axis);
  for (std::size_t ix = 0; ix < 3; ++ix) CHECK(along.information[ix] == Approx(design.information[ix]).epsilon(1e-4));
}

namespace {

/// Two blocks on a belt, each with a contact; numbers of the family are the belt's speed and the spring between them.
motion::StructureModel two_blocks(const Model& model, const planes::Numbers& numbers) {
  double speed = 0.1, stiffness = 4;
  for (const auto& [path, value] : numbers) (path == "drive.speed" ? speed : stiffness) = value;
  auto contact = contact_of(model);
  contact.speed = speed;
  motion::StructureModel blocks{oscillators::chain({.mass = {1, 1},
                                                    .coupling_stiffness = {stiffness},
                                                    .coupling_damping = {0.4},
                                                    .pull_stiffness = {1, 1},
                                                    .pull_damping = {0.2, 0.2}},
                                                   {contact, contact}),
                                {}};
  blocks.structure.contacts[1].load_factor = 0.8;
  blocks.start.kind = motion::Start::Kind::rest;
  return blocks;
}

Model block_under(const char* law, std::vector<Value> values) {
  Model model;
  model.law = laws::find_law(law)->with(std::move(values));
  model.drive.normal_load = 1.0;
  return model;
}

planes::Structures family_of_blocks(const Model& model) {
  return {[=](const planes::Numbers& numbers) { return two_blocks(model, numbers); },
          [](const std::string& path) { return path == "drive.speed" ? 0.1 : 4; }};
}
Varied blocks_under(const Model& model) { return Varied(family_of_blocks(model)); }

/// The pin on a disk of Tworzydlo, Becker & Oden (1992) where it squeals.
planes::Structures family_of_pins(const Model& model) {
  return {[=](const planes::Numbers& numbers) {
            auto contact = contact_of(model);
            for (const auto& [path, value] : numbers)
              (path == "drive.speed" ? contact.speed : contact.normal_load) = value;
            oscillators::PinOnDisk rig;
            rig.pin_stiffness = {1.2e6, 2.057e6, 600};
            rig.pin_damping = {100, 130, 0.01};
            rig.normal_law = laws::normal_law(laws::PowerContact{
                .coefficient = 1.25e20, .exponent = 2.5, .bound_coefficient = 1.25e20, .bound_exponent = 2.5});
            motion::StructureModel pin{oscillators::pin_on_disk(rig, contact), {}};
            const auto& names = pin.structure.names;
            pin.start.velocities.assign(names.size(), 0.0);
            for (std::size_t j = 0; j < names.size(); ++j)
              if (names[j].ends_with("normal_displacement")) pin.start.velocities[j] = 0.01;
            return pin;
          },
          [](const std::string& path) { return path == "drive.speed" ? 0.46 : 200; }};
}

/// What a design says at some of its points, against measurements that are drawn by cycles of both members there.
void check_by_drawing(const std::vector<planes::Structures>& members, const DesignOptions& options,
                      std::vector<std::size_t> points) {
  const auto design = discriminate(std::vector{Varied(members[0]), Varied(members[1])}, options);
  REQUIRE(design.failed == 0);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const std::size_t i : points) {
    std::map<std::string, double> values[2];
    for (const int k : {0, 1}) {
      const auto cycle = cycles::find_cycle(members[k].with({{options.x.parameter, options.x.values[i % 2]},
                                                             {options.y.parameter, options.y.values[i / 2]}}),
                                            {.tolerance = 0.1 * options.tolerance});
      REQUIRE(cycle.outcome.complete());
      for (const auto& [name, measure] : cycle.metrics) values[k][name] = measure.value;
    }
    std::vector<double> distances;  // in standard deviations
    double information = 0;
    for (std::size_t m = 0; m < options.noise.size(); ++m) {
      const auto& noise = options.noise[m];
      distances.push_back((values[1][noise.metric] - values[0][noise.metric]) / noise.absolute);
      const double part = 0.5 * distances[m] * distances[m];
      CHECK(design.by_metric[m][i] == Approx(part).epsilon(1e-3));
      information += part;
    }
    CHECK(std::abs(design.information[i] - information) <= design.information_error[i] + 1e-4 * information);
    const int repeats = int(design.repeats[i]), draws = 4000;
    REQUIRE(repeats < 200);
    int right = 0;
    for (int draw = 0; draw < draws; ++draw) {
      double ratio = 0;  // of the likelihoods, the first member being true
      for (int n = 0; n < repeats; ++n)
        for (const double d : distances) {
          const double x = normal(random);
          ratio += 0.5 * (x - d) * (x - d) - 0.5 * x * x;
        }
      right += ratio > 0;
    }
    // That many suffice, and hardly fewer.
    CHECK(double(right) / draws > 0.95 - 0.012);
    const double expected = 0.5 * std::erfc(-std::sqrt(0.5 * information * repeats) / std::sqrt(2.0));
    CHECK(double(right) / draws == Approx(expected).margin(0.015));
  }
}

}  // namespace

TEST_CASE("repeats of a design on two blocks decide rightly as often as asked, on drawn measurements",
          "[discrimination]") {
  DesignOptions options;
  options.x = planes::make_axis("drive.speed", 0.1, 0.12, 2, false, {});
  options.y = planes::make_axis("oscillator.stiffness", 4, 5, 2, false, {});
  options.noise = {{"period", 20, 0}, {"displacement_1_max", 1, 0}, {"stick_fraction_2", 0.5, 0}};
  options.tolerance = 1e-5;
  check_by_drawing(
      {family_of_blocks(block_under("hyperbolic", {1.0, 3.0})), family_of_blocks(block_under("coulomb", {1.0, 0.6}))},
      options, {0, 1, 2, 3});
}

TEST_CASE("repeats of a design on a pin that squeals decide rightly as often as asked, on drawn measurements",
          "[discrimination][long]") {
  DesignOptions options;
  options.x = planes::make_axis("drive.normal_load", 200, 240, 2, false, {});
  options.y = planes::make_axis("drive.speed", 0.4, 0.5, 2, false, {});
  options.noise = {{"slip_rate_max", 0.1, 0}, {"friction_mean", 0.01, 0}, {"stick_fraction", 0.05, 0}};
  options.tolerance = 1e-4;
  check_by_drawing({family_of_pins(block_under("coulomb", {0.25, 0.25})),
                    family_of_pins(block_under("stribeck", {0.27, 0.24, 0.3, 1.0, 0.0}))},
                   options, {0});
}

TEST_CASE("blocks that slide steadily count with what steady sliding shows", "[discrimination]") {
  DesignOptions options;
  options.x = planes::make_axis("drive.speed", 2, 3, 2, false, {});
  options.y = planes::make_axis("oscillator.stiffness", 1.2, 1.3, 2, false, {});
  options.noise = {{"friction_1_mean", 0.01, 0}, {"displacement_2_max", 0.1, 0}, {"stick_fraction_1", 0.01, 0}};
  options.tolerance = 1e-4;
  // μ + 0.3 s/m v grows with slip rate, so that nothing vibrates; K q = μ (N₁, N₂) + …, K the springs.
  const auto blocks = [](double mu) { return blocks_under(block_under("stribeck", {mu, mu, 0.5, 1.0, 0.3})); };
  const auto design = discriminate(std::vector{blocks(0.5), blocks(0.6)}, options);
  REQUIRE(design.failed == 0);
  for (std::size_t i = 0; i < 4; ++i) {
    REQUIRE(design.maps[0].points[i].regime == planes::Regime::stable);
    const double k = options.y.values[i / 2], stiffness = (1 + k) * (1 + k) - k * k;
    const double moved = 0.1 * (k * 1 + (1 + k) * 0.8) / stiffness;
    CHECK(design.by_metric[0][i] == Approx(0.5 * 10 * 10).epsilon(1e-9));
    CHECK(design.by_metric[1][i] == Approx(0.5 * (moved / 0.1) * (moved / 0.1)).epsilon(1e-9));
    CHECK(design.by_metric[2][i] == 0);
  }
  // Of the spring between the blocks steady sliding tells by their places: dq₂/d ln k in standard deviations.
  options.noise = {{"displacement_2_max", 0.1, 0}};
  const auto information = inform(blocks(0.5), "oscillator.stiffness", options);
  for (std::size_t i = 0; i < 4; ++i) {
    const double k = options.y.values[i / 2], mu = 0.5 + 0.3 * options.x.values[i % 2];
    const double slope = k * mu * (1.8 * (1 + 2 * k) - 2 * (k + 0.8 * (1 + k))) / ((1 + 2 * k) * (1 + 2 * k));
    CHECK(information.information[i] == Approx(slope * slope / 0.01).epsilon(1e-3));
  }
}

TEST_CASE("designs that make no sense are refused", "[discrimination]") {
  auto options = small_design();
  const std::vector<Varied> one{bristol_board(1e-3, 1)};
  CHECK_THROWS_WITH(discriminate(one, options), Catch::Contains("two members"));
  options.noise = {{"stick_fraction", 0, 0}};
  CHECK_THROWS_WITH(inform(one[0], "law.lambda", options), Catch::Contains("noise of 'stick_fraction'"));
  options.noise = {{"stick_fractoin", 1, 0}};
  CHECK_THROWS_WITH(inform(one[0], "law.lambda", options), Catch::Contains("stick_fraction"));
  options.noise.clear();
  CHECK_THROWS_WITH(inform(one[0], "law.lambda", options), Catch::Contains("no metric"));
}
