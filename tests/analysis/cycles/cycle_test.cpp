/// Periodic orbits against shooting with other integrators at 1e-13, closed forms, and exact event calculations.
#include "analysis/cycles/cycle.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/steady/stability.hpp"
#include "laws/spinodal.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::cycles;
using rosin::tests::bristol_board;
using rosin::tests::slider_under;

namespace {
/// A number, with the digits that are sure in the reference.
struct Reference {
  double Metrics::*member;
  double value, uncertainty;
};
void check(const Cycle& cycle, const std::vector<Reference>& references) {
  for (const auto& r : references) {
    INFO(r.value);
    const double difference = std::abs(cycle.metrics.*r.member - r.value);
    CHECK(difference <= cycle.error.*r.member + r.uncertainty);
    CHECK(cycle.error.*r.member <= 2e-6 * std::abs(r.value));
  }
}
}  // namespace

TEST_CASE("the cycle of Fig 1 has the period, extremes and metrics of an independent shooting", "[cycle]") {
  // Radau at 1e-11 and DOP853 at 1e-13 agree on all digits given.
  const std::vector<Reference> references = {{&Metrics::period, 22.58705579716, 1e-11},
                                             {&Metrics::slip_rate_max, 8.45069499589e-5, 1e-16},
                                             {&Metrics::slip_rate_min, 1.924206428998e-7, 1e-18},
                                             {&Metrics::friction_max, 0.40512742399316, 1e-13},
                                             {&Metrics::friction_min, 0.23543502159642, 1e-13},
                                             {&Metrics::stick_fraction, 0.5843785080036, 1e-12},
                                             {&Metrics::stick_fraction_05, 0.7665463331584, 1e-12},
                                             {&Metrics::loop_area, 4.17176638243e-6, 1e-17},
                                             {&Metrics::loop_area_normalised, 0.12185291141429, 1e-13}};
  const double tolerance = GENERATE(1e-6, 1e-10);
  const auto cycle = find_cycle(bristol_board(1e-4, 10), {.tolerance = tolerance});
  REQUIRE(cycle.outcome.complete());
  check(cycle, references);
  CHECK(cycle.error.period <= tolerance * cycle.metrics.period);
  CHECK(std::abs(cycle.metrics.period - 22.58705579716) <= 10 * tolerance * 22.6);
  CHECK(cycle.metrics.stick_fraction_001 == 0);
  CHECK(cycle.stable);
  CHECK(cycle.multipliers.front().real() == Approx(0.404064).epsilon(1e-4));
  CHECK(cycle.section_displacement == Approx(3.6983426076181e-4).epsilon(1e-9));
  CHECK(cycle.section_state.at(0) == Approx(3.77111979388e-3).epsilon(1e-9));
  // Identity: a periodic motion slips as far as the drive moves.
  CHECK(cycle.metrics.slip_rate_mean == Approx(1e-5).epsilon(10 * tolerance));
}

TEST_CASE("a relaxation cycle over seven decades of slip rate", "[cycle]") {
  const auto cycle = find_cycle(bristol_board(1e-2, 10), {.tolerance = 1e-9});
  REQUIRE(cycle.outcome.complete());
  check(cycle, {{&Metrics::period, 2009.591946018, 5e-9},
                {&Metrics::slip_rate_max, 1.031523017493e-2, 1e-14},
                {&Metrics::slip_rate_min, 5.6181170541e-10, 1e-19},
                {&Metrics::friction_max, 0.460745590772, 2e-11},
                {&Metrics::stick_fraction, 0.99450887923, 1e-11},
                {&Metrics::stick_fraction_001, 0.96106902156, 1e-11},
                {&Metrics::loop_area, 9.215200034e-5, 1e-14},
                {&Metrics::loop_area_normalised, 0.01938941275, 1e-11}});
  CHECK(cycle.multipliers.front().real() == Approx(0.04399).epsilon(1e-3));
}

