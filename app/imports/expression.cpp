/// Arithmetic of numbers and vectors, and the functions of NumPy and MATLAB that make them.
#include "app/imports/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace rosin::app::imports {

namespace {

constexpr std::size_t most_numbers = 1'000'000;       ///< of a vector
constexpr std::size_t most_numbers_made = 5'000'000;  ///< of all vectors of a script together
constexpr int most_nested = 60;

std::optional<double> apply(double a, std::string_view operation, double b, bool& truth) {
  if (operation == "+") return a + b;
  if (operation == "-") return a - b;
  if (operation == "*" || operation == ".*") return a * b;
  if (operation == "/" || operation == "./") return a / b;
  if (operation == "//") return std::floor(a / b);
  if (operation == "%") return a - std::floor(a / b) * b;
  if (operation == "**" || operation == "^" || operation == ".^") return std::pow(a, b);
  truth = true;
  if (operation == "<") return a < b;
  if (operation == "<=") return a <= b;
  if (operation == ">") return a > b;
  if (operation == ">=") return a >= b;
  if (operation == "==") return a == b;
  if (operation == "!=" || operation == "~=") return a != b;
  if (operation == "&" || operation == "&&" || operation == "and") return a != 0 && b != 0;
  if (operation == "|" || operation == "||" || operation == "or") return a != 0 || b != 0;
  return std::nullopt;
}

const Vector* vector_in(const Value& value) {
  const auto* pointer = value.as<std::shared_ptr<Vector>>();
  return pointer ? pointer->get() : nullptr;
}

/// The numbers of a vector or of a list of numbers; a number alone is one.
std::optional<std::vector<double>> numbers_in(const Value& value) {
  if (const auto* number = value.as<double>()) return std::vector<double>{*number};
  if (const auto* vector = vector_in(value)) return vector->numbers;
  const auto* list = value.as<std::shared_ptr<List>>();
  if (!list) return std::nullopt;
  std::vector<double> numbers;
  for (const auto& element : **list) {
    const auto part = numbers_in(element);
    if (!part || numbers.size() + part->size() > most_numbers) return std::nullopt;
    numbers.insert(numbers.end(), part->begin(), part->end());
  }
  return numbers;
}

const std::string* unknown_in(const Value& value) {
  const auto* unknown = value.as<Unknown>();
  return unknown ? &unknown->why : nullptr;
}

/// Index of an element from a number that counts from the end where negative. False unless it is whole.
bool whole(double number, long& index) {
  const double nearest = std::round(number);
  if (!(std::abs(number - nearest) <= 1e-6) || std::abs(nearest) > 1e9) return false;
  index = static_cast<long>(nearest);
  return true;
}

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
  if (name == "float" || name == "float64" || name == "double") return [](double x) { return x; };
  if (name == "int" || name == "fix") return [](double x) { return std::trunc(x); };
  if (name == "round") return [](double x) { return std::nearbyint(x); };
  return nullptr;
}

/// Python joins and repeats lists, and decides between two values by "and" and "or", where arithmetic and MATLAB have
/// numbers. Nothing where both agree.
std::optional<Value> by_python(const Value& left, std::string_view operation, const Value& right) {
  const auto *a = left.as<double>(), *b = right.as<double>();
  if (operation == "and" || operation == "or") {
    if (!a) return Value{Unknown{fmt::format("'{}' of these is not understood", operation)}};
    return (*a != 0) == (operation == "and") ? right : left;
  }
  const auto *first = left.as<std::shared_ptr<List>>(), *second = right.as<std::shared_ptr<List>>();
  if ((!first && !second) || vector_in(left) || vector_in(right)) return std::nullopt;
  auto joined = std::make_shared<List>();
  const auto append = [&](const List& list) {
    if (joined->size() + list.size() > most_numbers) return false;
    joined->insert(joined->end(), list.begin(), list.end());
    return true;
  };
  long times = 0;
  const auto* count = first ? b : a;
  if (operation == "+" && first && second && append(**first) && append(**second)) return Value{joined};
  if (operation == "*" && count && whole(*count, times)) {
    const auto& list = first ? **first : **second;
    bool room = true;
    for (long i = 0; i < times && room && !list.empty(); ++i) room = append(list);
    if (room) return Value{joined};
  }
  return Value{Unknown{fmt::format("'{}' of these is not understood", operation)}};
}

}  // namespace

