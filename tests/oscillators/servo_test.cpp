/// Servos that hunt, and coordinates without mass: against an independent integrator and equal structures.
#include "oscillators/servo.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using analysis::cycles::find_cycle;
using analysis::motion::Start;
using analysis::motion::StructureModel;
using Catch::Matchers::Contains;

namespace {

/// 1 kg without a spring on a surface at rest, pressed by 1 N.
Model carriage(double static_friction, double kinetic_friction) {
  Model model;
  model.law = laws::find_law("coulomb")->with({static_friction, kinetic_friction});
  model.slider = {1, 0, 0};
  model.drive.speed = 0.0, model.drive.normal_load = 1.0;
  return model;
}

StructureModel moving_from_rest(Structure structure) {
  StructureModel model{std::move(structure), {}};
  model.start.kind = Start::Kind::rest;
  return model;
}

Structure by_matrices(const Eigen::MatrixXd& M, const Eigen::MatrixXd& C, const Eigen::MatrixXd& K) {
  Structure structure = one_slider(carriage(1.5, 1.0));
  structure.M = M, structure.C = C, structure.K = K;
  structure.names = {"displacement", "second"};
  structure.force.clear();
  structure.contacts[0].tangential = Eigen::Vector2d(1, 0);
  return structure;
}

}  // namespace

TEST_CASE("integral action hunts about its reference where friction at rest is above that in motion", "[servo]") {
  const auto hunting =
      with_servo(one_slider(carriage(1.5, 1.0)),
                 {.coordinate = 0, .proportional = 3, .integral = 4, .derivative = 6, .reference = 1.0});
  const auto cycle = find_cycle(moving_from_rest(hunting), {.tolerance = 1e-8});
  REQUIRE(cycle.outcome.complete());
  // Events located under DOP853 at 1e-12.
  const auto check = [&](const char* name, double expected, double accuracy) {
    const auto& measure = cycle.metrics.at(name);
    INFO(name << " = " << measure.value << " ± " << measure.error);
    CHECK(std::abs(measure.value - expected) <= measure.error + accuracy);
    CHECK(measure.error < 1e-7 * std::abs(expected));
  };
  check("period", 23.369272293086, 1e-11);
  check("displacement_max", 1 + 0.0672401469, 5e-11);
  check("displacement_min", 1 - 0.0672401469, 5e-11);
  // The integrated force alone tells one period from the next: rest forgets the rest.
  REQUIRE(cycle.multipliers.size() == 2);
  CHECK(std::abs(cycle.multipliers[1]) < 1e-9);
  // With a mass that is next to none in place of none.
  auto with_mass = hunting;
  with_mass.M(1, 1) = 1e-9;
  const auto other = find_cycle(moving_from_rest(with_mass), {.tolerance = 1e-8});
  CHECK(other.metrics.at("period").value == Approx(cycle.metrics.at("period").value).epsilon(1e-7));
  CHECK(std::abs(other.multipliers[0] - cycle.multipliers[0]) < 1e-7);
}

TEST_CASE("a servo without integral action is a spring and a damper to its reference", "[servo]") {
  auto model = carriage(0.4, 0.3);
  model.drive.force = Signal(Signal::Harmonics{0, {{1.5, 0.8, 0}}});
  const auto held = with_servo(
      one_slider(model), {.coordinate = 0, .proportional = 1.0, .integral = 0, .derivative = 0.1, .reference = 0.0});
  model.slider.stiffness = 1.0, model.slider.damping = 0.1;
  const auto a = find_cycle(moving_from_rest(held), {}), b = find_cycle(moving_from_rest(one_slider(model)), {});
  REQUIRE(a.outcome.complete());
  for (const auto& [name, measure] : b.metrics) {
    INFO(name);
    CHECK(std::abs(a.metrics.at(name).value - measure.value) <= a.metrics.at(name).error + measure.error);
  }
}

