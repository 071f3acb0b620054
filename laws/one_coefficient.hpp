/// law.mu: the coefficients at rest and in motion as one number, of laws that have both.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "laws/law.hpp"

namespace rosin::laws {

inline constexpr std::string_view one_coefficient = "mu";
/// The parameters that it stands for.
inline constexpr std::array<std::string_view, 2> rest_and_motion = {"mu_s", "mu_d"};

inline bool is_rest_or_motion(std::string_view parameter) {
  return std::ranges::find(rest_and_motion, parameter) != rest_and_motion.end();
}

/// Its description; nothing for a law that has not both, or a parameter of that very name.
inline std::optional<Quantity> one_coefficient_of(const FrictionLaw& law) {
  const bool has_both = std::ranges::all_of(rest_and_motion, [&](auto name) { return law.find(name).has_value(); });
  if (!has_both || law.find(one_coefficient)) return std::nullopt;
  auto quantity = law.parameters()[*law.find(rest_and_motion.back())];
  quantity.name = one_coefficient;
  quantity.meaning = "coefficient of friction, at rest and in motion";
  return quantity;
}

/// The law with that coefficient at rest and in motion.
inline std::shared_ptr<const FrictionLaw> with_one_coefficient(const FrictionLaw& law, double value) {
  auto values = law.values();
  for (const auto name : rest_and_motion) values[*law.find(name)] = value;
  return law.with(std::move(values));
}

}  // namespace rosin::laws
