/// Periodic motion by steps: circles and lines in closed form, a slider along one axis, a block by its own finer steps.
#include "analysis/cycles/stepped_cycle.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/cycles/stepped_exponent.hpp"
#include "analysis/planes/sweep.hpp"
#include "analysis/steady/plane_sliding.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "laws/catalogue.hpp"
#include "tests/elastic_block.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::cycles;

namespace {

constexpr double pi = std::numbers::pi;

Signal wave(double amplitude, double w, double phase = 0, double mean = 0) {
  return Signal(Signal::Harmonics{mean, {{amplitude, w, phase}}});
}

/// A force of constant size that turns: f = A (cos ωt, sin ωt), equal springs and dampers.
motion::PlaneModel turning(double A, double w, double friction, double damping = 2) {
  motion::PlaneModel model;
  model.mass = {3, {400, 400}, {damping, damping}, friction, friction, {0, 0}, 20, {wave(A, w), wave(A, w, -pi / 2)}};
  return model;
}

/// The radius of circular motion: the force balances (k − mω²)R along the radius, cωR + μN across it.
double radius(double A, double w, double friction, double damping = 2) {
  const double k = 400 - 3 * w * w, c = damping * w, F = friction * 20;
  return (-c * F + std::sqrt(c * c * F * F - (k * k + c * c) * (F * F - A * A))) / (k * k + c * c);
}

StructureCycleOptions to(double tolerance) {
  StructureCycleOptions options;
  options.tolerance = tolerance;
  return options;
}

/// The flat block turned a little from steady sliding, as it is or moved.
/// \param damper  N s/m, beside the spring
motion::SteppedOscillator block(const oscillators::FlatBlock& flat, double step, double tilt, double damper = 0) {
  motion::StructureModel model{flat.structure(), {}};
  const auto& elongation = model.structure.functionals.front().row;
  model.structure.C += damper * elongation * elongation.transpose();
  const auto mesh = flat.mesh();
  model.start.beside = mesh.rigid(0, 0, tilt);
  motion::StartShapes shapes{{{"along", "m"}}, mesh.rigid(1, 0, 0)};
  return motion::stepped(model, {.step = step, .stick_width = flat.width}, shapes);
}

LyapunovSpectrum average_over(const motion::SteppedOscillator& oscillator, double duration, double transient) {
  LyapunovOptions options;
  options.duration = duration, options.transient = transient;
  return lyapunov_spectrum(oscillator, options);
}

}  // namespace

TEST_CASE("a motion that still swings about its period has that of the drive, and not two of them", "[plane]") {
  // Friction of 4e-4 N beside forces of 12 and 9 N: free swings of 11.5 and 8.2 rad/s die out by e^(-t/3).
  motion::PlaneModel model;
  model.mass = {3, {400, 200}, {2, 2}, 0.4, 0.4, {0, 0}, 1e-3, {wave(12, 10), wave(9, 10, 1)}};
  const auto found = find_cycle(motion::stepped(model), to(1e-8));
  REQUIRE(found.outcome.complete());
  CHECK(found.returns == 1);
  CHECK(found.metrics.at("period").value == Approx(2 * pi / 10).epsilon(1e-12));
  CHECK(found.metrics.at("displacement_x_max").value == Approx(12 / std::hypot(100, 20)).epsilon(1e-3));
  CHECK(found.metrics.at("displacement_y_max").value == Approx(9 / std::hypot(100, 20)).epsilon(1e-3));
}

