/// Sweeps by the command that are killed and taken up again.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/verbs/sweep_journal.hpp"
#include "tests/app/command.hpp"
#include "tests/app/scene_of.hpp"

using Catch::Matchers::Contains;
using namespace rosin;
using namespace rosin::app;
using namespace rosin::tests;
using nlohmann::json;

namespace {

namespace fs = std::filesystem;

const std::string forced = "sweep '" ROSIN_SOURCE_DIR "/examples/forced-belt-sweep.toml' --no-pictures ";

json timeless(const fs::path& path) {
  auto document = json::parse(content(path));
  document["cost"].erase("seconds");
  return document;
}

/// Starts the command and kills it as soon as its journal has some bytes. \returns whether it was killed in time
bool killed(const Folder& folder, const std::string& arguments, const std::string& journal, int bytes) {
  const auto line = "cd '" + folder.path.string() + "' && ('" ROSIN_COMMAND "' " + arguments +
                    " >out.txt 2>error.txt & p=$!; while kill -0 $p 2>/dev/null; do s=$(stat -c %s " + journal +
                    " 2>/dev/null || echo 0); [ $s -gt " + std::to_string(bytes) +
                    " ] && kill -9 $p; sleep 0.005; done; wait)";
  std::system(line.c_str());
  return fs::exists(folder.path / journal);
}

}  // namespace

TEST_CASE("a sweep that is killed goes on to the same bytes, wherever each value starts", "[app][sweep][long]") {
  const std::string few = forced + "--set sweep.points=24 --set sweep.keep=40 ";
  const std::string metrics = "sweep '" ROSIN_SOURCE_DIR
                              "/examples/sliding-or-stick-slip.toml' --no-pictures --set sweep.points=40 --set "
                              "sweep.record=metrics ";
  // Lanes do 32 values at once, in milliseconds: of many there is time to be killed between.
  const std::string lanes = forced + "--set sweep.points=300 --set sweep.keep=400 --set sweep.start=scene --threads 2 ";
  for (const auto& sweep : {few, lanes, metrics}) {
    CAPTURE(sweep);
    const Folder folder;
    REQUIRE(run_rosin(folder, sweep + "--out whole").status == 0);
    CHECK_FALSE(fs::exists(folder.path / "whole/sweep.partial"));
    REQUIRE(killed(folder, sweep + "--out killed", "killed/sweep.partial", 4000));
    CHECK_FALSE(fs::exists(folder.path / "killed/sweep.json"));
    std::ofstream(folder.path / "killed/sweep.partial", std::ios::app | std::ios::binary) << "torn record";
    const auto again = run_rosin(folder, sweep + "--out killed");
    REQUIRE(again.status == 0);
    CHECK_THAT(again.error, Contains("going on from") && Contains("finished values") && Contains("damaged after"));
    CHECK_FALSE(fs::exists(folder.path / "killed/sweep.partial"));
    CHECK(content(folder.path / "killed/sweep.nc") == content(folder.path / "whole/sweep.nc"));
    CHECK(content(folder.path / "killed/sweep.csv") == content(folder.path / "whole/sweep.csv"));
    CHECK(timeless(folder.path / "killed/sweep.json") == timeless(folder.path / "whole/sweep.json"));
  }
}

TEST_CASE("a sweep that is interrupted says how to go on, and does not go on from another", "[app][sweep]") {
  const Folder folder;
  const auto early = run_rosin(folder, forced + "--set sweep.keep=2000 --out a --time-limit 0.5");
  CHECK(early.status == 1);
  CHECK_THAT(early.error, Contains("the same command goes on from there"));
  CHECK(json::parse(content(folder.path / "a/sweep.json"))["outcome"] == "budget spent");
  CHECK(fs::exists(folder.path / "a/sweep.partial"));
  const auto other = run_rosin(folder, forced + "--set sweep.points=3 --out a");
  CHECK(other.status == 0);
  CHECK_THAT(other.error, Contains("began another sweep"));
  CHECK(json::parse(content(folder.path / "a/sweep.json"))["outcome"] == "reached the end");
}

