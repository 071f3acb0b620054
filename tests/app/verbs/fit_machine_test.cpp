/// The verb fit on recorded motions of machines: truths in closed form and of finer runs, all types of oscillators, and
/// refusals.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <sstream>

#include "tests/app/command.hpp"

namespace rosin::tests::machines {

using Catch::Contains;
using nlohmann::json;

namespace {

struct Answer {
  int status;
  json document;
  std::string error;
};
Answer asked(const Folder& folder, const std::string& verb, const std::string& scene, const std::string& options = "") {
  std::ofstream(folder.path / "scene.toml") << scene;
  const auto answer = run_rosin(folder, verb + " scene.toml --json --no-pictures --out out " + options);
  return {answer.status, answer.out.empty() ? json() : json::parse(answer.out), answer.error};
}

using Noise = std::vector<std::pair<std::string, double>>;
/// Writes columns of a run with white noise as a record, each of so many samples.
void write_record(const Folder& folder, const json& run, const Noise& noise, unsigned seed, std::size_t every = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::ofstream file(folder.path / "record.csv");
  file << "time (s)";
  for (const auto& [name, size] : noise) file << fmt::format(",{} ({})", name, run["units"][name].get<std::string>());
  file << '\n';
  for (std::size_t k = 0; k < run["time"].size(); k += every) {
    file << run["time"][k].get<double>();
    for (const auto& [name, size] : noise)
      file << fmt::format(",{:.12g}", run["columns"][name][k].get<double>() + size * normal(random));
    file << '\n';
  }
}

struct Count {
  int inside = 0, all = 0;
};
void count(const json& parameters, const std::map<std::string, double>& truth, Count& count) {
  for (const auto& [path, value] : truth) {
    const auto& interval = parameters[path]["interval"];
    INFO(path << ": " << parameters[path].dump());
    REQUIRE(interval[0].is_number());
    count.inside += interval[0].get<double>() < value && value < interval[1].get<double>();
    ++count.all;
  }
}

/// Two masses, the first on a belt, whose modes at 8.5 and 29 Hz ring at each slip.
std::string two_masses(const std::string& law, const std::string& stiffness, const std::string& rest) {
  return "[law]\n" + law + "\n[oscillator]\ntype = 'two-mass-belt'\nmass = 1\ndamping = 2\nsecond_mass = 0.3\n" +
         "second_damping = 1\n" + stiffness + "\n[drive]\nspeed = 0.2\nnormal_load = 50\n" + rest;
}
const std::string true_stiffness = "stiffness = 4000\nsecond_stiffness = 6000",
                  other_stiffness = "stiffness = 4100\nsecond_stiffness = 5900",
                  true_coulomb = "type = 'coulomb'\nmu_s = 0.4\nmu_d = 0.25",
                  other_coulomb = "type = 'coulomb'\nmu_s = 0.38\nmu_d = 0.27";
std::string run_for(double duration, int samples) {
  return fmt::format("[run]\nduration = {}\nsamples = {}\nstart = 'rest'\n", duration, samples);
}

}  // namespace

TEST_CASE("a slider's stick and slip in closed form gives law and spring back", "[fit-machine]") {
  // In stick x = V t until k x = mu_s N; in slip x − x_d swings with ω from (x_s − x_d, V), until its velocity is V
  // again. Three periods, exact but for the digits written.
  constexpr double m = 2, k = 800, N = 40, V = 0.05, mu_s = 0.5, mu_d = 0.3;
  const double omega = std::sqrt(k / m), x_s = mu_s * N / k, x_d = mu_d * N / k, swing = x_s - x_d;
  const double slip = (2 * std::numbers::pi - 2 * std::atan2(swing * omega, V)) / omega;
  const double first = x_s / V, period = slip + 2 * swing / V;
  const Folder folder;
  std::ofstream file(folder.path / "record.csv");
  file << "time (s),displacement (m)\n";
  for (int i = 0; i < 300; ++i) {
    const double t = i * (first + 3 * period) / 300;
    double x = V * t;
    if (t > first) {
      const double since = std::fmod(t - first, period);
      x = since < slip ? x_d + swing * std::cos(omega * since) + V / omega * std::sin(omega * since)
                       : x_d - swing + V * (since - slip);
    }
    file << fmt::format("{:.15g},{:.15g}\n", t, x);
  }
  file.close();
  const auto found =
      asked(folder, "fit",
            "[law]\ntype = 'coulomb'\nmu_s = 0.47\nmu_d = 0.31\n[oscillator]\nmass = 1.9\nstiffness = 800\n[drive]\n"
            "speed = 0.05\nnormal_load = 40\n[fit]\nparameters = ['law.mu_s', 'law.mu_d', 'oscillator.mass']\n"
            "data = [{ type = 'motion', file = 'record.csv', measured = ['displacement'], start = 'rest', "
            "standard_error = 1e-6 }]\n");
  REQUIRE(found.status == 0);
  const auto& p = found.document["parameters"];
  CHECK(p["law.mu_s"]["value"].get<double>() == Approx(mu_s).epsilon(1e-6));
  CHECK(p["law.mu_d"]["value"].get<double>() == Approx(mu_d).epsilon(1e-6));
  CHECK(p["oscillator.mass"]["value"].get<double>() == Approx(m).epsilon(1e-6));
}

TEST_CASE("masses and springs come back with the law, where clock and start are unknown too", "[fit-machine][long]") {
  const Folder folder;
  const std::string law = "type = 'lugre'\nmu_d = 0.25\nv_s = 0.1\nsigma0 = 1e4\nsigma1 = 10\nsigma2 = 0\nmu_s = ",
                    start = "start = { displacement = 0, second_displacement = 2e-3, velocity = 0.2 }";
  const auto run =
      asked(folder, "run", two_masses(law + "0.4", true_stiffness, "[run]\nduration = 0.3\nsamples = 150\n" + start),
            "--tolerance 1e-10");
  write_record(folder, run.document, {{"displacement", 2e-5}, {"second_velocity", 2e-3}}, 4);
  const auto found =
      asked(folder, "fit",
            two_masses(law + "0.38", other_stiffness,
                       "[fit]\nparameters = ['law.mu_s', 'law.mu_d', 'oscillator.stiffness', 'oscillator.second_mass', "
                       "'data.1.start.second_displacement']\ndata = [{ type = 'motion', file = 'record.csv', measured "
                       "= ['displacement', 'second_velocity'], start = { displacement = 0, second_displacement = 1e-3, "
                       "velocity = 0.2 }, clock_offset = true, base = true }]\nconfidence = 0.999"),
            "--set oscillator.second_stiffness=6000");
  REQUIRE(found.status == 0);
  CHECK(found.document["warnings"].empty());
  Count of;
  count(found.document["parameters"],
        {{"law.mu_s", 0.4},
         {"law.mu_d", 0.25},
         {"oscillator.stiffness", 4000},
         {"oscillator.second_mass", 0.3},
         {"data.1.start.second_displacement", 2e-3},
         {"data.1.clock_offset", 0},
         {"data.1.base", 0},
         {"data.2.base", 0}},
        of);
  CHECK(of.inside == of.all);
  CHECK_FALSE(found.document["parameters"].contains("data.2.clock_offset"));  // both columns have one clock
  CHECK(found.document["measurements"][1]["noise"]["size"].get<double>() == Approx(2e-3).epsilon(0.25));
}

TEST_CASE("over 20 noisy records of stick and slip the truth lies in most intervals", "[fit-machine][long]") {
  const Folder folder;
  const auto run =
      asked(folder, "run", two_masses(true_coulomb, true_stiffness, run_for(0.3, 150)), "--tolerance 1e-11");
  const auto scene =
      two_masses(other_coulomb, other_stiffness,
                 "[fit]\nparameters = ['law.mu_s', 'law.mu_d', 'oscillator.stiffness', "
                 "'oscillator.second_stiffness']\ndata = [{ type = 'motion', file = 'record.csv', measured = "
                 "['second_velocity', 'slip_rate'], start = 'rest' }]\n");
  Count of;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    write_record(folder, run.document, {{"second_velocity", 2e-3}, {"slip_rate", 2e-3}}, seed);
    const auto found = asked(folder, "fit", scene);
    REQUIRE(found.status == 0);
    count(
        found.document["parameters"],
        {{"law.mu_s", 0.4}, {"law.mu_d", 0.25}, {"oscillator.stiffness", 4000}, {"oscillator.second_stiffness", 6000}},
        of);
  }
  CHECK(of.all == 80);
  CHECK(of.inside >= 70);  // 76 are expected, with a standard deviation of 2 to 4
}

