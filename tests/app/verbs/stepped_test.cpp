/// The verbs that oscillators followed by steps answer, a plane slider and a block, by the command.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;
using nlohmann::json;

namespace {

const std::string law = "[law]\ntype = 'coulomb'\nmu_s = 0.4\nmu_d = 0.4\n";
const std::string slider = law +
                           "[oscillator]\ntype = 'plane-slider'\nmass = 3\nstiffness = [400, 400]\ndamping = [6, 6]\n"
                           "[drive]\nnormal_load = 20\n";
/// A force of 12 N that turns with 10 rad/s.
const std::string turned = slider +
                           "force = [{ mean = 0, harmonics = [{ amplitude = 12, angular_frequency = 10 }] }, "
                           "{ mean = 0, harmonics = [{ amplitude = 12, angular_frequency = 10, phase = "
                           "-1.5707963267948966 }] }]\n";
const std::string block = law +
                          "[oscillator]\ntype = 'block'\nlength = 2\nheight = 1\nyoungs_modulus = 20\npoisson_ratio = "
                          "0.3\ndensity = 0.5\nelements = [1, 1]\nspring_stiffness = 0.05\nstiffness_damping = 1e-3\n"
                          "normal_contact = { coefficient = 0.25, exponent = 2, damping = 0.01 }\n"
                          "[drive]\nspeed = 0.1\nnormal_load = 0.5\n[solver]\nscheme = 'average-acceleration'\n"
                          "step = 0.1\nsmoothing = { type = 'parabolic', width = 0.005 }\n";

Printed ask(const Folder& folder, const std::string& verb, const std::string& scene) {
  std::ofstream(folder.path / "scene.toml") << scene;
  return run_rosin(folder, verb + " scene.toml --json --tolerance 1e-5 --no-pictures");
}
json answer(const Folder& folder, const std::string& verb, const std::string& scene) {
  const auto printed = ask(folder, verb, scene);
  INFO(printed.error);
  REQUIRE(printed.status == 0);
  return json::parse(printed.out);
}

}  // namespace

TEST_CASE("a plane slider answers what a slider of one coordinate does", "[app][plane]") {
  const Folder folder;
  // The balance of forces along the radius and across it.
  const double k = 400 - 300, c = 60, F = 8,
               R = (-c * F + std::sqrt(c * c * F * F - (k * k + c * c) * (F * F - 144))) / (k * k + c * c);
  const auto cycle = answer(folder, "cycle", turned);
  CHECK(cycle["returns"] == 1);
  CHECK(cycle["stable"] == true);
  CHECK(std::abs(cycle["displacement_x_max"].get<double>() - R) <= cycle["error"]["displacement_x_max"].get<double>());
  CHECK(cycle["period"].get<double>() == Approx(2 * std::numbers::pi / 10));

  const std::string axis = "{ parameter = 'drive.normal_load', from = 18, to = 20, points = 2, scale = 'linear' }\n";
  const auto map = answer(folder, "map",
                          turned + "[map]\nmetrics = ['displacement_x_max']\nx = " + axis +
                              "y = { parameter = 'oscillator.mass', from = 3, to = 3.1, points = 2, "
                              "scale = 'linear' }\n");
  CHECK(map["metrics"]["displacement_x_max"][0][1].get<double>() == Approx(R).epsilon(1e-5));
  const auto one = answer(folder, "map", turned + "[map]\nx = " + axis);
  CHECK(one["up"]["displacement_x_max"][1].get<double>() == Approx(R).epsilon(1e-5));
  const auto sweep = answer(folder, "sweep",
                            turned +
                                "[sweep]\nparameter = 'drive.normal_load'\nfrom = 18\nto = 20\n"
                                "points = 2\ntransient = 40\nkeep = 3\ndirection = 'both'\n");
  CHECK(sweep["up"].size() == 2);
  CHECK(sweep["recurrence"]["down"][1] == 1);

  // Friction turns with the slip: across it Coulomb's friction damps, along it it does not.
  const auto lyapunov = answer(folder, "lyapunov", turned + "[lyapunov]\nduration = 20\n");
  REQUIRE(lyapunov["exponents"].size() == 1);
  CHECK(lyapunov["exponents"][0].get<double>() < -1);
  CHECK(lyapunov["clock_exponents"].size() == 1);

  const auto starts = [](const char* x, const char* y) {
    return std::string("[basin]\nx = { start = '") + x + "', from = -0.1, to = 0.1, points = 2 }\ny = { start = '" + y +
           "', from = -0.1, to = 0.1, points = 2 }\n";
  };
  for (const auto& names : {std::pair{"displacement_x", "velocity_y"}, {"displacement_1", "velocity_2"}}) {
    const auto basin = answer(folder, "basin", turned + starts(names.first, names.second));
    REQUIRE(basin["attractors"].size() == 1);
    CHECK(basin["attractors"][0]["kind"] == "cycle");
    CHECK(basin["x"]["start"] == "displacement_x");
  }
  CHECK_THAT(ask(folder, "basin", turned + starts("displacement_z", "velocity_x")).error,
             Contains("did you mean 'displacement_x'"));
}

