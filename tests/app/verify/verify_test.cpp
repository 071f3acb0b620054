/// The dossier as its readers use it: agreement, a changed digit, a wrong key; and that what is shipped holds.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/app/command.hpp"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using nlohmann::json;
using rosin::tests::content;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

/// Under 2 N, on a spring of 4 N/m and a mass of 1 kg, Coulomb friction sticks from 0.05 m to 0.25 m and swings about
/// 0.15 m at 2 rad/s: at 0.1 m/s the period is 2 s + π s − atan(2) s.
const std::string scene = R"(
[law]
type = "coulomb"
mu_s = 0.5
mu_d = 0.3
[oscillator]
mass = 1
stiffness = 4
[drive]
speed = 0.1
normal_load = 2
)";

/// A dossier of one case, `cases/block/<name>.toml`.
void write_case(const Folder& folder, const std::string& name, const std::string& verify,
                const std::string& rest = scene) {
  fs::create_directories(folder.path / "cases/block");
  std::ofstream(folder.path / "cases/block" / (name + ".toml")) << "title = \"Block\"\n[verify]\n" << verify << rest;
}

std::string question(const std::string& value, const std::string& more = "accuracy = 1e-9") {
  return "source = \"Den Hartog (1956)\"\norigin = \"closed form\"\n[[verify.questions]]\nwhat = \"period\"\nverb = "
         "\"cycle\"\n"
         "field = \"period\"\nvalue = " +
         value + "\n" + more + "\n";
}

constexpr auto right = "4.0344439358", last_digit_wrong = "4.0344439378";

json verify(const Folder& folder, const std::string& options, int status) {
  const auto answer = run_rosin(folder, "verify --cases cases --json " + options);
  INFO(answer.error);
  REQUIRE(answer.status == status);
  return json::parse(answer.out);
}

}  // namespace

TEST_CASE("a number agrees within the source's accuracy and the stated error, and a changed digit does not",
          "[verify]") {
  const Folder folder;
  write_case(folder, "swing", question(right));
  const auto good = verify(folder, "", 0);
  CHECK(good["passed"] == true);
  REQUIRE(good["cases"].size() == 1);
  const auto& row = good["cases"][0];
  CHECK(row["name"] == "swing");
  CHECK(row["group"] == "block");
  CHECK(row["source"] == "Den Hartog (1956)");
  CHECK(row["origin"] == "closed form");
  CHECK(row["command"] == "rosin cycle cases/block/swing.toml");
  CHECK(row["wanted"] == 4.0344439358);
  CHECK(row["accuracy"] == 1e-9);
  CHECK(std::abs(row["got"].get<double>() - 4.0344439358) < 1e-11);
  CHECK(row["error"].get<double>() < 1e-9);
  CHECK(row["verdict"] == "agrees");
  for (const char* file : {"verify.json", "result.json", "verify.md", "verify-block.svg", "swing/1/cycle.json"})
    CHECK(fs::exists(folder.path / "out/verify" / file));
  CHECK_THAT(content(folder.path / "out/verify/verify.md"),
             Contains("verify-block.svg") && Contains("*closed form:* Den Hartog (1956)."));

  write_case(folder, "swing", question(last_digit_wrong));
  const auto wrong = verify(folder, "", 1);
  CHECK(wrong["passed"] == false);
  CHECK(wrong["cases"][0]["verdict"] == "disagrees");
  const auto table = run_rosin(folder, "verify --cases cases");
  CHECK(table.status == 1);
  CHECK_THAT(table.out, Contains("disagrees") && Contains("rosin cycle cases/block/swing.toml"));

  // what rosin knows to rounding only cannot confirm eighteen digits
  write_case(folder, "swing", question("4.034443935795703", "accuracy = 1e-18"));
  CHECK(verify(folder, "", 1)["cases"][0]["verdict"] == "undecided");
}