TEST_CASE("the motion of every oscillator but strings gives a number of its law back", "[fit-machine]") {
  const struct {
    std::string scene, path, start, column;
    double value;
  } machines[] = {
      {"[law]\ntype = 'hyperbolic'\nmu_s = 1\ndelta = 3\n[oscillator]\ntype = 'chain'\nblocks = 2\nmass = 1\nstiffness "
       "= 1.2\npull_stiffness = 1\n[drive]\nspeed = 0.2\nnormal_load = 1\n",
       "law.delta", "{ coordinates = [0.5, -0.3] }", "displacement_2", 3},
      {"[law]\ntype = 'coulomb'\nmu_s = 0.4\nmu_d = 0.4\n[oscillator]\ntype = 'plane-slider'\nmass = 3\nstiffness = "
       "[400, 200]\ndamping = [2, 2]\n[drive]\nnormal_load = { mean = 20, harmonics = [{ amplitude = 4, "
       "angular_frequency = 50 }] }\nforce = [{ mean = 5, harmonics = [{ amplitude = 2, angular_frequency = 10 }] }, "
       "{ mean = 4, harmonics = [{ amplitude = 1, angular_frequency = 20 }] }]\n",
       "oscillator.mass", "{ velocity = [0.001, 0.001] }", "displacement_x", 3},
      {"[law]\ntype = 'ageing'\nmu0 = 0.6\na = 0.01\nb = 0.02\nL = 1e-5\nv0 = 1e-6\n[oscillator]\nmass = "
       "0\nstiffness = 1e6\n[drive]\nspeed = 1e-5\nnormal_load = 100\n",
       "law.a", "{ slip_rate = 2e-5 }", "displacement", 0.01},
      {"[law]\ntype = 'coulomb'\nmu_s = 0.5\nmu_d = 0.3\n[oscillator]\ntype = 'structure'\nM = [[1, 0], [0, 2]]\nK = "
       "[[300, -100], [-100, 200]]\nC = [[0.5, 0], [0, 0.5]]\ncontacts = [{ tangential = [1, 0] }]\n[drive]\nspeed = "
       "{ mean = 0.1, harmonics = [{ amplitude = 0.05, angular_frequency = 3 }] }\nnormal_load = 10\n",
       "oscillator.K.2.2", "'rest'", "displacement_2", 200}};
  for (const auto& machine : machines) {
    INFO(machine.scene);
    const Folder folder;
    const auto run =
        asked(folder, "run", machine.scene + "[run]\nduration = 2\nsamples = 100\nstart = " + machine.start);
    INFO(run.error);
    REQUIRE(run.status == 0);
    write_record(folder, run.document, {{machine.column, 0}}, 1);
    const auto found = asked(folder, "fit",
                             machine.scene + "[fit]\nparameters = ['" + machine.path +
                                 "']\ndata = [{ type = 'motion', file = " + "'record.csv', measured = ['" +
                                 machine.column + "'], start = " + machine.start + ", standard_error = 1e-6 }]\n",
                             fmt::format("--set {}={}", machine.path, 0.97 * machine.value));
    INFO(found.error);
    REQUIRE(found.status == 0);
    CHECK(found.document["parameters"][machine.path]["value"].get<double>() == Approx(machine.value).epsilon(1e-4));
  }
}

