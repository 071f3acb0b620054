/// A fault patch with radiation damping under the ageing law as a user writes it down: plain formulas, nothing from
/// rosin. QDYN's stick–slip case (Luo et al. 2017), per unit area.
///
///   N (μ₀ + a ln(v/v₀) + b ln(v₀θ/L)) + c v = k (V t − slip) + …, differentiated:
///   (a N + c v) d(ln v)/dt = k (V − v) − b N d(ln θ)/dt,  dθ/dt = 1 − v θ/L
#pragma once
#include <array>
#include <cmath>

namespace bench {

struct Fault {
  double k = 2e9, c = 2e10 / 6000, N = 5e6, a = 0.01, b = 0.025, L = 1e-5, V = 1e-6;
  double first_slip_rate = 0.9e-6, first_age = 10, duration = 5000;
};

/// (ln v, ln θ): what a user who knows the problem integrates.
struct LogarithmicFault {
  using Setting = Fault;
  static constexpr int size = 2;
  static constexpr const char* name = "ln v, ln theta";
  template <class Real>
  static std::array<Real, 2> start(const Fault& p) {
    return {std::log(Real(p.first_slip_rate)), std::log(Real(p.first_age))};
  }
  static std::array<double, 2> scale(const Fault&) { return {1, 1}; }
  template <class Real>
  static void rate(const Fault& p, const std::array<Real, 2>& y, std::array<Real, 2>& f) {
    const Real v = std::exp(y[0]), theta = std::exp(y[1]);
    f[1] = 1 / theta - v / Real(p.L);
    f[0] = (Real(p.k) * (Real(p.V) - v) - Real(p.b) * Real(p.N) * f[1]) / (Real(p.a) * Real(p.N) + Real(p.c) * v);
  }
  static void jacobian(const Fault& p, const std::array<double, 2>& y, std::array<std::array<double, 2>, 2>& J) {
    const double v = std::exp(y[0]), theta = std::exp(y[1]), D = p.a * p.N + p.c * v;
    std::array<double, 2> f;
    rate(p, y, f);
    J[1] = {-v / p.L, -1 / theta};
    J[0] = {(-p.k * v - p.b * p.N * J[1][0] - f[0] * p.c * v) / D, -p.b * p.N * J[1][1] / D};
  }
  static double log_slip_rate(const std::array<double, 2>& y) { return y[0]; }
};

/// (v, θ) as the equations give them.
struct NaturalFault {
  using Setting = Fault;
  static constexpr int size = 2;
  static constexpr const char* name = "v, theta";
  template <class Real>
  static std::array<Real, 2> start(const Fault& p) {
    return {Real(p.first_slip_rate), Real(p.first_age)};
  }
  /// Slip rates and ages below which nothing happens any more.
  static std::array<double, 2> scale(const Fault& p) { return {1e-6 * p.V, 1e-6 * p.L / p.V}; }
  template <class Real>
  static void rate(const Fault& p, const std::array<Real, 2>& y, std::array<Real, 2>& f) {
    const Real v = y[0], theta = y[1];
    const Real theta_rate = 1 - v * theta / p.L;
    f[1] = theta_rate;
    f[0] = v * (p.k * (p.V - v) - p.b * p.N * theta_rate / theta) / (p.a * p.N + p.c * v);
  }
  static void jacobian(const Fault& p, const std::array<double, 2>& y, std::array<std::array<double, 2>, 2>& J) {
    const double v = y[0], theta = y[1], D = p.a * p.N + p.c * v;
    const double growth = (p.k * (p.V - v) - p.b * p.N * (1 / theta - v / p.L)) / D;
    J[0] = {growth + v * (-p.k + p.b * p.N / p.L - growth * p.c) / D, v * p.b * p.N / (theta * theta) / D};
    J[1] = {-theta / p.L, -v / p.L};
  }
  static double log_slip_rate(const std::array<double, 2>& y) { return std::log(y[0]); }
};

}  // namespace bench
