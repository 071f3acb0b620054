/// From the text of a law to tapes for each question that is asked of it, and the law and contacts that run them.
#include "laws/formula.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "core/units.hpp"
#include "laws/adapter.hpp"
#include "laws/tape.hpp"

namespace rosin::laws {

namespace {

constexpr int most_states = 7;
constexpr std::size_t most_solved = 2;  ///< states of steady sliding that equations give
constexpr std::size_t most_names = 200;

/// Inputs of tapes. Contacts carry states from `first_state` on, as their unknowns.
enum Input { slip_rate, normal_load, load_rate, direction, compliance, friction, first_state };
constexpr int most_inputs = first_state + most_states;

[[noreturn]] void refuse(const std::string& path, const std::string& problem) {
  throw ExpressionError("law.formula." + path, ExpressionError::whole, problem);
}

// ---------------------------------------------------------------- names and expressions

/// The words of a law, and the definitions behind them, each parsed when it is first used.
class Words final : public Names {
 public:
  Words(Graph& graph, const FormulaDescription& law) : graph_(graph), law_(law) {
    if (law.parameters.size() + law.states.size() + law.define.size() > most_names)
      refuse("define", fmt::format("the law has more than {} names", most_names));
    add("v", "v", Measured{graph.input(Input::slip_rate), unit_of("m/s")});
    add("N", "N", Measured{graph.input(Input::normal_load), unit_of("N")});
    add("mu", "mu", Measured{graph.input(Input::friction), {}});
    for (std::size_t i = 0; i < law.parameters.size(); ++i) {
      const auto& quantity = law.parameters[i].quantity;
      const auto path = "parameters." + quantity.name;
      add(quantity.name, path, Measured{graph.parameter(int(i)), declared_unit(path, quantity)});
    }
    for (std::size_t i = 0; i < law.states.size(); ++i) {
      const auto path = "states." + law.states[i].name;
      add(law.states[i].name, path,
          Measured{graph.input(Input::first_state + int(i)), declared_unit(path, law.states[i])});
    }
    for (const auto& [name, text] : law.define) add(name, "define." + name, std::nullopt);
  }

  std::optional<Measured> find(std::string_view name, int depth) override {
    const auto at = values_.find(name);
    if (at == values_.end()) return std::nullopt;
    if (!at->second) at->second = define(at->first, depth);
    return at->second;
  }
  const std::vector<std::string>& known() const override { return known_; }

  static Dimension unit_of(std::string_view text) { return parse_unit(text)->dimension; }

 private:
  void add(const std::string& name, const std::string& path, std::optional<Measured> value) {
    if (!may_be_name(name))
      refuse(path, fmt::format("'{}' cannot be a name: it needs a letter, then letters, digits or _, and may not be "
                               "the name of a function",
                               name));
    if (!values_.emplace(name, value).second) refuse(path, fmt::format("the name '{}' is already taken", name));
    known_.push_back(name);
  }
  static Dimension declared_unit(const std::string& path, const Quantity& quantity) {
    const auto unit = parse_unit(quantity.unit);
    if (!unit) refuse(path, fmt::format("'{}' is not a known unit", quantity.unit));
    if (unit->factor != 1 || unit->offset)
      refuse(path, fmt::format("its unit '{}' must be plain SI, that is {}; values may carry any unit, as texts",
                               quantity.unit, coherent_unit(unit->dimension)));
    return unit->dimension;
  }
  Measured define(const std::string& name, int depth) {
    const auto path = "define." + name;
    if (std::ranges::find(open_, name) != open_.end())
      refuse(path, fmt::format("'{}' is defined by itself: {} → {}", name, fmt::join(open_, " → "), name));
    open_.push_back(name);
    const auto text = std::ranges::find(law_.define, name, &std::pair<std::string, std::string>::first)->second;
    const auto value = parse_expression(graph_, *this, "law.formula." + path, text, depth);
    open_.pop_back();
    return value;
  }

  Graph& graph_;
  const FormulaDescription& law_;
  std::map<std::string, std::optional<Measured>, std::less<>> values_;
  std::vector<std::string> known_, open_;
};

/// The expressions of a law as nodes over (v, N, mu, states).
struct Expressions {
  int friction = -1, slip_rate = -1, static_limit = -1, kink = -1;
  std::vector<int> rate;
  /// By v and N alone, but where states are `solved` for: then these hold at their root, from which Newton's method has
  /// taken two steps more, so that derivatives to the third order are those of the root.
  std::vector<int> steady;
  std::vector<int> solved, residual;  ///< states that no formula gives, and what vanishes in steady sliding of each
  std::vector<int> rest, after_stop, size;  ///< by default the steady state of slowest creep, and twice the state asked
};

class Reader {
 public:
  Reader(Graph& graph, const FormulaDescription& law) : graph_(graph), law_(law), words_(graph, law) {}

