/// Scenes from inputs of other programs, against the numbers of those programs.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "app/imports/format.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/verbs.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin;
using namespace rosin::app;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

namespace {

const std::string examples = ROSIN_SOURCE_DIR "/examples/import/";

std::string text_of(const std::string& name) { return read_whole(examples + name, 1'000'000); }

scene::Scene scene_from(const std::string& name, const std::string& text, const std::string& format = {}) {
  Request request;
  request.verb = "run";
  request.target = "scene";
  request.text = imports::format_of(format, name, text).translate(name, text).text();
  return verbs::read_scene(request);
}
scene::Scene scene_of_example(const std::string& name) { return scene_from(name, text_of(name)); }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

}  // namespace

TEST_CASE("a script of rsfmodel gives the friction that rsfmodel stores", "[imports]") {
  // Leeman, May & Marone (2016), tests/rsf_tests.py, TestDeiterichOneStateVar: at 11, 13 and 40 s
  auto scene = scene_of_example("velocity-step.py");
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().samples == 4000);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().duration == 40);
  scene.task<rosin::analysis::motion::RunOptions>().tolerance = 1e-10;
  const auto run = analysis::motion::run(scene.model, scene.task<rosin::analysis::motion::RunOptions>());
  REQUIRE(run.outcome.complete());
  const auto column = std::ranges::find(run.column_names, "friction_coefficient") - run.column_names.begin();
  const auto& friction = run.columns[static_cast<std::size_t>(column)];
  CHECK(run.time[1100] == Approx(11).epsilon(1e-14));
  CHECK(std::abs(friction[1000] - 0.6) < 1e-8);
  CHECK(std::abs(friction[1100] - 0.60720485) < 1e-8);
  CHECK(std::abs(friction[1300] - 0.58400910) < 1e-8);
  CHECK(std::abs(friction[4000] - 0.58848708) < 1e-8);
}

TEST_CASE("three inputs of QDYN are one spring-slider", "[imports]") {
  for (const char* name : {"stick-slip-qdyn.py", "stick-slip-qdyn.m", "qdyn.in"}) {
    INFO(name);
    const auto scene = scene_of_example(name);
    CHECK(scene.model.slider.mass == 0);
    CHECK(scene.model.slider.stiffness == 2e9);  // Pa/m: 20 GPa/10 m
    CHECK(scene.model.slider.damping == Approx(1e10 / 3e3).epsilon(1e-15));
    CHECK(scene.model.drive.normal_load.level() == 5e6);
    CHECK(scene.model.drive.speed.level() == 1e-6);
    CHECK(scene.model.law->card().name == "ageing");
    CHECK(scene.task<rosin::analysis::motion::RunOptions>().duration == 1e4);
    CHECK(*scene.task<rosin::analysis::motion::RunOptions>().start.slip_rate == Approx(1.01e-6).epsilon(1e-15));
    CHECK(scene.task<rosin::analysis::motion::RunOptions>().start.states.at("theta") == Approx(10).epsilon(1e-15));
  }
}

TEST_CASE("a run of QDYN's spring-slider slips every 585.4839 s", "[imports]") {
  // ydluo/qdyn, test/stickslip, stored series: 585.4839178 s, the mean of 16 intervals of 17 events. Samples lie 0.01 s
  // apart where slip begins, which is at the passage of the load point's velocity upwards.
  constexpr double recurrence = 585.4839178, first = 625.74;
  auto scene = scene_of_example("qdyn.in");
  scene.task<rosin::analysis::motion::RunOptions>().tolerance = 1e-9;
  scene.task<rosin::analysis::motion::RunOptions>().times.clear();
  for (int event = 0; event < 17; ++event)
    for (int i = -50; i <= 50; ++i)
      scene.task<rosin::analysis::motion::RunOptions>().times.push_back(first + event * recurrence + 0.01 * i);
  const auto run = analysis::motion::run(scene.model, scene.task<rosin::analysis::motion::RunOptions>());
  const auto column = std::ranges::find(run.column_names, "slip_rate") - run.column_names.begin();
  const auto& v = run.columns[static_cast<std::size_t>(column)];
  std::vector<double> onsets;
  for (std::size_t i = 1; i < v.size(); ++i)
    if (v[i - 1] < 1e-6 && v[i] >= 1e-6)
      onsets.push_back(run.time[i - 1] + 0.01 * (1e-6 - v[i - 1]) / (v[i] - v[i - 1]));
  REQUIRE(onsets.size() == 17);
  CHECK(std::abs((onsets.back() - onsets.front()) / 16 - recurrence) < 2e-5);
}

TEST_CASE("the cycle of QDYN's spring-slider has its recurrence to the last digit", "[imports]") {
  auto scene = scene_of_example("stick-slip-qdyn.py");
  scene.task<rosin::analysis::cycles::CycleOptions>().tolerance = 1e-10;
  const auto cycle = analysis::cycles::find_cycle(scene.model, scene.task<rosin::analysis::cycles::CycleOptions>());
  REQUIRE(cycle.outcome.complete());
  CHECK(std::abs(cycle.metrics.period - 585.4839178) < 1e-7);
}

