/// Graphs and tapes: derivatives of every operation against differences, lanes against doubles, and what a tape costs.
#include "laws/tape.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "core/dual.hpp"

using namespace rosin;
using namespace rosin::laws;

namespace {

/// A compiled list of nodes over inputs alone.
struct Compiled {
  Tape tape;
  std::vector<double> constants;

  Compiled(const Graph& graph, std::vector<int> outputs) {
    ConstantPool pool;
    tape = compile(graph, outputs, pool);
    constants = compile_pool(graph, pool)(std::vector<double>());
  }
  template <class Real>
  std::vector<Real> operator()(const std::vector<Real>& at) const {
    std::vector<const Real*> inputs;
    for (const Real& x : at) inputs.push_back(&x);
    const std::vector<Real> numbers(constants.begin(), constants.end());
    const TapeRun<Real> run(tape, numbers.data(), inputs.data());
    std::vector<Real> outputs;
    for (std::size_t k = 0; k < tape.outputs.size(); ++k) outputs.push_back(run[k]);
    return outputs;
  }
};

/// df/dx by central differences of order 8.
template <class F>
double difference(F f, double x, double h) {
  const double c[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  double sum = 0;
  for (int k = 1; k <= 4; ++k) sum += c[k - 1] * (f(x + k * h) - f(x - k * h));
  return sum / h;
}

}  // namespace

TEST_CASE("derivatives of every operation agree with differences of order 8", "[laws][formula]") {
  using enum Operation;
  const std::vector<std::vector<double>> points = {{0.4, 0.7}, {1.7, -0.6}, {3.1, 5.2}, {0.05, 1.1}, {-0.8, 2.3}};
  for (const auto operation : {add, subtract, multiply, divide, negate, exp, log, sqrt, abs, sign, sinh, cosh, tanh,
                               asinh, minimum, maximum, power, asinh_exp, sinh_exp})
    for (const auto& at : points) {
      INFO("operation " << int(operation) << " at " << at[0] << ", " << at[1]);
      if (at[0] < 0 && (operation == log || operation == sqrt || operation == power)) continue;
      Graph graph;
      const int node = graph.make(operation, graph.input(0), graph.input(1));
      for (int k = 0; k < operand_count(operation); ++k) {
        const Compiled f(graph, {node}), slope(graph, graph.differentiate(std::vector{node}, k));
        const auto along = [&](double x) {
          auto moved = at;
          moved[std::size_t(k)] = x;
          return f(moved)[0];
        };
        const double step = 4e-3 * std::min(1.0, 2 * std::abs(at[std::size_t(k)]));
        const double numeric = difference(along, at[std::size_t(k)], step), value = std::abs(f(at)[0]);
        const double exact = slope(at)[0];
        CHECK(std::abs(exact - numeric) <= 2e-11 * (std::abs(exact) + value));

        // Tower arithmetic on the tape of the value: first derivatives are the same, second differentiate the first.
        std::vector<Tower> towers{at[0], at[1]};
        using First = Dual<double, 1>;
        using Second = Dual<First, 1>;
        towers[std::size_t(k)] = Tower::variable(Second::variable(First::variable(at[std::size_t(k)], 0), 0), 0);
        const Tower t = f(towers)[0];
        CHECK(t.slope[0].value.value == Approx(exact).epsilon(1e-13).margin(1e-15));
        const auto slope_along = [&](double x) {
          auto moved = at;
          moved[std::size_t(k)] = x;
          return slope(moved)[0];
        };
        const double second = difference(slope_along, at[std::size_t(k)], step);
        CHECK(std::abs(t.slope[0].slope[0].value - second) <= 1e-8 * (std::abs(second) + std::abs(exact) + value));
      }
    }
}

TEST_CASE("derivatives at rest and far out are the limits", "[laws][formula]") {
  using enum Operation;
  Graph graph;
  const int x = graph.input(0), E = graph.input(1);
  const auto slope = [&](Operation operation, double at, double exponent = 0) {
    const int node = graph.make(operation, x, E);
    return Compiled(graph, graph.differentiate(std::vector{node}, 0))(std::vector{at, exponent})[0];
  };
  for (const auto operation : {sinh, tanh, asinh}) CHECK(slope(operation, 0) == Approx(1).epsilon(1e-15));
  CHECK(slope(asinh_exp, 0, 3) == Approx(std::exp(3)).epsilon(1e-14));
  CHECK(slope(sinh_exp, 0, 3) == Approx(std::exp(-3)).epsilon(1e-14));
  CHECK(slope(asinh_exp, 1e-3, 2000) == Approx(1e3).epsilon(1e-14));
  CHECK(slope(tanh, 20) == Approx(1 / std::pow(std::cosh(20.0), 2)).epsilon(1e-13));
  CHECK(slope(tanh, 800) == 0);
  CHECK(slope(power, 0, 2) == 0);
}

TEST_CASE("lanes of a tape have the values of doubles", "[laws][formula]") {
  using enum Operation;
  Graph graph;
  const int a = graph.input(0), b = graph.input(1);
  std::vector<int> outputs;
  for (const auto operation : {add, subtract, multiply, divide, negate, exp, log, sqrt, abs, sign, sinh, cosh, tanh,
                               asinh, minimum, maximum, power, asinh_exp, sinh_exp}) {
    const int node = graph.make(operation, a, b);
    outputs.push_back(node);
    for (const int k : {0, 1}) outputs.push_back(graph.differentiate(std::vector{node}, k)[0]);
  }
  const Compiled f(graph, outputs);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-3, 3);
  std::vector<Lanes> at(2);
  for (int lane = 0; lane < lane_count; ++lane)
    for (auto& x : at) x.set(lane, lane % 5 == 0 ? std::abs(uniform(random)) : uniform(random));
  const auto lanes = f(at);
  for (int lane = 0; lane < lane_count; ++lane) {
    const auto one = f(std::vector{at[0][lane], at[1][lane]});
    for (std::size_t k = 0; k < one.size(); ++k) {
      INFO("output " << k << " at " << at[0][lane] << ", " << at[1][lane]);
      if (std::isnan(one[k]))
        CHECK(std::isnan(lanes[k][lane]));
      else
        CHECK(lanes[k][lane] == Approx(one[k]).epsilon(2e-15).margin(1e-300));
    }
  }
}