TEST_CASE("lambda = 0 is the friction curve as a model of its own, without loop area", "[cycle]") {
  const auto cycle = find_cycle(bristol_board(1e-4, 0), {.tolerance = 1e-9});
  REQUIRE(cycle.outcome.complete());
  check(cycle, {{&Metrics::period, 20.0875412888, 4e-10},
                {&Metrics::slip_rate_min, 2.114903931e-11, 1e-19},
                {&Metrics::stick_fraction, 0.8376873255, 1e-10},
                {&Metrics::friction_max, 0.40467912319143, 1e-13}});
  CHECK(cycle.metrics.loop_area == 0);
  CHECK(std::abs(cycle.multipliers.front()) < 1e-7);
}

TEST_CASE("cycles at other loads and clocks agree with the published table", "[cycle]") {
  struct Case {
    double load_exponent, lambda, period, slip_rate_max;
  };
  const auto c = GENERATE(Case{-4.25, 10, 11.322421702, 2.59408137e-5}, Case{-4, 1, 33.823272129, 1.6732858e-4},
                          Case{-4, 1e-3, 20.893750698, 1.024853147e-4},
                          Case{-3.5, 31.622776601683793, 64.122726376, 2.2385792e-4}, Case{0, 1e-3, 92764.07057, 0});
  const auto cycle = find_cycle(bristol_board(std::pow(10, c.load_exponent), c.lambda), {.tolerance = 1e-8});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.period == Approx(c.period).epsilon(3e-8));
  if (c.slip_rate_max > 0) CHECK(cycle.metrics.slip_rate_max == Approx(c.slip_rate_max).epsilon(1e-7));
}

TEST_CASE("stick-slip coexists with stable sliding above the minimum of the steady curve", "[cycle]") {
  const auto cycle = find_cycle(bristol_board(1e-2, 1, 1e-3), {.tolerance = 1e-8});
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.period == Approx(21.782286).epsilon(3e-8));
  CHECK(cycle.metrics.slip_rate_max / 1e-3 == Approx(10.59632).epsilon(6e-7));
  CHECK(cycle.metrics.stick_fraction == Approx(0.846885).epsilon(1e-6));
}

TEST_CASE("the start decides between stable sliding and the cycle beside it", "[cycle]") {
  const auto model = bristol_board(1e-2, 1, 1e-3);
  CycleOptions options;
  options.start = motion::Start{motion::Start::Kind::given, {}, {}, 1.05e-3, {}};
  CHECK(find_cycle(model, options).outcome.ending == Ending::none_exists);
  options.start = motion::Start{motion::Start::Kind::rest, {}, {}, {}, {}};
  CHECK(find_cycle(model, options).metrics.period == Approx(21.782286).epsilon(3e-8));
}

TEST_CASE("a cycle is found next to the Hopf point and none on the other side", "[cycle]") {
  const double critical = 0.00040877514056773;
  const auto at = [&](double factor) {
    return find_cycle(bristol_board(1, 10).with("drive.normal_load", factor * critical), {.tolerance = 1e-6});
  };
  // Supercritical with Re c₁/ω = −0.0383434: A² = Re s/(0.0383434 ω).
  const auto near = at(1.0003);
  REQUIRE(near.outcome.complete());
  const double growth = 0.3 * 6.3107e-5, amplitude = std::sqrt(growth / (0.0383434 * 0.69102));
  CHECK((near.metrics.slip_rate_max - near.metrics.slip_rate_min) / 2e-5 == Approx(amplitude).epsilon(0.02));
  const auto beyond = at(0.98);
  CHECK(beyond.outcome.ending == Ending::none_exists);
  CHECK(beyond.metrics.period == 0);
}

