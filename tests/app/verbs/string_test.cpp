/// The verbs of a bowed string: what they tell, what they write, and what they refuse.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

namespace {

const std::string scenes_of_strings = ROSIN_SOURCE_DIR "/examples/";
const std::string string = "run " + scenes_of_strings + "bowed-string.toml --no-pictures ";

nlohmann::json answer_of_string(const Folder& folder, const std::string& arguments) {
  const auto answer = run_rosin(folder, arguments + " --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  return nlohmann::json::parse(answer.out);
}

int number_at(const std::string& bytes, std::size_t place, int size) {
  int value = 0;
  for (int i = size - 1; i >= 0; --i) value = 256 * value + static_cast<unsigned char>(bytes[place + std::size_t(i)]);
  return value;
}

}  // namespace

TEST_CASE("a bowed string has columns, slips, numbers with their errors, and a sound", "[app][string]") {
  const Folder folder;
  const auto document = answer_of_string(folder, string + "--set run.samples=1000 --out out");
  CHECK(document["regime"] == "helmholtz");
  CHECK(document["metrics"]["first_slip"].get<double>() == Approx(0.032834).margin(1e-5));
  CHECK(document["metrics"]["transient_length"].get<double>() == Approx(9.7395).margin(3e-3));
  CHECK(document["error"]["transient_length"].get<double>() < 3e-3);
  const auto samples = document["time"].size();
  CHECK(samples <= 1000);
  CHECK(samples > 500);
  for (const char* column : {"bow_speed", "string_velocity", "slip_rate", "friction_force", "normal_load",
                             "bridge_force", "stick", "temperature_rise", "nut_force"}) {
    CAPTURE(column);
    CHECK(document["columns"][column].size() == samples);
    CHECK(document["units"].contains(column));
  }
  CHECK(document["events"].size() > 20);
  const auto sound = content(folder.path / "out/bridge.wav");
  REQUIRE(sound.size() > 44);
  CHECK(sound.substr(0, 4) == "RIFF");
  CHECK(sound.substr(8, 4) == "WAVE");
  CHECK(number_at(sound, 24, 4) == 48'000);
  CHECK(number_at(sound, 40, 4) == int(sound.size()) - 44);
  const double seconds = double(document["cost"]["steps"].get<long>()) / 192e3;
  CHECK(double(sound.size() - 44) / 2 / 48e3 == Approx(seconds).margin(1e-3));
}

TEST_CASE("a document of a string lists no slider, in its manifest and in its verdict", "[app][string]") {
  const Folder folder;
  const auto document =
      answer_of_string(folder, "stability " + scenes_of_strings +
                                   "schelleng-diagram.toml --set drive.speed=0.1 --set drive.normal_load=0.05 "
                                   "--no-pictures --out out");
  CHECK_THAT(document["verdict"].get<std::string>(),
             Contains("Steady sliding is unstable: small motions grow at 27.88"));
  const auto parameters = nlohmann::json::parse(content(folder.path / "out/manifest.json"))["parameters"];
  CHECK(parameters.contains("law.mu_inf"));
  for (const auto& [path, value] : parameters.items()) CHECK(path.starts_with("law."));
}

TEST_CASE("a string by measured reflections is heard through a measured body", "[app][string]") {
  const Folder folder;
  const std::string measured = "run " + scenes_of_strings + "measured-string.toml --no-pictures ";
  const auto document = answer_of_string(folder, measured + "--set run.samples=1000 --out out");
  CHECK(document["metrics"]["first_slip"].get<double>() == Approx(0.032834).margin(1e-5));
  CHECK(document["units"]["sound"] == "Pa");
  CHECK(document["columns"]["sound"].size() == document["time"].size());
  CHECK(document["sound"]["file"] == "sound.wav");
  CHECK(document["sound"]["unit"] == "Pa");
  CHECK(content(folder.path / "out/sound.wav").substr(0, 4) == "RIFF");
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& words) {
    const auto answer = run_rosin(folder, measured + arguments);
    CAPTURE(arguments, answer.error);
    CHECK(answer.status == 2);
    for (const auto& word : words) CHECK_THAT(answer.error, Contains(word));
  };
  refused("--set oscillator.quality=100", {"oscillator.quality has no effect", "reflection.nut"});
  refused("--set oscillator.corner_rounding=1e-5", {"has no effect", "bridge and nut"});
  refused("--set oscillator.bridge_resistance=55", {"reflection.bridge"});
  refused("--set oscillator.reflection.bow_position=0", {"bow_position"});
  refused("--set 'oscillator.reflection={ bow_position = 0.1 }'", {"needs bridge, nut or both"});
  refused("--set run.sound.unit=loud", {"loud"});
  refused("--set run.sound.unit=m/s", {"Pa/(N s)"});
  std::ofstream(folder.path / "no-unit.csv") << "time,value\n0,0\n1,-1\n";
  refused("--set oscillator.reflection.nut=" + (folder.path / "no-unit.csv").string(),
          {"no-unit.csv:1: column 'time': no unit is given", "time (s)"});
}

TEST_CASE("a plane of strings counts what is good and what finer sample rates confirm", "[app][string]") {
  const Folder folder;
  const auto map = "map " + scenes_of_strings +
                   "guettler-diagram.toml --no-pictures --set map.x.points=4 --set map.y.points=3 --out out ";
  const auto document = answer_of_string(folder, map);
  REQUIRE(document["metrics"]["transient_length"].size() == 3);
  REQUIRE(document["metrics"]["transient_length"][0].size() == 4);
  REQUIRE(document["regime"][2].size() == 4);
  int good = 0, reproducible = 0;
  for (std::size_t y = 0; y < 3; ++y)
    for (std::size_t x = 0; x < 4; ++x) {
      good += document["metrics"]["transient_length"][y][x].get<double>() < 5;
      const bool near = document["error"]["transient_length"][y][x].get<double>() <= 0.3;
      CHECK(document["metrics"]["reproducible"][y][x].get<double>() == (near ? 1 : 0));
      reproducible += near;
    }
  CHECK(document["statistics"]["good"] == good);
  CHECK(document["statistics"]["reproducible"] == reproducible);
  CHECK(content(folder.path / "out/map.nc").size() > 1000);
  CHECK(answer_of_string(folder, map + "--threads 1")["metrics"] == document["metrics"]);
}

TEST_CASE("the strings of a plane start as [run] says", "[app][string]") {
  const Folder folder;
  const std::string schelleng = scenes_of_strings + "schelleng-diagram.toml --no-pictures ";
  const auto alone = answer_of_string(folder, "run " + schelleng + "--set oscillator.bow_position=0.1 --out alone");
  const auto plane = answer_of_string(folder, "map " + schelleng +
                                                  "--set map.x.from=0.1 --set map.x.points=2 --set map.y.from=1 "
                                                  "--set map.y.points=2 --out plane");
  CHECK(plane["metrics"]["bridge_force"][0][0] == alone["metrics"]["bridge_force"]);
  const auto rested = answer_of_string(
      folder, "run " + schelleng + "--set oscillator.bow_position=0.1 --set run.start=rest --out rested");
  CHECK(rested["metrics"]["bridge_force"] != alone["metrics"]["bridge_force"]);
}

TEST_CASE("strings under several laws, and where they differ most", "[app][string]") {
  const Folder folder;
  const auto document = answer_of_string(folder, "compare " + scenes_of_strings +
                                                     "which-law-plays-the-cello.toml --design --no-pictures --set "
                                                     "map.x.points=6 --set map.y.points=6");
  REQUIRE(document["members"].size() == 3);
  CHECK(document["differences"].size() == 3);
  const auto& best = document["best"];
  REQUIRE(best.is_object());
  // As far apart as the least different pair of members.
  double least = 1e9;
  for (const auto& [name, one] : best["transient_length"].items())
    for (const auto& [other, two] : best["transient_length"].items())
      if (name < other) least = std::min(least, std::abs(one.get<double>() - two.get<double>()));
  CHECK(best["separation"].get<double>() == Approx(least));
}

TEST_CASE("wrong keys of a string are refused with place and cure", "[app][string]") {
  const Folder folder;
  const auto refused = [&](const std::string& arguments, const std::vector<std::string>& words) {
    const auto answer = run_rosin(folder, arguments);
    CAPTURE(arguments, answer.error);
    CHECK(answer.status == 2);
    for (const auto& word : words) CHECK_THAT(answer.error, Contains(word));
  };
  refused("stability " + scenes_of_strings + "bowed-string.toml", {"a bow at rest does not slide"});
  refused(string + "--set oscillator.impedence=1", {"did you mean 'impedance'"});
  refused(string + "--set oscillator.sample_rate=16000", {"torsional waves", "take about"});
  refused(string + "--set oscillator.torsion=true", {"false, or a table"});
  refused(string + "--set oscillator.bow.width=0.01", {"no effect on a bow of one contact"});
  refused(string + "--set oscillator.bow.hair_damping=1", {"hair_stiffness"});
  refused(string + "--set oscillator.bow.contacts=5", {"between neighbouring contacts"});
  refused(string + "--set law.contact_stiffness.per_load=100", {"the hair of the bow is its spring"});
  refused(string + "--set transient.most=40", {"do not fit into run.periods"});
  refused(string + "--set run.duration=1 --set run.periods=2", {"not both"});
  refused(string + "--set oscillator.sample_rate=1e9", {"samples in a period of the string", "take at most"});
  refused(string + "--set run.duration=9999", {"more than 1e+08", "shorter run.duration"});
  refused(string + "--set drive.speed=0.1", {"give the duration"});
  refused(string + "--set drive.force=1", {"unknown key 'force'"});
  refused(string + "--set drive.speed='{approach={to=0.1,time=0}}'", {"drive.speed.approach.time"});
  const auto map = "map " + scenes_of_strings + "guettler-diagram.toml --no-pictures ";
  refused(map + "--set map.y.parameter=drive.speed.ramp.rate", {"the same parameter"});
  refused(map + "--set map.x.parameter=oscillator.bow_positon", {"oscillator.bow_position"});
  refused(map + "--set map.metrics='[\"period\"]'", {"unknown key 'metrics'"});
  refused("compare " + scenes_of_strings + "which-law-plays-the-cello.toml --set compare.members='[{name=\"a\"}]'",
          {"two members or more"});
}

TEST_CASE("sliding of the bow, periodic motion and sweeps of a string have numbers with errors", "[app][string]") {
  const Folder folder;
  const auto scene = scenes_of_strings + "schelleng-diagram.toml --no-pictures --out out ";
  const auto sliding =
      answer_of_string(folder, "stability " + scene + "--set drive.speed=0.1 --set drive.normal_load=0.05");
  CHECK(sliding["stable"] == false);
  CHECK(sliding["jumps"] == false);
  CHECK(sliding["unstable_modes"].get<int>() > 0);
  const auto& fastest = sliding["modes"][0];
  CHECK(fastest["growth_rate"].get<double>() > 100 * fastest["error"]["eigenvalue"].get<double>());
  const auto pressed = answer_of_string(folder, "stability " + scene + "--set drive.normal_load=3");
  CHECK(pressed["jumps"] == true);
  CHECK(pressed["modes"].empty());

  const auto cycle = answer_of_string(folder, "cycle " + scene + "--set drive.normal_load=0.5");
  CHECK(cycle["regime"] == "helmholtz");
  CHECK(std::abs(cycle["period"].get<double>() * 146.8 - 1) < 0.01);
  CHECK(cycle["error"]["period"].get<double>() < 1e-4);
  CHECK(content(folder.path / "out/cycle.csv").size() > 1000);

  const auto sweep =
      answer_of_string(folder, "sweep " + scene +
                                   "--set 'sweep={parameter=\"drive.normal_load\", from=0.4, to=0.6, points=3, "
                                   "scale=\"linear\"}' --set cycle.periods=60");
  REQUIRE(sweep["up"]["period"].size() == 3);
  CHECK(sweep["regime"]["up"][1] == "cycle");
  CHECK(sweep["error"]["up"]["slip_distance"][1].get<double>() > 0);
  // A plane of one axis is that sweep.
  const auto map =
      answer_of_string(folder, "map " + scene +
                                   "--set 'map={ x={ parameter=\"drive.normal_load\", from=0.4, to=0.6, points=3, "
                                   "scale=\"linear\" } }' --set cycle.periods=60");
  CHECK(map["up"] == sweep["up"]);
  CHECK(map["error"] == sweep["error"]);
}

TEST_CASE("a sweep of a string goes up and down from the motion before", "[app][string]") {
  const Folder folder;
  const auto sweep = "sweep " + scenes_of_strings + "hysteresis-of-bow-force.toml --no-pictures --out out ";
  const auto document =
      answer_of_string(folder, sweep + "--set sweep.from=0.14 --set sweep.to=0.35 --set sweep.points=2");
  CHECK(document["up"]["slips_per_period"] == nlohmann::json({2, 1}));
  CHECK(document["down"]["slips_per_period"] == nlohmann::json({1, 1}));
  for (const auto& [arguments, word] :
       {std::pair{"--set sweep.start=scene", "sweep.direction has no effect"},
        {"--set sweep.parameter=oscillator.quality --set sweep.from=50 --set sweep.to=90",
         "along drive.speed or drive.normal_load"}}) {
    const auto answer = run_rosin(folder, sweep + arguments);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(word));
  }
}

