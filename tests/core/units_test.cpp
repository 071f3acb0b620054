/// Text with units to SI: exact decimal prefixes, friendly spellings, and what is refused.
#include "core/units.hpp"

#include <catch2/catch.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "core/turning.hpp"

using rosin::to_si;
using rosin::unit_known;

TEST_CASE("numbers with units become SI, decimal prefixes to the last bit") {
  CHECK(to_si("0.01 mm/s", "m/s") == 1e-5);
  CHECK(to_si("5 MPa", "Pa") == 5e6);
  CHECK(to_si("10 um", "m") == 1e-5);
  CHECK(to_si("10 µm", "m") == 1e-5);
  CHECK(to_si("1e-3 1/um", "1/m") == Approx(1e3).epsilon(1e-15));
  CHECK(to_si(" 3 ", "kg") == 3);
  CHECK(to_si("+2.5kN", "N") == 2500);
  CHECK(to_si("-4 N s/m", "N s/m") == -4);
  CHECK(to_si("5 %", "1") == 0.05);
  CHECK(to_si("20 degC", "K") == Approx(293.15));
  CHECK(to_si("60 rpm", "rad/s") == Approx(6.283185307179586));
  CHECK(to_si("2 min", "s") == 120);
  CHECK(to_si("7 1", "1") == 7);
}

TEST_CASE("the units of laws and sliders are known") {
  for (const char* unit : {"1", "m", "s", "kg", "N", "N/m", "1/m", "s/m", "m/s", "N s/m", "Pa", "W/K", "m2/s", "rad/s"})
    CHECK(unit_known(unit));
  CHECK_FALSE(unit_known("furlongs per moon"));
}

TEST_CASE("units as laboratories spell them") {
  struct Spelling {
    const char *written, *si;
    double value;
  };
  constexpr double turn_a_minute = 0.10471975511965977;  // rad/s: 2 pi/60
  const std::vector<Spelling> spellings = {{"rpm", "rad/s", turn_a_minute},
                                           {"RPM", "rad/s", turn_a_minute},
                                           {"Rpm", "rad/s", turn_a_minute},
                                           {"r.p.m.", "rad/s", turn_a_minute},
                                           {"r/min", "rad/s", turn_a_minute},
                                           {"U/min", "rad/s", turn_a_minute},
                                           {"tr/min", "rad/s", turn_a_minute},
                                           {"rev/min", "rad/s", turn_a_minute},
                                           {"turn/min", "rad/s", turn_a_minute},
                                           {"rev/s", "rad/s", 60 * turn_a_minute},
                                           {"deg/s", "rad/s", 0.017453292519943295},
                                           {"°/s", "rad/s", 0.017453292519943295},
                                           {"1/min", "Hz", 1 / 60.0},
                                           {"min^-1", "Hz", 1 / 60.0},
                                           {"min-1", "Hz", 1 / 60.0},
                                           {"min⁻¹", "1/s", 1 / 60.0},
                                           {"KHz", "Hz", 1e3},
                                           {"Nm", "N m", 1},
                                           {"N·m", "N m", 1},
                                           {"N⋅m", "N m", 1},
                                           {"N.m", "N m", 1},
                                           {"mNm", "N m", 1e-3},
                                           {"Ncm", "N m", 1e-2},
                                           {"kNm", "N m", 1e3},
                                           {"Nm/rad", "N m", 1},
                                           {"rad/Nm", "1/(N m)", 1},
                                           {"Nm2", "N m2", 1},
                                           {"Nms/rad", "N m s", 1},
                                           {"Ns/m", "N s/m", 1},
                                           {"kgm2", "kg m^2", 1},
                                           {"kg·m²", "kg m^2", 1},
                                           {"mm/sec", "m/s", 1e-3},
                                           {"mm·s⁻¹", "m/s", 1e-3},
                                           {"mm s-1", "m/s", 1e-3},
                                           {"mic", "m", 1e-6},
                                           {"mic/sec", "m/s", 1e-6},
                                           {"micron/s", "m/s", 1e-6},
                                           {"μm/s", "m/s", 1e-6},
                                           {"N/mm²", "Pa", 1e6},
                                           {"N/mm2", "Pa", 1e6},
                                           {"MPA", "Pa", 1e6},
                                           {"KN", "N", 1e3},
                                           {"kp", "N", 9.80665},
                                           {"kgf", "N", 9.80665},
                                           {"lbf", "N", 4.4482216152605},
                                           {"psi", "Pa", 6894.757293168361},
                                           {"msec", "s", 1e-3},
                                           {"mins", "s", 60},
                                           {"microstrain", "1", 1e-6},
                                           {"µε", "1", 1e-6}};
  for (const auto& [written, si, value] : spellings) {
    INFO(written);
    CHECK(unit_known(written));
    CHECK(to_si(std::string("3 ") + written, si) == Approx(3 * value).epsilon(1e-14));
  }
  for (const char* none : {"mpa", "U", "r", "kgm", "Nmx", "mics/Q"}) {  // mPa or MPa; ambiguous or none
    INFO(none);
    CHECK_FALSE(unit_known(none));
  }
}

