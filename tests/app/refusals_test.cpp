/// What one verb refuses every verb refuses, with the place that the user wrote; and every key is used, refused or
/// noted.
#include <catch2/catch.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using namespace rosin::tests;

namespace {

Printed ask(const std::string& verb, const std::string& text) {
  const Folder folder;
  std::ofstream(folder.path / "scene.toml") << text;
  return run_rosin(folder, verb + " scene.toml --no-pictures");
}

const std::string slider = R"([law]
type = "stribeck"
mu_s = 1.0
mu_d = 0.5
v_s = 0.5
[oscillator]
mass = 1
stiffness = 1
damping = 0.1
[drive]
speed = 1.5
normal_load = 1
)";

}  // namespace

TEST_CASE("a contact whose slip rate is open has no stability, nor a basin or a branch", "[refusals]") {
  const std::string dahl = R"([law]
type = "dahl"
contact_stiffness = { per_load = 20 }
[oscillator]
mass = 1
stiffness = 11
damping = 0.1
[drive]
speed = 0.15
normal_load = 1.4
)";
  for (const auto& [verb, table] :
       {std::pair{"stability", ""},
        {"stability", "[stability]\nscan = { parameter = 'drive.speed', from = 0.1, to = 0.3, points = 3 }\n"},
        {"basin",
         "[basin]\nx = { start = 'displacement', from = 0, to = 1, points = 2 }\n"
         "y = { start = 'velocity', from = 0, to = 1, points = 2 }\n"},
        {"branch", "[branch]\nparameter = 'drive.speed'\nfrom = 0.1\nto = 0.3\n"},
        {"lyapunov", "[lyapunov]\nduration = 10\n"}}) {
    CAPTURE(verb, table);
    const auto answer = ask(verb, dahl + table);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains("answers to the slip rate only by way of its states"));
    CHECK_THAT(answer.error, Contains("scene.toml:"));
  }
}

TEST_CASE("a refusal at one value of a parameter stands where the values were given", "[refusals]") {
  const auto answer = ask("stability", R"([law]
type = "coulomb"
mu_s = 0.3
mu_d = 0.3
[oscillator]
type = "two-mass-belt"
mass = 1
stiffness = 1
second_mass = 1
second_stiffness = 1
[drive]
speed = 1
normal_load = 1
[stability]
scan = { parameter = "law.mu_s", from = 0.1, to = 0.5, points = 5 }
)");
  CHECK(answer.status == 2);
  CHECK_THAT(answer.error, StartsWith("scene.toml:15:8: stability.scan: at law.mu_s = 0.1: law.mu_s = 0.1 is below"));
}

TEST_CASE("a key that changes nothing is refused or noted", "[refusals]") {
  struct Case {
    const char *verb, *table, *says;
  };
  for (const auto& [verb, table, says] :
       {Case{"curve", "", "note: drive.speed, oscillator have no effect: 'curve' does not ask for them"},
        {"cycle", "[solver]\ntype = 'cvode'\n", "note: solver has no effect: 'cycle' does not ask for it"},
        {"stability", "[stability]\nmodes = 3\n", "note: stability.modes has no effect"},
        {"basin",
         "[basin]\nx = { start = 'displacement', from = 0, to = 1, points = 2 }\n"
         "y = { start = 'velocity', from = 0, to = 1, points = 2 }\nstart = { velocity = 1 }\n",
         "basin.start.velocity has no effect: basin.y sets velocity"}}) {
    CAPTURE(verb, table);
    CHECK_THAT(ask(verb, slider + table).error, Contains(says));
  }
  // A damper without a spring, whatever the contact is part of; and lists where numbers belong.
  const std::string chain = R"([law]
type = "hyperbolic"
mu_s = 1
delta = 3
[oscillator]
type = "chain"
blocks = 2
mass = 1
stiffness = 1.2
pull_stiffness = 1
[drive]
speed = 0.2
normal_load = 1
[run]
duration = 1
)";
  CHECK_THAT(ask("run --set law.contact_stiffness.damping=1", chain).error, Contains("damping without a spring"));
  CHECK_THAT(ask("run --set run.start.displacement_1=[0,1]", chain).error,
             Contains("run.start.displacement_1 is a list"));
}

TEST_CASE("a servo says what it needs", "[refusals][servo]") {
  const auto with = [](const std::string& servo) {
    auto text = slider;
    return ask("cycle", text.insert(text.find("[drive]"), "servo = " + servo + "\n"));
  };
  for (const auto& [servo, why] : {std::pair{"{ kp = 3, gain = 1 }", "unknown key 'gain' in [oscillator.servo]"},
                                   std::pair{"{ reference = 1 }", "oscillator.servo has no effect without a gain"},
                                   std::pair{"{ kp = -1 }", "oscillator.servo.kp = -1"},
                                   std::pair{"{ coordinate = 2, kp = 1 }", "oscillator.servo.coordinate"},
                                   std::pair{"{ kp = 1, feedforward = 2 }", "feedforward has no effect"},
                                   std::pair{"{ kp = 1, limit = 0 }", "oscillator.servo.limit = 0"},
                                   std::pair{"{ kp = 1, limit = 2, anti_windup = 1 }", "anti_windup has no effect"},
                                   std::pair{"{ kp = 1, filter = 1 }", "filter has no effect without a sampling_time"},
                                   std::pair{"{ kp = 1, sampling_time = 0.1 }", "it is followed by run, sweep"},
                                   std::pair{"{ kp = 1, reference = '1 N' }", "oscillator.servo.reference"}}) {
    const auto printed = with(servo);
    INFO(servo);
    CHECK(printed.status == 2);
    CHECK_THAT(printed.error, StartsWith("scene.toml:10:") && Contains(why));
  }
}
