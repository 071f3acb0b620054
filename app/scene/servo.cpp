/// A position servo on a coordinate of a slider or a structure: oscillator.servo.
#include "oscillators/servo.hpp"

#include "app/scene/reader.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/signal.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

void read_servo(SceneReader& reader, const toml::node& node) {
  auto& scene = reader.scene;
  auto served = verbs_of_structures;
  std::erase(served, "lab");  // whose experiments move the frame themselves
  const bool is_structure = !scene.string && !scene.plane && !scene.block && !reduced_block_of(scene);
  if (!is_structure || std::ranges::find(served, reader.request.verb) == served.end())
    fail(node.source(), "oscillator.servo acts on a slider or a structure, by {}; leave it out here",
         fmt::join(served, ", "));
  if (!scene.structure)
    scene.structure.emplace().structure = located(node.source(), [&] { return oscillators::one_slider(scene.model); });
  auto& structure = scene.structure->structure;

  Table table(node, "oscillator.servo");
  table.expect({"coordinate", "kp", "ki", "kd", "reference", "feedforward", "limit", "anti_windup", "sampling_time",
                "encoder_resolution", "filter"});
  int number = 1;
  if (structure.size() > 1) table.required("coordinate", "number of the coordinate, from 1");
  table.read("coordinate", number, 1, structure.size(), "number of the coordinate, from 1");
  oscillators::Servo servo{.coordinate = number - 1};
  constexpr Range gains{0, 1e15};
  table.read("kp", servo.proportional, {"", "N/m", gains, "proportional gain kp of the servo"});
  table.read("ki", servo.integral, {"", "N/(m s)", gains, "integral gain ki of the servo"});
  table.read("kd", servo.derivative, {"", "N s/m", gains, "derivative gain kd of the servo"});
  table.read("feedforward", servo.feedforward,
             {"", "N s/m", {0, 1e15}, "force of the servo on a velocity of its reference"});
  if (const auto* reference = table.find("reference"))
    servo.reference = read_signal(
        *reference, {table.path("reference"), "m", {-1e15, 1e15}, "position that the servo holds"}, reader.folder);
  if (const auto* feedforward = table.find("feedforward");
      feedforward && servo.feedforward > 0 && servo.reference.constant())
    fail(feedforward->source(), "oscillator.servo.feedforward has no effect: the reference does not move");
  table.read("limit", servo.limit, {"", "N", {1e-300, infinity}, "largest force of the servo"});
  if (const auto* time = table.find("anti_windup")) {
    table.read("anti_windup", servo.anti_windup,
               {"", "s", {1e-12, infinity}, "time in which the integral follows a force at its limit"});
    if (!(servo.limit < infinity && servo.integral > 0))
      fail(time->source(), "oscillator.servo.anti_windup has no effect without a limit (N) and an integral gain ki");
  }
  if (const auto* time = table.find("sampling_time")) {
    table.read("sampling_time", servo.sampling_time,
               {"", "s", {1e-9, 1e9}, "time from one run of the servo's program to the next"});
    constexpr auto follow = std::to_array<std::string_view>({"run", "sweep"});
    if (std::ranges::find(follow, reader.request.verb) == follow.end())
      fail(
          time->source(),
          "oscillator.servo.sampling_time: {} needs derivatives of the motion, or its period, but a servo that samples "
          "reads it at moments of a clock of its own: it is followed by {}; leave it out here",
          reader.request.verb, fmt::join(follow, ", "));
  }
  for (const auto& [key, value, quantity] :
       {std::tuple{"encoder_resolution", &servo.encoder_resolution,
                   Quantity{"", "m", {1e-15, 1e9}, "distance from one reading of the position to the next"}},
        {"filter", &servo.filter, Quantity{"", "s", {1e-12, 1e9}, "time constant of the filter of the speed"}}}) {
    const auto* given = table.find(key);
    if (!given) continue;
    table.read(key, *value, quantity);
    if (!(servo.sampling_time > 0))
      fail(given->source(), "oscillator.servo.{} has no effect without a sampling_time (s)", key);
  }
  if (const auto* filter = table.find("filter"); filter && servo.derivative == 0)
    fail(filter->source(), "oscillator.servo.filter has no effect without a derivative gain kd (N s/m)");
  table.finish();
  if (!(servo.proportional > 0 || servo.integral > 0 || servo.derivative > 0))
    fail(node.source(), "oscillator.servo has no effect without a gain: give kp (N/m), ki (N/(m s)) or kd (N s/m)");
  structure = located(node.source(), [&] {
    auto controlled = oscillators::with_servo(std::move(structure), servo);
    controlled.check();
    return controlled;
  });
}

}  // namespace rosin::app::scene
