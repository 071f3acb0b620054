/// Comments, texts, brackets and continued lines of Python and MATLAB.
#include "app/imports/statements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "core/error.hpp"

namespace rosin::app::imports {

namespace {

bool part_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Behind these a ' of MATLAB transposes; elsewhere it begins a text.
bool transposes(std::string_view before) {
  return !before.empty() &&
         (part_of_name(before.back()) || std::string_view(")]}.'").find(before.back()) != std::string_view::npos);
}

/// Takes a text in, sign by sign.
class Division {
 public:
  Division(std::string_view text, Dialect dialect, const std::string& path)
      : text_(text), dialect_(dialect), path_(path) {}

  std::vector<Statement> all() {
    while (at_ < text_.size()) sign();
    if (depth_ > 0)
      throw InputError(fmt::format("{}:{}: a bracket is opened in this statement and not closed", path_, begin_));
    finish();
    return std::move(found_);
  }

 private:
  bool ahead(std::string_view what) const { return text_.substr(at_, what.size()) == what; }

  void sign() {
    const char c = text_[at_];
    const bool python = dialect_ == Dialect::python;
    if (c == '\n') return new_line();
    if (c == (python ? '#' : '%')) return comment();
    if (!python && ahead("...")) {
      skip_line();
      join_line();
      return;
    }
    if (python && c == '\\') {
      ++at_;
      while (at_ < text_.size() && blank(text_[at_])) ++at_;
      if (at_ < text_.size() && text_[at_] == '\n') ++at_, ++line_;
      join_line();
      return;
    }
    if (c == '"' || (c == '\'' && (python || !transposes(current_)))) return quoted(c);
    if (std::string_view("([{").find(c) != std::string_view::npos) ++depth_;
    if (std::string_view(")]}").find(c) != std::string_view::npos) depth_ = std::max(0, depth_ - 1);
    if (depth_ == 0 && c == ';') {
      finish();
      ++at_;
      return;
    }
    put(c);
    ++at_;
  }

  void put(char c) {
    if (current_.empty()) {
      if (blank(c)) {
        if (fresh_) ++indent_;
        return;
      }
      begin_ = line_;
      fresh_ = false;
    }
    current_ += c;
  }

  /// The statement goes on with the next line, whose end is kept so that lines can be counted.
  void join_line() {
    if (!current_.empty()) current_ += '\n';
  }

  void new_line() {
    ++at_, ++line_;
    if (depth_ > 0) {
      join_line();
      return;
    }
    finish();
    fresh_ = true, indent_ = 0;
  }

  void skip_line() {
    at_ = std::min(text_.find('\n', at_), text_.size());
    if (at_ < text_.size()) ++at_, ++line_;
  }

  /// A block %{ … %}, each mark alone on its line, or the rest of a line.
  void comment() {
    if (dialect_ == Dialect::matlab && current_.empty() && ahead("%{")) {
      for (int open = 0; at_ < text_.size(); skip_line()) {
        auto line = text_.substr(at_, text_.find('\n', at_) - at_);
        while (!line.empty() && blank(line.front())) line.remove_prefix(1);
        while (!line.empty() && blank(line.back())) line.remove_suffix(1);
        open += line == "%{" ? 1 : line == "%}" ? -1 : 0;
        if (open <= 0) return skip_line();
      }
      return;
    }
    at_ = std::min(text_.find('\n', at_), text_.size());
  }

  void quoted(char mark) {
    const std::string triple(3, mark);
    const int began = line_;
    if (dialect_ == Dialect::python && ahead(triple)) {
      const auto close = text_.find(triple, at_ + 3);
      if (close == std::string_view::npos)
        throw InputError(fmt::format("{}:{}: a text begins here and does not end", path_, began));
      line_ += static_cast<int>(std::ranges::count(text_.substr(at_, close - at_), '\n'));
      at_ = close + 3;
      put(mark), put(mark);  // its content is prose
      return;
    }
    put(mark);
    for (++at_; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
      if (dialect_ == Dialect::python && text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n') {
        put(text_[at_++]);
      } else if (text_[at_] == mark) {
        put(mark);
        ++at_;
        return;
      }
      put(text_[at_]);
    }
    throw InputError(fmt::format("{}:{}: a text begins here and does not end on its line", path_, began));
  }

