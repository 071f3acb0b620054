/// What a results folder holds after a failure, and what is said of what is thinned, hidden by errors, or not there.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;
namespace fs = std::filesystem;

namespace {

const std::string examples = ROSIN_SOURCE_DIR "/examples/";

void write(const Folder& folder, const char* name, const char* text) { std::ofstream(folder.path / name) << text; }

/// The document of a command that succeeds.
nlohmann::json answer_of(const Folder& folder, const std::string& arguments) {
  const auto printed = run_rosin(folder, arguments + " --json --no-pictures");
  INFO(printed.error);
  REQUIRE(printed.status == 0);
  return nlohmann::json::parse(printed.out);
}

std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) files[entry.path().filename()] = content(entry.path());
  return files;
}

}  // namespace

TEST_CASE("a computation that fails leaves the whole result before it alone", "[app][results]") {
  const Folder folder;
  write(folder, "holds.toml",
        "[law]\ntype = 'ageing'\n[oscillator]\nmass = 0\nstiffness = 1e7\n[drive]\nnormal_load = 1\n"
        "[lab]\nhold_times = [1, 10]\n");
  const std::string lab = "lab slide-hold-slide holds.toml --no-pictures --out out ";
  REQUIRE(run_rosin(folder, lab).status == 0);
  const auto before = files_of(folder.path / "out");
  CHECK(before.contains("lab-peaks.csv"));
  // On a soft machine without mass slip runs away: there are no readings.
  const auto failed = run_rosin(folder, lab + "--set oscillator.stiffness=100 --set lab.slide_time=100");
  CHECK(failed.status == 1);
  CHECK_THAT(failed.error, Contains("is of an earlier computation, and is left alone"));
  CHECK(files_of(folder.path / "out") == before);
  CHECK(run_rosin(folder, "plot out").status == 0);
}

TEST_CASE("a result takes away what only the one before it had", "[app][results]") {
  const Folder folder;
  const std::string run = "run " + examples + "coulomb-stick-slip.toml --no-pictures --out out ";
  REQUIRE(run_rosin(folder, run).status == 0);
  CHECK(fs::exists(folder.path / "out/stick-slip.csv"));
  REQUIRE(run_rosin(folder, run + "--set run.duration=50").status == 0);
  CHECK_FALSE(fs::exists(folder.path / "out/stick-slip.csv"));
  const auto manifest = nlohmann::json::parse(content(folder.path / "out/run.manifest.json"));
  for (const auto& file : manifest["files"]) CHECK(fs::exists(folder.path / "out" / file.get<std::string>()));
  for (const auto& [name, text] : files_of(folder.path / "out")) CHECK_FALSE(name.ends_with(".new"));
}

TEST_CASE("a string says what is thinned, what does not follow, and sounds without its constant part",
          "[app][results][string]") {
  const Folder folder;
  write(folder, "string.toml",
        "[law]\ntype = 'ageing'\n[oscillator]\ntype = 'string'\n[drive]\nspeed = { ramp = { rate = 1.8 } }\n"
        "normal_load = 1.5\n[run]\nduration = 0.25\n");
  const auto told = run_rosin(folder, "run string.toml --no-pictures --out out");
  REQUIRE(told.status == 0);
  CHECK_THAT(told.error, Contains("of 48000 samples, evenly") && Contains("run.samples = 48000 keeps all"));
  const auto document = nlohmann::json::parse(content(folder.path / "out/run.json"));
  CHECK(document["metrics"]["transient_length"].is_null());
  CHECK(document["error"]["transient_length"].is_null());
  CHECK(document["time"].size() < 20'001);
  CHECK(answer_of(folder, "run string.toml --out out --set run.samples=48000")["time"].size() >= 48'000);
  // The bow pulls the bridge to one side all the time; what is heard has no mean.
  const auto sound = content(folder.path / "out/bridge.wav");
  double mean = 0;
  const std::size_t samples = (sound.size() - 44) / 2;
  for (std::size_t i = 0; i < samples; ++i)
    mean += std::int16_t(std::uint8_t(sound[44 + 2 * i]) | (std::uint8_t(sound[45 + 2 * i]) << 8)) / double(samples);
  CHECK(std::abs(mean) < 3000);  // of 32767, where it was half of it
}

TEST_CASE("holds that do not heal say so, and no line goes through their rounding", "[app][results]") {
  const Folder folder;
  write(folder, "slip.toml", "[law]\ntype = 'slip'\n");
  const auto told = run_rosin(folder, "lab slide-hold-slide slip.toml --no-pictures --out out");
  REQUIRE(told.status == 0);
  CHECK_THAT(told.error, Contains("no healing: no peak stands above sliding by more than its error") &&
                             Contains("give [oscillator] mass = 0 and the machine's stiffness"));
  const auto script = content(folder.path / "out/lab.gp");
  CHECK_THAT(script, Contains("β = 0 ± "));
  CHECK(script.find("line fitted") == script.npos);
  CHECK_THAT(script, Contains("set yrange [-1:1]"));
}