TEST_CASE("cycles of EQcycle's blocks have the recurrence of its equations", "[imports]") {
  // Bolotskaya's RS and SW parameters: by scipy's Radau at 1e-12, and in closed form (cases/fault-cycles)
  auto ageing = scene_of_example("earthquake-cycle.m");
  CHECK(ageing.task<rosin::analysis::motion::RunOptions>().start.states.at("theta") ==
        Approx(13 * 0.09 / 1e-3).epsilon(1e-14));
  ageing.task<rosin::analysis::cycles::CycleOptions>().tolerance = 1e-9;
  CHECK(std::abs(analysis::cycles::find_cycle(ageing.model, ageing.task<rosin::analysis::cycles::CycleOptions>())
                     .metrics.period -
                 3778.0755394) < 1e-5);
  auto weakening = scene_of_example("slip-weakening.m");
  CHECK(*weakening.task<rosin::analysis::motion::RunOptions>().start.displacement == Approx(0.7 * 20).epsilon(1e-14));
  weakening.task<rosin::analysis::cycles::CycleOptions>().tolerance = 1e-9;
  CHECK(std::abs(analysis::cycles::find_cycle(weakening.model, weakening.task<rosin::analysis::cycles::CycleOptions>())
                     .metrics.period -
                 3539.02101885) < 1e-5);
}

TEST_CASE("oscillating shear stress of QDYN is a force against the slider", "[imports]") {
  // tau = K (V_PL t - slip) + APER sin(2 pi t/TPER): at t = TPER/4 the force along x is -APER
  const auto text = replaced(text_of("qdyn.in"), "31536000 0 ", "100 2000 ");
  const auto scene = scene_from("qdyn.in", text);
  CHECK(scene.model.drive.force.value(25) == Approx(-2000));
  CHECK(std::abs(scene.model.drive.force.value(0)) < 1e-9);
}

TEST_CASE("older and newer releases of qdyn.in are told apart by their lines", "[imports]") {
  const std::string
      before = "0 meshdim\n1 NN\n10 1 L, W\n1 itheta_law\n2 i_rns_law\n0 i_sigma_cpl\n",
      after = "100 0 Tper, Aper\n1d-6 0 1D4 1e-10 dt_try, dtmax, tmax, acc\n0 nstop\n0 0 x\n1e18 1e-3 1e-4 y\n",
      node = "5e6 1e-6 10 0.01 0.025 1e-5 0.01 1e-7 0.6 2e-6 0 0";
  const std::string oldest =
      before + "2 n_equations\n1 1 1 1 0 0 out\n3000 2e10 3e10 1e-5 elastic\n" + after + node + "\n";
  const std::string newest = before + "0 restart\n0 restart time\n1 faults\n0 0 0 features\n1 1 1 1 1 1 1 0 0 out\n" +
                             "3000 2e10 3e10 0 0 0.01 elastic\n" + after + "1 2 type\n" + node +
                             " 0 3e-6\n0 0 0 90 1 0\n";
  const auto old = scene_from("qdyn.in", oldest), recent = scene_from("qdyn.in", newest);
  CHECK(old.model.drive.speed.level() == 2e-6);  // of V_SS
  CHECK(recent.model.drive.speed.level() == 3e-6);
  for (const auto* scene : {&old, &recent}) {
    CHECK(scene->task<rosin::analysis::motion::RunOptions>().duration == 1e4);
    CHECK(scene->model.slider.stiffness == 2e9);
  }
}