  void finish() {
    while (!current_.empty() && (blank(current_.back()) || current_.back() == '\n')) current_.pop_back();
    if (!current_.empty()) found_.push_back({begin_, indent_, std::move(current_)});
    current_.clear();
  }

  std::string_view text_;
  Dialect dialect_;
  const std::string& path_;
  std::vector<Statement> found_;
  std::string current_;
  std::size_t at_ = 0;
  int line_ = 1, begin_ = 1, indent_ = 0, depth_ = 0;
  bool fresh_ = true;
};

}  // namespace

std::vector<Statement> statements_of(std::string_view text, Dialect dialect, const std::string& path) {
  return Division(text, dialect, path).all();
}

bool tokens_of(std::string_view statement, Dialect dialect, std::vector<Token>& tokens) {
  static constexpr std::array symbols = {
      "**=", "//=", "**", "//", "==", "!=", "~=", "<=", ">=", "+=", "-=", "*=", "/=", ".*", "./",
      ".^",  "&&",  "||", "->", ":=", "+",  "-",  "*",  "/",  "%",  "^",  "=",  "<",  ">",  "(",
      ")",   "[",   "]",  "{",  "}",  ",",  ":",  ".",  ";",  "&",  "|",  "~",  "'",  "@",  "!"};
  tokens.clear();
  int lines = 0;
  for (std::size_t at = 0; at < statement.size();) {
    Token token;
    for (; at < statement.size() && (blank(statement[at]) || statement[at] == '\n'); ++at) {
      token.after_space = true;
      lines += statement[at] == '\n' ? 1 : 0;
    }
    token.line = lines;
    if (at == statement.size()) break;
    const auto rest = statement.substr(at);
    const bool point = rest.size() > 1 && rest[0] == '.' && digit(rest[1]);
    if (digit(rest[0]) || point) {
      // "2.*x" of MATLAB is 2 .* x
      std::size_t length = 0;
      while (length < rest.size() && digit(rest[length])) ++length;
      const bool elementwise = dialect == Dialect::matlab && length + 1 < rest.size() && rest[length] == '.' &&
                               std::string_view("*/^").find(rest[length + 1]) != std::string_view::npos;
      const auto digits = elementwise ? rest.substr(0, length) : rest;
      const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), token.value);
      if (read.ec != std::errc()) return false;
      token.kind = Token::number;
      token.word = std::string(digits.substr(0, static_cast<std::size_t>(read.ptr - digits.data())));
      at += token.word.size();
      if (at < statement.size() && part_of_name(statement[at])) return false;
    } else if (part_of_name(rest[0])) {
      std::size_t length = 0;
      while (length < rest.size() && part_of_name(rest[length])) ++length;
      token.kind = Token::name;
      token.word = std::string(rest.substr(0, length));
      at += length;
    } else if (rest[0] == '"' || (rest[0] == '\'' && (dialect == Dialect::python || token.after_space ||
                                                      !transposes(statement.substr(0, at))))) {
      const char mark = rest[0];
      token.kind = Token::text;
      std::size_t length = 1;
      for (; length < rest.size() && rest[length] != mark; ++length) {
        if (dialect == Dialect::python && rest[length] == '\\' && length + 1 < rest.size()) ++length;
        token.word += rest[length];
      }
      if (length == rest.size()) return false;
      at += length + 1;
    } else {
      const auto found =
          std::ranges::find_if(symbols, [&](std::string_view symbol) { return rest.starts_with(symbol); });
      if (found == symbols.end()) return false;
      token.kind = Token::symbol;
      token.word = *found;
      at += token.word.size();
    }
    tokens.push_back(std::move(token));
  }
  tokens.push_back({});
  return true;
}

}  // namespace rosin::app::imports
