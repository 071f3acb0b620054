/// Text with units to SI: exact decimal prefixes, friendly spellings, and what is refused.
#include "core/units.hpp"

#include <catch2/catch.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/error.hpp"

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
