/// Values of expressions in scripts.
#pragma once
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "app/imports/statements.hpp"

namespace rosin::app::imports {

/// What an expression may refer to.
struct Surroundings {
  Record& variables;
  Dialect dialect;
  const Call& call;
  std::set<std::string, std::less<>>& own_functions;  ///< that the script defines itself
  int line = 0;
  std::size_t& numbers_made;  ///< in vectors, so far
};

/// A part of a vector, or of a record by a text.
struct Subscript {
  Value index;         ///< a number, a mask, or a text; of a slice unused
  bool slice = false;  ///< from:to
  std::optional<Value> from = {}, to = {};
};
/// Where a value stands: a variable, and names and subscripts behind it.
struct Target {
  struct Step {
    std::string name;
    std::vector<Subscript> subscripts;  ///< empty: a name behind a dot
  };
  std::vector<Step> steps;
};

class Expression {
 public:
  Expression(std::span<const Token> tokens, Surroundings& surroundings)
      : tokens_(tokens), surroundings_(surroundings) {}

  /// The value of all tokens; Unknown where something is not understood.
  Value value();
  /// The same as the left side of an assignment. False where it is none.
  bool target(Target&);

 private:
  struct Failure {
    std::string why;
  };
  const Token& next() const { return tokens_[at_]; }
  bool is(std::string_view symbol) const { return next().kind == Token::symbol && next().word == symbol; }
  bool take(std::string_view symbol);
  void need(std::string_view symbol);
  bool begins_element() const;

  Value either();
  Value both();
  Value comparison();
  Value sum();
  Value product();
  Value sign();
  Value power();
  Value postfix();
  Value atom();
  Value brackets();
  Value braces();
  std::vector<Argument> arguments();
  std::vector<Subscript> subscripts(std::string_view close);
  Value element(const Value& of, const std::vector<Subscript>&);
  Value call(const std::string& name, const Value* object);
  Value function(const std::string& name, const std::vector<Argument>&);
  Value vector_of(std::vector<double> numbers, bool mask = false);

  std::span<const Token> tokens_;
  Surroundings& surroundings_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool in_matrix_ = false;  ///< of MATLAB, where a space divides elements
};

/// "op" of two values, element by element. Unknown where it has no meaning.
Value combined(const Value& left, std::string_view operation, const Value& right, Surroundings&);
/// The elements that a subscript chooses, counted from 0. False if it has none.
bool chosen(const Subscript&, std::size_t size, Dialect, std::vector<std::size_t>& elements);

}  // namespace rosin::app::imports
