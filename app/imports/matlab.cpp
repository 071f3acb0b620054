/// Scripts in MATLAB: assignments of numbers, of fields of structures, and of what functions return that a format
/// knows. A statement that may change variables unseen makes all above it unknown, by its line. Reading ends with the
/// first run, since later lines are about its results.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include "app/imports/script.hpp"
#include "core/error.hpp"
#include "core/stop.hpp"

namespace rosin::app::imports {

namespace {

constexpr int most_nested = 60;
constexpr std::size_t most_copied = 200'000;  ///< fields of structures, when these are given to other names

struct Token {
  enum Kind { number, name, text, symbol, end } kind = end;
  std::string word = {};
  double value = 0;
  bool after_space = false;
};
struct Statement {
  int line = 0;
  std::vector<Token> tokens = {};  ///< the last of kind `end`
};

bool part_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

/// Divides a text into statements, at the ends of lines, semicolons and commas outside of brackets.
class Division {
 public:
  Division(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  std::vector<Statement> all() {
    while (at_ < text_.size()) {
      end_if_stopped();
      sign();
    }
    if (!open_.empty())
      throw InputError(fmt::format("{}:{}: a bracket is opened in this statement and not closed", path_, now_.line));
    finish();
    return std::move(found_);
  }

 private:
  bool ahead(std::string_view what) const { return text_.substr(at_, what.size()) == what; }
  char next(std::size_t by = 1) const { return at_ + by < text_.size() ? text_[at_ + by] : '\0'; }

  void sign() {
    const char c = text_[at_];
    if (c == ' ' || c == '\t' || c == '\r') {
      space_ = true, ++at_;
    } else if (c == '\n') {
      if (open_.empty()) finish();
      if (!open_.empty() && open_.back() == '[') put({Token::symbol, ";"});
      ++at_, ++line_, space_ = true;
    } else if (c == '%' || c == '#') {
      comment();
    } else if (ahead("...")) {
      skip_line(), space_ = true;
    } else if (c == '"' || (c == '\'' && !transposes())) {
      quoted(c);
    } else if (open_.empty() && (c == ';' || c == ',')) {
      finish(), ++at_;
    } else if (digit(c) || (c == '.' && digit(next()))) {
      number();
    } else if (part_of_name(c)) {
      const auto begin = at_;
      while (at_ < text_.size() && part_of_name(text_[at_])) ++at_;
      put({Token::name, std::string(text_.substr(begin, at_ - begin))});
    } else {
      symbol();
    }
  }

  void put(Token token) {
    if (now_.tokens.empty()) now_.line = line_;
    token.after_space = std::exchange(space_, false);
    now_.tokens.push_back(std::move(token));
  }
  void finish() {
    if (!now_.tokens.empty()) {
      put({});
      found_.push_back(std::exchange(now_, {}));
    }
    space_ = false;
  }

  /// Behind a value a ' transposes; elsewhere it begins a text.
  bool transposes() const {
    if (now_.tokens.empty() || (space_ && !open_.empty() && open_.back() == '[')) return false;
    const auto& before = now_.tokens.back();
    return before.kind == Token::name || before.kind == Token::number ||
           (before.kind == Token::symbol && one_of(before.word, {")", "]", "}", "'"}));
  }

  void skip_line() {
    at_ = std::min(text_.find('\n', at_), text_.size());
    if (at_ < text_.size()) ++at_, ++line_;
  }
  /// A block %{ … %}, each mark alone on its line, or the rest of a line.
  void comment() {
    const auto trimmed_line = [&] {
      auto line = text_.substr(at_, text_.find('\n', at_) - at_);
      line.remove_prefix(std::min(line.size(), line.find_first_not_of(" \t")));
      return line.substr(0, line.find_last_not_of(" \t\r") + 1);
    };
    if (now_.tokens.empty() && one_of(trimmed_line(), {"%{", "#{"}))
      for (int open = 0; at_ < text_.size(); skip_line()) {
        const auto line = trimmed_line();
        open += one_of(line, {"%{", "#{"}) ? 1 : one_of(line, {"%}", "#}"}) ? -1 : 0;
        if (open <= 0) return skip_line();
      }
    at_ = std::min(text_.find('\n', at_), text_.size());
  }

  void quoted(char mark) {
    std::string word;
    for (++at_; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
      if (text_[at_] == mark && next() != mark) {
        ++at_;
        return put({Token::text, word});
      }
      if (text_[at_] == mark) ++at_;
      word += text_[at_];
    }
    throw InputError(fmt::format("{}:{}: a text begins here and does not end on its line", path_, line_));
  }

  void number() {
    std::size_t length = 0;
    const auto rest = text_.substr(at_);
    while (length < rest.size() && digit(rest[length])) ++length;
    // "2.*x" is 2 .* x, and "2.'" transposes
    const bool elementwise = length + 1 < rest.size() && rest[length] == '.' &&
                             std::string_view("*/^\\'").find(rest[length + 1]) != std::string_view::npos;
    if (!elementwise && length < rest.size() && rest[length] == '.') ++length;
    while (!elementwise && length < rest.size() && digit(rest[length])) ++length;
    std::string digits(rest.substr(0, length));
    if (length < rest.size() && std::string_view("eEdD").find(rest[length]) != std::string_view::npos) {
      auto end = length + 1;
      if (end < rest.size() && (rest[end] == '+' || rest[end] == '-')) ++end;
      const auto first = end;
      while (end < rest.size() && digit(rest[end])) ++end;
      if (end > first) digits += "e" + std::string(rest.substr(length + 1, end - length - 1)), length = end;
    }
    at_ += length;
    if (at_ < text_.size() && part_of_name(text_[at_])) return put({Token::symbol, "?"});  // 2i, 0x1F
    Token token{Token::number, digits};
    if (digits.back() == '.') digits.pop_back();
    auto read = std::string_view(digits);
    if (const auto plus = digits.find("e+"); plus != std::string::npos) digits.erase(plus + 1, 1), read = digits;
    if (std::from_chars(read.data(), read.data() + read.size(), token.value).ec != std::errc())
      token = {Token::symbol, "?"};
    put(token);
  }

  void symbol() {
    for (const std::string_view one :
         {"==", "~=", "!=", "<=", ">=", "+=", "-=", "*=", "/=", "^=", "++", "--", ".*", "./", ".^", ".'", "&&", "||"})
      if (ahead(one)) {
        at_ += one.size();
        return put({Token::symbol, std::string(one)});
      }
    const char c = text_[at_++];
    if (c == '(' || c == '[' || c == '{') open_ += c;
    if ((c == ')' || c == ']' || c == '}') && !open_.empty()) open_.pop_back();
    put({Token::symbol, std::string(1, c)});
  }

  std::string_view text_;
  const std::string& path_;
  std::vector<Statement> found_ = {};
  Statement now_ = {};
  std::string open_ = {};  ///< brackets
  std::size_t at_ = 0;
  int line_ = 1;
  bool space_ = false;
};

double (*function_named(std::string_view name))(double) {
  if (name == "exp") return [](double x) { return std::exp(x); };
  if (name == "log") return [](double x) { return std::log(x); };
  if (name == "log10") return [](double x) { return std::log10(x); };
  if (name == "sqrt") return [](double x) { return std::sqrt(x); };
  if (name == "abs") return [](double x) { return std::abs(x); };
  if (name == "sin") return [](double x) { return std::sin(x); };
  if (name == "cos") return [](double x) { return std::cos(x); };
  if (name == "tan") return [](double x) { return std::tan(x); };
  if (name == "floor") return [](double x) { return std::floor(x); };
  if (name == "ceil") return [](double x) { return std::ceil(x); };
  if (name == "round") return [](double x) { return std::round(x); };
  return nullptr;
}

/// The value of an expression.
class Expression {
 public:
  Expression(std::span<const Token> tokens, const Record& variables, const Call& call, int line)
      : tokens_(tokens), variables_(variables), call_(call), line_(line) {}