TEST_CASE("lists, texts, truth values, units of the source and settings are asked for together", "[verify]") {
  const Folder folder;
  write_case(folder, "swing", question("4034.4439358", "accuracy = 1e-6\nunit = \"ms\"") + R"([[verify.questions]]
what = "no higher static friction"
verb = "cycle"
set = ["law.mu_s=0.3", "oscillator.damping=1"]
field = "outcome"
value = "none exists"
[[verify.questions]]
what = "neither grows nor decays"
verb = "stability"
field = "marginal"
value = true
[[verify.questions]]
what = "events"
verb = "run"
field = "events[kind=slip].time"
value = [2.5]
accuracy = { relative = 1e-9 }
unit = "s"
)",
             scene + "[run]\nduration = 3\nstart = { displacement = 0, slip_rate = 0 }\n");
  const auto document = verify(folder, "--threads 2", 0);
  REQUIRE(document["cases"].size() == 4);
  CHECK(document["cases"][0]["name"] == "swing.1");
  CHECK(document["cases"][0]["unit"] == "s");
  CHECK(document["cases"][0]["wanted"].get<double>() == Approx(4.0344439358).epsilon(1e-15));
  CHECK(document["cases"][1]["command"] ==
        "rosin cycle cases/block/swing.toml --set law.mu_s=0.3 --set oscillator.damping=1");
  CHECK(document["cases"][3]["got"].size() == 1);
}

TEST_CASE("what is known to differ stays in the dossier with its reason, and no longer", "[verify]") {
  const Folder folder;
  write_case(folder, "swing", question("4.3", "accuracy = 1e-3\ndiffers = \"misprint\"\ninstead = 4.0344"));
  const auto differs = verify(folder, "", 0)["cases"][0];
  CHECK(differs["verdict"] == "differs, as known");
  CHECK(differs["reason"] == "misprint");
  // a difference that is not the known one is no excuse
  write_case(folder, "swing", question("4.3", "accuracy = 1e-3\ndiffers = \"misprint\"\ninstead = 4.1"));
  CHECK(verify(folder, "", 1)["cases"][0]["verdict"] == "disagrees");
  write_case(folder, "swing", question(right, "accuracy = 1e-9\ndiffers = \"misprint\"\ninstead = 4.3"));
  CHECK(verify(folder, "", 1)["cases"][0]["verdict"] == "no longer differs");
  write_case(folder, "swing",
             "source = \"a figure\"\norigin = \"printed\"\nnot_reproduced = \"two masses\"\n[[verify.questions]]\nwhat "
             "= \"period\"\n"
             "value = 12\naccuracy = 1\nunit = \"s\"\n",
             "");
  const auto missing = verify(folder, "", 0)["cases"][0];
  CHECK(missing["verdict"] == "not reproduced");
  CHECK(missing["got"].is_null());
  // and where no number comes out, that is no agreement
  write_case(
      folder, "swing", question(right) + "[cycle]\nstart = { displacement = 0.15 }\n",
      "[law]\ntype = \"coulomb\"\nmu_s = 0.3\nmu_d = 0.3\n[oscillator]\nmass = 1\nstiffness = 4\n[drive]\nspeed = "
      "0.1\nnormal_load = 2\n");
  const auto failed = verify(folder, "", 1)["cases"][0];
  CHECK(failed["verdict"] == "failed");
}