TEST_CASE("a journal belongs to the numbers of the files that its scene names", "[sweep][partial]") {
  const Folder folder;
  const auto key_with = [&](const std::string& load) {
    std::ofstream(folder.path / "load.csv") << "time (s),load (N)\n0,1\n1," + load + "\n";
    const auto scene = scene_of(ROSIN_SOURCE_DIR "/examples/coulomb-stick-slip.toml",
                                {"drive.normal_load={ table = '" + (folder.path / "load.csv").string() + "' }"}, "run");
    return verbs::journal_key(scene, 1e-6, "exact");
  };
  const auto key = key_with("2");
  CHECK(key_with("2") == key);
  CHECK(key_with("2.0000000000000004") != key);
}

TEST_CASE("records of a sweep are held to its sizes", "[sweep]") {
  const Folder folder;
  analysis::planes::SweepPoint point;
  point.done = true, point.recurrence = 2, point.why = "a reason";
  point.columns = {{1, 2}, {3, 4}};
  point.end = {5, 6, 7};
  {
    verbs::SweepJournal journal(folder.path / "sweep.partial", "key", 4, 2, {});
    journal.append(true, 3, point);
    journal.append(false, 0, point);
  }
  {
    const verbs::SweepJournal again(folder.path / "sweep.partial", "key", 4, 2, {});
    REQUIRE(again.known_count() == 2);
    const auto known = again.known(true, 3);
    REQUIRE(known);
    CHECK(known->columns == point.columns);
    CHECK(known->end == point.end);
    CHECK(known->recurrence == 2);
    CHECK(known->why == "a reason");
    CHECK(again.known(false, 0));
    CHECK_FALSE(again.known(true, 0));
  }
  // The same key cannot have other sizes, unless a journal is forged.
  const verbs::SweepJournal fewer(folder.path / "sweep.partial", "key", 2, 3, {});
  CHECK(fewer.known_count() == 0);
  CHECK_THAT(fewer.lost(), Contains("damaged after 0 whole records"));
}

TEST_CASE("a plane of one axis is a sweep with the plane's metrics", "[app][sweep]") {
  const Folder folder;
  const std::string plane = " '" ROSIN_SOURCE_DIR "/examples/bristol-board-plane.toml' --no-pictures ";
  auto scene = content(ROSIN_SOURCE_DIR "/examples/bristol-board-plane.toml");
  const auto y = scene.find("y = {");
  scene.erase(y, scene.find('\n', y) - y);
  std::ofstream(folder.path / "line.toml") << scene;
  const std::string points = "--tolerance 1e-6 --set map.x.points=6 --set law.lambda=1 ";
  const auto line = run_rosin(folder, "map line.toml --no-pictures --out line " + points);
  INFO(line.error);
  REQUIRE(line.status == 0);
  const auto sweep = json::parse(content(folder.path / "line/sweep.json"));
  CHECK(sweep["verb"] == "sweep");
  CHECK(fs::exists(folder.path / "line/sweep.csv"));
  CHECK(fs::exists(folder.path / "line/sweep.nc"));
  // A row of a plane, whose cycles are found by another search, which starts beside other points of the plane.
  const auto row = run_rosin(
      folder, "map" + plane + points + "--exact --out row --set map.y.from=1 --set map.y.to=2 --set map.y.points=2");
  INFO(row.error);
  REQUIRE(row.status == 0);
  const auto map = json::parse(content(folder.path / "row/map.json"));
  CHECK(sweep["values"] == map["x"]["values"]);
  CHECK(sweep["regime"]["up"] == map["regime"][0]);
  int cycles = 0;
  for (const std::string metric : {"stick_fraction", "loop_area_normalised"})
    for (int i = 0; i < 6; ++i) {
      const auto &one = sweep["up"][metric][i], &other = map["metrics"][metric][0][i];
      REQUIRE(one.is_null() == other.is_null());
      if (one.is_null()) continue;
      ++cycles;
      const double errors = sweep["error"]["up"][metric][i].get<double>() + map["error"][metric][0][i].get<double>();
      CHECK(std::abs(one.get<double>() - other.get<double>()) <= errors);
    }
  CHECK(cycles > 0);
  for (const std::string wrong : {"--set map.x.extra=[1]", "--shard 1/2"})
    CHECK(run_rosin(folder, "map line.toml --no-pictures " + wrong).status == 2);
  CHECK_THAT(run_rosin(folder, "merge line.toml").error, Contains("has one axis"));
}
