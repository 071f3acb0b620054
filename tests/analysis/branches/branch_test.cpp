/// Branches against closed forms, AUTO-07p and shooting: equilibria, cycles through stick, and the points where they
/// change.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/branches/branches.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"
#include "tests/analysis/branches/along.hpp"
#include "tests/bristol_board.hpp"
#include "tests/two_state_slip.hpp"

using namespace rosin;
using namespace rosin::analysis::branches;
using oscillators::Model;
using tests::along;
using tests::board_under;

namespace {

/// x² + p² = 1, whose tangent is along x at p = ±1.
class Circle final : public Problem {
 public:
  Residual residual(const Eigen::VectorXd& x, double p, double, bool) override {
    return {{},
            Eigen::VectorXd::Constant(1, x[0] * x[0] + p * p - 1),
            Eigen::MatrixXd::Constant(1, 1, 2 * x[0]),
            Eigen::VectorXd::Constant(1, 2 * p)};
  }
  const Eigen::VectorXd& scale() const override { return scale_; }
  View view(const Solved& at, const Solved&) override {
    View view;
    view.stable = at.x[0] > 0;
    view.tests = {{"fold", at.x[0]}};
    return view;
  }
  bool refer_to(Eigen::VectorXd&, double, double) override { return false; }
  int in_common() const override { return 1; }

 private:
  Eigen::VectorXd scale_ = Eigen::VectorXd::Ones(1);
};

const BranchPoint& asked(const Branches& found, double value, bool stable) {
  for (const auto& cycle : found.cycles)
    for (const auto& point : cycle.branch.points)
      if (point.asked && std::abs(point.p - value) < 1e-12 * value && point.view.stable == stable) return point;
  FAIL("no " << (stable ? "stable" : "unstable") << " cycle at " << value);
  return found.cycles.front().branch.points.front();
}

std::vector<SpecialPoint> special(const Branches& found, const std::string& kind) {
  std::vector<SpecialPoint> all;
  for (const auto& cycle : found.cycles)
    for (const auto& point : cycle.branch.special)
      if (point.kind == kind) all.push_back(point);
  return all;
}

}  // namespace

TEST_CASE("a branch goes round its folds, which are located to rounding", "[branches]") {
  Circle circle;
  ContinuationOptions options;
  options.parameter = {-2, 2, false};
  options.tolerance = 1e-10;
  options.most_points = 400;
  Continuation continuation(circle, options);
  const auto start = continuation.close(Eigen::VectorXd::Constant(1, 0.9), 0.3);
  REQUIRE(start);
  CHECK(start->x[0] == Approx(std::sqrt(1 - 0.09)).epsilon(1e-12));
  const auto branch = continuation.follow(*start, 1);
  REQUIRE(branch.special.size() >= 2);
  CHECK(std::abs(branch.special[0].p - 1) < 1e-12);
  CHECK(std::abs(branch.special[1].p + 1) < 1e-12);
  for (const auto& point : branch.points) CHECK(std::abs(point.x[0] * point.x[0] + point.p * point.p - 1) < 1e-9);
}

TEST_CASE("cycles of the board slider over load agree with AUTO to all its digits, multipliers too",
          "[branches][long]") {
  BranchOptions options;
  options.parameter = {2e-4, 1e-2, true};
  options.at = {5e-4, 1e-3, 2e-3, 5e-3};
  const Model model = board_under(1e-3, 10, 1e-5);
  const auto found = from_steady_sliding(along(model, "drive.normal_load"), options,
                                         crossings_of(model, "drive.normal_load", options.parameter));
  REQUIRE(found.crossings.size() == 1);
  CHECK(std::abs(found.crossings[0].value - 4.087751405677e-4) < 1e-16);
  const double wanted[][4] = {{5e-4, 10.3643431644, 2.0596458043e-5, 0.800806},
                              {1e-3, 23.1416365606, 8.73493728e-5, 0.397131},
                              {2e-3, 54.2469041447, 2.469646168e-4, 0.244056},
                              {5e-3, 151.538089265, 7.50222525e-4, 0.164519}};
  for (const auto& [load, period, fastest, multiplier] : wanted) {
    const auto& point = asked(found, load, true);
    CHECK(std::abs(point.view.metrics.at("period") / period - 1) < 1e-10);
    CHECK(std::abs(point.view.metrics.at("slip_rate_max") / fastest - 1) < 2e-9);
    CHECK(std::abs(point.view.multipliers.front() - multiplier) < 1e-6);
  }
  CHECK(special(found, "fold").empty());
  CHECK(special(found, "period-doubling").empty());
}

