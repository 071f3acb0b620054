/// Formulas as a tape: a flat list of instructions, each of which acts on one double, on a pack, on 32 lanes,
/// or on a Tower.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/pack.hpp"
#include "laws/graph.hpp"

namespace rosin::laws {

/// One operation on registers. A register is an index, with the highest bit set for constants.
struct Instruction {
  Operation operation;
  std::uint16_t target[3];   ///< one, unless the operation has several results
  std::uint16_t operand[3];  ///< those that the operation has not are 0
};

/// What does not vary, of all tapes of a law: nodes that are computed once when parameters are loaded.
struct ConstantPool {
  std::vector<int> nodes;
  std::uint16_t place(int node);
};

/// A compiled list of nodes. Immutable; evaluated by TapeRun.
struct Tape {
  static constexpr int most_registers = 256;

  struct Load {
    std::uint16_t input, target;
  };
  std::vector<Load> loads;  ///< the inputs that are used
  std::vector<Instruction> instructions;
  std::vector<std::uint16_t> outputs;
  int registers = 0;  ///< that must be held at once
};

/// Compiles `outputs`; nodes that do not vary become constants of the pool.
/// \throws InputError if they need too many registers.
Tape compile(const Graph&, std::span<const int> outputs, ConstantPool& pool);

/// Compiles the constants of a pool themselves, as functions of the parameters: those are its inputs, and numbers its
/// constants.
struct PoolTape {
  Tape tape;
  std::vector<double> numbers;
  /// The constants of the pool at these parameters, double or Tower.
  template <class Real>
  std::vector<Real> operator()(const std::vector<Real>& parameters) const;
};
PoolTape compile_pool(const Graph&, const ConstantPool& pool);

/// One evaluation of a tape, with its registers on the stack.
template <class Real>
class TapeRun {
 public:
  /// \param constants of the pool
  /// \param inputs by number; those that the tape does not use may be null
  TapeRun(const Tape& tape, const Real* constants, const Real* const* inputs) : tape_(tape), constants_(constants) {
    execute(inputs);
  }
  /// Output number k.
  const Real& operator[](std::size_t k) const { return at(tape_.outputs[k]); }

 private:
  static constexpr std::uint16_t constant_mark = 0x8000;
  const Real& at(std::uint16_t r) const { return r & constant_mark ? constants_[r & ~constant_mark] : registers_[r]; }
  void execute(const Real* const* inputs);

  const Tape& tape_;
  const Real* constants_;
  Real registers_[Tape::most_registers];  // not initialised: a tape writes before it reads
};

}  // namespace rosin::laws