  Expressions operator()() {
    Expressions read;
    const std::size_t states = law_.states.size();
    if (states > std::size_t(most_states)) refuse("states", fmt::format("more than {} states", most_states));
    read.friction = node("friction", law_.friction, {}, {.slip_rate = true, .states = true});
    const auto written = [&](const std::vector<std::string>& list, std::size_t k) {
      return k < list.size() && !list[k].empty();
    };
    for (std::size_t k = 0; k < states; ++k) {
      const auto& state = law_.states[k];
      const auto unit = Words::unit_of(state.unit);
      if (!written(law_.rate, k)) refuse("rate", fmt::format("there is no rate of state '{}'", state.name));
      read.rate.push_back(
          node("rate." + state.name, law_.rate[k], unit / Words::unit_of("s"), {.slip_rate = true, .states = true}));
      read.steady.push_back(written(law_.steady, k) ? node("steady." + state.name, law_.steady[k], unit,
                                                           {.slip_rate = true, .states = true})
                                                    : -1);
    }
    find_steady_states(read);
    for (std::size_t k = 0; k < states; ++k) {
      const auto& state = law_.states[k];
      const auto unit = Words::unit_of(state.unit);
      const int own = graph_.input(Input::first_state + int(k));
      read.size.push_back(written(law_.size, k) ? node("size." + state.name, law_.size[k], unit, {.load = false})
                                                : own);
      auto creep = inputs();
      creep[Input::slip_rate] = Symbol(FrictionLaw::slowest_creep).in(graph_);
      read.rest.push_back(written(law_.rest, k) ? node("rest." + state.name, law_.rest[k], unit, {})
                                                : graph_.substitute({&read.steady[k], 1}, creep).front());
      if (written(law_.after_stop, k) && law_.static_limit.empty())
        refuse("after_stop", "is of use beside a static_limit only: else nothing ever stops; leave it out");
      read.after_stop.push_back(written(law_.after_stop, k) ? node("after_stop." + state.name, law_.after_stop[k], unit,
                                                                   {.load = false, .states = true})
                                                            : own);
    }
    if (!law_.slip_rate.empty()) {
      if (states == 0) refuse("slip_rate", "is of use to laws with states only; leave it out");
      if (!law_.static_limit.empty())
        refuse("slip_rate", "does not go with a static_limit, which makes friction at rest any value; leave one out");
      read.slip_rate = node("slip_rate", law_.slip_rate, Words::unit_of("m/s"), {.states = true});
    }
    if (!law_.static_limit.empty()) {
      read.static_limit = node("static_limit", law_.static_limit, {}, {.states = true});
    }
    if (!law_.kink.empty()) {
      for (const auto& state : law_.states)
        if (state.scale == Scale::log)
          refuse("kink",
                 fmt::format("does not go with a state in logarithms; give '{}' scale = \"linear\"", state.name));
      read.kink = node("kink", law_.kink, {}, {.load = false, .states = true});
    }
    for (const auto& [name, text] : law_.define) words_.find(name, 0);  // wrong ones are refused, used or not
    return read;
  }

 private:
  std::vector<int> inputs() const {
    std::vector<int> all;
    for (int k = 0; k < Input::first_state + int(law_.states.size()); ++k) all.push_back(graph_.input(k));
    return all;
  }
  /// Puts steady states into the formulas that use them. States without a formula, and one of each circle, are left as
  /// unknowns of equations: rate = 0, or state − formula = 0.
  void find_steady_states(Expressions& read) {
    const std::size_t n = law_.states.size();
    enum class Known : char { not_yet, by_formula, by_solving };
    std::vector<Known> known(n, Known::not_yet);
    const auto first_left = [&] { return std::size_t(std::ranges::find(known, Known::not_yet) - known.begin()); };
    auto replaced = inputs();
    const auto put_in = [&](int node) { return graph_.substitute({&node, 1}, replaced).front(); };
    for (std::size_t k = 0; k < n; ++k)
      if (read.steady[k] < 0) known[k] = Known::by_solving;
    while (first_left() < n) {
      bool found = false;
      for (std::size_t k = 0; k < n; ++k) {
        if (known[k] != Known::not_yet) continue;
        bool complete = true;
        for (std::size_t j = 0; j < n; ++j)
          complete = complete &&
                     (known[j] != Known::not_yet || !graph_.uses_input(read.steady[k], Input::first_state + int(j)));
        if (!complete) continue;
        read.steady[k] = put_in(read.steady[k]);
        replaced[std::size_t(Input::first_state) + k] = read.steady[k];
        known[k] = Known::by_formula, found = true;
      }
      if (!found) known[first_left()] = Known::by_solving;
    }
    std::vector<std::string> names;
    for (std::size_t k = 0; k < n; ++k) {
      if (known[k] != Known::by_solving) continue;
      names.push_back("'" + law_.states[k].name + "'");
      read.solved.push_back(int(k));
      const int own = graph_.input(Input::first_state + int(k));
      read.residual.push_back(
          put_in(read.steady[k] < 0 ? read.rate[k] : graph_.make(Operation::subtract, own, read.steady[k])));
    }
    if (read.solved.empty()) return;
    if (read.solved.size() > most_solved)
      refuse("steady", fmt::format("the steady states of {} depend on each other: {} at most are solved for; give "
                                   "formulas of the others, in which these may stand",
                                   fmt::join(names, ", "), most_solved));
    for (int steps = 0; steps < 2; ++steps) newton_step(read, replaced);
    for (std::size_t k = 0; k < n; ++k)
      if (known[k] == Known::by_formula) read.steady[k] = put_in(read.steady[k]);
    for (const int k : read.solved) read.steady[std::size_t(k)] = replaced[std::size_t(Input::first_state + k)];
  }
  /// The solved states in `at`, and the others by them, after one more step of Newton's method.
  void newton_step(const Expressions& read, std::vector<int>& at) {
    const std::size_t n = read.solved.size();
    auto root = inputs();
    for (const int k : read.solved) root[std::size_t(Input::first_state + k)] = at[std::size_t(Input::first_state + k)];
    const auto symbol = [&](int node) { return Symbol(graph_, graph_.substitute({&node, 1}, root).front()); };
    std::vector<Symbol> R, J;
    for (const int residual : read.residual) {
      R.push_back(symbol(residual));
      for (const int k : read.solved)
        J.push_back(symbol(graph_.differentiate({&residual, 1}, Input::first_state + k).front()));
    }
    std::vector<Symbol> step(n);
    if (n == 1) {
      step[0] = R[0] / J[0];
    } else {
      const Symbol determinant = J[0] * J[3] - J[1] * J[2];
      step[0] = (R[0] * J[3] - J[1] * R[1]) / determinant;
      step[1] = (J[0] * R[1] - R[0] * J[2]) / determinant;
    }
    for (std::size_t i = 0; i < n; ++i) {
      auto& state = at[std::size_t(Input::first_state + read.solved[i])];
      state = (Symbol(graph_, state) - step[i]).in(graph_);
    }
  }

