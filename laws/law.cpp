/// Looking up parameters by name.
#include "laws/law.hpp"

#include <fmt/format.h>

namespace rosin {

std::optional<std::size_t> FrictionLaw::find(std::string_view parameter) const {
  const auto& list = parameters();
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == parameter) return i;
  return std::nullopt;
}

namespace {
std::size_t index_or_throw(const FrictionLaw& law, std::string_view parameter) {
  if (const auto i = law.find(parameter)) return *i;
  std::vector<std::string> known;
  for (const auto& p : law.parameters()) known.push_back(p.name);
  const auto near = nearest_name(parameter, known);
  throw InputError(fmt::format("law '{}' has no parameter '{}'{}", law.card().name, parameter,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}
}  // namespace

double FrictionLaw::parameter(std::string_view name) const {
  const auto& value = values()[index_or_throw(*this, name)];
  if (const double* x = std::get_if<double>(&value)) return *x;
  throw InputError(fmt::format("parameter '{}' of law '{}' is a list", name, card().name));
}

std::shared_ptr<const FrictionLaw> FrictionLaw::with(std::string_view name, Value value) const {
  auto changed = values();
  changed[index_or_throw(*this, name)] = std::move(value);
  return with(std::move(changed));
}

}  // namespace rosin
