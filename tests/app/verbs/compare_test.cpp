/// Comparisons in scenes: what members change, what is made equal, and what is refused with its place.
#include "app/tasks/compare.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "app/scene/scene.hpp"
#include "tests/app/scene_of.hpp"

using namespace rosin;
using namespace rosin::app;

namespace {

namespace fs = std::filesystem;
using rosin::tests::scene_of;

const std::string slider = R"(
[law]
type = "ageing"
[oscillator]
mass = 1
stiffness = 1500
[drive]
speed = 1e-5
normal_load = 5
)";

scene::Scene read(const std::string& comparison, const std::string& verb = "compare") {
  const fs::path path = fs::temp_directory_path() / ("rosin-compare-" + std::to_string(getpid()) + ".toml");
  std::ofstream(path) << slider << comparison;
  struct Remove {
    fs::path path;
    ~Remove() { fs::remove(path); }
  } remove{path};
  return scene_of(path.string(), {}, verb);
}

std::string refusal(const std::string& comparison, const std::string& verb = "compare") {
  try {
    read(comparison, verb);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("members change the scene's model by a law or by single parameters", "[app][compare]") {
  const auto scene = read(R"([compare]
members = [ { name = "as it is" }, { name = "slip", law = { type = "slip", a = 0.012, lambda = 2 } },
            { name = "soft", set = { "oscillator.stiffness" = "1 N/mm", "law.b" = 0.02 } } ])");
  const auto& members = scene.task<rosin::app::tasks::Compare>().members;
  REQUIRE(members.size() == 3);
  CHECK(members[0].model.law->card().name == "ageing");
  CHECK(members[1].model.law->card().name == "slip");
  CHECK(members[1].model.get("law.a") == 0.012);
  CHECK(members[1].model.lambda == 2);
  CHECK(members[1].model.slider.stiffness == 1500);
  CHECK(members[2].model.slider.stiffness == 1000);
  CHECK(members[2].model.get("law.b") == 0.02);
  CHECK(members[2].model.get("law.a") == members[0].model.get("law.a"));
  CHECK(scene.task<rosin::app::tasks::Compare>().protocol == "cycle");
}

TEST_CASE("members are made equal to the first as they are read", "[app][compare]") {
  const auto scene = read(R"([compare]
members = [ { name = "one" }, { name = "other", law = { type = "slip", mu0 = 0.5, a = 0.02, b = 0.03 } } ]
equalise = { properties = [ { name = "steady-friction", slip_rate = "10 um/s" }, { name = "steady-slope", slip_rate = 1e-5 },
                            { name = "direct-effect", slip_rate = 1e-5 } ], adjust = ["law.mu0", "law.a", "law.b"] })");
  const auto& other = scene.task<rosin::app::tasks::Compare>().members[1];
  CHECK(other.model.get("law.mu0") == Approx(0.6).epsilon(1e-10));
  CHECK(other.model.get("law.a") == Approx(0.010).epsilon(1e-10));
  CHECK(other.model.get("law.b") == Approx(0.015).epsilon(1e-10));
  CHECK(other.adjusted.size() == 3);
  CHECK(other.difference < 1e-12);
}

TEST_CASE("wrong comparisons are refused with their place and a way out", "[app][compare]") {
  using Catch::Contains;
  const std::string two = "members = [ { name = 'a' }, { name = 'b', set = { 'law.a' = 0.02 } } ]\n";
  CHECK_THAT(refusal(""), Contains("no [compare]"));
  CHECK_THAT(refusal("[compare]\nmembers = [ { name = 'a' } ]"), Contains("two members"));
  CHECK_THAT(refusal("[compare]\nmembers = [ { name = 'a' }, { name = 'a' } ]"), Contains("two are named 'a'"));
  CHECK_THAT(refusal("[compare]\nmembers = [ { name = 'a' }, { nmae = 'b' } ]"), Contains(":11:") && Contains("name"));
  CHECK_THAT(refusal("[compare]\nmembers = [ { name = 'a' }, { name = 'b', set = { 'law.aa' = 1 } } ]"),
             Contains("law.aa"));
  CHECK_THAT(refusal("[compare]\nmembers = [ { name = 'a' }, { name = 'b', set = { 'law.a' = 7 } } ]"),
             Contains("law.a = 7") && Contains("0.5"));
  CHECK_THAT(refusal("[compare]\nprotocol = 'cyle'\n" + two), Contains("did you mean 'cycle'"));
  CHECK_THAT(refusal("[compare]\n" + two +
                     "equalise = { properties = [ { name = 'steady-slop', slip_rate = 1 } ], "
                     "adjust = ['law.a'] }"),
             Contains("did you mean 'steady-slope'"));
  CHECK_THAT(refusal("[compare]\n" + two +
                     "equalise = { properties = [ { name = 'steady-slope', slip_rate = 1e-5 } ], "
                     "adjust = ['law.mu0'] }"),
             Contains("member 'b'") && Contains("cannot be made equal"));
  CHECK_THAT(refusal("[compare]\n" + two + "protocol = 'run'"), Contains("no [run]"));
  const std::string plane =
      "[map]\nx = { parameter = 'drive.normal_load', from = 1, to = 10, points = 3 }\n"
      "y = { parameter = 'drive.speed', from = 1e-6, to = 1e-5, points = 3 }\n";
  CHECK_THAT(refusal("[compare]\n" + two, "design"), Contains("no [map]"));
  CHECK_THAT(refusal(plane + "[compare]\n" + two, "design"), Contains("compare.noise is needed"));
  CHECK_THAT(refusal(plane + "[compare]\n" + two + "noise = { stick_fracton = { absolute = 1 } }", "design"),
             Contains("stick_fraction"));
  CHECK_THAT(refusal(plane + "[compare]\n" + two + "noise = { period = { relative = 0 } }", "design"),
             Contains("above 0"));
  CHECK_THAT(refusal(plane + "[compare]\nparameter = 'law.lamda'\nnoise = { period = { relative = 0.1 } }", "design"),
             Contains("law.lambda"));
  CHECK(refusal(plane + "[compare]\nparameter = 'law.lambda'\nnoise = { period = { relative = 0.1 } }", "design") ==
        "accepted");
}
