/// Scenes for a fit out of tables.
#include "app/verbs/fit_starter.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.hpp"
#include "core/files.hpp"
#include "tests/app/command.hpp"

using rosin::app::verbs::fit_starter;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

namespace {

bool tells(const std::string& scene, const std::string& line) { return scene.find(line) != std::string::npos; }

}  // namespace

TEST_CASE("a table of any names and units becomes a scene that finds the law that made it", "[fit]") {
  const Folder folder;
  // Friction falls from 0.4 to 0.3 over 20 mm/s, and one number in 10^4 is noise.
  std::string table = "Geschwindigkeit;COF\nmm/s;-\n";
  for (int i = 1; i <= 60; ++i) {
    const double v = 2.0 * i;
    table += fmt::format("{};{:.6f}\n", v, 0.3 + 0.1 * std::exp(-std::pow(v / 20, 2)) + 1e-5 * std::sin(7.0 * i));
  }
  rosin::write_whole(folder.path / "curve.csv", table);
  const auto scene = run_rosin(folder, "new fit curve.csv");
  REQUIRE(scene.status == 0);
  CHECK(tells(scene.out, "type = \"steady-curve\""));
  rosin::write_whole(folder.path / "fit.toml", scene.out);
  const auto fitted = run_rosin(folder, "fit fit.toml --no-pictures");
  INFO(fitted.out);
  CHECK(fitted.status == 0);
  CHECK(tells(fitted.out, "law.mu_s                           0.4000"));
  CHECK(tells(fitted.out, "law.mu_d                           0.3000"));
}

TEST_CASE("columns say what kind of measurement a table is", "[fit]") {
  const Folder folder;
  const auto scene_of = [&](const std::string& table) {
    rosin::write_whole(folder.path / "table.csv", table);
    return fit_starter(folder.path / "table.csv");
  };
  const auto joint = scene_of("time (s),angle (rad),torque (N m)\n0,0,0\n0.1,0.1,12\n0.2,0.2,11\n0.3,0.3,10\n");
  CHECK(tells(joint, "type = \"record\""));
  CHECK(tells(joint, "columns = { displacement = \"angle\", friction_force = \"torque\" }"));
  CHECK(tells(joint, "radius = 1"));
  CHECK(tells(joint, "normal_load = 100"));  // at which 12 N m are a coefficient of 0.12
  const auto gouge = scene_of("time (s),load point disp (um),mu\n0,0,0.6\n1,1,0.61\n2,2,0.6\n");
  CHECK(tells(gouge, "type = \"ageing\""));
  CHECK(tells(scene_of("hold (s),mu\n1,0.6\n10,0.61\n100,0.62\n"), "type = \"hold\""));
  CHECK(tells(scene_of("f (Hz),Re Z (N s/m),Im Z (N s/m)\n1,2,3\n2,3,4\n"), "type = \"frequency-response\""));
  CHECK_THROWS_WITH(scene_of("temperature (K),colour\n300,1\n301,2\n"),
                    Catch::Contains("no kind of measurement is told by its columns, temperature (K), colour"));
}
