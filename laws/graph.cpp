/// Building, simplifying and differentiating graphs of formulas.
#include "laws/graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "core/error.hpp"
#include "laws/operations.hpp"

namespace rosin::laws {

int operand_count(Operation operation) {
  switch (operation) {
    case Operation::constant:
    case Operation::parameter:
    case Operation::input:
      return 0;
    case Operation::negate:
    case Operation::exp:
    case Operation::log:
    case Operation::sqrt:
    case Operation::abs:
    case Operation::sign:
    case Operation::sinh:
    case Operation::cosh:
    case Operation::tanh:
    case Operation::asinh:
      return 1;
    case Operation::select_less:
      return 3;
    default:
      return 2;
  }
}

int Graph::intern(const Node& node) {
  const auto [at, added] =
      place_.try_emplace({node.operation, node.operand, std::bit_cast<std::uint64_t>(node.number)}, int(nodes_.size()));
  if (added) {
    if (size() >= capacity)
      throw InputError(fmt::format("the formula law needs more than {} operations; write it more briefly", capacity));
    nodes_.push_back(node);
  }
  return at->second;
}

int Graph::constant(double x) { return intern({Operation::constant, {-1, -1, -1}, x, false}); }

int Graph::find(Operation operation, int a, int b) const {
  const auto at = place_.find({operation, {a, b, -1}, 0});
  return at == place_.end() ? -1 : at->second;
}

int Graph::make(Operation operation, int a, int b, int c) {
  const int count = operand_count(operation);
  if (count < 2) b = -1;
  if (count < 3) c = -1;
  const std::array<int, 3> operand{a, b, c};
  const auto is_constant = [&](int k) { return k < 0 || (*this)[k].operation == Operation::constant; };
  if (std::ranges::all_of(operand, is_constant)) {
    const auto number = [&](int k) { return k < 0 ? 0.0 : (*this)[k].number; };
    double value = 0;
    with_operation(operation, [&](const auto& f) { value = f(number(a), number(b), number(c)); });
    return constant(value);
  }
  switch (operation) {
    case Operation::log:  // of a state that is carried as its logarithm
      if ((*this)[a].operation == Operation::exp) return (*this)[a].operand[0];
      break;
    case Operation::add:
      if (is_number(a, 0)) return b;
      if (is_number(b, 0)) return a;
      break;
    case Operation::subtract:
      if (is_number(a, 0)) return make(Operation::negate, b);
      if (is_number(b, 0)) return a;
      break;
    case Operation::multiply:
      for (const auto& [x, y] : {std::pair{a, b}, std::pair{b, a}}) {
        if (is_number(x, 0) || is_number(y, 1)) return x;
        if (is_number(x, -1)) return make(Operation::negate, y);
      }
      break;
    case Operation::divide:
      if (is_number(a, 0) || is_number(b, 1)) return a;
      // Lanes divide slowly; what does not vary is inverted once.
      if ((*this)[a].varies && !(*this)[b].varies)
        return make(Operation::multiply, a, make(Operation::divide, constant(1), b));
      break;
    case Operation::negate:
      if ((*this)[a].operation == Operation::negate) return (*this)[a].operand[0];
      break;
    case Operation::select_less:
      if (is_number(c, 0)) return c;
      break;
    default:
      break;
  }
  Node node{operation, operand, 0, false};
  if ((operation == Operation::add || operation == Operation::multiply) && a > b)
    std::swap(node.operand[0], node.operand[1]);
  for (const int k : operand) node.varies |= k >= 0 && (*this)[k].varies;
  return intern(node);
}

std::vector<bool> Graph::needed_for(std::span<const int> roots) const {
  std::vector<bool> needed(nodes_.size());
  for (const int root : roots) needed[std::size_t(root)] = true;
  for (int node = size() - 1; node >= 0; --node)
    if (needed[std::size_t(node)])
      for (int k = 0; k < operand_count((*this)[node].operation); ++k)
        needed[std::size_t((*this)[node].operand[std::size_t(k)])] = true;
  return needed;
}

bool Graph::uses_input(int node, int input) const {
  const auto needed = needed_for(std::span(&node, 1));
  for (int i = 0; i < size(); ++i)
    if (needed[std::size_t(i)] && (*this)[i].operation == Operation::input && (*this)[i].operand[0] == input)
      return true;
  return false;
}

std::vector<int> Graph::substitute(std::span<const int> nodes, std::span<const int> inputs) {
  const auto needed = needed_for(nodes);
  std::vector<int> replaced(needed.size(), -1);
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i]) continue;
    const Node node = nodes_[i];  // a copy: the list grows
    if (node.operation == Operation::input) {
      replaced[i] = inputs[std::size_t(node.operand[0])];
    } else if (!node.varies) {
      replaced[i] = int(i);
    } else {
      const auto operand = [&](std::size_t k) {
        return node.operand[k] < 0 ? -1 : replaced[std::size_t(node.operand[k])];
      };
      replaced[i] = make(node.operation, operand(0), operand(1), operand(2));
    }
  }
  std::vector<int> result;
  for (const int node : nodes) result.push_back(replaced[std::size_t(node)]);
  return result;
}

