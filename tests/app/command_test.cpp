/// The command as a user runs it: exit statuses, clean JSON, the same files for any number of threads and after a kill.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <thread>

#include "tests/app/folder.hpp"

extern char** environ;

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using nlohmann::json;
using rosin::tests::content;
using rosin::tests::Folder;
using Arguments = std::vector<std::string>;

pid_t start(const fs::path& folder, Arguments arguments) {
  arguments.insert(arguments.begin(), ROSIN_COMMAND);
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 1, "stdout.txt", flags, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, "stderr.txt", flags, 0600);
  pid_t child = 0;
  REQUIRE(posix_spawn(&child, ROSIN_COMMAND, &actions, nullptr, argv.data(), environ) == 0);
  posix_spawn_file_actions_destroy(&actions);
  return child;
}

/// Exit status, or minus the signal that ended the process.
int wait(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// True once the process has ended; its status can still be waited for.
bool ended(pid_t child) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

struct Answer {
  int status;
  std::string out, error;
};
Answer run_rosin(const Folder& folder, const Arguments& arguments) {
  const int status = wait(start(folder.path, arguments));
  return {status, content(folder.path / "stdout.txt"), content(folder.path / "stderr.txt")};
}

/// A line of the shell in which $ROSIN is the command: for streams that are closed or full. \returns its exit status.
int shell(const Folder& folder, const std::string& line) {
  const auto text = "cd '" + folder.path.string() + "' && ROSIN='" ROSIN_COMMAND "' && " + line;
  const int status = std::system(text.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

std::string example(const std::string& name) { return ROSIN_SOURCE_DIR "/examples/" + name + ".toml"; }

/// The plane of the examples with few points, and few seconds.
Arguments small_map(const std::string& out, const std::string& threads) {
  return {"map",
          example("bristol-board-plane"),
          "--quiet",
          "--out",
          out,
          "--threads",
          threads,
          "--set",
          "map.x.points=8",
          "--set",
          "map.y.points=6",
          "--tolerance=1e-5"};
}

/// result.json without the one number that depends on the clock.
json timeless(const fs::path& path) {
  auto document = json::parse(content(path));
  document["cost"].erase("seconds");
  return document;
}

}  // namespace

TEST_CASE("the command answers for itself") {
  const Folder folder;
  CHECK(run_rosin(folder, {"--version"}).out.starts_with("rosin 0."));
  CHECK(run_rosin(folder, {"--help"}).status == 0);
  CHECK(run_rosin(folder, {"map", "--help"}).status == 0);
}

TEST_CASE("wrong usage ends with status 2 and says what to try") {
  const Folder folder;
  const auto scene = example("bristol-board-cycle");
  const std::vector<std::pair<Arguments, std::string>> cases = {
      {{}, "See 'rosin --help'"},
      {{"cycel", scene}, "unknown command 'cycel'; did you mean 'cycle'?"},
      {{"cycle", scene, "--tolerence", "1e-6"}, "did you mean '--tolerance'?"},
      {{"cycle", scene, "other.toml"}, "'other.toml' is too much"},
      {{"cycle"}, "SCENE is required"},
      {{"cycle", scene, "--tolerance", "3"}, "--tolerance = 3 is outside"},
      {{"cycle", scene, "--tolerance", "nan"}, "--tolerance"},
      {{"cycle", scene, "--threads", "0"}, "--threads = 0 is outside"},
      {{"cycle", "none.toml"}, "none.toml: no such file"},
      {{"cycle", scene, "--set", "law.a=3"}, "--set law.a=3: law.a = 3 is outside 0.0001 … 0.5"},
      {{"map", scene}, "the scene has no [map]"},
      {{"cycle", scene, "--out", "/proc/none"}, "--out /proc/none: cannot be made"},
      {{"laws", "coulom"}, "did you mean 'coulomb'?"},
      {{"plot", scene}, "holds no results"},
  };
  for (const auto& [arguments, message] : cases) {
    const auto answer = run_rosin(folder, arguments);
    CAPTURE(message);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Catch::Contains(message));
    CHECK(answer.out.empty());
  }
}

TEST_CASE("with --json one document is printed, the same as result.json, and nothing else") {
  const Folder folder;
  struct Case {
    Arguments arguments;
    std::vector<std::string> fields;
  };
  const auto board = example("bristol-board-cycle");
  const std::vector<Case> cases = {
      {{"curve", board}, {"slip_rate", "friction_coefficient", "extrema"}},
      {{"stability", board, "--explain"}, {"steady", "eigenvalues", "stable", "hopf"}},
      {{"run", board, "--set", "run.duration=20", "--set", "run.samples=10"},
       {"time", "columns", "events", "outcome", "metrics"}},
      {{"cycle", board, "--tolerance", "1e-6"},
       {"period", "slip_rate_max", "slip_rate_min", "stick_fraction", "loop_area", "loop_area_normalised",
        "multipliers", "error"}},
  };
  for (auto [arguments, fields] : cases) {
    CAPTURE(arguments.front());
    arguments.insert(arguments.end(), {"--json", "--out", "results"});
    const auto answer = run_rosin(folder, arguments);
    CHECK(answer.status == 0);
    CHECK(answer.out == content(folder.path / "results/result.json"));
    const auto document = json::parse(answer.out);
    for (const auto& field : fields) CHECK(document.contains(field));
    CHECK(fs::exists(folder.path / "results/manifest.json"));
  }
  const auto laws = json::parse(run_rosin(folder, {"laws", "--json"}).out);
  CHECK(laws.size() >= 10);
  for (const auto& law : laws)
    for (const char* field : {"name", "kind", "title", "formula", "source", "parameters", "states", "presets"})
      CHECK(law.contains(field));
  const auto normal = json::parse(run_rosin(folder, {"laws", "power", "--json"}).out);
  REQUIRE(normal.size() == 1);
  CHECK(normal[0]["kind"] == "normal");
  // Keys are those that a scene takes: none is unknown, and the required one alone suffices.
  for (const auto& parameter : normal[0]["parameters"]) {
    const auto key = parameter["name"].get<std::string>();
    const auto answer = run_rosin(folder, {"stability", example("drop-on-rough-surface"), "--out", "n", "--set",
                                           "oscillator.contacts.1.normal_contact." + key + "=-7"});
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, !Catch::Contains("is not a key") && !Catch::Contains("unknown"));
    CHECK_THAT(answer.error, Catch::Contains(key));
  }
}