TEST_CASE("references and forces add, unless both vary", "[servo]") {
  auto model = carriage(0.4, 0.3);
  model.drive.force = 2.0;
  const Signal swings(Signal::Harmonics{1, {{0.5, 3, 0.2}}});
  const Servo servo{.coordinate = 0, .proportional = 10, .integral = 4, .derivative = 0, .reference = swings};
  const auto structure = with_servo(one_slider(model), servo);
  REQUIRE(structure.force.size() == 2);
  for (const double t : {0.0, 0.3, 1.7}) {
    CHECK(structure.force[0].value(t) == Approx(2 + 10 * swings.value(t)));
    CHECK(structure.force[1].value(t) == Approx(4 * swings.value(t)));
  }
  CHECK(structure.unit(1) == "N");
  model.drive.force = swings;
  CHECK_THROWS_WITH(with_servo(one_slider(model), servo), Contains("both vary"));
}

TEST_CASE("a coordinate without mass needs something that says how fast it moves", "[servo]") {
  Eigen::Matrix2d M, C, K;
  M << 1, 0, 0, 0;
  C << 6, 0, 0, 0;
  K << 3, -1, 4, 0;
  CHECK_THROWS_WITH(by_matrices(M, C, K).check(), Contains("second has no mass") && Contains("damping of its own"));
  C(1, 1) = 1;
  CHECK_NOTHROW(by_matrices(M, C, K).check());
  Structure stopped = by_matrices(M, C, K);
  stopped.stops = {{.coordinate = 1, .at = 1, .stiffness = 10}};
  CHECK_THROWS_WITH(stopped.check(), Contains("a stop needs a mass"));
  Structure three = by_matrices(M, C, K);
  for (auto* matrix : {&three.M, &three.C, &three.K}) matrix->conservativeResizeLike(Eigen::MatrixXd::Zero(3, 3));
  three.C.bottomRightCorner(2, 2).setOnes();
  three.names.push_back("third");
  three.contacts[0].tangential = Eigen::Vector3d(1, 0, 0);
  CHECK_THROWS_WITH(three.check(), Contains("damping matrix without an inverse"));
}

TEST_CASE("what neither moves nor feeds itself has no periodic motion", "[servo]") {
  Eigen::Matrix2d C, K;
  C << 0.1, 0, 0, 0.1;
  K << 2, -1, -1, 2;
  const auto dies_out = by_matrices(Eigen::Matrix2d::Identity(), C, K);
  CHECK_THROWS_WITH(find_cycle(moving_from_rest(dies_out), {}), Contains("nothing drives the structure"));
  CHECK_FALSE(dies_out.feeds_itself());
  C(1, 1) = -0.1;
  CHECK(by_matrices(Eigen::Matrix2d::Identity(), C, K).feeds_itself());
}

namespace {

/// Coefficients c0 + c1 t + c2 t² of an integral f that obeys f' + f/T = p(t) from f(0) = 0.
double followed(double T, const Eigen::Vector3d& p, double t) {
  const double c2 = T * p[2], c1 = T * (p[1] - 2 * c2), c0 = T * (p[0] - c1);
  return c0 + c1 * t + c2 * t * t - c0 * std::exp(-t / T);
}

analysis::motion::Run run_from_rest(Structure structure, const std::vector<double>& times) {
  auto model = moving_from_rest(std::move(structure));
  analysis::motion::RunOptions options;
  options.times = times, options.duration = times.back(), options.tolerance = 1e-10;
  return analysis::motion::run_structure(model, options);
}

const std::vector<double>& column(const analysis::motion::Run& run, const std::string& name) {
  return run.columns[std::size_t(std::ranges::find(run.column_names, name) - run.column_names.begin())];
}

}  // namespace

TEST_CASE("a servo that has come to rest has no period, although rounding crosses its section", "[servo]") {
  Model model = carriage(0.3, 0.2);
  model.law = laws::find_law("stribeck")->with({0.3, 0.2, 0.01, 2.0, 0.0});
  model.slider.mass = 2.5, model.drive.normal_load = 25.0;
  for (const double ki : {600.0, 620.0}) {
    const auto held = with_servo(
        one_slider(model), {.coordinate = 0, .proportional = 400, .integral = ki, .derivative = 60, .reference = 0.05});
    const auto cycle = find_cycle(moving_from_rest(held), {});
    INFO(ki);
    CHECK(cycle.outcome.ending == Ending::none_exists);
    CHECK(cycle.returns == 0);
  }
}

