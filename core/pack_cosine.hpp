/// The cosine of packs, for forces that vary in time.
#pragma once
#include "core/pack.hpp"

namespace rosin {

namespace detail {
/// sin r on |r| <= pi/2, by its series.
ROSIN_INLINE Block sin_reduced(Block r) {
  constexpr double c[] = {-1.0 / 6,
                          1.0 / 120,
                          -1.0 / 5040,
                          1.0 / 362880,
                          -1.0 / 39916800,
                          1.0 / 6227020800.0,
                          -1.0 / 1307674368000.0,
                          1.0 / 355687428096000.0,
                          -1.0 / 121645100408832000.0,
                          1.0 / 51090942171709440000.0};
  const Block z = r * r, z2 = z * z, z4 = z2 * z2;
  const Block low = (c[0] + c[1] * z) + z2 * (c[2] + c[3] * z), middle = (c[4] + c[5] * z) + z2 * (c[6] + c[7] * z);
  return r + r * z * (low + z4 * (middle + z4 * (c[8] + c[9] * z)));
}
/// cos x = (-1)^k sin(x - (k - 1/2) pi); pi in parts of 28 bits, whose products with k are exact.
ROSIN_INLINE Block cos_block(Block x) {
  constexpr double pi_high = 3.141592651605606, pi_middle = 1.9841871479187034e-09, pi_low = 1.1442377452219664e-17;
  const Block shifted = (x * 0.3183098861837907 + 0.5) + round_shift, n = (shifted - round_shift) - 0.5;
  const Block r = ((x - n * pi_high) - n * pi_middle) - n * pi_low;
  return bits_to_double(double_to_bits(sin_reduced(r)) ^ (double_to_bits(shifted) << 63));
}
}  // namespace detail

/// Within 3e-16 for |x| < 1e7.
ROSIN_INLINE Pack cos(const Pack& x) { return Pack(detail::cos_block(x.block)); }

}  // namespace rosin
