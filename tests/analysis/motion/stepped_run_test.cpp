/// Motions of an elastic block by steps: growth from steady sliding, the cycle with lift-off, and sliding with short
/// sticks, against an independent code.
#include "analysis/motion/stepped_run.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "analysis/motion/stepper.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using oscillators::FlatBlock;

namespace {

Run run(const FlatBlock& block, double tilt, double duration, Stepping stepping, int samples = 100) {
  StructureModel model{block.structure(), {}};
  model.start.beside = block.mesh().rigid(0, 0, tilt);
  stepping.stick_width = block.width;
  RunOptions options;
  options.duration = duration, options.samples = samples, options.stepping = stepping;
  return run_stepped(model, options);
}

/// s of the fit c e^(st) + c̄ e^(s̄t) + d to evenly spaced values, by the linear recurrence of their differences.
std::complex<double> exponent_of(const std::vector<double>& values, double spacing) {
  double aa = 0, ab = 0, bb = 0, ya = 0, yb = 0;
  std::vector<double> d;
  for (std::size_t i = 0; i + 1 < values.size(); ++i) d.push_back(values[i + 1] - values[i]);
  for (std::size_t i = 0; i + 2 < d.size(); ++i) {
    aa += d[i + 1] * d[i + 1], ab += d[i + 1] * d[i], bb += d[i] * d[i];
    ya += d[i + 2] * d[i + 1], yb += d[i + 2] * d[i];
  }
  const double det = aa * bb - ab * ab, p = (ya * bb - yb * ab) / det, q = (yb * aa - ya * ab) / det;
  return std::log(std::complex<double>(p / 2, std::sqrt(-q - p * p / 4))) / spacing;
}

}  // namespace

TEST_CASE("small departures from steady sliding grow as the eigenvalue says, to the order of the scheme") {
  struct Row {
    Stepping stepping;
    bool lumped;
    std::complex<double> wanted;
  };
  for (const auto& [stepping, lumped, wanted] : {Row{{.step = 0.1}, false, {.06286281, .91378036}},
                                                 Row{{Scheme::explicit_steps, 0.01}, true, {.06298736, .91442578}}}) {
    const FlatBlock block{.lumped = lumped};
    const auto found = run(block, 1e-7, 140, stepping, 1400);
    REQUIRE(found.outcome.complete());
    REQUIRE(found.column_names[3] == "tilt");
    const std::vector<double> late(found.columns[3].begin() + 800, found.columns[3].end());
    const auto s = exponent_of(late, 0.1);
    INFO(s << " and " << wanted);
    CHECK(std::abs(s - wanted) < 3e-5);  // the swing on the soft spring stays beside it
  }
}

TEST_CASE("a flat block on a fast belt settles in a cycle whose edges lift off and whose friction is not lowered") {
  const auto found = run({.speed = 0.7}, 1e-2, 1000, {.step = 0.2});
  REQUIRE(found.outcome.complete());
  const auto& m = found.metrics;
  CHECK(m.at("apparent_friction") == Approx(0.5).margin(2e-4));  // exactly, where every station slides forward
  CHECK(m.at("elongation_mean") == Approx(5).margin(0.01));
  CHECK(m.at("stick_fraction") == 0);
  CHECK(m.at("open_fraction") == Approx(.117).margin(2e-3));
  CHECK(m.at("tilt_amplitude") == Approx(.5803).epsilon(0.01));
  CHECK(m.at("tilt_period") == Approx(7.6705).epsilon(4e-3));
  CHECK(m.at("normal_load_max") == Approx(1.0099).epsilon(0.01));
  CHECK(m.at("normal_load_min") == Approx(.2184).epsilon(0.01));
  CHECK(m.at("energy_residual") < 1e-5);
}

TEST_CASE("short sticks of a block on a slow belt lower the friction that is seen") {
  const auto found = run({.speed = 0.1, .width = 0.005}, 1e-2, 300, {.step = 0.1});
  REQUIRE(found.outcome.complete());
  const auto& m = found.metrics;
  CHECK(m.at("apparent_friction") < 0.42);
  CHECK(m.at("apparent_friction") > 0.25);
  CHECK(m.at("stick_fraction") > 0.15);
  CHECK(m.at("full_stick_fraction") > 0.1);
  CHECK(m.at("apparent_friction_error") > 0);
}

