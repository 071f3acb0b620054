/// The verb basin: what it tells, and what it refuses.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace {

const std::string command = "basin " ROSIN_SOURCE_DIR "/examples/which-motion.toml ";

}  // namespace

TEST_CASE("starts on a grid have labels in rows of y, and a threshold beside them", "[app][basin]") {
  const Folder folder;
  const auto answer = run_rosin(folder, command +
                                            "--set basin.x.points=9 --set basin.y.points=5 --set basin.points=3 "
                                            "--no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto document = nlohmann::json::parse(answer.out);
  const auto& labels = document["labels"];
  REQUIRE(labels.size() == 5);
  REQUIRE(labels[0].size() == 9);
  REQUIRE(document["attractors"].size() == 2);
  CHECK(document["attractors"][0]["kind"] == "steady");
  CHECK(document["attractors"][1]["kind"] == "cycle");
  int cycles = 0;
  for (const auto& row : labels)
    for (const int label : row) cycles += label;
  CHECK(document["attractors"][1]["count"] == cycles);
  CHECK(document["attractors"][1]["share"] == Approx(cycles / 45.0));
  // Far off steady sliding (0.525 m), and beside it.
  CHECK(labels[2][0] == 1);
  CHECK(labels[2][4] == 0);
  CHECK(document["threshold"]["beyond"] == 1);
  CHECK(document["threshold"]["value"].get<double>() == Approx(1.23985488445).epsilon(1e-6));
  // The belt runs at 1.5 m/s: slip rates from 3.5 to -0.5 are the same starts.
  const auto by_slip_rate = run_rosin(folder, command +
                                                  "--set basin.x.points=9 --set basin.y.points=5 "
                                                  "--set basin.y.start=slip_rate --set basin.y.from=3.5 --set "
                                                  "basin.y.to=-0.5 --set basin.points=3 --no-pictures --json");
  INFO(by_slip_rate.error);
  REQUIRE(by_slip_rate.status == 0);
  CHECK(nlohmann::json::parse(by_slip_rate.out)["labels"] == labels);
}

TEST_CASE("random starts are the same for the same seed", "[app][basin]") {
  const Folder folder;
  const std::string random =
      "--set basin.x='{start=\"displacement\",from=-2,to=2}' --set basin.y='{start=\"velocity\",from=0,to=2}' "
      "--set basin.samples=20 --no-pictures --json --set basin.points=2 --set basin.seed=";
  const auto share = [&](const char* seed) {
    const auto answer = run_rosin(folder, command + random + seed);
    INFO(answer.error);
    REQUIRE(answer.status == 0);
    const auto document = nlohmann::json::parse(answer.out);
    CHECK_FALSE(document.contains("labels"));
    return document["attractors"][1]["share"].get<double>();
  };
  const double one = share("1");
  CHECK(share("1") == one);
  CHECK(share("2") != one);
}

TEST_CASE("wrong keys of a basin are refused with their range or the nearest name", "[app][basin]") {
  const Folder folder;
  const auto refused = [&](const std::string& change, const std::string& why) {
    const auto answer = run_rosin(folder, command + "--set " + change);
    INFO(change);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(why));
  };
  refused("basin.x.start=displacment", "did you mean 'displacement'?");
  refused("basin.y.start=displacement", "basin.x and basin.y are the same, displacement");
  refused("basin.x.start=velocity --set basin.y.start=slip_rate", "are the same, velocity and slip_rate");
  refused("basin.smaples=5", "unknown key 'smaples' in [basin]; did you mean 'samples'?");
  refused("basin.samples=5", "basin.x.points does not go with basin.samples");
  refused("basin.seed=5", "basin.seed has no effect without basin.samples");
  refused("basin.x.to=-2", "basin.x.from and basin.x.to are both -2");
  refused("basin.direction='{velocty=1}'", "did you mean 'velocity'?");
  refused("basin.direction='{velocity=0}'", "basin.direction does not disturb anything");
  refused("basin.from=3", "basin.from = 3 must be nearer to 0 than basin.to = 2");
  refused("basin.returns=1", "basin.returns = 1 is outside 10");
  refused("drive.speed=1", "steady sliding does not attract");
  refused("oscillator.mass=0", "mass");
  refused("oscillator.stops='[-1, 3]'", "lies behind the stop");
  const auto alone = run_rosin(folder, "basin " ROSIN_SOURCE_DIR "/examples/two-motions.toml");
  CHECK(alone.status == 2);
  CHECK_THAT(alone.error, Contains("the scene has no [basin]"));
}

TEST_CASE("refined borders say which starts were followed, and are refused for random starts", "[app][basin][long]") {
  const Folder folder;
  const std::string grid = "--set basin.x.points=33 --set basin.y.points=33 --set basin.points=3 --no-pictures ";
  REQUIRE(run_rosin(folder, command + grid + "--out full").status == 0);
  const auto answer = run_rosin(folder, command + grid + "--set basin.refine=true --out refined");
  REQUIRE(answer.status == 0);
  CHECK_THAT(answer.out, Contains("of 1089 starts followed"));
  const auto full = nlohmann::json::parse(content(folder.path / "full/basin.json")),
             refined = nlohmann::json::parse(content(folder.path / "refined/basin.json"));
  CHECK(refined["labels"] == full["labels"]);
  CHECK_FALSE(full.contains("refined"));
  CHECK(refined["refined"]["followed"] < 1089);
  CHECK_THAT(content(folder.path / "refined/basin.csv"), Contains("attractor,followed\n"));
  const auto random = run_rosin(folder, command +
                                            "--set \"basin.x={start='displacement',from=-1,to=1}\" --set "
                                            "\"basin.y={start='velocity',from=-1,to=1}\" --set basin.samples=5 --set "
                                            "basin.refine=true");
  CHECK(random.status == 2);
  CHECK_THAT(random.error, Contains("basin.refine has no effect on basin.samples"));
}
