/// Numbers with units as text, converted to SI once, at the edge.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace rosin {

/// The number in `text` expressed in `si_unit`: "0.01 mm/s" in "m/s" is 1e-5; a plain "3" is taken as SI.
/// \throws InputError if the text is not a number with an optional unit, or the unit has another dimension.
double to_si(std::string_view text, std::string_view si_unit);

/// True if the text is a unit ("N s/m", "1/um", "1").
bool unit_known(std::string_view unit);

/// What a quantity measures: exponents of the SI base units m, kg, s, A, K, mol, cd. Angles are dimensionless.
struct Dimension {
  std::array<double, 7> exponent{};

  bool operator==(const Dimension&) const = default;
  Dimension operator*(const Dimension&) const;
  Dimension operator/(const Dimension&) const;
  Dimension power(double) const;
};
/// The coherent SI unit of a dimension: "m/s", "kg m/s^2", "1".
std::string coherent_unit(const Dimension&);

/// A unit as it stands in a text.
struct TextUnit {
  Dimension dimension;
  double factor = 1;    ///< to SI
  bool offset = false;  ///< counted from another zero (degrees Celsius), or not a factor at all
};
/// Nothing where the text is no unit.
std::optional<TextUnit> parse_unit(std::string_view);

}  // namespace rosin
