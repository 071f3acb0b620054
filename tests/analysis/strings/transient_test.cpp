/// Transients of bowed strings against tables and single motions of an independent program.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>

#include "analysis/strings/strings.hpp"
#include "laws/catalogue.hpp"

namespace {

using namespace rosin;
using namespace rosin::analysis::strings;
using oscillators::BowedString;

BowedStringModel cello(const std::string& law, double acceleration, double load) {
  BowedStringModel model;
  model.law = laws::find_law(law);
  if (law == "coulomb") model.law = model.law->with("mu_s", 1.2)->with("mu_d", 0.35);
  model.speed.signal = Signal(Signal::Ramp{0, acceleration});
  model.load.signal = Signal(load);
  return model;
}

TEST_CASE("single transients: onsets, durations and length", "[string]") {
  struct Known {
    const char* law;
    double load, acceleration;
    bool torsion;
    double first, length;
    std::vector<double> onset, duration;  ///< periods, β periods; those of 3.07 MHz
  };
  const auto known = GENERATE(
      Known{"two-exponential",
            1.5,
            1.8,
            true,
            0.032834,
            3.7613,
            {0, 1.5172, 2.6281, 3.7613},
            {1.060, 1.044, .967, 1.097}},
      Known{"two-exponential", 1.0, 2.7, true, 0.0218587, 0, {0, 1.0190, 2.0263, 3.0318}, {1.041, 1.121, 1.141, 1.236}},
      Known{
          "two-exponential", 1.25, 1.5, false, .0318724, 20, {0, 1.4482, 2.6252, 3.7494}, {1.057, 1.064, 1.015, 1.109}},
      Known{"coulomb", 1.0, 1.2, true, 0.032834, 4.8694, {0, 1.5365, 2.6493, 3.7624}, {1.928, 1.933, 0.948, 1.940}},
      Known{"thermal-layer", 1.5, 1.8, true, .032834, 9.7395, {0, 1.3671, 2.4720, 3.5757}, {1.123, 1.083, 1.033, .961}},
      Known{"thermal", 0.5, 0.8, true, 0.0284202, 16.6785, {0, 1.3263, 2.4446, 3.4734}, {1.356, 1.276, 1.156, 1.846}});
  CAPTURE(known.law, known.load, known.torsion);
  auto model = cello(known.law, known.acceleration, known.load);
  if (!known.torsion) model.string.torsion.reset();
  const auto bowing = bow(model, {});
  CHECK(bowing.outcome.complete());
  CHECK(bowing.first_slip == Approx(known.first).margin(1e-5));
  CHECK(bowing.transient.length == Approx(known.length).margin(3e-3));
  const auto& slips = bowing.transient.slips;
  const double period = model.string.period(), step = model.string.step();
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(double(slips[k].on - slips[0].on) * step / period == Approx(known.onset[k]).margin(2e-3));
    CHECK(double(slips[k].off - slips[k].on) * step / period / model.string.bow_position ==
          Approx(known.duration[k]).epsilon(0.02));
  }
}

