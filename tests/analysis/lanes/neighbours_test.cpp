/// Advice between the points of a tile: polynomials are told exactly, and far away nothing is.
#include "analysis/lanes/neighbours.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin::analysis;
using namespace rosin::analysis::lanes;

namespace {

KnownCycle cycle_of(double value) {
  KnownCycle cycle;
  cycle.fixed_point = Eigen::VectorXd::Constant(2, value);
  cycle.derivative = Eigen::MatrixXd::Identity(2, 2) * value;
  cycle.sensitivity = Eigen::MatrixXd::Constant(1, 2, value);
  cycle.amplitude = value;
  cycle.error_rate = Eigen::VectorXd::Constant(1, value);
  return cycle;
}

/// What sliders at these places are told, each of them in its turn, if the cycles are those of `f`.
template <class F>
std::vector<std::optional<KnownCycle>> told(Tile& tile, const std::vector<std::array<int, 2>>& at, int coarsest, F f) {
  std::vector<GridPlace> places;
  std::vector<std::size_t> members;
  for (const auto& [x, y] : at) {
    members.push_back(places.size());
    places.push_back({&tile, x, y, phase_of(x, y, coarsest)});
  }
  std::vector<std::optional<KnownCycle>> advice(at.size());
  Neighbours neighbours(members, places);
  std::size_t count = 0;
  for (auto i = neighbours.next(); i; i = neighbours.next(), ++count) {
    advice[*i] = neighbours.advice(*i);
    neighbours.finished(*i, f(at[*i][0], at[*i][1]), 1);
  }
  CHECK(count == at.size());
  return advice;
}

}  // namespace

TEST_CASE("neighbours tell a cubic exactly, in one call or in several", "[neighbours]") {
  const auto cubic = [](int x, int y) { return 3 + 0.1 * x - 0.02 * x * x + 1e-3 * x * x * x + 0.05 * y; };
  const auto found = [&](int x, int y) { return std::optional(cycle_of(cubic(x, y))); };
  std::vector<std::array<int, 2>> row;
  for (int x = 0; x <= 12; x += 4) row.push_back({x, 0});
  Tile apart;
  (void)told(apart, row, 4, found);
  const auto later = told(apart, {{6, 0}}, 4, found);
  REQUIRE(later[0]);
  CHECK(later[0]->fixed_point[1] == Approx(cubic(6, 0)).epsilon(1e-14));
  CHECK(later[0]->derivative(0, 0) == Approx(cubic(6, 0)).epsilon(1e-14));
  CHECK(later[0]->derivative_error > 0.1 * std::abs(cubic(4, 0) - cubic(8, 0)));

  row.push_back({6, 0});
  Tile together;
  const auto once = told(together, row, 4, found);
  REQUIRE(once.back());
  CHECK(once.back()->fixed_point == later[0]->fixed_point);
  for (std::size_t k = 0; k + 1 < row.size(); ++k) CHECK_FALSE(once[k]);  // all of the first phase
}

TEST_CASE("nothing is told from one side of the plane to the other, nor by cycles not found", "[neighbours]") {
  Tile tile;
  const auto found = [](int, int) { return std::optional(cycle_of(1)); };
  const auto none = [](int, int) { return std::optional<KnownCycle>(); };
  (void)told(tile, {{0, 0}, {1, 0}}, 1, found);
  (void)told(tile, {{8, 0}, {12, 0}}, 1, none);
  CHECK_FALSE(told(tile, {{10, 0}}, 1, found)[0]);
  CHECK(told(tile, {{2, 0}}, 1, found)[0]);
  CHECK_FALSE(told(tile, {{0, 5}}, 1, found)[0]);  // alone on its row and column
}

TEST_CASE("error rates are found anew at every third halving of the grid", "[neighbours]") {
  Tile tile;
  const auto found = [](int x, int y) { return std::optional(cycle_of(1 + x + y)); };
  std::vector<std::array<int, 2>> all;
  for (int y = 0; y <= 8; ++y)
    for (int x = 0; x <= 8; ++x) all.push_back({x, y});
  const auto advice = told(tile, all, 8, found);
  const auto at = [&](int x, int y) -> const std::optional<KnownCycle>& { return advice[std::size_t(y) * 9 + x]; };
  REQUIRE(at(4, 0));
  CHECK(at(4, 0)->error_rate.size() == 0);
  REQUIRE(at(2, 0));
  REQUIRE(at(2, 0)->error_rate.size() == 1);
  CHECK(at(2, 0)->error_rate[0] == 5);  // the larger one of the two nearest, not that of (8, 0)
  REQUIRE(at(1, 1));
  CHECK(at(1, 1)->error_rate.size() == 1);
}

TEST_CASE("a derivative is known as well as one more neighbour changes it", "[neighbours]") {
  // Slopes that rise linearly, then one that does not.
  const auto straight = [](int x, int) { return std::optional(cycle_of(0.01 * x)); };
  const auto bent = [](int x, int) { return std::optional(cycle_of(0.01 * x + (x == 12 ? 0.2 : 0))); };
  const std::vector<std::array<int, 2>> row = {{0, 0}, {4, 0}, {8, 0}, {12, 0}};
  Tile one, other;
  (void)told(one, row, 4, straight);
  (void)told(other, row, 4, bent);
  CHECK(told(one, {{6, 0}}, 4, straight)[0]->derivative_error < 1e-12);
  // Of four points that to 12 weighs -1/16.
  CHECK(told(other, {{6, 0}}, 4, bent)[0]->derivative_error == Approx(0.2 / 16 * std::sqrt(2)));
}

TEST_CASE("sliders beside those that took long come first in their phase", "[neighbours]") {
  Tile tile;
  std::vector<GridPlace> places;
  std::vector<std::size_t> members;
  for (const int y : {0, 1, 2})
    for (const int x : {0, 4, 8, 2}) {  // the last lies between the others
      members.push_back(places.size());
      places.push_back({&tile, x, 16 * y, x == 2 ? 1 : 0});
    }
  Neighbours neighbours(members, places);
  for (int k = 0; k < 9; ++k) {
    const auto i = neighbours.next();
    REQUIRE(places[*i].phase == 0);
    neighbours.finished(*i, cycle_of(1), places[*i].row == 16 ? 100 : 10);
  }
  CHECK(places[*neighbours.next()].row == 16);
}