Value combined(const Value& left, std::string_view operation, const Value& right, Surroundings& surroundings) {
  for (const auto* side : {&left, &right})
    if (const auto* why = unknown_in(*side)) return {Unknown{*why}};
  if (surroundings.dialect == Dialect::python)
    if (auto value = by_python(left, operation, right)) return *value;
  const auto a = numbers_in(left), b = numbers_in(right);
  if (!a || !b || a->empty() || b->empty()) return {Unknown{fmt::format("'{}' of these is not understood", operation)}};
  const auto size = std::max(a->size(), b->size());
  if ((a->size() != size && a->size() != 1) || (b->size() != size && b->size() != 1))
    return {Unknown{fmt::format("'{}' joins {} and {} numbers", operation, a->size(), b->size())}};
  std::vector<double> result(size);
  bool truth = false;
  for (std::size_t i = 0; i < size; ++i) {
    const auto one = apply((*a)[a->size() == 1 ? 0 : i], operation, (*b)[b->size() == 1 ? 0 : i], truth);
    if (!one) return {Unknown{fmt::format("'{}' is not understood", operation)}};
    result[i] = *one;
  }
  if (left.as<double>() && right.as<double>()) return {result.front()};
  surroundings.numbers_made += size;
  if (surroundings.numbers_made > most_numbers_made) return {Unknown{"makes too many numbers"}};
  return {std::make_shared<Vector>(Vector{std::move(result), truth})};
}

bool chosen(const Subscript& subscript, std::size_t size, Dialect dialect, std::vector<std::size_t>& elements) {
  const long count = static_cast<long>(size), first = dialect == Dialect::matlab ? 1 : 0;
  elements.clear();
  if (!subscript.slice) {
    if (const auto* mask = vector_in(subscript.index)) {
      if (!mask->mask || mask->numbers.size() != size) return false;
      for (std::size_t i = 0; i < size; ++i)
        if (mask->numbers[i] != 0) elements.push_back(i);
      return true;
    }
    const auto* number = subscript.index.as<double>();
    long index = 0;
    if (!number || !whole(*number, index)) return false;
    index -= first;
    if (index < 0 && dialect == Dialect::python) index += count;
    if (index < 0 || index >= count) return false;
    elements.push_back(static_cast<std::size_t>(index));
    return true;
  }
  const auto bound = [&](const std::optional<Value>& value, long otherwise, long& index) {
    index = otherwise;
    if (!value) return true;
    const auto* number = value->as<double>();
    if (!number || !whole(*number, index)) return false;
    if (index < 0) index += count;
    index = std::clamp(index, 0L, count);
    return true;
  };
  long from = 0, to = count;
  if (dialect == Dialect::matlab) return false;
  if (!bound(subscript.from, 0, from) || !bound(subscript.to, count, to)) return false;
  for (long i = from; i < to; ++i) elements.push_back(static_cast<std::size_t>(i));
  return true;
}

bool Expression::take(std::string_view symbol) {
  if (!is(symbol)) return false;
  ++at_;
  return true;
}
void Expression::need(std::string_view symbol) {
  if (!take(symbol)) throw Failure{};
}

Value Expression::value() {
  try {
    auto result = either();
    if (surroundings_.dialect == Dialect::python && is(",")) {  // a tuple without parentheses
      auto list = std::make_shared<List>(List{result});
      while (take(",") && next().kind != Token::end) list->push_back(either());
      result = {list};
    }
    if (next().kind != Token::end) throw Failure{};
    return result;
  } catch (const Failure& failure) {
    return {failure.why.empty() ? Unknown{} : Unknown{failure.why}};
  }
}