TEST_CASE("a turning force moves a plane slider along the circle of the balance of forces", "[plane]") {
  const double w = 10, A = GENERATE(12.0, 20.0);
  const auto found = find_cycle(motion::stepped(turning(A, w, 0.4)), to(1e-7));
  const double R = radius(A, w, 0.4);
  INFO(A << " N: " << found.outcome.detail);
  REQUIRE(found.outcome.complete());
  CHECK(found.returns == 1);
  CHECK(found.stable);
  const auto is = [&](const char* name, double value) {
    const auto& measure = found.metrics.at(name);
    INFO(name << " " << measure.value << " ± " << measure.error << ", " << value);
    CHECK(std::abs(measure.value - value) <= measure.error + 1e-13 * std::abs(value));
    CHECK(measure.error < 1e-6 * (R + std::abs(value)));
  };
  is("period", 2 * pi / w);
  is("displacement_x_max", R);
  is("displacement_y_amplitude", R);
  is("velocity_x_max", R * w);
  is("slip_distance", 2 * pi * R);
  is("friction_work", 8 * 2 * pi * R);
  is("stick_fraction", 0);
}

TEST_CASE("friction that remembers follows a turning force on the circle of the balance of forces", "[plane]") {
  // On a circle of radius R the slip rate turns as iωR e^{iωt}: ages are steady, and bristles turn as z = w/(iω +
  // σ₀|w|/g).
  using Complex = std::complex<double>;
  constexpr double w = 10, R = 0.06, c = 2, m = 3, k = 400, N = 20;
  const Complex i(0, 1), slip = i * w * R;
  struct Case {
    std::shared_ptr<const FrictionLaw> law;
    Complex friction;  ///< N, against the motion
  };
  const auto ageing = laws::find_law("ageing")->with("a", 0.02)->with("b", 0.01)->with("L", 1e-3)->with("v0", 0.1);
  constexpr double sigma0 = 50, sigma1 = 2, sigma2 = 0.1, mu = 0.3;
  const auto bristles = laws::find_law("lugre")
                            ->with("sigma0", sigma0)
                            ->with("sigma1", sigma1)
                            ->with("sigma2", sigma2)
                            ->with("mu_s", mu)
                            ->with("mu_d", mu);
  const Complex z = slip / (i * w + sigma0 * std::abs(slip) / mu);
  const Case cases[] = {{ageing, N * ageing->steady_friction({R * w, N}).friction * slip / std::abs(slip)},
                        {bristles, N * (sigma0 * z + sigma1 * i * w * z + sigma2 * slip)}};
  for (const auto& [law, friction] : cases) {
    INFO(law->card().name);
    const double A = std::abs((k - m * w * w) * R + c * slip + friction);
    auto model = turning(A, w, 0);
    model.law = law;
    const auto found = find_cycle(motion::stepped(model), to(1e-7));
    INFO(found.outcome.detail);
    REQUIRE(found.outcome.complete());
    CHECK(found.returns == 1);
    CHECK(found.stable);
    const auto is = [&](const char* name, double value) {
      const auto& measure = found.metrics.at(name);
      INFO(name << " " << measure.value << " ± " << measure.error << ", " << value);
      CHECK(std::abs(measure.value - value) <= measure.error + 1e-13 * std::abs(value));
      CHECK(measure.error < 1e-5 * (R + std::abs(value)));
    };
    is("displacement_x_max", R);
    is("velocity_y_amplitude", R * w);
    is("friction_x_max", std::abs(friction));
    is("slip_distance", 2 * pi * R);
    is("friction_work", (friction * std::conj(slip)).real() * 2 * pi / w);
    is("stick_fraction", 0);
  }
}

