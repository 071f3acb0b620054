/// Numbers of a scene as parameters: found by path, with unit and range, and read anew with other values.
#include "app/scene/family.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "analysis/planes/map.hpp"
#include "analysis/planes/structure_map.hpp"
#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "tests/app/folder.hpp"
#include "tests/app/scene_of.hpp"

using namespace rosin;
using Catch::Matchers::Contains;

namespace {

const std::string two_modes = R"([law]
type = 'coulomb'
mu_s = 0.6
mu_d = 0.4
[oscillator]
type = 'structure'
M = [[1, 0], [0, 1]]
K = [[2, 1], [1, 2]]
force = [{ mean = 0, harmonics = [{ amplitude = 1, angular_frequency = 0.7 }, { amplitude = 0.1, angular_frequency = 1.4 }] }, 0]
contacts = [{ tangential = [1, 0] }, { tangential = [0, 1], normal_load = '3 kN', law = { type = 'coulomb', mu_s = 0.2, mu_d = 0.1 } }]
[drive]
speed = 1
normal_load = 2
[map]
x = { parameter = 'oscillator.K.1.2', from = 0.1, to = 0.9, points = 3, scale = 'linear' }
y = { parameter = 'contacts.2.law.mu_d', from = 0.05, to = 0.15, points = 2 }
)";

app::scene::Scene read(const std::string& text, const std::string& verb,
                       const std::vector<std::string>& overrides = {}) {
  const tests::Folder folder;
  const auto path = folder.path / "scene.toml";
  std::ofstream(path) << text;
  return tests::scene_of(path.string(), overrides, verb);
}

std::string refusal(const std::string& text, const std::string& verb, const std::vector<std::string>& overrides) {
  try {
    read(text, verb, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("every number of a scene is a parameter: entries of matrices, of contacts, and of harmonics") {
  const auto scene = read(two_modes, "map");
  REQUIRE(scene.family);
  const auto& family = *scene.family;
  CHECK(family.describe("oscillator.K.1.2").unit == "N/m");
  CHECK(family.describe("contacts.2.normal_load").unit == "N");
  CHECK(family.describe("law.mu_d").range.high == 10);
  CHECK(family.describe("oscillator.force.1.angular_frequency").unit == "rad/s");
  CHECK(family.with({{"oscillator.K.2.1", 0.25}}).structure.K(1, 0) == 0.25);
  CHECK(family.with({{"oscillator.contacts.2.normal_load", 5}}).structure.contacts[1].normal_load.level() == 5);
  CHECK(family.with({{"drive.normal_load", 7}}).structure.contacts[0].normal_load.level() == 7);
  const auto changed = family.with({{"oscillator.force.1.harmonics.2.amplitude", 0.5}, {"law.mu_s", 0.9}}).structure;
  CHECK(changed.force[0].piece(0).terms[1].amplitude == 0.5);
  CHECK(changed.force[0].piece(0).terms[0].amplitude == 1);
  CHECK(changed.contacts[0].law->static_limit(1) == 0.9);
  CHECK(changed.contacts[1].law->static_limit(1) == 0.2);
  CHECK_THROWS_WITH(family.describe("law.mud"),
                    Contains("no number of this scene") && Contains("did you mean 'law.mu'?"));
  CHECK_THROWS_WITH(family.describe("contacts.3.normal_load"), Contains("list of 2"));
  CHECK_THROWS_WITH(family.with({{"law.mu_d", 11}}), Contains("outside 0 … 10"));
}

TEST_CASE("a slider under a drive that varies has planes over the drive's frequency and amplitude") {
  const std::string slider = R"([law]
type = 'coulomb'
mu_s = 0.3
mu_d = 0.3
[oscillator]
mass = 1
stiffness = 1
[drive]
speed = 0
normal_load = 1
force = { mean = 0, harmonics = [{ amplitude = 1, angular_frequency = 0.7 }] }
[map]
x = { parameter = 'drive.force.angular_frequency', from = 0.7, to = 0.8, points = 2, scale = 'linear' }
y = { parameter = 'drive.force.amplitude', from = 0.1, to = 1, points = 2 }
metrics = ['displacement_max', 'stick_fraction', 'largest_multiplier']
)";
  const auto scene = read(slider, "map");
  const auto metrics = analysis::planes::metrics_of_structure(
      scene.structure->structure, scene.task<rosin::analysis::planes::MapOptions>().metrics);
  const auto map = analysis::planes::compute_structure_map(
      [&](double x, double y) {
        return scene.family->with({{scene.task<rosin::analysis::planes::MapOptions>().x.parameter, x},
                                   {scene.task<rosin::analysis::planes::MapOptions>().y.parameter, y}});
      },
      scene.task<rosin::analysis::planes::MapOptions>(), metrics);
  REQUIRE(map.points.size() == 4);
  CHECK(map.integrated == 4);
  // A force below friction leaves the block where it is; Den Hartog's amplitudes above it.
  CHECK(metrics[0].value(map.points[0]) == 0);
  CHECK(metrics[1].value(map.points[0]) == Approx(1));
  CHECK(metrics[0].value(map.points[2]) == Approx(1.88569985).epsilon(1e-8));
  CHECK(metrics[0].value(map.points[3]) == Approx(2.62610487572348).epsilon(1e-8));
  CHECK(metrics[2].value(map.points[3]) == Approx(0.69707788).epsilon(1e-5));
  CHECK(metrics[0].error(map.points[3]) < 1e-6);
  CHECK(refusal(slider, "map", {"map.metrics=['displacement_maxi']"}).find("displacement_max") != std::string::npos);
  CHECK(read(slider, "map", {"map.stick_threshold=0.2"}).task<analysis::planes::MapOptions>().stick_threshold == 0.2);
  CHECK(read(slider, "cycle", {"cycle.stick_threshold=0.2"}).task<analysis::cycles::CycleOptions>().stick_threshold ==
        0.2);
  CHECK(refusal(slider, "map", {"map.x.parameter=drive.force.frequencies"}).find("no number of this scene") !=
        std::string::npos);
  CHECK(refusal(slider, "map", {"oscillator.mass=0"}).find("mass") != std::string::npos);
}

TEST_CASE("overrides reach into lists, whose entries are numbered from 1") {
  CHECK(read(two_modes, "stability", {"oscillator.K.1.2=0.5"}).structure->structure.K(0, 1) == 0.5);
  CHECK(refusal(two_modes, "stability", {"oscillator.K.0.2=0.5"}).find("a number from 1, not '0'") !=
        std::string::npos);
  CHECK(refusal(two_modes, "stability", {"oscillator.K.1.x=0.5"}).find("list of 2") != std::string::npos);
}

TEST_CASE("paths of parameters are those of overrides too", "[app]") {
  const std::string forced = R"([law]
type = 'coulomb'
mu = 0.3
[oscillator]
mass = 1
stiffness = 1
[drive]
speed = 1
normal_load = 2
force = { mean = 0, harmonics = [{ amplitude = 1, angular_frequency = 0.7 }] }
[run]
duration = 1
start = 'rest'
)";
  const auto amplitude = [&](const std::string& change) {
    return read(forced, "run", {change}).model.drive.force.piece(0).terms.at(0).amplitude;
  };
  CHECK(amplitude("drive.force.amplitude=0.25") == 0.25);
  CHECK(amplitude("drive.force.harmonics.1.amplitude=0.25") == 0.25);
  CHECK_THAT(refusal(two_modes, "map", {"contacts.2.law.mu_d=-1"}), Contains("mu_d = -1"));
}