TEST_CASE("a case that cannot be asked is refused with file and line before anything runs", "[verify]") {
  const Folder folder;
  const auto refused = [&](const std::string& verify, const std::string& rest, const std::string& told) {
    write_case(folder, "swing", verify, rest);
    const auto answer = run_rosin(folder, "verify --cases cases");
    INFO(verify << rest);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(told));
    CHECK_FALSE(fs::exists(folder.path / "out/verify/verify.json"));
  };
  refused("sourse = \"x\"\n" + question(right), scene, "swing.toml:3:1: unknown key 'sourse'");
  refused(question(right, "acuracy = 1"), scene, "swing.toml:10:1: unknown key 'acuracy'");
  refused(question(right, ""), scene, "no 'accuracy'");
  refused(question(right, "accuracy = -1"), scene, "swing.toml:10:12: verify.questions.accuracy = -1 is outside");
  refused(question(right, "accuracy = [1, 2]"), scene, "2 entries, but there are 1 values");
  refused(question(right, "accuracy = 1\nunit = \"bananas\""), scene, "swing.toml:11:8: verify.questions.unit");
  refused(question("\"stable\"", "accuracy = 1"), scene, "swing.toml:10:12: verify.questions.accuracy has no effect");
  refused(question(right, "accuracy = 1\ndiffers = \"x\""), scene, "no 'instead'");
  refused(question(right, "accuracy = 1\ninstead = 3"), scene, "goes with 'differs'");
  refused(question(right, "accuracy = 1\nset = [\"drive.sped=1\"]"), scene, "swing.toml:5:");
  refused(question(right, "accuracy = 1\nset = [\"drive.sped=1\"]"), scene, "did you mean 'speed'?");
  refused(question(right), scene + "dampin = 1\n", "swing.toml:22:1: unknown key 'dampin'");
  refused(question(right), scene + "[lab]\nfoo = 1\n", "swing.toml:22:2: [lab] has no effect");
  refused("source = \" \"\n", scene, "verify.source is empty");
  const auto of_verb = [&](const std::string& verb) {
    auto text = question(right);
    return text.replace(text.find("\"cycle\""), 7, "\"" + verb + "\"");
  };
  refused(of_verb("cicle"), scene, "swing.toml:7:8: unknown command 'cicle'; did you mean 'cycle'?");
  refused(of_verb("laws"), scene, "swing.toml:7:8: 'laws' takes no scene");
  refused(of_verb("lab velocity-stepp"), scene, "swing.toml:7:8: unknown experiment 'velocity-stepp'");
  write_case(folder, "swing", question(right));
  const auto unknown = run_rosin(folder, "verify --cases cases swimg");
  CHECK(unknown.status == 2);
  CHECK_THAT(unknown.error, Contains("did you mean 'swing'?"));
  write_case(folder, "swing", "slow = true\n" + question(right));
  CHECK_THAT(run_rosin(folder, "verify --cases cases --quick").error, Contains("leaves no case"));
}

TEST_CASE("work on the dossier ends in order when its time has passed", "[verify]") {
  const Folder folder;
  write_case(folder, "long", question(right) + "set = [\"drive.speed=1e-5\"]\n");
  write_case(folder, "longer",
             "source = \"none\"\norigin = \"printed\"\n[[verify.questions]]\nwhat = \"end\"\nverb = \"run\"\nfield = "
             "\"time[-1]\"\nvalue = 1\n"
             "accuracy = 1\n",
             "[law]\ntype = \"ageing\"\n[oscillator]\nmass = 1\nstiffness = 1e6\n[drive]\nspeed = 0.1\nnormal_load = "
             "2\n[run]\nduration = 1e7\nstart = \"rest\"\n[solver]\ntype = \"collocation\"\n");
  const auto answer = run_rosin(folder, "verify --cases cases --time-limit 0.5");
  CHECK(answer.status == 1);
  CHECK_THAT(answer.error, Contains("of 2 commands have answered"));
  const auto kept = json::parse(content(folder.path / "out/verify/verify.json"));
  CHECK(kept["passed"] == false);
  CHECK(kept["cases"][1]["verdict"] == "not answered");
}

TEST_CASE("the quick dossier holds, is as large as it claims, and its page lists every case", "[verify][long]") {
  const Folder folder;
  const auto answer = run_rosin(folder, "verify --quick --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto document = json::parse(answer.out);
  CHECK(document["passed"] == true);
  const auto page = content(ROSIN_SOURCE_DIR "/docs/verification/verify.md");
  std::set<std::string> sources;
  std::size_t cases = 0;
  for (const auto& entry : fs::recursive_directory_iterator(ROSIN_SOURCE_DIR "/cases")) {
    if (entry.path().extension() != ".toml") continue;
    ++cases;
    INFO(entry.path().string());
    CHECK_THAT(page, Contains("- **[" + entry.path().stem().string() + "]("));
  }
  for (const auto& row : document["cases"]) {
    const auto source = row["source"].get<std::string>();
    sources.insert(source.substr(0, source.find(')')));  // author and year
    const auto wanted = "| " + row["name"].get<std::string>() + " | ";
    CHECK_THAT(page, Contains(wanted));
    CHECK_FALSE(source.empty());
    if (row["wanted"].is_number()) CHECK(row["accuracy"].get<double>() > 0);
  }
  CHECK(cases >= 40);
  CHECK(sources.size() >= 12);
}
