/// The key `profile` in scenes: what it makes of contacts, and the refusals with their places.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "app/scene/profile.hpp"
#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "tests/app/scene_of.hpp"

using Catch::Matchers::Contains;
using rosin::app::scene::Scene;
using rosin::oscillators::OverProfile;
using rosin::oscillators::profile_under;

namespace {

namespace fs = std::filesystem;

struct OwnFolder {
  fs::path path = fs::temp_directory_path() / ("rosin-profile-" + std::to_string(getpid()));
  OwnFolder() { fs::create_directories(path); }
  ~OwnFolder() { fs::remove_all(path); }
};

Scene read(const std::string& oscillator, const std::string& drive = "speed = 0.5\nnormal_load = 10",
           const std::string& heights = "") {
  const OwnFolder folder;
  std::ofstream(folder.path / "scene.toml") << "[law]\ntype = 'coulomb'\n[oscillator]\n"
                                            << oscillator << "\n[drive]\n"
                                            << drive << "\n[run]\nduration = 1\n";
  if (!heights.empty()) std::ofstream(folder.path / "heights.csv") << heights;
  return rosin::tests::scene_of((folder.path / "scene.toml").string(), {}, "run");
}

std::string rider(const std::string& profile, const std::string& more = "tangential = [1, 0], ") {
  return "type = 'structure'\nM = [[1, 0], [0, 1]]\nK = [[1e4, 0], [0, 1e4]]\ncontacts = [{ " + more +
         "normal = [0, 1], normal_contact = { stiffness = 1e6 }, profile = " + profile + " }]";
}

const OverProfile* profile_of(const Scene& scene) {
  return profile_under(scene.structure->structure.contacts[0].normal_law.get());
}

}  // namespace

TEST_CASE("waves, rough tracks and measured heights go under contacts that give way", "[profile]") {
  const auto wave = read(rider("{ type = 'harmonic', amplitude = '2 um', wavelength = '4 mm', phase = 0.5 }"));
  REQUIRE(profile_of(wave));
  CHECK(profile_of(wave)->height().value(1e-3) ==
        Approx(2e-6 * std::cos(2 * 3.14159265358979 * 0.5e-3 / 4e-3 + 0.5)).epsilon(1e-12));
  const auto waves = read(
      rider("{ type = 'harmonics', waves = [{ amplitude = 1e-6, wavelength = 1e-3 }, { amplitude = 2e-6, wavelength = "
            "'3 mm' }] }"));
  CHECK(profile_of(waves)->height().value(0) == Approx(3e-6));
  const auto rough = read(
      rider("{ type = 'random', rms = '1 um', shortest = '0.2 mm', longest = '2 mm', length = '20 mm', seed = 3 }"));
  CHECK(common_period(rough.structure->structure) == Approx(20e-3 / 0.5).epsilon(1e-12));
  const auto track = read(rider("{ type = 'table', table = 'heights.csv' }"), "speed = 0.5\nnormal_load = 10",
                          "distance [mm],height [um]\n0,1\n1,3\n2,-1\n3,-3\n");
  CHECK(profile_of(track)->height().value(2e-3) == Approx(3e-6));
  CHECK(common_period(track.structure->structure) == Approx(8e-3).epsilon(1e-12));
  // A wave without height, at which a map may begin; and the speed of a contact without friction.
  const auto flat = read(rider("{ type = 'harmonic', amplitude = 0, wavelength = 1e-3 }"));
  CHECK(profile_of(flat)->is_flat());
  CHECK(flat.structure->structure.constant());
  const auto smooth = read(rider("{ type = 'harmonic', amplitude = 1e-6, wavelength = 1e-3 }", "speed = 2, "));
  CHECK(common_period(smooth.structure->structure) == Approx(0.5e-3).epsilon(1e-12));
  CHECK(smooth.structure->structure.contacts[0].speed.level() == 0);
  CHECK(
      profile_of(read("type = 'mode-coupling'\nmass = 1\nsprings = [{ stiffness = 1e4, angle = 0.5 }, { stiffness = "
                      "1e4, angle = 2 }]\ncontact = { stiffness = 1e6 }\nprofile = { type = 'harmonic', amplitude = "
                      "1e-6, wavelength = 1e-3 }")));
  const auto pin = read("type = 'pin-on-disk'\nprofile = { type = 'harmonic', amplitude = 1e-6, wavelength = 2e-2 }");
  REQUIRE(profile_of(pin));
  CHECK(profile_of(pin)->stations() == 64);
}

TEST_CASE("profiles that cannot be ridden over are refused with their place", "[profile]") {
  const std::string wave = "{ type = 'harmonic', amplitude = 1e-6, wavelength = 1e-3 }";
  CHECK_THROWS_WITH(read("mass = 1\nstiffness = 1\nprofile = " + wave),
                    Contains("scene.toml:") && Contains("oscillator.profile has no effect") && Contains("prescribed"));
  CHECK_THROWS_WITH(
      read("type = 'structure'\nM = [[1]]\nK = [[1]]\ncontacts = [{ tangential = [1], profile = " + wave + " }]"),
      Contains("oscillator.contacts.1.profile has no effect") && Contains("no stiffness"));
  CHECK_THROWS_WITH(read("type = 'chain'\nblocks = 1\nmass = 1\nstiffness = 1\npull_stiffness = 1\ncontacts = [{ block "
                         "= 1, profile = " +
                         wave + " }]"),
                    Contains("oscillator.contacts.1.profile has no effect"));
  CHECK_THROWS_WITH(read(rider(wave), "speed = { ramp = { rate = 1 } }\nnormal_load = 10"),
                    Contains("scene.toml:") && Contains("constant speed"));
  CHECK_THROWS_WITH(read(rider(wave), "speed = 0\nnormal_load = 10"), Contains("constant speed"));
  CHECK_THROWS_WITH(read(rider("{ type = 'harmonc' }")), Contains("did you mean 'harmonic'?"));
  CHECK_THROWS_WITH(read(rider("{ type = 'harmonic', amplitude = 1e-6 }")), Contains("has no 'wavelength'"));
  CHECK_THROWS_WITH(read(rider("{ type = 'harmonic', amplitude = 1e-6, wavelength = 1e-3, rms = 1 }")),
                    Contains("unknown key 'rms'"));
  CHECK_THROWS_WITH(read(rider("{ type = 'random', rms = 1e-6, shortest = 1e-6, longest = 1e-2 }")),
                    Contains("more than 1000"));
  CHECK_THROWS_WITH(read(rider("{ type = 'table', table = 'heights.csv' }"), "speed = 0.5\nnormal_load = 10",
                         "distance [mm],height [um]\n0,1\n1,3\n3,-1\n4,-3\n"),
                    Contains("equal spacing"));
  CHECK_THROWS_WITH(read(rider("{ type = 'table', table = 'heights.csv' }"), "speed = 0.5\nnormal_load = 10",
                         "distance [mm],height [um]\n0,1\n1,1\n2,1\n3,1\n"),
                    Contains("all the same"));
  CHECK_THROWS_WITH(read(rider("{ type = 'harmonics', waves = [] }")), Contains("is empty"));
}
