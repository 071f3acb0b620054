/// The banded factorisation against the dense one, narrow orders, and steps of large systems against closed forms.
#include "solvers/steps/stage_algebra.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "oscillators/structure_system.hpp"
#include "solvers/steps/banded_lu.hpp"
#include "solvers/steps/collocation.hpp"

using namespace rosin;
using namespace rosin::solvers::steps;

namespace {

/// Bonds of a ring or a row of unknowns, whose numbers are shuffled.
Pattern bonds(const std::vector<std::pair<int, int>>& pairs, int n) {
  std::vector<std::vector<int>> rows(n);
  for (int i = 0; i < n; ++i) rows[i].push_back(i);
  for (const auto& [i, j] : pairs) rows[i].push_back(j), rows[j].push_back(i);
  Pattern pattern{{0}, {}};
  for (auto& row : rows) {
    std::sort(row.begin(), row.end());
    pattern.column.insert(pattern.column.end(), row.begin(), row.end());
    pattern.row_begin.push_back(int(pattern.column.size()));
  }
  return pattern;
}

int reach(const Pattern& pattern) {
  const auto order = narrow_order(pattern);
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = int(k);
  int reach = 0;
  for (int i = 0; i < pattern.size(); ++i)
    for (int e = pattern.row_begin[i]; e < pattern.row_begin[i + 1]; ++e)
      reach = std::max(reach, std::abs(place[i] - place[pattern.column[e]]));
  return reach;
}

/// Masses of 1 in a row between walls, springs of 1 between them, without contacts.
oscillators::Structure free_row(int n) {
  oscillators::Structure row;
  row.M = Eigen::MatrixXd::Identity(n, n);
  row.C = Eigen::MatrixXd::Zero(n, n);
  row.K = 2 * Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i + 1 < n; ++i) row.K(i, i + 1) = row.K(i + 1, i) = -1;
  return row;
}

}  // namespace

TEST_CASE("a banded factorisation solves what the dense one solves, real and complex") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> part(-1, 1);
  const auto compare = [&]<class Number>(Number, int n, int below, int above) {
    std::vector<Number> dense(n * n, Number(0));
    BandedLu<Number> banded(n, below, above);
    banded.clear();
    for (int i = 0; i < n; ++i) {
      const double size = std::pow(10, 20 * part(random));  // rows may be decades apart
      for (int j = std::max(0, i - below); j <= std::min(n - 1, i + above); ++j) {
        Number a = size * part(random);
        if constexpr (!std::is_same_v<Number, double>) a += Number(0, size * part(random));
        dense[i * n + j] = banded.entries()[banded.place(i, j)] = a;
      }
    }
    std::vector<Number> x(n), y;
    for (auto& value : x) value = part(random);
    y = x;
    std::vector<int> pivot(n);
    REQUIRE(factorise_lu(dense, pivot, n));
    REQUIRE(banded.factorise());
    solve_lu(dense, pivot, n, x.data());
    banded.solve(y.data());
    for (int i = 0; i < n; ++i) CHECK(std::abs(x[i] - y[i]) <= 1e-9 * std::abs(x[i]));
    if constexpr (std::is_same_v<Number, double>) CHECK(banded.determinant_sign() == determinant_sign(dense, pivot, n));
  };
  for (const auto& [n, below, above] : {std::array{40, 3, 2}, {33, 1, 4}, {20, 0, 1}, {1, 0, 0}, {12, 11, 11}}) {
    INFO(n << " rows, " << below << " below, " << above << " above");
    compare(double(), n, below, above);
    compare(std::complex<double>(), n, below, above);
  }
  BandedLu<double> singular(3, 1, 1);
  singular.clear();
  CHECK_FALSE(singular.factorise());
}

TEST_CASE("unknowns come into an order in which neighbours are close") {
  std::mt19937_64 random(11);
  const int n = 500;
  std::vector<int> number(n);
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  std::vector<std::pair<int, int>> row, ring;
  for (int i = 0; i + 1 < n; ++i) row.emplace_back(number[i], number[i + 1]);
  ring = row;
  ring.emplace_back(number[n - 1], number[0]);
  CHECK(reach(bonds(row, n)) == 1);
  CHECK(reach(bonds(ring, n)) == 2);
  // Pieces that are not connected stand one behind another.
  row.erase(row.begin() + n / 2);
  CHECK(reach(bonds(row, n)) == 1);
}