std::vector<int> Graph::differentiate(std::span<const int> nodes, int input) {
  const auto needed = needed_for(nodes);
  const int zero = constant(0), one = constant(1);
  std::vector<int> slope(needed.size(), zero);
  for (std::size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i] || !nodes_[i].varies) continue;
    if (nodes_[i].operation == Operation::input)
      slope[i] = nodes_[i].operand[0] == input ? one : zero;
    else
      slope[i] = derivative(int(i), slope);
  }
  std::vector<int> result;
  for (const int node : nodes) result.push_back(slope[std::size_t(node)]);
  return result;
}

int Graph::derivative(int node, const std::vector<int>& slope) {
  using enum Operation;
  const auto [a, b, c] = (*this)[node].operand;
  const int da = slope[std::size_t(a)], db = b < 0 ? -1 : slope[std::size_t(b)],
            dc = c < 0 ? -1 : slope[std::size_t(c)];
  const auto is_zero = [&](int k) { return k < 0 || is_number(k, 0); };
  const auto number = [&](double x) { return this->constant(x); };
  if (is_zero(da) && is_zero(db) && is_zero(dc)) return number(0);
  // ∂/∂a·da + ∂/∂b·db, asking only for what is not multiplied by zero.
  const auto chain = [&](auto by_a, auto by_b) {
    const int first = is_zero(da) ? number(0) : make(multiply, by_a(), da);
    return is_zero(db) ? first : make(add, first, make(multiply, by_b(), db));
  };
  const auto none = [&] { return number(0); };
  switch ((*this)[node].operation) {
    case add:
      return make(add, da, db);
    case subtract:
      return make(subtract, da, db);
    case multiply:
      return chain([&] { return b; }, [&] { return a; });
    case divide:
      return chain([&] { return make(divide, number(1), b); }, [&] { return make(negate, make(divide, node, b)); });
    case negate:
      return make(negate, da);
    case exp:
      return make(multiply, node, da);
    case log:
      return make(divide, da, a);
    case sqrt:
      return make(divide, make(multiply, number(0.5), da), node);
    case abs:
      return chain([&] { return make(sign, a); }, none);
    case sign:
      return number(0);
    case sinh:
      return chain([&] { return make(cosh, a); }, none);
    case cosh:
      return chain([&] { return make(sinh, a); }, none);
    case tanh:
      return chain(
          [&] {
            const int inverse = make(divide, number(1), make(cosh, a));
            return make(multiply, inverse, inverse);
          },
          none);
    case asinh:
      return chain([&] { return make(asinh_exp_by_x, a, number(0)); }, none);
    case minimum:
    case maximum: {
      const bool least = (*this)[node].operation == minimum;
      // As select(b < a, b, a) and select(a < b, b, a): b where the comparison holds.
      const int low = least ? b : a, high = least ? a : b;
      return make(add, da, make(select_less, low, high, make(subtract, db, da)));
    }
    case power:
      return chain([&] { return make(multiply, b, make(power, a, make(subtract, b, number(1)))); },
                   [&] { return make(multiply, node, make(log, make(maximum, a, number(1e-300)))); });
    case asinh_exp:
      return chain([&] { return make(asinh_exp_by_x, a, b); }, [&] { return make(asinh_exp_by_E, a, b); });
    case sinh_exp:
      return chain([&] { return make(cosh_exp, a, b); }, [&] { return make(negate, node); });
    case asinh_exp_by_x:
    case asinh_exp_by_E: {
      // f_x = e^E/√(1 + x² e^2E), f_E = x f_x: f_xx = −f_E f_x², f_xE = f_x (1 − f_E²), f_EE = f_E (1 − f_E²).
      const int f_x = make(asinh_exp_by_x, a, b), f_E = make(asinh_exp_by_E, a, b);
      const int rest = make(subtract, number(1), make(multiply, f_E, f_E)), mixed = make(multiply, f_x, rest);
      if ((*this)[node].operation == asinh_exp_by_E)
        return chain([&] { return mixed; }, [&] { return make(multiply, f_E, rest); });
      return chain([&] { return make(negate, make(multiply, f_E, make(multiply, f_x, f_x))); }, [&] { return mixed; });
    }
    case cosh_exp:
      return chain([&] { return make(sinh_exp, a, b); }, [&] { return make(negate, node); });
    case select_less:
      return make(select_less, a, b, dc);
    default:
      throw std::logic_error("an instruction of a tape has no derivative");
  }
}

Symbol Symbol::make(Operation operation, const Symbol& a, const Symbol& b) {
  Graph* graph = a.graph_ ? a.graph_ : b.graph_;
  if (graph) return {*graph, graph->make(operation, a.in(*graph), b.in(*graph))};
  double value = 0;
  with_operation(operation, [&](const auto& f) { value = f(a.number_, b.number_, 0.0); });
  return value;
}

}  // namespace rosin::laws