/// The amplitude (v_max − V)/V at which friction does no work on a harmonic oscillation about steady sliding: what the
/// cycle has in the limit of weak coupling (averaging, Krylov & Bogoliubov 1937).
double averaged_amplitude(const rosin::laws::Spinodal<>& law, double lambda, double V, double omega) {
  const auto work = [&](double amplitude) {
    constexpr int steps = 4000;
    const double h = 2 * std::numbers::pi / (omega * steps);
    const auto slip_rate = [&](double t) { return V * (1 + amplitude * std::sin(omega * t)); };
    const auto rate = [&](double t, double psi) { return law.rate({slip_rate(t), 0.0}, {psi}).psi / lambda; };
    double psi = law.steady({V, 0.0}).psi, sum = 0;
    for (int k = 0; k < 8 * steps; ++k) {  // the last of eight turns, when the first has been forgotten
      const double t = k * h;
      if (k >= 7 * steps) sum += law.friction({slip_rate(t), 0.0}, {psi}) * std::sin(omega * t);
      const double k1 = rate(t, psi), k2 = rate(t + h / 2, psi + h / 2 * k1), k3 = rate(t + h / 2, psi + h / 2 * k2),
                   k4 = rate(t + h, psi + h * k3);
      psi += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return sum;
  };
  double low = 1e-3, high = 0.9;  // work is done on small oscillations, and by large ones
  for (int i = 0; i < 40; ++i) (work((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  return low;
}

TEST_CASE("a cycle that friction hardly touches has the amplitude of averaging", "[cycle]") {
  // Loads at which a turn changes the motion by 10⁻⁶: no search could wait for it to settle.
  const double V = 1e-5;
  for (const double lambda : {5.5, 6.558685659571432, 6.61}) {
    Model model;
    model.law = laws::find_law("spinodal");
    model.lambda = lambda;
    model.slider = {1.0, 1.09, 0};
    model.drive = {V, 1.2e-7, 0.0};
    const Cycle cycle = find_cycle(model, {.tolerance = 1e-6});
    INFO("lambda " << lambda << ": " << cycle.outcome.detail);
    REQUIRE(cycle.outcome.complete());
    const double expected = averaged_amplitude({}, lambda, V, 2 * std::numbers::pi / cycle.metrics.period);
    CHECK((cycle.metrics.slip_rate_max / V - 1) / expected == Approx(1).epsilon(2e-3));
    CHECK(std::abs(cycle.multipliers.front()) < 1);
    CHECK(std::abs(cycle.multipliers.front()) > 0.999);
  }
}

TEST_CASE("Coulomb stick-slip has the closed-form slip and stick times", "[cycle]") {
  // A = (μ_s − μ_d) N/k: slip (2/ω)(π − atan(A ω/V)), stick 2A/V, peak V + √(V² + A²ω²).
  const double tolerance = GENERATE(1e-6, 1e-11);
  const auto cycle = find_cycle(slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.01, 2), {.tolerance = tolerance});
  REQUIRE(cycle.outcome.complete());
  check(cycle, {{&Metrics::period, 39.806257042379, 1e-12},
                {&Metrics::slip_rate_max, 0.20182608713734, 1e-14},
                {&Metrics::stick_fraction, 0.92189646636089, 1e-14}});
}

TEST_CASE("the slow fraction has one definition for all laws", "[cycle]") {
  // w = V + R sin(ωt + ψ), R = hypot(V, Aω), from rest to rest: slower than ε V for (asin(V/R) − asin((1 − ε)V/R))/ω at
  // either end of slip.
  const Model coulomb = slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.01, 2);
  const double V = 0.01, A = 0.2 / 1.09, omega = std::sqrt(1.09), R = std::hypot(V, A * omega);
  const double slip = (std::numbers::pi + 2 * std::asin(V / R)) / omega, period = slip + 2 * A / V;
  for (const double threshold : {0.01, 0.1, 0.5}) {
    const auto cycle = find_cycle(coulomb, {.tolerance = 1e-9, .stick_threshold = threshold});
    REQUIRE(cycle.outcome.complete());
    const double slow = 2 * (std::asin(V / R) - std::asin((1 - threshold) * V / R)) / omega;
    CHECK(cycle.metrics.slow_fraction == Approx((2 * A / V + slow) / period).epsilon(1e-12));
    CHECK(cycle.metrics.stick_fraction == Approx(2 * A / V / period).epsilon(1e-12));
  }
  // Located events, closed forms and lanes alike; of a smooth law the slow fraction is its stick fraction.
  auto curve = coulomb;
  curve.law = laws::find_law("stribeck");
  const Model board = bristol_board(1e-4, 10);
  for (const Model& model : {coulomb, curve, board}) {
    const auto cycle = find_cycle(model, {.tolerance = 1e-8, .stick_threshold = 0.5});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.metrics.slow_fraction == cycle.metrics.stick_fraction_05);
    if (!model.law->set_valued()) CHECK(cycle.metrics.slow_fraction == cycle.metrics.stick_fraction);
    const auto lanes = lanes::find_cycles(std::vector{model}, {1e-7, 0.5, {"slow_fraction", "stick_fraction_05"}});
    CHECK(lanes[0].metrics.slow_fraction == Approx(lanes[0].metrics.stick_fraction_05).epsilon(1e-8));
    CHECK(lanes[0].metrics.slow_fraction == Approx(cycle.metrics.slow_fraction).epsilon(1e-5));
  }
}

TEST_CASE("Leine's belt block sticks and slips with the exactly known times", "[cycle]") {
  const auto cycle = find_cycle(slider_under("hyperbolic", {1.0, 3.0}, {1, 1, 0}, 0.2, 1), {.tolerance = 1e-10});
  REQUIRE(cycle.outcome.complete());
  check(cycle, {{&Metrics::period, 12.00103129483, 2e-11}});
  CHECK((1 - cycle.metrics.stick_fraction) * cycle.metrics.period == Approx(4.29599952548).epsilon(1e-11));
  CHECK(cycle.metrics.stick_fraction * cycle.metrics.period == Approx(7.70503176935).epsilon(1e-11));
  const auto slower = find_cycle(slider_under("hyperbolic", {1.0, 3.0}, {1, 1, 0}, 0.1, 1), {.tolerance = 1e-10});
  check(slower, {{&Metrics::period, 17.86599024642, 2e-11}});
}

TEST_CASE("a load too weak to hold the slider gives a cycle of slip that reverses and never sticks", "[cycle]") {
  const auto cycle = find_cycle(slider_under("hyperbolic", {0.4, 3.0}, {0.0215408, 6.97031, 0}, 0.0159042, 1.02754e-4));
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.metrics.stick_fraction == 0);
  CHECK(cycle.metrics.slip_rate_min < 0);
  CHECK(cycle.metrics.slip_rate_mean == Approx(0.0159042).epsilon(1e-9));
  // A weak load leaves the period near that of the free slider.
  CHECK(cycle.metrics.period == Approx(2 * M_PI * std::sqrt(0.0215408 / 6.97031)).epsilon(0.02));
  CHECK(std::abs(cycle.multipliers.front()) < 1);
}

