/// What a scene does not use costs nothing: right-hand sides, steps and allocations, counted.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <new>

#include "analysis/motion/run.hpp"
#include "oscillators/slider_lanes.hpp"
#include "oscillators/structure_system.hpp"
#include "solvers/lanes/ensemble.hpp"
#include "solvers/steps/collocation.hpp"
#include "solvers/steps/cvode.hpp"
#include "solvers/steps/explicit.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"
#include "tests/bristol_board.hpp"

namespace {
thread_local long allocations = 0;
}

// All of the library's allocations come through here (SUNDIALS has its own).
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size ? size : 1);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

using namespace rosin;
using namespace rosin::analysis;
using rosin::tests::bristol_board;
using rosin::tests::slider_under;

namespace {

oscillators::Model fault() {
  return slider_under("ageing", {0.6, 0.01, 0.025, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 1e-6, 5e6);
}
motion::Start creep() {
  motion::Start start;
  start.kind = motion::Start::Kind::given;
  start.slip_rate = 0.9e-6;
  start.states["theta"] = 10;
  return start;
}

/// Allocations of `steps` steps after a few that may still make room.
template <class Step>
long allocations_of(int steps, Step step) {
  for (int i = 0; i < 3; ++i) REQUIRE(step());
  const long before = allocations;
  bool done = true;
  for (int i = 0; i < steps; ++i) done = step() && done;
  const long during = allocations - before;
  REQUIRE(done);
  return during;
}

struct Cost {
  long steps, evaluations, allocations;
};
/// Of one run, at a tolerance that needs two passes.
Cost cost_of(const oscillators::Model& model, int samples, motion::Start start) {
  motion::RunOptions options;
  options.duration = 100;
  options.samples = samples;
  options.tolerance = 1e-3;
  options.start = std::move(start);
  const long before = allocations;
  const motion::Run result = motion::run(model, options);
  const long during = allocations - before;
  REQUIRE(result.outcome.complete());
  return {result.cost.steps, result.cost.evaluations, during};
}
motion::Start rest() {
  motion::Start start;
  start.kind = motion::Start::Kind::rest;
  return start;
}

}  // namespace

TEST_CASE("no solver allocates inside a step", "[cost]") {
  {
    const oscillators::SliderSystem system(fault());
    const auto y = motion::starting_point(system, creep());
    solvers::steps::Explicit solver(system, 1e-9);
    solver.start(0, y);
    CHECK(allocations_of(300, [&] { return solver.step(5000).complete(); }) == 0);
    std::vector<double> seen(system.size());
    CHECK(allocations_of(50, [&] {
            const bool done = solver.step(5000).complete();
            solver.interpolate(0.5 * (solver.time_before() + solver.time()), seen.data());
            return done;
          }) == 0);
  }
  for (const auto& model : {fault(), bristol_board(1e-4, 10)}) {
    const oscillators::SliderSystem system(model);
    motion::Start start;
    start.kind = motion::Start::Kind::rest;
    solvers::steps::Collocation solver(system, 1e-9);
    REQUIRE(solver.start(0, motion::starting_point(system, model.slider.mass > 0 ? start : creep())));
    CHECK(allocations_of(100, [&] { return solver.step(500).complete(); }) == 0);
  }
  {
    oscillators::SliderSystem system(slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.01, 2));
    motion::Start start;
    start.kind = motion::Start::Kind::rest;
    solvers::stick_slip::StickSlip solver(system, 1e-9);
    REQUIRE(solver.start(0, motion::starting_point(system, start)));
    solvers::stick_slip::Switch switched;
    // A switch between stick and slip may make room for its location, and for the new mode after it.
    long smooth = 0;
    bool fresh = true;
    for (int i = 0; i < 200; ++i) {
      const long before = allocations;
      REQUIRE(solver.step(1000, switched).complete());
      if (switched == solvers::stick_slip::Switch::none && !fresh) smooth += allocations - before;
      fresh = switched != solvers::stick_slip::Switch::none;
    }
    CHECK(smooth == 0);
  }
  {
    const oscillators::SliderSystem system(bristol_board(1e-4, 10), Unknowns::states);
    motion::Start start;
    start.kind = motion::Start::Kind::rest;
    solvers::steps::Cvode solver(system, 1e-9);
    solver.start(0, motion::starting_point(system, start));
    CHECK(allocations_of(200, [&] { return solver.step(500).complete(); }) == 0);
  }
  {
    const oscillators::SliderSystem system(bristol_board(1e-4, 10));
    oscillators::SliderLanes sliders(system);
    solvers::lanes::Ensemble solver(sliders);
    const auto y = system.steady(0);
    for (int lane = 0; lane < lane_count; ++lane) solver.start(lane, y.data(), 1e-7, 1e-3 * (1 + lane));
    CHECK(allocations_of(300, [&] {
            solver.attempt();
            return true;
          }) == 0);
  }
}