  Value value() try {
    auto value = sum();
    return next().kind == Token::end ? value : Value{};
  } catch (const Unknown& why) {
    return {why};
  }

 private:
  const Token& next() const { return tokens_[at_]; }
  bool is(std::string_view symbol) const { return next().kind == Token::symbol && next().word == symbol; }
  bool take(std::string_view symbol) { return is(symbol) && ++at_; }
  void need(std::string_view symbol) {
    if (!take(symbol)) throw Unknown{};
  }
  static double number(const Value& value) {
    if (const auto* number = value.as<double>()) return *number;
    throw value.as<Unknown>() ? *value.as<Unknown>() : Unknown{};
  }
  /// In brackets a sign with a space before it and none behind begins an element.
  bool begins_element() const { return in_matrix_ && next().after_space && !tokens_[at_ + 1].after_space; }

  Value sum() {
    auto value = product();
    while ((is("+") || is("-")) && !begins_element()) {
      const bool plus = take("+");
      if (!plus) take("-");
      const double a = number(value), b = number(product());
      value = {plus ? a + b : a - b};
    }
    return value;
  }
  Value product() {
    auto value = sign();
    while (is("*") || is(".*") || is("/") || is("./")) {
      const bool times = take("*") || take(".*");
      if (!times && !take("/")) take("./");
      const double a = number(value), b = number(sign());
      value = {times ? a * b : a / b};
    }
    return value;
  }
  /// −2^2 is −4.
  Value sign() {
    if (++depth_ > most_nested) throw Unknown{"is nested too deeply"};
    Value value;
    if (take("-"))
      value = {-number(sign())};
    else
      value = take("+") ? sign() : power();
    --depth_;
    return value;
  }
  /// From the left, as 2^3^2 is 64; 2^-1 is a half.
  Value power() {
    auto value = postfix();
    while (is("^") || is(".^")) {
      if (!take("^")) take(".^");
      double sign = 1;
      while (is("-") || is("+")) sign *= take("-") ? -1 : (take("+"), 1);
      const double a = number(value), b = number(postfix());
      value = {std::pow(a, sign * b)};
      if (std::isnan(*value.as<double>())) throw Unknown{};  // a complex number
    }
    return value;
  }

