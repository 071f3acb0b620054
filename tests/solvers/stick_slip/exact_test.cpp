/// Stick–slip in closed form against numbers known to 34 digits, brute-force sampling, and the balance of energy.
#include "solvers/stick_slip/exact.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/solvers/stick_slip/stick_slip_cases.hpp"

using namespace rosin;
using namespace rosin::solvers;
using namespace rosin::solvers::stick_slip;
using rosin::tests::StickSlipCase;

namespace {

DryOscillator oscillator_of(const StickSlipCase& c) {
  return {.mass = c.m,
          .stiffness = c.k,
          .damping = c.c,
          .static_friction = c.mus,
          .dynamic_friction = c.muk,
          .speed = 0.0,
          .load = Signal(Signal::Harmonics{c.Nc, {{c.Nv, c.wn, 0}}}),
          .force = Signal(Signal::Harmonics{0, {{c.P, c.we, 0}}})};
}

}  // namespace

TEST_CASE("events, motion and works of seven stick-slip cases to all printed digits", "[exact]") {
  for (const auto& c : tests::stick_slip_cases()) {
    INFO(c.name);
    Exact<double> exact(oscillator_of(c));
    exact.audit();
    exact.start(0, c.x0, 0);
    std::size_t event = 0, point = 0;
    const auto points_until = [&](double t) {
      for (; point < c.points.size() && c.points[point].time <= t; ++point) {
        const auto seen = exact.at(c.points[point].time);
        CHECK(std::abs(seen.displacement - c.points[point].displacement) < 1e-14);
        CHECK(std::abs(seen.velocity - c.points[point].velocity) < 1e-12);
      }
    };
    while (exact.time() < 2) {
      const Switch what = exact.advance(2);
      points_until(exact.time());
      if (what == Switch::none) continue;
      REQUIRE(event < c.events.size());
      const auto& expected = c.events[event++];
      CHECK(name(what) == expected.kind);
      CHECK(std::abs(exact.time() - expected.time) < 2e-14);
      CHECK(std::abs(exact.at(exact.time()).displacement - expected.displacement) < 1e-14);
      CHECK(-exact.upcoming() == expected.direction);
    }
    CHECK(event == c.events.size());
    CHECK(point == c.points.size());
    CHECK(std::abs(exact.stick_time() - c.stick_time) < 1e-13);
    CHECK(std::abs(exact.works().friction - c.friction_work) < 1e-12);
    CHECK(std::abs(exact.works().damper - c.damper_work) < 1e-10);
    CHECK(std::abs(exact.works().force - c.force_work) < 1e-10);
    CHECK(std::abs(exact.works().residual) < 1e-14);
    CHECK(exact.chatter_events() == 0);
  }
}

TEST_CASE("a double root of the slip rate is not missed, and a miss by 1e-12 is not taken for one", "[exact]") {
  // 1 + ε − cos τ touches zero at 2π, or passes it by ε.
  for (const double gap : {1e-12, 1e-9, 1e-3}) {
    INFO(gap);
    const Signal above(Signal::Harmonics{1 + gap, {{-1, 1, 0}}}), below(Signal::Harmonics{1 - gap, {{-1, 1, 0}}});
    CHECK_FALSE(ClosedForm<double>(above.piece(0), 0).first_zero(1, 50, false));
    const auto zero = ClosedForm<double>(below.piece(0), 0).first_zero(1, 50, false);
    REQUIRE(zero);
    CHECK(std::abs(*zero - (2 * M_PI - std::acos(1 - gap))) < 1e-3 * std::sqrt(gap));
  }
}