  /// What an expression may depend on beside the parameters.
  struct Knows {
    bool load = true, slip_rate = false, states = false;
  };
  int node(const std::string& path, const std::string& text, const Dimension& unit, Knows knows) {
    const auto value = parse_expression(graph_, words_, "law.formula." + path, text);
    if (value.dimension != unit)
      refuse(path, fmt::format("must be {}, but is {}", in_words(unit), in_words(value.dimension)));
    if (!knows.slip_rate && graph_.uses_input(value.node, Input::slip_rate))
      refuse(path, "must not depend on the slip rate v, directly or through a definition");
    if (path != "slip_rate" && graph_.uses_input(value.node, Input::friction))
      refuse(path, "uses mu, which is known in slip_rate only");
    if (!knows.load && graph_.uses_input(value.node, Input::normal_load))
      refuse(path, "must not depend on the normal load N, directly or through a definition");
    for (std::size_t k = 0; k < law_.states.size() && !knows.states; ++k)
      if (graph_.uses_input(value.node, Input::first_state + int(k)))
        refuse(path,
               fmt::format("must not depend on the state '{}', directly or through a definition", law_.states[k].name));
    return value.node;
  }
  static std::string in_words(const Dimension& dimension) {
    return dimension == Dimension{} ? "dimensionless" : "in " + coherent_unit(dimension);
  }

  Graph& graph_;
  const FormulaDescription& law_;
  Words words_;
};

/// The law in symbols: what detail::Rows ask of it, recorded.
struct Traced {
  static constexpr int capacity = most_states;
  using Number = Symbol;
  static Symbol from_log(const Symbol& logarithm) { return exp(logarithm); }
  Graph& graph;
  const Expressions& expressions;
  const std::vector<Quantity>& quantities;
  int states;
  bool set_valued;

  bool logarithmic(int k) const { return quantities[std::size_t(k)].scale == Scale::log; }
  Symbol friction(const Sliding<Symbol>& at, const Symbol* state) const {
    return answer({&expressions.friction, 1}, at, 0.0, state).front();
  }
  void rate(const Sliding<Symbol>& at, const Symbol* state, Symbol* rate) const {
    std::ranges::copy(answer(expressions.rate, at, 0.0, state), rate);
  }
  void steady(const Sliding<Symbol>& at, Symbol* state) const {
    std::vector<Symbol> root;
    for (int k = 0; k < states; ++k) root.emplace_back(graph, graph.input(Input::first_state + k));
    std::ranges::copy(answer(expressions.steady, at, 0.0, root.data()), state);
  }
  Symbol slip_rate(const Symbol& mu, const Symbol& N, const Symbol* state) const {
    return answer({&expressions.slip_rate, 1}, {0.0, N}, mu, state).front();
  }

 private:
  std::vector<Symbol> answer(std::span<const int> nodes, const Sliding<Symbol>& at, const Symbol& mu,
                             const Symbol* state) const {
    std::vector<int> inputs(std::size_t(Input::first_state + states), -1);
    inputs[Input::slip_rate] = at.slip_rate.in(graph);
    inputs[Input::normal_load] = at.normal_load.in(graph);
    inputs[Input::friction] = mu.in(graph);
    for (int k = 0; k < states && state; ++k) inputs[std::size_t(Input::first_state + k)] = state[k].in(graph);
    std::vector<Symbol> symbols;
    for (const int node : graph.substitute(nodes, inputs)) symbols.emplace_back(graph, node);
    return symbols;
  }
};

// ---------------------------------------------------------------- tapes

/// Tapes of one kind of contact. Outputs of `evaluate`: g, F; of `linearise`: g, F, then by each of (z, u, N) the
/// derivatives of g and F; of `slip`: v, g, then by each of z those of v and g.
struct ContactTapes {
  Tape evaluate, linearise, slip;
};

/// A law compiled: shared by the law at all its parameter values.
struct Program {
  FormulaDescription law;
  Card card;
  std::vector<Quantity> parameters;
  std::vector<Value> defaults;
  int states;
  bool has_slip_rate, set_valued;
  std::vector<int> solved;  ///< states whose steady value is the root of `residual`
  Tape residual;            ///< of (v, N, solved states)
  Tape friction, rate, steady, slip_rate, static_limit, kink, rest, after_stop, size;  ///< of (v, N, mu, states)
  Tape friction_slopes, slip_rate_slope;                                               ///< ∂μ/∂ψ, ∂v/∂μ
  Tape steady_coefficient, steady_slope;  ///< μ_ss(v), odd; μ_ss and dμ_ss/dv on the side of v > 0
  ContactTapes of_friction, of_states, of_equilibrium;
  PoolTape pool;

  explicit Program(const FormulaDescription&);
  const ContactTapes& tapes(const detail::Rows& rows) const {
    return rows.with_friction ? of_friction : rows.equilibrium ? of_equilibrium : of_states;
  }