Value Expression::either() {
  if (++depth_ > most_nested) throw Failure{"is nested too deeply"};
  auto left = both();
  while (is("|") || is("||") || (next().kind == Token::name && next().word == "or")) {
    const auto operation = next().word;
    ++at_;
    left = combined(left, operation, both(), surroundings_);
  }
  --depth_;
  return left;
}

Value Expression::both() {
  auto left = comparison();
  while (is("&") || is("&&") || (next().kind == Token::name && next().word == "and")) {
    const auto operation = next().word;
    ++at_;
    left = combined(left, operation, comparison(), surroundings_);
  }
  return left;
}

Value Expression::comparison() {
  auto left = sum();
  for (const char* operation : {"<=", ">=", "<", ">", "==", "!=", "~="})
    if (take(operation)) return combined(left, operation, sum(), surroundings_);
  return left;
}

/// In a matrix of MATLAB "a -b" is two elements, "a - b" and "a-b" are one.
bool Expression::begins_element() const {
  return in_matrix_ && next().after_space && at_ + 1 < tokens_.size() && !tokens_[at_ + 1].after_space;
}

Value Expression::sum() {
  auto left = product();
  while ((is("+") || is("-")) && !begins_element()) {
    const auto operation = next().word;
    ++at_;
    left = combined(left, operation, product(), surroundings_);
  }
  return left;
}

Value Expression::product() {
  auto left = sign();
  while (is("*") || is("/") || is("//") || is("%") || is(".*") || is("./")) {
    const auto operation = next().word;
    ++at_;
    left = combined(left, operation, sign(), surroundings_);
  }
  return left;
}

Value Expression::sign() {
  if (++depth_ > most_nested) throw Failure{"is nested too deeply"};
  Value result;
  if (take("-"))
    result = combined({-1.0}, "*", sign(), surroundings_);
  else if (take("+"))
    result = sign();
  else
    result = power();
  --depth_;
  return result;
}

Value Expression::power() {
  auto base = postfix();
  for (const char* operation : {"**", "^", ".^"}) {
    if (!take(operation)) continue;
    return combined(base, operation, sign(), surroundings_);
  }
  return base;
}

std::vector<Argument> Expression::arguments() {
  std::vector<Argument> found;
  while (!is(")")) {
    if (next().kind == Token::end || is("*") || is("**")) throw Failure{};
    Argument argument;
    if (next().kind == Token::name && at_ + 1 < tokens_.size() && tokens_[at_ + 1].kind == Token::symbol &&
        tokens_[at_ + 1].word == "=") {
      argument.name = next().word;
      at_ += 2;
    }
    argument.value = either();
    found.push_back(std::move(argument));
    if (!take(",")) break;
  }
  need(")");
  return found;
}

std::vector<Subscript> Expression::subscripts(std::string_view close) {
  std::vector<Subscript> found;
  const bool before = std::exchange(in_matrix_, false);
  while (!is(close)) {
    Subscript one;
    std::optional<Value> first;
    if (!is(":")) first = either();
    if (take(":")) {
      one.slice = true;
      one.from = first;
      if (!is(close) && !is(",")) one.to = either();
    } else {
      one.index = *first;
    }
    found.push_back(std::move(one));
    if (!take(",")) break;
  }
  need(close);
  in_matrix_ = before;
  return found;
}

