/// The slider under spinodal friction as a user writes it down for one problem: plain formulas, nothing from rosin.
///
///   v = V − x′,  m v′ = k x − N μ(v, ψ),  λ ψ′ = (1 − ψ)/t_heal − |v| ψ/L
///   μ = a asinh((v/2v₀) e^E),  E = (μ₀ + b ln(c + ψ/ψ*))/a      (Woodhouse, Putelat & McKay 2015, eqs 2.10-2.13)
#pragma once
#include <array>
#include <cmath>
#include <utility>

namespace bench {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

struct Problem {
  double N = 9.81e-4, lambda = 10, V = 1e-5, m = 1, k = 1.09;
  double mu0 = 0.369, a = 0.0349, b = 0.0489, L = 0.9e-6, v0 = 1e-6, c = 1e-3, t_heal = 90;
  double psi_ref = L / (L + v0 * t_heal);

  double exponent(double psi) const { return (mu0 + b * std::log(c + psi / psi_ref)) / a; }
  double friction(double v, double psi) const { return a * std::asinh(v / (2 * v0) * std::exp(exponent(psi))); }
  double steady_state(double v) const { return L / (L + std::abs(v) * t_heal); }
  double steady_friction(double v) const { return friction(v, steady_state(v)); }
  /// No passage takes longer than a few natural periods and loadings of the spring to the friction force.
  double longest_passage() const { return 10 * (2 * M_PI * std::sqrt(m / k) + N / (k * V)); }
};

/// What a measurement needs of one instant.
struct Seen {
  double v, v_rate, mu;
};

/// The state as the equations give it: (x, v, ψ).
struct Natural {
  using Setting = Problem;
  static constexpr int size = 3;
  static constexpr const char* name = "x, v, psi";
  static Vector start(const Problem&, double x, double v, double psi) { return {x, v, psi}; }
  /// Sizes below which a variable no longer matters; the absolute tolerance is the relative one times these.
  static Vector scale(const Problem& p) { return {p.N * p.a / p.k, p.V, p.c * p.psi_ref}; }
  static double slip_rate(const Problem&, const Vector& y) { return y[1]; }
  /// (x, ψ), which say where on the section v = V a motion passes.
  static std::pair<double, double> section_point(const Vector& y) { return {y[0], y[2]}; }

  static void rate(const Problem& p, const Vector& y, Vector& f) {
    const auto [x, v, psi] = y;
    f[0] = p.V - v;
    f[1] = (p.k * x - p.N * p.friction(v, psi)) / p.m;
    f[2] = ((1 - psi) / p.t_heal - std::abs(v) * psi / p.L) / p.lambda;
  }
  static void jacobian(const Problem& p, const Vector& y, Matrix& J) {
    const auto [x, v, psi] = y;
    const double w = 2 * p.v0 * std::exp(-p.exponent(psi)), root = std::hypot(v, w);
    const double mu_v = p.a / root;
    const double mu_psi = v / root * p.b / (p.c * p.psi_ref + psi);
    J[0] = {0, -1, 0};
    J[1] = {p.k / p.m, -p.N * mu_v / p.m, -p.N * mu_psi / p.m};
    J[2] = {0, -std::copysign(psi / p.L, v) / p.lambda, (-1 / p.t_heal - std::abs(v) / p.L) / p.lambda};
  }
  static Seen seen(const Problem& p, const Vector& y, const Vector& rate) {
    return {y[1], rate[1], p.friction(y[1], y[2])};
  }
};

/// Variables in which nothing cancels in near-stick and ψ stays positive: (x, p = μ/a, q = ln ψ), v = 2v₀ e^−E(q) sinh
/// p.
struct Good {
  using Setting = Problem;
  static constexpr int size = 3;
  static constexpr const char* name = "x, mu/a, ln psi";
  static Vector start(const Problem& p, double x, double v, double psi) {
    return {x, p.friction(v, psi) / p.a, std::log(psi)};
  }
  static Vector scale(const Problem& p) { return {p.N * p.a / p.k, 1, 1}; }
  static std::pair<double, double> section_point(const Vector& y) { return {y[0], std::exp(y[2])}; }
  struct Terms {
    double psi, w, sinh_p, cosh_p, tanh_p, v, s, E_q, balance, q_rate;
  };
  static Terms terms(const Problem& p, const Vector& y) {
    Terms t;
    t.psi = std::exp(y[2]);
    t.w = 2 * p.v0 * std::exp(-p.exponent(t.psi));
    t.sinh_p = std::sinh(y[1]);
    t.cosh_p = std::cosh(y[1]);
    t.tanh_p = t.sinh_p / t.cosh_p;
    t.v = t.w * t.sinh_p;
    t.s = t.psi / (p.c * p.psi_ref + t.psi);
    t.E_q = p.b / p.a * t.s;                                               // dE/dq
    t.balance = (p.k * y[0] - p.N * p.a * y[1]) / (p.m * t.w * t.cosh_p);  // v′ / (∂v/∂p)
    t.q_rate = ((1 / t.psi - 1) / p.t_heal - std::abs(t.v) / p.L) / p.lambda;
    return t;
  }
  static double slip_rate(const Problem& p, const Vector& y) {
    return 2 * p.v0 * std::exp(-p.exponent(std::exp(y[2]))) * std::sinh(y[1]);
  }
  static void rate(const Problem& p, const Vector& y, Vector& f) {
    const Terms t = terms(p, y);
    f = {p.V - t.v, t.balance + t.tanh_p * t.E_q * t.q_rate, t.q_rate};
  }
  static void jacobian(const Problem& p, const Vector& y, Matrix& J) {
    const Terms t = terms(p, y);
    const double v_p = t.w * t.cosh_p, v_q = -t.E_q * t.v, E_qq = t.E_q * (1 - t.s);
    const double rate_p = -std::copysign(v_p / p.L, t.v) / p.lambda;
    const double rate_q = (-1 / (t.psi * p.t_heal) + t.E_q * std::abs(t.v) / p.L) / p.lambda;
    J[0] = {0, -v_p, -v_q};
    J[1] = {p.k / (p.m * v_p),
            -p.N * p.a / (p.m * v_p) - t.balance * t.tanh_p +
                t.E_q * (t.q_rate / (t.cosh_p * t.cosh_p) + t.tanh_p * rate_p),
            t.balance * t.E_q + t.tanh_p * (E_qq * t.q_rate + t.E_q * rate_q)};
    J[2] = {0, rate_p, rate_q};
  }
  static Seen seen(const Problem& p, const Vector& y, const Vector& rate) {
    const Terms t = terms(p, y);
    return {t.v, t.w * t.cosh_p * rate[1] - t.E_q * t.v * rate[2], p.a * y[1]};
  }
};

}  // namespace bench