TEST_CASE("a plane slider on a belt slides steadily, with friction over speed as the damper across", "[app][plane]") {
  const Folder folder;
  const auto belt = slider + "speed = [0.3, 0.4]\n";
  const auto stability = answer(folder, "stability", belt);
  CHECK(stability["stable"] == true);
  CHECK(stability["steady"]["coordinates"]["displacement_x"].get<double>() == Approx(8 * 0.6 / 400));
  CHECK(stability["modes"][0]["growth_rate"].get<double>() == Approx(-1));
  CHECK(stability["modes"][1]["growth_rate"].get<double>() == Approx(-(6 + 8 / 0.5) / 6));
  CHECK_THAT(ask(folder, "stability", slider).error, Contains("a surface that moves alone"));
  CHECK_THAT(ask(folder, "cycle", slider).error, Contains("nothing drives the slider"));
  // Along the slip the growth rate is −c/2m at any load, and nothing changes its stability.
  const std::string along = "[branch]\nparameter = 'drive.normal_load'\nfrom = 10\nto = 30\n";
  const auto branch = answer(folder, "branch", belt + along);
  CHECK(branch["points"].size() == 101);
  CHECK(branch["events"].empty());
  for (const auto& point : branch["points"]) CHECK(point["metrics"]["growth_rate"].get<double>() == Approx(-1));
  CHECK_THAT(ask(folder, "branch", belt + along + "start = 'cycle'\n").error,
             Contains("'sweep' follows them along a parameter"));
  CHECK(ask(folder, "cycle", belt).status == 1);  // it comes to steady sliding
}

TEST_CASE("a plane slider whose contact remembers answers every verb that a plane slider does", "[app][plane]") {
  const Folder folder;
  const std::string bristles =
      "[law]\ntype = 'lugre'\nsigma0 = 200\nsigma1 = 2\nsigma2 = 0.1\nmu_s = 0.3\nmu_d = 0.3\n" +
      turned.substr(law.size());
  const auto run = answer(folder, "run", bristles + "[run]\nduration = 1\nsamples = 10\nstart = { z = [1e-4, 0] }\n");
  CHECK(run["columns"]["z_x"][0].get<double>() == Approx(1e-4));
  CHECK(run["columns"].contains("z_y"));
  CHECK_FALSE(run["metrics"].contains("stick_time"));
  const auto cycle = answer(folder, "cycle", bristles);
  CHECK(cycle["returns"] == 1);
  const double R = cycle["displacement_x_max"].get<double>();
  const auto map = answer(folder, "map",
                          bristles +
                              "[map]\nmetrics = ['displacement_x_max']\nx = { parameter = 'law.sigma0', from = 200, to "
                              "= 400, points = 2 }\n");
  CHECK(map["up"]["displacement_x_max"][0].get<double>() == Approx(R).epsilon(1e-4));
  const auto sweep = answer(folder, "sweep",
                            bristles +
                                "[sweep]\nparameter = 'drive.normal_load'\nfrom = 18\nto = 20\npoints = 2\n"
                                "transient = 40\nkeep = 3\n");
  CHECK(sweep["up"].size() == 2);
  const auto lyapunov = answer(folder, "lyapunov", bristles + "[lyapunov]\nduration = 20\n");
  CHECK(lyapunov["exponents"][0].get<double>() < 0);
  const auto basin = answer(folder, "basin",
                            bristles +
                                "[basin]\nx = { start = 'displacement_x', from = -0.1, to = 0.1, points = 2 }\n"
                                "y = { start = 'velocity_y', from = -0.1, to = 0.1, points = 2 }\n");
  CHECK(basin["attractors"][0]["kind"] == "cycle");
}

TEST_CASE("along its slip a plane slider has the eigenvalues of the slider, with states too", "[app][plane]") {
  const Folder folder;
  const std::string ageing = "[law]\ntype = 'ageing'\nmu0 = 0.55\na = 0.015\nb = 0.028\nL = 0.12\nv0 = 0.08\n";
  const auto plane = answer(folder, "stability",
                            ageing +
                                "[oscillator]\ntype = 'plane-slider'\nmass = 1\nstiffness = [1.5, "
                                "1.5]\ndamping = [0, 0]\n[drive]\nspeed = [0.06, 0.08]\n"
                                "normal_load = 6.5\n");
  const auto one =
      answer(folder, "stability",
             ageing + "[oscillator]\nmass = 1\nstiffness = 1.5\n[drive]\nspeed = 0.1\nnormal_load = 6.5\n");
  REQUIRE(plane["eigenvalues"].size() == 5);
  for (const auto& wanted : one["eigenvalues"]) {
    double nearest = 1;
    for (const auto& z : plane["eigenvalues"])
      nearest = std::min(nearest, std::hypot(z[0].get<double>() - wanted[0].get<double>(),
                                             z[1].get<double>() - wanted[1].get<double>()));
    CHECK(nearest < 1e-10);
  }
}

TEST_CASE("a block answers by its steps", "[app][block][long]") {
  const Folder folder;
  const auto cycle = answer(folder, "cycle", block + "[cycle]\nstart = { tilt = 1e-2 }\n");
  // Friction on average is that of the spring, whatever the motion.
  CHECK(cycle["friction_force_mean"].get<double>() ==
        Approx(0.05 * cycle["elongation_mean"].get<double>()).epsilon(0.02));
  CHECK(cycle["error"]["period"].get<double>() < 0.05 * cycle["period"].get<double>());
  const auto lyapunov = answer(folder, "lyapunov", block + "[lyapunov]\nduration = 60\ntransient = 60\n");
  CHECK(lyapunov["exponents"].size() == 1);
  const auto basin = answer(folder, "basin",
                            block +
                                "[basin]\nx = { start = 'tilt', from = 0, to = 0.01, points = 2 }\n"
                                "y = { start = 'along', from = 0, to = 0.1, points = 2 }\n");
  CHECK(basin["attractors"][0]["count"].get<int>() > 0);
  CHECK_THAT(ask(folder, "basin", block + "[basin]\n").error, Contains("basin"));
  CHECK_THAT(ask(folder, "basin", block + "[basin]\ndirection = { tilt = 1 }\nto = 1\n").error,
             Contains("basin.direction serves structures"));
}
