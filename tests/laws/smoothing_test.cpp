/// Smoothed laws: their values and creep in closed form, what they lose, and motions that others computed.
#include "laws/smoothing.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/steady/stability.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using Type = laws::Smoothing::Type;

namespace {

std::shared_ptr<const FrictionLaw> block_on_belt() { return laws::preset(*laws::find_law("hyperbolic"), "leine"); }

/// S(w) in closed form.
double part_of(Type type, double w) {
  const double size = std::min(std::abs(w), 1.0);
  switch (type) {
    case Type::tanh:
      return std::tanh(w);
    case Type::arctan:
      return 2 * std::atan(w) / std::numbers::pi;
    case Type::linear:
      return std::copysign(size, w);
    case Type::parabolic:
      return std::copysign((2 - size) * size, w);
  }
  return NAN;
}

const Type types[] = {Type::tanh, Type::arctan, Type::linear, Type::parabolic};

}  // namespace

TEST_CASE("smoothing multiplies the friction of slip by S(v/width)", "[laws][smoothing]") {
  const double width = 2e-3, N = 1.7;
  for (const auto type : types) {
    const auto law = laws::smoothed(block_on_belt(), {type, width});
    CHECK_FALSE(law->set_valued());
    const auto contact = law->contact({.unknowns = Unknowns::states});
    for (const double v : {-0.3, -2.1e-3, -1.3e-3, -4e-7, 0.0, 3e-9, 1.9e-3, 2.2e-3, 0.05}) {
      CAPTURE(int(type), v);
      const double mu = part_of(type, v / width) / (1 + 3 * std::abs(v));
      CHECK(law->friction({v, N}, {}) == Approx(mu).epsilon(1e-14));
      double F;
      contact->evaluate({v, N, 0, v < 0 ? -1.0 : 1.0}, nullptr, nullptr, F);
      CHECK(F == Approx(N * mu).epsilon(1e-14));
    }
    // The slope at rest, where no side of |v| counts: N S'(0)/width.
    Slopes<double> slopes;
    double F;
    for (const double direction : {-1.0, 1.0}) {
      contact->linearise({0, N, 0, direction}, nullptr, nullptr, F, slopes);
      const double steepness[] = {1, 2 / std::numbers::pi, 1, 2};
      CHECK(F == 0);
      CHECK(slopes.F_u == Approx(N * steepness[int(type)] / width).epsilon(1e-14));
    }
  }
}

TEST_CASE("a mass that friction could hold creeps at the rate of each smoothing", "[laws][smoothing]") {
  // A force of 0.6 of the limit on a mass without spring, on a surface at rest: width·S⁻¹(0.6).
  const double part = 0.6, width = 1e-3;
  const double rates[] = {std::atanh(part), std::tan(std::numbers::pi * part / 2), part, 1 - std::sqrt(1 - part)};
  for (const auto type : types) {
    oscillators::Model model{.law = laws::smoothed(laws::find_law("coulomb")->with({0.5, 0.5}), {type, width})};
    model.slider = {.mass = 1, .stiffness = 0, .damping = 0};
    model.drive = {.speed = 0.0, .normal_load = 2.0, .force = part};
    analysis::motion::RunOptions options{.duration = 0.5, .samples = 1};
    options.start = {.kind = analysis::motion::Start::Kind::given, .displacement = 0, .velocity = 0};
    const auto run = analysis::motion::run(model, options);
    CAPTURE(int(type));
    CHECK(run.columns[1].back() == Approx(width * rates[int(type)]).epsilon(1e-7));
  }
}

TEST_CASE("smoothing is refused of laws that creep of themselves, and for widths out of range", "[laws][smoothing]") {
  CHECK_THROWS_WITH(laws::smoothed(laws::find_law("spinodal"), {}), Catch::Contains("has no effect: law 'spinodal'"));
  CHECK_THROWS_WITH(laws::smoothed(laws::find_law("coulomb"), {Type::tanh, 0}),
                    Catch::Contains("solver.smoothing.width = 0 is outside 1e-09 … 1000"));
  const auto law = laws::smoothed(laws::find_law("coulomb"), {});
  CHECK_THROWS_AS(law->static_limit(1), InputError);
  CHECK_THROWS_AS(law->flow(), InputError);
  CHECK(std::string(law->with("mu_d", 0.2)->approximation()) == law->approximation());
  CHECK(law->with("mu_d", 0.2)->friction({1, 1}, {}) == Approx(0.2));
}

TEST_CASE("steady sliding in the smoothed layer has the slope of friction there", "[laws][smoothing]") {
  // m = k = N = 1, V = 0.4 of the width: 2 Re s = −F'(V), F = Fs tanh(V/eps)/(1 + 3 V).
  const double eps = 0.05, V = 0.4 * eps, curve = 1 / (1 + 3 * V), t = std::tanh(0.4);
  oscillators::Model model{.law = laws::smoothed(block_on_belt(), {Type::tanh, eps})};
  model.drive.speed = V;
  const auto sliding = analysis::steady::stability(model);
  CHECK(sliding.steady.friction_force == Approx(t * curve).epsilon(1e-14));
  const double slope = (1 - t * t) / eps * curve - 3 * t * curve * curve;
  double sum = 0;
  for (const auto& value : sliding.eigenvalues) sum += value.real();
  CHECK(sum == Approx(-slope).epsilon(1e-12));
}

TEST_CASE("periods of the smoothed block on a belt are those of an independent integration", "[laws][smoothing]") {
  struct Row {
    Type type;
    double width, period;
  };
  for (const auto& [type, width, period] :
       {Row{Type::tanh, 1e-2, 11.281791457}, {Type::tanh, 1e-3, 11.900599944}, {Type::arctan, 1e-2, 9.709680833}}) {
    oscillators::Model model{.law = laws::smoothed(block_on_belt(), {type, width})};
    model.drive.speed = 0.2;
    const auto cycle = analysis::cycles::find_cycle(model, {.tolerance = 1e-10});
    CAPTURE(int(type), width);
    CHECK(std::abs(cycle.metrics.period - period) < 1e-9);
    CHECK(cycle.error.period < 1e-9);
  }
}