TEST_CASE("what no scene has is refused with file, line, name and reason", "[imports]") {
  const auto python = text_of("velocity-step.py"), qdyn = text_of("stick-slip-qdyn.py");
  struct Case {
    std::string name, text;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases = {
      {"a.py",
       replaced(python, "model.k = 1e-3", "model.k = stiffness()"),
       {"a.py:8: 'model.k = stiffness()", "model.k"}},
      {"a.py", replaced(python, "model.k = 1e-3", "model.kk = 1e-3"), {"a.py:8:", "'kk'", "did you mean 'k'?"}},
      {"a.py", replaced(python, "model.a = 0.005", "model.b = 0.005"), {"a.py:7:", "'b'"}},
      {"a.py", replaced(python, "model.a = 0.005", "if 1 > 0:\n    model.a = 0.005"), {"a.py:7:", "condition"}},
      {"a.py", replaced(python, "lp_velocity[10 * rate :] = 10.0", "lp_velocity[ramp] = 10.0"), {"a.py:20:"}},
      {"a.py", replaced(python, "[state1]", "[state1, state1, state1]"), {"a.py:15:", "text"}},
      {"a.py",
       replaced(python, "model.solve()", "model.state_relations.append(state1)\nmodel.solve()"),
       {"a.py:23: 'model.state_relations.append(state1)' may change"}},
      {"a.py", replaced(python, "model.solve()", "lp_velocity[::2] = 3.0\nmodel.solve()"), {"a.py:23:", "1000 times"}},
      {"a.py",
       replaced(python, "model = rsf.Model()", "def f():\n    return rsf.Model()\nmodel = f()"),
       {"rsf.Model()"}},
      {"q.py", replaced(qdyn, "p.settings(settings)", "p.settings(load('x.json'))"), {"q.py:22:", "may change"}},
      {"q.py", replaced(qdyn, "p.write_input()", "p.set_dict['SIGMA'] = 7e6"), {"q.py:24:", "render_mesh", "line 23"}},
      {"q.py", replaced(qdyn, "\"MESHDIM\": 0", "\"MESHDIM\": 2"), {"q.py:6:", "MESHDIM = 2", "one slider"}},
      {"q.py", replaced(qdyn, "\"RSF\"", "\"CNS\""), {"q.py:7:", "Chen, Niemeijer and Spiers"}},
      {"q.py", replaced(qdyn, "\"RNS_LAW\": 0", "\"RNS_LAW\": 1"), {"q.py:17:", "RNS_LAW = 1", "V1"}},
      {"q.py", replaced(qdyn, "\"V_PL\"", "\"V_PLL\""), {"V_PL"}},
      {"qdyn.in", replaced(text_of("qdyn.in"), "0     meshdim", "1     meshdim"), {"qdyn.in:1:", "MESHDIM = 1"}},
      {"qdyn.in", replaced(text_of("qdyn.in"), "0.01 0.025", "0.01"), {"qdyn.in"}},
      {"e.m", replaced(text_of("slip-weakening.m"), "mu_d = 0.6", "mu_t = 0.6"), {"e.m:7:", "law from text"}},
      {"e.m",
       text_of("slip-weakening.m") + "% D_c is that of slip weakening #\ns_sh = 0.1;\n",
       {"e.m:13:", "cohesive zone"}}};
  for (const auto& [name, text, parts] : cases) {
    std::string said;
    try {
      scene_from(name, text);
    } catch (const InputError& error) {
      said = error.what();
    }
    for (const auto& part : parts) CHECK_THAT(said, Contains(part));
  }
}

TEST_CASE("settings that are copied keep their numbers", "[imports]") {
  const auto scene =
      scene_from("q.py", replaced(text_of("stick-slip-qdyn.py"), "p.settings(settings)",
                                  "import copy\nsettings = copy.deepcopy(settings)\np.settings(settings)"));
  CHECK(scene.model.drive.normal_load.level() == 5e6);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().duration == 1e4);
}

TEST_CASE("the command names the line of the source where a scene would be refused", "[app][imports]") {
  const Folder folder;
  const auto import = [&](const std::string& name, const std::string& text, const std::string& options = {}) {
    std::ofstream(folder.path / name) << text;
    return run_rosin(folder, "import " + name + options);
  };
  auto ran = import("a.py", replaced(text_of("velocity-step.py"), "model.a = 0.005", "model.a = 3"));
  CHECK(ran.status == 2);
  CHECK_THAT(ran.error, Contains("a.py:7: model.a = 3: law.a = 3 is outside 0.0001 … 0.5"));
  CHECK(ran.out.empty());
  ran = import("a.txt", "hello\n");
  CHECK(ran.status == 2);
  CHECK_THAT(ran.error, Contains("--as") && Contains("rsfmodel") && Contains("qdyn") && Contains("eqcycle"));
  ran = import("a.txt", "hello\n", " --as rsfmodl");
  CHECK_THAT(ran.error, Contains("did you mean 'rsfmodel'?"));
  CHECK(run_rosin(folder, "import missing.py").status == 2);
}

TEST_CASE("damaged inputs become a scene or are refused", "[imports]") {
  std::mt19937_64 random(1);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::vector<std::string> names = {"velocity-step.py", "stick-slip-qdyn.py", "stick-slip-qdyn.m",
                                          "qdyn.in",          "earthquake-cycle.m", "slip-weakening.m"};
  const std::vector<std::string> pieces = {"[",  ")",   "'",    "=",      "1e999", "-",     "nan",
                                           "\n", "**",  "%{\n", "\"\"\"", ":",     "model", "np.arange(0,1e9)",
                                           "\\", "...", "{",    "0",      "inf",   ","};
  int scenes = 0;
  for (int i = 0; i < 200; ++i) {
    const auto& name = names[below(names.size())];
    auto text = text_of(name);
    for (std::size_t change = 0, changes = 1 + below(3); change < changes && !text.empty(); ++change) {
      const auto at = below(text.size()), length = std::min(below(12), text.size() - at);
      switch (below(4)) {
        case 0:
          text.erase(at, length);
          break;
        case 1:
          text.insert(at, pieces[below(pieces.size())]);
          break;
        case 2:
          text[at] = static_cast<char>(below(256));
          break;
        default:
          text.insert(below(text.size()), text.substr(at, length));
      }
    }
    INFO(i << ": " << text);
    try {
      scene_from(name, text);
      ++scenes;
    } catch (const InputError&) {
    }
  }
  CHECK(scenes > 40);
}
