/// Scenes that tabulate per unit area, or by turning, are the scene in newtons and metres.
#include "app/scene/reference.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "analysis/planes/map.hpp"
#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "tests/app/folder.hpp"
#include "tests/app/scene_of.hpp"

using Catch::Matchers::Contains;
using rosin::InputError;
using rosin::app::scene::Scene;
using rosin::tests::Folder;
using rosin::tests::scene_of;

namespace {

Scene scene(const std::string& text, const std::string& verb = "stability") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << "[law]\ntype = 'ageing'\n" << text;
  return scene_of((folder.path / "scene.toml").string(), {}, verb);
}
const std::string per_area =
    "[oscillator]\narea = '4 cm^2'\nmass = '250 kg/m^2'\nstiffness = '2 MPa/mm'\ndamping = '5 kPa s/m'\n"
    "[drive]\nspeed = '1 um/s'\nnormal_load = '5 MPa'\n";
const std::string turning =
    "[oscillator]\nradius = '50 mm'\nmass = '0.02 kg m^2'\nstiffness = '10 N m/rad'\ndamping = '0.1 N m s/rad'\n"
    "[drive]\nspeed = '60 rpm'\nnormal_load = 20\nforce = '0.5 N m'\n";

}  // namespace

TEST_CASE("stresses, and stiffness and mass per unit area, count times the area", "[scene][units]") {
  const auto model = scene(per_area).model;
  CHECK(model.drive.normal_load.level() == Approx(2000).epsilon(1e-14));
  CHECK(model.slider.mass == Approx(0.1).epsilon(1e-14));
  CHECK(model.slider.stiffness == Approx(8e5).epsilon(1e-14));
  CHECK(model.slider.damping == Approx(2).epsilon(1e-14));
  CHECK(model.drive.speed.level() == Approx(1e-6).epsilon(1e-14));
}

TEST_CASE("turning joints come to the radius at which they rub", "[scene][units]") {
  const auto model = scene(turning).model;
  CHECK(model.slider.mass == Approx(8).epsilon(1e-14));          // J/r²
  CHECK(model.slider.stiffness == Approx(4000).epsilon(1e-14));  // k/r²
  CHECK(model.slider.damping == Approx(40).epsilon(1e-14));
  CHECK(model.drive.speed.level() == Approx(2 * M_PI * 0.05).epsilon(1e-12));  // ω r
  CHECK(model.drive.force.level() == Approx(10).epsilon(1e-14));               // torque/r
  CHECK(model.drive.normal_load.level() == 20);
}

TEST_CASE("a rate per minute of something that rotates counts turns; another bare rate is refused", "[scene][units]") {
  const auto at = [](const std::string& speed) {
    auto text = turning;
    return text.replace(text.find("60 rpm"), 6, speed);
  };
  for (const char* minute : {"60 1/min", "60 min^-1", "60 RPM", "60 U/min", "60 r/min", "60 rev/min", "1 rev/s"}) {
    INFO(minute);
    CHECK(scene(at(minute)).model.drive.speed.level() == Approx(2 * M_PI * 0.05).epsilon(1e-12));
  }
  for (const char* unclear : {"1 Hz", "1 1/s"})
    CHECK_THROWS_WITH(scene(at(unclear)), Contains("drive.speed") && Contains("turns or radians") && Contains("rev/s"));
}

TEST_CASE("axes of a plane may be stresses", "[scene][units]") {
  const auto plane =
      scene(per_area +
                "[map]\nx = { parameter = 'drive.normal_load', from = '1 MPa', to = '10 MPa', points = 3 }\n"
                "y = { parameter = 'drive.speed', from = 1e-7, to = 1e-5, points = 3 }\n",
            "map");
  CHECK(plane.task<rosin::analysis::planes::MapOptions>().x.values.front() == Approx(400).epsilon(1e-12));
  CHECK(plane.task<rosin::analysis::planes::MapOptions>().x.values.back() == Approx(4000).epsilon(1e-12));
}

TEST_CASE("a stress without an area names the key that is missing; an area that nothing needs is noted",
          "[scene][units]") {
  CHECK_THROWS_WITH(
      scene("[oscillator]\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = '5 MPa'\n"),
      Contains("scene.toml:8:15") && Contains("'5 MPa' is in MPa, but needed is N") && Contains("oscillator.area"));
  CHECK_THROWS_WITH(scene("[oscillator]\nmass = '1 kg m^2'\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = 5\n"),
                    Contains("oscillator.radius"));
  // no length becomes a load by an area
  CHECK_THROWS_WITH(scene("[oscillator]\narea = 1\nmass = '1 m'\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = 5\n"),
                    Contains("needed is kg") && !Contains("oscillator.radius"));
  CHECK_THROWS_WITH(scene("[oscillator]\narea = 0\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = 5\n"),
                    Contains("oscillator.area = 0 is outside"));
  const auto noted =
      scene("[oscillator]\narea = 1\nmass = 1\nstiffness = 1\n[drive]\nspeed = 1\nnormal_load = 5\n").notes;
  REQUIRE(noted.size() == 1);
  CHECK_THAT(noted[0], Contains("oscillator.area has no effect"));
}
