/// How heat leaves a contact: its rise of temperature under steady power as a sum of exponentials.
#pragma once
#include <span>
#include <string_view>

#include "core/dual.hpp"

namespace rosin::laws {

/// One exponential of a kernel: heated by a power P that sets in at t = 0, a contact of resistance R warms as
/// ϑ(t) = R·P·Σ ρ_k (1 − e^{−t/τ_k}).
struct HeatMode {
  double share;  ///< ρ_k > 0, of sum 1: the rise that steady power ends at is R·P of any kernel
  double time;   ///< τ_k, in units of the kernel's own time
};

/// One temperature, the same throughout: a heat capacity C that loses heat through 1/R. Unit of time: R·C.
inline constexpr HeatMode lump[] = {{1, 1}};

/// Depth of a half-space, of diffusivity κ, under the centre of a disc of radius r that is heated evenly. Unit of time:
/// r²/κ. The surface warms as
///   ϑ/(R·P) = 2√x [1/√π − ierfc(1/(2√x))],  x = κt/r²,  and answers an oscillating power with  (1 − e^{−√s})/√s,
/// s = iω r²/κ: as √t and 1/√s, like a half-space heated all over, until heat spreads sideways (Carslaw & Jaeger,
/// Conduction of Heat in Solids, 1959, section 10.5). Its spectrum of rates ω = u² r²/κ has the density
/// 2(1 − cos u)/(πu²) du, nowhere negative, so that exponentials with positive shares converge to it. These ten, with
/// times in the ratio 5.2, have the least squares of the relative errors of both, each at 400 points evenly spaced in
/// the logarithm, for x from 1e-3 to 1e7 and ω r²/κ from 1e-5 to 1e3.
inline constexpr HeatMode disc[] = {{0.013993, 1.8e-4},     {0.013868, 9.36e-4},     {0.038782, 4.8672e-3},
                                    {0.069285, 0.02530944}, {0.325843, 0.131609088}, {0.301767, 0.684367258},
                                    {0.123368, 3.55870974}, {0.069877, 18.5052906},  {0.016460, 96.2275114},
                                    {0.026757, 500.383059}};
inline constexpr int disc_modes = int(std::size(disc));
/// The disc under a layer that holds heat of its own, such as a film of rosin: of the disc's exponentials those of
/// r²/κ and around it, what is faster lumped in the fastest. Rounded shares at times in the ratio 4.64; not measured.
inline constexpr HeatMode layered_disc[] = {
    {0.1156, 0.02}, {0.2667, 0.1}, {0.3234, 0.464}, {0.1465, 2.155}, {0.1478, 15}};
inline constexpr int layer_modes = int(std::size(layered_disc));
/// Largest relative error of the rise at any time from disc_from·r²/κ on, and of the answer to an oscillating power up
/// to ω = κ/(disc_from·r²). Sooner than that the sum warms as t, like a thin layer, where the disc warms as √t.
inline constexpr double disc_error = 0.0061, disc_response_error = 0.0138, disc_from = 1e-3;
inline constexpr std::string_view disc_approximation =
    "conduction from a disc by 10 exponentials: its rise of temperature within 0.61 % from 0.001 r2/kappa on, its "
    "answer to an oscillation within 1.38 % up to omega = 1000 kappa/r2";

/// Rates of a contact's temperatures per unit of the kernel's time. rise[0] and rate[0] are of the whole rise ϑ, the
/// others of the parts ϑ_k of the modes behind the fastest, whose own part is what is left. `ends_at` is R·P, the rise
/// that the present power would end at.
template <class Real>
ROSIN_INLINE void heat_rates(std::span<const HeatMode> modes, const Real& ends_at, const Real* rise, Real* rate) {
  Real fastest = rise[0], others = 0.0;
  for (std::size_t k = 1; k < modes.size(); ++k) {
    fastest = fastest - rise[k];
    rate[k] = (modes[k].share * ends_at - rise[k]) / modes[k].time;
    others = others + rate[k];
  }
  rate[0] = (modes[0].share * ends_at - fastest) / modes[0].time + others;
}

}  // namespace rosin::laws
