/// The verb lab on every type of oscillator with masses and springs of its own, and what it refuses.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

namespace rosin::tests::lab_machines {

using Catch::Contains;
using nlohmann::json;

namespace {

Printed asked(const Folder& folder, const std::string& experiment, const std::string& scene,
              const std::string& options = "") {
  std::ofstream(folder.path / "scene.toml") << scene;
  return run_rosin(folder, "lab " + experiment + " scene.toml --json --no-pictures --quiet --out out " + options);
}

const std::string rock = "[law]\ntype = 'ageing'\nmu0 = 0.6\na = 0.01\nb = 0.015\nL = 1e-5\nv0 = 1e-6\n",
                  drive = "\n[drive]\nspeed = 1e-5\nnormal_load = 1\n",
                  two_masses =
                      "[oscillator]\ntype = 'two-mass-belt'\nmass = 1\nstiffness = 1e4\ndamping = 100\n"
                      "second_mass = 0.5\nsecond_stiffness = 3e4\nsecond_damping = 100\n";

}  // namespace

TEST_CASE("lab: velocity steps on every type of machine with springs of its own read the law's rate dependence",
          "[lab-machine]") {
  const Folder folder;
  for (const std::string oscillator :
       {two_masses,
        std::string("[oscillator]\ntype = 'chain'\nblocks = 2\nmass = 1\nstiffness = 1e4\ndamping = 10\n"
                    "pull_stiffness = 1e4\npull_damping = 100\n"),
        std::string("[oscillator]\ntype = 'structure'\nM = [[1, 0], [0, 2]]\nK = [[2e4, -1e4], [-1e4, 4e4]]\n"
                    "C = [[200, -50], [-50, 300]]\ncontacts = [{ tangential = [1, 0] }]\n"),
        std::string("[oscillator]\ntype = 'mode-coupling'\nmass = 1\ndamping = 100\nsprings = [{ stiffness = 1e4, "
                    "angle = 0.3 }, { stiffness = 2e4, angle = 2 }]\ncontact = { stiffness = 1e5 }\n")}) {
    INFO(oscillator);
    const auto answer = asked(folder, "velocity-step", rock + oscillator + drive);
    INFO(answer.error);
    REQUIRE(answer.status == 0);
    const auto document = json::parse(answer.out);
    const double value = document["readings"]["rate_dependence"], error = document["error"]["rate_dependence"];
    CHECK(std::abs(value + 0.005) <= error + 1e-12);
    CHECK(error < 1e-6);
    CHECK(document["columns"].contains("slip"));
  }
}

TEST_CASE("lab: what no experiment on a machine answers is refused with the reason", "[lab-machine]") {
  const Folder folder;
  const auto refused = [&](const std::string& experiment, const std::string& scene, const std::string& options = "") {
    const auto answer = asked(folder, experiment, scene, options);
    CHECK(answer.status == 2);
    return answer.error;
  };
  const auto machine = rock + two_masses + drive;
  CHECK_THAT(refused("inverse", machine), Contains("friction follows from the motion of one mass"));
  CHECK_THAT(refused("frequency-response", machine), Contains("rosin frf"));
  CHECK_THAT(refused("velocity-step", rock + two_masses), Contains("drive"));
  CHECK_THAT(refused("velocity-step",
                     rock +
                         "[oscillator]\ntype = 'structure'\nM = [[1]]\nK = [[1e4]]\ncontacts = [{ tangential = [1], "
                         "speed = 0.1 }]\n" +
                         drive),
             Contains("a speed of its own"));
  CHECK_THAT(refused("spring-pulled", machine,
                     "--set drive.speed='{ mean = 1, harmonics = [{ amplitude = 0.5, "
                     "angular_frequency = 1 }] }'"),
             Contains("constant drive.speed"));
  CHECK_THAT(refused("velocity-step",
                     "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'plane-slider'\nmass = 3\nstiffness = [400, 400]\n"
                     "[drive]\nspeed = [0.1, 0]\nnormal_load = 1\n"),
             Contains("along one line"));
}

}  // namespace rosin::tests::lab_machines