 private:
  ContactTapes contact_tapes(const Traced&, const detail::Rows&, ConstantPool&);
};

Program::Program(const FormulaDescription& description)
    : law(description),
      states(int(law.states.size())),
      has_slip_rate(!law.slip_rate.empty()),
      set_valued(!law.static_limit.empty()) {
  card = {.name = "formula",
          .title = law.title,
          .formula = law.friction,
          .source = "the scene",
          .limits = "what its author says"};
  for (const auto& parameter : law.parameters) {
    parameters.push_back(parameter.quantity);
    defaults.emplace_back(parameter.value);
  }
  Graph graph;
  const Expressions nodes = Reader(graph, law)();
  const Traced traced{graph, nodes, law.states, states, set_valued};
  ConstantPool constants;
  const auto tape = [&](std::span<const int> outputs) { return compile(graph, outputs, constants); };
  const auto one = [&](int node) { return tape({&node, 1}); };

  friction = one(nodes.friction);
  rate = tape(nodes.rate);
  steady = tape(nodes.steady);
  solved = nodes.solved;
  residual = tape(nodes.residual);
  rest = tape(nodes.rest);
  after_stop = tape(nodes.after_stop);
  size = tape(nodes.size);
  std::vector<int> slopes;
  for (int k = 0; k < states; ++k)
    slopes.push_back(graph.differentiate({&nodes.friction, 1}, Input::first_state + k).front());
  friction_slopes = tape(slopes);
  if (set_valued) static_limit = one(nodes.static_limit);
  if (!law.kink.empty()) kink = one(nodes.kink);

  const Symbol v(graph, graph.input(Input::slip_rate)), N(graph, graph.input(Input::normal_load));
  steady_coefficient = one(detail::steady_coefficient(traced, Sliding<Symbol>{v, N}).in(graph));
  const int side = detail::steady_of(traced, Sliding<Symbol>{v, N}).in(graph);
  steady_slope = tape(std::array{side, graph.differentiate({&side, 1}, Input::slip_rate).front()});

  of_states = contact_tapes(traced, detail::Rows({.lambda = 1, .unknowns = Unknowns::states}), constants);
  of_equilibrium = contact_tapes(traced, detail::Rows({.lambda = 0, .unknowns = Unknowns::states}), constants);
  if (has_slip_rate) {
    slip_rate = one(nodes.slip_rate);
    slip_rate_slope = one(graph.differentiate({&nodes.slip_rate, 1}, Input::friction).front());
    of_friction = contact_tapes(traced, detail::Rows({.unknowns = Unknowns::friction}), constants);
  }
  pool = compile_pool(graph, constants);
}

ContactTapes Program::contact_tapes(const Traced& traced, const detail::Rows& rows, ConstantPool& constants) {
  Graph& graph = traced.graph;
  const auto input = [&](int number) { return Symbol(graph, graph.input(number)); };
  const int n = rows.unknowns(states), first = rows.with_friction ? Input::friction : Input::first_state;
  Symbol z[most_states + 1], g[most_states + 1], F;
  for (int i = 0; i < n; ++i) z[i] = input(first + i);
  rows(traced,
       ContactInput<Symbol>{input(Input::slip_rate), input(Input::normal_load), input(Input::load_rate),
                            input(Input::direction)},
       input(Input::compliance), z, g, F);

  const auto with_slopes = [&](std::vector<int> outputs, std::span<const int> directions) {
    const auto values = outputs;
    for (const int by : directions) {
      const auto slopes = graph.differentiate(values, by);
      outputs.insert(outputs.end(), slopes.begin(), slopes.end());
    }
    return compile(graph, outputs, constants);
  };
  std::vector<int> values, directions;
  for (int i = 0; i < n; ++i) values.push_back(g[i].in(graph)), directions.push_back(first + i);
  values.push_back(F.in(graph));
  ContactTapes tapes;
  tapes.evaluate = compile(graph, values, constants);
  if (rows.with_friction) {
    Symbol v;
    rows.slip(traced, input(Input::normal_load), z, v, g + 1);
    std::vector<int> slip{v.in(graph)};
    for (int i = 1; i < n; ++i) slip.push_back(g[i].in(graph));
    tapes.slip = with_slopes(slip, directions);
  }
  directions.push_back(Input::slip_rate);
  directions.push_back(Input::normal_load);
  tapes.linearise = with_slopes(values, directions);
  return tapes;
}

struct Answering;
/// Steady values of the states that equations give. \throws ExpressionError where there are several, or none
void solve_steady(const Answering&, Sliding<double>, double* state);

/// The law at given values, one system at a time, as detail::start_steady and others ask it.
struct Answering {
  static constexpr int capacity = most_states;
  using Number = double;
  static double from_log(double logarithm) { return std::exp(logarithm); }
  const Program& program;
  const std::vector<double>& constants;  ///< of the pool
  int states = program.states;
  bool set_valued = program.set_valued;

  bool logarithmic(int k) const { return program.law.states[std::size_t(k)].scale == Scale::log; }
  /// Runs a tape; writes its outputs.
  void answer(const Tape& tape, double v, double N, double mu, const double* state, double* outputs) const {
    const double* inputs[most_inputs] = {};
    inputs[Input::slip_rate] = &v, inputs[Input::normal_load] = &N, inputs[Input::friction] = &mu;
    for (int k = 0; k < states && state; ++k) inputs[Input::first_state + k] = state + k;
    const TapeRun<double> run(tape, constants.data(), inputs);
    for (std::size_t k = 0; k < tape.outputs.size(); ++k) outputs[k] = run[k];
  }
  double friction(Sliding<double> at, const double* state) const {
    double mu;
    answer(program.friction, at.slip_rate, at.normal_load, 0, state, &mu);
    return mu;
  }
  void rate(Sliding<double> at, const double* state, double* rate) const {
    answer(program.rate, at.slip_rate, at.normal_load, 0, state, rate);
  }
  void steady(Sliding<double> at, double* state) const {
    double root[most_states] = {};
    solve_steady(*this, at, root);
    answer(program.steady, at.slip_rate, at.normal_load, 0, root, state);
  }
  void sizes(const double* steady, double* sizes) const {
    answer(program.size, 0, 0, 0, steady, sizes);
    for (int k = 0; k < states; ++k) sizes[k] = std::abs(sizes[k]);
  }
  double slip_rate(double mu, double N, const double* state) const {
    double v;
    answer(program.slip_rate, 0, N, mu, state, &v);
    return v;
  }
  double slip_rate_slope(double mu, double N, const double* state) const {
    double slope;
    answer(program.slip_rate_slope, 0, N, mu, state, &slope);
    return slope;
  }
  void friction_slopes(Sliding<double> at, const double* state, double* slopes) const {
    answer(program.friction_slopes, at.slip_rate, at.normal_load, 0, state, slopes);
  }
};

/// Where the residuals of the solved states vanish together: changes of sign over the range of one of them, along which
/// the other is the root of its own residual.
class SteadyRoot {
 public:
  SteadyRoot(const Answering& law, Sliding<double> at, double* state) : law_(law), at_(at), state_(state) {}

