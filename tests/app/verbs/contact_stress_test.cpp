/// A few random blocks and pins: counts that add up, scenes that anybody can ask again, and no fault.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using namespace rosin::tests;
using nlohmann::json;

TEST_CASE("random blocks and pins are sound, refused or say why they end") {
  const Folder folder;
  const auto answer = run_rosin(folder, "stress contacts --seed 5 --scenes 12 --quiet --json --out s");
  CHECK(answer.status == 0);
  const auto report = json::parse(answer.out);
  CHECK(report == json::parse(content(folder.path / "s/result.json")));
  CHECK(report["passed"] == true);
  long scenes = 0;
  for (const char* kind : {"blocks", "pins"}) {
    const auto& counts = report[kind];
    long verdicts = 0, reasons = 0;
    for (const char* verdict : {"sound", "less_exact", "refused", "failed", "wrong", "not_finite", "crashed"})
      verdicts += counts[verdict].get<long>();
    for (const auto& reason : counts["reasons"]) reasons += reason["count"].get<long>();
    CHECK(verdicts == counts["scenes"]);
    CHECK(reasons == verdicts - counts["sound"].get<long>());
    CHECK(counts["wrong"] == 0);
    CHECK(counts["not_finite"] == 0);
    CHECK(counts["crashed"] == 0);
    // Who pulls does so below 0, and only who pulls.
    CHECK((counts["adhesion"].get<long>() > 0) == (counts["lowest_pressure"].get<double>() < 0));
    scenes += counts["scenes"].get<long>();
  }
  CHECK(scenes == 12);
  CHECK(report["blocks"]["scenes"].get<long>() > 1);
  CHECK(report["pins"]["scenes"].get<long>() > 1);
}

TEST_CASE("a random contact is a scene that depends on its seed and number alone") {
  const Folder folder;
  CHECK(run_rosin(folder, "stress contacts --seed 5 --scenes 4 --draw --quiet --out a").status == 0);
  CHECK(run_rosin(folder, "stress contacts --seed 5 --only 3 --draw --quiet --out b").status == 0);
  const auto scene = content(folder.path / "a/scene-3.toml");
  CHECK(scene == content(folder.path / "b/scene-3.toml"));
  CHECK(scene != content(folder.path / "a/scene-2.toml"));
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "a"))
    if (entry.path().extension() == ".toml")
      read += run_rosin(folder, "stability '" + entry.path().string() + "' --no-pictures --quiet --out o").status == 0;
  CHECK(read >= 2);
}