  /// A value, a field of a structure, an element of a row, or what a function returns.
  Value postfix() {
    const auto token = next();
    const auto found = token.kind == Token::name ? variables_.slots.find(token.word) : variables_.slots.end();
    if (token.kind != Token::name) return transposed(atom());
    ++at_;
    if (found == variables_.slots.end()) return transposed(calls() ? returned(token.word) : constant(token.word));
    Value value = found->second.value;
    if (is(".") && tokens_[at_ + 1].kind == Token::name) {
      ++at_;
      const auto name = next().word;
      ++at_;
      const auto record = record_of(value);
      if (!record) throw value.as<Unknown>() ? *value.as<Unknown>() : Unknown{};
      if (record->changed.line > 0) throw Unknown{record->changed.why};
      const auto field = record->slots.find(name);
      if (field == record->slots.end()) throw Unknown{fmt::format("refers to '{}', which is not given", name)};
      value = field->second.value;
    }
    if (calls()) {
      const auto given = arguments();
      const double index = given.size() == 1 ? number(given.front()) : 0;
      const auto* list = value.as<std::shared_ptr<List>>();
      if (value.as<double>() && index == 1) return value;
      if (!list || index < 1 || index != std::floor(index) || index > static_cast<double>((*list)->values.size()))
        throw Unknown{};
      value = (*list)->values[static_cast<std::size_t>(index) - 1];
    }
    return transposed(value);
  }
  bool calls() const { return is("(") && !(in_matrix_ && next().after_space); }
  Value transposed(Value value) {
    while (is("'") || is(".'")) ++at_;
    return value;
  }
  static Value constant(const std::string& name) {
    if (name == "pi") return {std::numbers::pi};
    if (one_of(name, {"Inf", "inf"})) return {INFINITY};
    throw Unknown{fmt::format("refers to '{}', which is not given", name)};
  }
  std::vector<Value> arguments() {
    need("(");
    const bool before = std::exchange(in_matrix_, false);
    std::vector<Value> given;
    while (!is(")")) {
      given.push_back(sum());
      if (!take(",")) break;
    }
    need(")");
    in_matrix_ = before;
    return given;
  }
  Value returned(const std::string& name) {
    const auto given = arguments();
    if (auto known = call_(name, given, line_); !known.as<Unknown>()) return known;
    auto* f = function_named(name);
    if (!f || given.size() != 1) throw Unknown{fmt::format("the function '{}' is not understood", name)};
    const double result = f(number(given.front()));
    if (std::isnan(result)) throw Unknown{};
    return {result};
  }

  Value atom() {
    const auto token = next();
    if (token.kind == Token::end) throw Unknown{};
    ++at_;
    if (token.kind == Token::number) return {token.value};
    if (token.kind == Token::text) return {token.word};
    if (token.word == "(") {
      const bool before = std::exchange(in_matrix_, false);
      auto value = sum();
      need(")");
      in_matrix_ = before;
      return value;
    }
    if (token.word != "[") throw Unknown{};
    const bool before = std::exchange(in_matrix_, true);
    auto row = std::make_shared<List>();
    while (!is("]")) {
      if (take(",")) continue;
      if (next().kind == Token::end || is(";")) throw Unknown{};
      row->values.push_back(sum());
    }
    need("]");
    in_matrix_ = before;
    return row->values.size() == 1 ? row->values.front() : Value{row};
  }