TEST_CASE("a plane slider pushed along one axis is a slider of one coordinate", "[plane]") {
  motion::PlaneModel line;
  line.mass = {3, {400, 200}, {2, 2}, 0.4, 0.4, {0, 0}, 20, {wave(12, 5), Signal(0.0)}};
  const auto found = find_cycle(motion::stepped(line), to(1e-7));
  oscillators::Model slider;
  slider.law = laws::find_law("coulomb")->with({0.4, 0.4});
  slider.slider = {3, 400, 2};
  slider.drive.speed = 0.0, slider.drive.normal_load = 20, slider.drive.force = wave(12, 5);
  motion::StructureModel structure{oscillators::one_slider(slider), {}};
  structure.start.kind = motion::Start::Kind::rest;
  const auto other = find_cycle(structure, to(1e-9));
  REQUIRE(found.outcome.complete());
  REQUIRE(other.outcome.complete());
  for (const auto& [name, of_one] : {std::pair{"displacement_x_max", "displacement_max"},
                                     {"displacement_x_min", "displacement_min"},
                                     {"velocity_x_max", "velocity_max"},
                                     {"period", "period"},
                                     {"stick_fraction", "stick_fraction"},
                                     {"slip_distance", "slip_distance"},
                                     {"friction_work", "friction_work"}}) {
    const auto &a = found.metrics.at(name), &b = other.metrics.at(of_one);
    INFO(name << " " << a.value << " ± " << a.error << ", " << b.value << " ± " << b.error);
    CHECK(std::abs(a.value - b.value) <= a.error + b.error);
    CHECK(a.error < 1e-5 * std::abs(a.value));
  }
  CHECK(found.metrics.at("displacement_y_amplitude").value < 1e-15);
  CHECK(found.metrics.at("stick_fraction").value > 0.1);
}

TEST_CASE("neighbouring motions in the plane approach each other by the damping alone where friction is small",
          "[plane]") {
  // Along the slip Coulomb friction does nothing, across it N μ/v: eigenvalues with the real part −c/2m.
  const auto spectrum = average_over(motion::stepped(turning(12, 10, 1e-9)), 30, 10);
  REQUIRE(spectrum.outcome.complete());
  REQUIRE(spectrum.exponents.size() == 1);
  const auto& exponent = spectrum.exponents.front();
  INFO(exponent.value << " ± " << exponent.error);
  CHECK(std::abs(exponent.value + 1.0 / 3) <= exponent.error);
  CHECK(exponent.error < 5e-3);
  CHECK(spectrum.clocks == 1);
}

TEST_CASE("a plane slider without damping circles a neutral cycle, and is said to", "[plane]") {
  auto model = turning(12, 10, 1e-9, 0);
  model.displacement = {0.01, 0};
  auto options = to(1e-6);
  options.max_cycles = 60, options.exponent = true;
  const auto found = find_cycle(motion::stepped(model), options);
  CHECK(!found.outcome.complete());
  CHECK(!found.stable);
  CHECK((found.exponent ? found.exponent->is_zero() : found.returns > 0));
}

TEST_CASE("a sweep and a map by steps have the circles of their forces", "[plane]") {
  planes::SweepOptions options;
  options.axis = planes::make_axis("force", 12, 20, 3, false, {});
  options.record = planes::SweepOptions::Record::metrics;
  options.metrics = {"displacement_x_max", "returns"};
  options.tolerance = 1e-6, options.down = true;
  const auto sweep = planes::sweep([](double A) { return motion::stepped(turning(A, 10, 0.4, 6)); }, options);
  REQUIRE(sweep.outcome.complete());
  for (const auto* points : {&sweep.up, &sweep.down})
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& at = (*points)[i].metrics;
      CHECK(at.regime == planes::Regime::cycle);
      const double R = radius(options.axis.values[i], 10, 0.4, 6);
      CHECK(std::abs(at.measures[0] - R) <= at.measure_errors[0]);
      CHECK(at.measure_errors[0] < 1e-5 * R);
      CHECK(at.measures[1] == 1);
    }
  options.record = planes::SweepOptions::Record::section;
  options.transient = 60, options.keep = 4;
  const auto section = planes::sweep([](double A) { return motion::stepped(turning(A, 10, 0.4, 6)); }, options);
  const auto& columns = section.up[1].columns;
  REQUIRE(columns[0].size() == 4);
  CHECK(std::hypot(columns[0][3], columns[1][3]) == Approx(radius(16, 10, 0.4, 6)).epsilon(1e-6));
  CHECK(section.up[1].recurrence == 1);
  options.metrics = {"displacement_z_max"}, options.record = planes::SweepOptions::Record::metrics;
  CHECK_THROWS_WITH(planes::sweep([](double A) { return motion::stepped(turning(A, 10, 0.4, 6)); }, options),
                    Catch::Contains("did you mean 'displacement_x_max'"));
}

