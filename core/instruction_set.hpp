/// Lane kernels compiled for several instruction sets, one of which is chosen at run time.
#pragma once

/// Lanes are compiled once per instruction set where the compiler can. Builds that look for faults of the source, not
/// of the machine code, set it to 0: sanitized kernels take minutes to compile.
#if defined(ROSIN_RUNTIME_INSTRUCTION_SETS)
#elif defined(__x86_64__) && !defined(__clang__)
#define ROSIN_RUNTIME_INSTRUCTION_SETS 1
#else
#define ROSIN_RUNTIME_INSTRUCTION_SETS 0
#endif

namespace rosin {

/// Which instruction set lanes run on: x86-64 baseline (SSE2), v3 (AVX2) or v4 (AVX-512).
enum class InstructionSet { baseline, v3, v4 };
/// The set in use: the best of the machine, unless a lesser one was asked for.
InstructionSet instruction_set();
/// Asks for a set; more than the machine has is not given. For tests and benches: results are the same bits on each.
void use_instruction_set(InstructionSet);

namespace detail {
#if ROSIN_RUNTIME_INSTRUCTION_SETS
template <class Kernel>
[[gnu::target("arch=x86-64-v4"), gnu::flatten]] void run_v4(const Kernel& kernel) {
  kernel();
}
template <class Kernel>
[[gnu::target("arch=x86-64-v3"), gnu::flatten]] void run_v3(const Kernel& kernel) {
  kernel();
}
#endif
}  // namespace detail

/// Runs kernel() in the code compiled for the instruction set in use. What the kernel calls must be visible to the
/// compiler here, to be inlined.
template <class Kernel>
void run_on_lanes(const Kernel& kernel) {
#if ROSIN_RUNTIME_INSTRUCTION_SETS
  switch (instruction_set()) {
    case InstructionSet::v4:
      return detail::run_v4(kernel);
    case InstructionSet::v3:
      return detail::run_v3(kernel);
    case InstructionSet::baseline:
      break;
  }
#endif
  kernel();
}

}  // namespace rosin
