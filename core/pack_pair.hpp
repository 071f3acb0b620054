/// Two packs side by side. A law is a chain of exponentials and logarithms in which each operation waits for the one
/// before; of two chains, each is computed while the other waits.
#pragma once
#include "core/pack.hpp"

namespace rosin {

struct MaskPair {
  Mask half[2];
};

/// Sixteen doubles; arithmetic acts lane by lane.
struct PackPair {
  Pack half[2];

  PackPair() = default;
  ROSIN_INLINE PackPair(double x) : half{Pack(x), Pack(x)} {}
  ROSIN_INLINE PackPair(const Pack& one, const Pack& other) : half{one, other} {}
};

#define ROSIN_ON_HALVES(Result, operation) \
  ROSIN_INLINE Result operation(const PackPair& a) { return {operation(a.half[0]), operation(a.half[1])}; }
#define ROSIN_BETWEEN_HALVES(Result, operation, Operand)                       \
  ROSIN_INLINE Result operation(const Operand& a, const Operand& b) {          \
    return {operation(a.half[0], b.half[0]), operation(a.half[1], b.half[1])}; \
  }
ROSIN_ON_HALVES(PackPair, operator-)
ROSIN_ON_HALVES(PackPair, abs)
ROSIN_ON_HALVES(PackPair, sqrt)
ROSIN_ON_HALVES(PackPair, exp)
ROSIN_ON_HALVES(PackPair, expm1)
ROSIN_ON_HALVES(PackPair, log)
ROSIN_ON_HALVES(PackPair, log1p)
ROSIN_BETWEEN_HALVES(PackPair, operator+, PackPair)
ROSIN_BETWEEN_HALVES(PackPair, operator-, PackPair)
ROSIN_BETWEEN_HALVES(PackPair, operator*, PackPair)
ROSIN_BETWEEN_HALVES(PackPair, operator/, PackPair)
ROSIN_BETWEEN_HALVES(PackPair, max, PackPair)
ROSIN_BETWEEN_HALVES(PackPair, min, PackPair)
ROSIN_BETWEEN_HALVES(MaskPair, operator<, PackPair)
ROSIN_BETWEEN_HALVES(MaskPair, operator>, PackPair)
ROSIN_BETWEEN_HALVES(MaskPair, operator&, MaskPair)
ROSIN_BETWEEN_HALVES(MaskPair, operator|, MaskPair)
ROSIN_BETWEEN_HALVES(MaskPair, operator^, MaskPair)
#undef ROSIN_ON_HALVES
#undef ROSIN_BETWEEN_HALVES
ROSIN_INLINE MaskPair operator!(const MaskPair& a) { return {!a.half[0], !a.half[1]}; }
ROSIN_INLINE PackPair select(const MaskPair& m, const PackPair& a, const PackPair& b) {
  return {select(m.half[0], a.half[0], b.half[0]), select(m.half[1], a.half[1], b.half[1])};
}

}  // namespace rosin
