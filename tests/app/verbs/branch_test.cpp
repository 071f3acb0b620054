/// The verb branch: what it refuses, and that it follows cycles where steady sliding is never stable.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace {
void write(const Folder& folder, const char* name, const std::string& text) {
  std::ofstream(folder.path / name) << text;
}
}  // namespace

TEST_CASE("wrong keys of a branch are refused with their range or the nearest name", "[app][branches]") {
  const Folder folder;
  const auto refused = [&](const std::string& change, const std::string& why) {
    const auto answer = run_rosin(folder, "branch " ROSIN_SOURCE_DIR "/examples/two-motions.toml --set " + change);
    INFO(change);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(why));
  };
  refused("branch.parameter=drive.sped", "did you mean 'drive.speed'?");
  refused("branch.strt=1", "unknown key 'strt' in [branch]; did you mean 'start'?");
  refused("branch.to=0.5", "branch.from and branch.to are both 0.5");
  refused("branch.values=[7]", "branch.values: 7 is not between from (0.5) and to (2.5)");
  refused("branch.doublings=99", "branch.doublings = 99");
  refused("branch.from=-1 --set branch.scale=log", "needs from and to on one side of 0");
  refused("oscillator.mass=0", "mass");
  const std::string locus = "branch.locus='{parameter=\"oscillator.damping\",from=0.05,to=0.3}' --set branch.locus.";
  refused(locus + "parameter=drive.speed", "branch.locus.parameter and branch.parameter are the same, drive.speed");
  refused(locus + "parameter=oscillator.dampin", "did you mean 'oscillator.damping'?");
  refused(locus + "parameter=oscillator.stops", "is no number of this scene");
  refused(locus + "to=0.08", "the scene has oscillator.damping = 0.1, which is not between from (0.05) and to (0.08)");
  refused(locus + "to=0.05", "branch.locus.from and branch.locus.to are both 0.05");
  refused(locus + "points=1", "branch.locus.points = 1 is outside 2");
  refused("branch.start=cycle --set branch.from=2 --set branch.values=[2.2]", "the motion settles on no cycle");
}

TEST_CASE("a branch tells its points and events, and goes on from stick-slip where sliding is never stable",
          "[app][branches]") {
  const Folder folder;
  const auto answer =
      run_rosin(folder, "branch " ROSIN_SOURCE_DIR
                        "/examples/leine-belt-block.toml --set branch.parameter=drive.speed --set branch.from=0.1 "
                        "--set branch.to=0.3 --no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  CHECK_THAT(answer.out, Contains("\"kind\": \"equilibrium\"") && Contains("\"kind\": \"cycle\"") &&
                             Contains("\"events\"") && Contains("\"stick_fraction\""));
  CHECK_THAT(answer.error, Contains("steady sliding is nowhere stable"));
}

