/// Detection of the instruction set that lanes run on.
#include "core/instruction_set.hpp"

#include <algorithm>
#include <atomic>

namespace rosin {

namespace {
InstructionSet best() {
#if ROSIN_RUNTIME_INSTRUCTION_SETS
  if (__builtin_cpu_supports("x86-64-v4")) return InstructionSet::v4;
  if (__builtin_cpu_supports("x86-64-v3")) return InstructionSet::v3;
#endif
  return InstructionSet::baseline;
}
std::atomic<InstructionSet>& in_use() {
  static std::atomic<InstructionSet> set = best();
  return set;
}
}  // namespace

InstructionSet instruction_set() { return in_use().load(std::memory_order_relaxed); }
void use_instruction_set(InstructionSet set) { in_use() = std::min(set, best()); }

}  // namespace rosin
