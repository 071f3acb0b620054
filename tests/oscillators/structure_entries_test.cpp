/// Large structures: entries of the Jacobian, the same motion by dense and banded algebra, and costs that grow with the
/// number of blocks.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_system.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

FrictionContact under(const char* law, std::vector<double> values, double speed) {
  FrictionContact contact;
  contact.law = laws::find_law(law);
  if (!values.empty()) contact.law = contact.law->with({values.begin(), values.end()});
  contact.speed = speed;
  return contact;
}

/// Blocks in a row, without a spring behind block `parted` (0: all are coupled).
Structure row_of(int n, const FrictionContact& contact, int parted = 0) {
  std::vector<double> coupling(n - 1, 25.0);
  if (parted > 0) coupling[parted - 1] = 0;
  return chain({.mass = std::vector<double>(n, 1.0),
                .coupling_stiffness = coupling,
                .coupling_damping = std::vector<double>(n - 1, 0.0),
                .pull_stiffness = std::vector<double>(n, 1.0),
                .pull_damping = std::vector<double>(n, 0.01)},
               std::vector<FrictionContact>(n, contact));
}
double start_of(int block) { return 0.3 + 0.2 * std::sin(2.3 * block); }
VectorXd starts(int first, int n) {
  return VectorXd::NullaryExpr(n, [&](Eigen::Index i) { return start_of(first + int(i)); });
}

struct Motion {
  std::vector<double> q;
  std::vector<std::pair<double, int>> switches;
  long steps;
};
Motion follow(StructureSystem& system, const std::vector<double>& start, double end, double tolerance) {
  solvers::stick_slip::StickSlip solver(system, tolerance);
  REQUIRE(solver.start(0, start));
  Motion motion;
  while (solver.time() < end) {
    solvers::stick_slip::Switch switched;
    const Outcome outcome = solver.step(end, switched);
    INFO(outcome.detail);
    REQUIRE(outcome.complete());
    for (const auto& event : solver.events()) motion.switches.emplace_back(solver.time(), event.contact);
  }
  motion.q.assign(solver.state().begin(), solver.state().begin() + system.coordinates());
  motion.steps = solver.stepper().count().steps;
  return motion;
}

}  // namespace

TEST_CASE("entries of a structure's Jacobian are those of differences, in every mode") {
  Structure structure;
  structure.M = VectorXd{{1, 0.8, 1.2}}.asDiagonal();
  structure.K = MatrixXd{{2, -0.7, 0}, {-0.7, 1.5, 0.2}, {0.3, 0, 1}};
  structure.C = MatrixXd{{0.1, 0, 0}, {-0.1, 0.2, 0}, {0, 0, 0}};
  auto pressed = under("stribeck", {}, 0.3);
  pressed.tangential = VectorXd{{1, 0, 0}};
  pressed.normal_load = 0.7;
  // Two stations of a power law, the second of which is open.
  pressed.normal = MatrixXd{{0, 0.1}, {0.5, 0}, {1, 0.7}};
  pressed.area = VectorXd{{0.6, 0.8}}, pressed.gap = VectorXd{{-0.5, 0.4}};
  pressed.load_along = VectorXd{{0, 0, 1}};
  pressed.normal_law = laws::normal_law(laws::PowerContact{.coefficient = 3,
                                                           .exponent = 2.5,
                                                           .damping = 0.3,
                                                           .separation_damping = 0.2,
                                                           .damping_exponent = 1.5,
                                                           .bound_of_pressure = true});
  auto creeping = under("ageing", {}, 1e-3), second = under("ageing", {}, 2e-3);
  creeping.tangential = VectorXd{{0, 1, 0}};
  second.tangential = VectorXd{{0, 1.5, 0}};  // on the same mass: no speed of its own
  structure.contacts = {pressed, creeping, second};
  StructureSystem system(structure);
  REQUIRE(system.pattern());
  const Pattern& pattern = *system.pattern();
  const int n = system.size();
  const auto y = system.unknowns_at(0, VectorXd{{0.1, -0.2, 0.3}}, VectorXd{{0.05, 0.02, -0.04}});
  for (const auto mode : {ContactMode::forward, ContactMode::backward, ContactMode::stick}) {
    system.set_mode(0, mode);
    std::vector<double> f(n), there(n), entries(pattern.entries());
    system.linearise_entries(0, y.data(), f.data(), entries.data());
    MatrixXd J = MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i)
      for (int e = pattern.row_begin[i]; e < pattern.row_begin[i + 1]; ++e) J(i, pattern.column[e]) = entries[e];
    for (int j = 0; j < n; ++j) {
      constexpr double h = 1e-6;
      auto moved = y;
      moved[j] += h;
      system.evaluate(0, moved.data(), there.data());
      for (int i = 0; i < n; ++i) {
        INFO(system.unknown(i) << " by " << system.unknown(j));
        CHECK((there[i] - f[i]) / h == Approx(J(i, j)).epsilon(1e-4).margin(1e-4));
      }
    }
  }
}

