/// The vector form of a contact, and its slopes.
#include "solvers/stick_slip/plane_contact.hpp"

#include <algorithm>
#include <cmath>

namespace rosin::solvers::stick_slip {

namespace {

constexpr int most = Slopes<double>::capacity;

/// The contact along a line.
struct Along {
  double g[most], F;
  Slopes<double> slopes;
};

/// A vector of the length f(a, b) along the vector `a`: its factor f/a, and the slopes of f and of the factor.
struct Radial {
  double factor, by_own, bend;  ///< f/a, ∂f/∂a, (∂f/∂a − f/a)

  /// \param slope  ∂f/∂a; \param at_zero  the same at a = 0; \param tiny  below it rounding would decide f/a
  Radial(double f, double a, double slope, double at_zero, double tiny)
      : factor(a > tiny ? f / a : at_zero), by_own(a > tiny ? slope : at_zero), bend(by_own - factor) {}
};

}  // namespace

PlaneContact::PlaneContact(PlaneFriction friction, double slip_rate, double load)
    : friction_(std::move(friction)), along_(friction_.contact->unknowns()) {
  double z[most], weight[most];
  std::fill(weight, weight + most, 1.0);
  friction_.contact->steady(0, slip_rate, load, z, weight);
  if (friction_.creep > 0) {
    constexpr double slower = 1e-3, least = 1e-3;
    double fast, slow;
    friction_.contact->steady_friction(slip_rate, load, fast);
    friction_.contact->steady_friction(slower * slip_rate, load, slow);
    creep_ = friction_.creep * slip_rate / std::max({std::abs(fast), std::abs(slow), least});
  }
  for (int i = 0, to = 0; i < along_; ++i) {
    weight_[to++] = weight[i];
    if (i == friction_.turning) weight_[to++] = weight[i];
  }
}

void PlaneContact::mass(double load, double* m) const {
  double along[most];
  friction_.contact->mass(load, along);
  for (int i = 0; i < along_; ++i) {
    *m++ = along[i];
    if (i == friction_.turning) *m++ = along[i];
  }
}

void PlaneContact::evaluate(const PlaneVector& u, double load, const double* z, double* g, PlaneVector& F,
                            PlaneSlopes* slopes) const {
  const auto& contact = *friction_.contact;
  const int k = friction_.turning, n = along_;
  const bool turns = k >= 0;
  // Places of the contact's unknowns in the plane: behind the turning one by one more.
  const auto place = [&](int i) { return i + (turns && i > k ? 1 : 0); };
  const double s = std::hypot(u[0], u[1]), zeta = turns ? std::hypot(z[k], z[k + 1]) : 0;
  const PlaneVector to_u = {s > 0 ? u[0] / s : 0, s > 0 ? u[1] / s : 0};
  const PlaneVector to_z = {zeta > 0 ? z[k] / zeta : 0, zeta > 0 ? z[k + 1] / zeta : 0};

  double line[most];
  for (int i = 0; i < n; ++i) line[i] = z[place(i)];
  Along at, without, still;  // with ζ; at ζ = 0; and at u = 0 with ζ = 0
  const auto ask = [&](double slip_rate, double turning, Along& answer) {
    if (turns) line[k] = turning;
    contact.linearise({slip_rate, load, 0, 1}, line, answer.g, answer.F, answer.slopes);
  };
  ask(s, zeta, at);
  if (turns)
    ask(s, 0, without);
  else
    without = at;
  constexpr double slowest = 1e-300;
  if (s > slowest)
    still = without;
  else
    ask(0, 0, still);
  constexpr double small = 1e-9;  // of the size of ζ
  const double least = turns ? small * weight_[k] : 0;

  for (int i = 0; i < n; ++i)
    if (i != k) g[place(i)] = at.g[i];
  const Radial F_slip(without.F, s, without.slopes.F_u, still.slopes.F_u, slowest);
  for (int d = 0; d < 2; ++d) F[d] = F_slip.factor * u[d];
  Radial F_turning(0, 0, 0, 0, 0), g_slip = F_turning, g_turning = F_turning;
  if (turns) {
    F_turning = Radial(at.F - without.F, zeta, at.slopes.F_z[k], without.slopes.F_z[k], least);
    g_slip = Radial(without.g[k], s, without.slopes.g_u[k], still.slopes.g_u[k], slowest);
    g_turning = Radial(at.g[k] - without.g[k], zeta, at.slopes.g_z[k * n + k], without.slopes.g_z[k * n + k], least);
    for (int d = 0; d < 2; ++d) {
      F[d] += F_turning.factor * z[k + d];
      g[k + d] = g_slip.factor * u[d] + (g_turning.factor - creep_) * z[k + d];
    }
  }
  if (!slopes) return;

  auto& S = *slopes;
  const auto radial = [](const Radial& of, const PlaneVector& e, int a, int b) {
    return (a == b ? of.factor : 0) + of.bend * e[a] * e[b];
  };
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) S.F_u[a][b] = radial(F_slip, to_u, a, b);
  for (int i = 0; i < n; ++i) {
    if (i == k) continue;
    const int row = place(i);
    for (int b = 0; b < 2; ++b) {
      S.g_u[row][b] = at.slopes.g_u[i] * to_u[b];
      if (turns) S.g_z[row][k + b] = at.slopes.g_z[i * n + k] * to_z[b];
    }
    for (int j = 0; j < n; ++j)
      if (j != k) S.g_z[row][place(j)] = at.slopes.g_z[i * n + j];
    for (int a = 0; a < 2; ++a)
      S.F_z[a][row] = without.slopes.F_z[i] * to_u[a] + (at.slopes.F_z[i] - without.slopes.F_z[i]) * to_z[a];
  }
  if (!turns) return;
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      S.F_u[a][b] += (at.slopes.F_u - without.slopes.F_u) * to_z[a] * to_u[b];
      S.F_z[a][k + b] = radial(F_turning, to_z, a, b);
      S.g_u[k + a][b] = radial(g_slip, to_u, a, b) + (at.slopes.g_u[k] - without.slopes.g_u[k]) * to_z[a] * to_u[b];
      S.g_z[k + a][k + b] = radial(g_turning, to_z, a, b) - (a == b ? creep_ : 0);
    }
    for (int j = 0; j < n; ++j)
      if (j != k)
        S.g_z[k + a][place(j)] = without.slopes.g_z[k * n + j] * to_u[a] +
                                 (at.slopes.g_z[k * n + j] - without.slopes.g_z[k * n + j]) * to_z[a];
  }
}

}  // namespace rosin::solvers::stick_slip