TEST_CASE("heated slip that reverses in each turn, and never sticks, is a cycle", "[cycle]") {
  // Reference: classical Runge-Kutta with located reversals, the temperature itself as unknown, 60 turns of 4000 steps.
  const auto model =
      slider_under("thermal", {0.35, 0.4, 0.01, 0.45, 0.1, 5e-7, 1e-3, 8e-3, 1.0, 1.0}, {1e-3, 1e3, 0}, 0.05, 1e-3);
  for (const double tolerance : {1e-6, 1e-10}) {
    const auto cycle = find_cycle(model, {.tolerance = tolerance});
    INFO(cycle.outcome.detail);
    REQUIRE(cycle.outcome.complete());
    check(cycle, {{&Metrics::period, 0.00628770473409, 4e-14},
                  {&Metrics::slip_rate_min, -8.8226606887e-4, 1e-14},
                  {&Metrics::slip_rate_max, 0.10099174516564, 2e-14},
                  {&Metrics::friction_mean, 0.582119831911, 4e-12}});
    CHECK(cycle.metrics.stick_fraction_001 > 0);
    CHECK(cycle.section_displacement == Approx(8.39388455e-6).epsilon(2e-8));
    CHECK(cycle.stable);
  }
}

TEST_CASE("periods of stick and slip that a leap has led astray go on by themselves", "[cycle][long]") {
  // Beside stable sliding, heated slip comes to a cycle by two parts in a thousand of its way in each period. Onsets
  // ahead of that may begin slip that does not come to rest: what follows it says nothing of the cycle.
  const auto model = slider_under("thermal-disc",
                                  {0.1956658670818921, 0.23525015579547781, 0.0015932161362236586, 0.15364090716977541,
                                   0.033026925235497002, 0.00022876907916291047, 0.0025501257566048425,
                                   0.040283685445523396, 0.58540264407989973, 0.0, 9.1028393426791236},
                                  {2.1020872411176121e-07, 19844.182877065785, 0.004168486334843396},
                                  7.5590659389763255, 172.92509329776681);
  CHECK(steady::stability(model).stable);
  const auto closely = find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(closely.outcome.complete());
  CHECK(closely.metrics.slip_rate_mean == Approx(model.drive.speed.level()).epsilon(1e-8));
  for (const double tolerance : {1e-5, 1e-6, 1e-7}) {
    const auto cycle = find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    CHECK(std::abs(cycle.metrics.period - closely.metrics.period) <= cycle.error.period);
  }
}

