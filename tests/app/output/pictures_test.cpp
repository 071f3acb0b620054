/// What pictures say in words: numbers of the result, the drive, and what the scene is made of.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using nlohmann::json;
using rosin::tests::content;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

namespace {

/// The number behind `symbol = ` in a script.
double number_of(const std::string& script, const std::string& symbol) {
  const auto at = script.find("'" + symbol + " = ");
  REQUIRE(at != std::string::npos);
  return std::stod(script.substr(at + symbol.size() + 4));
}

}  // namespace

TEST_CASE("pictures of velocity steps show a, a - b and the decay length as they are read off", "[pictures]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << "[law]\ntype = \"slip\"\na = 0.012\nb = 0.02\nL = \"4 um\"\n";
  REQUIRE(run_rosin(folder, "lab velocity-step scene.toml --out out --no-pictures").status == 0);
  const auto script = content(folder.path / "out/lab.gp");
  const auto readings = json::parse(content(folder.path / "out/lab.json"))["readings"];
  CHECK(number_of(script, "a") == Approx(readings["direct_effect"]).epsilon(1e-3));
  CHECK(number_of(script, "a") == Approx(0.012).epsilon(1e-3));  // of the law
  CHECK(number_of(script, "a − b") == Approx(-0.008).epsilon(1e-3));
  CHECK(number_of(script, "decay length") ==
        Approx(4).epsilon(0.01));  // µm: the slip law decays by e over L (Ruina 1983)
  CHECK_THAT(script, Contains("law: slip, L\u00A0=\u00A04\u00A0um, a\u00A0=\u00A00.012, b\u00A0=\u00A00.02"));
}

TEST_CASE("pictures of holds show the last peak and the healing rate", "[pictures]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << "[law]\ntype = \"ageing\"\nb = 0.015\n";
  REQUIRE(run_rosin(folder, "lab slide-hold-slide scene.toml --out out --no-pictures").status == 0);
  const auto script = content(folder.path / "out/lab.gp");
  const auto readings = json::parse(content(folder.path / "out/lab.json"))["readings"];
  CHECK(number_of(script, "β") == Approx(0.015).epsilon(0.02));  // b per e-fold of hold time (Dieterich 1979)
  CHECK(number_of(script, "Δμ") == Approx(readings["last_rise"]).epsilon(1e-3));
}

TEST_CASE("a run shows the speed and the load that drive it", "[pictures]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml")
      << "[law]\ntype = \"ageing\"\n[oscillator]\nmass = 0\nstiffness = 1e6\n[drive]\nspeed = 1e-5\n"
         "normal_load = { steps = [[0, 20], [1, 30]] }\n[run]\nduration = 2\nsamples = 40\n";
  REQUIRE(run_rosin(folder, "run scene.toml --out out --no-pictures").status == 0);
  const auto script = content(folder.path / "out/run.gp");
  CHECK_THAT(script, Contains("'drive speed'"));
  CHECK_THAT(script, Contains("'normal load '.'N'.' (N)'"));
  const auto drive = content(folder.path / "out/run-drive.csv");
  CHECK_THAT(drive, Contains("\n0,1e-05,20\n") && Contains("\n2,1e-05,30\n"));
  // A load that never changes has nothing to show.
  REQUIRE(run_rosin(folder, "run scene.toml --set drive.normal_load=20 --out out2 --no-pictures").status == 0);
  CHECK_THAT(content(folder.path / "out2/run.gp"), !Contains("'normal load '.'N'"));
}

TEST_CASE("a plane's caption leaves out what the plane varies, and its marks stand at exceptions alone", "[pictures]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml")
      << "[law]\ntype = \"ageing\"\na = 0.01\nb = 0.02\n[oscillator]\nmass = 1\nstiffness = 1e4\n[drive]\nspeed = "
         "1e-5\n"
         "normal_load = 20\n[map]\nx = { parameter = \"drive.normal_load\", from = 10, to = 40, points = 6 }\n"
         "y = { parameter = \"oscillator.stiffness\", from = 1e4, to = 1e5, points = 6 }\n"
         "metrics = [\"slip_rate_max\"]\n";
  REQUIRE(run_rosin(folder, "map scene.toml --out out --no-pictures").status == 0);
  const auto script = content(folder.path / "out/map.gp");
  CHECK_THAT(script, Contains("mass\u00A0=\u00A01\u00A0kg") && Contains("speed\u00A0=\u00A01e-05\u00A0m/s"));
  CHECK_THAT(script, !Contains("stiffness\u00A0=") && !Contains("load\u00A0="));
  // The threshold parts cycles from steady sliding: no point but exceptions has a mark.
  CHECK_THAT(script, Contains("'threshold of steady sliding'") && !Contains("'cycle'"));
}

TEST_CASE("a width in print that no journal has is refused, and so is one without pictures", "[pictures]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << "[law]\ntype = \"ageing\"\n";
  const auto narrow = run_rosin(folder, "curve scene.toml --width 20");
  CHECK(narrow.status == 2);
  CHECK_THAT(narrow.error, Contains("--width") && Contains("80 … 250 (width of pictures in print, mm)"));
  const auto none = run_rosin(folder, "curve scene.toml --width 85 --no-pictures");
  CHECK(none.status == 2);
  CHECK_THAT(none.error, Contains("--width has no effect beside --no-pictures"));
}