Value Expression::element(const Value& of, const std::vector<Subscript>& subscripts) {
  if (subscripts.size() != 1) throw Failure{};
  const auto& subscript = subscripts.front();
  if (const auto record = record_of(of)) {
    const auto* key = subscript.index.as<std::string>();
    if (!key || subscript.slice) throw Failure{};
    const auto found = record->slots.find(*key);
    if (found == record->slots.end()) throw Failure{fmt::format("refers to '{}', which is not given", *key)};
    return found->second.value;
  }
  std::vector<std::size_t> elements;
  if (const auto* list = of.as<std::shared_ptr<List>>()) {
    if (subscript.slice || !chosen(subscript, (*list)->size(), surroundings_.dialect, elements)) throw Failure{};
    if (elements.empty()) throw Failure{};
    return (**list)[elements.front()];
  }
  if (of.as<double>() && !subscript.slice) {  // p.A(1) where A is one number
    if (!chosen(subscript, 1, surroundings_.dialect, elements)) throw Failure{};
    return of;
  }
  const auto* vector = vector_in(of);
  if (!vector || !chosen(subscript, vector->numbers.size(), surroundings_.dialect, elements)) throw Failure{};
  std::vector<double> part;
  for (const auto i : elements) part.push_back(vector->numbers[i]);
  if (subscript.index.as<double>() && !subscript.slice && part.size() == 1) return {part.front()};
  auto slice = vector_of(std::move(part), vector->mask);
  if (subscript.slice) (*slice.as<std::shared_ptr<Vector>>())->part_of = *of.as<std::shared_ptr<Vector>>();
  return slice;
}

Value Expression::vector_of(std::vector<double> numbers, bool mask) {
  surroundings_.numbers_made += numbers.size();
  if (numbers.size() > most_numbers || surroundings_.numbers_made > most_numbers_made)
    throw Failure{"makes too many numbers"};
  return {std::make_shared<Vector>(Vector{std::move(numbers), mask})};
}

/// A name, what stands behind its dots, brackets and parentheses.
Value Expression::postfix() {
  const bool named = next().kind == Token::name;
  auto name = named ? next().word : std::string();
  const bool variable = named && surroundings_.variables.slots.contains(name);
  Value value;
  bool module = false;  // "np" and others: names of functions follow
  if (named && !variable && name != "True" && name != "False" && name != "None" && name != "true" && name != "false" &&
      name != "pi" && name != "inf" && name != "Inf" && name != "lambda" && name != "not" && name != "nan") {
    ++at_;
    module = true;
  } else {
    value = atom();
  }
  Value object;
  bool has_object = false;
  while (true) {
    if (is(".") && at_ + 1 < tokens_.size() && tokens_[at_ + 1].kind == Token::name) {
      ++at_;
      name = next().word;
      ++at_;
      if (module) {
        if (name == "pi") value = {std::numbers::pi}, module = false;
        if (name == "inf") value = {INFINITY}, module = false;
        continue;
      }
      object = value, has_object = true;
      if (is("(") && surroundings_.dialect == Dialect::python) continue;
      const auto record = record_of(value);
      if (!record) {
        value = {Unknown{}};
        continue;
      }
      const auto found = record->slots.find(name);
      value = found == record->slots.end() ? Value{Unknown{fmt::format("refers to '{}', which is not given", name)}}
                                           : found->second.value;
      continue;
    }
    const bool calls = is("(") && !(in_matrix_ && next().after_space);
    if (calls && (module || has_object) && surroundings_.dialect == Dialect::python) {
      value = call(name, has_object ? &object : nullptr);
      module = has_object = false;
    } else if (calls && module) {
      value = call(name, nullptr);
      module = false;
    } else if (calls && surroundings_.dialect == Dialect::matlab) {
      ++at_;
      value = element(value, subscripts(")"));
    } else if (is("[") && surroundings_.dialect == Dialect::python && !module) {
      ++at_;
      value = element(value, subscripts("]"));
      has_object = false;
    } else if (is("'") && surroundings_.dialect == Dialect::matlab) {
      ++at_;
    } else {
      break;
    }
  }
  if (module) throw Failure{fmt::format("refers to '{}', which is not given", name)};
  return value;
}

Value Expression::call(const std::string& name, const Value* object) {
  need("(");
  const bool before = std::exchange(in_matrix_, false);
  auto given = arguments();
  in_matrix_ = before;
  if (object) given.insert(given.begin(), {"", *object});
  if (surroundings_.own_functions.contains(name) || name == "setattr" || name == "exec" || name == "eval") {
    for (const auto& argument : given)
      if (const auto record = record_of(argument.value)) record->handed_over = surroundings_.line;
    return {Unknown{fmt::format("comes from '{}', which is not run", name)}};
  }
  return function(name, given);
}