TEST_CASE("a cycle whose disturbances grow 1e10-fold in a period lies on its branch, which turns at a fold",
          "[branches][long]") {
  BranchOptions options;
  options.parameter = {3e-4, 4e-3, true};
  options.at = {1e-3};
  const Model model = board_under(9.81e-2, 1, 1e-3);
  const auto found =
      from_steady_sliding(along(model, "drive.speed"), options, crossings_of(model, "drive.speed", options.parameter));
  const auto& unstable = asked(found, 1e-3, false);
  CHECK(std::abs(unstable.view.metrics.at("period") / 10.0925050294 - 1) < 1e-9);
  CHECK(unstable.view.multipliers.front().real() == Approx(6.9e10).epsilon(0.02));
  CHECK(std::abs(asked(found, 1e-3, true).view.metrics.at("period") / 21.7822862438 - 1) < 1e-10);
  const auto folds = special(found, "fold");
  REQUIRE(folds.size() == 1);
  CHECK(std::abs(folds[0].p / 2.386858673594e-3 - 1) < 1e-10);
  CHECK(folds[0].error < 1e-8 * folds[0].p);
}

TEST_CASE("period doublings of two states lie where shooting has them, five of them, and closer by 4.67",
          "[branches]") {
  const auto model = two_state_slip(400);
  constexpr double stiffness = 5000;
  BranchOptions options;
  options.parameter = {0.0805 * stiffness, 0.0685 * stiffness, false};
  options.doublings = 5;
  const auto found = from_steady_sliding(along(model, "oscillator.stiffness"), options,
                                         crossings_of(model, "oscillator.stiffness", options.parameter));
  REQUIRE(found.crossings.size() == 1);
  CHECK(std::abs(found.crossings[0].value / stiffness - 0.0802755656492) < 1e-12);
  const auto doublings = special(found, "period-doubling");
  REQUIRE(doublings.size() == 5);
  CHECK(std::abs(doublings[0].p / stiffness - 0.0695394087541) < 1e-11);
  CHECK(std::abs(doublings[1].p / stiffness - 0.0687992769253) < 1e-11);
  CHECK(std::abs(doublings[2].p / stiffness - 0.0686671929453) < 1e-11);
  // By collocation (AUTO-07p), to its digits; Feigenbaum's ratio is 4.669.
  CHECK(std::abs(doublings[3].p / stiffness - 0.06863961634) < 2e-11);
  CHECK(std::abs(doublings[4].p / stiffness - 0.06863374015) < 2e-11);
  CHECK((doublings[3].p - doublings[2].p) / (doublings[4].p - doublings[3].p) == Approx(4.693).margin(1e-3));
  CHECK(std::abs(doublings[1].view.metrics.at("period") / 2 - 79.957152893) < 1e-6);
}

TEST_CASE("cycles of dry friction are followed through stick to the speed where they end by grazing", "[branches]") {
  Model model;
  model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
  model.slider = {1, 1, 0.1};
  model.drive.speed = 1.2, model.drive.normal_load = 1.0;
  BranchOptions options;
  options.parameter = {1, 2.5, false};
  options.at = {1.5};
  const auto found = from_steady_sliding(along(model, "drive.speed"), options);
  REQUIRE(found.crossings.size() == 1);
  CHECK(std::abs(found.crossings[0].value - 0.5 * std::log(10)) < 1e-13);  // v₀ ln((μs − μd)/(2 ξ v₀))
  // From the unstable cycle, and from none: the fold where slip begins to touch rest.
  const auto grazing = special(found, "grazing");
  REQUIRE(grazing.size() == 1);
  CHECK(grazing[0].error < 1e-8);
  CHECK(std::abs(grazing[0].p - 1.8366009722) < 1e-8);
  const auto &smooth = asked(found, 1.5, false), &sticks = asked(found, 1.5, true);
  CHECK(smooth.view.metrics.at("stick_fraction") == 0);
  CHECK(smooth.view.metrics.at("slip_rate_min") > 0);
  CHECK(sticks.view.metrics.at("stick_fraction") > 0);
  CHECK(std::abs(sticks.view.multipliers.front()) < 1e-9);  // rest forgets
  // The cycle that is sought from rest is that of the branch.
  const auto settled = settle(model.with("drive.speed", 1.5), 1e-9);
  REQUIRE(settled.outcome.complete());
  CHECK(settled.period == Approx(sticks.view.metrics.at("period")).epsilon(1e-8));
}

