/// A slider is a structure of one coordinate: the same scene in both forms has the same numbers by every verb, within
/// the sum of their stated errors, under the same names.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <tuple>
#include <vector>

#include "tests/app/command.hpp"

namespace {

using nlohmann::json;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

/// A slider that oscillates under a law.
struct Case {
  std::string law;  ///< its table
  double mass, stiffness, damping, speed, load;
};

std::string scene_of(const Case& of, bool as_structure) {
  const auto oscillator =
      as_structure
          ? fmt::format("type = 'structure'\nM = [[{}]]\nC = [[{}]]\nK = [[{}]]\ncontacts = [{{ tangential = [1] }}]\n",
                        of.mass, of.damping, of.stiffness)
          : fmt::format("type = 'slider'\nmass = {}\ndamping = {}\nstiffness = {}\n", of.mass, of.damping,
                        of.stiffness);
  return fmt::format("[law]\n{}\n[oscillator]\n{}[drive]\nspeed = {}\nnormal_load = {}\n", of.law, oscillator, of.speed,
                     of.load);
}

/// The coordinate of a structure is numbered.
std::string unnumbered(const std::string& text) {
  return std::regex_replace(text, std::regex("(displacement|velocity|acceleration)_1"), "$1");
}
std::string numbered(const std::string& table) {
  return std::regex_replace(table, std::regex("(displacement|velocity|acceleration)(_m|')"), "$1_1$2");
}

/// The documents of both forms.
struct Both {
  json slider, structure;
  std::string columns[2];  ///< the header of the verb's table, if it has one
};
Both ask(const Case& of, const std::string& verb, const std::string& table) {
  Both both;
  for (const bool as_structure : {false, true}) {
    const Folder folder;
    std::ofstream(folder.path / "scene.toml") << scene_of(of, as_structure) << (as_structure ? numbered(table) : table);
    const auto answer =
        run_rosin(folder, verb + " scene.toml --json --no-pictures --out out --tolerance 1e-7 --time-limit 300");
    CAPTURE(verb, as_structure, answer.error);
    REQUIRE(answer.status == 0);
    (as_structure ? both.structure : both.slider) = json::parse(unnumbered(answer.out));
    std::getline(std::ifstream(folder.path / "out" / (verb + ".csv")), both.columns[as_structure]);
    both.columns[as_structure] = unnumbered(both.columns[as_structure]);
  }
  return both;
}

/// Angles differ by whole turns.
double difference(const std::string& name, double a, double b) {
  return name.find("_phase_") != name.npos ? std::remainder(a - b, 2 * std::numbers::pi) : a - b;
}

/// Every number whose error stands at the same place of `error`: a number, or one for a list.
void compare(const std::string& name, const json& a, const json& b, const json& error_a, const json& error_b) {
  CAPTURE(name);
  if (a.is_object()) {
    for (const auto& [key, of_key] : a.items()) {
      CAPTURE(key);
      REQUIRE(b.contains(key));
      if (error_a.contains(key)) compare(key, of_key, b[key], error_a[key], error_b.value(key, json()));
    }
    CHECK(a.size() == b.size());
  } else if (a.is_array()) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      compare(name, a[i], b[i], error_a.is_array() ? error_a[i] : error_a, error_b.is_array() ? error_b[i] : error_b);
  } else if (a.is_number() && error_a.is_number() && error_b.is_number()) {
    constexpr double digits = 1e-13, rest = 1e-20;  // rounding of what is known exactly; m/s at which a contact rests
    const double x = a.get<double>(), y = b.get<double>();
    CAPTURE(x, y, error_a.get<double>(), error_b.get<double>());
    CHECK(std::abs(difference(name, x, y)) <=
          error_a.get<double>() + error_b.get<double>() + digits * std::max(std::abs(x), std::abs(y)) + rest);
  }
}

void compare_cycles(const Case& of) {
  const auto [slider, structure, columns] = ask(of, "cycle", "");
  CHECK(columns[0] == columns[1]);
  const bool jumps = slider["ill_conditioned_stick"].get<bool>();
  for (const auto& [name, error] : slider["error"].items()) {
    REQUIRE(structure["error"].contains(name));
    if (name == "multipliers" || (jumps && name.find("fraction") != name.npos)) continue;
    compare(name, slider[name], structure[name], error, structure["error"][name]);
  }
  CHECK(slider["error"].size() == structure["error"].size());
  CHECK(slider["stable"] == structure["stable"]);
  CHECK(slider["returns"] == structure["returns"]);
}