TEST_CASE("two hundred masses in a row swing in their normal modes") {
  const int n = 200;
  const oscillators::StructureSystem system(free_row(n));
  REQUIRE(system.pattern());
  // Modes sin(π k i/(n + 1)) with ω = 2 sin(π k/(2 (n + 1))), a slow and the fastest ones.
  const auto shape = [&](int k, int i) { return std::sin(std::numbers::pi * k * (i + 1) / (n + 1)); };
  const auto frequency = [&](int k) { return 2 * std::sin(std::numbers::pi * k / (2 * (n + 1))); };
  const std::vector<std::pair<int, double>> modes = {{3, 1.0}, {41, 0.3}, {150, 0.2}, {200, 0.1}};
  const auto place = [&](double t) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(n);
    for (const auto& [k, amplitude] : modes)
      for (int i = 0; i < n; ++i) q[i] += amplitude * std::cos(frequency(k) * t) * shape(k, i);
    return q;
  };
  Collocation solver(system, 1e-12);
  REQUIRE(solver.start(0, system.unknowns_at(0, place(0), Eigen::VectorXd::Zero(n))));
  const double end = 20;
  std::vector<double> seen(system.size());
  while (solver.time() < end) {
    REQUIRE(solver.step(end).complete());
    REQUIRE(solver.solve_at(0.37, seen.data()));
    const auto within = place(solver.time_at(0.37));
    for (int i = 0; i < n; ++i) REQUIRE(seen[i] == Approx(within[i]).margin(1e-9));
  }
  const auto expected = place(end);
  for (int i = 0; i < n; ++i) CHECK(solver.state()[i] == Approx(expected[i]).margin(1e-9));
}

TEST_CASE("an oscillation that long steps would damp unseen is followed in large systems too") {
  // Every other mass is stiff and swings by a ten-millionth of its scale, less than the embedded estimate asks for.
  const int n = 200;
  const double stiff = 1e4, small = 1e-9;
  auto row = free_row(n);
  row.K.setZero();
  Eigen::VectorXd q(n);
  for (int i = 0; i < n; ++i) row.K(i, i) = i % 2 ? stiff : 1, q[i] = i % 2 ? small : 1;
  const oscillators::StructureSystem system(row);
  Collocation solver(system, 1e-9);
  REQUIRE(solver.start(0, system.unknowns_at(0, q, Eigen::VectorXd::Zero(n))));
  const double end = 1;
  while (solver.time() < end) REQUIRE(solver.step(end).complete());
  CHECK(solver.state()[50] == Approx(std::cos(end)).margin(1e-8));
  CHECK(solver.state()[51] == Approx(small * std::cos(std::sqrt(stiff) * end)).margin(0.1 * small));
}

TEST_CASE("systems that no algebra serves are refused") {
  auto wide = free_row(100);
  wide.M(0, 1) = wide.M(1, 0) = 0.1;
  const oscillators::StructureSystem shared(wide);
  CHECK_THROWS_WITH(Collocation(shared, 1e-6), Catch::Contains("200 unknowns are more than the collocation takes, 64"));
  // One mass that all others hang on reaches over all.
  auto star = free_row(1200);
  star.K.row(0).setConstant(-1), star.K.col(0).setConstant(-1), star.K(0, 0) = 2000;
  const oscillators::StructureSystem coupled(star);
  CHECK_THROWS_WITH(Collocation(coupled, 1e-6), Catch::Contains("coupled over"));
  const oscillators::StructureSystem row(free_row(40));
  Collocation solver(row, 1e-6);
  REQUIRE(solver.start(0, std::vector<double>(80, 0.1)));
  REQUIRE(solver.step(1).complete());
  std::vector<double> derivative(80 * 80);
  CHECK_THROWS_WITH(solver.propagate(derivative, 80), Catch::Contains("up to 64 unknowns, not of 80"));
}