TEST_CASE("sixty blocks by banded algebra move as their two halves do by dense algebra") {
  // No spring joins the halves. Thirty blocks have sixty unknowns, sixty have a hundred and twenty.
  const auto contact = under("coulomb", {0.6, 0.4}, 0.1);
  const double end = 0.3, tolerance = 1e-10;
  StructureSystem all(row_of(60, contact, 30)), half(row_of(30, contact));
  const auto whole = follow(all, all.unknowns_at(0, starts(0, 60), VectorXd::Zero(60)), end, tolerance);
  CHECK(whole.switches.size() > 30);
  std::vector<std::pair<double, int>> expected;
  for (const int first : {0, 30}) {
    const auto part = follow(half, half.unknowns_at(0, starts(first, 30), VectorXd::Zero(30)), end, tolerance);
    for (int i = 0; i < 30; ++i) CHECK(whole.q[first + i] == Approx(part.q[i]).margin(1e-8));
    for (const auto& [time, block] : part.switches) expected.emplace_back(time, first + block);
  }
  std::sort(expected.begin(), expected.end());
  REQUIRE(whole.switches.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(whole.switches[i].second == expected[i].second);
    CHECK(whole.switches[i].first == Approx(expected[i].first).margin(1e-7));
  }
}

TEST_CASE("a chain of equal blocks switches as one block, all contacts at the same instant") {
  const auto contact = under("coulomb", {0.6, 0.4}, 0.1);
  StructureSystem all(row_of(100, contact)), one(row_of(1, contact));
  const auto single = follow(one, one.unknowns_at(0, VectorXd::Constant(1, 0.5), VectorXd::Constant(1, 0.1)), 9, 1e-10);
  const auto many =
      follow(all, all.unknowns_at(0, VectorXd::Constant(100, 0.5), VectorXd::Constant(100, 0.1)), 9, 1e-10);
  REQUIRE(single.switches.size() == 2);
  REQUIRE(many.switches.size() == 100 * single.switches.size());
  for (std::size_t k = 0; k < single.switches.size(); ++k)
    for (std::size_t i = 0; i < 100; ++i)
      REQUIRE(many.switches[100 * k + i].first == Approx(single.switches[k].first).margin(1e-8));
  for (const double q : many.q) CHECK(q == Approx(single.q[0]).margin(1e-8));
}

TEST_CASE("equal light blocks that weakening friction carries away from steady sliding leave it in large chains too") {
  // All modes grow within one per cent of N |∂μ/∂v|/m, an even number of them.
  const auto contact = under("hyperbolic", {1, 3}, 0.2);
  const auto leaves = [&](int n) {
    auto row = row_of(n, contact);
    row.M *= 1e-4;
    StructureSystem system(row);
    const auto start = system.unknowns_at(0, VectorXd::Constant(n, 1 / 1.6), VectorXd::Constant(n, 1e-12));
    const auto motion = follow(system, start, 3e-3, 1e-6);
    REQUIRE(motion.switches.size() >= std::size_t(n));
    return motion.switches.front().first;
  };
  CHECK(leaves(100) == Approx(leaves(1)).epsilon(1e-3));
}

TEST_CASE("rate-and-state friction: a hundred equal blocks in a row move as one") {
  // Four unknowns a block, one of them algebraic.
  auto contact = under("ageing", {}, 1e-3);
  contact.normal_load = 1;
  StructureSystem all(row_of(100, contact)), one(row_of(1, contact));
  const auto single = follow(one, one.unknowns_at(0, VectorXd::Constant(1, 0.3), VectorXd::Zero(1)), 3, 1e-9);
  const auto many = follow(all, all.unknowns_at(0, VectorXd::Constant(100, 0.3), VectorXd::Zero(100)), 3, 1e-9);
  for (const double q : many.q) CHECK(q == Approx(single.q[0]).margin(1e-7));
}

TEST_CASE("uneven blocks under rate-and-state friction take about as many steps by either algebra") {
  // Sixteen blocks have 64 unknowns. What a contact's state does by itself is no growth of its own.
  auto contact = under("ageing", {}, 0.1);
  const auto steps = [&](int n) {
    StructureSystem system(row_of(n, contact));
    return follow(system, system.unknowns_at(0, starts(0, n), VectorXd::Zero(n)), 0.01, 1e-6).steps;
  };
  const long dense = steps(16), banded = steps(17);
  CHECK(banded < 1.4 * double(dense));
}

TEST_CASE("entries of the Jacobian grow with the number of blocks, steady sliding and a run of a thousand blocks") {
  const auto contact = under("stribeck", {0.6, 0.4, 0.05, 1, 0}, 0.1);
  StructureSystem small(row_of(100, contact)), large(row_of(1000, contact));
  CHECK(large.pattern()->entries() < 10.1 * small.pattern()->entries());
  const auto y = large.steady(0);
  std::vector<double> f(large.size());
  for (int c = 0; c < large.contacts(); ++c) large.set_mode(c, ContactMode::forward);
  large.evaluate(0, y.data(), f.data());
  for (const double rate : f) CHECK(rate == Approx(0).margin(1e-12));

  analysis::motion::StructureModel model;
  model.structure = row_of(1000, contact);
  model.start.kind = analysis::motion::Start::Kind::given;
  for (int i = 0; i < 1000; ++i)
    model.start.coordinates.emplace_back(0.3 + 0.05 * std::sin(0.01 * i)), model.start.velocities.emplace_back(0.0);
  analysis::motion::RunOptions options;
  options.duration = 0.2;
  options.samples = 2;
  options.tolerance = 1e-4;
  const auto result = analysis::motion::run_structure(model, options);
  CHECK(result.outcome.complete());
  CHECK(result.metrics.at("energy_residual") < 1e-6);
}

TEST_CASE("large structures without springs to hold them have no steady sliding") {
  auto loose = row_of(40, under("coulomb", {0.6, 0.4}, 0.1));
  loose.K -= MatrixXd::Identity(40, 40);
  CHECK_THROWS_WITH(StructureSystem(loose).steady(0), Catch::Contains("no steady sliding"));
}