TEST_CASE("what is constant, shared or multiplied by zero is not computed again", "[laws][formula]") {
  using enum Operation;
  Graph graph;
  const int x = graph.input(0), p = graph.parameter(0), q = graph.parameter(1);
  CHECK(graph.make(add, graph.constant(2), graph.constant(3)) == graph.constant(5));
  CHECK(graph.make(multiply, x, p) == graph.make(multiply, p, x));
  CHECK(graph.make(multiply, x, graph.constant(0)) == graph.constant(0));
  CHECK(graph.make(subtract, x, graph.constant(0)) == x);
  CHECK(graph.make(negate, graph.make(negate, x)) == x);

  // exp(x·ln(p)/q)·p + its double: ln(p), 1/q and their product do not vary.
  const int inside = graph.make(divide, graph.make(multiply, x, graph.make(log, p)), q);
  const int grown = graph.make(multiply, graph.make(exp, inside), p);
  const int node = graph.make(add, grown, graph.make(multiply, graph.constant(2), grown));
  ConstantPool pool;
  const Tape tape = compile(graph, std::vector{node}, pool);
  CHECK(tape.instructions.size() == 6);  // x·ln p, ·(1/q), exp, ·p, 2·, +
  CHECK(pool.nodes.size() == 4);         // ln p, 1/q, p, 2
  const auto constants = compile_pool(graph, pool)(std::vector{5.0, 0.5});
  const double at = 0.3;
  const double* inputs[] = {&at};
  CHECK(TapeRun<double>(tape, constants.data(), inputs)[0] ==
        Approx(3 * 5 * std::exp(0.3 * std::log(5.0) / 0.5)).epsilon(1e-15));

  // A value and its derivatives that share their exponentials take one instruction.
  const int friction = graph.make(asinh_exp, x, graph.input(1)), slip = graph.make(sinh_exp, x, graph.input(1));
  for (const int f : {friction, slip}) {
    const std::vector<int> outputs{f, graph.differentiate(std::vector{f}, 0)[0],
                                   graph.differentiate(std::vector{f}, 1)[0]};
    CHECK(compile(graph, outputs, pool).instructions.size() == (f == friction ? 1 : 2));
  }
}

TEST_CASE("registers are used again, and running out of them is said", "[laws][formula]") {
  using enum Operation;
  Graph graph;
  const int x = graph.input(0);
  int chain = x;
  for (int i = 0; i < 2000; ++i) chain = graph.make(sinh_exp, chain, x);
  ConstantPool pool;
  CHECK(compile(graph, std::vector{chain}, pool).registers <= 4);
  std::vector<int> wide;
  for (int i = 0; i < 300; ++i) wide.push_back(graph.make(power, x, graph.constant(i + 0.5)));
  CHECK_THROWS_WITH(compile(graph, wide, pool), Catch::Contains("more than 256 intermediate values"));
}
