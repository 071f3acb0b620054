/// Compiling graphs to tapes (order of evaluation, registers) and the loops that execute them.
#include "laws/tape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/error.hpp"
#include "laws/operations.hpp"
#include "laws/portion.hpp"

namespace rosin::laws {

namespace {

constexpr std::uint16_t constant_mark = 0x8000;
constexpr int none = -1;

/// The group of operations that one instruction computes together.
struct Group {
  Operation together;
  std::vector<Operation> members;
};
const Group* group_of(Operation operation) {
  static const Group groups[] = {
      {Operation::sinh_cosh_exp, {Operation::sinh_exp, Operation::cosh_exp}},
      {Operation::asinh_exp_slopes, {Operation::asinh_exp, Operation::asinh_exp_by_x, Operation::asinh_exp_by_E}}};
  for (const auto& group : groups)
    if (std::ranges::find(group.members, operation) != group.members.end()) return &group;
  return nullptr;
}

class Compiler {
 public:
  /// `constant` gives the register of a node that is not computed here; `load` the input number of one that is given.
  Compiler(const Graph& graph, std::function<int(int)> constant, std::function<int(int)> load)
      : graph_(graph), constant_(std::move(constant)), load_(std::move(load)) {}

  Tape operator()(std::span<const int> outputs) {
    place_.assign(std::size_t(graph_.size()), none);
    uses_.assign(std::size_t(graph_.size()), 0);
    count_uses(outputs);
    load_inputs();
    for (const int node : outputs) emit(node);
    for (const int node : outputs) tape_.outputs.push_back(std::uint16_t(place_[std::size_t(node)]));
    return std::move(tape_);
  }

 private:
  /// Nodes that are computed here, each once, its operands marked.
  void count_uses(std::span<const int> outputs) {
    std::vector<int> open(outputs.begin(), outputs.end());
    for (const int node : outputs) ++uses_[std::size_t(node)];
    std::vector<bool> seen(uses_.size());
    while (!open.empty()) {
      const int node = open.back();
      open.pop_back();
      if (seen[std::size_t(node)]) continue;
      seen[std::size_t(node)] = true;
      if (constant_(node) != none || load_(node) != none) continue;
      for (const int operand : operands(node)) {
        ++uses_[std::size_t(operand)];
        open.push_back(operand);
      }
    }
    needed_ = std::move(seen);
  }

  std::span<const int> operands(int node) const {
    return {graph_[node].operand.data(), std::size_t(operand_count(graph_[node].operation))};
  }
  bool placed(int node) const { return place_[std::size_t(node)] != none; }

  /// Inputs are loaded before anything is computed, so that no register has served another value before.
  void load_inputs() {
    for (int node = 0; node < graph_.size(); ++node)
      if (const int input = load_(node); needed_[std::size_t(node)] && input != none) {
        place_[std::size_t(node)] = take_register();
        tape_.loads.push_back({std::uint16_t(input), std::uint16_t(place_[std::size_t(node)])});
      }
  }

  /// Emits what a node needs, and the node; without recursion, since sums may be long.
  void emit(int root) {
    std::vector<int> open{root};
    while (!open.empty()) {
      const int node = open.back();
      if (placed(node)) {
        open.pop_back();
      } else if (const int constant = constant_(node); constant != none) {
        place_[std::size_t(node)] = constant | constant_mark;
      } else {
        bool ready = true;
        for (const int operand : operands(node))
          if (!placed(operand)) open.push_back(operand), ready = false;
        if (ready) emit_instruction(node);
      }
    }
  }

  void emit_instruction(int node) {
    Instruction instruction{graph_[node].operation, {}, {}};
    std::vector<int> results{node};
    if (const Group* group = group_of(instruction.operation)) {
      std::vector<int> members;
      for (const auto member : group->members) {
        const int k = graph_.find(member, graph_[node].operand[0], graph_[node].operand[1]);
        members.push_back(k >= 0 && std::size_t(k) < needed_.size() && needed_[std::size_t(k)] ? k : none);
      }
      if (std::ranges::count(members, none) + 1 < std::ptrdiff_t(members.size())) {
        instruction.operation = group->together;
        results = members;
      }
    }
    const auto list = operands(node);
    for (std::size_t k = 0; k < list.size(); ++k) instruction.operand[k] = std::uint16_t(place_[std::size_t(list[k])]);
    // Results are taken before operands are given back: with several, one would overwrite what the next still needs.
    int unused = none;
    for (std::size_t k = 0; k < results.size(); ++k) {
      const int place = take_register();
      instruction.target[k] = std::uint16_t(place);
      if (results[k] == none)
        unused = place;
      else
        place_[std::size_t(results[k])] = place;
    }
    if (unused != none) give_back(unused);
    for (const int result : results)
      if (result != none)
        for (const int operand : operands(result)) release(operand);
    tape_.instructions.push_back(instruction);
  }