TEST_CASE("a step of a chain makes no more room for a thousand blocks than for a hundred", "[cost]") {
  const auto in_steps = [](std::size_t n) {
    oscillators::FrictionContact contact;
    contact.law = laws::find_law("coulomb")->with({0.6, 0.4});
    contact.speed = 0.1;
    oscillators::StructureSystem system(oscillators::chain({.mass = std::vector<double>(n, 1.0),
                                                            .coupling_stiffness = std::vector<double>(n - 1, 25.0),
                                                            .coupling_damping = std::vector<double>(n - 1, 0.0),
                                                            .pull_stiffness = std::vector<double>(n, 1.0),
                                                            .pull_damping = std::vector<double>(n, 0.0)},
                                                           std::vector<oscillators::FrictionContact>(n, contact)));
    solvers::stick_slip::StickSlip solver(system, 1e-8);
    std::vector<double> q(n);
    for (std::size_t i = 0; i < n; ++i) q[i] = 0.3 + 0.05 * std::sin(0.1 * double(i));
    REQUIRE(solver.start(0, system.unknowns_at(0, Eigen::Map<const Eigen::VectorXd>(q.data(), long(n)),
                                               Eigen::VectorXd::Zero(long(n)))));
    solvers::stick_slip::Switch switched;
    return allocations_of(20, [&] { return solver.step(100, switched).complete(); });
  };
  CHECK(in_steps(100) == 0);
  CHECK(in_steps(1000) == 0);
}

TEST_CASE("recording, events and wrappers cost what they use", "[cost]") {
  std::string table = fmt::format("{:<36} {:>12} {:>8} {:>12}\n", "", "evaluations", "steps", "allocations");
  const auto row = [&](const char* what, const Cost& cost) {
    table += fmt::format("{:<36} {:>12} {:>8} {:>12}\n", what, cost.evaluations, cost.steps, cost.allocations);
    return cost;
  };
  auto board = bristol_board(1e-4, 10);
  const Cost end = row("board slider, its end only", cost_of(board, 1, rest()));
  const Cost record = row("recorded 1000 times", cost_of(board, 1000, rest()));
  auto sprung = board;
  sprung.contact_stiffness.tangential = 100;
  const Cost contact = row("with contact stiffness", cost_of(sprung, 1, rest()));
  auto block = slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.01, 2);
  const Cost events = row("Coulomb block, four switches", cost_of(block, 1, rest()));
  const Cost patch = row("fault patch, its end only", cost_of(fault(), 1, creep()));
  const Cost patch_record = row("fault patch, recorded 1000 times", cost_of(fault(), 1000, creep()));
  INFO(table);
  if (std::getenv("ROSIN_SHOW_COST")) FAIL("shown as asked");

  // Looking changes no step. A sample is a step solved again, from a good prediction.
  CHECK(record.steps == end.steps);
  CHECK(record.evaluations > end.evaluations);
  CHECK(patch_record.steps == patch.steps);
  CHECK(patch_record.evaluations <= patch.evaluations + 6 * 1000);
  // Room is made for each run, pass and break, and for each look at the motion: some five in a step, ten in a long one.
  CHECK(end.allocations < 400 + 15 * end.steps);
  CHECK(patch.allocations < 400 + 60 * patch.steps);
  // What is not there has no unknown.
  CHECK(oscillators::SliderSystem(board).size() == oscillators::SliderSystem(sprung).size());
  CHECK(contact.steps > 0);
  CHECK(events.steps > 0);
}
