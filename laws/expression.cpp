/// The parser of expressions: recursive descent with a bound on its depth.
#include "laws/expression.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace rosin::laws {

ExpressionError::ExpressionError(std::string path, std::size_t at, const std::string& problem)
    : InputError(fmt::format("{}: {}", path, problem)), expression(std::move(path)), offset(at) {}

namespace {

bool is_letter(char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return '0' <= c && c <= '9'; }

/// How the unit of a function follows from those of its arguments.
enum class UnitRule { plain, same, square_root, sign, all_same };
struct Function {
  std::string_view name;
  Operation operation;
  int arguments;
  UnitRule units;
};
constexpr Function functions[] = {
    {"exp", Operation::exp, 1, UnitRule::plain},           {"ln", Operation::log, 1, UnitRule::plain},
    {"log", Operation::log, 1, UnitRule::plain},           {"log10", Operation::log, 1, UnitRule::plain},
    {"sqrt", Operation::sqrt, 1, UnitRule::square_root},   {"abs", Operation::abs, 1, UnitRule::same},
    {"sign", Operation::sign, 1, UnitRule::sign},          {"sinh", Operation::sinh, 1, UnitRule::plain},
    {"cosh", Operation::cosh, 1, UnitRule::plain},         {"tanh", Operation::tanh, 1, UnitRule::plain},
    {"asinh", Operation::asinh, 1, UnitRule::plain},       {"min", Operation::minimum, 2, UnitRule::all_same},
    {"max", Operation::maximum, 2, UnitRule::all_same},    {"asinh_exp", Operation::asinh_exp, 2, UnitRule::plain},
    {"sinh_exp", Operation::sinh_exp, 2, UnitRule::plain},
};

const Function* find_function(std::string_view name) {
  const auto at = std::ranges::find(functions, name, &Function::name);
  return at == std::end(functions) ? nullptr : at;
}

std::string readable(const Dimension& dimension) { return readable_unit(coherent_unit(dimension)); }

class Parser {
 public:
  Parser(Graph& graph, Names& names, const std::string& path, std::string_view text, int depth)
      : graph_(graph), names_(names), path_(path), text_(text), depth_(depth) {}

  Measured whole() {
    if (text_.size() > longest_expression)
      fail(longest_expression, "has {} characters, more than {}; write parts of it by names of their own", text_.size(),
           longest_expression);
    if (peek() == 0) fail(0, "is empty");
    const Part value = sum();
    if (peek() == ')') fail(at_, "')' closes nothing");
    if (peek() != 0) unexpected("an operator");
    return {value.node, value.dimension};
  }

 private:
  struct Part {
    int node;
    Dimension dimension;
    std::size_t begin, end;
    bool bare_zero = false;  ///< a plain 0 is one in every unit
  };

  template <class... Args>
  [[noreturn]] void fail(std::size_t at, fmt::format_string<Args...> text, Args&&... args) const {
    throw ExpressionError(path_, at, fmt::format(text, std::forward<Args>(args)...));
  }
  [[noreturn]] void unexpected(std::string_view wanted) {
    if (peek() == 0) fail(at_, "ends where {} is needed", wanted);
    const auto token = is_letter(text_[at_]) ? word_at(at_) : text_.substr(at_, utf8_length(text_[at_]));
    fail(at_, "'{}' stands where {} is needed", token, wanted);
  }
  static std::size_t utf8_length(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x80 ? 1 : byte < 0xe0 ? 2 : byte < 0xf0 ? 3 : 4;
  }

