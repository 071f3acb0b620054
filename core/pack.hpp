/// SIMD lanes: packs of eight doubles in GCC vector extensions, four to a batch, with the elementary functions that
/// laws use.
///
/// The functions are written in plain arithmetic, so that every instruction set gives the same bits (the library is
/// compiled with -ffp-contract=off). Accuracy: exp, expm1, log, log1p within 2 ulp of the correctly rounded result.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <limits>

namespace rosin {

inline constexpr int pack_width = 8;
inline constexpr int lane_packs = 4;
inline constexpr int lane_count = lane_packs * pack_width;

#define ROSIN_INLINE [[gnu::always_inline]] inline
/// Before a short loop over unknowns or derivatives: keeps their values in registers, which -O2 alone does not.
#define ROSIN_UNROLL _Pragma("GCC unroll 16")

// Aligned by name: without it the alignment, and so the layout, would depend on the instruction set of each file.
using Block = double __attribute__((vector_size(8 * pack_width), aligned(8 * pack_width)));
using BlockBits = std::int64_t __attribute__((vector_size(8 * pack_width), aligned(8 * pack_width)));

/// One truth value per lane, 1 or 0. As numbers and not as bits: GCC 12 takes combinations of vector comparisons apart
/// lane by lane, which costs more than all the rest.
struct Mask {
  Block truth;
};

/// Eight doubles; arithmetic acts lane by lane.
struct Pack {
  Block block;

  Pack() = default;
  ROSIN_INLINE Pack(double x) : block(x - Block{}) {}
  ROSIN_INLINE explicit Pack(Block b) : block(b) {}
};

/// 32 lanes, the batch that solvers move together: four packs.
struct Lanes {
  Pack pack[lane_packs];

