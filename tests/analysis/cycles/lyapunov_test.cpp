/// Lyapunov exponents against independent integrations, a one-dimensional map, closed forms and sums.
#include "analysis/cycles/lyapunov.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/cycles/section_map.hpp"
#include "laws/catalogue.hpp"
#include "laws/smoothing.hpp"

using namespace rosin;
using namespace rosin::analysis::cycles;
using analysis::motion::Start;
using analysis::motion::StructureModel;

namespace {

Signal cosine(double amplitude, double angular_frequency) {
  return Signal(Signal::Harmonics{0, {{amplitude, angular_frequency, 0}}});
}

/// m = k = 1 on a belt, friction F_s/(1 + 3|v|), force F₀ cos 2t.
StructureModel belt(const Signal& speed, double limit, double force, double damping = 0) {
  oscillators::Model model;
  model.law = laws::find_law("hyperbolic")->with({limit, 3.0});
  model.slider = {1, 1, damping};
  model.drive.speed = speed, model.drive.normal_load = 1.0;
  if (force > 0) model.drive.force = cosine(force, 2);
  StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = Start::Kind::rest;
  return structure;
}

StructureModel smoothed(StructureModel model, double width) {
  auto& law = model.structure.contacts[0].law;
  law = laws::smoothed(law, {laws::Smoothing::Type::tanh, width});
  return model;
}

LyapunovSpectrum spectrum_of(const StructureModel& model, double duration, double transient = -1) {
  return lyapunov_spectrum(model, {.duration = duration, .transient = transient});
}

}  // namespace

TEST_CASE("exponents of periodic motions with stick are those of their multipliers") {
  // By two independent integrators with located events; the period-three one by saltation and by differences.
  const auto forced = spectrum_of(belt(0.1, 1, 0.5), 300);
  CHECK(forced.from == "cycle");
  CHECK(forced.clocks == 1);
  REQUIRE(forced.exponents.size() == 2);
  CHECK(std::abs(forced.exponents[0].value + 0.1439927) < 1.5e-7);
  CHECK(forced.exponents[0].error < 1e-8);
  CHECK(forced.exponents[1].value == -infinity);
  CHECK(forced.stick_fraction.at(0) == Approx(0.64253306).margin(5e-9));
  CHECK(forced.switches == 4);

  const auto swinging = spectrum_of(belt(cosine(0.1, 0.1), 0.6, 0), 1000);
  REQUIRE(swinging.exponents.size() == 2);
  CHECK(std::abs(swinging.exponents[0].value + 0.060645259) < 1e-9);
  CHECK(swinging.exponents[1].value == -infinity);
}

TEST_CASE("a motion that is not driven has a zero along its flow, and forgets the rest in stick") {
  const auto spectrum = spectrum_of(belt(0.2, 1, 0), 300);
  CHECK(spectrum.from == "cycle");
  CHECK(spectrum.clocks == 0);
  REQUIRE(spectrum.exponents.size() == 2);
  CHECK(spectrum.exponents[0].trivial);
  CHECK(spectrum.exponents[0].value == 0);
  CHECK(spectrum.exponents[1].value == -infinity);
}

TEST_CASE("an oscillation that dies out has the growth rates of steady sliding") {
  const double damping = 1;
  const auto spectrum = spectrum_of(belt(0.2, 0.3, 0, damping), 300);
  CHECK(spectrum.from == "steady");
  REQUIRE(spectrum.exponents.size() == 2);
  const double slope = -0.9 / (1.6 * 1.6);  // of the friction at 0.2 m/s
  for (const auto& exponent : spectrum.exponents)
    CHECK(exponent.value == Approx(-(damping + slope) / 2).epsilon(1e-12));
}