/// Laws with their usual parameters on a soft spring, or 0.7 of the stiffness below which sliding is unstable.
std::vector<Case> cases() {
  std::vector<Case> cases;
  for (const auto& [law, stiffness, speed] : {std::tuple{"hyperbolic", 1.0, 0.1},
                                              {"coulomb", 1.0, 0.1},
                                              {"stribeck", 1.0, 0.1},
                                              {"two-exponential", 1.0, 0.1},
                                              {"ageing", 350.0, 1e-6},
                                              {"slip", 350.0, 1e-6},
                                              {"prz", 350.0, 1e-6},
                                              {"nagata", 120.0, 1e-6},
                                              {"two-state-ageing", 120.0, 1e-6},
                                              {"bowden-tabor", 1e4, 1e-6},
                                              {"flash-heating", 140.0, 1e-6},
                                              {"slip-distance", 1.0, 0.1},
                                              {"static-growth", 1.0, 0.1},
                                              {"kato-growth", 1.0, 0.1},
                                              {"loading-rate", 1.0, 0.1},
                                              {"hot-film", 3100.0, 0.1}})
    cases.push_back({fmt::format("type = '{}'", law), 1, stiffness, 0, speed, 1});
  cases.push_back({"type = 'spinodal'\npreset = 'bristol-board'\nlambda = 10", 1, 1.09, 0, 1e-5, 9.81e-4});
  cases.push_back({"type = 'ageing'", 0, 350, 1, 1e-6, 1});  // without mass
  return cases;
}

}  // namespace

TEST_CASE("a slider is a structure of one coordinate by every metric of its cycle", "[app][cycle][long]") {
  for (const auto& of : cases()) {
    CAPTURE(of.law);
    compare_cycles(of);
  }
}