TEST_CASE("slips that differ at one tolerance alone are one period each", "[cycle]") {
  // Where steps are loose, every other slip of stiff bristles begins late by a fiftieth of the period, and the next one
  // as much earlier.
  const auto model =
      slider_under("lugre", {1e5, 316.2277660168379, 0.4, 1.5, 1.0, 1e-3}, {3112042.5693077459, 58060.673963022382, 0},
                   7.5150833839878828e-05, 1941263.4768688304);
  for (const double tolerance : {1e-6, 1e-8, 1e-9}) {
    const auto cycle = find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    CHECK(cycle.metrics.period == Approx(222624.301).epsilon(1e-8));
    int slips = 0;
    for (std::size_t i = 1; i < cycle.orbit.size(); ++i)
      slips += cycle.orbit[i - 1].slip_rate < 0.1 && cycle.orbit[i].slip_rate >= 0.1;
    CHECK(slips == 1);
  }
}

TEST_CASE("friction at a reversal is known as well as the heat that lags there", "[cycle][long]") {
  // Within 1.6e-6 s, a part in 1e10 of the period, the temperature follows the slip rate: at a reversal, where it is
  // least, it is what the steps before have left. Friction differs there by 3e-10 from one tolerance to the other.
  auto model = slider_under(
      "thermal",
      {0.60023772321103641, 0.31714114826857454, 0.0045709400029150613, 1.1213812675343795, 0.0059851902304816022,
       1.9659794070943272e-11, 10.661974789588786, 0.37947742530888695, 1.0, 0.014759609252588351},
      {20652.548766602191, 0.002686339576237221, 0}, 0.032698960026603392, 0.00012075575015978874);
  model.lambda = 877749.41071520734;
  const auto closely = find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(closely.outcome.complete());
  for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
    const auto cycle = find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.outcome.complete());
    for (auto friction : {&Metrics::friction_max, &Metrics::friction_min})
      CHECK(std::abs(cycle.metrics.*friction - closely.metrics.*friction) <= cycle.error.*friction);
  }
}

TEST_CASE("a period holds no more slips than it must", "[cycle]") {
  // The ring of the bristles makes every second, fourth or eighth turn more alike than the next before the motion
  // settles; then slips that follow each other are the same, or a longer and a shorter one by turns.
  struct Case {
    double load, stiffness;
    int slips;
  };
  for (const auto& [load, stiffness, expected] :
       {Case{1.49249555, 1e4, 1}, {0.1823348, 3007.88252, 2}, {0.1, 1649.64807, 2}}) {
    const auto model = slider_under("lugre", {1e5, 100.0, 0.4, 0.4, 0.3, 1e-3}, {1, stiffness, 0}, 2e-3, load);
    const auto cycle = find_cycle(model, {.tolerance = 1e-6});
    REQUIRE(cycle.outcome.complete());
    for (const auto& m : cycle.multipliers) CHECK(std::abs(m) > 0);  // what is unknown is left out
    std::vector<double> slips;
    const double fast = 0.5 * cycle.metrics.slip_rate_max;
    for (std::size_t i = 1; i < cycle.orbit.size(); ++i) {
      const auto &a = cycle.orbit[i - 1], &b = cycle.orbit[i];
      if (a.slip_rate < fast && b.slip_rate >= fast)
        slips.push_back(a.time + (b.time - a.time) * (fast - a.slip_rate) / (b.slip_rate - a.slip_rate));
    }
    REQUIRE(int(slips.size()) == expected);
    if (expected == 2) CHECK(std::abs(2 * (slips[1] - slips[0]) / cycle.metrics.period - 1) > 1e-3);
  }
}