TEST_CASE("resonance and critical damping, exact and nearly so, keep their digits", "[exact]") {
  // From rest under cos t: undamped at resonance x = t sin(t)/2.
  const auto force = [](double omega) {
    return ClosedForm<double>(Signal(Signal::Harmonics{0, {{1, omega, 0}}}).piece(0), 0);
  };
  for (const double detuning : {0.0, 1e-12, 1e-8, 1e-5}) {
    INFO(detuning);
    const double w = 1 + detuning, t = 7;
    const auto x = ClosedForm<double>::response(1, 0, 1, force(w), 0, 0);
    // (cos w t − cos t)/(1 − w²) as a product
    const double expected = detuning == 0
                                ? t * std::sin(t) / 2
                                : 2 * std::sin((1 + w) * t / 2) * std::sin(detuning * t / 2) / (detuning * (1 + w));
    CHECK(std::abs(x(t) - expected) < 1e-14 * t);
  }
  for (const double excess : {-1e-3, -1e-9, 0.0, 1e-9, 1e-3}) {
    INFO(excess);
    const double a = 1 + excess, t = 1.5;
    const auto x = ClosedForm<double>::response(1, 2 * a, 1, ClosedForm<double>(0), 1, 0.5);
    const double b2 = (a - 1) * (a + 1), z = b2 * t * t;
    // e^{-at}(x₀ C + (v₀ + a x₀) S) with C, S the even and odd parts of e^{bt}, by their series in b²
    const double C = 1 + z / 2 + z * z / 24 + z * z * z / 720, S = t * (1 + z / 6 + z * z / 120 + z * z * z / 5040);
    CHECK(std::abs(x(t) - std::exp(-a * t) * (C + (0.5 + a) * S)) < 1e-14);
  }
}