TEST_CASE("rates that may count turns, periods or radians are refused with what to write") {
  using Catch::Contains;
  for (const char* bare : {"60 1/min", "60 min-1", "1 Hz", "2 kHz", "5 1/h", "5 1/ms"})
    CHECK_THROWS_WITH(to_si(bare, "rad/s"), Contains("angular frequency is needed") && Contains("rev/min"));
  for (const char* turning : {"60 rpm", "1 rad/s", "1 rev/s"})
    CHECK_THROWS_WITH(to_si(turning, "Hz"), Contains("a frequency is needed") && Contains("1/min"));
  CHECK_THROWS_WITH(to_si("60 rpm", "1/s"), Contains("a frequency is needed"));
  CHECK_THROWS_WITH(to_si("5 %", "rad"), Contains("write rad, deg or rev"));
  CHECK(to_si("5 1/s", "rad/s") == 5);
  CHECK(to_si("5 rad/s", "1/s") == 5);
  // a rotating thing turns
  CHECK(rosin::turning_to_si("60 1/min") == Approx(6.283185307179586).epsilon(1e-15));
  CHECK(rosin::turning_to_si("60 rpm") == Approx(6.283185307179586).epsilon(1e-15));
  CHECK(rosin::turning_to_si("2 rad/s") == 2);
  for (const char* unclear : {"1 Hz", "1 1/s", "5 1/h"})
    CHECK_THROWS_WITH(rosin::turning_to_si(unclear), Contains("turns or radians") && Contains("rev/s"));
}

TEST_CASE("a wrong unit is refused with both units named") {
  CHECK_THROWS_WITH(to_si("5 MPa", "m/s"), "'5 MPa' is in MPa, but needed is m/s");
  CHECK_THROWS_WITH(to_si("5 m", "1"), Catch::Contains("dimensionless"));
  CHECK_THROWS_WITH(to_si("5 Hz", "s"), Catch::Contains("needed is s"));  // reciprocal units are not the same
  CHECK_THROWS_WITH(to_si("5 s/m", "m/s"), Catch::Contains("needed is m/s"));
  CHECK_THROWS_WITH(to_si("5 Hz", "rad/s"), Catch::Contains("angular frequency"));
  CHECK_THROWS_WITH(to_si("5 parsnips", "m"), Catch::Contains("'parsnips' is not a known unit"));
}

TEST_CASE("malformed text is refused") {
  for (const char* text : {"", " ", "mm", "fast", "--3 m", "3 4 m", "1,5 m", "0x10 m", "1e999 m",
                           "3 m s since 2000-01-01", "2 lg(re 1 m)", "3 /", "3 m/"})
    CHECK_THROWS_AS(to_si(text, "m"), rosin::InputError);
}

TEST_CASE("units are converted from several threads at once") {
  std::vector<std::jthread> threads;
  std::vector<int> wrong(4);
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&wrong, i] {
      for (int n = 0; n < 500; ++n) wrong[i] += to_si(std::to_string(n) + " mm", "m") != n / 1000.0;
    });
  threads.clear();
  CHECK(wrong == std::vector<int>(4));
}

TEST_CASE("powers that are no whole numbers, as power laws have them") {
  CHECK(to_si("1.25e13 kg/cm^3.5/s^2", "N/m^4.5") == Approx(1.25e20));
  CHECK(to_si("3 kPa/um^2.5", "N/m^4.5") == Approx(3e18));
  CHECK(to_si("2e3 N s/m^3.5", "N s/m^3.5") == 2e3);
  CHECK(to_si("4 N/m^2", "N/m^2.0") == 4);
  CHECK_THROWS_WITH(to_si("1 Pa/m^2.5", "N/m^2.5"), Catch::Contains("but needed is N/m^2.5"));
  CHECK_THROWS_WITH(to_si("1 Qx/m^2.5", "N/m^2.5"), Catch::Contains("not a known unit"));
}
