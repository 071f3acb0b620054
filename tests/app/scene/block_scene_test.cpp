/// Elastic blocks in scenes: what is read, and the refusals with their places.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "analysis/motion/run.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "oscillators/block.hpp"
#include "tests/app/scene_of.hpp"

using rosin::app::scene::Scene;

namespace {

constexpr const char* smoothing = "smoothing = { type = 'parabolic', width = 1e-3 }\n";

Scene read(const std::string& keys, const std::string& solver, const std::string& verb = "run",
           const std::string& more = "") {
  const auto path = std::filesystem::temp_directory_path() / ("rosin-block-" + std::to_string(getpid()) + ".toml");
  std::ofstream(path, std::ios::binary)
      << "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'block'\nlength = '80 mm'\nheight = '40 mm'\nthickness = "
         "0.02\nyoungs_modulus = 206e9\npoisson_ratio = 0.3\ndensity = 7850\nspring_stiffness = 1e6\nnormal_contact = "
         "{ coefficient = 1e17, exponent = 2 }\n"
      << keys << "\n[drive]\nspeed = 1\nnormal_load = 32\n[run]\nduration = 1\nstart = { tilt = 1e-6 }\n[solver]\n"
      << solver << "\n"
      << more;
  struct Removed {
    std::filesystem::path path;
    ~Removed() { std::filesystem::remove(path); }
  } on_exit{path};
  return rosin::tests::scene_of(path.string(), {}, verb);
}
const std::string steps = std::string("scheme = 'average-acceleration'\nstep = 1e-6\n") + smoothing;

}  // namespace

TEST_CASE("a scene's block is a mesh whose stations share the weight", "[block]") {
  const auto scene = read("elements = [3, 2]\nmass_matrix = 'lumped'\nstiffness_damping = 5e-8", steps);
  REQUIRE(scene.block);
  CHECK(scene.block->block.elements == std::array{3, 2});
  CHECK(scene.block->block.length == 0.08);
  const auto& structure = scene.structure->structure;
  CHECK(structure.size() == 2 * 7 * 5);
  CHECK(structure.M.isDiagonal(0));
  CHECK(structure.contacts.size() == 9);
  double load = 0;
  for (const auto& contact : structure.contacts) load += contact.load_factor * contact.normal_load.level();
  CHECK(load == Approx(32).epsilon(1e-13));
  CHECK(structure.names.front() == "x_1_1");
  CHECK(structure.names.back() == "y_7_5");
  CHECK((structure.C - 5e-8 * Eigen::MatrixXd(scene.block->K)).norm() < 1e-12 * structure.C.norm());
  REQUIRE(scene.task<rosin::analysis::motion::RunOptions>().stepping);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().stepping->step == 1e-6);
  CHECK(scene.task<rosin::analysis::motion::RunOptions>().stepping->stick_width == 1e-3);
  CHECK(scene.block->tilt.dot(scene.structure->start.beside) == Approx(1e-6).epsilon(1e-12));
}

TEST_CASE("scenes of blocks are refused with what is missing or cannot be", "[block]") {
  using Catch::Contains;
  CHECK_THROWS_WITH(read("", ""), Contains("scheme = \"average-acceleration\""));
  CHECK_THROWS_WITH(read("", "scheme = 'newmark'\nstep = 1"), Contains("solver.scheme = 'newmark' is not known"));
  CHECK_THROWS_WITH(read("", "scheme = 'explicit'"), Contains("[solver] has no 'step'"));
  CHECK_THROWS_WITH(read("", "scheme = 'explicit'\nstep = 1e-6"), Contains("solver.smoothing"));
  CHECK_THROWS_WITH(read("", steps + "spectral_radius = 0.5"), Contains("only for generalised-alpha"));
  CHECK_THROWS_WITH(read("", steps + "type = 'events'"), Contains("not both"));
  CHECK_THROWS_WITH(read("elements = [4]", steps), Contains("oscillator.elements is a pair"));
  CHECK_THROWS_WITH(read("elements = [4, 40]", steps), Contains("outside 1 … 16"));
  CHECK_THROWS_WITH(read("mass_matrix = 'diagonal'", steps), Contains("oscillator.mass_matrix = 'diagonal'"));
  CHECK_THROWS_WITH(read("mass = 2", steps), Contains("mass") && Contains("mass_matrix"));
  CHECK_THROWS_WITH(read("", "", "cycle"), Contains("scheme = \"average-acceleration\""));
  const std::string branch = "[branch]\nparameter = 'law.mu_d'\nfrom = 0.1\nto = 0.2\n";
  CHECK_THROWS_WITH(read("", steps, "branch", branch + "start = 'cycle'\n"),
                    Contains("'sweep' follows them along a parameter"));
}

TEST_CASE("numbers of a block are varied with the smoothing of its friction kept", "[block]") {
  const auto scene = read("", steps, "stability", "[stability]\nscan = { parameter = 'law.mu_d', from = 0, to = 1 }\n");
  REQUIRE(scene.family);
  const auto varied = scene.family->with({{"oscillator.density", 8000}}).structure;
  CHECK(varied.M.sum() / scene.structure->structure.M.sum() == Approx(8000 / 7850.0));
  CHECK_FALSE(varied.contacts.front().law->set_valued());
}

TEST_CASE("a block with modes is a structure of its face and these, and says which", "[block]") {
  using Catch::Contains;
  const auto scene = read("elements = [3, 2]\nmodes = 5", steps);
  CHECK_FALSE(scene.block);
  REQUIRE(rosin::app::scene::reduced_block_of(scene));
  const auto& structure = scene.structure->structure;
  CHECK(structure.size() == 2 * 7 + 5 + 1);
  CHECK(structure.names.back() == "sinking");
  CHECK(structure.contacts.size() == 9);
  CHECK(structure.contacts.back().normal_load.level() == 32);
  CHECK(structure.functionals.back().row.dot(scene.structure->start.beside) == Approx(1e-6).epsilon(1e-3));
  const auto note =
      std::ranges::find_if(scene.notes, [](const auto& text) { return text.starts_with("oscillator.modes"); });
  REQUIRE(note != scene.notes.end());
  CHECK_THAT(*note, Contains("14 coordinates of its lower face and 5 of the 56 modes"));
  CHECK_THAT(*note, Contains("Hz; the next has") && Contains("of those of the mesh, relative"));
  CHECK_THROWS_WITH(read("elements = [3, 2]\nmodes = -1", steps), Contains("oscillator.modes") && Contains("0 … 56"));
  CHECK_THROWS_WITH(read("elements = [3, 2]\nmodes = 57", steps), Contains("oscillator.modes") && Contains("0 … 56"));
  CHECK_THROWS_WITH(read("elements = [3, 2]\nmodes = 1.5", steps), Contains("oscillator.modes"));
}
