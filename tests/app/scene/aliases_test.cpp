/// Names of other programs in scenes: read as rosin's own where both mean the same, else refused with what to give.
#include "app/scene/aliases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>

#include "app/scene/scene.hpp"
#include "app/scene/toml_document.hpp"
#include "app/tasks/compare.hpp"
#include "app/tasks/stability.hpp"
#include "core/error.hpp"
#include "laws/catalogue.hpp"
#include "tests/app/folder.hpp"
#include "tests/app/scene_of.hpp"

using Catch::Matchers::Contains;
using rosin::InputError;
using rosin::app::scene::law_called;
using rosin::app::scene::Scene;
using rosin::tests::Folder;

namespace {

Scene read(const Folder& folder, const std::string& text, const std::string& verb,
           const std::vector<std::string>& overrides = {}) {
  const auto path = folder.path / "scene.toml";
  std::ofstream(path) << text;
  return rosin::tests::scene_of(path.string(), overrides, verb);
}

std::string refusal(const Folder& folder, const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    read(folder, text, "stability", overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool noted(const Scene& scene, const std::string& text) {
  return std::ranges::find(scene.notes, text) != scene.notes.end();
}

const std::string slider = "[oscillator]\nm = 1\nk = 200\nc = 3\n[drive]\nV = 1e-5\nnormal_force = 2\n";
const std::string ageing = "[law]\ntype = 'aging'\nmu_0 = 0.7\nD_c = '20 um'\nVref = 1e-5\n";

}  // namespace

TEST_CASE("names of rsfmodel, xlook and Abaqus are read as rosin's own, and a note says so", "[aliases]") {
  const Folder folder;
  const auto scene = read(folder, ageing + slider, "stability");
  const auto& model = scene.model;
  CHECK(model.law->card().name == "ageing");
  CHECK(model.get("law.mu0") == 0.7);
  CHECK(model.get("law.L") == 20e-6);
  CHECK(model.get("law.v0") == 1e-5);
  CHECK(model.slider.mass == 1);
  CHECK(model.slider.stiffness == 200);
  CHECK(model.slider.damping == 3);
  CHECK(model.drive.speed.level() == 1e-5);
  CHECK(model.drive.normal_load.level() == 2);
  CHECK(noted(scene, "law.type = 'aging' is read as 'ageing'"));
  CHECK(noted(scene, "law.D_c is read as law.L (m)"));
  CHECK(noted(scene, "law.mu_0 is read as law.mu0"));
  CHECK(noted(scene, "oscillator.k is read as oscillator.stiffness (N/m)"));
  CHECK(scene.notes.size() == 9);
  CHECK_THAT(scene.resolved, Contains("L = \"20 um\"") || Contains("L = '20 um'"));
  CHECK(scene.places.at("law.L").ends_with("scene.toml:4:7"));  // where D_c stands
}

TEST_CASE("Greek letters are read by their names", "[aliases]") {
  const Folder folder;
  const auto scene = read(folder, "[law]\ntype = 'ageing'\n'μ₀' = 0.7\n\"λ\" = 2\n" + slider, "stability");
  CHECK(scene.model.get("law.mu0") == 0.7);
  CHECK(scene.model.get("law.lambda") == 2);
  CHECK(noted(scene, "law.μ₀ is read as law.mu0"));
}

TEST_CASE("an override by another name replaces what the scene has, and paths may be such names", "[aliases]") {
  const Folder folder;
  const std::string own = "[law]\ntype = 'ageing'\nL = 1e-5\n" + slider;
  CHECK(read(folder, own, "stability", {"law.Dc=3e-5"}).model.get("law.L") == 3e-5);
  CHECK(read(folder, own, "stability", {"law.Dc=3e-5", "law.L=4e-5"}).model.get("law.L") == 4e-5);
  CHECK(read(folder, own, "stability", {"drive.velocity=2e-5"}).model.drive.speed.level() == 2e-5);
  const auto scene = read(folder, own + "[stability]\nparameters = ['law.Dc', 'oscillator.c']\n", "stability");
  CHECK(scene.task<rosin::app::tasks::Stability>().parameters ==
        std::vector<std::string>{"law.L", "oscillator.damping"});
  CHECK(noted(scene, "law.Dc is read as law.L"));
}

TEST_CASE("a name that a law has itself is left alone, as are names of formulas", "[aliases]") {
  const Folder folder;
  const auto weakening = read(folder, "[law]\ntype = 'slip-weakening'\nd_c = 2e-4\n" + slider, "stability");
  CHECK(weakening.model.get("law.d_c") == 2e-4);
  const auto formula =
      read(folder,
           "[law]\ntype = 'formula'\nDc = 2\n[law.formula]\nfriction = '0.3 + Dc*v'\nstatic_limit = '0.3'\n"
           "[law.formula.parameters]\nDc = { default = 1, unit = 's/m' }\n" +
               slider,
           "stability");
  CHECK(formula.model.get("law.Dc") == 2);
  for (const auto& law : rosin::laws::catalogue()) CHECK(law_called(law->card().name) == law->card().name);
}

TEST_CASE("names that mean something else are refused with what to give, at their place", "[aliases]") {
  const Folder folder;
  const auto with = [&](const std::string& line) {
    return refusal(folder, "[law]\ntype = 'ageing'\n" + line + "\n" + slider);
  };
  CHECK_THAT(with("a_minus_b = -0.005"), Contains("scene.toml:3:13: law.a_minus_b leaves the direct effect open"));
  CHECK_THAT(with("k_c = 3"), Contains("give oscillator.stiffness"));
  CHECK_THAT(with("A = 0.01"), Contains("may be a stress"));
  CHECK_THAT(with("Dc = 1e-5\nL = 1e-5"), Contains("law.Dc means law.L, which is given too"));
  CHECK_THAT(with("theta = 1"), Contains("run.start"));
  CHECK_THAT(with("stifness = 1"), Contains("unknown key 'stifness'"));
  CHECK_THAT(refusal(folder, "[law]\ntype = 'film'\n'μ_S' = 3\n" + slider), Contains("unknown key 'μ_S'"));
  CHECK_THAT(refusal(folder, "[law]\ntype = 'rate-and-state'\n" + slider), Contains("is a family of laws"));
  CHECK_THAT(refusal(folder, "[law]\ntype = 'stribeck'\nd_c = 3\n" + slider), Contains("law.v_s = 1/d_c"));
  CHECK_THAT(refusal(folder, "[law]\ntype = 'coulomb'\nF_s = 3\n" + slider), Contains("law.F_s is a force"));
  CHECK_THAT(refusal(folder, ageing + slider, {"oscillator.zeta=0.1"}), Contains("--set oscillator.zeta=0.1: "));
}

TEST_CASE("laws of members and contacts take other names too", "[aliases]") {
  const Folder folder;
  const auto scene =
      read(folder,
           ageing + slider +
               "[compare]\nprotocol = 'stability'\nmembers = [{ name = 'a' }, { name = 'b', law = { type "
               "= 'Ruina', Dc = 3e-5 } }, { name = 'c', set = { 'law.Dc' = 4e-5 } }]\n",
           "compare");
  REQUIRE(scene.task<rosin::app::tasks::Compare>().members.size() == 3);
  CHECK(scene.task<rosin::app::tasks::Compare>().members[1].scene.model.law->card().name == "slip");
  CHECK(scene.task<rosin::app::tasks::Compare>().members[1].scene.model.get("law.L") == 3e-5);
  CHECK(scene.task<rosin::app::tasks::Compare>().members[2].scene.model.get("law.L") == 4e-5);
  CHECK(noted(scene, "compare.members.2.law.Dc is read as compare.members.2.law.L (m)"));
}

TEST_CASE("a contact of a structure takes other names, and so does its path, in full and in short", "[aliases]") {
  auto scene = toml::parse(
      "[oscillator]\ntype = 'structure'\ncontacts = [{ law = { type = 'Amontons', mu_k = 0.2 } }]\n"
      "[map]\nx = 'contacts.1.law.mu_k'\ny = 'oscillator.contacts.1.law.muk'\n");
  std::vector<std::string> notes;
  rosin::app::scene::resolve_aliases(scene, notes);
  CHECK(scene.at_path("oscillator.contacts[0].law.type").value_or(std::string()) == "coulomb");
  CHECK(scene.at_path("oscillator.contacts[0].law.mu_d").value_or(0.0) == 0.2);
  CHECK(scene.at_path("map.x").value_or(std::string()) == "contacts.1.law.mu_d");
  CHECK(scene.at_path("map.y").value_or(std::string()) == "oscillator.contacts.1.law.mu_d");
}

TEST_CASE("a folder's name takes values of the scene, fit for a file system", "[aliases]") {
  using rosin::app::scene::filled_in;
  const auto scene = toml::parse("title = '../a b'\n[drive]\nspeed = 1e-5\nload = '10 µN/s'\nn = 20\non = true\n");
  CHECK(filled_in("out/plain", scene) == "out/plain");
  CHECK(filled_in("out/{drive.speed}/N{drive.n}", scene) == "out/1e-05/N20");
  CHECK(filled_in("{drive.load}", scene) == "10_µN_s");
  CHECK(filled_in("{title}", scene) == "_.._a_b");
  CHECK_THROWS_WITH(filled_in("{drive.sped}", scene), Contains("did you mean 'drive.speed'?"));
  CHECK_THROWS_WITH(filled_in("{drive.on}", scene), Contains("is a truth value"));
  CHECK_THROWS_WITH(filled_in("{drive}", scene), Contains("is a table"));
  CHECK_THROWS_WITH(filled_in("{drive.speed", scene), Contains("without }"));
}

TEST_CASE("rosin's own scenes use rosin's own names", "[aliases]") {
  int scenes = 0;
  for (const char* folder : {"examples", "cases", "tests/scenes"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(ROSIN_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".toml") continue;
      INFO(entry.path());
      std::vector<std::string> notes;
      auto scene = rosin::app::scene::read_toml(entry.path().string());
      rosin::app::scene::resolve_aliases(scene, notes);
      CHECK(notes == std::vector<std::string>{});
      ++scenes;
    }
  CHECK(scenes > 50);
}
