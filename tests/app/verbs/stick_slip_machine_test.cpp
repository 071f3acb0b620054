/// The verb fit on events of stick–slip of machines: events of motions give springs and law back.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/app/command.hpp"

namespace rosin::tests::stick_slip_machines {

using Catch::Contains;
using nlohmann::json;

namespace {

/// A block of 1 kg before a frame of 0.3 kg, whose modes are damped within a stick.
std::string machine(double mu_s, double stiffness, double second_stiffness, const std::string& more) {
  return fmt::format(
      "[law]\ntype = 'coulomb'\nmu_s = {}\nmu_d = 0.25\n[oscillator]\ntype = 'two-mass-belt'\nmass = 1\nstiffness = "
      "{}\ndamping = 5\nsecond_mass = 0.3\nsecond_stiffness = {}\nsecond_damping = 10\n[drive]\nspeed = "
      "0.05\nnormal_load = 50\n{}",
      mu_s, stiffness, second_stiffness, more);
}

json asked(const Folder& folder, const std::string& verb, const std::string& scene, const std::string& options = "") {
  std::ofstream(folder.path / "scene.toml") << scene;
  const auto answer = run_rosin(folder, verb + " scene.toml --json --no-pictures --quiet --out out " + options);
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  return json::parse(answer.out);
}

/// Of the last slips of a motion at each drive speed: times between them and their peaks.
struct Events {
  std::vector<double> speed, recurrence, peak;
};
Events events_of_motions(const Folder& folder) {
  Events events;
  for (const double speed : {0.02, 0.05, 0.1}) {
    const auto run =
        asked(folder, "run", machine(0.4, 4000, 6000, "[run]\nduration = 3\nsamples = 3000\nstart = 'rest'\n"),
              fmt::format("--tolerance 1e-9 --set drive.speed={}", speed));
    const auto& slips = run["stick_slip"];
    events.speed.push_back(speed);
    events.recurrence.push_back(slips["recurrence"].back().get<double>());
    events.peak.push_back(slips["peak_slip_rate"].back().get<double>());
  }
  return events;
}

void write_noisy(const Folder& folder, const Events& events, double part, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::ofstream file(folder.path / "events.csv");
  file << "speed (m/s),recurrence (s),peak_slip_rate (m/s)\n";
  for (std::size_t i = 0; i < events.speed.size(); ++i)
    for (int k = 0; k < 8; ++k)
      file << fmt::format("{},{:.10g},{:.10g}\n", events.speed[i],
                          events.recurrence[i] + part * events.recurrence[1] * normal(random),
                          events.peak[i] + part * events.peak[1] * normal(random));
}

/// Truths within their intervals, over seeds of the noise.
int inside(const Folder& folder, const Events& events, unsigned seeds) {
  int count = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    write_noisy(folder, events, 0.01, seed);
    const auto found = asked(folder, "fit",
                             machine(0.42, 4300, 6000,
                                     "[fit]\nparameters = ['law.mu_s', 'oscillator.stiffness']\n"
                                     "data = [{ type = 'stick-slip', file = 'events.csv' }]\n"));
    for (const auto& [path, truth] : {std::pair{"law.mu_s", 0.4}, std::pair{"oscillator.stiffness", 4000.0}}) {
      const auto& interval = found["parameters"][path]["interval"];
      REQUIRE(interval[0].is_number());
      count += interval[0].get<double>() < truth && truth < interval[1].get<double>();
    }
  }
  return count;
}

}  // namespace

TEST_CASE("noisy events of stick-slip of two masses give law and spring back", "[fit-stick-slip-machine][long]") {
  const Folder folder;
  CHECK(inside(folder, events_of_motions(folder), 3) >= 5);
}

TEST_CASE("over 20 sets of noisy events of two masses the truth lies in most intervals",
          "[fit-stick-slip-machine][long]") {
  const Folder folder;
  CHECK(inside(folder, events_of_motions(folder), 20) >= 34);  // 38 are expected, with a standard deviation of 1.4
}

TEST_CASE("a record of the force between two masses gives the static coefficient back", "[fit-stick-slip-machine]") {
  const Folder folder;
  const auto run =
      asked(folder, "run", machine(0.4, 4000, 6000, "[run]\nduration = 4\nsamples = 8000\nstart = 'rest'\n"));
  std::ofstream file(folder.path / "cell.csv");
  file << "time (s),friction_force (N)\n";
  const auto& columns = run["columns"];
  for (std::size_t k = 0; k < run["time"].size(); ++k)
    file << fmt::format(
        "{},{:.9g}\n", run["time"][k].get<double>(),
        4000 * (columns["displacement"][k].get<double>() - columns["second_displacement"][k].get<double>()));
  file.close();
  const auto found = asked(folder, "fit",
                           machine(0.44, 4000, 6000,
                                   "[fit]\nparameters = ['law.mu_s']\n"
                                   "data = [{ type = 'stick-slip-record', file = 'cell.csv' }]\n"));
  CHECK(found["parameters"]["law.mu_s"]["value"].get<double>() == Approx(0.4).margin(2e-3));
}

TEST_CASE("events of an oscillator that is followed by steps are refused", "[fit-stick-slip-machine]") {
  const Folder folder;
  std::ofstream(folder.path / "events.csv") << "recurrence (s)\n1\n";
  std::ofstream(folder.path / "scene.toml")
      << "[law]\ntype = 'coulomb'\n[oscillator]\ntype = 'plane-slider'\nmass = 3\nstiffness = [400, 400]\ndamping = "
         "[1, 1]\n"
         "[drive]\nspeed = [0.1, 0]\nnormal_load = 1\n[fit]\nparameters = ['law.mu_s']\n"
         "data = [{ type = 'stick-slip', file = 'events.csv' }]\n";
  const auto answer = run_rosin(folder, "fit scene.toml");
  CHECK(answer.status == 2);
  CHECK_THAT(answer.error, Contains("type = \"motion\""));
}

}  // namespace rosin::tests::stick_slip_machines
