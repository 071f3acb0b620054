/// Comparisons in scenes: what members change, what is made equal, and what is refused with its place.
#include "app/tasks/compare.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/scene/scene.hpp"
#include "tests/app/command.hpp"
#include "tests/app/scene_of.hpp"

using namespace rosin;
using namespace rosin::app;

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using rosin::tests::Folder;
using rosin::tests::run_rosin;
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

const std::string blocks = R"(
[law]
type = "hyperbolic"
mu_s = 1
delta = 3
[oscillator]
type = "chain"
blocks = 2
mass = 1
stiffness = 1.2
pull_stiffness = 1
contacts = [ { block = 2, law = { type = "coulomb", mu_s = 0.4, mu_d = 0.3 } } ]
[drive]
speed = 0.2
normal_load = 1
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
  CHECK(members[0].scene.model.law->card().name == "ageing");
  CHECK(members[1].scene.model.law->card().name == "slip");
  CHECK(members[1].scene.model.get("law.a") == 0.012);
  CHECK(members[1].scene.model.lambda == 2);
  CHECK(members[1].scene.model.slider.stiffness == 1500);
  CHECK(members[2].scene.model.slider.stiffness == 1000);
  CHECK(members[2].scene.model.get("law.b") == 0.02);
  CHECK(members[2].scene.model.get("law.a") == members[0].scene.model.get("law.a"));
  CHECK(scene.task<rosin::app::tasks::Compare>().protocol == "cycle");
}

TEST_CASE("members are made equal to the first as they are read", "[app][compare]") {
  const auto scene = read(R"([compare]
members = [ { name = "one" }, { name = "other", law = { type = "slip", mu0 = 0.5, a = 0.02, b = 0.03 } } ]
equalise = { properties = [ { name = "steady-friction", slip_rate = "10 um/s" }, { name = "steady-slope", slip_rate = 1e-5 },
                            { name = "direct-effect", slip_rate = 1e-5 } ], adjust = ["law.mu0", "law.a", "law.b"] })");
  const auto& other = scene.task<rosin::app::tasks::Compare>().members[1];
  CHECK(other.scene.model.get("law.mu0") == Approx(0.6).epsilon(1e-10));
  CHECK(other.scene.model.get("law.a") == Approx(0.010).epsilon(1e-10));
  CHECK(other.scene.model.get("law.b") == Approx(0.015).epsilon(1e-10));
  CHECK(other.adjusted.size() == 3);
  CHECK(other.difference < 1e-12);
}

TEST_CASE("members of a structure change its laws, and any number of the scene", "[app][compare]") {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << blocks << R"([run]
duration = 1
start = { displacement_2 = 0.3 }
[compare]
protocol = "run"
members = [ { name = "as it is" }, { name = "dry", law = { type = "coulomb", mu_s = 1, mu_d = 0.6 } },
            { name = "other", set = { "oscillator.pull_stiffness" = 2, "contacts.1.law.mu_d" = 0.2, "law.delta" = 4 } } ])";
  const auto scene = scene_of((folder.path / "scene.toml").string(), {}, "compare");
  const auto& members = scene.task<rosin::app::tasks::Compare>().members;
  REQUIRE(members.size() == 3);
  const auto contact = [&](int member, int k) {
    return members[std::size_t(member)].scene.structure->structure.contacts[std::size_t(k)];
  };
  const auto number = [&](int member, int k, const char* name) {
    const auto law = contact(member, k).law;
    return std::get<double>(law->values()[*law->find(name)]);
  };
  CHECK(contact(0, 0).law->card().name == "hyperbolic");
  CHECK(contact(1, 0).law->card().name == "coulomb");
  CHECK(number(2, 0, "delta") == 4);
  CHECK(number(0, 1, "mu_d") == 0.3);  // the block's own law
  CHECK(number(1, 1, "mu_d") == 0.3);
  CHECK(number(2, 1, "mu_d") == 0.2);
  CHECK(members[0].scene.structure->structure.K(0, 0) == 2.2);
  CHECK(members[2].scene.structure->structure.K(0, 0) == 3.2);
  for (const auto& member : members) CHECK(member.scene.structure->start.coordinates[1] == 0.3);
}

TEST_CASE("one coordinate compares under every protocol as the slider that it is", "[app][compare]") {
  const std::string begin = R"([law]
type = "hyperbolic"
mu_s = 1
delta = 3
[drive]
speed = 0.2
normal_load = 1
)";
  const std::string forms[] = {
      "[oscillator]\nmass = 1\nstiffness = 1\n",
      "[oscillator]\ntype = 'structure'\nM = [[1]]\nK = [[1]]\ncontacts = [{ tangential = [1] }]\n"};
  const std::string axes =
      "[map]\nx = { parameter = 'drive.speed', from = 0.15, to = 0.2, points = 2 }\n"
      "y = { parameter = 'drive.normal_load', from = 1, to = 1.2, points = 2 }\nmetrics = ['stick_fraction']\n";
  for (const auto& [protocol, table, words] :
       {std::tuple{"run", std::string("[run]\nduration = 20\nsamples = 50\nstart = { displacement = 0.1 }\n"), ""},
        {"cycle", std::string(), ""},
        {"map", axes, ""},
        {"frf", std::string("[frf]\nfrequencies = [0.05, 0.1, 1]\n"), ""},
        {"map", axes, " --design"}}) {
    CAPTURE(protocol, words);
    json documents[2];
    for (const int form : {0, 1}) {
      const Folder folder;
      std::ofstream(folder.path / "scene.toml")
          << begin << forms[form] << table << "[compare]\nprotocol = '" << protocol
          << "'\nmembers = [{ name = 'a' }, { name = 'b', law = { type = 'coulomb', mu_s = 1, mu_d = 0.6 } }]\n"
          << "noise = { stick_fraction = { absolute = 0.01 } }\n";
      const auto answer =
          run_rosin(folder, fmt::format("compare scene.toml{} --json --no-pictures --tolerance 1e-7", words));
      CAPTURE(answer.error);
      REQUIRE(answer.status == 0);
      documents[form] = json::parse(answer.out);
    }
    if (*words) {
      for (const int row : {0, 1})
        for (const int column : {0, 1}) {
          const auto at = [&](int form, const char* name) { return documents[form][name][row][column].get<double>(); };
          CHECK(std::abs(at(0, "discriminability") - at(1, "discriminability")) <=
                at(0, "discriminability_error") + at(1, "discriminability_error"));
        }
      continue;
    }
    int compared = 0;
    for (const auto& [metric, slider] : documents[0]["differences"].items()) {
      INFO(metric << ": " << slider.dump());
      if (!documents[1]["differences"].contains(metric)) continue;
      const auto& structure = documents[1]["differences"][metric];
      CHECK(structure["unit"] == slider["unit"]);
      for (const int k : {0, 1}) {
        const double one = slider["values"][k], other = structure["values"][k];
        CHECK(std::abs(one - other) <=
              slider["errors"][k].get<double>() + structure["errors"][k].get<double>() + 1e-14 * (1 + std::abs(one)));
      }
      ++compared;
    }
    CHECK(compared > 0);
  }
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
