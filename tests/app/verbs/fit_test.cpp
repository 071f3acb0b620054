/// The verb fit on records as laboratories have them: numbers within intervals, warnings, tables, and refusals.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/app/command.hpp"
#include "tests/app/folder.hpp"

using namespace rosin::tests;
using Catch::Contains;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::string records = ROSIN_SOURCE_DIR "/tests/records/";

/// A step of a slip law behind a machine, with these keys of the data.
std::string layer(const std::string& keys) {
  return "[law]\ntype = 'slip'\nmu0 = 0.59\na = 0.006\nb = 0.006\nL = '20 um'\nv0 = '10 um/s'\n"
         "[law.contact_stiffness]\nper_load = 1e3\n[drive]\nspeed = '10 um/s'\nnormal_load = 20\n"
         "[fit]\nparameters = ['law.a', 'law.b', 'law.L', 'law.contact_stiffness.per_load', 'law.mu0']\n"
         "data = [{ type = 'velocity-step', file = '" +
         records + "step-on-a-weakening-layer.csv', " + keys + " }]\n";
}

struct Answer {
  int status;
  json document;
  std::string error;
};
Answer fit(const Folder& folder, const std::string& scene, const std::string& options = "") {
  std::ofstream(folder.path / "scene.toml") << scene;
  const auto answer = run_rosin(folder, "fit scene.toml --json " + options);
  return {answer.status, answer.out.empty() ? json() : json::parse(answer.out), answer.error};
}

void check_within(const json& parameters, const std::string& path, double truth) {
  INFO(path << ": " << parameters[path].dump());
  CHECK(parameters[path]["interval"][0].get<double>() < truth);
  CHECK(parameters[path]["interval"][1].get<double>() > truth);
}

}  // namespace

TEST_CASE("a step on a layer that weakens gives the law with a trend, and a warning without", "[fit-command]") {
  // Made with a 0.008, b 0.005, L 12 um, machine 2500 1/m and a trend of -7 1/m of displacement, noise 5e-4.
  const Folder folder;
  const std::string step = "from = '10 um/s', to = '30 um/s', standard_error = 5e-4";
  const auto without = fit(folder, layer(step));
  CHECK(without.document["parameters"]["law.L"]["value"].get<double>() > 60e-6);
  CHECK_THAT(without.document["warnings"].dump(), Contains("trend = true"));
  CHECK(without.document["measurements"][0]["durbin_watson"].get<double>() < 1.5);
  for (const std::string trend : {"true", "'displacement'"}) {
    const auto with = fit(folder, layer(step + ", trend = " + trend));
    REQUIRE(with.status == 0);
    const auto& found = with.document["parameters"];
    check_within(found, "law.a", 0.008);
    check_within(found, "law.b", 0.005);
    check_within(found, "law.L", 12e-6);
    check_within(found, "law.contact_stiffness.per_load", 2500);
    CHECK(found["data.1.trend"]["unit"] == (trend == "true" ? "1/s" : "1/m"));
    CHECK(with.document["warnings"].empty());
  }
}

TEST_CASE("LuGre comes back from a recorded motion, with tables of the fit and of correlations", "[fit-command]") {
  const Folder folder;
  const std::string scene =
      "[law]\ntype = 'lugre'\nmu_s = 0.3\nmu_d = 0.2\nv_s = 0.02\nsigma0 = 2e3\nsigma1 = 1\nsigma2 = 0\n"
      "[drive]\nspeed = 0\nnormal_load = 100\n[fit]\n"
      "parameters = ['law.mu_s', 'law.mu_d', 'law.v_s', 'law.sigma0', 'law.sigma1']\n"
      "data = [{ type = 'record', file = '" +
      records + "lugre-motion.csv', standard_error = 0.2 }]\n";
  const auto found = fit(folder, scene, "--out out");
  INFO(found.error);
  REQUIRE(found.status == 0);
  const auto& parameters = found.document["parameters"];
  check_within(parameters, "law.mu_s", 0.25);
  check_within(parameters, "law.mu_d", 0.15);
  check_within(parameters, "law.v_s", 0.01);
  check_within(parameters, "law.sigma0", 1000);
  check_within(parameters, "law.sigma1", 2);
  std::ifstream curve(folder.path / "out/fit-curve-1.csv");
  std::string header, row;
  std::getline(curve, header);
  CHECK(header == "time (s),data,fit,residual,standard error,displacement (m)");
  std::getline(curve, row);
  std::istringstream cells(row);
  double time, data, fitted, residual;
  char comma;
  cells >> time >> comma >> data >> comma >> fitted >> comma >> residual;
  CHECK(data == Approx(0.4082));
  CHECK(residual == Approx(data - fitted));
  std::ifstream correlation(folder.path / "out/fit-correlation.csv");
  std::getline(correlation, header);
  CHECK(header == "law.mu_s,law.mu_d,law.v_s,law.sigma0,law.sigma1");
  std::getline(correlation, row);
  CHECK(row.starts_with("1,"));
}

