/// Events of branches of cycles that are strongly unstable, shrink to a Hopf point, or relax: all that are there, and
/// no others.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/branches/branches.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"
#include "tests/analysis/branches/along.hpp"

using namespace rosin;
using namespace rosin::analysis::branches;
using oscillators::Model;
using tests::along;

namespace {

std::vector<SpecialPoint> all_special(const Branches& found) {
  std::vector<SpecialPoint> all;
  for (const auto& cycle : found.cycles) {
    UNSCOPED_INFO("from " << cycle.from << ": " << cycle.branch.points.size() << " points, "
                          << cycle.branch.outcome.detail);
    for (const auto& point : cycle.branch.special) {
      UNSCOPED_INFO("  " << point.kind << " at " << point.p << " +- " << point.error);
      all.push_back(point);
    }
  }
  return all;
}

}  // namespace

TEST_CASE("cycles that shrink to a Hopf point end there, without an event on the way", "[branches]") {
  Model model;
  model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
  model.slider = {1, 1, 0.1};
  model.drive.speed = 1, model.drive.normal_load = 1.0;
  BranchOptions options;
  options.parameter = {1, 2.2, false};
  const auto found = from_cycle(along(model, "drive.speed"), settle(model, 1e-8), 1, options);
  const auto special = all_special(found);
  REQUIRE(special.size() == 1);
  CHECK(special[0].kind == "grazing");
  // DOP853 at 3e-14: the peak of the slip that leaves rest.
  CHECK(std::abs(special[0].p - 1.836600972207924) <= special[0].error);
  CHECK(special[0].error < 1e-9);
  REQUIRE(found.cycles.size() == 1);
  REQUIRE(found.crossings.size() == 1);
  const double hopf = 0.5 * std::log(10);  // v₀ ln((μs − μd)/(2 ξ v₀))
  CHECK(std::abs(found.crossings[0].value - hopf) <= found.crossings[0].error);
  CHECK(found.crossings[0].error < 1e-12);
  CHECK(found.cycles[0].to_value == found.crossings[0].value);
  CHECK(found.cycles[0].branch.points.size() < 400);
}

TEST_CASE("cycles whose disturbances grow 1e26-fold have the one fold at which the speed turns", "[branches][long]") {
  Model model;
  model.law = laws::preset(*laws::find_law("spinodal"), "bristol-board");
  model.lambda = 0.31622776601683794;
  model.slider = {1, 1.09, 0};
  model.drive.normal_load = 0.0981, model.drive.speed = 1e-3;
  BranchOptions options;
  options.parameter = {3e-4, 6e-3, true};
  const auto found =
      from_steady_sliding(along(model, "drive.speed"), options, crossings_of(model, "drive.speed", options.parameter));
  const auto special = all_special(found);
  REQUIRE(special.size() == 1);
  CHECK(special[0].kind == "fold");
  CHECK(std::abs(special[0].p / 3.219286010105e-3 - 1) < 5e-11);  // AUTO-07p, whose folds are known to that
  CHECK(special[0].error < 1e-11);
  double largest = 0;
  for (const auto& point : found.cycles[0].branch.points) {
    const auto& z = point.view.multipliers;
    const auto& error = point.view.multiplier_errors;
    REQUIRE(z.size() == 2);
    REQUIRE(error.size() == 2);
    largest = std::max(largest, std::abs(z[0]));
    CHECK(error[0] < 1e-5 * std::max(1.0, std::abs(z[0])));
    // By Liouville's formula the other one is the exponential of the trace's integral over the first.
    if (std::abs(z[0]) > 1e24) CHECK(std::abs(z[1]) + error[1] < 1e-100);
  }
  CHECK(largest > 1e26);
}

TEST_CASE("cycles of relaxation are followed in steps of their shape, not of their rest", "[branches][long]") {
  Model model;
  model.law = laws::find_law("ageing")->with({0.6, 0.012, 0.018, 1e-5, 1e-6});
  model.slider = {0, 540, 1e-2};
  model.drive.speed = 1e-6, model.drive.normal_load = 1;
  BranchOptions options;
  options.parameter = {606, 174, false};
  options.tolerance = 1e-10;
  options.at = {540, 300, 180};
  const auto found = from_steady_sliding(along(model, "oscillator.stiffness"), options,
                                         crossings_of(model, "oscillator.stiffness", options.parameter));
  CHECK(all_special(found).empty());
  REQUIRE(found.cycles.size() == 1);
  const auto& branch = found.cycles[0].branch;
  CHECK(branch.outcome.detail == "");
  CHECK(branch.points.size() < 500);
  std::vector<double> periods;
  for (const auto& point : branch.points)
    if (point.asked) periods.push_back(point.view.metrics.at("period"));
  // AUTO-07p; the first is 259.6300800666(3) by the search for one cycle.
  const double wanted[] = {259.63008010, 456.46417937, 753.19775400};
  REQUIRE(periods.size() == 3);
  for (int i = 0; i < 3; ++i) CHECK(std::abs(periods[std::size_t(i)] / wanted[i] - 1) < 2e-10);
}