TEST_CASE("a cycle that does not exist ends with status 1 and keeps its result") {
  const Folder folder;
  const auto answer =
      run_rosin(folder, {"cycle", example("bristol-board-cycle"), "--out", "r", "--set", "drive.normal_load=1e-6"});
  CHECK(answer.status == 1);
  CHECK_THAT(answer.error, Catch::Contains("none exists"));
  const auto document = json::parse(content(folder.path / "r/result.json"));
  CHECK(document["outcome"] == "none exists");
  CHECK(document["period"].is_null());
}

TEST_CASE("results go to out/ and the name of the scene, with pictures and without leftovers") {
  const Folder folder;
  REQUIRE(run_rosin(folder, {"curve", example("bristol-board-cycle")}).status == 0);
  const auto results = folder.path / "out/bristol-board-cycle";
  for (const char* name : {"result.json", "manifest.json", "curve.csv", "curve.gp"}) CHECK(fs::exists(results / name));
  for (const auto& entry : fs::directory_iterator(results))
    CHECK_FALSE(entry.path().filename().string().starts_with('.'));
  CHECK(content(results / "curve.csv").starts_with("slip_rate (m/s),friction_coefficient\n"));
  CHECK(run_rosin(folder, {"plot", results.string()}).status == 0);
  CHECK(fs::exists(results / "curve.svg"));
  CHECK(fs::exists(results / "curve.png"));
  CHECK(run_rosin(folder, {"plot", example("bristol-board-cycle")}).status == 0);
}

