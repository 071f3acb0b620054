/// Looking up laws and presets by name.
#include "laws/catalogue.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "laws/shipped.hpp"

namespace rosin::laws {

namespace {

template <template <class> class... L>
std::vector<std::shared_ptr<const FrictionLaw>> make_all(LawList<L...>) {
  return {make_law<L>()...};
}

/// "; did you mean 'spinodal'? (known: coulomb, …)"
std::string suggestion(std::string_view name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return fmt::format("{} (known: {})", near.empty() ? "" : fmt::format("; did you mean '{}'?", near),
                     known.empty() ? "none" : fmt::to_string(fmt::join(known, ", ")));
}

}  // namespace

const std::vector<std::shared_ptr<const FrictionLaw>>& catalogue() {
  static const auto laws = make_all(Shipped{});
  return laws;
}

std::shared_ptr<const FrictionLaw> find_law(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& law : catalogue()) {
    if (law->card().name == name) return law;
    known.emplace_back(law->card().name);
  }
  throw InputError(fmt::format("unknown friction law '{}'{}", name, suggestion(name, known)));
}

std::shared_ptr<const FrictionLaw> preset(const FrictionLaw& law, std::string_view name) {
  std::vector<std::string> known;
  for (const auto& preset : law.presets()) {
    if (preset.name == name) return law.with(preset.values);
    known.push_back(preset.name);
  }
  throw InputError(fmt::format("law '{}' has no preset '{}'{}", law.card().name, name, suggestion(name, known)));
}

}  // namespace rosin::laws