TEST_CASE("chaotic stick–slip agrees with long runs elsewhere, and with the slope of a one-dimensional map", "[long]") {
  const auto model = belt(0.4, 1, 0.5);
  const auto spectrum = spectrum_of(model, 6000);
  CHECK(spectrum.from == "average");
  CHECK(spectrum.levelled);
  REQUIRE(spectrum.exponents.size() == 2);
  const auto [value, error, trivial] = spectrum.exponents[0];
  // 0.0731(4), two runs of 4·10⁵ s.
  CHECK(error < 0.01);
  CHECK(error > 0.001);
  CHECK(std::abs(value - 0.0731) < 3 * std::hypot(error, 4e-4));
  CHECK(spectrum.exponents[1].value == -infinity);
  CHECK(spectrum.stick_fraction.at(0) == Approx(0.391).margin(0.01));

  // Stick forgets all but the phase at which it ends. Slopes of this map by two motions from neighbouring phases.
  SectionMap map(model.structure);
  auto& system = map.system();
  const double period = map.drive_period(), V = 0.4, aside = 1e-7;
  const auto next_release = [&](double t) {
    analysis::motion::Follower follower(system, 1e-11);
    std::vector<double> y =
        system.unknowns_at(t, Eigen::VectorXd::Constant(1, 1 + 0.5 * std::cos(2 * t)), Eigen::VectorXd::Constant(1, V));
    double release = 0;
    bool has_stuck = false;
    follower.observe = [&](auto& step, auto events) {
      for (const auto& event : events) {
        if (event.kind == std::string("stick")) has_stuck = true;
        if (event.kind == std::string("slip") && has_stuck && release == 0) release = step.time();
      }
    };
    while (release == 0) {
      follower.follow(t, y, t + period);
      t = follower.time();
    }
    return release;
  };
  double t = next_release(1.4), logs = 0;
  const double begin = t;
  for (int k = 0; k < 400; ++k) {
    const double phase = std::fmod(t, period);
    const double ahead = next_release(phase + aside), behind = next_release(phase - aside);
    logs += std::log(std::abs(ahead - behind) / (2 * aside));
    t += next_release(phase) - phase;
  }
  CHECK(std::abs(logs / (t - begin) - 0.0731) < 0.02);
}

TEST_CASE("a search that finds no period says by its largest exponent whether the motion is chaotic", "[cycle][long]") {
  const auto searched = [](const StructureModel& model, int returns) {
    return find_cycle(model, {.max_cycles = returns, .multipliers = false, .exponent = true});
  };
  const auto chaotic = searched(belt(0.4, 1, 0.5), 3000);
  REQUIRE(chaotic.exponent);
  // 0.0731(4), two runs of 4·10⁵ s.
  CHECK(chaotic.exponent->error < 0.0731 / 5);
  CHECK(std::abs(chaotic.exponent->value - 0.0731) < 3 * std::hypot(chaotic.exponent->error, 4e-4));
  CHECK(chaotic.outcome.ending == Ending::none_exists);
  CHECK_THAT(chaotic.outcome.detail, Catch::StartsWith("chaotic: "));

  const auto periodic = searched(belt(0.1, 1, 0.5), 3000);
  CHECK(periodic.outcome.complete());
  CHECK_FALSE(periodic.exponent);
  CHECK_FALSE(find_cycle(belt(0.4, 1, 0.5), {.max_cycles = 100}).exponent);

  // Without friction and damping a force of 2 rad/s and the free oscillation of √2 rad/s never repeat themselves, and
  // disturbances neither grow nor decay.
  auto free = belt(0.4, 1e-12, 0.5);
  free.structure.K(0, 0) = 2;
  const auto quasiperiodic = searched(free, 1000);
  CHECK(quasiperiodic.outcome.ending == Ending::budget_spent);
  REQUIRE(quasiperiodic.exponent);
  CHECK(std::abs(quasiperiodic.exponent->value) <= 5 * quasiperiodic.exponent->error);
  CHECK_THAT(quasiperiodic.outcome.detail, Catch::StartsWith("no period within 1000 returns; exponent"));
}