TEST_CASE("the forced belt keeps its period three over the force, with its multiplier", "[branches][long]") {
  Model model;
  model.law = laws::find_law("hyperbolic");
  model.slider = {1, 1, 0};
  model.drive.speed = 0.1, model.drive.normal_load = 1.0;
  const auto forced = [&](double amplitude) {
    Model changed = model;
    changed.drive.force = Signal(Signal::Harmonics{0, {{amplitude, 2, 0}}});
    return changed;
  };
  for (const auto& [name, value] : {std::pair{"law.mu_s", 1.0}, {"law.delta", 3.0}}) model = model.with(name, value);
  const auto settled = settle(forced(0.5), 1e-9);
  REQUIRE(settled.outcome.complete());
  REQUIRE(settled.turns == 3);
  BranchOptions options;
  options.parameter = {0.5, 0.51, false};
  options.doublings = 0;
  const auto found = from_cycle([&](double p) { return oscillator_of(forced(p)); }, settled, 0.5, options);
  REQUIRE(found.cycles.size() == 1);
  const auto& first = found.cycles[0].branch.points.front();
  CHECK(std::abs(first.view.multipliers.front() - -0.2574065874) < 1e-8);
  CHECK(std::abs(first.view.metrics.at("stick_fraction") - 0.64253306) < 1e-7);
  CHECK(found.cycles[0].branch.points.size() > 3);
}

TEST_CASE("a load that swings at twice the natural frequency doubles the period where shooting has it", "[branches]") {
  Model model;
  model.law = laws::find_law("ageing")->with({0.6, 0.01, 0.015, 1e-6, 1e-6});
  model.slider = {0, 5500, 1};
  model.drive.speed = 1e-6;
  const auto modulated = [&](double amplitude) {
    Model changed = model;
    changed.drive.normal_load = Signal(Signal::Harmonics{1, {{amplitude, 1.4142, 0}}});
    return changed;
  };
  const auto settled = settle(modulated(1e-4), 1e-8);
  REQUIRE(settled.outcome.complete());
  BranchOptions options;
  options.parameter = {1e-4, 2e-3, true};
  options.doublings = 0;
  const auto found = from_cycle([&](double p) { return oscillator_of(modulated(p)); }, settled, 1e-4, options);
  const auto doublings = special(found, "period-doubling");
  REQUIRE(doublings.size() == 1);
  CHECK(std::abs(doublings[0].p - 0.00166176022533) < 1e-13);
}

TEST_CASE("dry friction with a jump from static to kinetic: stick-slip ends where slip only just comes to rest",
          "[branches]") {
  Model model;
  model.law = laws::find_law("coulomb")->with({1.0, 0.6});
  model.slider = {1, 1, 0.1};
  model.drive.speed = 0.2, model.drive.normal_load = 1.0;
  const auto settled = settle(model, 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions options;
  options.parameter = {0.2, 3, false};
  const auto found = from_cycle(along(model, "drive.speed"), settled, 0.2, options);
  const auto grazing = special(found, "grazing");
  REQUIRE(grazing.size() == 1);
  // Slip under kinetic friction begins where the spring and the damper need the static: ξ = x − μd swings freely from
  // ξ = μs − μd − cV at the speed of the belt, and its lowest slip rate is 0 at the border.
  const double damping = 0.05, w = std::sqrt(1 - damping * damping);
  const auto lowest = [&](double V) {
    const double a = 0.4 - 0.1 * V, b = (V + damping * a) / w;
    const auto slip = [&](double t) {
      const double c = std::cos(w * t), s = std::sin(w * t);
      return V - std::exp(-damping * t) * ((b * w - damping * a) * c - (a * w + damping * b) * s);
    };
    double left = 4.5, right = 7;
    for (int i = 0; i < 80; ++i) {
      const double third = (right - left) / 3;
      if (slip(left + third) < slip(right - third))
        right -= third;
      else
        left += third;
    }
    return slip(left);
  };
  double low = 0.3, high = 0.6;
  for (int i = 0; i < 50; ++i) (lowest(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
  CHECK(std::abs(grazing[0].p - low) < 1e-10);
}
