/// Units as they stand in texts of a scene.
#include "app/scene/written_units.hpp"

#include <cmath>
#include <cstdlib>

#include "app/scene/reference.hpp"

namespace rosin::app::scene {

void UnitsRead::note(const std::string& si, double value, std::optional<std::string_view> text) {
  auto* read = current();
  if (!read || value == 0) return;  // nothing is nothing in any unit
  WrittenUnit unit{si, 1};
  if (text) {
    const std::string written(*text);
    char* behind = nullptr;
    std::strtod(written.c_str(), &behind);
    const std::string_view rest = behind;
    if (const auto begin = rest.find_first_not_of(" \t"); begin != rest.npos) {
      unit.name = rest.substr(begin, rest.find_last_not_of(" \t") + 1 - begin);
      unit.factor = Reference::to_si("1 " + unit.name, si);
      const double twice = Reference::to_si("2 " + unit.name, si);
      if (std::abs(twice - 2 * unit.factor) > 1e-12 * std::abs(twice)) unit = {si, 1};  // of another zero, as degrees
    }
  }
  const auto [place, added] = read->units_.try_emplace(si, unit);
  if (!added && place->second != unit) place->second.reset();
}

WrittenUnits UnitsRead::written() const {
  WrittenUnits written;
  for (const auto& [si, unit] : units_)
    if (unit) written.emplace(si, *unit);
  return written;
}

}  // namespace rosin::app::scene
