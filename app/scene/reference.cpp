/// The units that an area or a radius brings to those of a contact.
#include "app/scene/reference.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "app/scene/scene_table.hpp"
#include "core/error.hpp"
#include "core/turning.hpp"
#include "core/units.hpp"

namespace rosin::app::scene {

namespace {

constexpr std::size_t area = 0, radius = 1;  // in Reference::keys

/// A number in `unit` times the key's value to this power is one in `si`.
struct Way {
  std::string_view si, unit;
  std::size_t key;
  int power;
};
constexpr Way ways[] = {
    {"N", "N/m^2", area, 1},      {"N/m", "N/m^3", area, 1},   {"N s/m", "N s/m^3", area, 1},
    {"kg", "kg/m^2", area, 1},    {"N/s", "N/m^2/s", area, 1},

    {"kg", "kg m^2", radius, -2}, {"N/m", "N m", radius, -2},  {"N s/m", "N m s", radius, -2},
    {"N", "N m", radius, -1},     {"m/s", "rad/s", radius, 1}, {"m", "rad", radius, 1},
};

const std::array<Quantity, Reference::keys.size()>& quantities() {
  static const std::array<Quantity, Reference::keys.size()> list = {
      Quantity{"oscillator.area", "m^2", {1e-18, 1e12}, "area of the contact, times which numbers per unit area count"},
      Quantity{"oscillator.radius", "m", {1e-9, 1e6}, "radius at which the contact rubs, to which turning is brought"}};
  return list;
}

}  // namespace

Reference::Reference(const toml::table& document) {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (const auto found = document.at_path(quantities()[i].name)) values_[i] = number(*found.node(), quantities()[i]);
}

Reference::~Reference() {
  // A scene that is read within another one, changed in some numbers, refers to the same area and radius.
  for (std::size_t i = 0; before() && i < keys.size(); ++i) before()->used_[i] = before()->used_[i] || used_[i];
}

double Reference::to_si(std::string_view text, std::string_view si_unit) {
  std::string problem;
  try {
    return rosin::to_si(text, si_unit);
  } catch (const UnclearAngle&) {
    throw;
  } catch (const InputError& error) {
    problem = error.what();
  }
  for (const auto& way : ways) {
    if (way.si != si_unit) continue;
    double number = 0;
    try {
      number = way.unit == "rad/s" ? turning_to_si(text) : rosin::to_si(text, way.unit);
    } catch (const UnclearAngle&) {
      throw;
    } catch (const InputError&) {
      continue;
    }
    auto* reference = current();
    const auto& quantity = quantities()[way.key];
    if (!reference || !reference->values_[way.key])
      throw InputError(fmt::format("{}; with {} ({}: {}) it is brought to {}", problem, quantity.name, quantity.unit,
                                   quantity.meaning, readable_unit(si_unit)));
    reference->used_[way.key] = true;
    return number * std::pow(*reference->values_[way.key], way.power);
  }
  throw InputError(problem);
}

std::vector<std::string> Reference::unused() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (values_[i] && !used_[i]) names.push_back(quantities()[i].name);
  return names;
}

}  // namespace rosin::app::scene
