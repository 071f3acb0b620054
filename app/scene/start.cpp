/// Starts of a slider.
#include "app/scene/start.hpp"

#include <utility>

namespace rosin::app::scene {

namespace {

constexpr Range any{-1e15, 1e15};

}  // namespace

analysis::motion::Start read_start(const toml::node& node, const std::string& path, const FrictionLaw& law) {
  using Kind = analysis::motion::Start::Kind;
  if (node.is_string())
    return {choice(node, path, {"steady", "rest"}) == "rest" ? Kind::rest : Kind::steady, {}, {}, {}, {}};
  if (!node.is_table()) wrong_kind(node, path, "\"steady\", \"rest\" or a table");
  analysis::motion::Start start{Kind::given, {}, {}, {}, {}};
  Table table(node, path);
  table.read("displacement", start.displacement, {"", "m", any, "displacement of the slider"});
  table.read("velocity", start.velocity, {"", "m/s", any, "velocity of the slider"});
  table.read("slip_rate", start.slip_rate, {"", "m/s", any, "drive speed minus velocity of the slider"});
  if (start.velocity && start.slip_rate) fail(node.source(), "{}: give velocity or slip_rate, not both", path);
  const auto read_states = [&](Table& from) {
    for (auto state : law.states()) {
      std::optional<double> value;
      from.read(state.name, value, state);
      if (value) start.states[state.name] = *value;
    }
  };
  if (const auto* state = table.find("state")) {
    if (law.states().empty()) fail(state->source(), "{}.state: law '{}' has no states", path, law.card().name);
    if (state->is_table()) {
      Table states(*state, path + ".state");
      read_states(states);
      states.finish();
    } else if (law.states().size() == 1) {
      auto quantity = law.states().front();
      const auto name = std::exchange(quantity.name, path + ".state");
      start.states[name] = number(*state, quantity);
    } else {
      wrong_kind(*state, path + ".state", fmt::format("a table with the {} states by name", law.states().size()));
    }
  }
  read_states(table);
  table.finish();
  return start;
}

void read_plane_start(const toml::node& node, const std::string& path, analysis::motion::PlaneModel& plane) {
  plane.velocity = plane.mass.surface_velocity;
  if (node.is_string()) {
    choice(node, path, {"rest"});
    return;
  }
  Table table(node, path);
  if (table.find("displacement"))
    plane.displacement = both(table, "displacement", {"", "m", any, "displacement of the slider"});
  if (table.find("velocity")) plane.velocity = both(table, "velocity", {"", "m/s", any, "velocity of the slider"});
  table.finish();
}

}  // namespace rosin::app::scene
