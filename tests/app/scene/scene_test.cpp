/// Scenes: what is read, and that every wrong scene is refused with its place, the value and what to try.
#include "app/scene/scene.hpp"

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/planes/map.hpp"
#include "app/scene/family.hpp"
#include "app/tasks/compare.hpp"
#include "app/tasks/fit.hpp"
#include "app/tasks/lab.hpp"
#include "app/tasks/stability.hpp"
#include "core/error.hpp"
#include "tests/app/scene_of.hpp"

using rosin::app::scene::Scene;
using rosin::tests::scene_of;

namespace {

/// A scene in a file "scene.toml" of a folder of its own, read with that folder as the working directory.
Scene read(const std::string& text, const std::string& verb, const std::vector<std::string>& overrides = {},
           std::string_view experiment = {}) {
  namespace fs = std::filesystem;
  const auto before = fs::current_path();
  const auto folder = fs::temp_directory_path() / ("rosin-scene-" + std::to_string(getpid()));
  fs::create_directories(folder);
  fs::current_path(folder);
  std::ofstream("scene.toml", std::ios::binary) << text;
  std::ofstream("record.csv") << "time,load\n0,1\n2.5,4\n";
  std::ofstream("torn.csv") << "0,1\n2.5\n";
  std::ofstream("units.csv") << "# of the rig\ntime (ms), load [kN]\n0,1\n2500,4\n";
  std::ofstream("units-in-comment.csv")
      << "# taken (twice), again\n# rig (new), run (last)\n# time (ms), load (kN)\n0,1\n2500,4\n";
  std::ofstream("units-below.csv") << "time,load\nms,kN\n0,1\n2500,4\n";
  std::ofstream("gap.csv") << "time;load;state\n0,0;1,5;a\n1,0;n/a;b\n";
  std::ofstream("motion.csv") << "time (ms),displacement (mm)\n0,1\n2500,4\n";
  std::ofstream("curve.csv") << "Speed [mm/s],mu [-]\n1,0.4\n10,0.3\n100,0.2\n";
  struct Return {
    fs::path to;
    ~Return() { fs::current_path(to); }
  } on_exit{before};
  return scene_of("scene.toml", overrides, verb, experiment);
}

std::string refusal(const std::string& text, const std::string& verb, const std::vector<std::string>& overrides = {}) {
  try {
    read(text, verb, overrides);
  } catch (const rosin::InputError& error) {
    return error.what();
  }
  return "accepted";
}

const std::string spinodal = "[law]\ntype = 'spinodal'\n";
const std::string slider = "[oscillator]\nmass = 1\nstiffness = 1.09\n[drive]\nspeed = 1e-5\nnormal_load = 1e-3\n";
const std::string plane =
    "[map]\nx = { parameter = 'drive.normal_load', from = 1e-6, to = 1, points = 4 }\n"
    "y = { parameter = 'law.lambda', from = 1e-2, to = 10, points = 3, extra = [0] }\n";

}  // namespace

TEST_CASE("the scene of the contract is read in SI units") {
  const Scene scene = read(R"(title = "Bristol board"
[law]
type = "spinodal"
preset = "bristol-board"
lambda = 10
b = "4.5 %"
[law.contact_stiffness]
tangential = "1 N/um"
[oscillator]
type = "slider"
mass = "1000 g"
stiffness = 1.09
[drive]
speed = "0.01 mm/s"
normal_load = 9.81e-4
[run]
duration = "2 min"
samples = 20
start = { displacement = "1 mm", velocity = 0, psi = 0.01 }
[cycle]
stick_threshold = 0.2
[stability]
parameters = ["law.lambda"]
[map]
x = { parameter = "drive.normal_load", from = "1 uN", to = "1 N", points = 7, scale = "log" }
y = { parameter = "law.lambda", from = 1e-4, to = 1e2, points = 4, extra = [0] }
metrics = ["stick_fraction", "loop_area"]
)",
                           "map");
  CHECK(scene.title == "Bristol board");
  CHECK(scene.model.lambda == 10);
  CHECK(scene.model.get("law.b") == 0.045);
  CHECK(scene.model.get("law.a") == 0.0349);
  CHECK(scene.model.contact_stiffness.tangential == Approx(1e6));
  CHECK(scene.model.slider.mass == 1);
  CHECK(scene.model.drive.speed.level() == 1e-5);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().duration == 120);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().samples == 20);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().start.displacement == 1e-3);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().start.states.at("psi") == 0.01);
  CHECK(scene.task<rosin::analysis::cycles::CycleOptions>().stick_threshold == 0.2);
  CHECK(scene.task<rosin::analysis::planes::MapOptions>().stick_threshold == 0.2);
  CHECK(scene.task<rosin::analysis::planes::MapOptions>().x.values.size() == 7);
  CHECK(scene.task<rosin::analysis::planes::MapOptions>().y.values.back() == 0);
  CHECK(scene.task<rosin::analysis::planes::MapOptions>().metrics ==
        std::vector<std::string>{"stick_fraction", "loop_area"});
  CHECK(scene.task<rosin::app::tasks::Stability>().parameters == std::vector<std::string>{"law.lambda"});
}

TEST_CASE("a law alone is enough for its curve") {
  CHECK(read("[law]\ntype = 'coulomb'", "curve").model.law->card().name == "coulomb");
  CHECK(read("[law]\ntype = 'tabulated'\nslip_rate = [0, '1 mm/s']\nfriction = [0.4, 0.3]", "curve")
            .model.law->friction({5e-4, 1}, {}) < 0.4);
}