TEST_CASE("an overdamped slider that starts onto unstable sliding leaves it for its cycle", "[cycle]") {
  const auto cycle = find_cycle(slider_under("ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {1, 1e4, 10}, 1e-8, 30));
  REQUIRE(cycle.outcome.complete());
  CHECK(cycle.stable);
  CHECK(cycle.metrics.slip_rate_max > 10 * 1e-8);
  CHECK(cycle.metrics.slip_rate_mean == Approx(1e-8).epsilon(1e-7));
}

TEST_CASE("a drive in the other direction gives the mirror image", "[cycle]") {
  const auto forward = find_cycle(bristol_board(1e-4, 10)), back = find_cycle(bristol_board(1e-4, 10, -1e-5));
  CHECK(back.metrics.period == forward.metrics.period);
  CHECK(back.metrics.slip_rate_min == -forward.metrics.slip_rate_max);
  CHECK(back.metrics.friction_min == -forward.metrics.friction_max);
  CHECK(back.section_displacement == -forward.section_displacement);
}

TEST_CASE("where no cycle can be, the outcome says why", "[cycle]") {
  CHECK(find_cycle(bristol_board(1e-4, 10, 0)).outcome.ending == Ending::none_exists);
  CHECK(find_cycle(bristol_board(0, 10)).outcome.ending == Ending::none_exists);
  // Strengthening friction.
  const auto rock = slider_under("ageing", {0.6, 0.015, 0.010, 1e-5, 1e-6}, {1, 1e3, 0}, 1e-5, 1);
  CHECK(find_cycle(rock).outcome.ending == Ending::none_exists);
  auto varying = bristol_board(1e-4, 10);
  varying.drive.speed = Signal(Signal::Ramp{1e-5, 1e-7});
  CHECK_THROWS_AS(find_cycle(varying), InputError);
  CHECK_THROWS_AS(find_cycle(bristol_board(1e-4, 10), {.tolerance = 0}), InputError);
}

TEST_CASE("metrics are found by name, with the nearest suggested", "[cycle]") {
  CHECK(find_metric("loop_area").member == &Metrics::loop_area);
  CHECK_THROWS_WITH(find_metric("loop_aera"), Catch::Contains("did you mean 'loop_area'"));
}

TEST_CASE("bristles without a clock stick and slip as stiff ones do", "[cycle][long]") {
  auto model = slider_under("lugre", {1e6, 10.0, 0.1, 0.4, 0.3, 1e-3}, {1, 1000, 1}, 1e-3, 10);
  model.lambda = 1e-2;
  const auto fast = find_cycle(model, {.tolerance = 1e-6});
  model.lambda = 0;
  const auto at_once = find_cycle(model, {.tolerance = 1e-6});
  REQUIRE(fast.outcome.complete());
  REQUIRE(at_once.outcome.complete());
  CHECK(at_once.metrics.period == Approx(fast.metrics.period).epsilon(1e-3));
  CHECK(at_once.metrics.slip_rate_max == Approx(fast.metrics.slip_rate_max).epsilon(1e-3));
  CHECK(at_once.metrics.friction_max == Approx(0.4));
  CHECK(at_once.metrics.slip_rate_min == 0);
  REQUIRE(!at_once.orbit.empty());
  CHECK(at_once.orbit.front().state.size() == 1);

  // Absolute stiffnesses share the curve, with their viscous part over the load.
  auto absolute = slider_under("lugre-unscaled", {1e7, 100.0, 1.0, 0.4, 0.3, 1e-3}, {1, 1000, 1}, 1e-3, 10);
  absolute.lambda = 0;
  CHECK(find_cycle(absolute, {.tolerance = 1e-6}).metrics.period == Approx(at_once.metrics.period).epsilon(1e-9));
}