TEST_CASE("a column that jumps under a law that sticks comes with a note", "[fit-machine]") {
  const Folder folder;
  const auto run = asked(folder, "run", two_masses(true_coulomb, true_stiffness, run_for(0.2, 100)));
  write_record(folder, run.document, {{"friction_force", 0.2}}, 1);
  const auto found = asked(folder, "fit",
                           two_masses(true_coulomb, true_stiffness,
                                      "[fit]\nparameters = ['law.mu_d']\ndata = [{ type = 'motion', file = "
                                      "'record.csv', measured = ['friction_force'], start = 'rest' }]\n"));
  CHECK_THAT(found.document["notes"].dump(), Contains("jumps where slip begins"));
}

TEST_CASE("what a fit of a motion cannot use is refused with the reason", "[fit-machine]") {
  const Folder folder;
  std::ofstream(folder.path / "record.csv") << "time (s),displacement (m)\n0,0\n0.1,0.02\n0.2,0.02\n0.3,0.03\n";
  const auto error = [&](const std::string& keys, const std::string& path = "law.mu_s") {
    const auto answer = asked(folder, "fit",
                              two_masses(other_coulomb, true_stiffness,
                                         "[fit]\nparameters = ['" + path +
                                             "']\ndata = [{ type = 'motion', file = 'record.csv', " + keys + " }]\n"));
    CHECK(answer.status == 2);
    return answer.error;
  };
  const std::string measured = "measured = ['displacement']", start = "start = 'rest'", both = measured + ", " + start;
  CHECK_THAT(error("measured = ['displacment'], " + start),
             Contains("has no column 'displacment'") && Contains("'displacement'") && Contains("scene.toml:"));
  CHECK_THAT(error(measured), Contains("'start'"));
  CHECK_THAT(error(start), Contains("'measured'"));
  CHECK_THAT(error(both + ", normal_load = 3"), Contains("normal_load has no effect on a motion"));
  CHECK_THAT(error(both + ", trend = 'displacement'"), Contains("over time"));
  CHECK_THAT(error("measured = ['displacement', 'displacement'], " + start), Contains("twice"));
  CHECK_THAT(error(both + ", columns = { time = { column = 'time', offset = -0.1 } }"), Contains("before time 0"));
  CHECK_THAT(error(both, "oscillator.second_stifness"), Contains("oscillator.second_stiffness"));
  CHECK_THAT(error(both + ", columns = { time = { column = 'time', factor = 1e6 } }"),
             Contains("ends before the record"));
  const auto string = asked(folder, "fit",
                            "[law]\ntype = 'coulomb'\nmu_s = 0.4\nmu_d = 0.3\n[oscillator]\ntype = 'string'\n[fit]\n"
                            "parameters = ['law.mu_s']\ndata = [{ type = 'motion', file = 'record.csv', " +
                                both + " }]\n");
  CHECK(string.status == 2);
  CHECK_THAT(string.error, Contains("waves"));
}

}  // namespace rosin::tests::machines
