/// Starts of a slider.
#include "app/scene/start.hpp"

#include <utility>

#include "analysis/motion/plane_model.hpp"

namespace rosin::app::scene {

namespace {

constexpr Range any{-1e15, 1e15};

/// A state that turns with the slip as a pair, others as on a line.
void read_plane_states(Table& table, analysis::motion::PlaneModel& plane) {
  plane.states.clear();
  if (!plane.remembers()) return;
  const auto& states = plane.law->states();
  const auto memory = analysis::motion::memory_of(plane);
  auto of = memory.begin();
  for (const auto& state : states) {
    if (state.parity == Parity::odd) {
      if (table.find(state.name))
        for (const double part : both(table, state.name, state)) plane.states[(of++)->state.name] = part;
      else
        of += 2;
      continue;
    }
    std::optional<double> value;
    table.read(state.name, value, state);
    if (value) plane.states[state.name] = *value;
    ++of;
  }
}

}  // namespace

std::map<std::string, double> read_start_states(Table& table, const FrictionLaw& law, const std::string& suffix) {
  std::map<std::string, double> given;
  const auto read = [&](Table& from, const std::string& end) {
    for (auto state : law.states()) {
      std::optional<double> value;
      from.read(state.name + end, value, state);
      if (value) given[state.name] = *value;
    }
  };
  if (const auto* state = table.find("state" + suffix)) {
    const auto path = table.path("state" + suffix);
    if (law.states().empty()) fail(state->source(), "{}: law '{}' has no states", path, law.card().name);
    if (state->is_table()) {
      Table states(*state, path);
      read(states, "");
      states.finish();
    } else if (law.states().size() == 1) {
      auto quantity = law.states().front();
      const auto name = std::exchange(quantity.name, path);
      given[name] = number(*state, quantity);
    } else {
      wrong_kind(*state, path, fmt::format("a table with the {} states by name", law.states().size()));
    }
  }
  read(table, suffix);
  return given;
}

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
  start.states = read_start_states(table, law, "");
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
  read_plane_states(table, plane);
  table.finish();
}

}  // namespace rosin::app::scene
