/// Hot film: steady friction and the speed at which it is strongest to 40 digits, the film of one temperature as a
/// limit, and the balance of heat.
#include <catch2/catch.hpp>
#include <cmath>

#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("hot-film: steady friction is that of 40 digits, over ten decades and 1235 K", "[laws][hot-film]") {
  const auto law = laws::find_law("hot-film");
  const double values[][3] = {
      {1e-9, 0.0327718491795342, 1.31087396718e-7}, {1e-6, 0.1018347684869037, 4.07339073948e-4},
      {1e-3, 0.1702709799975933, 0.68108391999},    {1e-2, 0.1870456929313322, 7.48182771725},
      {1e-1, 0.1657159412601849, 66.2863765041},    {1, 0.08718137582760431, 348.72550331},
      {10, 0.03087485327793327, 1234.99413112}};
  for (const auto& [v, mu, rise] : values) {
    CHECK(law->steady_friction({v, 1}).friction == Approx(mu).epsilon(1e-14));
    CHECK(law->steady({v, 1})[1] == Approx(rise).epsilon(1e-11));
    // All power warms: ϑ = R μ N v.
    CHECK(law->steady({v, 1})[1] == Approx(4e3 * mu * v).epsilon(1e-13));
  }
  // Friction is strongest where ϑ [(E_a + p V_a)/(k_B T²) + 1/T] = 1.
  CHECK(std::abs(law->steady_friction({0.01519862619756297, 1}).slope) < 1e-12);
  const double rise = law->steady({0.01519862619756297, 1})[1], T = 293.15 + rise;
  CHECK(rise * ((1e-19 + 1e8 * 8e-29) / (1.380649e-23 * T * T) + 1 / T) == Approx(1).epsilon(1e-9));
}

TEST_CASE("hot-film: without heat it is the film of one temperature", "[laws][hot-film]") {
  const double T = 293.15, kT = 1.380649e-23 * T;
  const auto hot = laws::find_law("hot-film")->with("R", 0.0);
  const auto film = laws::find_law("film")->with("v0", 1e-9 * 1e8 * T * std::exp(-1e-19 / kT))->with("p0", kT / 8e-29);
  for (const double N : {0.1, 1.0, 3.0})
    for (const double v : {1e-12, 1e-6, -1e-4, 1.0}) {
      CHECK(hot->steady_friction({v, N}).friction == Approx(film->steady_friction({v, N}).friction).epsilon(1e-12));
      const double stress[] = {3e6, 0};
      CHECK(hot->rate({v, N}, stress)[0] == Approx(film->rate({v, N}, std::vector{3e6})[0]).epsilon(1e-12));
    }
}

TEST_CASE("hot-film: friction that has warmed a film a million times over is still found", "[laws][hot-film]") {
  const auto law = laws::find_law("hot-film")->with("R", 1e15);
  for (const double v : {1e-9, 1e-3, 1.0, 1e3}) {
    const auto state = law->steady({v, 1});
    CHECK(state[1] == Approx(1e15 * 1e-8 * state[0] * v).epsilon(1e-12));
    const auto rate = law->rate({v, 1}, state);
    CHECK(std::abs(rate[0]) < 1e-9 * 1e9 / 1e-9 * v);
  }
}
