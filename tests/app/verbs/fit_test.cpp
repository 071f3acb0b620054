/// The verb fit on records as laboratories have them: numbers within intervals, warnings, tables, and refusals.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
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

TEST_CASE("a step on a layer that weakens gives the law with a trend, and a warning without", "[fit-command][long]") {
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
          "[fit-command][long]") {
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

TEST_CASE("derived numbers stand beside the parameters, and what cannot be derived is refused", "[fit-command]") {
  const Folder folder;
  const auto derived = [&](const std::string& table) {
    return run_rosin(folder, "fit " ROSIN_SOURCE_DIR
                             "/cases/rate-and-state/critical-stiffness-from-a-steady-curve.toml --no-pictures --json "
                             "--set fit.derived='" +
                                 table + "'");
  };
  const auto found = derived("{ \"a-b\" = \"law.a - law.b\" }");
  REQUIRE(found.status == 0);
  const auto document = nlohmann::json::parse(found.out);
  const auto &number = document["derived"]["a-b"], &a = document["parameters"]["law.a"];
  CHECK(number["value"].get<double>() == Approx(-0.005).epsilon(1e-9));
  CHECK(number["unit"] == "1");
  CHECK(number["formula"] == "law.a - law.b");
  CHECK(number["standard_error"].get<double>() == Approx(a["standard_error"].get<double>()).epsilon(1e-9));
  CHECK(document["ranking"][0]["derived"] == document["derived"]);
  for (const auto& [table, why] :
       {std::pair{"{ k = \"law.a - law.L\" }", "their units differ"},
        std::pair{"{ k = \"law.aa\" }", "did you mean 'law.a'?"},
        std::pair{"{ k = \"law.b*2\" }", "holds no number that is fitted"},
        std::pair{"{ k = \"law.a*drive.speed\" }", "the scene has no drive.speed"},
        std::pair{"{ \"law.a\" = \"law.a\" }", "take another"}, std::pair{"[1]", "a table of formulas"}}) {
    const auto refused = derived(table);
    INFO(table);
    CHECK(refused.status == 2);
    CHECK_THAT(refused.error, Contains(why));
  }
}

TEST_CASE("one coefficient at rest and in motion is the mean of measured ones, and one beyond the other is told",
          "[fit-command]") {
  const Folder folder;
  std::ofstream(folder.path / "data.csv")
      << "slip_rate,friction_coefficient\nm/s,-\n0.01,0.43\n0.02,0.42\n0.05,0.425\n0.1,0.435\n";
  const auto fitted = [&](const std::string& law, const std::string& parameter) {
    std::ofstream(folder.path / "fit.toml")
        << "[law]\ntype = 'coulomb'\n"
        << law << "[drive]\nspeed = 0.01\nnormal_load = 10\n[fit]\nparameters = ['" << parameter
        << "']\ndata = [{ type = 'steady-curve', file = 'data.csv' }]\n";
    const auto run = run_rosin(folder, "fit fit.toml --json --no-pictures");
    return std::pair(nlohmann::ordered_json::parse(run.out)["parameters"][parameter], run.error);
  };
  const auto [both, quiet] = fitted("mu = 0.4\n", "law.mu");
  CHECK(both["value"].get<double>() == Approx(0.4275).epsilon(1e-9));
  CHECK(both["standard_error"].get<double>() == Approx(0.0064550 / 2).epsilon(1e-3));
  const auto [held, told] = fitted("mu_s = 0.4\nmu_d = 0.3\n", "law.mu_d");  // which the law does not allow beyond mu_s
  CHECK(held["at_bound"] == true);
  CHECK_THAT(told, Contains("the data bound law.mu_d on one side only"));
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

TEST_CASE("one friction curve, as three instruments write it, is one law", "[fit-command]") {
  // mu = 0.3 + 0.1 exp(-(v/v_s)^2), to rounding
  const auto curve = [](const std::string& head, double v_s, const std::string& first) {
    std::string text = head;
    for (int i = 0; i < 14; ++i) {
      const double v = v_s * std::pow(10, -1.3 + i / 6.0), mu = 0.3 + 0.1 * std::exp(-v * v / (v_s * v_s));
      text += fmt::format("{}{:.12g},{:.12g}\n", first.empty() ? "" : first + ",", v, mu);
    }
    return text;
  };
  const auto xlook = [&] {
    std::string text =
        "number of records = 14\n            col 1       col 2\n           LP_Vel          mu\n"
        "          mic/sec           .\n          14 recs     14 recs\n";
    for (int i = 0; i < 14; ++i) {
      const double v = 20e3 * std::pow(10, -1.3 + i / 6.0), mu = 0.3 + 0.1 * std::exp(-v * v / (20e3 * 20e3));
      text += fmt::format("{:5}{:12.9g}{:12.9g}\n", i + 1, v, mu);
    }
    return text;
  };
  struct Export {
    std::string table, column;
    double v_s;  ///< m/s
  };
  for (const auto& [table, column, v_s] :
       {Export{curve("\"Rig 7\"\n\"Unit\",\"mm/s\",\"-\"\n\"Ch\",\"Speed\",\"mu\"\n", 20, "1"), "'Speed'", 0.02},
        Export{xlook(), "'LP_Vel'", 0.02},
        // at 20 mm a turn a second is 0.12566 m/s
        Export{curve("n (1/min),mu\n", 60, ""), "1", 2 * M_PI * 0.02}}) {
    INFO(table);
    const Folder folder;
    std::ofstream(folder.path / "curve.csv") << table;
    const auto found =
        fit(folder,
            "[law]\ntype = 'stribeck'\nmu_s = 0.45\nmu_d = 0.25\nv_s = 0.05\n[oscillator]\nradius = 0.02\nmass = 0\n"
            "stiffness = 1\n[drive]\nspeed = 0.01\nnormal_load = 1\n[fit]\nprofiles = false\nfolds = 0\n"
            "parameters = ['law.mu_s', 'law.mu_d', 'law.v_s']\ndata = [{ type = 'steady-curve', file = 'curve.csv', "
            "standard_error = 1e-4, columns = { slip_rate = " +
                column + ", friction_coefficient = 'mu' } }]\n");
    REQUIRE(found.status == 0);
    const auto& parameters = found.document["parameters"];
    CHECK(parameters["law.mu_s"]["value"].get<double>() == Approx(0.4).epsilon(1e-6));
    CHECK(parameters["law.mu_d"]["value"].get<double>() == Approx(0.3).epsilon(1e-6));
    CHECK(parameters["law.v_s"]["value"].get<double>() == Approx(v_s).epsilon(1e-6));
  }
}

TEST_CASE("a record of stresses needs the area of its contact alone, and a load that somebody says", "[fit-command]") {
  const Folder folder;
  const auto scene = [&](const std::string& oscillator, const std::string& keys) {
    return "[law]\ntype = 'lugre'\nmu_s = 0.3\nmu_d = 0.2\nv_s = 0.02\nsigma0 = 2e3\nsigma1 = 1\nsigma2 = 0\n" +
           oscillator + "[fit]\nparameters = ['law.mu_d', 'law.sigma0']\ndata = [{ type = 'record', file = '" +
           records + "lugre-motion.csv', " + keys + " }]\n";
  };
  const auto forces = fit(folder, scene("", "normal_load = 100, standard_error = 0.2"));
  REQUIRE(forces.status == 0);
  const std::string in_stress =
      "columns = { friction_force = { column = 'friction_force', factor = 1, unit = 'MPa' } }, standard_error = '0.2 "
      "MPa'";
  const auto stresses = fit(folder, scene("[oscillator]\narea = '3 mm^2'\n", in_stress + ", normal_load = '100 MPa'"));
  INFO(stresses.error);
  REQUIRE(stresses.status == 0);
  for (const char* path : {"law.mu_d", "law.sigma0"})
    CHECK(stresses.document["parameters"][path]["value"].get<double>() ==
          Approx(forces.document["parameters"][path]["value"].get<double>()).epsilon(1e-6));
  CHECK_THAT(stresses.error, !Contains("has no effect"));
  CHECK_THAT(fit(folder, scene("", in_stress)).error, Contains("oscillator.area"));
  const auto no_load = fit(folder, scene("", "standard_error = 0.2"));
  CHECK(no_load.status == 2);
  CHECK_THAT(no_load.error, Contains("fit.data.normal_load or drive.normal_load"));
}

TEST_CASE("stick-slip with noise and spikes has the events that were made, and their limits are said",
          "[fit-command]") {
  // 0.4 N up in 1.8 s and down in 0.2 s, with noise of 0.03 N and a spike of 5 N each 5 s; the last fall ends with the
  // record.
  const Folder folder;
  std::ofstream file(folder.path / "cell.csv");
  file << "time (s),force (N)\n";
  std::mt19937 dice(3);
  std::normal_distribution<double> noise(0, 0.03);
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.002 * i, phase = std::fmod(t, 2);
    file << t << ','
         << 2.8 + 0.4 * (phase < 1.8 ? phase / 1.8 : (2 - phase) / 0.2) + noise(dice) + (i % 2500 == 7 ? 5 : 0) << '\n';
  }
  file.close();
  const std::string scene =
      "[law]\ntype = 'coulomb'\nmu_s = 0.32\nmu_d = 0.30\n[oscillator]\nmass = 0.5\nstiffness = 100\n"
      "[drive]\nspeed = '2 mm/s'\nnormal_load = 10\n[fit]\nparameters = ['law.mu_s']\n"
      "[[fit.data]]\ntype = 'stick-slip-record'\nfile = 'cell.csv'\n"
      "columns = { time = 'time', friction_force = 'force' }\n";
  for (const std::string keys : {"", "least_drop = 0.04\n", "least_drop = 0.3\n", "least_time = 0.03\n"}) {
    INFO(keys);
    const auto found = fit(folder, scene + keys);
    INFO(found.error);
    REQUIRE(found.status == 0);
    const auto notes = found.document["notes"].dump();
    CHECK_THAT(notes, Contains("cell.csv: 19 events") && Contains("samples left out as spikes"));
    CHECK_THAT(notes, Contains("recurrence: 18 of 2.00") || Contains("recurrence: 18 of 1.99"));
  }
  CHECK_THAT(fit(folder, scene + "least_time = -1\n").error, Contains("least_time"));
}

TEST_CASE("a record whose sensor never reads 0 at rest gives the friction of slip", "[fit-command]") {
  // Made with mu_d 0.2; slip rates carry noise of 2 mm/s, a quarter of the record is rest.
  const Folder folder;
  const auto scene = [](const std::string& keys) {
    return "[law]\ntype = 'coulomb'\nmu_s = 0.25\nmu_d = 0.25\n[drive]\nspeed = 0.1\nnormal_load = 400\n"
           "[fit]\nparameters = ['law.mu_d']\ndata = [{ type = 'record', file = '" +
           records +
           "stick-slip-with-noisy-rest.csv', columns = { slip_rate = 'slip rate', friction_force = 'friction', "
           "normal_load = 'load' }" +
           keys + " }]\n";
  };
  for (const std::string rest : {"", ", rest = '8 mm/s'", ", rest = [[0.25, 0.41], [0.68, 0.84]]"}) {
    const auto found = fit(folder, scene(rest));
    INFO(rest << found.error);
    REQUIRE(found.status == 0);
    check_within(found.document["parameters"], "law.mu_d", 0.2);
    CHECK(found.document["parameters"]["law.mu_d"]["standard_error"].get<double>() < 5e-4);
    CHECK(found.document["warnings"].empty());
    const auto& at_rest = found.document["measurements"][0]["rest"];
    CHECK(at_rest["points"].get<int>() > 100);
    CHECK(at_rest["points"].get<int>() + found.document["points"].get<int>() == 1000);
    if (rest.empty()) CHECK(at_rest["slip_rate_noise"].get<double>() == Approx(2e-3).epsilon(0.1));
  }
  // A static coefficient that no slip tells of is bounded by the force that held.
  auto held = scene("");
  held.replace(held.find("'law.mu_d'"), 10, "'law.mu_d', 'law.mu_s'");
  const auto bounded = fit(folder, held);
  CHECK(bounded.document["parameters"]["law.mu_s"]["interval"][0].is_null());
  check_within(bounded.document["parameters"], "law.mu_d", 0.2);
  const auto refusal = [&](const std::string& keys) {
    const auto answer = fit(folder, scene(keys));
    CHECK(answer.status == 2);
    return answer.error;
  };
  CHECK_THAT(refusal(", rest = [[2, 1]]"), Contains("in ascending order"));
  CHECK_THAT(refusal(", rest = []"), Contains("is empty"));
  CHECK_THAT(refusal(", rest = '1 N'"), Contains("fit.data.rest"));
}

TEST_CASE("holds of a slip law fitted by the ageing law are warned of, and each law has its own table",
          "[fit-command][long]") {
  // Made with the slip law: a 0.0072, b 0.0098, L 14 um, machine 2100 1/m, independent noise of 3e-4.
  const Folder folder;
  const std::string law = "mu0 = 0.63, v0 = '10 um/s', L = '20 um', contact_stiffness = { per_load = 2000 } }\n";
  const std::string paths = "parameters = ['law.mu0', 'law.a', 'law.b', 'law.L', 'law.contact_stiffness.per_load']";
  const std::string alone = "law = { type = 'ageing', " + law + "[fit]\n" + paths +
                            "\ndata = [{ type = 'record', file = '" + records + "holds-of-a-slip-law.csv' }]\n";
  const auto wrong = fit(folder, alone);
  CHECK_THAT(wrong.error, Contains("residuals are no noise: after changes of the slip rate"));
  CHECK(wrong.document["parameters"]["law.b"]["interval"][0].is_null());
  CHECK(wrong.document["parameters"]["law.b"]["value"].get<double>() < 0.005);
  CHECK(wrong.document["measurements"][0]["misfit"]["probability"].get<double>() < 1e-6);
  const auto both =
      fit(folder,
          alone + "candidates = [{ law = { type = 'slip', " + law.substr(0, law.size() - 1) + ", " + paths + " }]\n",
          "--out out");
  INFO(both.error);
  const auto& best = both.document["ranking"][0];
  CHECK(best["law"] == "slip");
  CHECK(best["warnings"].empty());
  check_within(best["parameters"], "law.b", 0.0098);
  check_within(best["parameters"], "law.L", 14e-6);
  CHECK(best["cross_validation"].get<double>() == Approx(1).margin(0.1));
  CHECK(both.document["undecided"].empty());
  std::ifstream picture(folder.path / "out/fit.gp");
  const std::string drawn((std::istreambuf_iterator<char>(picture)), {});
  for (const char* law : {"'slip'", "'ageing'"}) CHECK_THAT(drawn, Contains(law));
}

TEST_CASE("the mass that moves with the sensor is taken off the force", "[fit-command]") {
  // Made with mu_s 0.3, mu_d 0.2, v_s 10 mm/s under 20 N, and a carriage of 3 kg below the sensor.
  const Folder folder;
  const auto scene = [](const std::string& keys) {
    return "[law]\ntype = 'stribeck'\nmu_s = 0.4\nmu_d = 0.25\nv_s = '20 mm/s'\nexponent = 1\n"
           "[drive]\nspeed = 0.01\nnormal_load = 20\n[fit]\nparameters = ['law.mu_s', 'law.mu_d', 'law.v_s']\n"
           "data = [{ type = 'record', file = '" +
           records + "motor-and-carriage.csv', columns = { slip_rate = 'velocity', friction_force = 'motor force' }" +
           keys + " }]\n";
  };
  const auto found = fit(folder, scene(", sensor_mass = 3"));
  INFO(found.error);
  REQUIRE(found.status == 0);
  check_within(found.document["parameters"], "law.mu_s", 0.3);
  check_within(found.document["parameters"], "law.mu_d", 0.2);
  check_within(found.document["parameters"], "law.v_s", 0.01);
  CHECK_THAT(fit(folder, scene(", sensor_mass = '1 N'")).error, Contains("fit.data.sensor_mass"));
}
