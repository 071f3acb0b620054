/// Motion that nothing bounds ends with its rate, and one that goes far without growing exponentially does not.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/servo.hpp"

using namespace rosin;
using namespace rosin::analysis;

namespace {

motion::StructureModel carriage(const oscillators::Servo& servo, double force = 0) {
  oscillators::Model model;
  model.law = laws::find_law("coulomb")->with({0.3, 0.3});
  model.slider = {1, 0, 0};
  model.drive.speed = 0.0, model.drive.normal_load = 1.0, model.drive.force = force;
  motion::StructureModel moving{oscillators::one_slider(model), {}};
  if (servo.proportional > 0) moving.structure = with_servo(std::move(moving.structure), servo);
  moving.start.kind = motion::Start::Kind::rest;
  return moving;
}

motion::Run run_for(const motion::StructureModel& model, double duration) {
  motion::RunOptions options;
  options.duration = duration, options.samples = 10;
  return motion::run_structure(model, options);
}

}  // namespace

TEST_CASE("a servo with too much integral action grows without bound, by its largest eigenvalue", "[motion]") {
  for (const double ki : {20.0, 20'000.0}) {  // kd kp/m = 18 would be stable
    const auto model =
        carriage({.coordinate = 0, .proportional = 3, .integral = ki, .derivative = 6, .reference = 1.0});
    Eigen::Matrix3d A;  // x, ẋ and the integral's force
    A << 0, 1, 0, -3, -6, 1, -ki, 0, 0;
    const double rate = A.eigenvalues().real().maxCoeff();
    const auto run = run_for(model, 1e6);
    INFO(run.outcome.detail);
    CHECK(run.outcome.ending == Ending::unbounded);
    const auto told = run.outcome.detail.find("grows with ");
    REQUIRE(told != std::string::npos);
    CHECK(std::stod(run.outcome.detail.substr(told + 11)) == Approx(rate).epsilon(0.1));
    CHECK(cycles::find_cycle(model, {}).outcome.ending == Ending::unbounded);
  }
}

TEST_CASE("a mass that a constant force carries away has no exponential growth", "[motion]") {
  const double t = 1e8;
  const auto run = run_for(carriage({}, 1.0), t);
  REQUIRE(run.outcome.complete());
  CHECK(run.columns[0].back() == Approx(0.35 * t * t));
}