TEST_CASE("keys that a measurement does not listen to, and programs that say things twice, are refused",
          "[fit-command]") {
  const Folder folder;
  const auto refusal = [&](const std::string& keys) {
    const auto answer = fit(folder, layer(keys));
    CHECK(answer.status == 2);
    return answer.error;
  };
  const std::string from = "from = '10 um/s', ";
  CHECK_THAT(refusal(from + "to = 1, speed = 1"), Contains("fit.data.speed has no effect on a velocity-step"));
  CHECK_THAT(refusal(from + "to = 1, steps = [[0, 1]]"), Contains("steps say it already"));
  CHECK_THAT(refusal(from + "steps = [[0, 1], [0, 2]]"), Contains("must follow each other"));
  CHECK_THAT(refusal(from + "steps = [[0]]"), Contains("[at, slip rate]"));
  CHECK_THAT(refusal(from + "to = 1, trend = 3"), Contains("true, \"time\" or \"displacement\""));
  CHECK_THAT(refusal(from + "to = 1, step_at = 100"), Contains("before the step"));
  CHECK_THAT(refusal(from + "to = 1, over = 'displacement'"), Contains("no column 'displacement'"));
  // A level of the laboratory and one of the law are one.
  const auto twice = fit(folder, layer(from + "to = '30 um/s', base = true, trend = true, standard_error = 5e-4"));
  CHECK(twice.status == 1);
  CHECK_THAT(twice.error, Contains("a combination of it with data.1.base"));
}

TEST_CASE("the catalogue of a run's slip events is data of a fit", "[fit-command]") {
  const Folder folder;
  const std::string model =
      "[law]\ntype = 'coulomb'\nmu_s = 0.4\nmu_d = 0.3\n[oscillator]\nmass = 2\nstiffness = 50\n"
      "[drive]\nspeed = 0.2\nnormal_load = 10\n";
  std::ofstream(folder.path / "run.toml") << model << "[run]\nduration = 40\nsamples = 20000\nstart = 'rest'\n";
  REQUIRE(run_rosin(folder, "run run.toml --no-pictures --quiet --out out").status == 0);
  const std::string data = "{ type = 'stick-slip', file = 'out/stick-slip.csv'";
  const auto scene = [&](const std::string& keys) {
    return model + "[fit]\nparameters = ['law.mu_s']\ndata = [" + data + keys + " }]\n";
  };
  const auto found = fit(folder, scene(", events = ['force_drop'], standard_error = 1e-3"), "--set law.mu_s=0.45");
  INFO(found.error);
  REQUIRE(found.status == 0);
  check_within(found.document["parameters"], "law.mu_s", 0.4);
  CHECK(found.document["parameters"]["law.mu_s"]["standard_error"].get<double>() < 1e-3);
  CHECK_THAT(fit(folder, scene(", standard_error = 1e-3")).error, Contains("events = [\"recurrence\"]"));
  CHECK_THAT(fit(folder, scene(", trend = true")).error, Contains("no effect on a stick-slip"));
  CHECK_THAT(fit(folder, scene(", columns = { slip_rate = 2 }")).error, Contains("unknown key 'slip_rate'"));
  // The same out of the load cell: the spring's force is -50 N/m times displacement.
  const std::string record =
      model +
      "[fit]\nparameters = ['law.mu_s']\ndata = [{ type = 'stick-slip-record', file = 'out/run.csv', "
      "columns = { friction_force = { column = 'displacement', factor = 50, unit = 'N' } } }]\n";
  const auto read_off = fit(folder, record, "--set law.mu_s=0.45");
  INFO(read_off.error);
  REQUIRE(read_off.status == 0);
  CHECK(read_off.document["parameters"]["law.mu_s"]["value"].get<double>() == Approx(0.4).margin(2e-3));
  CHECK_THAT(read_off.error, Contains("events"));
  CHECK_THAT(fit(folder, record, "--set \"fit.data.1.least_drop='9 N'\"").error, Contains("0 whole events"));
}
