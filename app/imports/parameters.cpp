/// Numbers of records.
#include "app/imports/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"

namespace rosin::app::imports {

Origin Parameter::origin(std::string_view meaning) const {
  return {fmt::format("{} = {}{}{}{}", name, number(value), meaning.empty() ? "" : ", ", meaning,
                      line == 0 ? ", a default" : ""),
          line};
}

std::optional<Parameter> parameter(const Script& script, const Record& record, std::string_view name,
                                   std::string_view shown) {
  const auto found = record.slots.find(name);
  if (found == record.slots.end()) return std::nullopt;
  const auto& [value, line] = found->second;
  if (const auto* number = value.as<double>()) return Parameter{*number, line, std::string(shown)};
  if (const auto* vector = value.as<std::shared_ptr<Vector>>()) {
    script.refuse((*vector)->changed);
    const auto& numbers = (*vector)->numbers;  // the same for all elements of a mesh
    if (!numbers.empty() && std::ranges::all_of(numbers, [&](double one) { return one == numbers.front(); }))
      return Parameter{numbers.front(), line, std::string(shown)};
  }
  if (const auto* unknown = value.as<Unknown>())
    script.refuse(line, fmt::format("gives {}, but {}", shown, unknown->why));
  script.refuse(line, fmt::format("gives {}, which has to be one number", shown));
}

Parameter required(const Script& script, const Record& record, std::string_view name, std::string_view shown,
                   std::string_view meaning) {
  if (auto found = parameter(script, record, name, shown)) return *found;
  throw InputError(fmt::format("{}: {} is not given ({})", script.path(), shown, meaning));
}

}  // namespace rosin::app::imports