TEST_CASE("an option of a law takes the law that stands for it, with its own units") {
  const auto law = [](const std::string& text) { return read("[law]\n" + text, "curve").model.law; };
  const auto free = law("type = 'lugre'\nload_scaling = 'none'\nsigma0 = '20 N/mm'");
  CHECK(free->card().name == "lugre-unscaled");
  CHECK(free->parameter("sigma0") == 2e4);
  CHECK(law("type = 'lugre'\nload_scaling = 'load'\nsigma0 = 2e4")->card().name == "lugre");
  CHECK(law("type = 'thermal'\nconduction = 'disc'\ntime = '1 ms'")->card().name == "thermal-disc");
  CHECK(law("type = 'thermal'\nconduction = 'lumped'\nC = 1e-6")->card().name == "thermal");
  const auto heated =
      law("type = 'coulomb'\n[law.heating]\nresistance = 3\ntime = 0.1\nsoftening = 9\nconduction = 'disc'");
  CHECK(heated->states().size() == 10);
  CHECK(heated->states()[0].name == "temperature_rise");
  CHECK_THAT(refusal("[law]\ntype = 'lugre'\nload_scaling = 'some'\n", "curve"),
             Catch::Contains("scene.toml:3:16: law.load_scaling = 'some' is not known"));
  CHECK_THAT(refusal("[law]\ntype = 'dahl'\nload_scaling = 'none'\n", "curve"),
             Catch::Contains("unknown key 'load_scaling' in [law]"));
}

TEST_CASE("drive signals are read in every form") {
  const auto drive = [](const std::string& load) {
    return read(spinodal + "[oscillator]\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = " + load,
                "stability")
        .model.drive.normal_load;
  };
  CHECK(drive("'2 kN'").level() == 2000);
  CHECK(drive("{ steps = [[0, '1 kN'], ['100 ms', 3]] }").value(0.1) == 3);
  CHECK(drive("{ steps = [[0, '1 kN'], ['100 ms', 3]] }").value(0.05) == 1000);
  CHECK(drive("{ ramp = { from = 1, rate = '2 N/min' } }").value(60) == Approx(3));
  CHECK(drive("{ mean = 9.8, harmonics = [{ amplitude = 5, angular_frequency = 15 }] }").value(0) == 14.8);
  CHECK(drive("{ table = 'record.csv' }").value(1.25) == 2.5);
}

TEST_CASE("units in the headers of tables count for drives, motions and measurements alike") {
  const std::string pulled = spinodal + "[oscillator]\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = ";
  CHECK(read(pulled + "{ table = 'units.csv' }", "stability").model.drive.normal_load.value(1.25) == 2500);
  CHECK(read(pulled + "{ table = 'units-in-comment.csv' }", "stability").model.drive.normal_load.value(1.25) == 2500);
  CHECK_THAT(refusal(pulled + "{ table = 'motion.csv' }", "stability"),
             Catch::Contains("motion.csv:1") && Catch::Contains("'1 mm' is in mm, but needed is N"));
  CHECK(read(pulled + "{ table = 'units-below.csv' }", "stability").model.drive.normal_load.value(1.25) == 2500);
  const std::string chosen = "{ table = { file = 'units.csv', time = 'time', value = ";
  CHECK(read(pulled + chosen + "{ column = 2, factor = 2, offset = 1, unit = 'N' } } }", "stability")
            .model.drive.normal_load.value(1.25) == 6);
  CHECK_THAT(refusal(pulled + chosen + "{ column = 'load', unit = 'mN' } } }", "stability"),
             Catch::Contains("units.csv:2") && Catch::Contains("the file says kN, the scene mN"));
  const auto gap = [&](const char* value) {
    return refusal(pulled + "{ table = { file = 'gap.csv', time = 1, value = " + value + " } }", "stability");
  };
  CHECK_THAT(gap("'load'"), Catch::Contains("gap.csv:3: column 'load' is missing here"));
  CHECK_THAT(gap("'state'"), Catch::Contains("gap.csv:2: column 'state' is not a finite number here: 'a'"));
  CHECK_THAT(refusal(pulled + "{ table = 'gap.csv' }", "stability"),
             Catch::Contains("gap.csv:2: has 3 columns, where 2 are taken"));
  CHECK_THAT(refusal(pulled + chosen + "'lode' } }", "stability"), Catch::Contains("did you mean 'load'?"));

  const std::string lab = spinodal + slider + "[lab]\nrecord = 'motion.csv'\n";
  const auto scene = read(lab, "lab", {}, "inverse");
  CHECK(scene.task<rosin::app::tasks::Lab>().task->motion->time.back() == 2.5);
  CHECK(scene.task<rosin::app::tasks::Lab>().task->motion->value.back() == 4e-3);

  const std::string fit = spinodal + "[drive]\nspeed = 1\nnormal_load = 1\n[fit]\nparameters = ['law.a']\n";
  const std::string data = "data = [ { type = 'steady-curve', file = 'curve.csv', standard_error = 1e-3, columns = ";
  for (const char* columns : {"{ slip_rate = 'Speed [mm/s]', friction_coefficient = 'mu [-]' }",
                              "{ slip_rate = 'Speed', friction_coefficient = 'mu' }",
                              "{ slip_rate = { column = 'Speed', unit = 'mm/s' }, friction_coefficient = 'mu' }"})
    CHECK(read(fit + data + columns + " } ]", "fit").task<rosin::app::tasks::Fit>().data[0].x ==
          std::vector<double>{1e-3, 1e-2, 0.1});
}

