/// End stops in scenes: of sliders and structures, and the refusals with their places.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "tests/app/scene_of.hpp"

using rosin::app::scene::Scene;

namespace {

/// \param keys  of the oscillator
Scene read(const std::string& keys, const std::string& verb = "run", const std::string& start = "displacement = 0") {
  const auto path = std::filesystem::temp_directory_path() / ("rosin-stops-" + std::to_string(getpid()) + ".toml");
  std::ofstream(path, std::ios::binary) << "[law]\ntype = 'coulomb'\n[oscillator]\n"
                                        << keys
                                        << "\n[drive]\nspeed = 0\nnormal_load = 1\n[run]\nduration = 1\nstart = { "
                                        << start << " }\n";
  struct Removed {
    std::filesystem::path path;
    ~Removed() { std::filesystem::remove(path); }
  } on_exit{path};
  return rosin::tests::scene_of(path.string(), {}, verb);
}

std::string slider(const std::string& stops) { return "mass = 1\nstiffness = 1\n" + stops; }
std::string two(const std::string& stops) {
  return "type = 'structure'\nM = [[1, 0], [0, 2]]\nK = [[1, 0], [0, 1]]\ncontacts = [{ tangential = [1, 0] }]\n" +
         stops;
}

}  // namespace

TEST_CASE("a slider with stops is a structure of one coordinate", "[stops]") {
  CHECK(!read(slider("")).structure);
  const auto pair = read(slider("stops = ['-5 mm', 0.5]\nrestitution = 0.2"));
  REQUIRE(pair.structure);
  const auto& stops = pair.structure->structure.stops;
  REQUIRE(stops.size() == 2);
  CHECK(stops[0].at == -0.005);
  CHECK(stops[0].side == -1);
  CHECK(stops[1].at == 0.5);
  CHECK(stops[1].side == 1);
  CHECK(stops[1].restitution == 0.2);
  CHECK(read(slider("stops = [-1, 1]")).structure->structure.stops[0].restitution == 0);
  const auto spring = read(slider("stops = [{ at = -0.1, stiffness = 100, damping = 2 }]"));
  const auto& stop = spring.structure->structure.stops.front();
  CHECK(stop.side == -1);
  CHECK(stop.stiffness == 100);
  CHECK(stop.damping == 2);
}

TEST_CASE("of two stops of a coordinate the higher is the upper one", "[stops]") {
  const auto scene = read(two("stops = [{ coordinate = 2, at = 0.5 }, { coordinate = 2, at = 0.1, stiffness = 3 }, "
                              "{ coordinate = 1, at = 0, side = 'lower', restitution = 1 }]"),
                          "cycle");
  const auto& stops = scene.structure->structure.stops;
  REQUIRE(stops.size() == 3);
  CHECK(stops[0].coordinate == 1);
  CHECK(stops[0].side == 1);
  CHECK(stops[1].side == -1);
  CHECK(stops[2].side == -1);
  CHECK(stops[2].restitution == 1);
}

TEST_CASE("wrong stops are refused with their place", "[stops]") {
  using Catch::Contains;
  struct Case {
    std::string keys, what, verb = "run";
  };
  for (const auto& [keys, what, verb] : std::vector<Case>{
           {slider("stops = [0.5, -0.5]"), ":6:9: stops 1 and 2 leave coordinate 1 no room"},
           {slider("stops = [0.5]"), ":6:9: oscillator.stops has 1 entries, but 2 are needed, low and high (m)"},
           {slider("stops = [-1, 1]\nrestitution = 1.5"), ":7:15: oscillator.restitution = 1.5"},
           {slider("restitution = 0.5"), ":6:15: oscillator.restitution goes with stops = [low, high] (m)"},
           {slider("stops = [{ at = 0 }]"), "oscillator.stops.1 stands at 0: say side"},
           {slider("stops = [{ at = 1, restitution = 0.5, stiffness = 3 }]"),
            "oscillator.stops.1.stiffness: give restitution (a rigid stop) or stiffness"},
           {slider("stops = [{ at = 1, damping = 3 }]"), "oscillator.stops.1.damping has no effect on a rigid stop"},
           {slider("stops = [{ at = 1, side = 'uper' }]"), "did you mean 'upper'?"},
           {slider("stops = [{ restitution = 1 }]"), "[oscillator.stops.1] has no 'at' (place of the stop, m)"},
           {slider("stops = [-1, 1]"),
            ":6:9: oscillator.stops serve run, cycle, sweep, branch, lyapunov, basin only, not 'stability'",
            "stability"},
           {two("stops = [{ at = 1 }]"), "[oscillator.stops.1] has no 'coordinate'"},
           {two("stops = [{ coordinate = 3, at = 1 }]"), "oscillator.stops.1.coordinate = 3 is outside 1 … 2"},
           {"type = 'structure'\nM = [[2, 0.5], [0.5, 1]]\nK = [[1, 0], [0, 1]]\ncontacts = []\nstops = [{ coordinate "
            "= 1, "
            "at = 1 }]",
            ":8:9: stop 1: a rigid stop needs a mass matrix M that is diagonal"}}) {
    INFO(keys);
    CHECK_THROWS_WITH(read(keys, verb), Contains(what));
  }
}
