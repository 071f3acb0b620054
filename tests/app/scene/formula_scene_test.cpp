/// Laws from text in scenes: the same cycles and planes as the compiled law, and refusals with line and column.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "analysis/cycles/cycle.hpp"
#include "analysis/planes/map.hpp"
#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "laws/catalogue.hpp"
#include "tests/app/scene_of.hpp"

using namespace rosin;
using app::scene::Scene;
using rosin::tests::scene_of;

namespace {

const std::string example = ROSIN_SOURCE_DIR "/examples/formula-law.toml";

Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const auto file = std::filesystem::temp_directory_path() / ("rosin-formula-" + std::to_string(getpid()) + ".toml");
  std::ofstream(file, std::ios::binary) << text;
  struct Remove {
    std::filesystem::path file;
    ~Remove() { std::filesystem::remove(file); }
  } on_exit{file};
  return scene_of(file, overrides, "curve");
}

/// What is said from the line on.
std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read(text, overrides);
  } catch (const InputError& error) {
    const std::string what = error.what();
    const auto file = what.find(".toml:");
    return file == std::string::npos ? what : what.substr(file + 6);
  }
  return "accepted";
}

const std::string viscous =
    "[law]\n"
    "type = 'formula'\n"
    "[law.formula]\n"
    "parameters = { eta = { default = '3 s/m', unit = 's/m' } }\n";

}  // namespace

TEST_CASE("a cycle under a law from text is that under the compiled law", "[formula]") {
  const std::vector<std::string> none;
  auto scene = scene_of(example, none, "cycle");
  auto model = scene.model;
  const auto text = analysis::cycles::find_cycle(model, scene.task<rosin::analysis::cycles::CycleOptions>());
  model.law = laws::find_law("spinodal");
  const auto compiled = analysis::cycles::find_cycle(model, scene.task<rosin::analysis::cycles::CycleOptions>());
  REQUIRE(text.outcome.complete());
  for (const auto& metric : analysis::cycles::metric_names())
    CHECK(text.metrics.*metric.member == Approx(compiled.metrics.*metric.member).epsilon(1e-9));
}

TEST_CASE("a plane under a law from text, through lanes, is that under the compiled law", "[formula]") {
  const std::vector<std::string> coarse = {"map.x.points=6", "map.y.points=5", "law.mu0=0.4"};
  auto scene = scene_of(example, coarse, "map");
  const auto text = analysis::planes::compute_map(scene.model, scene.task<rosin::analysis::planes::MapOptions>());
  auto model = scene.model;
  model.law = laws::find_law("spinodal")->with("mu0", 0.4);
  const auto compiled = analysis::planes::compute_map(model, scene.task<rosin::analysis::planes::MapOptions>());
  REQUIRE(text.points.size() == compiled.points.size());
  CHECK(text.integrated > 10);
  CHECK(text.integrated == compiled.integrated);
  for (std::size_t i = 0; i < text.points.size(); ++i) {
    const auto &a = text.points[i], &b = compiled.points[i];
    CHECK(a.regime == b.regime);
    if (a.regime != analysis::planes::Regime::cycle) continue;
    for (const auto& name : scene.task<rosin::analysis::planes::MapOptions>().metrics) {
      const auto member = analysis::cycles::find_metric(name).member;
      CHECK(std::abs(a.metrics.*member - b.metrics.*member) <= a.error.*member + b.error.*member);
    }
  }
}

TEST_CASE("a law without states and without a limit at rest is a smooth curve", "[formula]") {
  const auto scene = read(viscous + "friction = 'tanh(eta*v)'\n", {"law.eta=2 s/mm"});
  CHECK(scene.model.law->steady_friction({1e-3, 1}).friction == Approx(std::tanh(2)).epsilon(1e-14));
  CHECK(scene.model.law->parameter("eta") == 2000);
  CHECK_FALSE(scene.model.law->set_valued());
}

TEST_CASE("errors in laws from text stand at line and column of the token", "[formula]") {
  const struct {
    std::string rest;
    const char* message;
  } cases[] = {
      {"friction = 'eta*v*etta'", "5:19: law.formula.friction: unknown name 'etta'; did you mean 'eta'?"},
      {"friction = \"eta*v + v\"", "5:21: law.formula.friction: 'eta*v' (dimensionless) and 'v' (m/s) cannot be added"},
      {"friction = \"\"\"\neta*v*etta\"\"\"",
       "5:12: law.formula.friction: unknown name 'etta'; did you mean 'eta'? (character 7 of the text)"},
      {"friction = 'v'", "5:12: law.formula.friction: must be dimensionless, but is in m/s"},
      {"friction = 'eta*v'\ndefine = { A = 'B', B = 'A' }",
       "law.formula.define.A: 'A' is defined by itself: A → B → A"},
      {"friction = 3", "5:12: law.formula.friction is a number, but a text is needed"},
      {"fricton = 'eta*v'", "5:1: unknown key 'fricton' in [law.formula]; did you mean 'friction'?"},
      {"friction = 'eta*v'\nrate = { psi = 'v' }", "unknown key 'psi' in [law.formula.rate]"},
      {"friction = 'eta*v'\nstates = { psi = { unit = 'm' } }", "there is no rate of state 'psi'"},
      {"friction = 'eta*v'\nstates = { time = { unit = 's' } }", "'time' has another meaning in scenes"},
      {"friction = 'eta*v'\nstates = { psi = { scale = 'lug' } }", "law.formula.states.psi.scale = 'lug' is not known"},
      {"friction = 'eta*v'\n[law.formula.parameters.lambda]\ndefault = 1", "'lambda' has another meaning in scenes"},
      {"friction = 'eta*v'\n[law.formula.parameters.k]\nunit = '1'", "[law.formula.parameters.k] has no 'default'"},
      {"friction = 'eta*v'\n[law.formula.parameters.k]\ndefault = 2\nmaximum = 1", "default = 2 is outside"},
      {"friction = 'eta*v'\n[law.formula.parameters.k]\ndefault = '2 m'", "needed is dimensionless"},
  };
  for (const auto& c : cases) {
    INFO(c.rest);
    auto text = viscous + c.rest + "\n";
    if (const auto table = text.find("[law.formula.parameters"); table != std::string::npos)
      text.replace(text.find("parameters = "), text.find("friction") - text.find("parameters = "),
                   "\n");  // a table cannot be written in both ways
    if (text.find("eta = ") == std::string::npos) text += "[law.formula.parameters.eta]\ndefault = 1\nunit = 's/m'\n";
    CHECK_THAT(refusal(text), Catch::Contains(c.message));
  }
  CHECK_THAT(refusal(viscous + "friction = 'eta*v'\n", {"law.formula.friction=eta*w"}),
             Catch::Contains("--set law.formula.friction=eta*w: law.formula.friction: unknown name 'w'") &&
                 Catch::Contains("(character 5 of the text)"));
  CHECK_THAT(refusal("[law]\ntype = 'formula'\n"), Catch::Contains("[law] has no 'formula'"));
  CHECK_THAT(refusal("[law]\ntype = 'coulomb'\n[law.formula]\nfriction = '1'\n"),
             Catch::Contains("unknown table 'formula' in [law]"));
}