TEST_CASE("what a verb does not ask for is said to have no effect") {
  const auto said = [](const Scene& scene, const char* text) {
    return std::ranges::any_of(scene.notes, [&](const auto& note) { return note.find(text) != std::string::npos; });
  };
  const std::string fit = spinodal + slider + "force = 1\n[fit]\nparameters = ['law.a']\n" +
                          "data = [ { type = 'steady-curve', file = 'curve.csv', standard_error = 1e-3, columns = "
                          "{ slip_rate = 'Speed', friction_coefficient = 'mu' } } ]\n";
  const auto fitted = read(fit, "fit");
  CHECK(said(fitted, "oscillator.mass has no effect"));
  CHECK(said(fitted, "drive.force has no effect"));
  const std::string coulomb = "[law]\ntype = 'coulomb'\n" + slider +
                              "[map]\nstick_threshold = 0.2\nx = { parameter = 'drive.normal_load', from = 1, to = 2, "
                              "points = 2 }\ny = { parameter = 'drive.speed', from = 1, to = 2, points = 2 }\n";
  CHECK(said(read(coulomb, "map"), "map.stick_threshold has no effect"));
  CHECK_FALSE(said(read(coulomb + "metrics = ['slow_fraction']", "map"), "stick_threshold"));
  const std::string lab = "[law]\ntype = 'ageing'\n[drive]\nspeed = 1\n[lab]\nspeed = 1e-5\n";
  CHECK(said(read(lab, "lab", {}, "slide-hold-slide"), "drive.speed has no effect: slide-hold-slide sets it itself"));
}

TEST_CASE("starts are read in every form") {
  const auto start = [](const std::string& text) {
    return read(spinodal + slider + "[run]\nduration = 1\nstart = " + text, "run")
        .task<rosin::analysis::motion::RunOptions>()
        .start;
  };
  using Kind = rosin::analysis::motion::Start::Kind;
  CHECK(start("'steady'").kind == Kind::steady);
  CHECK(start("'rest'").kind == Kind::rest);
  CHECK(start("{ state = 0.5 }").states.at("psi") == 0.5);
  CHECK(start("{ state = { psi = 0.5 } }").states.at("psi") == 0.5);
  CHECK(start("{ slip_rate = '1 mm/s' }").slip_rate == 1e-3);
}

TEST_CASE("overrides replace values and may be bare words") {
  const Scene scene = read(spinodal + slider + "[run]\nduration = 1", "run",
                           {"law.a=0.03", "drive.speed=2 mm/s", "run.start=rest", "cycle.stick_threshold=0.5",
                            "oscillator.mass=\"3 g\"", "drive.force={ steps = [[0, 1], [1, 2]] }"});
  CHECK(scene.model.get("law.a") == 0.03);
  CHECK(scene.model.drive.speed.level() == 2e-3);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().start.kind == rosin::analysis::motion::Start::Kind::rest);
  CHECK(scene.task<rosin::analysis::cycles::CycleOptions>().stick_threshold == 0.5);
  CHECK(scene.model.slider.mass == 3e-3);
  CHECK(scene.model.drive.force.value(1) == 2);
  CHECK(scene.resolved.find("0.03") != std::string::npos);
}

TEST_CASE("the resolved scene is a scene with the same content") {
  const std::vector<std::string> changes = {"law.a=0.03", "run.start={ displacement = '1 mm' }"};
  const Scene scene = read(spinodal + slider + "[run]\nduration = 1\n" + plane, "map", changes);
  const Scene again = read(scene.resolved, "map");
  CHECK(again.resolved == scene.resolved);
  CHECK(again.model.get("law.a") == 0.03);
  CHECK(again.task<rosin::analysis::planes::MapOptions>().x.values ==
        scene.task<rosin::analysis::planes::MapOptions>().x.values);
  // Texts of several lines and of quotation marks, keys with dots, and a number that must stay whole.
  const Scene titled =
      read("title = \"\"\"a'''b\n\\\"\"\"\"\"\n" + spinodal + slider + "[run]\nduration = 1.0\nsamples = 7", "run");
  CHECK(titled.title == "a'''b\n\"\"");
  CHECK(read(titled.resolved, "run").title == titled.title);
  CHECK_THROWS_WITH(read(spinodal + slider + "[run]\nduration = 1", "run", {"title=\xff"}),
                    Catch::Contains("is no text in UTF-8"));
}

TEST_CASE("a place in a message is one that the user wrote", "[scene]") {
  const std::string belt =
      "[law]\ntype = 'coulomb'\nmu_s = 0.3\nmu_d = 0.3\n[oscillator]\ntype = 'two-mass-belt'\nmass = 1\nstiffness = 1\n"
      "second_mass = 1\nsecond_stiffness = 1\n[drive]\nspeed = 1\nnormal_load = 1\n";
  const auto scene =
      read(belt + "[stability]\nscan = { parameter = 'law.mu_s', from = 0.1, to = 0.5, points = 5 }", "stability");
  CHECK_THROWS_WITH(scene.family->with({{"law.mu_s", 0.1}}),
                    Catch::StartsWith("stability.scan: at law.mu_s = 0.1: law.mu_s = 0.1 is below law.mu_d = 0.3"));
  CHECK(scene.placed("stability.scan: at law.mu_s = 0.1: too small") ==
        "scene.toml:15:8: stability.scan: at law.mu_s = 0.1: too small");
}

