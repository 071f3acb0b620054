/// Laws that contain others as limits: what is left shrinks at the order that the equations give.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/steady/stability.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;
using rosin::tests::bristol_board;

namespace {

/// log₂ of how much less is left after halving: the observed order.
double order(double coarse, double fine) { return std::log2(std::abs(coarse / fine)); }

Model quasi_static(const char* law, std::vector<Value> values, double lambda = 1) {
  Model model;
  model.law = laws::find_law(law)->with(std::move(values));
  model.lambda = lambda;
  model.slider = {.mass = 0, .stiffness = 2000, .damping = 0};
  Signal::Steps steps{{{0, 1e-6}, {5, 1e-5}}};
  model.drive = {.speed = Signal(std::move(steps)), .normal_load = 1.0, .force = 0.0};
  return model;
}

/// Friction after a velocity step through a spring, at its most telling moments.
std::vector<double> after_step(const Model& model) {
  motion::RunOptions options;
  options.times = {5.5, 6, 7, 9, 30};
  options.duration = 30;
  options.tolerance = 1e-11;
  return motion::run(model, options).columns[4];
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("without saturation of healing and without cut-off the spinodal law is the ageing law", "[limits]") {
  // theta = psi t_heal: theta' = 1 − theta/t_heal − v theta/L; what is left goes with c and 1/t_heal.
  const auto ageing = after_step(quasi_static("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}));
  const auto left = [&](double c, double t_heal) {  // mu0, a, b, L, v0, c, t_heal
    return largest_difference(after_step(quasi_static("spinodal", {0.6, 0.010, 0.015, 1e-5, 1e-6, c, t_heal})), ageing);
  };
  CHECK(left(1e-9, 1e8) < 1e-8);
  CHECK(order(left(1e-12, 1e5), left(1e-12, 2e5)) == Approx(1).margin(0.01));
  CHECK(order(left(2e-4, 1e12), left(1e-4, 1e12)) == Approx(1).margin(0.01));
}

TEST_CASE("without evolution effect the ageing law is a rate law, and without direct effect Coulomb friction",
          "[limits]") {
  // mu − (mu0 + a ln(v/v0)) goes with b; that goes with a.
  const auto friction = [](double a, double b) { return after_step(quasi_static("ageing", {0.6, a, b, 1e-5, 1e-6})); };
  const auto rate_only = friction(0.010, 0);
  CHECK(rate_only.back() == Approx(0.6 + 0.010 * std::log(10.0)).epsilon(1e-9));  // steady again
  CHECK(order(largest_difference(friction(0.010, 2e-6), rate_only),
              largest_difference(friction(0.010, 1e-6), rate_only)) == Approx(1).margin(0.01));
  const std::vector<double> coulomb(rate_only.size(), 0.6);
  CHECK(largest_difference(friction(1e-4, 0), coulomb) == Approx(1e-4 * std::log(10.0)).epsilon(1e-3));
}

TEST_CASE("a contact spring that stiffens becomes a rigid contact, in proportion to its compliance", "[limits]") {
  const Model rigid = bristol_board(1e-3, 10);
  const auto with_spring = [&](double k_t) {
    Model model = rigid;
    model.contact_stiffness.tangential = k_t;
    return model;
  };
  const auto critical = [](const Model& model) { return steady::hopf_points(model, "drive.normal_load").at(0).value; };
  const double rigid_load = critical(rigid);
  CHECK(order(critical(with_spring(1e4)) - rigid_load, critical(with_spring(2e4)) - rigid_load) ==
        Approx(1).margin(0.01));
  // Softer springs ring in slip, and the period swings; from k_t of 1e5 N/m on it is monotone.
  const auto period = [](const Model& model) { return cycles::find_cycle(model, {.tolerance = 1e-8}).metrics.period; };
  const double rigid_period = period(rigid);
  CHECK(order(period(with_spring(5e5)) - rigid_period, period(with_spring(1e6)) - rigid_period) ==
        Approx(1).margin(0.05));
}

TEST_CASE("a fast state becomes a friction curve, in proportion to its clock", "[limits]") {
  const auto period = [](double lambda) {
    return cycles::find_cycle(bristol_board(1e-4, lambda), {.tolerance = 1e-11}).metrics.period;
  };
  const double curve = period(0);
  CHECK(std::abs(curve - 20.0875412888) < 1e-8);  // independent integration of the friction curve
  INFO("differences " << period(2e-6) - curve << ", " << period(1e-6) - curve);
  CHECK(order(period(2e-6) - curve, period(1e-6) - curve) == Approx(1).margin(0.1));
}
