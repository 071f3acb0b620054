/// Designs of experiments: information against closed forms, against drawn measurements, and on the board's plane.
#include "analysis/inference/discrimination.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::inference;
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
  const auto design = discriminate(members, options);
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
  const auto same = discriminate(std::vector{one, one}, options);
  CHECK(same.best.information == 0);
  CHECK(same.best.repeats == infinity);
  const auto near = discriminate(std::vector{one, other}, options),
             all = discriminate(std::vector{one, other, third}, options);
  for (std::size_t i = 0; i < all.information.size(); ++i) CHECK(all.information[i] <= near.information[i]);
}

TEST_CASE("of three members each metric has its own hardest pair", "[discrimination]") {
  // The board at three clocks and other weights of its metrics: pairs differ in which metric tells them apart.
  const auto options = small_design();
  const std::vector<Model> members{bristol_board(1e-3, 1), bristol_board(1e-3, 3), bristol_board(2e-3, 2)};
  const auto all = discriminate(members, options);
  std::vector<Design> pairs;
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
    pairs.push_back(discriminate(std::vector{members[std::size_t(a)], members[std::size_t(b)]}, options));
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

TEST_CASE("designs that make no sense are refused", "[discrimination]") {
  auto options = small_design();
  const std::vector<Model> one{bristol_board(1e-3, 1)};
  CHECK_THROWS_WITH(discriminate(one, options), Catch::Contains("two members"));
  options.noise = {{"stick_fraction", 0, 0}};
  CHECK_THROWS_WITH(inform(one[0], "law.lambda", options), Catch::Contains("noise of 'stick_fraction'"));
  options.noise = {{"stick_fractoin", 1, 0}};
  CHECK_THROWS_WITH(inform(one[0], "law.lambda", options), Catch::Contains("stick_fraction"));
  options.noise.clear();
  CHECK_THROWS_WITH(inform(one[0], "law.lambda", options), Catch::Contains("no metric"));
}
