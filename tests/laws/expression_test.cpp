/// Expressions: values of what is right, messages for what is wrong, and that hostile text ends in a message.
#include "laws/expression.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "laws/tape.hpp"

using namespace rosin;
using namespace rosin::laws;

namespace {

constexpr double x = 0.7, y = -1.3, L = 2.5e-6, t = 40, s = 3;

/// x and y are plain numbers, L a length, t a time; s is a name that is a unit too.
class SomeNames final : public Names {
 public:
  explicit SomeNames(Graph& graph) {
    const char* names[] = {"x", "y", "L", "t", "s"};
    const char* units[] = {"1", "1", "m", "s", "1"};
    for (int i = 0; i < 5; ++i) {
      known_.emplace_back(names[i]);
      values_[names[i]] = {graph.input(i), parse_unit(units[i])->dimension};
    }
  }
  std::optional<Measured> find(std::string_view name, int) override {
    const auto at = values_.find(std::string(name));
    return at == values_.end() ? std::nullopt : std::optional(at->second);
  }
  const std::vector<std::string>& known() const override { return known_; }

 private:
  std::map<std::string, Measured> values_;
  std::vector<std::string> known_;
};

struct Evaluated {
  double value;
  std::string unit;
};
Evaluated evaluated(const std::string& text) {
  Graph graph;
  SomeNames names(graph);
  const auto parsed = parse_expression(graph, names, "test", text);
  ConstantPool pool;
  const Tape tape = compile(graph, {&parsed.node, 1}, pool);
  const auto constants = compile_pool(graph, pool)(std::vector<double>());
  const double* inputs[] = {&x, &y, &L, &t, &s};
  return {TapeRun<double>(tape, constants.data(), inputs)[0], coherent_unit(parsed.dimension)};
}

struct Refused {
  std::string message;
  std::size_t offset;
};
Refused refused(const std::string& text) {
  try {
    evaluated(text);
  } catch (const ExpressionError& error) {
    return {error.what(), error.offset};
  }
  return {"accepted", 0};
}

}  // namespace

TEST_CASE("expressions have their value and their unit", "[laws][formula]") {
  const struct {
    const char* text;
    double value;
    const char* unit;
  } cases[] = {
      {"1 + 2*3", 7, "1"},
      {"1 - 2 - 3", -4, "1"},
      {"12/3/2", 2, "1"},
      {"2^3^2", 512, "1"},
      {"-2^2", -4, "1"},
      {"2^-1", 0.5, "1"},
      {"(-2)^3", -8, "1"},
      {"y^2", y * y, "1"},
      {"--x", x, "1"},
      {"+x*-y", -x * y, "1"},
      {" ( x\t+\ny ) ", x + y, "1"},
      {".5 + 1.e1 + 2E-1", 10.7, "1"},
      {"pi", 3.14159265358979323846, "1"},
      {"x^1.5", std::pow(x, 1.5), "1"},
      {"x^y", std::pow(x, y), "1"},
      {"0^x", 0, "1"},
      {"exp(x) + ln(x) + log(x) + log10(x)", std::exp(x) + 2 * std::log(x) + std::log10(x), "1"},
      {"sinh(y)", std::sinh(y), "1"},
      {"cosh(y)", std::cosh(y), "1"},
      {"tanh(y)", std::tanh(y), "1"},
      {"asinh(y)", std::asinh(y), "1"},
      {"asinh_exp(y, x)", std::asinh(y * std::exp(x)), "1"},
      {"sinh_exp(y, x)", std::sinh(y) * std::exp(-x), "1"},
      {"asinh_exp(1e-3, 2000)", std::log(2e-3) + 2000, "1"},
      {"min(x, y) - max(x, y)", y - x, "1"},
      {"abs(y)*sign(y)", y, "1"},
      {"max(0, L)", L, "m"},
      {"sign(L)", 1, "1"},
      {"sqrt(L*L)", L, "m"},
      {"L^2", L * L, "m^2"},
      {"L^0.5*L^(1/2)", L, "m"},
      {"L/t", L / t, "m/s"},
      {"1/(L*t)", 1 / (L * t), "1/(m s)"},
      {"3 um", 3e-6, "m"},
      {"3um + L", 3e-6 + L, "m"},
      {"6 mm/min*t", 4e-3, "m"},
      {"7200 m/min^2", 2, "m/s^2"},
      {"(2 m^2)/L", 2 / L, "m"},
      {"2 N s/m", 2, "kg/s"},
      {"(5 m)/s", 5 / s, "m"},
      {"1 1/2", 0, "refused"},
      {"5 MPa", 5e6, "kg/(m s^2)"},
      {"50 %", 0, "refused"},
      {"1 m/sqrt(4)", 0.5, "m"},
  };
  for (const auto& c : cases) {
    INFO(c.text);
    if (c.unit == std::string("refused")) {
      CHECK(refused(c.text).message != "accepted");
      continue;
    }
    const auto got = evaluated(c.text);
    CHECK(got.value == Approx(c.value).epsilon(1e-14));
    CHECK(got.unit == c.unit);
  }
}