TEST_CASE("smoothing by tanh makes chaos of a periodic motion, or a periodic motion of chaos") {
  // Of tangents and of differences, by an explicit integrator with steps below the width.
  const auto wide = spectrum_of(smoothed(belt(0.1, 1, 0.5), 1e-2), 3000);
  CHECK(wide.from == "average");
  CHECK(std::abs(wide.exponents[0].value - 0.115) < 3 * std::hypot(wide.exponents[0].error, 3e-3));
  CHECK(wide.exponents[0].value > 5 * wide.exponents[0].error);
  const auto narrow = spectrum_of(smoothed(belt(0.1, 1, 0.5), 1e-4), 1000);
  CHECK(narrow.from == "cycle");
  CHECK(std::abs(narrow.exponents[0].value + 0.222567) < 2e-5);
  const auto locked = spectrum_of(smoothed(belt(0.4, 1, 0.5), 1e-2), 1000);
  CHECK(locked.from == "cycle");
  CHECK(std::abs(locked.exponents[0].value + 0.5454) < 9e-4);
}

TEST_CASE("exponents add up to the divergence of the flow, however hard a direction shrinks") {
  // Wide enough for both multipliers to be known by themselves.
  const auto mild = spectrum_of(smoothed(belt(0.4, 1, 0.5, 0.3), 0.2), 1000);
  REQUIRE(mild.from == "cycle");
  REQUIRE(mild.cycle.multipliers.size() == 2);
  const double period = mild.duration;
  const double of_multipliers =
      (std::log(std::abs(mild.cycle.multipliers[0])) + std::log(std::abs(mild.cycle.multipliers[1]))) / period;
  CHECK(mild.divergence == Approx(of_multipliers).epsilon(1e-6));
  CHECK(mild.sum == Approx(mild.divergence).epsilon(1e-6));
  // A damper of 1 N s/m on 1 kg, with friction that does not depend on the slip rate: −1 1/s, whatever the motion. The
  // reversals of dry friction that never sticks add ln of the accelerations behind and before them.
  oscillators::Model dry;
  dry.law = laws::find_law("coulomb")->with({0.3, 0.3});
  dry.slider = {1, 1, 0.2};
  dry.drive.speed = 0.0, dry.drive.normal_load = 1.0, dry.drive.force = cosine(1, 0.9);
  const auto reversing = spectrum_of({oscillators::one_slider(dry), {.kind = Start::Kind::rest}}, 1000);
  REQUIRE(reversing.from == "cycle");
  REQUIRE(reversing.stick_fraction.at(0) == 0);
  CHECK(reversing.divergence == Approx(-0.2).epsilon(1e-9));
  double saltation = 0;
  for (const auto& event : reversing.cycle.events) {
    // At a reversal x = displacement: with a force P = cos ωt − x without friction, accelerations are P ± 0.3.
    const double P = std::cos(0.9 * event.time) - event.displacement;
    saltation += std::log((std::abs(P) - 0.3) / (std::abs(P) + 0.3));
  }
  CHECK(reversing.sum == Approx(reversing.divergence + saltation / reversing.duration).epsilon(1e-7));
}

TEST_CASE("the error of a correlated series is that of the sum of its correlations") {
  // x' = ρ x + noise: the error of the mean is √((1 + ρ)/(1 − ρ)) times that of independent values.
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  constexpr double rho = 0.9;
  std::vector<double> series(1 << 16);
  double x = 0;
  for (auto& value : series) value = x = rho * x + std::sqrt(1 - rho * rho) * normal(random);
  const auto error = blocked_error(series);
  CHECK(error.levelled);
  CHECK(error.value == Approx(std::sqrt((1 + rho) / (1 - rho) / double(series.size()))).epsilon(0.15));
  CHECK_FALSE(blocked_error({1, 2, 3}).levelled);
}

TEST_CASE("a wanted standard error ends the average") {
  const auto rough = lyapunov_spectrum(belt(0.4, 1, 0.5), {.tolerance = 0.01});
  CHECK(rough.outcome.complete());
  CHECK(rough.exponents[0].error <= 0.01);
  CHECK(std::abs(rough.exponents[0].value - 0.0731) < 4 * rough.exponents[0].error);
  CHECK_THROWS_AS(lyapunov_spectrum(belt(0.4, 1, 0.5), {}), InputError);
}
