/// Oscillators of a user's own program: a structure by its parameters, which scenes then know by name.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/parameters.hpp"
#include "oscillators/structure.hpp"

namespace rosin::app {

/// A type of oscillators as scenes read it: [oscillator] has its parameters as keys.
struct AddedOscillator {
  struct Parameter {
    Quantity quantity;
    double usual;  ///< where the scene does not say
  };
  std::string name;  ///< oscillator.type
  std::vector<Parameter> parameters;
  /// Masses, springs and contacts by the values of the parameters. \param contact of the scene's law, speed and normal
  /// load, along the first of the coordinates until the structure gives it a direction; \param force drive.force
  std::function<oscillators::Structure(const std::vector<double>&, const oscillators::FrictionContact& contact,
                                       const Signal& force)>
      structure;
};

/// Before `command`. \throws InputError for a name that is taken, or a key that every oscillator has
void add_oscillator(AddedOscillator);

/// The type of a struct with `name`, a table of `parameters` (numbers, in any order) and
/// `Structure structure(const FrictionContact&, const Signal& force) const`. \throws InputError as above
template <class Oscillator>
void add_oscillator() {
  AddedOscillator added{.name = std::string(Oscillator::name), .parameters = {}, .structure = {}};
  std::apply(
      [&](const auto&... field) {
        (added.parameters.push_back(
             {{std::string(field.name), std::string(field.unit), field.range, std::string(field.meaning)},
              Oscillator{}.*field.member}),
         ...);
      },
      Oscillator::parameters);
  added.structure = [](const std::vector<double>& values, const oscillators::FrictionContact& contact,
                       const Signal& force) {
    Oscillator made;
    auto value = values.begin();
    std::apply([&](const auto&... field) { ((made.*field.member = *value++), ...); }, Oscillator::parameters);
    return made.structure(contact, force);
  };
  add_oscillator(std::move(added));
}

}  // namespace rosin::app
