/// The verb branch: what it refuses, and that it follows cycles where steady sliding is never stable.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

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
  CHECK_THAT(answer.error, Contains("steady sliding is unstable throughout"));
}

TEST_CASE("a second parameter gives curves from one end of its range to the other", "[app][branches]") {
  const Folder folder;
  const auto answer = run_rosin(
      folder, "branch " ROSIN_SOURCE_DIR
              "/examples/two-motions.toml --set branch.values='[]' --set branch.to=1.3 --set branch.points=10 "
              "--set branch.locus='{parameter=\"oscillator.damping\",from=0.08,to=0.3,points=8}' --no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
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
