/// End stops of the coordinates of a structure, and of a slider.
#include <fmt/ranges.h>

#include <algorithm>

#include "app/scene/reader.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

using oscillators::Stop;

namespace {

const Quantity place_of_stop{"", "m", {-1e15, 1e15}, "place of an end stop"};
const Quantity restitution{"", "1", {0, 1}, "coefficient of restitution of a stop"};

/// \returns whether the table says on which side it stands
bool read_stop(Table table, int coordinates, Stop& stop) {
  table.expect({"coordinate", "at", "side", "restitution", "stiffness", "damping"});
  table.required("at", "place of the stop, m");
  table.read("at", stop.at, place_of_stop);
  int number = 1;
  if (coordinates > 1) table.required("coordinate", "number of the coordinate, from 1");
  table.read("coordinate", number, 1, coordinates, "number of the coordinate, from 1");
  stop.coordinate = number - 1;
  const auto *side = table.find("side"), *rigid = table.find("restitution"), *spring = table.find("stiffness"),
             *damper = table.find("damping");
  if (rigid && spring)
    fail(spring->source(), "{}: give restitution (a rigid stop) or stiffness (one that gives way), not both",
         table.path("stiffness"));
  if (damper && !spring)
    fail(damper->source(), "{} has no effect on a rigid stop: give stiffness (N/m) too, or restitution instead",
         table.path("damping"));
  table.read("restitution", stop.restitution, restitution);
  table.read("stiffness", stop.stiffness, {"", "N/m", {1e-12, 1e15}, "stiffness of a stop"});
  table.read("damping", stop.damping, {"", "N s/m", {0, 1e15}, "damping of a stop"});
  if (side) stop.side = choice(*side, table.path("side"), {"upper", "lower"}) == "upper" ? 1 : -1;
  table.finish();
  return side != nullptr;
}

}  // namespace

void refuse_stops_elsewhere(const SceneReader& reader, const toml::node& stops) {
  const std::string_view verb = reader.request.verb;
  static const std::vector<std::string_view> followed = {"run", "cycle", "sweep", "branch", "lyapunov", "basin"};
  if (std::ranges::find(followed, verb) == followed.end())
    fail(stops.source(), "oscillator.stops serve {} only, not '{}': leave them out", fmt::join(followed, ", "), verb);
}

void read_stops(SceneReader& reader, Table& oscillator) {
  const auto* node = oscillator.find("stops");
  if (!node) return;
  const auto path = oscillator.path("stops");
  refuse_stops_elsewhere(reader, *node);
  auto& structure = reader.scene.structure->structure;
  structure.stops.clear();
  std::vector<bool> has_side;
  for (const auto& element : list(*node, path, "tables with at (m)", most_names)) {
    Table table(element, fmt::format("{}.{}", path, structure.stops.size() + 1));
    has_side.push_back(read_stop(table, structure.size(), structure.stops.emplace_back()));
  }
  // Of two on a coordinate the higher one is the upper; one alone stands on the side of its place.
  for (std::size_t s = 0; s < structure.stops.size(); ++s) {
    Stop& stop = structure.stops[s];
    if (has_side[s]) continue;
    const auto other = std::ranges::find_if(structure.stops, [&](const Stop& one) {
      return &one != &stop && one.coordinate == stop.coordinate && one.at != stop.at;
    });
    const double above = other != structure.stops.end() ? stop.at - other->at : stop.at;
    if (above == 0)
      fail(node->as_array()->get(s)->source(), "{}.{} stands at 0: say side = \"upper\" or \"lower\"", path, s + 1);
    stop.side = above > 0 ? 1 : -1;
  }
  located(node->source(), [&] { structure.check(); });
}

void read_slider_stops(SceneReader& reader, Table oscillator) {
  const auto *node = oscillator.find("stops"), *bounce = oscillator.find("restitution");
  const bool is_pair = node && node->is_array() && !node->as_array()->empty() && node->as_array()->get(0)->is_value();
  if (bounce && !is_pair)
    fail(bounce->source(), "{} goes with stops = [low, high] (m)", oscillator.path("restitution"));
  if (!node) return;
  auto& structure = reader.scene.structure.emplace().structure;
  structure = located(oscillator.source(), [&] { return oscillators::one_slider(reader.scene.model); });
  if (!is_pair) return read_stops(reader, oscillator);
  auto quantity = place_of_stop;
  quantity.name = oscillator.path("stops");
  const auto places = numbers(*node, quantity);
  if (places.size() != 2)
    fail(node->source(), "{} has {} entries, but 2 are needed, low and high (m)", quantity.name, places.size());
  double e = 0;
  oscillator.read("restitution", e, restitution);
  structure.stops = {{.at = places[0], .side = -1, .restitution = e}, {.at = places[1], .side = 1, .restitution = e}};
  located(node->source(), [&] { structure.check(); });
}

}  // namespace rosin::app::scene