  void operator()() {
    const auto& solved = law_.program.solved;
    std::vector<int> order(solved.size());
    std::iota(order.begin(), order.end(), 0);
    do {
      order_ = order, ambiguous_ = false;
      const auto found = roots(0);
      if (ambiguous_) continue;
      if (found.size() != 1) refuse_roots(found);
      residual(0, found.front());
      return;
    } while (std::ranges::next_permutation(order).found);
    refuse("steady",
           fmt::format("'{}' and '{}' depend on each other in steady sliding in a way that leaves several values "
                       "open; give a formula of one of them, in which the other may stand",
                       name(0), name(1)));
  }

 private:
  const Quantity& quantity(std::size_t level) const {
    return law_.program.law.states[std::size_t(law_.program.solved[std::size_t(order_[level])])];
  }
  const std::string& name(std::size_t level) const { return quantity(level).name; }

  /// With the states of the levels behind at their roots; NaN where they have none.
  double residual(std::size_t level, double x) {
    const auto& solved = law_.program.solved;
    state_[solved[std::size_t(order_[level])]] = x;
    if (level + 1 < solved.size()) {
      const auto inner = roots(level + 1);
      ambiguous_ = ambiguous_ || inner.size() > 1;
      if (inner.size() != 1) return NAN;
      residual(level + 1, inner.front());
    }
    double values[most_solved];
    law_.answer(law_.program.residual, at_.slip_rate, at_.normal_load, 0, state_, values);
    constexpr double largest = 1e300;
    return std::clamp(values[order_[level]], -largest, largest);
  }

  std::vector<double> roots(std::size_t level) {
    const auto f = [&](double x) { return residual(level, x); };
    std::vector<double> found;
    const auto add = [&](double x) {
      constexpr double same = 1e-9;
      if (found.empty() || std::abs(x - found.back()) > same * std::abs(x)) found.push_back(x);
    };
    double before = NAN, at_before = NAN;
    for (const double x : places(quantity(level))) {
      const double here = f(x);
      if (ambiguous_) return {};
      if (here == 0) {
        add(x);
      } else if (at_before * ((here > 0) - (here < 0)) < 0) {  // of residuals that exist on both sides
        std::uintmax_t most = 200;
        const auto [low, high] = boost::math::tools::toms748_solve(f, before, x, at_before, here,
                                                                   boost::math::tools::eps_tolerance<double>(50), most);
        // At a pole the residual grows towards the change of sign.
        const double middle = low + 0.5 * (high - low);
        if (std::abs(f(middle)) < std::min(std::abs(at_before), std::abs(here))) add(middle);
      }
      before = x, at_before = here;
    }
    return found;
  }

  /// Over the range of a state, from small sizes to large ones of both signs.
  static std::vector<double> places(const Quantity& state) {
    constexpr double least = 1e-30, most = 1e30;
    constexpr int per_decade = 2, evenly = 16;
    const double low = std::max(state.scale == Scale::log ? least : -most, state.range.low),
                 high = std::min(most, state.range.high);
    // An end may be a root itself, or a round number: a little beside them no change of sign is hidden.
    constexpr double beside = 1e-6, not_round = 1.0472;
    std::vector<double> list{low, low + beside * std::abs(low), high - beside * std::abs(high), high};
    for (double size = not_round * least; size <= most; size *= std::pow(10, 1.0 / per_decade))
      list.insert(list.end(), {size, -size});
    if (state.scale == Scale::linear) {
      list.push_back(0);
      for (int i = 1; i < evenly; ++i) list.push_back(low + (high - low) * i / evenly);
    }
    std::erase_if(list, [&](double x) { return !(x >= low && x <= high); });
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
    return list;
  }

  [[noreturn]] void refuse_roots(const std::vector<double>& found) const {
    const auto where = fmt::format("at v = {} m/s, N = {} N", at_.slip_rate, at_.normal_load);
    const auto& state = quantity(0);
    const auto path = "steady." + state.name;
    if (found.empty())
      refuse(path, fmt::format("has no formula of v and N, and no value between {} and {} is steady {}; give one",
                               state.range.low, state.range.high, where));
    constexpr std::size_t shown = 3;
    std::vector<std::string> values;
    for (const double x : std::span(found).first(std::min(found.size(), shown)))
      values.push_back(fmt::format("{:.6g}", x));
    refuse(path, fmt::format(
                     "has no formula of v and N, and {} values are steady {}: {}{}; give one, or a minimum and maximum "
                     "of the state that leave one",
                     found.size(), where, fmt::join(values, ", "), found.size() > shown ? ", …" : ""));
  }