TEST_CASE("strings are compared by run and cycle, with the numbers of those verbs", "[app][string][compare]") {
  const Folder folder;
  for (const auto& [protocol, metric, table] :
       {std::tuple{"cycle", "slip_distance", "--set cycle.periods=60 "},
        std::tuple{"run", "bridge_force", "--set run.duration=0.1 --set run.start=helmholtz "}}) {
    CAPTURE(protocol);
    const auto scene = scenes_of_strings + "schelleng-diagram.toml --no-pictures --out out " + table;
    const auto compared =
        answer_of_string(folder, "compare " + scene + "--set 'compare={ protocol = \"" + protocol +
                                     "\", members = [{ name = \"a\", set = { \"drive.normal_load\" = 0.4 } }, { name = "
                                     "\"b\", set = { \"drive.normal_load\" = 0.6 } }]}'");
    const auto& row = compared["differences"][metric];
    for (const auto& [member, load] : {std::pair{0, "0.4"}, {1, "0.6"}}) {
      const auto alone = answer_of_string(folder, protocol + (" " + scene) + "--set drive.normal_load=" + load);
      const auto& value = protocol == std::string("run") ? alone["metrics"][metric] : alone[metric];
      CHECK(row["values"][std::size_t(member)] == value);
      CHECK(row["errors"][std::size_t(member)] == alone["error"][metric]);
    }
  }
}

TEST_CASE("questions that have no meaning for a string are refused with the reason", "[app][string]") {
  const Folder folder;
  for (const auto& [verb, reason] :
       {std::pair{"branch", "all its waves"}, std::pair{"basin --set basin.samples=2", "all its waves"}}) {
    const auto answer =
        run_rosin(folder, std::string(verb) + " --out out " + scenes_of_strings + "schelleng-diagram.toml");
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(reason));
  }
  const auto changing = run_rosin(folder, "cycle " + scenes_of_strings + "bowed-string.toml --out out");
  CHECK(changing.status == 2);
  CHECK_THAT(changing.error, Contains("drive.speed"));
}