Value Expression::function(const std::string& name, const std::vector<Argument>& given) {
  const auto number = [&](std::size_t i) -> double {
    const auto* value = i < given.size() ? given[i].value.as<double>() : nullptr;
    if (!value) throw Failure{fmt::format("'{}' of these is not understood", name)};
    return *value;
  };
  const auto named = [&](std::string_view key) -> const Value* {
    for (const auto& argument : given)
      if (argument.name == key) return &argument.value;
    return nullptr;
  };
  const auto size_from = [&](double count) {
    long size = 0;
    if (!whole(count, size) || size < 0 || static_cast<std::size_t>(size) > most_numbers)
      throw Failure{fmt::format("makes {} numbers; at most {} are", count, most_numbers)};
    return static_cast<std::size_t>(size);
  };
  const auto length_of = [&](std::size_t i) {
    const auto numbers = i < given.size() ? numbers_in(given[i].value) : std::nullopt;
    if (!numbers) throw Failure{fmt::format("'{}' of these is not understood", name)};
    return numbers->size();
  };
  if (auto known = surroundings_.call(name, given, surroundings_.line); !known.as<Unknown>()) return known;
  if (name == "arange") {
    const double start = given.size() > 1 ? number(0) : 0, stop = number(given.size() > 1 ? 1 : 0);
    const double step = given.size() > 2 ? number(2) : 1;
    std::vector<double> numbers(size_from(std::max(0.0, std::ceil((stop - start) / step))));
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = start + static_cast<double>(i) * step;
    return vector_of(std::move(numbers));
  }
  if (name == "linspace") {
    const auto* counted = named("num");
    const double count = counted && counted->as<double>() ? *counted->as<double>() : given.size() > 2 ? number(2) : 50;
    std::vector<double> numbers(size_from(count));
    const double from = number(0), to = number(1), intervals = static_cast<double>(numbers.size()) - 1;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      numbers[i] = i + 1 == numbers.size() && i > 0 ? to : from + static_cast<double>(i) * ((to - from) / intervals);
    return vector_of(std::move(numbers));
  }
  if (name == "ones_like") return vector_of(std::vector<double>(length_of(0), 1.0));
  if (name == "zeros_like") return vector_of(std::vector<double>(length_of(0), 0.0));
  if (name == "full_like") return vector_of(std::vector<double>(length_of(0), number(1)));
  if (surroundings_.dialect == Dialect::python) {
    if (name == "ones") return vector_of(std::vector<double>(size_from(number(0)), 1.0));
    if (name == "zeros") return vector_of(std::vector<double>(size_from(number(0)), 0.0));
    if (name == "full") return vector_of(std::vector<double>(size_from(number(0)), number(1)));
    if (name == "len") return {static_cast<double>(length_of(0))};
    if (name == "dict") {
      auto record = std::make_shared<Record>();
      for (const auto& argument : given) record->slots[argument.name] = {argument.value, surroundings_.line};
      return {record};
    }
  }
  if (name == "array" || name == "asarray" || name == "concatenate" || name == "hstack" || name == "copy") {
    const auto numbers = given.empty() ? std::nullopt : numbers_in(given.front().value);
    if (!numbers) throw Failure{fmt::format("'{}' of these is not understood", name)};
    return vector_of(*numbers);
  }
  if (name == "max" || name == "min") {
    std::vector<double> all;
    for (const auto& argument : given)
      if (const auto part = numbers_in(argument.value)) all.insert(all.end(), part->begin(), part->end());
    if (all.empty() || all.size() < given.size()) throw Failure{fmt::format("'{}' of these is not understood", name)};
    return {name == "max" ? *std::ranges::max_element(all) : *std::ranges::min_element(all)};
  }
  if (auto* f = function_named(name); f && given.size() == 1) {
    if (const auto* plain = given[0].value.as<double>()) return {f(*plain)};
    if (const auto* why = unknown_in(given[0].value)) throw Failure{*why};
    if (const auto numbers = numbers_in(given[0].value)) {
      auto result = *numbers;
      for (auto& one : result) one = f(one);
      return vector_of(std::move(result));
    }
  }
  throw Failure{fmt::format("the function '{}' is not understood", name)};
}

