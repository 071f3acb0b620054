/// How a contact of type Real is worked on: in which scalar type, in how many portions, on which instruction set.
#pragma once
#include "core/dual.hpp"
#include "core/instruction_set.hpp"
#include "core/lane_system.hpp"

namespace rosin::laws {

/// Scalar type that a law is evaluated in, and how many of them make up a contact of type Real.
template <class Real>
struct Portion {
  using Scalar = Real;
  static constexpr int count = 1;
  static const Real& of(const Real& x, int) { return x; }
  static Real& of(Real& x, int) { return x; }
};
template <>
struct Portion<Lanes> {
  using Scalar = Pack;
  static constexpr int count = lane_packs;
  ROSIN_INLINE static const Pack& of(const Lanes& x, int i) { return x.pack[i]; }
  ROSIN_INLINE static Pack& of(Lanes& x, int i) { return x.pack[i]; }
};

/// The same for values without derivatives, which leave registers free: two packs of lanes side by side.
template <class Real>
struct WidePortion {
  using Scalar = Real;
  static constexpr int count = 1, width = 1;
  static const Real& get(const Real& x, int) { return x; }
  static void set(Real& x, int, const Real& value) { x = value; }
};
template <>
struct WidePortion<Lanes> {
  using Scalar = PackPair;
  static constexpr int count = lane_packs / 2, width = 2 * pack_width;
  ROSIN_INLINE static PackPair get(const Lanes& x, int i) { return {x.pack[2 * i], x.pack[2 * i + 1]}; }
  ROSIN_INLINE static void set(Lanes& x, int i, const PackPair& value) {
    for (int k = 0; k < 2; ++k) x.pack[2 * i + k] = value.half[k];
  }
};

/// How many portions a contact works on: of lanes those with a pack in use.
template <class Real>
class Portions {
 protected:
  static constexpr int portions() { return Portion<Real>::count; }
  static constexpr int wide_portions() { return WidePortion<Real>::count; }
};
template <>
class Portions<Lanes> : public LaneWork {
 protected:
  int portions() const { return packs_; }
  int wide_portions() const { return (packs_ + 1) / 2; }
};

/// Runs a kernel once, on the instruction set in use if it works on packs.
template <class Real, class Kernel>
void on_lanes(const Kernel& kernel) {
  if constexpr (std::is_same_v<typename Portion<Real>::Scalar, Pack>)
    run_on_lanes(kernel);
  else
    kernel();
}

namespace detail {

/// Sets one lane of a scalar: the only lane of a double or of a Dual's slopes stays constant.
inline void set_lane(double& x, int, double value) { x = value; }
inline void set_lane(Pack& x, int lane, double value) { x.block[lane] = value; }
inline void set_lane(PackPair& x, int lane, double value) {
  set_lane(x.half[lane / pack_width], lane % pack_width, value);
}
inline void set_lane(Lanes& x, int lane, double value) { x.set(lane, value); }
template <class Real, int n>
void set_lane(Dual<Real, n>& x, int lane, double value) {
  set_lane(x.value, lane, value);
}

}  // namespace detail

}  // namespace rosin::laws