TEST_CASE("a slider is a structure of one coordinate by every verb", "[app][long]") {
  for (const auto& of : cases()) {
    CAPTURE(of.law);
    const double natural = 2 * std::numbers::pi * std::sqrt((of.mass > 0 ? of.mass : 1) / of.stiffness),
                 size = of.load / of.stiffness, low = 0.95 * of.load;
    const auto range = fmt::format("parameter = 'drive.normal_load', from = {}, to = {}", low, of.load);
    const auto both = [&](const char* verb, const std::string& table) { return ask(of, verb, table); };
    {
      const auto start = of.mass > 0 ? fmt::format("{{ displacement = {}, velocity = {} }}", 0.3 * size, 0.5 * of.speed)
                                     : std::string("'steady'");  // without mass the spring bears friction
      const auto [slider, structure, columns] =
          both("run", fmt::format("[run]\nduration = {}\nsamples = 40\nstart = {}\n", 2 * natural, start));
      CHECK(columns[0] == columns[1]);
      CHECK(slider["units"] == structure["units"]);
      compare("columns", slider["columns"], structure["columns"], slider["error"], structure["error"]);
      for (const auto& [name, value] : slider["metrics"].items())
        if (slider["error"].contains(name))
          compare(name, value, structure["metrics"].at(name), slider["error"][name], structure["error"].at(name));
    }
    {
      const auto [slider, structure, columns] = both("stability", "");
      CHECK(slider["stable"] == structure["stable"]);
      CHECK(slider["eigenvalues"].size() == structure["eigenvalues"].size());
      compare("growth_rate", slider["eigenvalues"][0][0], structure["eigenvalues"][0][0], 0,
              structure["modes"][0]["error"]["eigenvalue"]);
    }
    const auto metrics = std::string("metrics = ['period', 'stick_fraction', 'friction_work', 'displacement_max']\n");
    const auto along = [&](const char* verb, const std::string& table) {
      const auto [slider, structure, columns] = both(verb, table);
      compare("up", slider["up"], structure["up"], slider["error"]["up"], structure["error"]["up"]);
      CHECK(slider["regime"] == structure["regime"]);
    };
    along("sweep", fmt::format("[sweep]\nparameter = 'drive.normal_load'\nfrom = {}\nto = {}\npoints = 2\nrecord = "
                               "'metrics'\n{}",
                               low, of.load, metrics));
    along("map", fmt::format("[map]\nx = {{ {}, points = 2 }}\n{}", range, metrics));
    {
      const auto [slider, structure, columns] =
          both("map", fmt::format("[map]\nx = {{ {}, points = 2 }}\ny = {{ parameter = 'drive.speed', from = {}, to = "
                                  "{}, points = 2 }}\nmetrics = ['period', 'loop_area', 'slip_rate_max']\n",
                                  range, of.speed, 1.02 * of.speed));
      compare("metrics", slider["metrics"], structure["metrics"], slider["error"], structure["error"]);
    }
    {
      const auto [slider, structure, columns] =
          both("branch", fmt::format("[branch]\nparameter = 'drive.normal_load'\nfrom = {}\nto = {}\nstart = "
                                     "'steady'\n",
                                     low, of.load));
      REQUIRE(slider["events"].size() == structure["events"].size());
      for (std::size_t i = 0; i < slider["events"].size(); ++i) {
        CHECK(slider["events"][i]["kind"] == structure["events"][i]["kind"]);
        compare("value", slider["events"][i]["value"], structure["events"][i]["value"], slider["events"][i]["error"],
                structure["events"][i]["error"]);
      }
    }
    {
      const auto [slider, structure, columns] =
          both("lyapunov", fmt::format("[lyapunov]\nduration = {}\n", 20 * natural));
      CHECK(slider["from"] == structure["from"]);
      compare("exponents", slider["exponents"], structure["exponents"], slider["standard_error"],
              structure["standard_error"]);
    }
    {
      const auto [slider, structure, columns] =
          both("basin", fmt::format("[basin]\nx = {{ start = 'displacement', from = 0, to = {}, points = 2 }}\ny = {{ "
                                    "start = 'slip_rate', from = {}, to = {}, points = 2 }}\n",
                                    0.5 * size, 0.5 * of.speed, 1.5 * of.speed));
      CHECK(slider["labels"] == structure["labels"]);
      REQUIRE(slider["attractors"].size() == structure["attractors"].size());
      for (std::size_t i = 0; i < slider["attractors"].size(); ++i) {
        const auto &a = slider["attractors"][i], &b = structure["attractors"][i];
        CHECK(a["kind"] == b["kind"]);
        compare("metrics", a["metrics"], b["metrics"], a["error"], b["error"]);
      }
    }
    {
      const auto [slider, structure, columns] =
          both("compare", fmt::format("[compare]\nmembers = [{{ name = 'as it is' }}, {{ name = 'lighter', set = {{ "
                                      "'drive.normal_load' = {} }} }}]\n",
                                      low));
      CHECK(slider["differences"].size() == structure["differences"].size());
      for (const auto& [metric, row] : slider["differences"].items()) {
        REQUIRE(structure["differences"].contains(metric));
        const auto& other = structure["differences"][metric];
        CHECK(row["unit"] == other["unit"]);
        compare(metric, row["values"], other["values"], row["errors"], other["errors"]);
      }
    }
  }
}

TEST_CASE("a design measures any metric of a slider, as of a structure", "[app][compare]") {
  const auto [slider, structure, columns] = ask(
      cases().front(), "compare --design",
      "[map]\nx = { parameter = 'drive.speed', from = 0.2, to = 0.25, points = 2 }\ny = { parameter = "
      "'drive.normal_load', from = 1, to = 1.2, points = 2 }\n[compare]\nprotocol = 'map'\nmembers = [{ name = 'a' }, "
      "{ name = 'b', set = { 'law.mu_s' = 0.5 } }]\nnoise = { friction_work = { relative = 0.05 }, "
      "acceleration_max = { relative = 0.05 } }\n");
  CHECK(slider["best"]["discriminability"].get<double>() > 0);
  compare("discriminability", slider["discriminability"], structure["discriminability"],
          slider["discriminability_error"], structure["discriminability_error"]);
}
