/// Arithmetic expressions as text: parsed into a graph, with the unit of every part checked.
///
///   sum      = product (("+" | "−") product)…
///   product  = unary (("*" | "/") unary)…
///   unary    = ("−" | "+") unary | power
///   power    = primary ["^" unary]
///   primary  = number [unit] | name | name "(" sum ("," sum)… ")" | "(" sum ")"
///   unit     = name ["^" integer] (("/")? name ["^" integer])…
///
/// A name is a letter, then letters, digits and _; of those that are paths, such as law.a, dots too.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "core/units.hpp"
#include "laws/graph.hpp"

namespace rosin::laws {

/// An expression that cannot be used: `what()` names it, what is wrong and what to try.
class ExpressionError : public InputError {
 public:
  ExpressionError(std::string expression, std::size_t offset, const std::string& problem);
  std::string expression;  ///< its path in a scene: "law.formula.rate.psi"
  std::size_t offset;      ///< of the offending token in its text, in bytes; `whole` if all of it is meant
  static constexpr auto whole = static_cast<std::size_t>(-1);
};

/// A value of the graph with what it measures.
struct Measured {
  int node;
  Dimension dimension;
};

/// What names stand for.
class Names {
 public:
  virtual ~Names() = default;
  /// The value of a name, or nothing. `depth` counts nested parts, so that a chain of definitions stays bounded.
  virtual std::optional<Measured> find(std::string_view name, int depth) = 0;
  /// All names, for suggestions and against mistaking them for units.
  virtual const std::vector<std::string>& known() const = 0;
  /// True where names are paths: dots belong to them.
  virtual bool paths() const { return false; }
};

inline constexpr std::size_t longest_expression = 4000;  ///< bytes
inline constexpr int deepest_expression = 100;           ///< nested parts

/// The value of `text`. \throws ExpressionError
Measured parse_expression(Graph&, Names&, const std::string& path, std::string_view text, int depth = 0);

/// True for what may name a parameter, a state or a definition: a letter, then letters, digits and _; no function.
bool may_be_name(std::string_view);

}  // namespace rosin::laws