TEST_CASE("wrong expressions are refused at their token, with what to try", "[laws][formula]") {
  const struct {
    const char* text;
    std::size_t offset;
    const char* message;
  } cases[] = {
      {"", 0, "is empty"},
      {"   ", 0, "is empty"},
      {"1 +", 3, "ends where a number, a name or '(' is needed"},
      {"(x", 2, "ends where ')' is needed"},
      {"x)", 1, "')' closes nothing"},
      {"x y", 2, "'y' stands where an operator is needed"},
      {"x, y", 1, "',' stands where an operator is needed"},
      {"x ** 2", 3, "a power is written with ^"},
      {"x + * y", 4, "'*' stands where"},
      {"asnh(x)", 0, "unknown function 'asnh'; did you mean 'asinh'?"},
      {"system(x)", 0, "unknown function 'system'; known here: exp, ln"},
      {"z + x", 0, "unknown name 'z'"},
      {"x + LL", 4, "unknown name 'LL'; did you mean 'L'?"},
      {"nan", 0, "unknown name 'nan'"},
      {"inf*x", 0, "unknown name 'inf'"},
      {"x(y)", 0, "'x' is not a function; a product is written with *"},
      {"exp", 0, "'exp' is a function; its argument stands in parentheses"},
      {"exp()", 4, "')' stands where a number"},
      {"exp(x, y)", 0, "exp takes 1 argument, not 2"},
      {"min(x)", 0, "min takes 2 arguments, not 1"},
      {"2 x", 2, "'x' follows a number; a product is written with *"},
      {"2 furlings", 2, "'furlings' is not a unit"},
      {"2(x)", 1, "'(' stands where an operator is needed"},
      {"2 m^2/L", 6, "'L' may be a unit or a name of this law here; put the number and its unit in parentheses"},
      {"5 m/s", 4, "'s' may be a unit or a name of this law here"},
      {"20 degC", 2, "not a unit that a number can be multiplied by"},
      {"1e999", 0, "too large or too small for a number"},
      {"1 m^999", 3, "the power of a unit is a small whole number"},
      {"x = 1", 2, "'=' stands where an operator is needed"},
      {"x; y", 1, "';' stands where an operator is needed"},
      {"x × y", 2, "'×' stands where an operator is needed"},
      {"`ls`", 0, "'`' stands where"},
      // units
      {"x + L", 4, "'x' (dimensionless) and 'L' (m) cannot be added: their units differ"},
      {"L*x - t/2", 6, "'L*x' (m) and 't/2' (s) cannot be subtracted"},
      {"max(L, t)", 7, "'L' (m) and 't' (s) cannot be compared"},
      {"exp(L/t)", 4, "the argument of exp must be dimensionless, but 'L/t' is in m/s"},
      {"asinh_exp(L/t, x)", 10, "the argument of asinh_exp must be dimensionless"},
      {"x^L", 2, "an exponent must be dimensionless"},
      {"L^x", 2, "its exponent must be a number"},
      {"1 + 0*L", 4, "cannot be added"},
  };
  for (const auto& c : cases) {
    INFO(c.text);
    const auto got = refused(c.text);
    CHECK_THAT(got.message, Catch::Contains(c.message));
    CHECK_THAT(got.message, Catch::StartsWith("test: "));
    CHECK(got.offset == c.offset);
  }
}

TEST_CASE("hostile text ends in a message, not in a crash", "[laws][formula]") {
  CHECK_THAT(refused(std::string(1'000'000, '(')).message, Catch::Contains("has 1000000 characters, more than 4000"));
  for (const char* part : {"(", "-", "exp(", "x^", "2^-", "min(x,", "+"}) {
    std::string text;
    while (text.size() < 3900) text += part;
    INFO(part);
    CHECK_THAT(refused(text).message, Catch::Contains("is nested more than 100 deep"));
  }
  std::string sum = "x";  // long, but not deep
  for (int i = 0; i < 900; ++i) sum += "+x*y";
  CHECK(evaluated(sum).value == Approx(x + 900 * x * y).epsilon(1e-12));
  std::string unit = "1 m";
  while (unit.size() < 3900) unit += " m m m";
  CHECK_THAT(refused("x + " + unit).message, Catch::Contains("is not a unit that a number"));
  CHECK(std::isinf(evaluated("1/0").value));  // what a law does with it is refused when it is asked
  CHECK(std::isnan(evaluated("ln(y)").value));

  // Random text over the alphabet of expressions: a value or a message.
  const std::string alphabet = "xyLts019.e+-*/^(), mNu\n\"exp(ln(";
  std::mt19937 random(7);
  std::uniform_int_distribution<std::size_t> pick(0, alphabet.size() - 1), length(1, 30);
  int accepted = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text;
    for (auto n = length(random); n > 0; --n) text += alphabet[pick(random)];
    accepted += refused(text).message == "accepted";
  }
  CHECK(accepted > 50);
  CHECK(accepted < 10'000);
}