TEST_CASE("a structure followed by steps agrees with the same followed from switch to switch") {
  oscillators::ModeCoupling model;
  model.mass[0] = model.mass[1] = 1, model.damping[0] = 0.1;
  model.springs = {{1, 0.4}, {0.7, 1.9}};
  model.contact = laws::normal_law(
      laws::PowerContact{.coefficient = 2, .exponent = 2, .bound_coefficient = 2, .bound_exponent = 2});
  oscillators::FrictionContact contact;
  contact.law = laws::smoothed(laws::find_law("coulomb")->with({0.4, 0.4}), {laws::Smoothing::Type::tanh, 0.2});
  contact.normal_load = 1.5, contact.speed = 0.5;
  StructureModel structure{oscillators::mode_coupling(model, contact, 0.0), {}};
  structure.start.kind = Start::Kind::given;
  structure.start.coordinates = {0.3, 0.9}, structure.start.velocities = {0.2, 0};
  RunOptions options;
  options.duration = 10, options.samples = 20, options.tolerance = 1e-9;
  const auto by_events = run_structure(structure, options);
  options.stepping = Stepping{.step = 0.01};
  const auto by_steps = run_stepped(structure, options);
  REQUIRE(by_events.outcome.complete());
  REQUIRE(by_steps.outcome.complete());
  for (int c : {0, 1})
    for (std::size_t i = 0; i < by_steps.time.size(); ++i)
      CHECK(std::abs(by_steps.columns[c][i] - by_events.columns[c][i]) < 1.5 * by_steps.column_error[c]);
  CHECK(by_steps.column_error[0] < 1e-4);
}

TEST_CASE(
    "a block on a soft spring and a slow belt slides down by flutter, then sticks as a whole until static friction") {
  // Independent explicit steps of 4e-5: down to 22.18 at 355.6, one stick of 1434, release at μ W/k = 50.
  auto model = [] {
    const FlatBlock block{.lumped = true, .speed = 0.02, .width = 0.001};
    auto structure = block.structure();
    const auto mesh = block.mesh();
    structure.K -= (0.05 - 0.005) * mesh.elongation * mesh.elongation.transpose();
    StructureModel of{std::move(structure), {}};
    of.start.beside = mesh.rigid(0, 0, 1e-2);
    return of;
  }();
  const oscillators::StationForces contacts(model.structure);
  const auto mesh = FlatBlock{}.mesh();
  const Eigen::VectorXd start = analysis::steady::steady_sliding(model.structure, contacts) + model.start.beside;
  CHECK(mesh.elongation.dot(start) == Approx(50).epsilon(1e-9));
  const auto stepper =
      make_stepper(model.structure, contacts, {.step = 0.1}, start, Eigen::VectorXd::Zero(model.structure.size()));
  // Full sticks: from when to when all stations move with the belt.
  double since = 0, longest = 0, at_stick = 0, at_release = 0, stuck_at = 0;
  bool sticks = false;
  while (stepper->time() < 2000 && longest == 0) {
    REQUIRE(stepper->advance().complete());
    const Eigen::VectorXd rate = contacts.rows() * stepper->velocities();
    bool all = true;
    for (const auto& contact : contacts.contacts()) all = all && std::abs(0.02 - rate[contact.slip]) < 0.001;
    const double elongation = mesh.elongation.dot(stepper->coordinates());
    if (all && !sticks) since = stepper->time(), stuck_at = elongation;
    if (!all && sticks && stepper->time() - since > 100)
      longest = stepper->time() - since, at_stick = stuck_at, at_release = elongation;
    sticks = all;
  }
  CHECK(at_release == Approx(50).margin(0.05));
  CHECK(at_stick > 20);
  CHECK(at_stick < 25);
  CHECK(longest == Approx((at_release - at_stick) / 0.02).epsilon(0.05));  // creep of what sticks
}