TEST_CASE("steady sliding in the plane is damped across the slip by friction over speed", "[plane]") {
  auto model = turning(0, 10, 0.4);
  model.mass.force = {};
  model.mass.surface_velocity = {0.3, 0.4};
  oscillators::FrictionContact like;
  like.law = laws::find_law("coulomb")->with({0.4, 0.4});
  const auto found = steady::stability(steady::sliding_in_plane(model.mass, like));
  CHECK(found.stable);
  CHECK(found.coordinates[0] == Approx(8 * 0.6 / 400));
  CHECK(found.coordinates[1] == Approx(8 * 0.8 / 400));
  // Along e: c/2m; across it (c + μN/V)/2m with V = 0.5.
  REQUIRE(found.modes.size() == 2);
  CHECK(found.modes[0].growth_rate() == Approx(-2.0 / 6));
  CHECK(found.modes[1].growth_rate() == Approx(-(2 + 8 / 0.5) / 6));
  // The motion comes to it, and its exponent is that of the slowest mode.
  const auto oscillator = motion::stepped(model);
  const auto cycle = find_cycle(oscillator, to(1e-6));
  CHECK(cycle.outcome.ending == Ending::none_exists);
  CHECK(cycle.settled == Settled::sliding);
  const auto spectrum = average_over(oscillator, 20, 10);
  REQUIRE(spectrum.exponents.size() == 1);
  CHECK(std::abs(spectrum.exponents[0].value + 1.0 / 3) <= spectrum.exponents[0].error + 1e-3);
  model.mass.surface_velocity = {};
  CHECK_THROWS_WITH(steady::sliding_in_plane(model.mass, like), Catch::Contains("a surface that moves alone"));
  CHECK_THROWS_WITH(motion::stepped(model), Catch::Contains("nothing drives the slider"));
}

TEST_CASE("a block on a fast belt has the cycle with lift-off of an independent code", "[block]") {
  const auto found = find_cycle(block({.elements = 1, .speed = 0.7}, 0.2, 1e-2, 0.3), to(1e-6));
  INFO(found.outcome.detail);
  REQUIRE(found.outcome.complete());
  const auto& m = found.metrics;
  const auto is = [&](const char* name, double value, double margin) {
    INFO(name << " " << m.at(name).value << " ± " << m.at(name).error);
    CHECK(std::abs(m.at(name).value - value) <= margin + m.at(name).error);
  };
  is("elongation_mean", 5, 0.01);
  is("friction_force_mean", 0.25, 1e-4);
  is("stick_fraction", 0, 0);
  // Half the step is within the error that is stated.
  const auto half = find_cycle(block({.elements = 1, .speed = 0.7}, 0.1, 1e-2, 0.3), to(1e-6));
  REQUIRE(half.outcome.complete());
  for (const char* name : {"period", "tilt_max", "tilt_min", "normal_load_max"}) {
    INFO(name << " " << m.at(name).value << " ± " << m.at(name).error << ", " << half.metrics.at(name).value);
    CHECK(std::abs(m.at(name).value - half.metrics.at(name).value) <= m.at(name).error);
  }
}

TEST_CASE("the exponent of a block in steady sliding is the growth of an independent code", "[block]") {
  const auto spectrum = average_over(block({.elements = 4}, 0.1, 0), 120, 120);
  REQUIRE(spectrum.exponents.size() == 1);
  const auto& exponent = spectrum.exponents.front();
  INFO(exponent.value << " ± " << exponent.error);
  CHECK(std::abs(exponent.value - .06286281) <= exponent.error + 3e-5);
}
