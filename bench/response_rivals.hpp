/// A swept sine on an ageing contact at an imposed slip rate, followed by CVODE.
#pragma once
#include <complex>
#include <string>

namespace bench {

/// μ = μ0 + a ln(v/v0) + b ln(v0 θ/L), θ̇ = 1 − v θ/L, about the slip rate V under the load N.
struct AgeingContact {
  double mu0, a, b, L, v0, V, N;
};

struct SweptSine {
  std::complex<double> Z;
  std::string failure = {};
};

/// δF/δv at a frequency (Hz): v = V (1 + ε cos ωt) with ε = 0.01 and 0.005, extrapolated to none. Transients are left
/// to fall to the tolerance, then four cycles are sampled; in ln θ, with Adams methods, as its user would write it.
SweptSine swept_by_cvode(const AgeingContact&, double frequency, double tolerance);

}  // namespace bench