  std::span<const Token> tokens_;
  const Record& variables_;
  const Call& call_;
  int line_ = 0;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool in_matrix_ = false;
};

/// What each statement does to the variables.
class Reader {
 public:
  Reader(Script& script, const Call& call) : script_(script), variables_(script.variables), call_(call) {}

  void read(const std::vector<Statement>& statements) {
    for (const auto& statement : statements) {
      end_if_stopped();
      line_ = statement.line;
      if (run_line_ > 0) {
        refuse_second_run(statement.tokens);
      } else {
        perform(statement.tokens);
      }
      if (ended_) return;
    }
  }

 private:
  void perform(const std::vector<Token>& tokens) {
    const auto& head = tokens.front();
    const auto equals = std::ranges::find_if(tokens, [depth = 0](const Token& token) mutable {
      if (token.kind != Token::symbol) return false;
      if (one_of(token.word, {"(", "[", "{"})) ++depth;
      if (one_of(token.word, {")", "]", "}"})) --depth;
      return depth == 0 && one_of(token.word, {"=", "+=", "-=", "*=", "/=", "^=", "++", "--"});
    });
    const bool assigns = equals != tokens.end();
    if (may_change_all(tokens)) return change_all("may change every variable unseen");
    if (head.kind == Token::name && !assigns && one_of(head.word, {"return", "exit", "quit", "error"})) {
      ended_ = blocks_ == 0;
      return;
    }
    if (head.kind == Token::name && head.word == "function") {
      ended_ = true;  // definitions stand at the end of a script
      return;
    }
    if (head.kind == Token::name && one_of(head.word, {"if", "for", "while", "switch", "try", "parfor", "spmd", "do",
                                                       "unwind_protect", "classdef"}))
      ++blocks_, opens_ = true;
    else if (head.kind == Token::name && (head.word.starts_with("end") || head.word == "until") && !assigns)
      blocks_ = std::max(0, blocks_ - 1), opens_ = true;
    else
      opens_ = false;
    if (head.kind == Token::name && one_of(head.word, {"global", "persistent"})) {
      for (const auto& token : tokens) globals_.insert(token.word);
      return;
    }
    if (!assigns) {
      command(tokens);
    } else if (blocks_ > 0 || opens_) {
      unknown_left(tokens, std::size_t(equals - tokens.begin()),
                   "stands in a loop, a condition or a function, which is not run");
    } else if (equals->word != "=") {
      unknown_left(tokens, std::size_t(equals - tokens.begin()), "is changed in a way that is not understood");
    } else {
      assign(tokens, std::size_t(equals - tokens.begin()));
    }
    functions_may_change_globals(tokens);
  }

  /// Functions that run text or files, or take variables away, wherever they stand.
  bool may_change_all(const std::vector<Token>& tokens) const {
    for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
      const auto& token = tokens[i];
      const bool is_field = i > 0 && tokens[i - 1].kind == Token::symbol && tokens[i - 1].word == ".";
      const bool is_target = tokens[i + 1].kind == Token::symbol && tokens[i + 1].word == "=";
      if (token.kind == Token::name && !is_field && !is_target && !variables_.slots.contains(token.word) &&
          one_of(token.word, {"eval", "feval", "evalc", "evalin", "assignin", "load", "run", "source", "clear",
                              "clearvars", "keyboard", "uiimport", "dbstop"}))
        return true;
    }
    return false;
  }
  void change_all(std::string_view why) {
    for (auto& [name, slot] : variables_.slots) unknown(slot, why);
  }
  /// By the first statement that may have changed it.
  void unknown(Slot& slot, std::string_view why) {
    if (slot.value.as<Unknown>() && slot.line > 0) return;
    if (const auto record = record_of(slot.value))
      record->changed = record->changed.line > 0 ? record->changed : Changed{line_, std::string(why)};
    else
      slot = {{Unknown{std::string(why)}}, line_};
  }