  const Answering& law_;
  Sliding<double> at_;
  double* state_;
  std::vector<int> order_;
  bool ambiguous_ = false;
};

void solve_steady(const Answering& law, Sliding<double> at, double* state) {
  if (!law.program.solved.empty()) SteadyRoot(law, at, state)();
}

/// The same for scalars of several numbers, as inputs of tapes that hold at the root.
template <class Real>
struct SolvedStates {
  Real root[most_states];
  SolvedStates(const Program& program, const Real& v, const Real& N, const auto& answering, const Real** inputs) {
    if (program.solved.empty()) return;
    constexpr int count = std::is_same_v<Real, Lanes> ? lane_count : 1;
    const auto number = [](const Real& x, int lane) {
      if constexpr (std::is_same_v<Real, Lanes>)
        return x[lane];
      else if constexpr (std::is_same_v<Real, Tower>)
        return x.value.value.value;
      else
        return x;
    };
    for (int lane = 0; lane < count; ++lane) {
      double state[most_states];
      double slip_rate = number(v, lane);
      if (program.set_valued) slip_rate = std::abs(slip_rate);
      solve_steady(answering(lane), {slip_rate, number(N, lane)}, state);
      for (const int k : program.solved) {
        if (lane == 0) root[k] = Real(state[k]);
        if constexpr (std::is_same_v<Real, Lanes>) detail::set_lane(root[k], lane, state[k]);
      }
    }
    for (const int k : program.solved) inputs[Input::first_state + k] = root + k;
  }
};

std::vector<double> numbers(std::span<const Value> values) {
  std::vector<double> list;
  for (const auto& value : values) list.push_back(std::get<double>(value));
  return list;
}

// ---------------------------------------------------------------- contacts

/// Where the inputs of a contact's tapes lie.
template <class Real>
struct ContactInputs {
  const Real* at[most_inputs] = {};
  ContactInputs(const ContactInput<Real>& in, const Real& spring, const Real* z, int unknowns, bool with_friction) {
    at[Input::slip_rate] = &in.slip_rate, at[Input::normal_load] = &in.normal_load;
    at[Input::load_rate] = &in.load_rate, at[Input::direction] = &in.direction, at[Input::compliance] = &spring;
    for (int i = 0; i < unknowns; ++i) at[(with_friction ? Input::friction : Input::first_state) + i] = z + i;
  }
};

template <class Real>
class FormulaContact final : public Contact<Real> {
  static constexpr std::size_t lanes = std::is_same_v<Real, Lanes> ? lane_count : 1;

 public:
  FormulaContact(std::shared_ptr<const Program> program, const std::vector<double>& constants,
                 const ContactSetup& setup)
      : program_(std::move(program)), setup_(setup), tapes_(program_->tapes(setup_.rows())) {
    constants_.assign(constants.begin(), constants.end());
    lane_constants_.fill(constants);
  }

  int unknowns() const override { return setup_.rows().unknowns(program_->states); }

  void evaluate(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const override {
    const int n = unknowns();
    auto from = inputs(in, z);
    const auto solved = at_equilibrium(in, from);
    const TapeRun<Real> run(tapes_.evaluate, constants_.data(), from.at);
    for (int i = 0; i < n; ++i) g[i] = run[std::size_t(i)];
    F = run[std::size_t(n)];
  }

  void linearise(const ContactInput<Real>& in, const Real* z, Real* g, Real& F, Slopes<Real>& slopes) const override {
    const int n = unknowns();
    auto from = inputs(in, z);
    const auto solved = at_equilibrium(in, from);
    const TapeRun<Real> run(tapes_.linearise, constants_.data(), from.at);
    std::size_t k = 0;
    for (int i = 0; i < n; ++i) g[i] = run[k++];
    F = run[k++];
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) slopes.g_z[i * n + j] = run[k++];
      slopes.F_z[j] = run[k++];
    }
    for (int i = 0; i < n; ++i) slopes.g_u[i] = run[k++];
    slopes.F_u = run[k++];
    for (int i = 0; i < n; ++i) slopes.g_N[i] = run[k++];
    slopes.F_N = run[k++];
  }

  void steady_friction(const Real& u, const Real& N, Real& mu) const override {
    const Real* at[most_inputs] = {&u, &N};
    [[maybe_unused]] const SolvedStates<Real> solved(
        *program_, u, N, [&](int lane) { return answering(lane); }, at);
    mu = TapeRun<Real>(program_->steady_coefficient, constants_.data(), at)[0];
  }

  void mass(const Real& N, Real* m) const override { setup_.mass(N, program_->states, m); }

  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    setup_.load(lane, setup);
    auto& constants = lane_constants_[std::size_t(lane)];
    constants = program_->pool(numbers(parameters));
    for (std::size_t k = 0; k < constants.size(); ++k) detail::set_lane(constants_[k], lane, constants[k]);
  }

  void steady(int lane, double u, double N, double* z, double* weight) const override {
    detail::start_steady(setup_.rows(), answering(lane), u, N, z, weight);
  }
  void friction_slopes(int lane, double u, double N, double* slopes) const override {
    detail::steady_friction_slopes(answering(lane), u, N, slopes);
  }

 private:
  ContactInputs<Real> inputs(const ContactInput<Real>& in, const Real* z) const {
    return {in, setup_.compliance(), z, unknowns(), setup_.rows().with_friction};
  }
  Answering answering(int lane) const { return {*program_, lane_constants_[std::size_t(lane)]}; }
  /// States that are no unknowns are those of steady sliding.
  std::optional<SolvedStates<Real>> at_equilibrium(const ContactInput<Real>& in, ContactInputs<Real>& from) const {
    if (!setup_.rows().equilibrium || program_->solved.empty()) return std::nullopt;
    return std::optional<SolvedStates<Real>>(
        std::in_place, *program_, in.slip_rate, in.normal_load, [&](int lane) { return answering(lane); }, from.at);
  }

  std::shared_ptr<const Program> program_;
  Surroundings<Real> setup_;
  const ContactTapes& tapes_;
  std::vector<Real> constants_;
  std::array<std::vector<double>, lanes> lane_constants_;  ///< for starts, one lane at a time
};

class FormulaFlow final : public ContactFlow {
 public:
  FormulaFlow(std::shared_ptr<const Program> program, const std::vector<double>& constants)
      : program_(std::move(program)),
        tape_(program_->tapes(detail::Rows(ContactSetup{})).slip),
        constants_(constants.begin(), constants.end()) {}
  int unknowns() const override { return program_->states + 1; }
  void slip(const Pack& N, const Pack* z, Pack& v, Pack* g, Pack* v_z, Pack* g_z) const override {
    const int n = unknowns();
    const Pack* at[most_inputs] = {nullptr, &N};
    for (int i = 0; i < n; ++i) at[Input::friction + i] = z + i;
    const TapeRun<Pack> run(tape_, constants_.data(), at);
    std::size_t k = 0;
    v = run[k++];
    for (int i = 0; i < n - 1; ++i) g[i] = run[k++];
    for (int j = 0; j < n; ++j) {
      v_z[j] = run[k++];
      for (int i = 0; i < n - 1; ++i) g_z[i * n + j] = run[k++];
    }
  }