TEST_CASE("a map does not depend on threads, nor on being killed and taken up again") {
  const Folder folder;
  REQUIRE(run_rosin(folder, small_map("one", "1")).status == 0);
  REQUIRE(run_rosin(folder, small_map("three", "3")).status == 0);
  CHECK(content(folder.path / "one/map.nc") == content(folder.path / "three/map.nc"));
  CHECK(timeless(folder.path / "one/result.json") == timeless(folder.path / "three/result.json"));
  const auto document = timeless(folder.path / "one/result.json");
  CHECK(document["regime"].size() == 6);
  CHECK(document["regime"][0].size() == 8);
  CHECK_FALSE(fs::exists(folder.path / "one/map.partial"));

  const auto journal = folder.path / "killed/map.partial";
  const auto size = [&] { return fs::exists(journal) ? fs::file_size(journal) : 0; };
  const pid_t child = start(folder.path, small_map("killed", "1"));
  constexpr std::uintmax_t some_records = 2000;  // bytes beyond the header
  std::uintmax_t header = 0;
  while (!ended(child) && (header == 0 || size() < header + some_records)) {
    if (header == 0) header = size();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGKILL);
  wait(child);
  const bool killed_in_time = fs::exists(journal);
  CHECK(killed_in_time == !fs::exists(folder.path / "killed/result.json"));
  if (killed_in_time) std::ofstream(journal, std::ios::app | std::ios::binary) << "torn record";
  REQUIRE(run_rosin(folder, small_map("killed", "2")).status == 0);
  CHECK(content(folder.path / "killed/map.nc") == content(folder.path / "one/map.nc"));
  CHECK(timeless(folder.path / "killed/result.json") == timeless(folder.path / "one/result.json"));
}

