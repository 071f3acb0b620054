/// Motions without a period: averages of a chaotic one against an integration outside rosin, balances of force, and a
/// sum of two sinusoids.
#include "analysis/cycles/irregular_motion.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/motion/motion.hpp"
#include "analysis/motion/stepped_oscillator.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::cycles;

namespace {

/// m = 1 on a belt at 0.4 m/s, friction `limit`/(1 + 3|v|), force ½ cos 2t.
analysis::motion::StructureModel belt(double stiffness, double limit) {
  oscillators::Model model;
  model.law = laws::find_law("hyperbolic")->with({limit, 3.0});
  model.slider = {1, stiffness, 0};
  model.drive.speed = 0.4, model.drive.normal_load = 1.0;
  model.drive.force = Signal(Signal::Harmonics{0, {{0.5, 2, 0}}});
  analysis::motion::StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = analysis::motion::Start::Kind::rest;
  return structure;
}

double power(const IrregularMotion& motion, std::size_t column) {
  double sum = 0;
  for (const double density : motion.density[column]) sum += density * motion.frequency[1];
  return sum;
}

}  // namespace

TEST_CASE("a chaotic motion is known for some time, and then by averages whose errors hold", "[long]") {
  const auto motion = irregular_motion(belt(1, 1), {0.0731, 4e-4}, 1e-8, 0.1);
  CHECK(motion.outcome.complete());
  CHECK(motion.regime == "chaotic");
  CHECK(motion.returns == 10'000);
  // An error of 1e-9 grows to a hundredth of the range in ln(1e7)/λ = 220 s, give or take what λ scatters by.
  CHECK(motion.known_until > 110);
  CHECK(motion.known_until < 440);
  // By fixed steps of a method of order 4 with switches by bisection, through 6·10⁵ s.
  struct {
    const char* name;
    double value, of_reference;
  } known[] = {{"displacement_mean", 0.31491, 4e-5},  {"displacement_rms", 0.54820, 3e-4},
               {"velocity_rms", 0.48492, 3e-4},       {"stick_fraction", 0.39116, 2e-4},
               {"friction_work_rate", 0.11589, 5e-5}, {"velocity_mean", 0, 0}};
  for (const auto& [name, value, of_reference] : known) {
    INFO(name);
    const auto& measure = motion.averages.at(name);
    CHECK(measure.error < 0.02 * std::max(std::abs(value), 0.1));
    CHECK(std::abs(measure.value - value) < 4 * std::hypot(measure.error, of_reference));
  }
  // Without a mean acceleration the spring bears the mean of friction.
  const auto& friction = motion.averages.at("friction_force_mean");
  CHECK(std::abs(friction.value - motion.averages.at("displacement_mean").value) < 1e-3);
  // Parseval, but for what a window takes of the slowest.
  const double rms = motion.averages.at("velocity_rms").value;
  CHECK(std::abs(power(motion, 1) - rms * rms) < 0.03 * rms * rms);
}

TEST_CASE("the same block by steps of a slider in the plane has the averages of the line", "[long]") {
  analysis::motion::PlaneModel model;
  model.mass = {1, {1, 1}, {0, 0}, 1, 1, {0.3, 0}, 1, {Signal(Signal::Harmonics{0, {{0.7, 2, 0}}}), Signal(0.0)}};
  model.law = laws::find_law("hyperbolic")->with({1.0, 3.0});
  const auto oscillator = analysis::motion::stepped(model);
  SteppedCycle searched;
  searched.exponent = {0.1, 0.01}, searched.start = oscillator.start;
  const auto motion = irregular_motion(oscillator, searched, 1e-6);
  CHECK(motion.regime == "chaotic");
  CHECK(motion.known_until > 50);  // the axis along which nothing moves does not count
  // As above, through 3·10⁵ s at 0.3 m/s under 0.7 cos 2t.
  for (const auto& [name, value] : {std::pair{"displacement_x_mean", 0.40315},
                                    {"displacement_x_rms", 0.36710},
                                    {"stick_fraction", 0.42404},
                                    {"friction_work_rate", 0.09730}}) {
    INFO(name);
    const auto& measure = motion.averages.at(name);
    CHECK(measure.error < 0.01 * value);
    CHECK(std::abs(measure.value - value) < 4 * measure.error);
  }
}

TEST_CASE("two sinusoids that never meet again are quasi-periodic, and have their two lines", "[long]") {
  // x = −¼ cos 2t + A cos √2 t + B sin √2 t without friction, from 0 at the speed of the belt.
  const auto motion = irregular_motion(belt(2, 1e-12), {1e-9, 1e-7}, 1e-8, 0.1);
  CHECK(motion.regime == "quasi-periodic");
  CHECK(std::isinf(motion.known_until));
  const double A = 0.25, B = 0.4 / std::sqrt(2.0), squares = A * A + B * B;
  const auto& rms = motion.averages.at("displacement_rms");
  CHECK(std::abs(rms.value - std::sqrt((squares + 0.0625) / 2)) < std::max(rms.error, 1e-5));
  const auto& density = motion.density[0];
  const auto peak_near = [&](double frequency) {
    const auto k = std::size_t(std::lround(frequency / motion.frequency[1]));
    double sum = 0;
    for (std::size_t i = k - 3; i <= k + 3; ++i) sum += density[i] * motion.frequency[1];
    return sum;
  };
  CHECK(peak_near(std::sqrt(2.0) / (2 * std::numbers::pi)) == Approx(squares / 2).epsilon(1e-3));
  CHECK(peak_near(1 / std::numbers::pi) == Approx(0.0625 / 2).epsilon(1e-3));
}

TEST_CASE("a motion is called by what its largest exponent leaves certain") {
  CHECK(regime_of({0.07, 0.01}, 3) == "chaotic");
  CHECK(regime_of({0.04, 0.01}, 3).empty());  // neither above zero nor known to be small
  CHECK(regime_of({1e-6, 1e-5}, 3) == "quasi-periodic");
  CHECK(regime_of({-0.07, 0.01}, 3).empty());
}