TEST_CASE("a wrong scene is refused with its place and what to try") {
  struct Case {
    std::string verb;
    std::string text, message;
  };
  const auto law = [](const std::string& line) { return spinodal + line; };
  const auto run = [](const std::string& line) { return spinodal + slider + line; };
  const auto map = [](const std::string& x) {
    return spinodal + slider + "[map]\nx = " + x +
           "\ny = { parameter = 'law.lambda', from = 1, to = 10, points = 3 }\n";
  };
  const auto structure = [](const std::string& lines) {
    return "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'structure'\nM = [[1, 0], [0, 1]]\n" + lines +
           "\n[drive]\nspeed = 1\nnormal_load = 1\n";
  };
  const auto chain = [](const std::string& lines, const std::string& drive = "") {
    return "[law]\ntype = 'coulomb'\n[drive]\nspeed = 1\nnormal_load = 1\n" + drive +
           "[oscillator]\ntype = 'chain'\nblocks = 2\nmass = 1\npull_stiffness = 1\n" + lines + "\n";
  };
  const std::vector<Case> cases = {
      // keys and tables
      {"stability", law("[oscillator]\nmass = 1\n  stifness = 1"),
       "scene.toml:5:3: unknown key 'stifness' in [oscillator]; did you mean 'stiffness'?"},
      {"stability", law("[oscillator]\nmass = 1\nstiffness = 1\n  dampin = 1\n[drive]\nspeed=1\nnormal_load=1"),
       "scene.toml:6:3: unknown key 'dampin' in [oscillator]; did you mean 'damping'?"},
      {"stability", law("[oscillator]\nmass = 1"), "scene.toml:3:1: [oscillator] has no 'stiffness' (N/m)"},
      {"curve", law("aa = 3"), "scene.toml:3:1: unknown key 'aa' in [law]; did you mean 'a'?"},
      {"curve", law("[mapp]\nx = 1"), "scene.toml:3:2: unknown table 'mapp'; did you mean 'map'?"},
      {"curve", "titel = 'x'\n" + spinodal, "scene.toml:1:1: unknown key 'titel'; did you mean 'title'?"},
      {"curve", "[oscillator]\nmass = 1", "the scene has no [law]"},
      {"curve", "law = 3", "scene.toml:1:7: law is a number, but a table is needed"},
      {"curve", "[law]\na = 0.1", "scene.toml:1:1: [law] has no 'type'"},
      {"run", spinodal, "the scene has no [oscillator]"},
      {"run", law("[oscillator]\nmass = 1\nstiffness = 1\n"), "the scene has no [drive]"},
      {"run", run(""), "the scene has no [run]"},
      {"map", run(""), "the scene has no [map]"},
      {"run", run("[run]\nsamples = 3"), "scene.toml:9:1: [run] has no 'duration' (s)"},
      // the law
      {"curve", "[law]\ntype = 'spinodl'", "scene.toml:2:8: unknown friction law 'spinodl'; did you mean 'spinodal'?"},
      {"curve", "[law]\ntype = 3", "scene.toml:2:8: law.type is a number, but a text is needed"},
      {"curve", law("preset = 'bristolboard'"), "did you mean 'bristol-board'?"},
      {"curve", law("a = 3"), "scene.toml:3:5: law.a = 3 is outside 0.0001 … 0.5 (direct effect, dimensionless)"},
      {"curve", law("a = nan"), "scene.toml:3:5: law.a is not a number (NaN)"},
      {"curve", law("a = inf"), "scene.toml:3:5: law.a = inf is outside"},
      {"curve", law("a = true"), "scene.toml:3:5: law.a is a truth value, but a number (direct effect, "},
      {"curve", law("a = [1]"), "scene.toml:3:5: law.a is a list, but a number"},
      {"curve", law("a = 1979-05-27"), "scene.toml:3:5: law.a is a date or time, but a number"},
      {"curve", law("L = '5 MPa'"), "scene.toml:3:5: law.L: '5 MPa' is in MPa, but needed is m"},
      {"curve", law("L = 'long'"), "scene.toml:3:5: law.L: 'long' is not a number with a unit"},
      {"curve", law("L = '3 parsnip'"), "scene.toml:3:5: law.L: 'parsnip' is not a known unit"},
      {"curve", "[law]\ntype = 'coulomb'\nmu_s = 0.1", "scene.toml:1:1: law.mu_s = 0.1 is below law.mu_d"},
      {"curve", "[law]\ntype = 'coulomb'\nlambda = 2", "scene.toml:3:10: law.lambda has no meaning"},
      {"curve", "[law]\ntype = 'tabulated'\nslip_rate = 3", "scene.toml:3:13: law.slip_rate is a number, but a list"},
      {"curve", "[law]\ntype = 'tabulated'\nfriction = [1, 99]", "scene.toml:3:16: law.friction = 99 is outside"},
      {"curve", law("[law.contact_stiffness]\ntangential = 1\ndamping = -1"),
       "scene.toml:5:11: law.contact_stiffness.damping = -1 is outside 0 … 1"},
      {"curve", law("load_memory = { alpha = 2 }"), "law.load_memory.alpha = 2 is outside 0 … 1"},
      {"curve", law("[law.contact_stiffness]\ntangental = 1"), "did you mean 'tangential'?"},
      // slider and drive
      {"stability", law("[oscillator]\ntype = 'modal'"), "scene.toml:4:8: oscillator.type = 'modal' is not available"},
      {"stability", law("[oscillator]\ntype = 'slyder'"), "did you mean 'slider'?"},
      {"stability",
       "[law]\ntype = 'coulomb'\n[oscillator]\nmass = 0\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = 1",
       "scene.toml:3:1: oscillator.mass = 0 does not go with law 'coulomb'"},
      {"run", run("force = { noise = { rms = 1 } }"), "[drive.force.noise] has no 'band'"},
      {"run", run("force = { noise = { rms = 1, band = [2, 1] } }"), "must be 0 <= low < high"},
      {"run", run("force = { steps = [[0, 1], [0, 2]] }"), "scene.toml:9:9: times must ascend"},
      {"run", run("force = { steps = [[0, '1 m']] }"), "scene.toml:9:24: drive.force: '1 m' is in m, but needed is N"},
      {"run", run("force = { steps = [[0]] }"),
       "scene.toml:9:20: drive.force.steps is a list, but [time, value] is needed"},
      {"run", run("force = {}"), "scene.toml:9:9: drive.force needs one of steps, ramp, table, or harmonics"},
      {"run", run("force = { table = 'none.csv' }"), "scene.toml:9:19: none.csv: no such file"},
      {"run", run("force = { table = 'torn.csv' }"), "scene.toml:9:19: torn.csv:2: has 1 cells, the other rows have 2"},
      {"run", run("force = { mean = 1, harmonics = [{ amplitude = 1, angular_frequency = '3 Hz' }] }"),
       "angular frequency"},
      {"run",
       law("[oscillator]\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\n"
           "normal_load = { mean = 1, harmonics = [{ amplitude = 5, angular_frequency = 3 }] }"),
       "scene.toml:8:15: drive.normal_load leaves 0 … 1"},
      {"run",
       law("[oscillator]\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\n"
           "normal_load = { ramp = { from = 5, rate = -1 } }\n[run]\nduration = 6"),
       "scene.toml:8:15: drive.normal_load leaves"},
      // runs
      {"run", run("[run]\nduration = 0"), "scene.toml:10:12: run.duration = 0 is outside"},
      {"run", run("[run]\nduration = 1\nsamples = 2.5"),
       "scene.toml:11:11: run.samples is a number, but a whole number"},
      {"run", run("[run]\nduration = 1\nsamples = 0"), "scene.toml:11:11: run.samples = 0 is outside 1 …"},
      {"run", run("[run]\ntimes = [0, 2, 1]"), "scene.toml:10:9: run.times must ascend"},
      {"run", run("[run]\nduration = 1\nstart = 'stedy'"), "run.start = 'stedy' is not known; did you mean 'steady'?"},
      {"run", run("[run]\nduration = 1\nstart = { velocity = 1, slip_rate = 1 }"), "velocity or slip_rate, not both"},
      {"run", run("[run]\nduration = 1\nstart = { psi = 2 }"), "scene.toml:11:17: run.start.psi = 2 is outside"},
      {"run", run("[run]\nduration = 1\nstart = { state = 2 }"), "scene.toml:11:19: run.start.state = 2 is outside"},
      {"run", run("[run]\nduration = 1\nstart = { theta = 2 }"), "unknown key 'theta' in [run.start]"},
      {"run", run("[run]\nduration = 1\n[solver]\ntype = 'cvod'"), "did you mean 'cvode'?"},
      {"run", run("[run]\nduration = 1\n[solver]\ntype = 'lanes'"), "is that of maps"},
      {"run", run("[run]\nduration = 1\n[solver]\ntype = 'cfm'\nwindow = 1"), "only for o-fbfm"},
      {"run", run("[run]\nduration = 1\n[solver]\nstep = 1"), "no meaning for solver 'auto'"},
      {"branch", "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'string'\n[drive]\nspeed = 1\nnormal_load = 1",
       "scene.toml:4:8: oscillator.type = 'string' serves run, stability, cycle, sweep, map, compare, frf, lyapunov, "
       "lab only, not 'branch': the state of a string is all its waves"},
      {"run", structure("K = [[1]]"), "scene.toml:6:5: oscillator.K has 1 rows, but M has 2"},
      {"run", structure("K = [[1, 0], [0]]"), "scene.toml:6:14: oscillator.K is not square: a row has 1 of 2"},
      {"run", structure("K = [['3 kN/m', 0], [0, '1 m']]"), "scene.toml:6:25: oscillator.K: '1 m' is in m"},
      {"run", structure("K = [[1, 0], [0, 1]]\nKk = 1\ncontacts = []"), "unknown key 'Kk' in [oscillator]"},
      {"run", structure("K = [[1, 0], [0, 1]]"), "[oscillator] has no 'contacts'"},
      {"run", structure("K = [[1, 0], [0, 1]]\n[[oscillator.contacts]]\ntangential = [1]"),
       "scene.toml:8:14: oscillator.contacts.1.tangential has 1 entries for 2 coordinates"},
      {"run",
       structure(
           "K = [[1, 0], [0, 1]]\n[[oscillator.contacts]]\ntangential = [1, 0]\nnormal_load = 1\nload_factor = 2"),
       "scene.toml:10:15: oscillator.contacts.1.load_factor: give normal_load or load_factor, not both"},
      {"run",
       structure("K = [[1, 0], [0, 1]]\n[[oscillator.contacts]]\ntangential = [1, 0]\n[[oscillator.contacts]]\n"
                 "tangential = [2, 0]"),
       "directions that depend on each other"},
      {"run",
       structure("K = [[1, 0], [0, 1]]\n[[oscillator.contacts]]\ntangential = [1, 0]\n[run]\nduration = 1\n"
                 "start = { displacment_2 = 1 }"),
       "unknown key 'displacment_2' in [run.start]; did you mean 'displacement_2'?"},
      {"run", chain("stiffness = [1, 1]"),
       "oscillator.stiffness has 2 entries, but 1 are needed, or one number for all"},
      {"run", chain("stiffness = 1\n[[oscillator.contacts]]\nblock = 3"),
       "oscillator.contacts.1.block = 3 is outside 1 … 2"},
      {"run", chain("stiffness = 1\n[[oscillator.contacts]]\nblock = 1\n[[oscillator.contacts]]\nblock = 1"),
       "block 1 has a contact in this list already"},
      {"run", chain("stiffness = 1", "force = 1\n"), "drive.force has no place on this oscillator"},
      {"run",
       "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'plane-slider'\nmass = 1\nstiffness = [1]\ndamping = [0, 0]\n"
       "[drive]\nnormal_load = 1\nforce = [0, 0]\n[run]\nduration = 1",
       "scene.toml:6:13: oscillator.stiffness has 1 entries, but 2 are needed"},
      {"run",
       "[law]\ntype = 'static-growth'\n[oscillator]\ntype = 'plane-slider'\nmass = 1\nstiffness = [1, 1]\ndamping = "
       "[0, "
       "0]\n[drive]\nnormal_load = 1\n[run]\nduration = 1",
       "scene.toml:1:1: law 'static-growth' on a plane slider has states and is set-valued at rest"},
      {"run",
       "[law]\ntype = 'lugre'\nlambda = 0\n[oscillator]\ntype = 'plane-slider'\nmass = 1\nstiffness = [1, 1]\ndamping "
       "= "
       "[0, 0]\n[drive]\nnormal_load = 1\n[run]\nduration = 1",
       "scene.toml:1:1: law.lambda = 0 leaves law 'lugre' no memory"},
      {"run",
       "[law]\ntype = 'lugre'\n[oscillator]\ntype = 'plane-slider'\nmass = 1\nstiffness = [1, 1]\ndamping = [0, 0]\n"
       "[drive]\nnormal_load = 1\n[run]\nduration = 1\nstart = { z = 1e-6 }",
       "scene.toml:12:15: run.start.z is a number, but a list of two, along x and y is needed"},
      {"study", "[study]\ndimensions = 3", "scene.toml:2:14: study.dimensions = 3 is outside 1"},
      {"study", "[study]\ncases = 0", "scene.toml:2:9: study.cases = 0 is outside 1"},
      {"study", "[study]\nstepps_per_period = 1000", "did you mean 'steps_per_period'?"},
      {"study", "title = 'x'", "the scene has no [study]"},
      // maps
      {"map", map("{ parameter = 'drive.normal', from = 1, to = 2, points = 3 }"),
       "scene.toml:10:19: unknown parameter 'drive.normal'"},
      {"map", map("{ parameter = 'drive.normal_loud', from = 1, to = 2, points = 3 }"),
       "did you mean 'drive.normal_load'?"},
      {"map", map("{ parameter = 'law.a', from = 1e-9, to = 0.1, points = 3 }"),
       "scene.toml:10:35: map.x.from = 1e-09 is outside 0.0001 … 0.5 (law.a, direct effect, dimensionless)"},
      {"map", map("{ parameter = 'law.a', from = 1e-3, to = 2, points = 3 }"),
       "scene.toml:10:46: map.x.to = 2 is outside"},
      {"map", map("{ parameter = 'law.a', from = 1e-3, to = 0.1, points = 1 }"), "map.x.points = 1 is outside 2 …"},
      {"map", map("{ parameter = 'law.b', from = 0, to = 0.1, points = 3 }"), "scene.toml:10:5: "},
      {"map", map("{ parameter = 'law.a', from = 0.1, to = 0.1, points = 3 }"), "scene.toml:10:5: "},
      {"map", map("{ parameter = 'law.lambda', from = 1, to = 9, points = 3 }"), "are the same parameter"},
      {"map", map("{ parameter = 'law.a', from = 1e-3, to = 0.1, points = 3, scale = 'lin' }"), "map.x.scale = 'lin'"},
      {"map", map("{ parameter = 'law.a', from = 1e-3, to = 0.1, points = 3, extra = [9] }"),
       "map.x.extra = 9 is outside"},
      {"map", run(plane + "metrics = ['stick_fractoin']"), "scene.toml:12:12: unknown metric 'stick_fractoin'"},
      {"map", run(plane + "metrics = ['period', 'period']"), "names 'period' twice"},
      {"map", run("[map]\nx = 3\ny = 4"), "scene.toml:10:5: map.x is a number, but a table is needed"},
      {"stability", run("[stability]\nparameters = ['law.c', 'law.q']"), "scene.toml:10:24: unknown parameter 'law.q'"},
      {"curve", law("[curve]\nfrom = 1\nto = 0.1"), "scene.toml:3:1: curve.from = 1 must be below curve.to = 0.1"},
      // files
      {"curve", "", "scene.toml:1:1: the scene is empty"},
      {"curve", " \n\t", "scene.toml:1:1: the scene is empty"},
      {"curve", "[law\ntype = 3", "scene.toml:1:5: not valid TOML"},
      {"curve", "[law]\ntype = 'spinodal'\ntype = 'slip'", "scene.toml:3:"},
      {"curve", "[law]\ntype = '\xff\xfe'", "scene.toml:2:"},
      {"curve", std::string(5000, '['), "scene.toml:1:"},
      {"curve", "[law]\ntype = 'spinodal'\na = 1e", "scene.toml:3:"},
  };
  for (const auto& c : cases) {
    CAPTURE(c.text);
    CHECK_THAT(refusal(c.text, c.verb), Catch::Contains(c.message));
    CHECK_THAT(refusal(c.text, c.verb), Catch::StartsWith("scene.toml:"));
  }
}