TEST_CASE("a servo at its limit accelerates its mass steadily until its force falls below", "[servo]") {
  // kp (1 − x) − kd ẋ with kp = 10, kd = 2 begins above L = 3 N; less 1 N of friction 1 kg moves by x = t², up to
  // 10 − 10 t² − 4 t = 3. From there it is the oscillator x'' + 2 x' + 10 x = 9, of ω = 3.
  const auto structure =
      with_servo(one_slider(carriage(1.0, 1.0)),
                 {.coordinate = 0, .proportional = 10, .integral = 0, .derivative = 2, .reference = 1.0, .limit = 3});
  const double leaves = (-4 + std::sqrt(296.0)) / 20, peak = 1.0;
  const auto run = run_from_rest(structure, {0.0, 0.2, 0.4, 0.6, leaves, 0.8, peak});
  REQUIRE(run.outcome.complete());
  const auto& x = column(run, "displacement");
  for (std::size_t i = 0; i < 5; ++i) CHECK(x[i] == Approx(run.time[i] * run.time[i]).margin(1e-9));
  const double a = leaves * leaves - 0.9, b = (2 * leaves + a) / 3;
  for (std::size_t i = 5; i < 7; ++i) {
    const double s = run.time[i] - leaves;
    CHECK(x[i] == Approx(0.9 + std::exp(-s) * (a * std::cos(3 * s) + b * std::sin(3 * s))).margin(1e-8));
  }
  CHECK(run.metrics.at("energy_residual") < 1e-8);
}

TEST_CASE("the integral of a servo goes on at its limit, or follows it within its anti-windup time", "[servo]") {
  // As above, with ki = 4 and x = t² throughout: f = 4 (t − t³/3), or f' + f/T = 4 (1 − x) − (10 (1 − x) − 4 t − 3)/T.
  Servo servo{.coordinate = 0, .proportional = 10, .integral = 4, .derivative = 2, .reference = 1.0, .limit = 3};
  const std::vector<double> times = {0.0, 0.1, 0.3, 0.5};
  const auto wound = run_from_rest(with_servo(one_slider(carriage(1.0, 1.0)), servo), times);
  servo.anti_windup = 0.5;
  const auto followed_limit = run_from_rest(with_servo(one_slider(carriage(1.0, 1.0)), servo), times);
  const double T = servo.anti_windup;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i];
    INFO(t);
    CHECK(column(wound, "displacement")[i] == Approx(t * t).margin(1e-9));
    CHECK(column(wound, "servo_force")[i] == Approx(4 * (t - t * t * t / 3)).margin(1e-8));
    const double f = followed(T, {4 - 7 / T, 4 / T, -4 + 10 / T}, t);
    if (10 - 10 * t * t - 4 * t + f > 3) {
      CHECK(column(followed_limit, "displacement")[i] == Approx(t * t).margin(1e-9));
      CHECK(column(followed_limit, "servo_force")[i] == Approx(f).margin(1e-8));
    }
  }
}

TEST_CASE("steady sliding beyond the limit of a servo is refused with the force that it needs", "[servo]") {
  auto model = carriage(0.5, 0.4);
  model.drive.speed = 1.0, model.drive.normal_load = 10.0;
  const auto held = [&](double limit) {
    return StructureSystem(with_servo(
        one_slider(model),
        {.coordinate = 0, .proportional = 100, .integral = 0, .derivative = 1, .reference = 0.0, .limit = limit}));
  };
  CHECK_NOTHROW(held(4.1).steady(0));
  CHECK_THROWS_WITH(held(3.9).steady(0), Contains("-4 N of the servo, whose limit is 3.9 N"));
  // About a reference that swings, it is that of the mean.
  const Signal swings(Signal::Harmonics{0, {{1, 4, 0}}});
  const auto moving = with_servo(
      one_slider(model),
      {.coordinate = 0, .proportional = 100, .integral = 0, .derivative = 1, .reference = swings, .limit = 4.1});
  CHECK_NOTHROW(StructureSystem(analysis::steady::frozen(moving)).steady(0));
}

