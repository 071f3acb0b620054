/// Starts of structures: states of contacts by the names of columns.
#include <catch2/catch.hpp>
#include <fstream>

#include "tests/app/folder.hpp"
#include "tests/app/scene_of.hpp"

using Catch::Matchers::Contains;
using namespace rosin;
using namespace rosin::tests;

namespace {

void write_scene(const Folder& folder, const std::string& matrices, const std::string& contacts,
                 const std::string& start) {
  std::ofstream(folder.path / "scene.toml")
      << "[law]\ntype = \"ageing\"\n[oscillator]\ntype = \"structure\"\n"
      << matrices << contacts << "[drive]\nspeed = 0.1\nnormal_load = 8\n[run]\nduration = 30\nstart = " << start
      << '\n';
}

double first_state(const Folder& folder, int contact) {
  const auto scene = scene_of((folder.path / "scene.toml").string(), {}, "run");
  const oscillators::StructureSystem system(scene.structure->structure);
  const auto y = analysis::motion::starting_point(system, scene.structure->start);
  return system.states(contact, 0, y.data())[0];
}

}  // namespace

TEST_CASE("a structure starts with states of its contacts, by column or as state", "[app]") {
  const Folder folder;
  const std::string one = "M = [[1.1]]\nK = [[1.3]]\n", contact = "[[oscillator.contacts]]\ntangential = [1]\n";
  for (const char* state : {"theta = 2", "state = 2", "state = { theta = 2 }"}) {
    write_scene(folder, one, contact, std::string("{ coordinates = [0.2], velocities = [0], ") + state + " }");
    CHECK(first_state(folder, 0) == Approx(2));
  }
  write_scene(folder, one, contact, "{ displacement = 0.2, velocity = 0.05, theta = 3 }");
  CHECK(first_state(folder, 0) == Approx(3));
  write_scene(folder, "M = [[1, 0], [0, 1]]\nK = [[2, 0], [0, 2]]\n",
              "[[oscillator.contacts]]\ntangential = [1, 0]\n[[oscillator.contacts]]\ntangential = [0, 1]\n",
              "{ coordinates = [0, 0], theta_2 = 5 }");
  CHECK(first_state(folder, 1) == Approx(5));
  CHECK(first_state(folder, 0) == Approx(1e-5 / 0.1));  // steady at the slip rate
  write_scene(folder, one, contact, "{ coordinates = [0.2], thet = 2 }");
  CHECK_THROWS_WITH(scene_of((folder.path / "scene.toml").string(), {}, "run"), Contains("thet"));
}