namespace {

/// Oscillators over many decades: undamped to over-critical, equal coefficients, loads that vanish at instants,
/// surfaces at rest, moving, and shaken.
class RandomOscillators {
 public:
  explicit RandomOscillators(unsigned seed) : random_(seed) {}
  struct Drawn {
    DryOscillator oscillator;
    double x, v, duration, fastest;
  };
  Drawn draw() {
    const double m = decades(-3, 3), w0 = decades(-3, 3), k = m * w0 * w0;
    const double zeta = one_in(4) ? 0 : one_in(8) ? 1 : decades(-3, 2);
    const double we = w0 * decades(-3, 3), wn = one_in(16) ? w0 : w0 * decades(-3, 3);
    const double Nc = m * decades(-1, 2), Nv = one_in(3) ? Nc : one_in(4) ? 0 : uniform(0, 1) * Nc;
    const double muk = one_in(32) ? 0 : decades(-2, 0), mus = one_in(3) ? muk : muk * uniform(1, 2);
    const double P = mus * Nc * decades(-1, 1.5);
    const double phase = one_in(2) ? 0 : uniform(0, 2 * M_PI), other = one_in(2) ? 0 : uniform(0, 2 * M_PI);
    std::vector<Signal::Harmonic> forces = {{P, we, phase}};
    if (one_in(4)) forces.push_back({P * uniform(0, 1), we * uniform(0.1, 10), other});
    const double V = P / (m * w0) * decades(-2, 1);
    DryOscillator o{m,
                    k,
                    2 * zeta * m * w0,
                    mus,
                    muk,
                    0,
                    0.0,
                    Signal(Signal::Harmonics{Nc, {{Nv, wn, other}}}),
                    Signal(Signal::Harmonics{one_in(3) ? P * uniform(-1, 1) : 0, forces})};
    if (one_in(4)) o.speed = V;
    if (one_in(8)) o.speed = Signal(Signal::Harmonics{V * uniform(-1, 1), {{V, w0 * decades(-2, 2), 0}}});
    double fastest = std::max({w0, we, wn});
    const double duration = std::min(60 / w0, 1000 / fastest);
    const double x = (P + mus * Nc) / k * uniform(-4, 4);
    return {o, one_in(5) ? 0 : x, one_in(2) ? 0 : x * w0 * uniform(-1, 1), duration, fastest};
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double decades(double low, double high) { return std::pow(10, uniform(low, high)); }
  bool one_in(int n) { return random_() % n == 0; }
  std::mt19937_64 random_;
};

struct StressCount {
  long cases = 0, events = 0, chattering = 0, missed = 0, endless = 0;
  double worst_balance = 0, largest_chatter = 0;
};

/// Runs oscillators and looks between events for what should have been one.
StressCount stress(unsigned seed, long cases) {
  RandomOscillators random(seed);
  StressCount count;
  for (; count.cases < cases; ++count.cases) {
    const auto drawn = random.draw();
    const auto& o = drawn.oscillator;
    INFO("case " << count.cases);
    Exact<double> exact(o);
    exact.audit();
    exact.start(0, drawn.x, drawn.v);
    // Sizes of speeds and forces are known at the end only.
    double speed = 0, force = 0, worst_slip = 0, worst_hold = 0;
    long pieces = 0;
    while (exact.time() < drawn.duration) {
      if (++pieces > 100'000) {
        ++count.endless;
        break;
      }
      const long chatter_before = exact.chatter_events();
      count.events += exact.advance(drawn.duration) != Switch::none;
      const double from = exact.time_before(), length = exact.time() - from;
      const int samples = 40 + int(8 * length * drawn.fastest);
      for (int i = 0; i <= samples; ++i) {
        const auto seen = exact.at(from + length * i / samples);
        speed = std::max({speed, std::abs(seen.slip_rate), std::abs(seen.velocity)});
        force = std::max({force, std::abs(seen.friction_force), o.stiffness * std::abs(seen.displacement),
                          std::abs(o.force.value(from))});
        if (exact.direction() != 0) worst_slip = std::max(worst_slip, -seen.slip_rate * exact.direction());
        if (exact.direction() == 0 && exact.chatter_events() == chatter_before)
          worst_hold = std::max(worst_hold, std::abs(seen.friction_force) - o.static_friction * seen.load);
      }
    }
    speed = std::max(speed, std::sqrt(o.stiffness / o.mass) * force / o.stiffness);
    const bool missed = worst_slip > 1e-11 * speed || worst_hold > 1e-11 * force;
    count.missed += missed;
    count.chattering += exact.chatter_events() > 0;
    count.largest_chatter = std::max(count.largest_chatter, double(exact.chatter_time()) / drawn.duration);
    const auto& works = exact.works();
    const double energy = works.throughput + o.stiffness * drawn.x * drawn.x + o.mass * drawn.v * drawn.v;
    if (energy > 0) count.worst_balance = std::max(count.worst_balance, std::abs(works.residual) / energy);
    if (missed || (energy > 0 && std::abs(works.residual) / energy > 1e-9))
      WARN("seed " << seed << " case " << count.cases << ": slip turned by " << worst_slip / speed
                   << ", hold passed by " << worst_hold / force << ", balance " << std::abs(works.residual) / energy
                   << ", pieces " << pieces);
  }
  return count;
}

}  // namespace

TEST_CASE("random oscillators over six decades: no event is missed, none repeats for ever, energy balances",
          "[exact]") {
  const auto count = stress(1, 1000);
  CHECK(count.events > 1000);
  CHECK(count.missed == 0);
  CHECK(count.endless == 0);
  CHECK(count.worst_balance < 1e-9);
}

TEST_CASE("a hundred thousand random oscillators", "[.exact-stress]") {
  const auto count = stress(2, 100'000);
  WARN(count.cases << " cases, " << count.events << " events, " << count.missed << " missed, " << count.endless
                   << " endless, " << count.chattering << " with chatter (at most a part of " << count.largest_chatter
                   << " of the time), energy balance at worst " << count.worst_balance);
  CHECK(count.missed == 0);
  CHECK(count.endless == 0);
  CHECK(count.worst_balance < 1e-9);
}

TEST_CASE("three motions drawn for published pictures: first sticks, and the forces in stick and slip", "[exact]") {
  struct Drawn {
    double m, k, c, mus, muk, x0, Nc, Nv, P, wn, we, first_stick;
  };
  // First sticks by an independent implementation, to the digits given.
  const Drawn drawn[] = {{4.1274, 1575.5, 1.9608, .40109, .27661, .072586, 40.49, .18329, 14.687, 10.651, 84.18, .677},
                         {4.6835, 10483, 11.126, .38084, .36443, .050481, 45.945, 43.753, 17.474, 234.64, 19.397, .665},
                         {3.5107, 5561.8, 11.697, .32667, .23451, .012564, 34.44, 31.616, 25.008, 22.94, 15.311, .218}};
  for (const auto& d : drawn) {
    Exact<double> exact({d.m, d.k, d.c, d.mus, d.muk, 0, 0.0, Signal(Signal::Harmonics{d.Nc, {{d.Nv, d.wn, 0}}}),
                         Signal(Signal::Harmonics{0, {{d.P, d.we, 0}}})});
    exact.start(0, d.x0, 0);
    while (exact.time() < 4 && exact.advance(4) != Switch::stick) continue;
    CHECK(double(exact.time()) == Approx(d.first_stick).margin(5e-4));
  }
}
