/// Curves in two parameters against closed forms and AUTO-07p.
#include "analysis/branches/locus.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/structure_hopf.hpp"
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "tests/two_state_slip.hpp"

using namespace rosin;
using namespace rosin::analysis::branches;
using oscillators::Model;

namespace {

Family2 over(const Model& model, const std::string& p_path, const std::string& q_path) {
  return [=](double p, double q) { return oscillator_of(model.with(p_path, p).with(q_path, q)); };
}

Branches at(const Family2& family, double q, const ParameterScale& p) {
  BranchOptions options;
  options.parameter = p;
  return from_steady_sliding([&](double value) { return family(value, q); }, options);
}

const Locus& of(const std::vector<Locus>& curves, const std::string& kind) {
  for (const auto& locus : curves)
    if (locus.kind == kind) return locus;
  FAIL("no " << kind);
  return curves.front();
}

}  // namespace

TEST_CASE("the Hopf curve of a block on a belt follows its closed form", "[branches]") {
  // Friction 0.5 + 0.5 e^(−2 V): the damping that makes up for its slope is N e^(−2 V).
  Model model;
  model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
  model.slider = {1, 1, 0.1};
  model.drive.normal_load = 1.0, model.drive.speed = 1.0;
  const auto family = over(model, "drive.speed", "oscillator.damping");
  LocusOptions options;
  options.p = {0.2, 2.5, false}, options.q = {0.01, 0.5, false};
  Branches found;
  found.crossings.push_back({0.5 * std::log(10.0), 1e-15, false, 1});
  const auto curves = find_loci(family, found, 0.1, options).curves;
  const auto& hopf = of(curves, "hopf");
  CHECK(hopf.points.size() > 40);
  CHECK(hopf.points.front().q == Approx(0.01).epsilon(1e-12));
  CHECK(hopf.points.back().q == Approx(0.5).epsilon(1e-12));
  CHECK(hopf.begins.empty());
  CHECK(hopf.ends.empty());
  for (const auto& [p, q, p_error, q_error, metrics] : hopf.points) {
    CHECK(std::abs(p - 0.5 * std::log(1 / q)) < p_error + q_error / (2 * q) + 1e-12);
    CHECK(p_error < 1e-9);
    CHECK(metrics.at("angular_frequency") == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("the folds of the board slider over speed and clock factor are those of AUTO", "[branches][long]") {
  Model model;
  model.law = laws::preset(*laws::find_law("spinodal"), "bristol-board");
  model.lambda = std::pow(10.0, 0.75);
  model.slider = {1, 1.09, 0};
  model.drive.normal_load = 9.81e-2, model.drive.speed = 1e-3;
  const auto family = over(model, "drive.speed", "law.lambda");
  LocusOptions options;
  options.p = {3e-4, 4e-3, true}, options.q = {std::sqrt(10.0), 10, true}, options.points = 4;
  const auto found = at(family, model.lambda, options.p);
  const auto curves = find_loci(family, found, model.lambda, options).curves;
  const auto& folds = of(curves, "fold");
  // AUTO-07p 0.9.2; on its own curve of folds to a relative 1e-8, at the first to all digits.
  const double wanted[][3] = {
      {std::sqrt(10.0), 1.629455683488e-3, 1e-10}, {model.lambda, 1.29704804e-3, 1e-8}, {10, 1.00316167e-3, 1e-8}};
  for (const auto& [lambda, speed, accuracy] : wanted) {
    const auto there = std::ranges::find_if(
        folds.points, [at = lambda](const auto& point) { return std::abs(point.q / at - 1) < 1e-9; });
    REQUIRE(there != folds.points.end());
    const auto& fold = *there;
    CHECK(std::abs(fold.p / speed - 1) < accuracy);
    CHECK(fold.p_error / speed < 2 * accuracy);  // of a number that is AUTO's to `accuracy`
    CHECK(fold.metrics.at("period") > 9);
  }
  const auto& hopf = of(curves, "hopf");
  CHECK(hopf.points.front().p == Approx(4.0504078e-4).epsilon(1e-7));
}

TEST_CASE("period doublings without mass go in proportion to the load", "[branches]") {
  // Two states, after Gu, Rice, Ruina & Tse (1984): k L1/(σ a) = 0.0695394087541 by shooting.
  const auto model = two_state_slip(350);
  const auto family = over(model, "oscillator.stiffness", "drive.normal_load");
  LocusOptions options;
  options.p = {250, 500, false}, options.q = {0.8, 1.2, false}, options.points = 4;
  const auto found = at(family, 1, {402, 343, false});
  const auto curves = find_loci(family, found, 1, options).curves;
  const auto& doublings = of(curves, "period-doubling");
  CHECK(doublings.points.front().q == Approx(0.8));
  CHECK(doublings.points.back().q == Approx(1.2));
  for (const auto& [stiffness, load, error, q_error, metrics] : doublings.points)
    CHECK(std::abs(stiffness / load - 0.0695394087541 * 5000) < error + 1e-9);
}

TEST_CASE("two modes that merge without damping have no Hopf curve", "[branches]") {
  // At the friction coefficient 404/1200, in closed form.
  Model model;
  model.law = laws::find_law("coulomb")->with({0.6, 0.4});
  model.drive.speed = 1.0, model.drive.normal_load = 1e3;
  const Family2 family = [&](double friction, double stiffness) {
    auto contact = oscillators::contact_of(model.with("law.mu_d", friction));
    contact.tangential = Eigen::Vector2d(1, 0), contact.normal = Eigen::Vector2d(0, 1);
    contact.normal_law = laws::normal_law(laws::LinearContact{.stiffness = stiffness});
    oscillators::Structure structure;
    structure.M = Eigen::Matrix2d::Identity(), structure.C = Eigen::Matrix2d::Zero();
    structure.K = Eigen::Matrix2d{{5.2e7, 1e7}, {1e7, 2e7}};
    structure.names = {"along", "into"}, structure.contacts = {contact};
    return oscillator_of(structure);
  };
  LocusOptions options;
  options.p = {0.3, 0.4, false}, options.q = {2.5e7, 3.6e7, false};
  Branches found;
  found.crossings.push_back({404.0 / 1200 + 9e-14, 1e-13, true, 7141.428});
  const auto loci = find_loci(family, found, 3e7, options);
  REQUIRE(loci.curves.size() == 1);
  CHECK(loci.curves[0].points.empty());
  CHECK_THAT(loci.curves[0].ends, Catch::Contains("no mode crosses by itself"));
}

TEST_CASE("the speed at which stick-slip ends by grazing scales with load and curve", "[branches][long]") {
  // Friction 0.5 + 0.5 e^(−|v|/0.5), damping 0.1, all forces and speeds times q: 1.8366 q by a Runge-Kutta integration
  // of order 4.
  const Family2 family = [](double speed, double q) {
    Model model;
    model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5 * q, 1.0, 0.0});
    model.slider = {1, 1, 0.1};
    model.drive.normal_load = q, model.drive.speed = speed;
    return oscillator_of(model);
  };
  LocusOptions options;
  options.p = {0.5, 2.1, false}, options.q = {0.7, 1.5, false}, options.points = 4;
  const auto found = at(family, 1, options.p);
  const auto curves = find_loci(family, found, 1, options).curves;
  const auto& grazing = of(curves, "grazing");
  REQUIRE(grazing.points.size() >= 3);
  CHECK(grazing.points.front().q == Approx(0.7));
  CHECK(grazing.begins.empty());
  for (const auto& [speed, q, error, q_error, metrics] : grazing.points) {
    CHECK(std::abs(speed / q - 1.8366009722) < error + 1e-8);
    CHECK(metrics.at("period") > 6);
  }
  CHECK(grazing.points.back().p > 1.9);  // and then it leaves the range
  CHECK(grazing.ends.empty());
}

TEST_CASE("the torus of a modulated load comes to the critical stiffness as its amplitude squared", "[branches]") {
  // Ageing law with radiation damping (Perfettini & Schmittbuhl 2001): k/kc = 0.9997466853417 at an amplitude of 1e-3
  // by shooting; without modulation sliding loses its stability at kc (1 − D/(b − a)).
  const Family2 family = [](double stiffness, double amplitude) {
    Model model;
    model.law = laws::find_law("ageing")->with({0.6, 0.01, 0.015, 1e-6, 1e-6});
    model.slider = {0, stiffness, 1};
    model.drive.speed = 1e-6;
    model.drive.normal_load = Signal(Signal::Harmonics{1, {{amplitude, 1.1, 0}}});
    return oscillator_of(model);
  };
  constexpr double critical = 5000 * (1 - 1e-6 / 0.005);
  LocusOptions options;
  options.p = {5100, 4990, false}, options.q = {2e-4, 1e-3, false}, options.points = 2, options.tolerance = 1e-9;
  Model model;
  model.law = laws::find_law("ageing")->with({0.6, 0.01, 0.015, 1e-6, 1e-6});
  model.slider = {0, 5100, 1};
  model.drive.speed = 1e-6;
  model.drive.normal_load = Signal(Signal::Harmonics{1, {{1e-3, 1.1, 0}}});
  const auto settled = settle(model, 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions along;
  along.parameter = options.p, along.tolerance = 1e-9, along.doublings = 0;
  const auto found = from_cycle([&](double p) { return family(p, 1e-3); }, settled, 5100, along);
  const auto curves = find_loci(family, found, 1e-3, options).curves;
  const auto& torus = of(curves, "torus");
  REQUIRE(torus.points.size() >= 3);
  CHECK(torus.points.front().q == Approx(2e-4));
  CHECK(torus.points.back().q == Approx(1e-3));
  CHECK(std::abs(torus.points.back().p - 4998.7334267085) < 5e-8);
  const auto below = [&](const LocusPoint& at) { return (critical - at.p) / (at.q * at.q); };
  CHECK(below(torus.points.front()) / below(torus.points.back()) == Approx(1).margin(0.01));
}

TEST_CASE("the curve of grazing turns in the force at resonance, and is that of the closed form", "[branches][long]") {
  // Constant friction while a block slips one way on a belt: it moves as a linear oscillator under F cos(ωt), whose
  // velocity reaches that of the belt, V, where F = V sqrt(c² + (k/ω − mω)²): least at k = mω², where F = cV.
  constexpr double V = 0.5, c = 0.2, w = 1;
  const Family2 family = [](double stiffness, double amplitude) {
    Model model;
    model.law = laws::find_law("coulomb")->with({0.4, 0.3});
    model.slider = {1, stiffness, c};
    model.drive.speed = V, model.drive.normal_load = 1;
    model.drive.force = Signal(Signal::Harmonics{0, {{amplitude, w, 1}}});
    return oscillator_of(model);
  };
  Model start;
  start.law = laws::find_law("coulomb")->with({0.4, 0.3});
  start.slider = {1, 0.7, c};
  start.drive.speed = V, start.drive.normal_load = 1;
  constexpr double F = 0.16;
  start.drive.force = Signal(Signal::Harmonics{0, {{F, w, 1}}});
  const auto settled = settle(start, 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions along;
  along.parameter = {0.5, 1.5, false};
  const auto found = from_cycle([&](double p) { return family(p, F); }, settled, 0.7, along);
  LocusOptions options;
  options.p = along.parameter, options.q = {0.05, 0.25, false}, options.points = 10;
  // Below resonance slip begins to touch rest; above it, where static friction holds more, stick ends by another
  // grazing.
  const auto& special = found.cycles[0].branch.special;
  REQUIRE(special.size() == 2);
  const auto& touches = special[0].p < special[1].p ? special[0] : special[1];
  CHECK(touches.p == Approx(1 - std::sqrt(F * F / V / V - c * c)).epsilon(1e-10));
  const auto grazing = cycle_locus(family, touches, F, options);
  CHECK(grazing.begins.empty());  // both ends stand at the border of a range
  CHECK(grazing.ends.empty());
  double least = infinity;
  for (const auto& [k, amplitude, k_error, error, metrics] : grazing.points) {
    const double reactance = k / w - w, wanted = V * std::hypot(c, reactance);
    CHECK(std::abs(amplitude - wanted) < error + k_error * V * std::abs(reactance) / wanted / w + 1e-8);
    least = std::min(least, amplitude);
  }
  CHECK(least < 1.05 * c * V);
  CHECK(std::min(grazing.points.front().p, grazing.points.back().p) < 0.56);  // sqrt(0.25²/V² − c²) from resonance
  CHECK(std::max(grazing.points.front().p, grazing.points.back().p) > 1.44);
}

TEST_CASE("a closed curve in two parameters is followed once round", "[branches][long]") {
  // The block of which grazing stands at V = 1.8366009722, at a speed that has this value on a circle of the plane.
  constexpr double grazes = 1.8366009722, radius = 0.3;
  const Family2 family = [](double p, double q) {
    Model model;
    model.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
    model.slider = {1, 1, 0.1};
    model.drive.normal_load = 1.0, model.drive.speed = grazes + p * p + q * q - radius * radius;
    return oscillator_of(model);
  };
  LocusOptions options;
  options.p = {-0.5, 0.5, false}, options.q = {-0.5, 0.5, false}, options.points = 10;
  BranchOptions along;
  along.parameter = {-0.2, -0.5, false};
  // Cycles from rest, at a speed below.
  Model slow;
  slow.law = laws::find_law("stribeck")->with({1.0, 0.5, 0.5, 1.0, 0.0});
  slow.slider = {1, 1, 0.1};
  slow.drive.normal_load = 1.0, slow.drive.speed = grazes + 0.04 - radius * radius;
  const auto settled = settle(slow, 1e-9);
  const auto found = from_cycle([&](double p) { return family(p, 0); }, settled, -0.2, along);
  const auto curves = find_loci(family, found, 0, options).curves;
  REQUIRE(curves.size() == 1);
  const auto& grazing = curves[0];
  CHECK(grazing.ends == "it closes on itself");
  double angle = 0;
  for (std::size_t i = 0; i < grazing.points.size(); ++i) {
    const auto& at = grazing.points[i];
    CHECK(std::abs(std::hypot(at.p, at.q) - radius) < at.p_error + at.q_error + 1e-7);
    if (i == 0) continue;
    const auto& before = grazing.points[i - 1];
    angle += std::atan2(before.p * at.q - before.q * at.p, before.p * at.p + before.q * at.q);
  }
  CHECK(std::abs(angle) == Approx(2 * 3.14159265358979).epsilon(1e-6));
}

TEST_CASE("onset turns from soft to hard where the third derivative of the friction curve is 0", "[branches]") {
  // Friction 0.5 + 0.5 e^(−V²): averaging gives Re c₁/ω = −N μ''' V²/(16 m ω), whatever μ'' is, because a force ẋ²
  // alone is reversible; μ''' = (6 V − 4 V³) e^(−V²) is 0 at V = √(3/2), and the damping there is V e^(−V²).
  Model model;
  model.law = laws::find_law("stribeck")->with({1.0, 0.5, 1.0, 2.0, 0.0});
  model.slider = {1, 2, 0.2};
  model.drive.normal_load = 1.0, model.drive.speed = 1.0;
  const auto family = over(model, "drive.speed", "oscillator.damping");
  const double V = std::sqrt(1.5), c = V * std::exp(-1.5), w = std::sqrt(2.0);
  const auto curvature = [](double v) { return (6 * v - 4 * v * v * v) * std::exp(-v * v); };
  LocusOptions options;
  options.p = {0.9, 2.0, false}, options.q = {0.1, 0.38, false};
  for (const bool as_structure : {false, true}) {
    options.normal_form = [&](double p, double q, double angular_frequency) {
      const auto here = model.with("drive.speed", p).with("oscillator.damping", q);
      return as_structure
                 ? analysis::steady::normal_form(oscillators::one_slider(here), std::complex(0.0, angular_frequency))
                 : analysis::steady::normal_form(here, angular_frequency);
    };
    Branches found;
    const double at = 1.3843;  // V e^(−V²) = 0.2037
    found.crossings.push_back({at, 1e-4, false, w});
    const auto curves = find_loci(family, found, at * std::exp(-at * at), options).curves;
    const auto& hopf = of(curves, "hopf");
    for (const auto& point : hopf.points)
      CHECK(point.metrics.at("first_lyapunov_coefficient") ==
            Approx(-curvature(point.p) * point.p * point.p / (16 * w)).margin(1e-7));
    REQUIRE(hopf.events.size() == 1);
    const auto& bautin = hopf.events[0];
    INFO(bautin.at.p << " ± " << bautin.at.p_error << ", " << bautin.at.q << " ± " << bautin.at.q_error);
    CHECK(bautin.kind == "bautin");
    CHECK(std::abs(bautin.at.p - V) < bautin.at.p_error);
    CHECK(std::abs(bautin.at.q - c) < bautin.at.q_error);
    CHECK(bautin.at.p_error < 1e-6);
  }
}

TEST_CASE("a torus meets its strong resonances where the drive is three and four times as fast", "[branches]") {
  // Friction falls linearly, so that sliding under a force is a linear oscillator: its multipliers are
  // e^((−(c − β)/2 ± iω) 2π/Ω), on the unit circle at c = β with the angle 2π/Ω for k = m.
  laws::FormulaDescription description;
  constexpr Range finite{-1e300, 1e300};
  description.parameters = {{{"mu0", "1", finite, "mu0"}, 0.5}, {{"beta", "s/m", finite, "beta"}, 0.1}};
  description.friction = "mu0 - beta*v", description.static_limit = "mu0";
  const auto law = laws::make_formula(description);
  const Family2 family = [&](double damping, double angular_frequency) {
    Model model;
    model.law = law;
    model.slider = {1, 1, damping};
    model.drive.speed = 1.0, model.drive.normal_load = 1.0;
    model.drive.force = Signal(Signal::Harmonics{0, {{0.2, angular_frequency, 0}}});
    return oscillator_of(model);
  };
  Model start;
  start.law = law;
  start.slider = {1, 1, 0.2};
  start.drive.speed = 1.0, start.drive.normal_load = 1.0;
  start.drive.force = Signal(Signal::Harmonics{0, {{0.2, 3.3, 0}}});
  const auto settled = settle(start, 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions along;
  along.parameter = {0.2, 0.05, false};
  const auto found = from_cycle([&](double p) { return family(p, 3.3); }, settled, 0.2, along);
  LocusOptions options;
  options.p = along.parameter, options.q = {2.7, 4.8, false}, options.points = 5;
  const auto curves = find_loci(family, found, 3.3, options).curves;
  const auto& torus = of(curves, "torus");
  REQUIRE(torus.events.size() == 2);
  const char* kinds[] = {"resonance-1:3", "resonance-1:4"};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& [kind, at] = torus.events[k];
    INFO(kind << " " << at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
    CHECK(kind == kinds[k]);
    CHECK(std::abs(at.q - double(3 + k)) < at.q_error);
    CHECK(std::abs(at.p - 0.1) < at.p_error + 1e-12);
    CHECK(at.q_error < 1e-5);
  }
}

namespace {

/// Friction 1 − v, which is 0 at the speed of the surface, 1 m/s: sliding is at rest at 0 whatever the springs are.
oscillators::FrictionContact pushing_contact(int coordinates) {
  laws::FormulaDescription description;
  constexpr Range finite{-1e300, 1e300};
  description.parameters = {{{"beta", "s/m", finite, "beta"}, 1.0}};
  description.friction = "1 - beta*v", description.static_limit = "1";
  Model model;
  model.law = laws::make_formula(description);
  model.drive.speed = 1.0, model.drive.normal_load = 1.0;
  auto contact = oscillators::contact_of(model);
  contact.tangential = Eigen::VectorXd::Unit(coordinates, 0);
  return contact;
}

}  // namespace

TEST_CASE("a Hopf curve ends in a double zero where the spring vanishes", "[branches]") {
  // λ² + (c − 1) λ + k = 0.
  const Family2 family = [](double damping, double stiffness) {
    oscillators::Structure block;
    block.M = Eigen::MatrixXd::Identity(1, 1), block.C = Eigen::MatrixXd::Constant(1, 1, damping);
    block.K = Eigen::MatrixXd::Constant(1, 1, stiffness), block.names = {"x"};
    block.contacts = {pushing_contact(1)};
    return oscillator_of(block);
  };
  LocusOptions options;
  options.p = {0.5, 1.6, false}, options.q = {1.7, -0.6, false};
  Branches found;
  found.crossings.push_back({1, 1e-15, false, 1});
  const auto curve = find_loci(family, found, 1, options).curves.at(0);
  CHECK(curve.begins.empty());
  CHECK(curve.ends == "the frequency goes to 0");
  REQUIRE(curve.events.size() == 1);
  const auto& [kind, at] = curve.events[0];
  INFO(at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
  CHECK(kind == "bogdanov-takens");
  CHECK(std::abs(at.p - 1) <= at.p_error);
  CHECK(std::abs(at.q) <= at.q_error);
  CHECK(at.q_error < 1e-7);
  CHECK(curve.points.back().q == at.q);
  for (const auto& point : curve.points) {
    CHECK(point.q >= -at.q_error);
    CHECK(point.metrics.at("angular_frequency") == Approx(std::sqrt(std::max(point.q, 0.0))).margin(1e-7));
  }
}

TEST_CASE("on a Hopf curve a second coordinate becomes neutral where its spring does not hold it", "[branches]") {
  // (λ² + γλ + 1)(λ² + dλ + k) = e², γ = c − 1: a root 0 at k = e², where the others are a pair on the axis at
  // dγ² + (1 + d²) γ + dk = 0 with ω² = 1 + k + γd.
  constexpr double d = 0.6, e = 0.3;
  const Family2 family = [&](double damping, double stiffness) {
    oscillators::Structure two;
    two.M = Eigen::Matrix2d::Identity(), two.C = Eigen::Vector2d(damping, d).asDiagonal();
    two.K = Eigen::Matrix2d{{1, e}, {e, stiffness}}, two.names = {"x", "y"};
    two.contacts = {pushing_contact(2)};
    return oscillator_of(two);
  };
  const double k = e * e, b = 1 + d * d, gamma = (std::sqrt(b * b - 4 * d * d * k) - b) / (2 * d);
  LocusOptions options;
  options.p = {0.7, 1.3, false}, options.q = {0.02, 0.31, false};
  Branches found;
  const auto crossing = analysis::steady::Crossing{1 + gamma, 0.01, false, std::sqrt(1 + k + gamma * d)};
  found.crossings.push_back(crossing);
  const auto curve = find_loci(family, found, 0.2, options).curves.at(0);
  REQUIRE(curve.events.size() == 1);
  const auto& [kind, at] = curve.events[0];
  INFO(at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
  CHECK(kind == "zero-hopf");
  CHECK(std::abs(at.p - 1 - gamma) <= at.p_error);
  CHECK(std::abs(at.q - k) <= at.q_error);
  CHECK(at.q_error < 1e-9);
  CHECK(at.metrics.at("angular_frequency") == Approx(std::sqrt(1 + k + gamma * d)).epsilon(1e-9));
}

TEST_CASE("a torus whose load swings twice as fast meets the resonance 1:2", "[branches]") {
  // Friction μ₀ − βv under N(1 + a cos Ωt): x″ + (c − β N(t)) x′ + x = …, multipliers of Hill's equation, whose product
  // is 1 at c = β and whose sum is −2 at Ω = 2.024922599131, by Runge and Kutta's method with extrapolation.
  laws::FormulaDescription description;
  constexpr Range finite{-1e300, 1e300};
  description.parameters = {{{"beta", "s/m", finite, "beta"}, 0.1}};
  description.friction = "0.5 - beta*v", description.static_limit = "0.5";
  const auto law = laws::make_formula(description);
  const auto model = [&](double damping, double angular_frequency) {
    Model block;
    block.law = law;
    block.slider = {1, 1, damping};
    block.drive.speed = 1.0;
    block.drive.normal_load = Signal(Signal::Harmonics{1, {{0.5, angular_frequency, 0}}});
    return block;
  };
  const Family2 family = [&](double damping, double frequency) { return oscillator_of(model(damping, frequency)); };
  const auto settled = settle(model(0.2, 2.5), 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions along;
  along.parameter = {0.2, 0.05, false};
  const auto found = from_cycle([&](double p) { return family(p, 2.5); }, settled, 0.2, along);
  LocusOptions options;
  options.p = along.parameter, options.q = {2, 2.6, false}, options.points = 10;
  const auto curves = find_loci(family, found, 2.5, options).curves;
  const auto& torus = of(curves, "torus");
  REQUIRE(torus.events.size() >= 1);
  const auto& [kind, at] = torus.events.front();
  INFO(at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
  CHECK(kind == "resonance-1:2");
  CHECK(std::abs(at.q - 2.024922599131) < at.q_error);
  CHECK(std::abs(at.p - 0.1) < at.p_error + 1e-12);
  CHECK(at.q_error < 1e-5);
}

namespace {

/// Friction 0.5 − 0.1 (v − 1) + 0.4 (v − 1)³ and a force: x″ + x = 0.1 x′ − 0.4 x′³ + F cos(Ωt), Rayleigh's oscillator.
/// Weakly forced it obeys ż = (1 + iσ) z − |z|² z + γ (Holmes & Rand 1978), with F = 0.1 √(1/3) γ and Ω = 1 ± 0.05 σ.
oscillators::Model forced_rayleigh(double force, double angular_frequency) {
  laws::FormulaDescription description;
  constexpr Range finite{-1e300, 1e300};
  description.parameters = {{{"mu0", "1", finite, "mu0"}, 0.5}, {{"v0", "m/s", finite, "v0"}, 1.0}};
  description.friction = "mu0 - 0.1*(v/v0 - 1) + 0.4*(v/v0 - 1)^3", description.static_limit = "mu0 - 0.3";
  static const auto law = laws::make_formula(description);
  Model model;
  model.law = law;
  model.slider = {1, 1, 0};
  model.drive.speed = 1.0, model.drive.normal_load = 1.0;
  model.drive.force = Signal(Signal::Harmonics{0, {{force, angular_frequency, 0}}});
  return model;
}

std::vector<Locus> loci_over_force(double angular_frequency, const LocusOptions& options) {
  const Family2 family = [](double force, double frequency) {
    return oscillator_of(forced_rayleigh(force, frequency));
  };
  const auto settled = settle(forced_rayleigh(options.p.from, angular_frequency), 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions along;
  along.parameter = options.p, along.doublings = 0;
  const auto found = from_cycle([&](double p) { return family(p, angular_frequency); }, settled, options.p.from, along);
  return find_loci(family, found, angular_frequency, options).curves;
}

}  // namespace

TEST_CASE("a torus of a forced oscillator meets the resonance 1:1 where its fold is", "[branches]") {
  // Both multipliers 1 by shooting with DOP853; σ = γ = 1/2 of the averaged oscillator would be 0.975 and 0.028868.
  LocusOptions options;
  options.p = {0.06, 0.02, false}, options.q = {0.95, 0.98, false}, options.points = 6;
  const auto curves = loci_over_force(0.95, options);
  const auto& torus = of(curves, "torus");
  const auto there = std::ranges::find(torus.events, "resonance-1:1", &LocusEvent::kind);
  REQUIRE(there != torus.events.end());
  const auto& at = there->at;
  INFO(at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
  CHECK(std::abs(at.p - 0.02905376729586) < at.p_error);
  CHECK(std::abs(at.q - 0.9748397343489) < at.q_error);
  CHECK(at.p_error < 1e-6);
  CHECK(at.q_error < 1e-6);
}

TEST_CASE("two folds of a forced oscillator meet in a cusp, and the curve goes on as that of the other", "[branches]") {
  // By shooting with second derivatives, DOP853; σ² = 1/3, γ² = 8/27 of the averaged oscillator would be 0.97113 and
  // 0.031427.
  LocusOptions options;
  options.p = {0.05, 0.02, false}, options.q = {0.9735, 0.967, false}, options.points = 10;
  const auto curves = loci_over_force(0.973, options);
  const auto& fold = of(curves, "fold");
  REQUIRE(fold.events.size() == 1);
  const auto& [kind, at] = fold.events[0];
  INFO(at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
  CHECK(kind == "cusp");
  CHECK(std::abs(at.p - 0.0319094164709) < at.p_error);
  CHECK(std::abs(at.q - 0.9706964740967) < at.q_error);
  CHECK(at.p_error < 1e-7);
  CHECK(at.q_error < 1e-7);
  // One curve with both folds, each from the end of the range.
  CHECK(std::ranges::count(curves, "fold", &Locus::kind) == 1);
  CHECK(fold.points.front().q == Approx(0.9735));
  CHECK(fold.points.back().q == Approx(0.9735));
  CHECK(std::abs(fold.points.front().p - fold.points.back().p) > 1e-4);
  for (const auto& point : fold.points) CHECK(point.q > at.q - 1e-7);
}

TEST_CASE("folds of cycles without a drive meet in a cusp, from whichever of them the curve begins", "[branches]") {
  // x″ + x = (0.1 − c) x′ − b₃ x′³ + 1.92 x′⁵ − 2.9257 x′⁷. In polar coordinates the return map of the radius has slope
  // 1 and no second derivative there, by its equations of variation with DOP853.
  laws::FormulaDescription description;
  constexpr Range finite{-1e300, 1e300};
  description.parameters = {{{"v0", "m/s", finite, "v0"}, 1.0}, {{"b3", "1", finite, "b3"}, 0.38}};
  description.define = {{"u", "1 - v/v0"}};
  description.friction = "0.5 + 0.1*u - b3*u^3 + 1.92*u^5 - 2.9257*u^7", description.static_limit = "0.5";
  Model model;
  model.law = laws::make_formula(description);
  model.slider = {1, 1, 0.05};
  model.drive.speed = 1.0, model.drive.normal_load = 1.0;
  const auto family = over(model, "oscillator.damping", "law.b3");
  const auto settled = settle(model, 1e-9);
  REQUIRE(settled.outcome.complete());
  BranchOptions along;
  along.parameter = {0.05, 0.1, false};
  const auto found = from_cycle([&](double p) { return family(p, 0.38); }, settled, 0.05, along);
  LocusOptions options;
  options.p = along.parameter, options.q = {0.375, 0.41, false}, options.points = 10;
  const auto curves = find_loci(family, found, 0.38, options).curves;
  CHECK(std::ranges::count(curves, "fold", &Locus::kind) == 1);
  const auto& fold = of(curves, "fold");
  REQUIRE(fold.events.size() == 1);
  const auto& [kind, at] = fold.events[0];
  INFO(at.p << " ± " << at.p_error << ", " << at.q << " ± " << at.q_error);
  CHECK(kind == "cusp");
  CHECK(std::abs(at.p - 0.07499983756622) < at.p_error);
  CHECK(std::abs(at.q - 0.4000016267352) < at.q_error);
  CHECK(at.q_error < 1e-6);
  CHECK(std::abs(fold.points.front().p - fold.points.back().p) > 1e-3);
}