  /// A statement without "=": a value that is shown, a function with its arguments, or a command, which may be a
  /// script of that name.
  void command(const std::vector<Token>& tokens) {
    const auto& head = tokens.front();
    if (head.kind != Token::name || opens_ || variables_.slots.contains(head.word)) return;
    const bool with_arguments = tokens[1].kind == Token::symbol && one_of(tokens[1].word, {"(", "."});
    if (with_arguments ||
        one_of(head.word,
               {"close",    "clc",     "figure", "hold", "format", "more",    "warning",   "pkg",      "axis",
                "grid",     "drawnow", "tic",    "toc",  "pause",  "legend",  "box",       "colorbar", "colormap",
                "clf",      "cla",     "disp",   "else", "elseif", "case",    "otherwise", "catch",    "break",
                "continue", "beep",    "diary",  "shg",  "echo",   "addpath", "cd",        "rng"}))
      return;
    change_all(fmt::format("may change every variable: '{}' may be a script, and no script is run", head.word));
  }

  void functions_may_change_globals(const std::vector<Token>& tokens) {
    if (globals_.empty()) return;
    for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
      const auto& token = tokens[i];
      const bool called = token.kind == Token::name && tokens[i + 1].word == "(" && !function_named(token.word) &&
                          !variables_.slots.contains(token.word) && token.word != "odeset";
      if (!called) continue;
      for (auto& [name, slot] : variables_.slots)
        if (globals_.contains(name))
          unknown(slot, fmt::format("may change the global variable '{}' in the function '{}'", name, token.word));
      return;
    }
  }

  /// Every variable that is named before a sign of assignment.
  void unknown_left(const std::vector<Token>& tokens, std::size_t equals, std::string_view why) {
    for (std::size_t i = 0; i < equals; ++i)
      if (tokens[i].kind == Token::name && (i == 0 || tokens[i - 1].word != "."))
        unknown(variables_.slots[tokens[i].word], why);
  }

  void assign(const std::vector<Token>& tokens, std::size_t equals) {
    const auto right = std::span(tokens).subspan(equals + 1);
    const auto value = Expression(right, variables_, call_, line_).value();
    const auto is = [&](std::size_t i, std::string_view symbol) {
      return tokens[i].kind == Token::symbol && tokens[i].word == symbol;
    };
    if (equals == 1 && tokens[0].kind == Token::name) {
      give(tokens[0].word, value);
    } else if (equals == 3 && tokens[0].kind == Token::name && is(1, ".") && tokens[2].kind == Token::name) {
      auto& slot = variables_.slots[tokens[0].word];
      if (!record_of(slot.value)) slot = {{std::make_shared<Record>()}, line_};
      const auto record = record_of(slot.value);
      record->name = tokens[0].word;
      record->slots[tokens[2].word] = {record_of(value) ? Value{} : value, line_};
    } else {
      unknown_left(tokens, equals, "is one of several values that are given together, or a part");
      // [p, ot, ox] = qdyn(…) gives the first its value
      if (is(0, "[") && tokens[1].kind == Token::name && (is(2, ",") || is(2, "]") || tokens[2].after_space))
        give(tokens[1].word, value);
    }
    const auto made = record_of(value);
    const bool solves = right[0].kind == Token::name && right[0].word.starts_with("ode") && right[0].word != "odeset" &&
                        right[1].word == "(";
    if ((made && made->ran) || solves) run_line_ = line_, run_ = right[0].word;
  }

  /// A structure that is given to another name is a structure of its own.
  void give(const std::string& name, const Value& value) {
    variables_.slots[name] = {value, line_};
    const auto record = record_of(value);
    if (!record) return;
    copied_ += record->slots.size();
    if (copied_ > most_copied) script_.refuse(line_, "is where structures are copied too often; write their fields");
    auto own = std::make_shared<Record>(*record);
    own->name = name;
    variables_.slots[name].value = {own};
  }

  void refuse_second_run(const std::vector<Token>& tokens) const {
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i)
      if (run_ == "qdyn" && tokens[i].word == run_ && tokens[i + 1].word == "(" && tokens[i + 2].word == "run")
        script_.refuse(line_, fmt::format("is a second run, beside that in line {}; one scene is one run", run_line_));
  }

  Script& script_;
  Record& variables_;
  const Call& call_;
  std::set<std::string> globals_ = {};
  std::string run_ = {};
  std::size_t copied_ = 0;
  int line_ = 0, run_line_ = 0, blocks_ = 0;
  bool opens_ = false, ended_ = false;
};

}  // namespace

Script read_matlab(const std::string& path, std::string_view text, const Call& call) {
  Script script(path, text);
  Reader(script, call).read(Division(text, path).all());
  return script;
}

}  // namespace rosin::app::imports