TEST_CASE("a fine plane is drawn as an image, a coarse one as boxes, and what lies outside the scales always so") {
  const Folder folder;
  // The load falls along its axis: pictures have the least at the left all the same.
  const auto plane = [&](const std::string& out, const std::string& points) {
    REQUIRE(run_rosin(folder, {"map", example("bristol-board-plane"), "--quiet", "--out", out, "--tolerance=1e-3",
                               "--set", "map.metrics=['loop_area']", "--set",
                               "map.x={parameter='drive.normal_load',from=9.81,to=9.81e-8,points=" + points +
                                   ",scale='log',extra=[1e-9]}",
                               "--set", "map.y.points=2", "--set", "map.y.extra=[]"})
                .status == 0);
    return json::parse(content(folder.path / out / "result.json"))["metrics"]["loop_area"];
  };
  const auto lines = [&](const fs::path& path) {
    const auto text = content(folder.path / path);
    return std::ranges::count(text, '\n');
  };
  plane("coarse", "40");
  CHECK(lines("coarse/map-cells.csv") == 1 + 2 * 41);
  CHECK_FALSE(fs::exists(folder.path / "coarse/map-grid.bin"));

  const auto loop_area = plane("fine", "161");
  CHECK(lines("fine/map-cells.csv") == 1 + 2);
  CHECK(lines("fine/map-marks.csv") <= 1 + 2 * 24);
  const auto grid = content(folder.path / "fine/map-grid.bin");
  REQUIRE(grid.size() == 2 * 161 * sizeof(double));
  std::vector<double> values(2 * 161);
  std::memcpy(values.data(), grid.data(), grid.size());
  for (const std::size_t row : {0, 1})
    for (const std::size_t i : {0, 80, 160}) {
      const auto& expected = loop_area[row][160 - i];
      INFO(row << ' ' << i);
      if (expected.is_null())
        CHECK(std::isnan(values[row * 161 + i]));
      else
        CHECK(values[row * 161 + i] == expected.get<double>());
    }
  CHECK(fs::file_size(folder.path / "fine/map.svg") < 300'000);
}

TEST_CASE("an interrupted map ends in order with status 130 and says how to go on") {
  const Folder folder;
  auto arguments = small_map("stopped", "1");
  arguments.insert(arguments.end(), {"--set", "map.x.points=200", "--set", "map.y.points=200"});
  const pid_t child = start(folder.path, arguments);
  while (!ended(child) && !fs::exists(folder.path / "stopped/map.partial"))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(child, SIGINT);
  CHECK(wait(child) == 130);
  CHECK_THAT(content(folder.path / "stderr.txt"), Catch::Contains("the same command goes on from there"));
  CHECK(fs::exists(folder.path / "stopped/map.partial"));
  CHECK_FALSE(fs::exists(folder.path / "stopped/result.json"));
}

TEST_CASE("a comparison and a design answer in JSON with the fields that callers rely on", "[app]") {
  const Folder folder;
  const auto cycle = run_rosin(folder, {"compare", example("ageing-or-slip"), "--json", "--out", "a"});
  REQUIRE(cycle.status == 0);
  const auto document = json::parse(cycle.out);
  CHECK(document["members"].size() == 2);
  const auto& stick = document["differences"]["stick_fraction"];
  CHECK(stick["differences"][0] == 0);
  CHECK(std::abs(stick["differences"][1].get<double>() -
                 (stick["values"][1].get<double>() - stick["values"][0].get<double>())) < 1e-15);
  CHECK(stick["difference_errors"][1].get<double>() < 1e-7);
  const auto design = run_rosin(folder, {"compare", example("ageing-or-slip"), "--design", "--set", "map.x.points=4",
                                         "--set", "map.y.points=3", "--json", "--out", "b"});
  REQUIRE(design.status == 0);
  const auto plane = json::parse(design.out);
  REQUIRE(plane["discriminability"].size() == 3);
  REQUIRE(plane["discriminability"][0].size() == 4);
  double most = 0;
  for (const auto& row : plane["discriminability"])
    for (const auto& value : row) most = std::max(most, value.get<double>());
  CHECK(plane["best"]["discriminability"].get<double>() == most);
  CHECK(plane["best"]["repeats"].get<double>() >= 1);
  CHECK(fs::exists(folder.path / "b" / "design.svg"));
  // One member: nothing to compare.
  CHECK(run_rosin(folder, {"compare", example("bristol-board-cycle"), "--out", "c"}).status == 2);
}

TEST_CASE("members that stick and members that creep are compared by one definition, and it is said", "[app]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << R"toml([law]
type = "ageing"
[oscillator]
mass = 1
stiffness = 1500
[drive]
speed = 1e-2
normal_load = 100
[map]
x = { parameter = "drive.normal_load", from = 100, to = 200, points = 2 }
y = { parameter = "drive.speed", from = 1e-2, to = 2e-2, points = 2 }
[compare]
members = [ { name = "creeps" }, { name = "sticks", law = { type = "coulomb" } } ]
noise = { stick_fraction = { absolute = 0.01 } }
)toml";
  const auto answer = run_rosin(folder, {"compare", "scene.toml", "--design", "--json", "--tolerance", "1e-4"});
  REQUIRE(answer.status == 0);
  const auto document = json::parse(answer.out);
  CHECK(document["by_metric"].contains("slow_fraction"));
  CHECK_FALSE(document["by_metric"].contains("stick_fraction"));
  CHECK(document["notes"].dump().find("slow_fraction") != std::string::npos);
}

TEST_CASE("a member under a law from text has the numbers of the compiled law that it spells") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << R"toml([law]
type = "ageing"
[oscillator]
mass = 1
stiffness = 1500
[drive]
speed = 1e-5
normal_load = 5
[compare]
protocol = "cycle"
[[compare.members]]
name = "compiled"
[[compare.members]]
name = "text"
[compare.members.law]
type = "formula"
[compare.members.law.formula]
friction = "a*asinh_exp(v/(2*v0), (mu0 + b*ln(v0*theta/L))/a)"
slip_rate = "2*v0*sinh_exp(mu/a, (mu0 + b*ln(v0*theta/L))/a)"
[compare.members.law.formula.parameters]
mu0 = { default = 0.6 }
a = { default = 0.010 }
b = { default = 0.015 }
L = { default = "10 um", unit = "m" }
v0 = { default = "1 um/s", unit = "m/s" }
[compare.members.law.formula.states]
theta = { unit = "s", scale = "log" }
[compare.members.law.formula.rate]
theta = "1 - abs(v)*theta/L"
[compare.members.law.formula.steady]
theta = "L/abs(v)"
)toml";
  const auto answer = run_rosin(folder, {"compare", "scene.toml", "--json", "--out", "a"});
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  const auto differences = json::parse(answer.out)["differences"];
  CHECK(differences.size() > 5);
  for (const auto& [metric, row] : differences.items()) {
    INFO(metric << ": " << row.dump());
    const double compiled = row["values"][0], text = row["values"][1];
    const double apart =
        metric.find("_phase_") == metric.npos ? text - compiled : std::remainder(text - compiled, 2 * std::numbers::pi);
    CHECK(std::abs(apart) <= double(row["errors"][0]) + double(row["errors"][1]));
  }
  for (const auto* metric : {"period", "slip_rate_max", "friction_max", "stick_fraction", "loop_area"}) {
    const auto& row = differences[metric];
    CHECK(std::abs(double(row["values"][1]) - double(row["values"][0])) <= 1e-7 * std::abs(double(row["values"][0])));
  }
}