  /// The next character that is not blank; 0 at the end.
  char peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c || at_ == text_.size()) return false;
    ++at_;
    return true;
  }
  std::string_view word_at(std::size_t begin) const {
    std::size_t end = begin;
    const auto belongs = [&](char c) { return is_letter(c) || is_digit(c) || (c == '.' && names_.paths()); };
    while (end < text_.size() && belongs(text_[end])) ++end;
    return text_.substr(begin, end - begin);
  }
  /// A part of the text as it is shown in a message.
  std::string shown(const Part& part) const {
    auto piece = std::string(text_.substr(part.begin, part.end - part.begin));
    while (!piece.empty() && piece.back() == ' ') piece.pop_back();
    return piece.size() > 40 ? piece.substr(0, 37) + "…" : piece;
  }

  /// Counts nested parts while it lives.
  struct Nested {
    explicit Nested(Parser& parser) : depth(parser.depth_) {
      if (++depth > deepest_expression)
        parser.fail(parser.at_, "is nested more than {} deep; write parts of it by names of their own",
                    deepest_expression);
    }
    ~Nested() { --depth; }
    int& depth;
  };

  Part with(Operation operation, const Part& a, const Part& b, const Dimension& dimension) {
    return {graph_.make(operation, a.node, b.node), dimension, a.begin, at_};
  }
  /// The unit that two parts share.
  Dimension common(const Part& a, const Part& b, std::string_view what) const {
    if (a.bare_zero) return b.dimension;
    if (!b.bare_zero && a.dimension != b.dimension)
      fail(b.begin, "'{}' ({}) and '{}' ({}) cannot be {}: their units differ", shown(a), readable(a.dimension),
           shown(b), readable(b.dimension), what);
    return a.dimension;
  }
  void require_plain(const Part& part, std::string_view where) const {
    if (!(part.dimension == Dimension{}))
      fail(part.begin, "{} must be dimensionless, but '{}' is in {}", where, shown(part), readable(part.dimension));
  }

  Part sum() {
    const Nested nested(*this);
    Part left = product();
    for (;;) {
      const bool plus = take('+');
      if (!plus && !take('-')) return left;
      const Part right = product();
      const auto dimension = common(left, right, plus ? "added" : "subtracted");
      left = with(plus ? Operation::add : Operation::subtract, left, right, dimension);
    }
  }

  Part product() {
    Part left = unary();
    for (;;) {
      const bool times = take('*');
      if (!times && !take('/')) return left;
      if (times && peek() == '*') fail(at_, "'**' is no operator; a power is written with ^");
      const Part right = unary();
      const auto dimension = times ? left.dimension * right.dimension : left.dimension / right.dimension;
      left = with(times ? Operation::multiply : Operation::divide, left, right, dimension);
    }
  }

  Part unary() {
    const Nested nested(*this);
    peek();
    const std::size_t begin = at_;
    if (take('+')) return unary();
    if (!take('-')) return raised();
    const Part part = unary();
    return {graph_.make(Operation::negate, part.node), part.dimension, begin, at_, part.bare_zero};
  }

  Part raised() {
    const Part base = primary();
    if (!take('^')) return base;
    const Part exponent = unary();
    require_plain(exponent, "an exponent");
    const Node& power = graph_[exponent.node];
    const bool constant = power.operation == Operation::constant;
    if (!constant && !(base.dimension == Dimension{}))
      fail(exponent.begin, "'{}' is in {}: its exponent must be a number, since the unit would depend on it",
           shown(base), readable(base.dimension));
    const auto dimension = constant ? base.dimension.power(power.number) : Dimension{};
    constexpr double most_products = 16;
    if (constant && power.number == std::round(power.number) && std::abs(power.number) <= most_products)
      return {whole_power(base.node, int(power.number)), dimension, base.begin, at_};
    return with(Operation::power, base, exponent, dimension);
  }

  /// x^n by repeated squaring; of negative x too.
  int whole_power(int x, int n) {
    if (n < 0) return graph_.make(Operation::divide, graph_.constant(1), whole_power(x, -n));
    int result = graph_.constant(1);
    for (; n > 0; n /= 2, x = graph_.make(Operation::multiply, x, x))
      if (n % 2) result = graph_.make(Operation::multiply, result, x);
    return result;
  }

  Part primary() {
    const char next = peek();
    const std::size_t begin = at_;
    if (is_digit(next) || next == '.') return number();
    if (is_letter(next)) {
      const auto word = word_at(at_);
      at_ += word.size();
      if (peek() == '(') return call(word, begin);
      return named(word, begin);
    }
    if (take('(')) {
      Part inside = sum();
      if (!take(')')) unexpected("')'");
      inside.begin = begin, inside.end = at_;
      return inside;
    }
    unexpected("a number, a name or '('");
  }

  Part number() {
    const std::size_t begin = at_;
    double value = 0;
    const auto [end, problem] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (problem == std::errc::result_out_of_range)
      fail(at_, "'{}' is too large or too small for a number",
           text_.substr(at_, std::size_t(end - text_.data()) - at_));
    if (problem != std::errc{}) unexpected("a number");
    at_ = std::size_t(end - text_.data());
    const std::size_t number_end = at_;
    const auto unit_text = unit();
    if (unit_text.empty()) return {graph_.constant(value), {}, begin, number_end, value == 0};
    const auto unit = parse_unit(unit_text);
    const auto moderate = [](double power) { return std::abs(power) <= 20; };
    if (!unit || unit->offset || !std::ranges::all_of(unit->dimension.exponent, moderate))
      fail(number_end, "'{}' is not a unit that a number can be multiplied by", unit_text);
    const auto number = text_.substr(begin, number_end - begin);
    return {graph_.constant(to_si(fmt::format("{} {}", number, unit_text), coherent_unit(unit->dimension))),
            unit->dimension, begin, at_};
  }

  /// The unit behind a number, as UDUNITS reads it; empty where there is none.
  std::string unit() {
    std::string unit;
    for (;;) {
      peek();
      const std::size_t back = at_;
      const bool divided = !unit.empty() && take('/');
      if (!is_letter(peek())) {
        at_ = back;
        return unit;
      }
      const auto word = word_at(at_);
      std::size_t behind = at_ + word.size();
      while (behind < text_.size() && text_[behind] == ' ') ++behind;
      const bool function = behind < text_.size() && text_[behind] == '(';
      const bool known = std::ranges::find(names_.known(), word) != names_.known().end();
      const bool is_unit = !function && parse_unit(word).has_value();
      if (divided && (function || !is_unit)) {
        at_ = back;  // a division by something else
        return unit;
      }
      if (divided && known)
        fail(at_, "'{}' may be a unit or a name of this law here; put the number and its unit in parentheses", word);
      if (!is_unit) {
        if (known || function) fail(at_, "'{}' follows a number; a product is written with *", word);
        fail(at_, "'{}' is not a unit; a unit may follow a number, a product is written with *", word);
      }
      if (!unit.empty()) unit += divided ? "/" : " ";
      unit += word;
      at_ += word.size();
      if (peek() == '^') {
        const std::size_t power = at_;
        ++at_;
        peek();
        std::size_t digits = at_;
        if (digits < text_.size() && text_[digits] == '-') ++digits;
        const std::size_t first = digits;
        while (digits < text_.size() && is_digit(text_[digits])) ++digits;
        if (digits == first || digits - first > 2)
          fail(power, "the power of a unit is a small whole number, such as 1 m^2");
        unit += '^';
        unit += text_.substr(at_, digits - at_);
        at_ = digits;
      }
    }
  }

  Part named(std::string_view word, std::size_t begin) {
    if (const auto value = names_.find(word, depth_))
      return {value->node, value->dimension, begin, begin + word.size()};
    if (word == "pi") return {graph_.constant(std::numbers::pi), {}, begin, begin + word.size()};
    if (find_function(word)) fail(begin, "'{}' is a function; its argument stands in parentheses", word);
    suggest(begin, word, names_.known(), "name");
  }

  [[noreturn]] void suggest(std::size_t begin, std::string_view word, const std::vector<std::string>& known,
                            std::string_view what) const {
    const auto near = nearest_name(word, known);
    if (!near.empty()) fail(begin, "unknown {} '{}'; did you mean '{}'?", what, word, near);
    fail(begin, "unknown {} '{}'; known here: {}", what, word, fmt::join(known, ", "));
  }

  Part call(std::string_view word, std::size_t begin) {
    const Function* function = find_function(word);
    if (!function) {
      if (std::ranges::find(names_.known(), word) != names_.known().end())
        fail(begin, "'{}' is not a function; a product is written with *", word);
      std::vector<std::string> known;
      for (const auto& f : functions) known.emplace_back(f.name);
      suggest(begin, word, known, "function");
    }
    take('(');
    std::vector<Part> arguments;
    do arguments.push_back(sum());
    while (take(','));
    if (!take(')')) unexpected("')'");
    if (int(arguments.size()) != function->arguments)
      fail(begin, "{} takes {} argument{}, not {}", word, function->arguments, function->arguments == 1 ? "" : "s",
           arguments.size());
    Part result{-1, {}, begin, at_};
    const Part& first = arguments.front();
    switch (function->units) {
      case UnitRule::plain:
        for (const auto& argument : arguments) require_plain(argument, fmt::format("the argument of {}", word));
        break;
      case UnitRule::same:
        result.dimension = first.dimension;
        break;
      case UnitRule::square_root:
        result.dimension = first.dimension.power(0.5);
        break;
      case UnitRule::sign:
        break;
      case UnitRule::all_same:
        result.dimension = common(first, arguments.back(), "compared");
        break;
    }
    result.node = graph_.make(function->operation, first.node, arguments.back().node);
    if (word == "log10")
      result.node = graph_.make(Operation::multiply, result.node, graph_.constant(1 / std::numbers::ln10));
    return result;
  }

  Graph& graph_;
  Names& names_;
  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0;
  int depth_;
};

}  // namespace

Measured parse_expression(Graph& graph, Names& names, const std::string& path, std::string_view text, int depth) {
  return Parser(graph, names, path, text, depth).whole();
}

bool may_be_name(std::string_view name) {
  const auto ordinary = [](char c) { return is_letter(c) || is_digit(c); };
  return !name.empty() && is_letter(name.front()) && std::ranges::all_of(name, ordinary) && !find_function(name) &&
         name != "pi";
}

}  // namespace rosin::laws
