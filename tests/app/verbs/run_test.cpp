/// The verb run: the catalogue of slip events beside its record.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace {

const std::string command = "run " ROSIN_SOURCE_DIR "/examples/coulomb-stick-slip.toml --no-pictures --out out ";

}  // namespace

TEST_CASE("a run lists its slip events in a file, in its document and in its summary", "[app][slip-events]") {
  const Folder folder;
  const auto told = run_rosin(folder, command);
  REQUIRE(told.status == 0);
  CHECK_THAT(told.out, Contains("3 slip events, on average") && Contains("recurrence             39.806257042"));
  const auto file = content(folder.path / "out/stick-slip.csv");
  CHECK_THAT(file, Catch::Matchers::StartsWith("onset (s),duration (s),force_drop (N),friction_drop,slip (m),"
                                               "peak_slip_rate (m/s),recurrence (s)\n73.394495412"));
  CHECK(std::count(file.begin(), file.end(), '\n') == 4);
  const auto document = nlohmann::json::parse(content(folder.path / "out/run.json"));
  CHECK(document["stick_slip"]["force_drop"].size() == 3);
  CHECK(document["stick_slip"]["recurrence"][0].is_null());
  CHECK(document["stick_slip"]["error"]["recurrence"] < 1e-12);
  const auto manifest = nlohmann::json::parse(content(folder.path / "out/run.manifest.json"));
  const auto& files = manifest["files"];
  CHECK(std::find(files.begin(), files.end(), "stick-slip.csv") != files.end());
}

TEST_CASE("a run with one slip event or none has no catalogue, and few samples change nothing in one",
          "[app][slip-events]") {
  const Folder folder;
  REQUIRE(run_rosin(folder, command + "--set run.duration=80").status == 0);
  CHECK_FALSE(std::filesystem::exists(folder.path / "out/stick-slip.csv"));
  CHECK_FALSE(nlohmann::json::parse(content(folder.path / "out/run.json")).contains("stick_slip"));
  const auto many = nlohmann::json::parse(run_rosin(folder, command + "--json").out),
             few = nlohmann::json::parse(run_rosin(folder, command + "--json --set run.samples=2").out);
  for (const char* name : {"onset", "duration", "peak_slip_rate", "force_drop"})
    CHECK(few["stick_slip"][name] == many["stick_slip"][name]);
  for (const auto& [name, value] : many["metrics"].items()) {
    CAPTURE(name);
    const double error = many["error"].value(name, 0.0);
    CHECK(std::abs(few["metrics"][name].get<double>() - value.get<double>()) <= 2 * error);
  }
  for (const auto& event : few["events"]) CHECK(event["error"].get<double>() < 1e-10);
}
