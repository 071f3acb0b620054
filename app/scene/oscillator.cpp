/// The list of oscillators.
#include "app/scene/oscillator.hpp"

#include <fmt/ranges.h>

#include <stdexcept>

#include "app/scene/reader.hpp"

namespace rosin::app::scene {

#define ROSIN_OSCILLATOR(name) OscillatorType name##_type();
#include "app/scene/oscillators.def"
#undef ROSIN_OSCILLATOR

namespace {

std::vector<OscillatorType>& all_types() {
  static std::vector<OscillatorType> list = {
#define ROSIN_OSCILLATOR(name) name##_type(),
#include "app/scene/oscillators.def"
#undef ROSIN_OSCILLATOR
  };
  return list;
}

std::vector<std::string> known_names() {
  std::vector<std::string> known = {"modal"};  // reserved
  for (const auto& one : all_types()) known.push_back(one.name);
  return known;
}

}  // namespace

const std::vector<OscillatorType>& oscillator_types() { return all_types(); }

void add_oscillator_type(OscillatorType type) {
  if (const auto known = known_names(); std::ranges::find(known, type.name) != known.end())
    throw InputError(fmt::format("oscillator.type = '{}' is taken; known are {}", type.name, fmt::join(known, ", ")));
  all_types().push_back(std::move(type));
}

const OscillatorType& oscillator_type(SceneReader& reader, const toml::node& oscillator) {
  const auto& types = oscillator_types();
  Table table(oscillator, "oscillator");
  const auto* type = table.find("type");
  if (!type) return types.front();
  const auto name = choice(*type, table.path("type"), known_names());
  const auto found = std::ranges::find(types, name, &OscillatorType::name);
  if (found == types.end())
    fail(type->source(), "oscillator.type = '{}' is not available in this version; use 'slider' or 'structure'", name);
  const auto& verbs = found->verbs;
  if (!verbs.empty() && std::ranges::find(verbs, reader.request.verb) == verbs.end()) {
    const auto reason = found->reasons.find(reader.request.verb);
    fail(type->source(), "oscillator.type = '{}' serves {} only, not '{}'{}", name, fmt::join(verbs, ", "),
         reader.request.verb, reason == found->reasons.end() ? "" : ": " + reason->second);
  }
  return *found;
}

Quantity mechanical(std::string_view path) {
  for (const auto& quantity : oscillators::mechanical_parameters())
    if (quantity.name == path) return quantity;
  throw std::logic_error("no mechanical parameter " + std::string(path));
}

}  // namespace rosin::app::scene