// Lengths of transients in periods over force (rows, 2.5 N down to 0.125 N) and acceleration (0.15 … 3 m/s²), at 768
// kHz;
// --: none within 20, ??: another at half or a quarter of the rate.
constexpr const char* of_curve[] = {
    "-- -- -- -- -- -- -- -- ?? 12.7 -- 18.7 -- -- -- -- ?? 12.9 3.8 3.8",
    "-- -- -- -- -- -- -- ?? ?? -- -- -- -- 13.9 9.8 -- 12.9 3.8 3.8 4.7",
    "-- -- -- -- -- -- -- 18.2 12.7 -- 17.9 -- 13.9 9.8 -- 12.9 3.8 3.8 4.7 4.7",
    "-- -- -- -- -- -- -- -- -- 19.8 -- ?? 9.8 -- ?? 3.8 3.8 4.7 4.7 --",
    "-- -- -- -- -- -- 17.2 12.7 -- ?? 13.9 -- -- ?? 3.8 3.8 4.7 4.7 -- --",
    "-- -- -- -- -- -- -- -- ?? -- 13.9 -- -- 3.8 3.8 4.7 4.7 -- -- --",
    "-- -- -- ?? -- 17.2 11.8 ?? -- 13.9 9.8 19.8 3.8 3.8 4.7 ?? -- -- -- --",
    "-- -- -- -- -- ?? -- 15.7 13.9 9.8 19.8 3.8 3.8 4.7 -- -- -- -- ?? 1.1",
    "-- -- -- -- 17.2 ?? ?? ?? -- 12.8 3.8 3.8 4.7 -- -- -- -- 1.1 1.1 1.1",
    "-- -- ?? 17.3 -- 10.8 12.6 13.9 -- 3.8 4.7 4.7 ?? -- -- ?? 1.1 1.1 -- --",
    "-- -- 16.2 -- ?? ?? 13.9 -- 3.8 4.7 4.7 -- -- ?? 1.1 1.1 -- -- ?? 0.0",
    "-- -- -- -- ?? -- -- 3.8 4.7 4.7 -- ?? 1.1 1.1 1.1 -- ?? 0.0 0.0 0.0",
    "-- -- -- ?? ?? ?? 3.8 4.7 4.7 -- -- 1.1 -- -- -- 0.0 0.0 0.0 -- --",
    "-- -- -- ?? 13.9 3.8 4.7 8.7 -- 1.1 1.1 ?? -- 0.0 -- -- -- -- -- --",
    "-- ?? ?? 13.9 3.8 4.7 ?? -- 1.1 9.2 -- 0.0 -- -- -- -- -- -- -- --",
    "-- ?? -- 3.8 4.7 9.6 1.1 18.1 ?? 0.0 -- -- -- -- -- -- -- -- -- --",
    "-- 16.8 ?? 4.7 -- 1.1 -- -- -- -- -- -- -- -- -- -- -- -- -- --",
    "?? ?? 4.7 1.1 -- 11.0 ?? -- -- -- -- -- -- -- -- -- -- -- -- --",
    "-- ?? ?? 10.0 -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- --",
    "5.1 ?? -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- --",
};
constexpr const char* of_layer[] = {
    "-- -- -- -- -- -- -- -- -- -- -- -- -- 17.0 17.9 -- 3.8 3.8 3.8 3.8",
    "-- -- -- -- -- -- -- ?? -- -- 14.0 ?? 17.0 ?? -- -- 3.8 3.8 3.8 --",
    "-- -- -- -- -- -- 19.8 -- -- ?? -- -- 9.8 -- -- 3.8 3.8 3.8 -- --",
    "-- -- -- -- -- -- -- -- 17.6 -- -- 9.8 -- -- 3.8 3.8 3.8 -- -- --",
    "-- -- -- -- -- -- -- 13.7 19.1 13.7 ?? -- ?? 3.8 3.8 ?? -- -- 10.6 --",
    "-- -- -- -- -- -- -- -- -- -- 17.9 -- 3.8 3.8 9.7 -- -- 10.7 -- --",
    "-- -- -- 18.3 -- -- 11.8 17.8 -- 17.9 -- 3.8 3.8 9.7 -- -- ?? -- -- --",
    "-- -- -- -- 19.8 -- -- -- 17.9 -- 3.8 3.8 9.7 -- -- -- -- -- ?? 1.1",
    "-- -- -- -- -- 19.9 -- -- ?? 3.8 3.8 9.7 -- ?? -- -- -- 1.1 1.1 --",
    "-- -- 18.3 -- -- -- -- 17.9 3.8 3.8 9.7 -- ?? -- -- 1.1 1.1 4.2 -- --",
    "-- -- 16.2 -- 19.9 13.7 17.9 -- 3.8 ?? -- -- -- -- 1.1 1.1 -- -- -- 0.0",
    "-- -- -- 15.7 15.9 -- 13.1 3.8 9.7 -- ?? -- 1.1 1.1 -- -- -- 0.0 -- --",
    "-- -- 18.7 15.8 -- 14.7 3.8 9.7 ?? ?? 8.3 1.1 -- -- -- 0.0 0.0 -- -- --",
    "-- -- -- 18.8 -- 3.8 8.7 ?? ?? 1.1 12.2 -- -- 0.0 5.0 -- -- -- -- --",
    "-- 12.6 -- 15.9 3.8 4.7 10.6 8.3 9.2 -- -- 0.0 -- -- -- -- -- -- -- --",
    "-- ?? -- 3.8 4.7 13.6 1.1 -- 0.0 10.0 -- -- -- -- -- -- -- -- -- --",
    "18.3 13.7 9.8 5.6 ?? -- 0.0 5.0 -- -- -- -- -- -- -- -- -- -- -- --",
    "?? 10.9 5.6 1.1 0.0 15.1 -- -- -- -- -- -- -- -- -- -- -- -- -- --",
    "15.9 1.1 0.0 -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- --",
    "0.0 -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- -- --",
};