Value Expression::atom() {
  const auto token = next();
  if (token.kind == Token::number) {
    ++at_;
    return {token.value};
  }
  if (token.kind == Token::text) {
    ++at_;
    return {token.word};
  }
  if (token.kind == Token::name) {
    ++at_;
    if (const auto found = surroundings_.variables.slots.find(token.word); found != surroundings_.variables.slots.end())
      return found->second.value;
    if (token.word == "True" || token.word == "true") return {1.0};
    if (token.word == "False" || token.word == "false") return {0.0};
    if (token.word == "pi") return {std::numbers::pi};
    if (token.word == "inf" || token.word == "Inf") return {INFINITY};
    throw Failure{};
  }
  if (take("(")) {
    const bool before = std::exchange(in_matrix_, false);
    auto value = either();
    if (is(",")) {
      auto list = std::make_shared<List>(List{value});
      while (take(",") && !is(")")) list->push_back(either());
      value = {list};
    }
    need(")");
    in_matrix_ = before;
    return value;
  }
  if (take("[")) return brackets();
  if (is("{") && surroundings_.dialect == Dialect::python) return braces();
  throw Failure{};
}

Value Expression::brackets() {
  const bool before = std::exchange(in_matrix_, surroundings_.dialect == Dialect::matlab);
  auto list = std::make_shared<List>();
  while (!is("]")) {
    if (next().kind == Token::end) throw Failure{};
    if (take(",") || take(";")) continue;
    if (list->size() >= most_numbers) throw Failure{"has too many entries"};
    const auto before_it = at_;
    list->push_back(either());
    if (at_ == before_it || (!in_matrix_ && !is(",") && !is("]"))) throw Failure{};
  }
  need("]");
  in_matrix_ = before;
  return {list};
}

Value Expression::braces() {
  need("{");
  auto record = std::make_shared<Record>();
  while (!is("}")) {
    if (next().kind != Token::text) throw Failure{};
    const auto key = next().word;
    const int line = surroundings_.line + next().line;
    ++at_;
    need(":");
    const auto begin = at_;
    const int depth = depth_;
    Slot slot{{}, line};
    try {
      slot.value = either();
    } catch (const Failure& failure) {  // the other entries stand all the same
      slot.value = {failure.why.empty() ? Unknown{} : Unknown{failure.why}};
      depth_ = depth;
      int open = 0;
      for (at_ = begin; next().kind != Token::end; ++at_) {
        if (is("(") || is("[") || is("{")) ++open;
        if (open == 0 && (is(",") || is("}"))) break;
        if (is(")") || is("]") || is("}")) --open;
      }
    }
    record->slots[key] = std::move(slot);
    if (!take(",")) break;
  }
  need("}");
  return {record};
}

bool Expression::target(Target& target) {
  try {
    if (next().kind != Token::name) return false;
    target.steps.push_back({next().word, {}});
    ++at_;
    while (next().kind != Token::end) {
      if (take(".")) {
        if (next().kind != Token::name) return false;
        target.steps.push_back({next().word, {}});
        ++at_;
        continue;
      }
      const auto close = take("[") ? "]" : surroundings_.dialect == Dialect::matlab && take("(") ? ")" : "";
      if (!*close) return false;
      auto found = subscripts(close);
      if (found.empty()) return false;
      const auto* key = found.front().index.as<std::string>();
      target.steps.push_back({found.size() == 1 && key && !found.front().slice ? *key : std::string(), {}});
      if (target.steps.back().name.empty()) target.steps.back().subscripts = std::move(found);
    }
    return true;
  } catch (const Failure&) {  // a part that is not understood, of what came before
    if (target.steps.empty()) return false;
    target.steps.push_back({"", {Subscript{}}});
    return true;
  }
}

}  // namespace rosin::app::imports
