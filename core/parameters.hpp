/// Descriptions of named quantities: a law's card, its parameters and states, with units and accepted ranges.
#pragma once
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

namespace rosin {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Where a law stands beside another one, as its option: scenes may write type = "thermal", conduction = "disc" for
/// "thermal-disc".
struct LawOption {
  std::string_view of;     ///< name of the other law
  std::string_view key;    ///< key in [law]
  std::string_view usual;  ///< word that means the other law
  std::string_view word;   ///< word that means this one
};

/// What a law (or any named model) says of itself.
struct Card {
  std::string_view name;  ///< the user's word: file, type, scene key, anchor in the docs
  std::string_view title;
  std::string_view formula;             ///< LaTeX
  std::string_view source;              ///< paper and equations
  std::string_view limits;              ///< where the law stops being meaningful
  std::string_view approximation = {};  ///< what is computed only nearly, and how nearly; empty if nothing
  LawOption option = {};
};

/// Accepted values: a closed interval and, of what is neither 0 nor infinite, the magnitudes.
struct Range {
  double low = -infinity, high = infinity;
  double smallest = 0, largest = infinity;
  constexpr bool contains(double x) const {  // false for NaN
    const double magnitude = x < 0 ? -x : x;
    const bool measured = x != 0 && magnitude != infinity;
    return low <= x && x <= high && !(measured && (magnitude < smallest || magnitude > largest));
  }
};

/// How a state is integrated: as it is, or as its logarithm (positive, spanning decades).
enum class Scale { linear, log };

/// What becomes of a state when the motion is mirrored: an age stays, a deflection changes sign.
enum class Parity { even, odd };

/// One named member of a law or of its state.
template <class Owner, class Member>
struct Field {
  Member Owner::*member;
  std::string_view name, unit;
  Range range;
  std::string_view meaning;
  Scale scale = Scale::linear;
  Parity parity = Parity::even;
};

template <class Owner, class Member>
constexpr Field<Owner, Member> field(Member Owner::*member, std::string_view name, std::string_view unit, Range range,
                                     std::string_view meaning, Scale scale = Scale::linear,
                                     Parity parity = Parity::even) {
  return {member, name, unit, range, meaning, scale, parity};
}

/// An ordered list of fields. Parameters stand in the order of the law's members.
template <class... F>
constexpr std::tuple<F...> table(F... fields) {
  return {fields...};
}

/// A parameter's value: a number, or a list (tabulated laws).
using Value = std::variant<double, std::vector<double>>;

/// A field as text and numbers, for catalogues, scenes and messages. `is_list`: an array of numbers.
struct Quantity {
  std::string name, unit;
  Range range;
  std::string meaning;
  Scale scale = Scale::linear;
  bool is_list = false;
  Parity parity = Parity::even;
};

/// The name in `known` nearest to `name` by edit distance, or empty where none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace rosin
