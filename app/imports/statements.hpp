/// The text of a script divided into statements and those into tokens.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/imports/script.hpp"

namespace rosin::app::imports {

/// What stands on one line, or on several where brackets or a mark of continuation join them; without comments, and
/// with the ends of its lines.
struct Statement {
  int line;    ///< where it begins, from 1
  int indent;  ///< spaces before it
  std::string text;
};
/// \throws InputError for a bracket or text that is not closed
std::vector<Statement> statements_of(std::string_view text, Dialect, const std::string& path);

struct Token {
  enum Kind { number, name, text, symbol, end } kind = end;
  std::string word;
  double value = 0;
  bool after_space = false;
  int line = 0;  ///< counted from that of its statement
};
/// Ends with a token of kind `end`. False where a sign is none of the language.
bool tokens_of(std::string_view statement, Dialect, std::vector<Token>& tokens);

}  // namespace rosin::app::imports
