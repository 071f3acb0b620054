/// Planes as NetCDF: what their coordinates are called.
#include "app/results/table.hpp"

#include <catch2/catch.hpp>

#include "tests/app/command.hpp"

using rosin::app::results::axis_names;
using rosin::tests::Folder;
using rosin::tests::run_rosin;
using Names = std::vector<std::string>;

TEST_CASE("a coordinate is called as its parameter, with its whole path where that is another's name", "[planes]") {
  CHECK(axis_names({"drive.normal_load", "law.lambda"}, {"period"}) == Names{"normal_load", "lambda"});
  CHECK(axis_names({"oscillator.pin_stiffness.2", "oscillator.M.1.12"}, {}) == Names{"pin_stiffness_2", "M_1_12"});
  CHECK(axis_names({"law.mu_s", "oscillator.contacts.1.law.mu_s"}, {}) ==
        Names{"law_mu_s", "oscillator_contacts_1_law_mu_s"});
  CHECK(axis_names({"law.period", "drive.speed"}, {"period", "period_error"}) == Names{"law_period", "drive_speed"});
}

TEST_CASE("a law from text may call its parameters as results are called", "[planes]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << R"(
[law]
type = "formula"
[law.formula]
friction = "period - regime*v"
static_limit = "period"
parameters = { period = { default = 0.3 }, regime = { default = 0.01, unit = "s/m" } }
[oscillator]
type = "slider"
mass = 1
stiffness = 1
damping = 1
[drive]
speed = 0.1
normal_load = 1
[map]
x = { parameter = "law.period", from = 0.1, to = 0.5, points = 2 }
y = { parameter = "law.regime", from = 1e-3, to = 1e-2, points = 2 }
metrics = ["period"]
)";
  const auto mapped = run_rosin(folder, "map scene.toml --no-pictures --out out");
  CHECK(mapped.status == 0);
  CHECK(mapped.error.empty());
  CHECK(std::filesystem::exists(folder.path / "out/map.nc"));
}
