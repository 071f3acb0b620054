/// The program examples/your_own_oscillator.cpp: the command with a type of oscillators that the user added.
#include "app/add_oscillator.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin;
using namespace rosin::tests;
using nlohmann::json;

namespace {

const std::string own_program =
    (std::filesystem::path(ROSIN_COMMAND).parent_path() / "examples/example_your_own_oscillator").string();

constexpr double J1 = 0.2, J2 = 0.5, k = 60, k2 = 200, c = 0.2, R = 0.1, mu_s = 0.4, delta = 0.5, V = 0.5;

const std::string law = "[law]\ntype = 'hyperbolic'\nmu_s = 0.4\ndelta = 0.5\n",
                  drive = "[drive]\nspeed = 0.5\nnormal_load = 80\n",
                  own =
                      "[oscillator]\ntype = 'two-rotors'\ninertia_1 = 0.2\ninertia_2 = 0.5\nstiffness = 60\n"
                      "stiffness_2 = 200\ndamping = 0.2\nclutch_radius = 0.1\n",
                  by_matrices =
                      "[oscillator]\ntype = 'structure'\nM = [[0.2, 0], [0, 0.5]]\nC = [[0.2, -0.2], [-0.2, 0.2]]\n"
                      "K = [[60, -60], [-60, 260]]\n[[oscillator.contacts]]\ntangential = [0.1, 0]\n";

json answer(const Folder& folder, const std::string& program, const std::string& verb, const std::string& scene) {
  std::ofstream(folder.path / "scene.toml") << scene;
  const auto printed =
      run_program(folder, program, verb + " scene.toml --json --no-pictures --tolerance 1e-6 --out out");
  INFO(program << ' ' << verb << '\n' << scene << '\n' << printed.error);
  REQUIRE(printed.status <= 1);  // 1: a document that says how far it came
  return json::parse(printed.out);
}

/// Every number of a document, ascending: coordinates have other names and so stand at other places.
void collect(const json& document, std::vector<double>& into) {
  if (document.is_object()) {
    for (const auto& [key, value] : document.items())
      if (key != "seconds" && key != "manifest") collect(value, into);
  } else if (document.is_array()) {
    for (const auto& element : document) collect(element, into);
  } else if (document.is_number()) {
    into.push_back(document.get<double>());
  }
}

std::vector<double> numbers_of(const json& document) {
  std::vector<double> numbers;
  collect(document, numbers);
  std::ranges::sort(numbers);
  return numbers;
}

}  // namespace

TEST_CASE("an oscillator that a program adds answers each verb as the structure of its matrices",
          "[app][oscillator][long]") {
  const std::string axis = "{ parameter = 'drive.normal_load', from = 70, to = 90, points = 3, scale = 'linear' }";
  const std::string run = "[run]\nduration = 3\nsamples = 50\nstart = 'rest'\n",
                    members = "members = [{ name = 'one' }, { name = 'two', set = { 'drive.normal_load' = 90 } }]\n";
  const std::vector<std::pair<std::string, std::string>> questions = {
      {"run", run},
      {"fit",
       "[fit]\nparameters = ['law.mu_s']\nstarts = 1\n"
       "data = [{ type = 'motion', file = 'record.csv', measured = ['slip_rate'], start = 'rest' }]\n"},
      {"stability", "[stability]\nscan = { parameter = 'drive.normal_load', from = 1, to = 200, points = 5 }\n"},
      {"cycle", ""},
      {"map", "[map]\nx = " + axis + "\n"},
      {"sweep", "[sweep]\nparameter = 'drive.normal_load'\nfrom = 70\nto = 90\npoints = 3\nscale = 'linear'\n"},
      {"branch", "[branch]\nparameter = 'drive.normal_load'\nfrom = 70\nto = 90\n"},
      {"lyapunov", "[lyapunov]\nduration = 3\ntransient = 1\n"},
      {"basin",
       "[basin]\nx = { start = 'COORDINATE_1', from = -0.1, to = 0.1, points = 2 }\n"
       "y = { start = 'VELOCITY_1', from = -1, to = 1, points = 2 }\n"},
      {"frf", "[frf]\nfrequencies = { from = 0.1, to = 10, points = 5, scale = 'log' }\n"},
      {"compare", run + "[compare]\nprotocol = 'run'\n" + members},
      {"compare", "[compare]\nprotocol = 'cycle'\n" + members}};
  const Folder folder;
  for (const auto& [verb, table] : questions) {
    CAPTURE(verb, table);
    const auto named = [&, table = table](const std::string& coordinate, const std::string& velocity) {
      auto text = table;
      for (const auto& [word, by] : {std::pair{"COORDINATE_1", coordinate}, std::pair{"VELOCITY_1", velocity}})
        if (const auto at = text.find(word); at != std::string::npos) text.replace(at, std::string(word).size(), by);
      return text;
    };
    const auto ours =
        numbers_of(answer(folder, own_program, verb, law + own + drive + named("angle_1", "velocity_of_angle_1")));
    const auto theirs = numbers_of(
        answer(folder, ROSIN_COMMAND, verb, law + by_matrices + drive + named("displacement_1", "velocity_1")));
    if (verb == "run") std::filesystem::copy_file(folder.path / "out/run.csv", folder.path / "record.csv");
    CHECK(ours == theirs);
    CHECK(ours.size() > 5);
  }
}

