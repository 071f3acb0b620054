/// What each operation of a formula computes, for every scalar type.
#pragma once
#include "core/maths.hpp"
#include "laws/graph.hpp"

namespace rosin::laws {

/// Calls use(f), f(a, b, c) being the operation's function of scalars; nothing for leaves and for instructions with
/// several results. The choice is made once, so that it may stand before a loop over lanes.
template <class Use>
ROSIN_INLINE void with_operation(Operation operation, const Use& use) {
#define ROSIN_OPERATION(name, value)                                                      \
  case Operation::name:                                                                   \
    use([]<class T>(const T& a, [[maybe_unused]] const T& b, [[maybe_unused]] const T& c) \
            __attribute__((always_inline))                                                \
                ->T { return value; });                                                   \
    break;
  switch (operation) {
    ROSIN_OPERATION(add, a + b)
    ROSIN_OPERATION(subtract, a - b)
    ROSIN_OPERATION(multiply, a * b)
    ROSIN_OPERATION(divide, a / b)
    ROSIN_OPERATION(negate, -a)
    ROSIN_OPERATION(exp, rosin::exp(a))
    ROSIN_OPERATION(log, rosin::log(a))
    ROSIN_OPERATION(sqrt, rosin::sqrt(a))
    ROSIN_OPERATION(abs, rosin::abs(a))
    ROSIN_OPERATION(sign, rosin::sign(a))
    ROSIN_OPERATION(sinh, rosin::sinh_exp(a, T(0.0)))
    ROSIN_OPERATION(cosh, rosin::cosh_exp(a, T(0.0)))
    ROSIN_OPERATION(tanh, rosin::tanh(a))
    ROSIN_OPERATION(asinh, rosin::asinh(a))
    ROSIN_OPERATION(minimum, rosin::min(a, b))
    ROSIN_OPERATION(maximum, rosin::max(a, b))
    ROSIN_OPERATION(power, rosin::real_power(a, b))
    ROSIN_OPERATION(asinh_exp, rosin::asinh_exp(a, b))
    ROSIN_OPERATION(sinh_exp, rosin::sinh_exp(a, b))
    ROSIN_OPERATION(asinh_exp_by_x, rosin::asinh_exp_with_slopes(a, b).by_v)
    ROSIN_OPERATION(asinh_exp_by_E, rosin::asinh_exp_with_slopes(a, b).by_E)
    ROSIN_OPERATION(cosh_exp, rosin::cosh_exp(a, b))
    ROSIN_OPERATION(select_less, rosin::select(a < b, c, T(0.0)))
    default:
      break;
  }
#undef ROSIN_OPERATION
}

}  // namespace rosin::laws
