/// What the ensemble solver advances: 32 systems of one kind that differ in parameters.
#pragma once
#include "core/pack.hpp"

namespace rosin {

/// Work on 32 lanes, of which the last packs are left out while nobody uses them.
class LaneWork {
 public:
  virtual ~LaneWork() = default;
  /// From now on the lanes of the first `packs` packs are worked on; those of the others hold what they happen to.
  virtual void use_packs(int packs) { packs_ = packs; }

 protected:
  int packs_ = lane_packs;
};

/// 32 systems M·ẏ = f(y) with diagonal M whose zero rows are algebraic, one in each lane. Arrays hold one Lanes for
/// each unknown.
class LaneSystem : public LaneWork {
 public:
  virtual int size() const = 0;
  /// Diagonal of M.
  virtual void mass(Lanes* m) const = 0;
  /// f(y).
  virtual void evaluate(const Lanes* y, Lanes* f) const = 0;
  /// f and ∂f/∂y, row-major size × size. Solvers eliminate the unknowns in their order and without pivoting: mechanics
  /// first, which are never stiff, then those of the contact.
  virtual void linearise(const Lanes* y, Lanes* f, Lanes* jacobian) const = 0;
  /// The sizes by which errors in each unknown are measured, at y, where the derivative is `jacobian`.
  virtual void scale(const Lanes* y, const Lanes* jacobian, Lanes* s) const = 0;
};

}  // namespace rosin