  int take_register() {
    if (free_.empty()) {
      if (tape_.registers == Tape::most_registers)
        throw InputError(
            fmt::format("the formula law needs more than {} intermediate values at once; write it more "
                        "briefly",
                        Tape::most_registers));
      return tape_.registers++;
    }
    const int place = free_.back();
    free_.pop_back();
    return place;
  }
  void give_back(int place) { free_.push_back(place); }
  void release(int node) {
    if (--uses_[std::size_t(node)] == 0 && !(place_[std::size_t(node)] & constant_mark))
      give_back(place_[std::size_t(node)]);
  }

  const Graph& graph_;
  std::function<int(int)> constant_, load_;
  std::vector<int> place_, uses_, free_;
  std::vector<bool> needed_;
  Tape tape_;
};

}  // namespace

std::uint16_t ConstantPool::place(int node) {
  const auto at = std::ranges::find(nodes, node);
  if (at == nodes.end()) {
    if (nodes.size() == constant_mark)
      throw InputError("the formula law has too many constants; write it more briefly");
    nodes.push_back(node);
    return std::uint16_t(nodes.size() - 1);
  }
  return std::uint16_t(at - nodes.begin());
}

Tape compile(const Graph& graph, std::span<const int> outputs, ConstantPool& pool) {
  return Compiler(
      graph, [&](int node) { return graph[node].varies ? none : int(pool.place(node)); },
      [&](int node) { return graph[node].operation == Operation::input ? graph[node].operand[0] : none; })(outputs);
}

PoolTape compile_pool(const Graph& graph, const ConstantPool& pool) {
  PoolTape compiled;
  ConstantPool numbers;
  compiled.tape = Compiler(
      graph, [&](int node) { return graph[node].operation == Operation::constant ? int(numbers.place(node)) : none; },
      [&](int node) { return graph[node].operation == Operation::parameter ? graph[node].operand[0] : none; })(
      pool.nodes);
  for (const int node : numbers.nodes) compiled.numbers.push_back(graph[node].number);
  return compiled;
}

template <class Real>
std::vector<Real> PoolTape::operator()(const std::vector<Real>& parameters) const {
  std::vector<const Real*> inputs;
  for (const Real& x : parameters) inputs.push_back(&x);
  const std::vector<Real> own(numbers.begin(), numbers.end());
  const TapeRun<Real> run(tape, own.data(), inputs.data());
  std::vector<Real> constants(tape.outputs.size());
  for (std::size_t k = 0; k < constants.size(); ++k) constants[k] = run[k];
  return constants;
}
template std::vector<double> PoolTape::operator()(const std::vector<double>&) const;
template std::vector<Tower> PoolTape::operator()(const std::vector<Tower>&) const;

namespace {

template <class Real>
ROSIN_INLINE void execute_here(const Tape& tape, const Real* constants, const Real* const* inputs, Real* registers) {
  using Part = Portion<Real>;
  for (const auto& load : tape.loads) registers[load.target] = *inputs[load.input];
  const Real* const bank[] = {registers, constants};
  const auto at = [&](std::uint16_t r) __attribute__((always_inline))->const Real& {
    return bank[r >> 15][r & ~constant_mark];
  };
  for (const Instruction& i : tape.instructions) {
    const Real &a = at(i.operand[0]), &b = at(i.operand[1]), &c = at(i.operand[2]);
    Real &r = registers[i.target[0]], &s = registers[i.target[1]], &t = registers[i.target[2]];
    if (i.operation == Operation::sinh_cosh_exp) {
      for (int p = 0; p < Part::count; ++p) {
        const auto f = sinh_cosh_exp(Part::of(a, p), Part::of(b, p));
        Part::of(r, p) = f.sinh, Part::of(s, p) = f.cosh;
      }
    } else if (i.operation == Operation::asinh_exp_slopes) {
      for (int p = 0; p < Part::count; ++p) {
        const auto f = asinh_exp_with_slopes(Part::of(a, p), Part::of(b, p));
        Part::of(r, p) = f.value, Part::of(s, p) = f.by_v, Part::of(t, p) = f.by_E;
      }
    } else {
      with_operation(
          i.operation, [&](const auto& f) __attribute__((always_inline)) {
            for (int p = 0; p < Part::count; ++p) Part::of(r, p) = f(Part::of(a, p), Part::of(b, p), Part::of(c, p));
          });
    }
  }
}

}  // namespace

template <class Real>
void TapeRun<Real>::execute(const Real* const* inputs) {
  on_lanes<Real>([&] { execute_here(tape_, constants_, inputs, registers_); });
}

template class TapeRun<double>;
template class TapeRun<Pack>;
template class TapeRun<Lanes>;
template class TapeRun<Tower>;

}  // namespace rosin::laws
