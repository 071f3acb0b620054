/// Formulas as a graph: each intermediate value stands there once, however often it is written, and can be
/// differentiated and have its inputs replaced.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace rosin::laws {

/// What a node of the graph, or an instruction of a tape, computes from its operands a, b, c.
enum class Operation : std::uint8_t {
  constant,   ///< a number
  parameter,  ///< a number that is set when a law is loaded
  input,      ///< what changes from one evaluation to the next
  add,
  subtract,
  multiply,
  divide,
  negate,
  exp,
  log,
  sqrt,
  abs,
  sign,
  sinh,
  cosh,
  tanh,
  asinh,
  minimum,
  maximum,
  power,             ///< a^b, real_power of core/maths.hpp
  asinh_exp,         ///< asinh(a·e^b)
  sinh_exp,          ///< e^−b·sinh a
  asinh_exp_by_x,    ///< ∂/∂a of asinh_exp
  asinh_exp_by_E,    ///< ∂/∂b of asinh_exp
  cosh_exp,          ///< ∂/∂a of sinh_exp
  select_less,       ///< where a < b: c, else 0
  asinh_exp_slopes,  ///< instruction only: asinh_exp and both derivatives at once
  sinh_cosh_exp      ///< instruction only: sinh_exp and cosh_exp at once
};

struct Node {
  Operation operation;
  std::array<int, 3> operand;  ///< nodes; of a parameter or an input, its number; −1 where there is none
  double number;               ///< of a constant
  bool varies;                 ///< depends on an input
};

/// A growing list of nodes, each behind its operands. Nodes are named by their place in the list.
class Graph {
 public:
  static constexpr int capacity = 200'000;  ///< nodes; more is a law that nobody can mean

  int constant(double);
  int parameter(int number) { return intern({Operation::parameter, {number, -1, -1}, 0, false}); }
  int input(int number) { return intern({Operation::input, {number, -1, -1}, 0, true}); }
  /// The node of an operation, simplified: what is constant is computed, 0·x is 0, 1·x is x, ln e^x is x.
  /// \throws InputError beyond the capacity.
  int make(Operation, int a, int b = -1, int c = -1);

  int size() const { return int(nodes_.size()); }
  const Node& operator[](int node) const { return nodes_[std::size_t(node)]; }
  bool is_number(int node, double x) const {
    return (*this)[node].operation == Operation::constant && (*this)[node].number == x;
  }
  /// The node of exactly this operation, or −1.
  int find(Operation, int a, int b) const;
  /// For every node, whether one of `roots` needs it.
  std::vector<bool> needed_for(std::span<const int> roots) const;
  /// True if the node depends on that input.
  bool uses_input(int node, int input) const;

  /// `nodes` with each input k replaced by the node inputs[k].
  std::vector<int> substitute(std::span<const int> nodes, std::span<const int> inputs);
  /// Derivatives of `nodes` by an input.
  std::vector<int> differentiate(std::span<const int> nodes, int input);

 private:
  int intern(const Node&);
  int derivative(int node, const std::vector<int>& of_operands);

  std::vector<Node> nodes_;
  std::map<std::tuple<Operation, std::array<int, 3>, std::uint64_t>, int> place_;
};

/// A node with its graph: a scalar type that records what is computed with it. Without a graph, a number.
class Symbol {
 public:
  Symbol() : Symbol(0.0) {}
  Symbol(double number) : number_(number) {}
  Symbol(Graph& graph, int node) : graph_(&graph), node_(node) {}

  /// This value as a node of `graph`.
  int in(Graph& graph) const { return graph_ ? node_ : graph.constant(number_); }

  friend Symbol operator+(const Symbol& a, const Symbol& b) { return make(Operation::add, a, b); }
  friend Symbol operator-(const Symbol& a, const Symbol& b) { return make(Operation::subtract, a, b); }
  friend Symbol operator*(const Symbol& a, const Symbol& b) { return make(Operation::multiply, a, b); }
  friend Symbol operator/(const Symbol& a, const Symbol& b) { return make(Operation::divide, a, b); }
  friend Symbol operator-(const Symbol& a) { return make(Operation::negate, a, a); }
  friend Symbol exp(const Symbol& a) { return make(Operation::exp, a, a); }
  friend Symbol sign(const Symbol& a) { return make(Operation::sign, a, a); }
  friend Symbol max(const Symbol& a, const Symbol& b) { return make(Operation::maximum, a, b); }

 private:
  static Symbol make(Operation, const Symbol& a, const Symbol& b);

  Graph* graph_ = nullptr;
  int node_ = -1;
  double number_ = 0;
};

/// Number of operands of an operation.
int operand_count(Operation);

}  // namespace rosin::laws