TEST_CASE("Guettler's diagrams of a cello string, on pixels that do not hang on the sample rate", "[string]") {
  // Every second pixel along both axes.
  const auto [law, table] = GENERATE(std::pair{"two-exponential", of_curve}, std::pair{"thermal-layer", of_layer});
  CAPTURE(law);
  std::vector<BowedStringModel> models;
  std::vector<std::string> wanted;
  for (int row = 0; row < 20; row += 2) {
    std::istringstream words(table[row]);
    std::string word;
    for (int i = 1; words >> word; ++i)
      if (i % 2 == 0) models.push_back(cello(law, 0.15 * i, 0.125 * (20 - row))), wanted.push_back(word);
  }
  const auto found = bow(models, {}, 2);
  int stable = 0, near = 0, good = 0, good_near = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] == "??") continue;
    const double length = wanted[i] == "--" ? 20 : std::stod(wanted[i]);
    const double difference = std::abs(found[i].transient.length - length);
    ++stable;
    near += difference <= 0.5;
    if (length >= 5) continue;
    ++good;
    good_near += difference <= 0.1;
  }
  CAPTURE(stable, near, good, good_near);
  REQUIRE(stable > 80);
  REQUIRE(good > 10);
  CHECK(near >= 0.93 * stable);
  CHECK(good_near >= 0.95 * good);
}

TEST_CASE("Coulomb friction knows only force over acceleration, to the last bit", "[string]") {
  const auto once = bow(cello("coulomb", 1, 0.8), {}).transient, twice = bow(cello("coulomb", 2, 1.6), {}).transient;
  REQUIRE(once.slips.size() == twice.slips.size());
  for (std::size_t k = 0; k < once.slips.size(); ++k) {
    CHECK(once.slips[k].on == twice.slips[k].on);
    CHECK(once.slips[k].off == twice.slips[k].off);
  }
}

TEST_CASE("strings do not hear those beside them", "[string]") {
  std::vector<BowedStringModel> models;
  for (int i = 0; i < 40; ++i) models.push_back(cello(i % 2 ? "thermal-layer" : "two-exponential", 1 + 0.03 * i, 0.6));
  const auto one = bow(models, {}, 1), two = bow(models, {}, 2);
  for (std::size_t i = 0; i < models.size(); ++i) {
    CHECK(one[i].transient.length == two[i].transient.length);
    CHECK(one[i].bridge_force == two[i].bridge_force);
    if (i % 23 == 0) CHECK(bow(models[i], {}).bridge_force == one[i].bridge_force);
  }
}

TEST_CASE("Schelleng's maximum is exact for a string without losses", "[string]") {
  const double speed = GENERATE(0.1, 0.05);
  auto model = cello("two-exponential", 1, 1);
  model.string = {.frequency = 250,
                  .bow_position = 0.1,
                  .quality = BowedString::none,
                  .corner_rounding = 0,
                  .torsion = {},
                  .delays = oscillators::DelayLine::integer,
                  .sample_rate = 1e5};
  model.speed.signal = Signal(speed);
  model.start = oscillators::StringStart::helmholtz;
  const double most = schelleng_limits(model, speed).most;
  CHECK(most == Approx(speed == 0.1 ? 1.29414875226 : 0.64937524139).epsilon(1e-11));
  const auto regime = [&](double load) {
    model.load.signal = Signal(load);
    return bow(model, {.duration = 0.1}).transient.regime;
  };
  CHECK(regime(most * (1 - 1e-9)) == StringRegime::helmholtz);
  CHECK(regime(most * (1 + 1e-9)) != StringRegime::helmholtz);
}