 private:
  std::shared_ptr<const Program> program_;
  const Tape& tape_;
  std::vector<Pack> constants_;
};

class FormulaTower final : public ContactValues<Tower> {
 public:
  FormulaTower(std::shared_ptr<const Program> program, const std::vector<double>& parameters, const ContactSetup& setup,
               const ContactChange& change)
      : program_(std::move(program)), setup_(setup, change.setup), base_(program_->pool(parameters)) {
    std::vector<Tower> varied(parameters.begin(), parameters.end());
    for (std::size_t k = 0; k < change.parameters.size(); ++k)
      varied[k] = across(parameters[k], 0, change.parameters[k]);
    constants_ = program_->pool(varied);
  }
  int unknowns() const override { return setup_.rows().unknowns(program_->states); }
  void evaluate(const ContactInput<Tower>& in, const Tower* z, Tower* g, Tower& F) const override {
    const int n = unknowns();
    const auto& rows = setup_.rows();
    ContactInputs<Tower> from(in, setup_.compliance(), z, n, rows.with_friction);
    std::optional<SolvedStates<Tower>> solved;
    if (rows.equilibrium)
      solved.emplace(
          *program_, in.slip_rate, in.normal_load,
          [&](int) {
            return Answering{*program_, base_};
          },
          from.at);
    const TapeRun<Tower> run(program_->tapes(rows).evaluate, constants_.data(), from.at);
    for (int i = 0; i < n; ++i) g[i] = run[std::size_t(i)];
    F = run[std::size_t(n)];
  }
  void mass(const Tower& N, Tower* m) const override { setup_.mass(N, program_->states, m); }

 private:
  std::shared_ptr<const Program> program_;
  Surroundings<Tower> setup_;
  std::vector<double> base_;  ///< constants without their slopes
  std::vector<Tower> constants_;
};

// ---------------------------------------------------------------- the law

class FormulaLaw final : public FrictionLaw {
 public:
  FormulaLaw(std::shared_ptr<const Program> program, std::vector<Value> values)
      : program_(std::move(program)), values_(std::move(values)), constants_(program_->pool(numbers(values_))) {}

  const Card& card() const override { return program_->card; }
  const std::vector<Quantity>& parameters() const override { return program_->parameters; }
  const std::vector<Quantity>& states() const override { return program_->law.states; }
  const std::vector<Preset>& presets() const override {
    static const std::vector<Preset> none;
    return none;
  }
  const std::vector<Value>& values() const override { return values_; }
  std::shared_ptr<const FrictionLaw> with(std::vector<Value> values) const override {
    check_parameters(card(), parameters(), values);
    return std::make_shared<FormulaLaw>(program_, std::move(values));
  }

  bool has_slip_rate() const override { return program_->has_slip_rate; }
  bool set_valued() const override { return program_->set_valued; }

  double friction(Sliding<double> at, std::span<const double> state) const override {
    require_states(state);
    const double direction = set_valued() ? sign(at.slip_rate) : 1.0;
    return finite_answer(card(), "friction", at, direction * answering().friction(asked(at), state.data()));
  }
  std::vector<double> rate(Sliding<double> at, std::span<const double> state) const override {
    require_states(state);
    return of_states("rate", program_->rate, asked(at), state.data());
  }
  std::vector<double> steady(Sliding<double> at) const override {
    std::vector<double> state(states().size());
    answering().steady(asked(at), state.data());
    for (const double x : state) finite_answer(card(), "steady state", at, x);
    return state;
  }
  double slip_rate(double mu, double normal_load, std::span<const double> state) const override {
    if (!has_slip_rate()) throw InputError(fmt::format("law '{}' has no explicit slip rate", card().name));
    require_states(state);
    return answering().slip_rate(mu, normal_load, state.data());
  }
  std::vector<double> rest(double normal_load) const override {
    double root[most_states] = {};
    const bool given = std::ranges::count(program_->law.rest, "") == 0 && !program_->law.rest.empty();
    if (!given) solve_steady(answering(), {slowest_creep, normal_load}, root);
    return of_states("state at rest", program_->rest, {0, normal_load}, root);
  }
  std::vector<double> after_stop(std::span<const double> state) const override {
    require_states(state);
    return of_states("state after a stop", program_->after_stop, {}, state.data());
  }
  double kink(std::span<const double> state) const override {
    if (program_->law.kink.empty()) return NAN;
    double value;
    answering().answer(program_->kink, 0, 0, 0, state.data(), &value);
    return value;
  }
  double static_limit(double normal_load, std::span<const double> state) const override {
    if (!set_valued())
      throw InputError(fmt::format("law '{}' has no static limit: its force at rest is unique", card().name));
    require_states(state);
    double limit;
    answering().answer(program_->static_limit, 0, normal_load, 0, state.data(), &limit);
    return finite_answer(card(), "static limit", {0, normal_load}, limit);
  }
  Steady steady_friction(Sliding<double> at) const override {
    const double direction = set_valued() && at.slip_rate < 0 ? -1 : 1;
    const Sliding<double> along{direction * at.slip_rate, at.normal_load};
    double answers[2], root[most_states] = {};
    solve_steady(answering(), along, root);
    answering().answer(program_->steady_slope, along.slip_rate, along.normal_load, 0, root, answers);
    return {finite_answer(card(), "steady friction", at, direction * answers[0]), answers[1]};
  }
  std::unique_ptr<ContactFlow> flow() const override {
    if (!has_slip_rate()) refuse_flow(card());
    return std::make_unique<FormulaFlow>(program_, constants_);
  }