TEST_CASE("feedforward makes up for the lag of a derivative on a ramp, but for that of friction", "[servo]") {
  // At a steady speed w kp (r − x) = (kd − c) w + friction.
  const Servo servo{.coordinate = 0,
                    .proportional = 50,
                    .integral = 0,
                    .derivative = 10,
                    .feedforward = 7,
                    .reference = Signal(Signal::Ramp{0, 0.5})};
  const auto run = run_from_rest(with_servo(one_slider(carriage(0.4, 0.3)), servo), {0.0, 9.0, 10.0});
  REQUIRE(run.outcome.complete());
  CHECK(column(run, "displacement").back() == Approx(0.5 * 10 - ((10 - 7) * 0.5 + 0.3) / 50).epsilon(1e-9));
}

TEST_CASE("feedforward of harmonics has the gain and phase of its transfer function", "[servo]") {
  // x/r = (kp + iωc)/(kp − mω² + iω kd) without friction.
  const Signal swings(Signal::Harmonics{0, {{0.1, 4, 0.3}}});
  const Servo servo{
      .coordinate = 0, .proportional = 30, .integral = 0, .derivative = 3, .feedforward = 5, .reference = swings};
  const auto cycle = find_cycle(moving_from_rest(with_servo(one_slider(carriage(0, 0)), servo)), {.tolerance = 1e-9});
  REQUIRE(cycle.outcome.complete());
  const double wanted = 0.1 * std::hypot(30, 4 * 5) / std::hypot(30 - 16, 4 * 3);
  const auto& most = cycle.metrics.at("displacement_max");
  CHECK(std::abs(most.value - wanted) < most.error + 1e-9);
  const Signal jumps(Signal::Steps{{{0, 0}, {1, 1}}});
  auto stepped = servo;
  stepped.reference = jumps;
  CHECK_THROWS_WITH(with_servo(one_slider(carriage(0, 0)), stepped), Contains("a ramp or harmonics"));
}

namespace {

/// A mass of 1 kg alone, which a servo that samples moves from 1 m to 0.
Structure free_mass(Servo servo) {
  Structure structure;
  structure.M = Eigen::MatrixXd::Identity(1, 1), structure.C = structure.K = Eigen::MatrixXd::Zero(1, 1);
  structure.names = {"displacement"}, structure.units = {"m"};
  return with_servo(std::move(structure), servo);
}

analysis::motion::Run run_from_one(Structure structure, double sampling_time, int samples) {
  auto model = moving_from_rest(std::move(structure));
  model.start.coordinates = {1.0};
  analysis::motion::RunOptions options;
  for (int k = 0; k <= samples; ++k) options.times.push_back(k * sampling_time);
  options.duration = options.times.back(), options.tolerance = 1e-10;
  return analysis::motion::run_structure(model, options);
}

}  // namespace

TEST_CASE("a servo that samples moves a mass by the powers of its sampled-data matrix", "[servo]") {
  // x_{k+1} = x + h v + h²/2 u, v_{k+1} = v + h u, u = −kp x − kd v.
  const double kp = 100, kd = 2, h = 0.01;
  const Eigen::Matrix2d A{{1 - kp * h * h / 2, h - kd * h * h / 2}, {-kp * h, 1 - kd * h}};
  const int samples = 40;
  const auto run =
      run_from_one(free_mass({.coordinate = 0, .proportional = kp, .derivative = kd, .sampling_time = h}), h, samples);
  REQUIRE(run.outcome.complete());
  Eigen::Vector2d expected(1, 0);
  for (int k = 0; k <= samples; ++k, expected = A * expected)
    CHECK(column(run, "displacement")[std::size_t(k)] == Approx(expected[0]).margin(1e-9));
  CHECK(run.metrics.at("energy_residual") < 1e-8);
}