TEST_CASE("the laboratory answers with a record, readings and a picture, and the same noise for the same seed",
          "[lab]") {
  const Folder folder;
  const auto step = [&](Arguments more) {
    Arguments arguments = {"lab", "velocity-step", example("lab-velocity-step"), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto answer = run_rosin(folder, arguments);
    INFO(answer.error);
    REQUIRE(answer.status == 0);
    return json::parse(answer.out);
  };
  const auto exact = step({"--out", "exact"});
  CHECK(exact["experiment"] == "velocity-step");
  CHECK(std::abs(exact["readings"]["direct_effect"].get<double>() - 0.01) < 1e-8);
  CHECK(exact["time"].size() == exact["columns"]["friction_coefficient"].size());
  CHECK(exact["tables"]["steps"]["to"].size() == 2);
  for (const char* file : {"lab.csv", "lab-steps.csv", "lab.gp", "result.json", "manifest.json"})
    CHECK(fs::exists(folder.path / "exact" / file));
  CHECK(json::parse(content(folder.path / "exact/result.json")) == exact);

  const std::string noise = "lab.sensor.noise.friction_coefficient=1e-4";
  const auto noisy = step({"--set", noise}), again = step({"--set", noise});
  CHECK(noisy["columns"] == again["columns"]);
  CHECK(noisy["columns"] != exact["columns"]);
  CHECK(step({"--set", noise, "--set", "lab.sensor.seed=2"})["columns"] != noisy["columns"]);
  CHECK(noisy["error"]["direct_effect"].get<double>() > 1e-6);
  const auto held = step({"--set", "lab.sensor.range.friction_coefficient=0.6"});
  REQUIRE(held["warnings"].size() == 1);
  CHECK(held["warnings"][0].get<std::string>().find("saturates") != std::string::npos);
}

TEST_CASE("every example of the laboratory runs; wrong ones are refused with status 2 and what to try", "[lab]") {
  const Folder folder;
  for (const std::string name : {"inclined-plane", "impulse", "velocity-step", "slide-hold-slide", "spring-pulled",
                                 "reciprocation", "ring-down", "frequency-response", "inverse"}) {
    const auto answer = run_rosin(folder, {"lab", name, example("lab-" + name)});
    INFO(name << ": " << answer.error);
    CHECK(answer.status == 0);
    CHECK(fs::exists(folder.path / "out" / ("lab-" + name) / "lab.csv"));
  }
  const auto refused = [&](Arguments arguments) {
    const auto answer = run_rosin(folder, arguments);
    CHECK(answer.status == 2);
    return answer.error;
  };
  const auto plane = example("lab-inclined-plane");
  CHECK_THAT(refused({"lab", "inclined", plane}), Contains("did you mean 'inclined-plane'?") || Contains("known:"));
  CHECK_THAT(refused({"lab", "inclined-plane"}), Contains("SCENE"));
  CHECK_THAT(refused({"lab", "inclined-plane", plane, "--set", "lab.angel_rate=1"}),
             Contains("did you mean 'angle_rate'?"));
  CHECK_THAT(refused({"lab", "inclined-plane", plane, "--set", "lab.angle_rate=-1"}), Contains("is outside"));
  CHECK_THAT(refused({"lab", "inclined-plane", plane, "--set", "lab.travel='5 N'"}), Contains("lab.travel"));
  CHECK_THAT(refused({"lab", "inclined-plane", plane, "--set", "lab.samples=2.5"}), Contains("a whole number"));
  CHECK_THAT(refused({"lab", "inclined-plane", plane, "--set", "lab.sensor.noise.slop=1"}),
             Contains("did you mean 'slope'?"));
  CHECK_THAT(refused({"lab", "inverse", example("lab-inverse"), "--set", "lab.record=none.csv"}),
             Contains("no such file"));
  std::ofstream(folder.path / "short.csv") << "0,1\n1,2\n";
  CHECK_THAT(refused({"lab", "inverse", example("lab-inverse"), "--set",
                      "lab.record=" + (folder.path / "short.csv").string()}),
             Contains("64 or more"));
}

TEST_CASE("a run that ends before its first sample is a result without samples", "[app]") {
  const Folder folder;
  std::ofstream(folder.path / "stiff.toml") << "[law]\ntype = 'ageing'\n[oscillator]\nmass = 0\nstiffness = inf\n"
                                               "damping = 1\n[drive]\nspeed = { steps = [[0, 1e-6], [20, 1e-5]] }\n"
                                               "normal_load = 5\n[run]\nduration = 100\n";
  const auto answer = run_rosin(folder, {"run", "stiff.toml", "--json"});
  CHECK(answer.status == 1);
  CHECK_THAT(answer.error, Contains("stiff.toml: not finite"));
  const auto document = json::parse(answer.out);
  CHECK(document["time"].empty());
  CHECK(document["outcome"] == "not finite");
}

TEST_CASE("what lies too deep is refused before anything walks down there", "[app]") {
  const Folder folder;
  constexpr int deep = 100'000;
  const auto repeated = [](const std::string& text) {
    std::string all;
    for (int i = 0; i < deep; ++i) all += text;
    return all;
  };
  for (const auto& text :
       {"a = " + repeated("[") + repeated("]"), repeated("a.") + "b = 1", "[" + repeated("a.") + "b]",
        "a = " + repeated("{a=") + "1" + repeated("}"), "\n\na = " + repeated("[")}) {
    std::ofstream(folder.path / "deep.toml") << text;
    const auto answer = run_rosin(folder, {"curve", "deep.toml"});
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(text[0] == '\n' ? "deep.toml:3: tables" : "deep.toml:1: tables"));
  }
  const auto answer =
      run_rosin(folder, {"curve", example("load-step"), "--set", repeated("a.").substr(0, 100'000) + "b=1"});
  CHECK(answer.status == 2);
  CHECK(answer.error.size() < 500);
  CHECK_THAT(answer.error, Contains("100 levels deep"));
  // Dots and brackets in texts, comments and long lists of numbers are no levels.
  std::string flat =
      "# " + repeated("[.") + "\ntitle = '" + repeated("[.") + "'\n[law]\ntype = 'tabulated'\nfriction = [";
  std::string rates = "slip_rate = [";
  for (int i = 1; i <= 300; ++i) flat += "0.5, ", rates += std::to_string(i) + ".5, ";
  std::ofstream(folder.path / "flat.toml") << flat << "]\n" << rates << "]\n";
  CHECK(run_rosin(folder, {"curve", "flat.toml", "--set", "curve.from=2", "--set", "curve.to=100"}).status == 0);
}

TEST_CASE("streams that are closed or full end neither the work nor the process", "[app]") {
  const Folder folder;
  const auto curve = "$ROSIN curve " + example("bristol-board-cycle") + " --explain ";
  CHECK(shell(folder, curve + ">out.txt 2>/dev/full") == 0);
  CHECK(shell(folder, curve + ">out.txt 2>&-") == 0);
  CHECK(content(folder.path / "out/bristol-board-cycle/result.json").find("plan:") == std::string::npos);
  for (const std::string output : {">/dev/full", ">&-", "--json >/dev/full"}) {
    INFO(output);
    CHECK(shell(folder, curve + output + " 2>err.txt") == 1);
    CHECK_THAT(content(folder.path / "err.txt"), Contains("rosin: standard output cannot be written: "));
  }
  CHECK(shell(folder, "$ROSIN laws --json >/dev/full 2>err.txt") == 1);
  CHECK(shell(folder, "$ROSIN curve none.toml 2>/dev/full") == 2);
  CHECK(shell(folder, "(ulimit -f 1; " + curve + "--out small >out.txt 2>/dev/null)") == 1);
}

TEST_CASE("a time limit ends the work in order and keeps what there is", "[app]") {
  const Folder folder;
  std::ofstream(folder.path / "long.toml")
      << "[law]\ntype = 'spinodal'\npreset = 'bristol-board'\nlambda = 10\n[oscillator]\nmass = 1e9\n"
         "stiffness = 1.09\n[drive]\nspeed = 1e-5\nnormal_load = 0.009\n[run]\nduration = 1e9\nsamples = 2000\n"
         "start = { slip_rate = 1.1e-5 }\n[map]\n"
         "x = { parameter = 'drive.normal_load', from = 9.81e-8, to = 9.81, points = 300, scale = 'log' }\n"
         "y = { parameter = 'law.lambda', from = 1e-2, to = 1e2, points = 300, scale = 'log' }\n";
  const auto run = run_rosin(folder, {"run", "long.toml", "--time-limit", "0.3", "--json"});
  CHECK(run.status == 1);
  const auto document = json::parse(run.out);
  CHECK(document["outcome"] == "budget spent");
  CHECK_THAT(document["outcome_detail"].get<std::string>(), Contains("the time limit of 0.3 s has passed"));
  CHECK(document["time"].size() < 2001);
  const auto map = run_rosin(folder, {"map", "long.toml", "--time-limit", "0.3", "--json"});
  CHECK(map.status == 1);
  CHECK_THAT(map.error, Contains("the time limit of 0.3 s has passed") && Contains("the same command goes on"));
  CHECK(json::parse(map.out)["outcome"] == "budget spent");
  CHECK(fs::exists(folder.path / "out/long/map.partial"));
  CHECK(run_rosin(folder, {"run", "long.toml", "--time-limit", "0"}).status == 2);
}

TEST_CASE("each verb keeps its own result, and what is replaced by another is said", "[app]") {
  const Folder folder;
  const auto scene = example("bristol-board-cycle");
  const auto results = folder.path / "out/bristol-board-cycle";
  CHECK(run_rosin(folder, {"curve", scene}).error ==
        "note: law.lambda has no effect: a steady curve does not depend on it\n"
        "note: drive.speed, oscillator have no effect: 'curve' does not ask for them\n");
  REQUIRE(run_rosin(folder, {"stability", scene}).error.empty());
  CHECK(json::parse(content(results / "curve.json"))["verb"] == "curve");
  CHECK(json::parse(content(results / "stability.json"))["verb"] == "stability");
  CHECK(content(results / "result.json") == content(results / "stability.json"));
  CHECK(content(results / "manifest.json") == content(results / "stability.manifest.json"));
  CHECK(run_rosin(folder, {"stability", scene}).error.empty());  // the same once more
  CHECK_THAT(run_rosin(folder, {"stability", scene, "--set", "law.lambda=20"}).error,
             Contains("stability.json replaces a result without --set"));
  CHECK_THAT(run_rosin(folder, {"stability", scene}).error, Contains("replaces a result with --set \"law.lambda=20\""));
  CHECK_THAT(run_rosin(folder, {"stability", scene, "--set", "law.lambda=20"}).error,
             Contains("--out keeps results apart, such as --out \"out/{law.lambda}\""));
  for (const char* lambda : {"20", "30"}) {
    const auto set = std::string("law.lambda=") + lambda;
    CHECK(run_rosin(folder, {"stability", scene, "--set", set, "--out", "{title}/{law.lambda}"}).error.empty());
    CHECK(fs::exists(folder.path / "Bristol_board_near_the_elbow_of_the_stability_line" / lambda / "stability.json"));
  }
  const auto unknown = run_rosin(folder, {"curve", scene, "--out", "out/{law.lamda}"});
  CHECK(unknown.status == 2);
  CHECK_THAT(unknown.error, Contains("--out: 'law.lamda'") && Contains("did you mean 'law.lambda'?"));
  std::ofstream(folder.path / "...toml") << content(scene);
  CHECK(run_rosin(folder, {"curve", "...toml"}).status == 0);
  CHECK(fs::exists(folder.path / "out/...toml/curve.json"));
}

TEST_CASE("scripts are drawn again as rosin wrote them, others are left alone", "[app]") {
  const Folder folder;
  const auto scene = example("bristol-board-cycle");
  REQUIRE(run_rosin(folder, {"curve", scene, "--out", "r"}).status == 0);
  const auto again = run_rosin(folder, {"plot", "r"});
  CHECK(again.status == 0);
  CHECK_THAT(again.out, Contains("r/curve.svg"));
  std::ofstream(folder.path / "r/curve.gp", std::ios::app) << "system 'touch restyled'\n";
  std::ofstream(folder.path / "r/foreign.gp") << "system 'touch foreign'\n";
  const auto refused = run_rosin(folder, {"plot", "r"});
  CHECK(refused.status == 1);
  CHECK(refused.out.empty());
  for (const char* script : {"curve.gp", "foreign.gp"})
    CHECK_THAT(refused.error, Contains(std::string(script) + " is not as rosin wrote it") &&
                                  Contains(std::string("'gnuplot ") + script + "' in r/"));
  CHECK_FALSE(fs::exists(folder.path / "r/restyled"));
  CHECK_FALSE(fs::exists(folder.path / "r/foreign"));
}

TEST_CASE("what an analysis refuses names the place of the key in the scene", "[app]") {
  const Folder folder;
  const auto scene = example("bristol-board-plane");
  const auto varied = run_rosin(folder, {"map", scene, "--set", "drive.speed={ steps = [[0, 1e-6], [20, 1e-5]] }"});
  CHECK(varied.status == 2);
  CHECK_THAT(varied.error, StartsWith("--set drive.speed="));
  const auto twice = run_rosin(folder, {"map", scene, "--set", "map.y.parameter=drive.normal_load"});
  CHECK(twice.status == 2);
  CHECK_THAT(twice.error, StartsWith(scene + ":"));
}

TEST_CASE("a bench keeps each row as it is finished, and tells what it computes unless it is to be quiet") {
  const Folder folder;
  const Arguments bench = {"bench", "response", "--quick", "--out", "b"};
  const auto told = run_rosin(folder, bench);
  CHECK(told.status == 0);
  CHECK_THAT(told.error, Catch::Contains(" s] "));
  const auto rows = json::parse(content(folder.path / "b" / "response.json"))["response"]["rows"];
  std::istringstream kept(content(folder.path / "b" / "response.rows.jsonl"));
  std::size_t count = 0;
  for (std::string line; std::getline(kept, line); ++count) {
    REQUIRE(count < rows.size());
    const auto row = json::parse(line);
    CHECK(row["solver"] == rows[count]["solver"]);
    CHECK(row["seconds"] == rows[count]["seconds"]);
  }
  CHECK(count == rows.size());
  auto quietly = bench;
  quietly.push_back("--quiet");
  CHECK(run_rosin(folder, quietly).error.empty());
}