  Lanes() = default;
  Lanes(double x) {
    for (auto& p : pack) p = Pack(x);
  }
  double operator[](int lane) const { return pack[lane / pack_width].block[lane % pack_width]; }
  void set(int lane, double x) { pack[lane / pack_width].block[lane % pack_width] = x; }
};

ROSIN_INLINE Pack operator+(const Pack& a, const Pack& b) { return Pack(a.block + b.block); }
ROSIN_INLINE Pack operator-(const Pack& a, const Pack& b) { return Pack(a.block - b.block); }
ROSIN_INLINE Pack operator*(const Pack& a, const Pack& b) { return Pack(a.block * b.block); }
ROSIN_INLINE Pack operator/(const Pack& a, const Pack& b) { return Pack(a.block / b.block); }
ROSIN_INLINE Pack operator-(const Pack& a) { return Pack(-a.block); }
ROSIN_INLINE Mask operator<(const Pack& a, const Pack& b) { return {a.block < b.block ? Block{} + 1.0 : Block{}}; }
ROSIN_INLINE Mask operator>(const Pack& a, const Pack& b) { return {a.block > b.block ? Block{} + 1.0 : Block{}}; }
ROSIN_INLINE Mask operator&(const Mask& a, const Mask& b) { return {a.truth * b.truth}; }
ROSIN_INLINE Mask operator|(const Mask& a, const Mask& b) { return {a.truth + b.truth - a.truth * b.truth}; }
ROSIN_INLINE Mask operator^(const Mask& a, const Mask& b) { return {(a.truth - b.truth) * (a.truth - b.truth)}; }
ROSIN_INLINE Mask operator!(const Mask& a) { return {1.0 - a.truth}; }
ROSIN_INLINE Pack select(const Mask& m, const Pack& a, const Pack& b) {
  const BlockBits all = (__builtin_bit_cast(BlockBits, m.truth) << 2) >> 63;  // 1.0: all bits set
  return Pack(__builtin_bit_cast(
      Block, (__builtin_bit_cast(BlockBits, a.block) & all) | (__builtin_bit_cast(BlockBits, b.block) & ~all)));
}
/// True if a lane holds anything but zero.
inline bool any(const Lanes& x) {
  Block sum{};
  for (const Pack& p : x.pack) sum += p.block * p.block;
  double all = 0;
  for (int i = 0; i < pack_width; ++i) all += sum[i];
  return all != 0;
}

ROSIN_INLINE Pack abs(const Pack& a) {
  return Pack(__builtin_bit_cast(Block, __builtin_bit_cast(BlockBits, a.block) & INT64_MAX));
}
ROSIN_INLINE Pack max(const Pack& a, const Pack& b) { return select(a < b, b, a); }
ROSIN_INLINE Pack min(const Pack& a, const Pack& b) { return select(b < a, b, a); }
ROSIN_INLINE Pack sqrt(const Pack& a) {
  // By way of an array: a loop over elements of a vector is left as it is, eight roots one by one.
  struct Array {
    double x[pack_width];
  } lanes = __builtin_bit_cast(Array, a.block);
  for (double& x : lanes.x) x = __builtin_sqrt(x);
  return Pack(__builtin_bit_cast(Block, lanes));
}

namespace detail {

ROSIN_INLINE Block bits_to_double(BlockBits b) { return __builtin_bit_cast(Block, b); }
ROSIN_INLINE BlockBits double_to_bits(Block d) { return __builtin_bit_cast(BlockBits, d); }
ROSIN_INLINE BlockBits wrapping_difference(BlockBits a, BlockBits b) {
  using Words = std::uint64_t __attribute__((vector_size(sizeof(BlockBits))));
  return __builtin_bit_cast(BlockBits, __builtin_bit_cast(Words, a) - __builtin_bit_cast(Words, b));
}

inline constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
inline constexpr double round_shift = 6755399441055744.0;  // 1.5·2^52: adding it rounds to an integer in the low bits

/// r = x - k·ln 2 with |r| <= ln2/2, and 2^k in two factors (so that subnormal results are right).
struct Reduced {
  Block r, low, scale_one, scale_two;
};
ROSIN_INLINE Reduced reduce_exp(Block x) {
  const Block shifted = x * 1.4426950408889634 + round_shift;
  const Block k = shifted - round_shift;
  const Block high = x - k * ln2_high, low = k * ln2_low;
  const BlockBits n = double_to_bits(shifted) - double_to_bits(Block{} + round_shift);
  const BlockBits half = n >> 1;
  return {high - low, (high - (high - low)) - low, bits_to_double((half + 1023) << 52),
          bits_to_double((n - half + 1023) << 52)};
}
/// (e^r - 1 - r - r²/2)/r³ on |r| <= ln2/2 by the Chebyshev interpolant of degree 9 (error of e^r - 1 below 3e-18
/// relative), summed in pairs, which waits less than Horner's chain.
ROSIN_INLINE Block exp_tail(Block r) {
  constexpr double c[] = {0.16666666666666669,    0.041666666666666664,   0.008333333333330051,   0.0013888888888886545,
                          0.00019841269863105968, 2.4801587317181886e-05, 2.7557268378684192e-06, 2.755728291148268e-07,
                          2.5100424157005067e-08, 2.0911264239196083e-09};
  const Block r2 = r * r, r4 = r2 * r2;
  const Block low = (c[0] + c[1] * r) + r2 * (c[2] + c[3] * r);
  const Block middle = (c[4] + c[5] * r) + r2 * (c[6] + c[7] * r);
  return low + r4 * (middle + r4 * (c[8] + c[9] * r));
}
ROSIN_INLINE Block expm1_reduced(Block r, Block low) { return r + (low + r * r * (0.5 + r * exp_tail(r))); }

ROSIN_INLINE Block clamp_exponent(Block x) {
  x = x > 710.0 ? Block{} + 710.0 : x;
  return x < -760.0 ? Block{} - 760.0 : x;
}
ROSIN_INLINE Block exp_block(Block x) {
  const Reduced q = reduce_exp(clamp_exponent(x));
  const Block e = (1.0 + expm1_reduced(q.r, q.low)) * q.scale_one * q.scale_two;
  return x == x ? e : x;
}
ROSIN_INLINE Block expm1_block(Block x) {
  const Reduced q = reduce_exp(clamp_exponent(x));
  const Block t = expm1_reduced(q.r, q.low), two_k = q.scale_one * q.scale_two;
  // 2^k (t + 1) - 1; for k = 0 this is t itself, without rounding.
  Block e = two_k * t + (two_k - 1.0);
  e = x > 40.0 ? (1.0 + t) * q.scale_one * q.scale_two : e;
  return x == x ? e : x;
}
/// log by reduction to [sqrt(1/2), sqrt 2) and the atanh series (after the method of FDLIBM's e_log).
/// `correction` is added at the precision of the small part: log(x) + correction.
ROSIN_INLINE Block log_block(Block x, Block correction) {
  constexpr double least = 2.2250738585072014e-308;
  const BlockBits bits = double_to_bits(x < least ? x * 18014398509481984.0 : x);  // 2^54
  // x = 2^k m, by the distance of its bits from those of sqrt(1/2); of negative x it wraps around, and is not used.
  const BlockBits k = wrapping_difference(bits, BlockBits{} + 0x3fe6a09e667f3bcd) >> 52;
  const Block m = bits_to_double(wrapping_difference(bits, k << 52));
  // The integer exponent as a double without a conversion instruction that SSE2 lacks.
  Block exponent = bits_to_double(double_to_bits(Block{} + round_shift) + k) - round_shift;
  exponent = x < least ? exponent - 54.0 : exponent;
  const Block f = m - 1.0, s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
  const Block w = z * z;
  const Block even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const Block odd = 6.666666666666735130e-01 +
                    w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01));
  const Block r =
      exponent * ln2_high - ((half - (s * (half + (z * odd + even)) + (exponent * ln2_low + correction))) - f);
  // 0, infinity, negative numbers and NaN.
  const Block infinity = Block{} + std::numeric_limits<double>::infinity();
  const Block upper = x < infinity ? r : x;
  const Block lower = x < 0.0 ? Block{} + std::numeric_limits<double>::quiet_NaN() : -infinity;
  return x > 0.0 ? upper : (x == x ? lower : x);
}
}  // namespace detail

ROSIN_INLINE Pack exp(const Pack& x) { return Pack(detail::exp_block(x.block)); }
ROSIN_INLINE Pack expm1(const Pack& x) { return Pack(detail::expm1_block(x.block)); }
ROSIN_INLINE Pack log(const Pack& x) { return Pack(detail::log_block(x.block, Block{})); }
ROSIN_INLINE Pack log1p(const Pack& x) {
  const Block t = x.block, u = 1.0 + t;
  const Block lost = u - 1.0 < 1e300 ? (t - (u - 1.0)) / u : Block{};  // what rounding 1 + t dropped
  return Pack(detail::log_block(u, lost));
}

}  // namespace rosin