TEST_CASE("files that are no scenes are refused before they are read") {
  namespace fs = std::filesystem;
  const auto refuse = [](const std::string& path) {
    try {
      scene_of(path, {}, "curve");
    } catch (const rosin::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(refuse("no/such.toml") == "no/such.toml: no such file");
  CHECK(refuse("/") == "/: is a folder, not a file");
  CHECK(refuse("/dev/zero") == "/dev/zero: is not a regular file or a pipe");
  const auto large = fs::temp_directory_path() / ("rosin-large-" + std::to_string(getpid()));
  std::ofstream(large).put('x');
  fs::resize_file(large, 11'000'000);
  CHECK_THAT(refuse(large.string()), Catch::Contains("has 11.0 MB, more than the 10 MB that are read"));
  fs::remove(large);
}

TEST_CASE("a scene may be given as a text, which errors call by its name") {
  rosin::app::Request request;
  request.verb = "curve", request.target = "mine";
  request.text = "[law]\ntype = 'coulomb'\nmu_s = 0.5\n";
  CHECK(rosin::app::verbs::read_scene(request).model.law->card().name == std::string("coulomb"));
  request.text = "[law]\ntype = 'coulom'\n";
  CHECK_THROWS_WITH(rosin::app::verbs::read_scene(request),
                    Catch::StartsWith("mine:2:8: ") && Catch::Contains("did you mean 'coulomb'?"));
}

TEST_CASE("wrong overrides are refused with the override as their place") {
  const auto refuse = [](const std::string& override) {
    return refusal(spinodal + slider + "[run]\nduration = 1", "run", {override});
  };
  CHECK(refuse("law.a=3") == "--set law.a=3: law.a = 3 is outside 0.0001 … 0.5 (direct effect, dimensionless)");
  CHECK(refuse("law.aa=3") == "--set law.aa=3: unknown key 'aa' in [law]; did you mean 'a'?");
  CHECK_THAT(refuse("oscilator.mass=3"), Catch::Contains("unknown table 'oscilator'; did you mean 'oscillator'?"));
  CHECK_THAT(refuse("law.a"), Catch::StartsWith("--set law.a: must read path=value"));
  CHECK_THAT(refuse("=3"), Catch::Contains("must read path=value"));
  CHECK_THAT(refuse("law.=3"), Catch::Contains("path ends with a dot"));
  CHECK_THAT(refuse("law.a.b=3"), Catch::Contains("unknown key 'b'") || Catch::Contains("law.a is a table"));
  CHECK_THAT(refuse("law.type.x=3"), Catch::Contains("law.type is a text, not a table"));
  CHECK_THAT(refuse("law.a=[1,"), Catch::Contains("not valid TOML"));
  CHECK_THAT(refuse("law.a="), Catch::Contains("not valid TOML"));
  CHECK_THAT(refuse("law.a=1\nb=2"), Catch::Contains("more than one value"));
  CHECK_THAT(refuse("law.L=5 MPa"), Catch::StartsWith("--set law.L=5 MPa: law.L: '5 MPa' is in MPa"));
  CHECK_THAT(refuse("law.type=slipp"), Catch::Contains("did you mean 'slip'?"));
}

TEST_CASE("a smoothing of the solver makes every set-valued law of the scene smooth", "[app][scene]") {
  const std::string tanh = "[solver]\nsmoothing = { type = 'tanh', width = '2 mm/s' }\n";
  const std::string coulomb = "[law]\ntype = 'coulomb'\n";
  for (const char* verb : {"run", "cycle", "stability", "curve", "map", "compare"}) {
    CAPTURE(verb);
    const auto scene = read(coulomb + slider + tanh + "[run]\nduration = 1\n" +
                                "[map]\nx = { parameter = 'drive.speed', from = 1e-3, to = 1, points = 2 }\n"
                                "y = { parameter = 'drive.normal_load', from = 1e-2, to = 1, points = 2 }\n"
                                "[compare]\nmembers = [{ name = 'a' }, { name = 'b', law = { type = 'stribeck' } }, "
                                "{ name = 'c', law = { type = 'spinodal' } }]\n",
                            verb);
    CHECK_FALSE(scene.model.law->set_valued());
    CHECK(scene.model.law->friction({2e-3, 1}, {}) == Approx(0.3 * std::tanh(1.0)).epsilon(1e-14));
    for (const auto& member : scene.task<rosin::app::tasks::Compare>().members)
      CHECK_FALSE(member.scene.model.law->set_valued());
    // What holds at rest is lost, which a note says of each law.
    REQUIRE(scene.notes.size() >= 1);
    CHECK_THAT(scene.notes.front(),
               Catch::Contains("0.4 at rest of law 'coulomb' has no effect") && Catch::Contains("rises to 0.3"));
  }
  const std::string chain =
      "[oscillator]\ntype = 'chain'\nblocks = 3\nmass = 1\nstiffness = 1\npull_stiffness = 1\n"
      "[[oscillator.contacts]]\nblock = 2\nlaw = { type = 'hyperbolic' }\n"
      "[drive]\nspeed = 0.2\nnormal_load = 1\n[run]\nduration = 1\n";
  const auto of_chain = read(spinodal + chain + tanh, "run").structure->structure;
  REQUIRE(of_chain.contacts.size() == 3);
  for (const auto& contact : of_chain.contacts) CHECK_FALSE(contact.law->set_valued());
  CHECK(of_chain.contacts[1].law->friction({2e-3, 1}, {}) == Approx(0.4 / 1.006 * std::tanh(1.0)).epsilon(1e-14));
  CHECK(read("[law]\ntype = 'coulomb'\nheating = { resistance = 1, time = 1, softening = 1 }\n" + slider + tanh +
                 "[run]\nduration = 1\n",
             "run")
            .model.law->friction({2e-3, 1}, std::vector{1.0}) == Approx(0.15 * std::tanh(1.0)).epsilon(1e-14));
  const auto counting = read("[law]\ntype = 'slip-weakening'\n" + slider + tanh + "[run]\nduration = 1\n", "run").notes;
  REQUIRE(counting.size() == 1);  // at rest after a stop it has its coefficient in the slowest motion
  CHECK_THAT(counting.front(), Catch::Contains("'slip-weakening' count neither time at rest nor slip from a stop"));
}

TEST_CASE("a smoothing that is none, or without effect, is refused at its place", "[app][scene]") {
  const auto asked = [](const std::string& smoothing, const std::string& law = "coulomb") {
    return refusal("[law]\ntype = '" + law + "'\n" + slider + "[run]\nduration = 1\n[solver]\nsmoothing = " + smoothing,
                   "run");
  };
  CHECK_THAT(asked("{ type = 'arctn', width = 1e-3 }"),
             Catch::Contains("scene.toml:12:22: solver.smoothing.type = 'arctn'") &&
                 Catch::Contains("did you mean 'arctan'?"));
  CHECK_THAT(asked("{ type = 'switch', width = 1e-3 }"),
             Catch::Contains("scene.toml:12:22") && Catch::Contains("friction jumps at the edge of the width") &&
                 Catch::Contains("use one of tanh, arctan, linear, parabolic, multi-region"));
  CHECK_THAT(
      asked("{ type = 'tanh', width = 0 }"),
      Catch::Contains("scene.toml:12:38") && Catch::Contains("solver.smoothing.width = 0 is outside 1e-09 … 1000"));
  CHECK_THAT(asked("{ type = 'tanh', width = '1 mm' }"), Catch::Contains("m/s"));
  CHECK_THAT(asked("{ type = 'tanh' }"), Catch::Contains("no 'width' (slip rate over which friction rises, m/s)"));
  CHECK_THAT(asked("{ type = 'tanh', width = 1e-3, withd = 2 }"), Catch::Contains("did you mean 'width'?"));
  CHECK_THAT(
      asked("{ type = 'tanh', width = 1e-3 }", "spinodal"),
      Catch::Contains("scene.toml:12:13: solver.smoothing has no effect: no law here is set-valued, 'spinodal' is"));
  CHECK_THAT(asked("{ type = 'tanh', width = 1e-3 }\ntype = 'events'"),
             Catch::Contains("accepted"));  // what fits is known when it runs
}

TEST_CASE("a slider in the plane takes laws of the slip rate, and no force", "[app][scene]") {
  const auto text = [](const std::string& law) {
    return "[law]\n" + law +
           "[oscillator]\ntype = 'plane-slider'\nmass = 1\nstiffness = [1, 2]\ndamping = [0, 0]\n[run]\nduration = 1\n";
  };
  const auto rising = read(text("type = 'stribeck'\nmu_s = 0.1\nmu_d = 0.3\n") + "[drive]\nnormal_load = 1\n", "run");
  REQUIRE(rising.plane);
  CHECK(rising.plane->law == rising.model.law);
  CHECK(rising.plane->mass.static_friction == 0.1);
  CHECK(rising.plane->mass.dynamic_friction == Approx(0.1).epsilon(1e-15));
  for (const auto& force : rising.plane->mass.force) CHECK(force.value(1) == 0);
  CHECK_FALSE(read(text("type = 'coulomb'\n") + "[drive]\nnormal_load = 1\n", "run").plane->law);
  const std::string of_load =
      "type = 'formula'\n[law.formula]\nfriction = '0.3 + 0.01 / (1 + N * c)'\n"
      "static_limit = '0.4 + 0.01 / (1 + N * c)'\nparameters = { c = { default = 1, unit = '1/N' } }\n";
  CHECK_NOTHROW(read(text(of_load) + "[drive]\nnormal_load = 1\n", "run"));
  CHECK_THAT(
      refusal(text(of_load) + "[drive]\nnormal_load = { mean = 2, harmonics = [{ amplitude = 1, angular_frequency "
                              "= 1 }] }\n",
              "run"),
      Catch::Contains("law 'formula' depends on the load, which of a plane slider must then be constant"));
}