TEST_CASE("beyond its longest sampling time a servo grows, by the eigenvalue of its sampled-data matrix", "[servo]") {
  // det A = 1 − kd h + kp h²/2 is 1 at h = 2 kd/kp, where A has a pair of eigenvalues.
  const double kp = 100, kd = 2, longest = 2 * kd / kp;
  const auto end_at = [&](double h) {
    return run_from_one(free_mass({.coordinate = 0, .proportional = kp, .derivative = kd, .sampling_time = h}), h,
                        20'000)
        .outcome;
  };
  const double below = 0.95 * longest, above = 1.05 * longest;
  CHECK(end_at(below).complete());
  const auto outcome = end_at(above);
  REQUIRE(outcome.ending == Ending::unbounded);
  const double growth = std::log(1 - kd * above + kp * above * above / 2) / (2 * above);
  CHECK(std::stod(outcome.detail.substr(outcome.detail.find("grows with ") + 11)) == Approx(growth).epsilon(0.05));
}

TEST_CASE("an encoder's steps and the filter of their differences are what the servo's program computes", "[servo]") {
  const double h = 0.01, q = 3e-3;
  const Servo servo{.coordinate = 0,
                    .proportional = 100,
                    .integral = 150,
                    .derivative = 8,
                    .reference = 0.2,
                    .limit = 30,
                    .anti_windup = 0.1,
                    .sampling_time = h,
                    .encoder_resolution = q,
                    .filter = 0.02};
  const int samples = 100;
  const auto run = run_from_one(free_mass(servo), h, samples);
  REQUIRE(run.outcome.complete());
  double x = 1, v = 0, f = 0, before = q * std::round(x / q), filtered = 0;
  for (int k = 0; k <= samples; ++k) {
    CHECK(column(run, "displacement")[std::size_t(k)] == Approx(x).margin(1e-9));
    const double reading = q * std::round(x / q), error = 0.2 - reading;
    filtered = (servo.filter * filtered + reading - before) / (servo.filter + h), before = reading;
    const double u = 100 * error + f - 8 * filtered, limited = std::clamp(u, -30.0, 30.0);
    f += h * (150 * error - (u - limited) / 0.1);
    x += h * v + h * h / 2 * limited, v += h * limited;
  }
}

TEST_CASE("a servo that samples is followed, and not differentiated", "[servo]") {
  auto structure = with_servo(
      one_slider(carriage(1.5, 1.0)),
      {.coordinate = 0, .proportional = 3, .integral = 4, .derivative = 6, .reference = 1.0, .sampling_time = 0.01});
  CHECK_THROWS_WITH(find_cycle(moving_from_rest(structure), {}), Contains("a clock of its own"));
  structure.contacts[0].speed = 0.1;
  CHECK_THROWS_WITH(analysis::steady::stability(structure), Contains("a servo that samples holds its force"));
}

TEST_CASE("with short samples hunting is that of the servo that acts without delay", "[servo]") {
  const auto positions = [](double sampling_time) {
    Servo servo{.coordinate = 0, .proportional = 3, .integral = 4, .derivative = 6, .reference = 1.0};
    servo.sampling_time = sampling_time;
    auto model = moving_from_rest(with_servo(one_slider(carriage(1.5, 1.0)), servo));
    analysis::motion::RunOptions options;
    options.duration = 60, options.samples = 60, options.tolerance = 1e-6;
    return column(analysis::motion::run_structure(model, options), "displacement");
  };
  const auto exact = positions(0), coarse = positions(0.02), fine = positions(0.005);
  const auto apart = [&](const std::vector<double>& x) {
    double sum = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) sum += std::abs(x[i] - exact[i]) / double(exact.size());
    return sum;
  };
  CHECK(apart(fine) < 2e-3);
  CHECK(apart(fine) < 0.4 * apart(coarse));
}