 private:
  std::unique_ptr<Contact<double>> bare_contact(const ContactSetup& setup) const override {
    return std::make_unique<FormulaContact<double>>(program_, constants_, accepted(setup));
  }
  std::unique_ptr<Contact<Lanes>> bare_lanes(const ContactSetup& setup) const override {
    return std::make_unique<FormulaContact<Lanes>>(program_, constants_, accepted(setup));
  }
  std::unique_ptr<ContactValues<Tower>> bare_tower(const ContactSetup& setup,
                                                   const ContactChange& change) const override {
    return std::make_unique<FormulaTower>(program_, numbers(values_), accepted(setup), change);
  }

  const ContactSetup& accepted(const ContactSetup& setup) const {
    if (setup.unknowns == Unknowns::friction && !has_slip_rate())
      throw InputError(
          fmt::format("law '{}' has no explicit slip rate: its contact cannot carry μ as unknown", card().name));
    return setup;
  }
  /// Set-valued laws are asked for slip along v.
  Sliding<double> asked(Sliding<double> at) const {
    if (set_valued()) at.slip_rate = std::abs(at.slip_rate);
    return at;
  }
  std::vector<double> of_states(const char* question, const Tape& tape, Sliding<double> at, const double* state) const {
    std::vector<double> answers(states().size());
    answering().answer(tape, at.slip_rate, at.normal_load, 0, state, answers.data());
    for (const double x : answers) finite_answer(card(), question, at, x);
    return answers;
  }
  void require_states(std::span<const double> values) const {
    if (values.size() != states().size())
      throw InputError(fmt::format("law '{}' has {} state(s), got {}", card().name, states().size(), values.size()));
  }
  Answering answering() const { return {*program_, constants_}; }

  std::shared_ptr<const Program> program_;
  std::vector<Value> values_;
  std::vector<double> constants_;
};

/// What a law is asked at one slip rate; an answer that is no number is refused by the expression's name.
class Interview {
  template <class Ask>
  auto asked(const char* what, Ask ask) const {
    try {
      return ask();
    } catch (const ExpressionError&) {
      throw;
    } catch (const InputError& error) {
      refuse(what, error.what());
    }
  }

 public:
  Interview(const FrictionLaw& law, double v) : law_(law), at_{v, 1}, state_(law.states().size()) {
    for (auto& x : state_) x = 1;
    state_ = asked("steady", [&] { return law_.steady(at_); });
  }

  void operator()() const {
    const double mu = friction(at_, state_);
    for (std::size_t k = 0; k < state_.size(); ++k) {
      const auto& quantity = law_.states()[k];
      if (!quantity.range.contains(state_[k]))
        refuse("steady." + quantity.name, fmt::format("is {} at {}, outside its range {} … {}", state_[k], where(),
                                                      quantity.range.low, quantity.range.high));
    }
    if (!state_.empty()) check_rate();
    if (law_.set_valued()) {
      const auto rest = asked("rest", [&] { return law_.rest(1); });
      for (const auto& state : {rest, asked("after_stop", [&] { return law_.after_stop(rest); })})
        if (const double limit = asked("static_limit", [&] { return law_.static_limit(1, state); }); limit < 0)
          refuse("static_limit", fmt::format("is {}, but must not be negative", limit));
      return;
    }
    const Sliding<double> back{-at_.slip_rate, 1};
    const double opposite = friction(back, asked("steady", [&] { return law_.steady(back); }));
    if (!(std::abs(opposite + mu) <= 1e-9 * std::abs(mu)))
      refuse("friction", fmt::format("must change sign with v, but is {} at {} and {} at v = {} m/s; a law in ln(v) is "
                                     "written with asinh_exp (or give static_limit, and v ≥ 0 alone is asked)",
                                     mu, where(), opposite, back.slip_rate));
    if (law_.has_slip_rate()) check_slip_rate();
  }

 private:
  double friction(Sliding<double> at, std::span<const double> state) const {
    return asked("friction", [&] { return law_.friction(at, state); });
  }
  std::string where() const { return fmt::format("v = {} m/s, N = 1 N", at_.slip_rate); }

  /// In the steady state the rate is small beside the rate of a state that is off by a tenth.
  void check_rate() const {
    const auto rate = asked("rate", [&] { return law_.rate(at_, state_); });
    for (std::size_t k = 0; k < state_.size(); ++k) {
      auto moved = state_;
      moved[k] = state_[k] == 0 ? 0.1 : 0.9 * state_[k];
      const double beside = asked("rate", [&] { return law_.rate(at_, moved); })[k];
      if (!(std::abs(rate[k]) <= 1e-6 * std::abs(beside)))
        refuse("steady." + law_.states()[k].name,
               fmt::format("is not steady at {}: there the rate is {} {}/s", where(), rate[k], law_.states()[k].unit));
    }
  }

  /// From friction far from, near and at steady sliding back to the slip rate.
  void check_slip_rate() const {
    for (const double other : {1e-11, 1e-6, 1e-2}) {
      const auto state = asked("steady", [&] { return law_.steady({other, 1}); });
      const double mu = friction(at_, state), v = law_.slip_rate(mu, 1, state);
      if (!(std::abs(v - at_.slip_rate) <= 1e-6 * std::abs(at_.slip_rate)))
        refuse("slip_rate", fmt::format("does not invert friction: friction is {} at {} in the state of steady sliding "
                                        "at {} m/s, and slip_rate makes {} m/s of it",
                                        mu, where(), other, v));
    }
  }

  const FrictionLaw& law_;
  Sliding<double> at_;
  std::vector<double> state_;
};

}  // namespace

std::shared_ptr<const FrictionLaw> make_formula(const FormulaDescription& description) {
  const auto program = std::make_shared<const Program>(description);
  return std::make_shared<FormulaLaw>(program, program->defaults)->with(program->defaults);
}

void check_formula(const FrictionLaw& law) {
  for (double v = 1.7e-12; v < 2; v *= 10) Interview(law, v)();
}

}  // namespace rosin::laws
