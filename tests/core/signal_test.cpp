/// Signals: values and rates of every form, where they break, and what is refused.
#include "core/signal.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

using rosin::infinity;
using rosin::Signal;

TEST_CASE("a constant has no rate and no break") {
  const Signal signal = 3.5;
  CHECK(signal.constant());
  CHECK(signal.value(1e9) == 3.5);
  CHECK(signal.rate(0) == 0);
  CHECK(signal.next_break(0) == infinity);
  CHECK(signal.resolution() == infinity);
  CHECK(signal.with_level(2).value(7) == 2);
}

TEST_CASE("steps take the value after the step and break only where they jump") {
  const Signal signal(Signal::Steps{{{1, 10}, {4, 20}, {9, 5}}});
  CHECK_FALSE(signal.constant());
  CHECK(signal.value(0) == 10);  // before the first step its value holds
  CHECK(signal.value(3.999) == 10);
  CHECK(signal.value(4) == 20);
  CHECK(signal.value(100) == 5);
  CHECK(signal.next_break(0) == 4);
  CHECK(signal.next_break(4) == 9);
  CHECK(signal.next_break(9) == infinity);
  CHECK(signal.within({5, 20}));
  CHECK_FALSE(signal.within({6, 20}));
  CHECK(signal.level() == 10);
  CHECK(signal.with_level(1).constant());
}

TEST_CASE("a ramp rises at its rate") {
  const Signal signal(Signal::Ramp{1, -0.25});
  CHECK(signal.value(8) == -1);
  CHECK(signal.rate(8) == -0.25);
  CHECK(signal.next_break(0) == infinity);
  CHECK(signal.within({1, 2}));
}

TEST_CASE("harmonics are cosines of absolute time") {
  const Signal signal(Signal::Harmonics{9.8, {{5, 15, 0.3}, {1, -40, 0}}});
  const double t = 0.7;
  CHECK(signal.value(t) == Approx(9.8 + 5 * std::cos(15 * t + 0.3) + std::cos(40 * t)).epsilon(1e-15));
  const double h = 1e-6;
  CHECK(signal.rate(t) == Approx((signal.value(t + h) - signal.value(t - h)) / (2 * h)).epsilon(1e-8));
  CHECK(signal.resolution() == Approx(2 * std::numbers::pi / 40 / 16));
  CHECK(signal.within({3.8, 15.8}));
  CHECK_FALSE(signal.within({3.9, 15.8}));
  CHECK(signal.level() == 9.8);
  CHECK(signal.with_level(1).value(t) == Approx(signal.value(t) - 8.8));
}

TEST_CASE("a table is linear between its points and constant outside") {
  const Signal signal(Signal::Table{{1, 2, 4}, {0, 10, -10}});
  CHECK(signal.value(0) == 0);
  CHECK(signal.value(1.5) == 5);
  CHECK(signal.value(3) == 0);
  CHECK(signal.value(9) == -10);
  CHECK(signal.rate(0.5) == 0);
  CHECK(signal.rate(1) == 10);
  CHECK(signal.rate(2) == -10);
  CHECK(signal.rate(4) == 0);
  CHECK(signal.next_break(0) == 1);
  CHECK(signal.next_break(1) == 2);
  CHECK(signal.next_break(4) == infinity);
  CHECK(Signal(Signal::Table{{1}, {2}}).next_break(0) == infinity);
}

TEST_CASE("signals that make no sense are refused") {
  using rosin::InputError;
  CHECK_THROWS_AS(Signal(Signal::Steps{}), InputError);
  CHECK_THROWS_WITH(Signal(Signal::Steps{{{1, 0}, {1, 2}}}), Catch::Contains("times must ascend"));
  CHECK_THROWS_AS(Signal(Signal::Steps{{{0, NAN}}}), InputError);
  CHECK_THROWS_AS(Signal(Signal::Ramp{0, INFINITY}), InputError);
  CHECK_THROWS_AS(Signal(Signal::Harmonics{1, {}}), InputError);
  CHECK_THROWS_AS(Signal(Signal::Table{{0, 1}, {1}}), InputError);
  CHECK_THROWS_AS(Signal(Signal::Table{{0, NAN}, {1, 2}}), InputError);
}