TEST_CASE("a second parameter gives curves from one end of its range to the other", "[app][branches]") {
  const Folder folder;
  const auto answer = run_rosin(
      folder, "branch " ROSIN_SOURCE_DIR
              "/examples/two-motions.toml --set branch.values='[]' --set branch.to=1.3 --set branch.points=10 "
              "--set branch.locus='{parameter=\"oscillator.damping\",from=0.08,to=0.3,points=8}' --no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 1);  // ten points do not reach the end
  CHECK_THAT(answer.error, Contains("10 points before the branch from drive.speed = 1.15129255 came to its end"));
  const auto document = nlohmann::json::parse(answer.out);
  const auto& hopf = document["loci"][0];
  CHECK(hopf["kind"] == "hopf");
  CHECK(hopf["parameter"] == "oscillator.damping");
  CHECK(hopf["begins"] == "at the end of the range");
  const auto &first = hopf["points"].front(), &last = hopf["points"].back();
  CHECK(first["locus_value"] == Approx(0.08));
  CHECK(first["value"] == Approx(0.5 * std::log(1 / 0.08)));
  CHECK(last["value"] == Approx(0.5 * std::log(1 / 0.3)));
}

TEST_CASE("a branch tells the cycles of the normal form beside its own", "[app][branches]") {
  const Folder folder;
  const auto answer = run_rosin(folder, "branch " ROSIN_SOURCE_DIR
                                        "/examples/two-motions.toml --set branch.values='[]' --set branch.to=1.3 "
                                        "--no-pictures --json --out out");
  REQUIRE(answer.status == 0);
  const auto hopf = nlohmann::json::parse(answer.out)["events"][0];
  const double critical = 0.5 * std::log(10);
  CHECK(hopf["squared_amplitude_slope"].get<double>() == Approx(4 / (critical * critical)).epsilon(1e-6));
  std::istringstream table(content(folder.path / "out/branch.csv"));
  std::string line;
  std::getline(table, line);
  CHECK_THAT(line, Catch::Matchers::EndsWith(",slip_rate_max_normal_form (m/s)"));
  int compared = 0;
  while (std::getline(table, line)) {
    const auto ending = line.substr(line.rfind(',') + 1);
    const double value = std::stod(line.substr(line.find(',') + 1));
    if (line.starts_with("-1,")) CHECK(ending == "nan");
    if (!line.starts_with("0,") || value - critical > 0.02) continue;
    ++compared;
    CHECK(std::stod(ending) == Approx(value * (1 + std::sqrt(4 * (value - critical)) / critical)).epsilon(1e-9));
  }
  CHECK(compared > 1);
  CHECK_THAT(content(folder.path / "out/branch.gp"), Contains("weakly nonlinear"));
}

TEST_CASE("steady sliding that is asked for is told, whether or not the motion beside it settles on a cycle",
          "[app][branches][long]") {
  const Folder folder;
  write(folder, "belt.toml", R"(
[law]
type = "hyperbolic"
mu_s = 1
delta = 3
[oscillator]
type = "two-mass-belt"
mass = 1
stiffness = 1
second_mass = 3
second_stiffness = 2
[drive]
speed = 0.2
normal_load = 1
[branch]
parameter = "drive.speed"
from = 0.15
to = 0.25
start = "steady"
)");
  const auto answer = run_rosin(folder, "branch belt.toml --no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto document = nlohmann::json::parse(answer.out);
  CHECK(document["events"].empty());
  CHECK(document["points"].size() == 101);
  for (const auto& point : document["points"]) {
    CHECK(point["stable"] == false);
    // friction falls with the slip rate: growth is positive.
    CHECK(point["metrics"]["growth_rate"] > 0);
  }
  CHECK_THAT(document["notes"].dump(),
             Contains("without a Hopf point, and no cycles are followed: at branch.from = 0.15"));
}

TEST_CASE("a branch follows the motion to which its start leads", "[app][branches][long]") {
  // Two motions live at 0.3 m/s: period three, and chaos from rest.
  const std::string scene = R"(
[law]
type = "hyperbolic"
mu_s = 1
delta = 3
[oscillator]
mass = 1
stiffness = 1
damping = 0.02
[drive]
speed = 0.3
normal_load = 1
force = { mean = 0, harmonics = [{ amplitude = 0.5, angular_frequency = 2 }] }
[branch]
parameter = "drive.speed"
from = 0.3
to = 0.301
)";
  const Folder folder;
  write(folder, "cycle.toml", scene + "start = \"cycle\"\n[cycle]\nstart = { displacement = 2, velocity = -1.3333 }\n");
  write(folder, "table.toml", scene + "start = { displacement = 2, velocity = -1.3333 }\n");
  write(folder, "both.toml", scene + "start = { displacement = 2, velocity = -1.3333 }\n[cycle]\nstart = \"rest\"\n");
  for (const std::string name : {"cycle", "table", "both"}) {
    const auto answer = run_rosin(folder, "branch " + name + ".toml --no-pictures --json");
    INFO(name << answer.error);
    REQUIRE(answer.status == 0);
    const auto document = nlohmann::json::parse(answer.out);
    CHECK(std::abs(document["points"][0]["metrics"]["period"].get<double>() - 9.42477796) < 1e-8);
    CHECK((document["notes"].dump().find("cycle.start has no effect") != std::string::npos) == (name == "both"));
    CHECK(document["points"][0]["error"]["multipliers"].size() == document["points"][0]["multipliers"].size());
  }
  const auto rest = run_rosin(folder, "branch table.toml --set branch.start=rest");
  CHECK(rest.status == 2);
  write(folder, "wrong.toml", scene + "start = { displacment = 2 }\n");
  const auto wrong = run_rosin(folder, "branch wrong.toml");
  CHECK(wrong.status == 2);
  CHECK_THAT(wrong.error, Contains("displacment") && Contains("did you mean 'displacement'?"));
}

TEST_CASE("a frequency without which the others of a drive keep no period is no parameter of a branch",
          "[app][branches]") {
  const Folder folder;
  write(folder, "two.toml", R"(
[law]
type = "coulomb"
mu_s = 0.2
mu_d = 0.2
[oscillator]
mass = 1
stiffness = 1
damping = 0.2
[drive]
speed = 0
normal_load = 1
force = { mean = 0, harmonics = [{ amplitude = 1, angular_frequency = 0.5 }, { amplitude = 0.3, angular_frequency = 1.5 }] }
[branch]
parameter = "drive.force.angular_frequency"
from = 0.5
to = 0.8
)");
  const auto answer = run_rosin(folder, "branch two.toml");
  CHECK(answer.status == 2);
  CHECK_THAT(answer.error, Contains("does not vary continuously along the parameter"));
}

TEST_CASE("motions that coexist are followed from a start each, and one that two starts lead to once",
          "[app][branches][long]") {
  // Short of its stop the block is a linear oscillator, of the amplitude F/√((k − m ω²)² + (c ω)²); with more speed it
  // beats the stop, up to a fold.
  const Folder folder;
  write(folder, "two.toml", R"(
[law]
type = "coulomb"
mu_s = 0
mu_d = 0
[oscillator]
mass = 1
stiffness = 1
damping = 0.05
stops = [{ coordinate = 1, at = 1, stiffness = 20 }]
[drive]
speed = 0
normal_load = 1
force = { mean = 0, harmonics = [{ amplitude = 0.3, angular_frequency = 1.3 }] }
[branch]
parameter = "drive.force.harmonics.1.angular_frequency"
from = 1.3
to = 1.6
start = [{ velocity = 0 }, { velocity = 1.5 }, { velocity = 0.01 }]
)");
  const auto answer = run_rosin(folder, "branch two.toml --no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto document = nlohmann::json::parse(answer.out);
  REQUIRE(document["branches"].size() == 2);
  CHECK_THAT(document["notes"].dump(), Contains("start 3: its motion is that of branch 0"));
  double beats = 0;
  for (const auto& point : document["points"]) {
    const double w = point["value"], most = point["metrics"]["displacement_max"];
    if (point["branch"] == 0)
      CHECK(most == Approx(0.3 / std::hypot(1 - w * w, 0.05 * w)).epsilon(1e-7));
    else
      beats = std::max(beats, most);
  }
  CHECK(beats > 1.4);
  REQUIRE(document["events"].size() == 1);
  CHECK(document["events"][0]["kind"] == "fold");
  CHECK(document["events"][0]["branch"] == 1);
}

TEST_CASE("doubled cycles end at the doubling where their halves are equal again, and are followed once",
          "[app][branches]") {
  const Folder folder;
  const auto answer = run_rosin(
      folder, "branch " ROSIN_SOURCE_DIR
              "/cases/branches/modulated-load.toml --set "
              "drive.normal_load.harmonics.1.amplitude=2e-3 --set branch.parameter=drive.normal_load.angular_frequency "
              "--set branch.from=1.2 --set branch.to=1.7 --tolerance 1e-6 --no-pictures --json");
  REQUIRE(answer.status == 0);
  const auto document = nlohmann::json::parse(answer.out);
  // Born at 1.392 rad/s, turned at a fold, and gone at 1.561 rad/s, the other edge of parametric resonance.
  REQUIRE(document["branches"].size() == 2);
  const auto& doubled = document["branches"][1];
  CHECK(doubled["value"].get<double>() == Approx(1.3922215).epsilon(1e-6));
  CHECK(doubled["to_value"].get<double>() == Approx(1.5608163713).epsilon(1e-8));
  CHECK(doubled["points"].get<int>() < 200);
  int folds = 0;
  for (const auto& event : document["events"]) folds += event["kind"] == "fold";
  CHECK(folds == 1);
}