TEST_CASE("Schelleng's minimum is where a force that falls slowly ends Helmholtz motion", "[string]") {
  auto model = cello("two-exponential", 1, 1);
  const double Z = 0.55, reflection = 0.98;
  model.string = {.frequency = 250,
                  .impedance = Z,
                  .bow_position = 0.1,
                  .quality = BowedString::none,
                  .corner_rounding = 0,
                  .bridge_resistance = Z * (1 + reflection) / (1 - reflection),
                  .torsion = {},
                  .delays = oscillators::DelayLine::integer,
                  .sample_rate = 1e5};
  model.speed.signal = Signal(0.1);
  model.start = oscillators::StringStart::helmholtz;
  const double least = schelleng_limits(model, 0.1).least;
  CHECK(least == Approx(0.032680524).epsilon(1e-8));
  // The force falls by 0.05 % a period, from where Helmholtz motion has settled for 300 periods.
  const double period = model.string.period();
  Signal::Table falling{{0, 300 * period}, {2.2 * least, 2.2 * least}};
  for (int k = 1; k < 1700; ++k)
    falling.time.push_back((300 + k) * period), falling.value.push_back(2.2 * least * std::exp(-5e-4 * k));
  const auto record_of = [&] {
    model.load.signal = Signal(falling);
    return record(model, {.duration = 2000 * period});
  }();
  // The first period with two slips.
  double breaks = NAN;
  const auto& slips = record_of.bowing.transient.slips;
  for (std::size_t k = 1; k < slips.size() && std::isnan(breaks); ++k)
    if (double(slips[k].on) > 310 * 400 && slips[k].on - slips[k - 1].on < 350)
      breaks = record_of.normal_load[std::size_t(slips[k].on)];
  CHECK(breaks == Approx(least).epsilon(0.02));  // it lags behind in proportion to the fall
}

TEST_CASE("the rays of Guettler's diagram", "[string]") {
  const auto rays = guettler_rays(BowedString{}, 1.2, 0.8, 5);
  CHECK(rays.lower == Approx(0.2845).epsilon(2e-4));
  CHECK(rays.upper == Approx(1.0736).epsilon(2e-4));
}

TEST_CASE("regimes and slips that count, of made-up slips", "[string]") {
  // Period of 100 samples of 1 s, bow at 0.1 of the string at 1 m/s.
  const auto at = [](std::vector<std::pair<long, long>> list) {
    std::vector<SlipEpisode> raw;
    for (const auto& [on, off] : list) raw.push_back({on, off, 100, 1});
    return raw;
  };
  std::vector<std::pair<long, long>> slips = {{50, 60}, {130, 140}};
  for (long k = 2; k < 30; ++k) slips.push_back({100 * k, 100 * k + 10});
  const auto helmholtz = find_transient(at(slips), 3000, 1, 100, 0.1);
  CHECK(helmholtz.regime == StringRegime::helmholtz);
  CHECK(helmholtz.length == Approx(1.5));
  CHECK(helmholtz.period == Approx(1));
  auto twice = slips;
  for (long k = 10; k < 30; ++k) twice.push_back({100 * k + 50, 100 * k + 60});
  std::ranges::sort(twice);
  CHECK(find_transient(at(twice), 3000, 1, 100, 0.1).regime == StringRegime::double_slip);
  CHECK(find_transient(at({{50, -1}}), 3000, 1, 100, 0.1).regime == StringRegime::sliding);
  CHECK(find_transient({}, 3000, 1, 100, 0.1).regime == StringRegime::none);
  // A gap of 3 samples within a slip, and one that moves 0.1 m, do not count.
  auto broken = slips;
  broken[5] = {500, 504}, broken.insert(broken.begin() + 6, {507, 510});
  auto raw = at(broken);
  raw.insert(raw.begin() + 3, {250, 252, 10, 1});
  CHECK(find_transient(raw, 3000, 1, 100, 0.1).length == Approx(1.5));
}

TEST_CASE("a bow that never lets go is told", "[string]") {
  const auto bowing = bow(cello("two-exponential", 1, 1), {.duration = 0.01});
  CHECK(bowing.transient.regime == StringRegime::none);
  auto still = cello("two-exponential", 1, 1);
  still.speed.signal = Signal(0.1);
  CHECK_THROWS_WITH(bow(still, {}), Catch::Contains("give the duration"));
}

}  // namespace