TEST_CASE("two rotors with a clutch lose stability where Hurwitz's determinant vanishes", "[app][oscillator]") {
  const Folder folder;
  const auto document = answer(
      folder, own_program, "stability",
      law + own + drive + "[stability]\nscan = { parameter = 'drive.normal_load', from = 1, to = 200, points = 5 }\n");
  // Friction R N μ(V − R q̇₁) is a torque that grows with q̇₁, as of a damper −R² N |μ'(V)|.
  const double slope = mu_s * delta / std::pow(1 + delta * V, 2);
  const auto hurwitz = [&](double load) {
    const double c11 = c - R * R * load * slope, k22 = k + k2;
    const double a4 = J1 * J2, a3 = J1 * c + J2 * c11, a2 = J1 * k22 + J2 * k + c11 * c - c * c,
                 a1 = c11 * k22 + c * k - 2 * c * k, a0 = k * k2;
    return a3 * (a2 * a1 - a3 * a0) - a4 * a1 * a1;
  };
  REQUIRE(document["thresholds"].size() == 1);
  const auto& threshold = document["thresholds"][0];
  const double load = threshold["value"], error = threshold["error"];
  const double away = std::max(error, 1e-12 * load);
  CHECK(error < 1e-8 * load);
  CHECK(hurwitz(load - away) * hurwitz(load + away) < 0);
}

TEST_CASE("undamped rotors under constant friction have the frequencies of two springs", "[app][oscillator]") {
  const Folder folder;
  const auto document = answer(folder, own_program, "stability --set oscillator.damping=0",
                               "[law]\ntype = 'coulomb'\nmu_s = 0.4\nmu_d = 0.3\n" + own + drive);
  // ω² are the roots of J1 J2 s² − (J1 (k + k2) + J2 k) s + k k2.
  const double b = J1 * (k + k2) + J2 * k, root = std::sqrt(b * b - 4 * J1 * J2 * k * k2);
  std::set<double> found;
  for (const auto& mode : document["modes"]) found.insert(mode["frequency"].get<double>());
  REQUIRE(found.size() == 2);
  CHECK(*found.begin() == Approx(std::sqrt((b - root) / (2 * J1 * J2)) / (2 * M_PI)).epsilon(1e-12));
  CHECK(*found.rbegin() == Approx(std::sqrt((b + root) / (2 * J1 * J2)) / (2 * M_PI)).epsilon(1e-12));
}

TEST_CASE("what an added oscillator cannot be is refused by name", "[app][oscillator]") {
  const Folder folder;
  const auto refused = [&](const std::string& scene) {
    std::ofstream(folder.path / "scene.toml") << scene;
    const auto printed = run_program(folder, own_program, "run scene.toml --no-pictures");
    CHECK(printed.status == 2);
    return printed.error;
  };
  const std::string rest = drive + "[run]\nduration = 1\n";
  CHECK_THAT(refused(law + own + "inertia_3 = 1\n" + rest), Contains("inertia_3") && Contains("inertia_1"));
  CHECK_THAT(refused(law + "[oscillator]\ntype = 'two-rotors'\ninertia_1 = -1\n" + rest),
             Contains("oscillator.inertia_1 = -1 is outside") && Contains("kg m^2"));
  CHECK_THAT(refused(law + "[oscillator]\ntype = 'two-rotor'\n" + rest), Contains("did you mean 'two-rotors'"));
  const auto taken = [](const std::string& name, const std::string& key) {
    app::add_oscillator({.name = name, .parameters = {{{key, "kg", {0, 1}, "mass"}, 1}}, .structure = {}});
  };
  CHECK_THROWS_WITH(taken("slider", "mass"), Contains("'slider' is taken"));
  CHECK_THROWS_WITH(taken("mine", "radius"), Contains("oscillator.radius is a key of every oscillator"));
}
