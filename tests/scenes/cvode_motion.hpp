/// The motion of a drawn structure by equations, laws and switches written anew, integrated with CVODE: nothing of
/// rosin is in it.
///
/// A contact under a law that creeps, μ = a asinh(v e^E), has μ for its unknown in place of its slip rate v, whose
/// logarithm falls to −100 as slip comes to rest: μ̇ = (v̇ − ∂v/∂E Ė)/(∂v/∂μ). Time starts anew wherever steps become
/// short beside it, so that a reversal within 1e-30 s is followed.
#pragma once
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/scenes/drawn_structure.hpp"

namespace rosin::tests {

struct CvodeEvent {
  double time;
  std::string kind;
  int contact;         ///< from 1
  double fastest = 0;  ///< slip since the reversal before, of a law that creeps
};

/// A slip of a set-valued contact from its onset to its end.
struct CvodeSlip {
  int contact;
  double onset, duration, slip, peak;
};

struct CvodeMotion {
  std::vector<std::string> names;            ///< of the columns, as rosin's
  std::vector<std::vector<double>> samples;  ///< [sample][column]
  std::vector<double> low, high;             ///< of the columns
  std::vector<CvodeEvent> events;
  std::vector<CvodeSlip> slips;
  std::map<std::string, double> works;  ///< friction_work, stick_time_i
  long steps = 0;
};

class CvodeFollower {
 public:
  CvodeFollower(const DrawnStructure& drawn, double tolerance) : of_(drawn), tolerance_(tolerance) {
    sundials_ = [] {
      SUNContext context;
      SUNContext_Create(nullptr, &context);
      return context;
    }();
    prepare();
  }
  ~CvodeFollower() {
    if (memory_) CVodeFree(&memory_);
    SUNLinSolFree(linear_), SUNMatDestroy(jacobian_), N_VDestroy(y_), N_VDestroy(at_);
    SUNContext_Free(&sundials_);
  }
  CvodeFollower(const CvodeFollower&) = delete;

  CvodeMotion follow();

 private:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 5, 5>;

  struct Contact {
    const DrawnContact* of;
    Vector t;
    int state = -1;      ///< its place among the unknowns
    int mode = 0;        ///< of set-valued contacts and bristles: the sign of slip, 0: at rest
    bool armed = false;  ///< its switch is looked for
    bool bristles = false, creeps = false;
    double mu_s = 0, mu_d = 0, v_s = 0, exponent = 0, viscous = 0, sigma0 = 0, sigma1 = 0, sigma2 = 0;
    double a = 0, b = 0, mu0 = 0, L = 0, v0 = 0, c = 0, t_heal = 0;

    bool set_valued() const { return !bristles && !creeps; }
    double curve(double v) const {  // v ≥ 0
      if (of->law == "coulomb") return mu_d;
      return mu_d + (mu_s - mu_d) * std::exp(-std::pow(std::abs(v) / v_s, exponent)) + viscous * v;
    }
    double exponent_of(double x) const {  // E − ln 2v₀ with v = 2 v₀ e^−E' sinh(μ/a)
      if (of->law == "spinodal") return (mu0 + b * std::log(c + x * (1 + v0 * t_heal / L))) / a;
      return (mu0 + b * (std::log(v0 / L) + x)) / a;
    }
    double exponent_slope(double x) const {
      if (of->law == "spinodal") {
        const double s = 1 + v0 * t_heal / L;
        return b * s / (a * (c + x * s));
      }
      return b / a;
    }
    double creep(double mu, double x) const {
      const double u = mu / a, E = exponent_of(x);
      return v0 * (std::exp(u - E) - std::exp(-u - E));
    }
    double creep_slope(double mu, double x) const {
      const double u = mu / a, E = exponent_of(x);
      return v0 / a * (std::exp(u - E) + std::exp(-u - E));
    }
    double friction(double v, double x) const {  // the inverse of creep
      const double E = exponent_of(x), w = std::abs(v) / (2 * v0);
      const double z = std::log(w) + E;  // asinh(e^z)
      return std::copysign(a * (z > 20 ? z + std::log(2.0) : std::asinh(std::exp(z))), v);
    }
    double state_rate(double v, double x) const {
      const double s = std::abs(v);
      if (bristles) return v - sigma0 * (mode >= 0 ? v : -v) / bristle_curve(v) * x;
      if (of->law == "ageing") return std::exp(-x) - s / L;
      if (of->law == "slip") return s == 0 ? 0 : -s / L * (std::log(s / L) + x);
      return (1 - x) / t_heal - s * x / L;
    }
    double bristle_curve(double v) const { return mu_d + (mu_s - mu_d) * std::exp(-v * v / (v_s * v_s)); }
    double natural(double x) const { return creeps && of->law != "spinodal" ? std::exp(x) : x; }
  };

  /// All that is seen at a moment.
  struct Seen {
    Vector rate, acceleration;                         ///< q̇, q̈
    std::vector<double> v, force, load, v_rate, xdot;  ///< of contacts
  };

  void prepare();
  void see(const double* y, Seen& seen) const;
  int rates(const double* y, double* f) const;
  void roots(const double* y, double* g) const;
  void resolve(double* y, const std::vector<int>& forced);
  void observe(const double* y, std::vector<double>& row);
  void include(const double* y);
  void include_step(double from, double to);
  bool arm(const double* y);
  void begin_slip(int j, const double* y);
  void end_slip(int j, const double* y);

  int n() const { return int(of_.M.rows()); }
  int m() const { return int(contacts_.size()); }
  double clock(const double* y) const { return y[size_ - 1]; }

  const DrawnStructure& of_;
  double tolerance_;
  std::vector<Contact> contacts_;
  Matrix inverse_mass_, from_speeds_, rest_;  ///< M⁻¹; q̇ = from_speeds p; rows beside the contacts' directions
  Matrix C_, K_;
  int size_ = 0;
  mutable Seen seen_;
  CvodeMotion motion_;
  std::vector<double> row_, stuck_since_, fastest_;
  struct Slipping {
    bool on = false;
    double onset, along, peak;
  };
  std::vector<Slipping> slipping_;

  SUNContext sundials_ = nullptr;
  void* memory_ = nullptr;
  N_Vector y_ = nullptr, at_ = nullptr;
  SUNMatrix jacobian_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
};

inline void CvodeFollower::prepare() {
  const int n = this->n();
  int place = 2 * n;
  for (const auto& drawn : of_.contacts) {
    Contact c;
    c.of = &drawn, c.t = drawn.direction;
    c.bristles = drawn.law == "lugre", c.creeps = !drawn.set_valued() && !c.bristles;
    c.mu_s = drawn["mu_s"], c.mu_d = drawn["mu_d"], c.v_s = drawn["v_s"], c.exponent = drawn["exponent"];
    c.viscous = drawn["viscous"], c.sigma0 = drawn["sigma0"], c.sigma1 = drawn["sigma1"], c.sigma2 = drawn["sigma2"];
    c.a = drawn["a"], c.b = drawn["b"], c.mu0 = drawn["mu0"], c.L = drawn["L"], c.v0 = drawn["v0"];
    c.c = drawn["c"], c.t_heal = drawn["t_heal"];
    if (!c.set_valued()) c.state = place++;
    contacts_.push_back(c);
  }
  size_ = place + 2;  // work of friction, time
  inverse_mass_ = of_.M.inverse(), C_ = of_.C, K_ = of_.K;
  Eigen::MatrixXd S(n, n);
  Eigen::MatrixXd T(n, m());
  for (int j = 0; j < m(); ++j) T.col(j) = contacts_[j].t;
  const Eigen::MatrixXd Q = T.householderQr().householderQ();
  S << T.transpose(), Q.rightCols(n - m()).transpose();
  from_speeds_ = S.inverse(), rest_ = S;

  const bool vary = std::ranges::any_of(contacts_, [](const Contact& c) { return !c.set_valued(); });
  y_ = N_VNew_Serial(size_, sundials_), at_ = N_VNew_Serial(size_, sundials_);
  N_VConst(0, y_);
  memory_ = CVodeCreate(vary ? CV_BDF : CV_ADAMS, sundials_);
  CVodeInit(
      memory_,
      [](realtype, N_Vector y, N_Vector f, void* user) {
        return static_cast<CvodeFollower*>(user)->rates(N_VGetArrayPointer(y), N_VGetArrayPointer(f));
      },
      0, y_);
  CVodeSetUserData(memory_, this);
  // An error of μ is one of ln v, a times as large.
  CVodeWFtolerances(memory_, [](N_Vector y, N_Vector weight, void* user) {
    const auto& self = *static_cast<CvodeFollower*>(user);
    for (int i = 0; i < self.size_; ++i)
      NV_Ith_S(weight, i) = 1 / (self.tolerance_ * (std::abs(NV_Ith_S(y, i)) + 1e-2));
    for (int j = 0; j < self.m(); ++j)
      if (self.contacts_[j].creeps) NV_Ith_S(weight, self.n() + j) = 1 / (self.tolerance_ * self.contacts_[j].a);
    return 0;
  });
  jacobian_ = SUNDenseMatrix(size_, size_, sundials_);
  linear_ = SUNLinSol_Dense(y_, jacobian_, sundials_);
  CVodeSetLinearSolver(memory_, linear_, jacobian_);
  // The increments of CVODE's own differences grow with the rates, which are stiff.
  CVodeSetJacFn(memory_, [](realtype, N_Vector y, N_Vector, SUNMatrix J, void* user, N_Vector, N_Vector, N_Vector) {
    auto& self = *static_cast<CvodeFollower*>(user);
    const int size = self.size_;
    double* v = N_VGetArrayPointer(y);
    std::vector<double> up(size), down(size);
    for (int c = 0; c < size; ++c) {
      const int j = c - self.n();
      const bool creeps = j >= 0 && j < self.m() && self.contacts_[j].creeps;
      const double here = v[c], step = 1e-5 * (creeps ? self.contacts_[j].a : std::max(0.1, std::abs(here)));
      v[c] = here + step;
      const int failed = self.rates(v, up.data());
      v[c] = here - step;
      const int failed_too = self.rates(v, down.data());
      v[c] = here;
      if (failed || failed_too) return 1;
      for (int r = 0; r < size; ++r) SM_ELEMENT_D(J, r, c) = (up[r] - down[r]) / (2 * step);
    }
    return 0;
  });
  CVodeRootInit(memory_, m(), [](realtype, N_Vector y, realtype* g, void* user) {
    static_cast<CvodeFollower*>(user)->roots(N_VGetArrayPointer(y), g);
    return 0;
  });
  CVodeSetNoInactiveRootWarn(memory_);
  CVodeSetMaxStep(memory_, 0.01);  // no switch begins and ends within
  // ∂v/∂μ changes by decades within few steps: a correction by that of an earlier step would pass for convergence.
  CVodeSetLSetupFrequency(memory_, 1), CVodeSetJacEvalFrequency(memory_, 1);
  CVodeSetMaxHnilWarns(memory_, -1);
  CVodeSetMaxErrTestFails(memory_, 60);
  CVodeSetMaxConvFails(memory_, 60);
  CVodeSetErrFile(memory_, nullptr);
  slipping_.resize(contacts_.size()), stuck_since_.assign(contacts_.size(), NAN);
  fastest_.assign(contacts_.size(), 0);
}

inline void CvodeFollower::see(const double* y, Seen& s) const {
  const int n = this->n(), m = this->m();
  const double t = clock(y);
  s.v.resize(m), s.force.resize(m), s.load.resize(m), s.v_rate.resize(m), s.xdot.resize(m);
  const Eigen::Map<const Eigen::VectorXd> q(y, n);
  Vector p(n);
  for (int i = 0; i < n; ++i) p[i] = y[n + i];
  for (int j = 0; j < m; ++j) {
    const auto& c = contacts_[j];
    s.v[j] = c.creeps ? c.creep(y[n + j], y[c.state]) : y[n + j];
    s.load[j] = c.of->load.value(t);
    p[j] = c.of->speed.value(t) - s.v[j];
  }
  s.rate = from_speeds_ * p;
  Vector R = -(C_ * s.rate) - K_ * q;
  for (int i = 0; i < n; ++i) R[i] += of_.force[i].value(t);
  int stuck[3], count = 0;
  for (int j = 0; j < m; ++j) {
    const auto& c = contacts_[j];
    s.xdot[j] = c.set_valued() ? 0 : c.state_rate(s.v[j], y[c.state]);
    if (c.set_valued() && c.mode == 0) {
      stuck[count++] = j;
      continue;
    }
    if (c.creeps)
      s.force[j] = s.load[j] * y[n + j];
    else if (c.bristles)
      s.force[j] = s.load[j] * (c.sigma0 * y[c.state] + c.sigma1 * s.xdot[j] + c.sigma2 * s.v[j]);
    else
      s.force[j] = s.load[j] * c.mode * c.curve(c.mode * s.v[j]);
    R += c.t * s.force[j];
  }
  s.acceleration = inverse_mass_ * R;
  if (count > 0) {
    Matrix G(count, count);
    Vector b(count);
    for (int i = 0; i < count; ++i) {
      const auto& c = contacts_[stuck[i]];
      b[i] = c.of->speed.slope(t) - c.t.dot(s.acceleration);
      for (int k = 0; k < count; ++k) G(i, k) = c.t.dot(inverse_mass_ * contacts_[stuck[k]].t);
    }
    const Vector F = G.partialPivLu().solve(b);
    for (int i = 0; i < count; ++i) {
      s.force[stuck[i]] = F[i];
      s.acceleration += inverse_mass_ * contacts_[stuck[i]].t * F[i];
    }
  }
  for (int j = 0; j < m; ++j) {
    const auto& c = contacts_[j];
    s.v_rate[j] = c.set_valued() && c.mode == 0 ? 0 : c.of->speed.slope(t) - c.t.dot(s.acceleration);
  }
}

inline int CvodeFollower::rates(const double* y, double* f) const {
  const int n = this->n();
  auto& s = seen_;
  see(y, s);
  for (int i = 0; i < n; ++i) f[i] = s.rate[i];
  for (int i = m(); i < n; ++i) f[n + i] = rest_.row(i).dot(s.acceleration);
  double work = 0;
  for (int j = 0; j < m(); ++j) {
    const auto& c = contacts_[j];
    work += s.force[j] * s.v[j];
    f[n + j] = s.v_rate[j];
    if (c.state >= 0) f[c.state] = s.xdot[j];
    if (c.creeps) {
      const double mu = y[n + j], x = y[c.state];
      f[n + j] = (s.v_rate[j] + s.v[j] * c.exponent_slope(x) * s.xdot[j]) / c.creep_slope(mu, x);
    }
  }
  f[size_ - 2] = work, f[size_ - 1] = 1;
  for (int i = 0; i < size_; ++i)
    if (!std::isfinite(f[i])) return 1;
  return 0;
}

inline void CvodeFollower::roots(const double* y, double* g) const {
  Seen s;
  bool any_stuck = false;
  for (const auto& c : contacts_) any_stuck |= c.set_valued() && c.mode == 0;
  if (any_stuck) see(y, s);
  for (int j = 0; j < m(); ++j) {
    const auto& c = contacts_[j];
    const double u = y[n() + j];
    if (c.creeps)
      g[j] = u;
    else if (!c.armed)
      g[j] = 1;
    else if (c.mode != 0)
      g[j] = c.mode * u;
    else
      g[j] = 1 - std::abs(s.force[j]) / (c.mu_s * s.load[j]);
  }
}

/// What the set-valued contacts at rest do: those of `forced` are loaded to their limit.
inline void CvodeFollower::resolve(double* y, const std::vector<int>& forced) {
  const auto is_forced = [&](int j) { return std::ranges::find(forced, j) != forced.end(); };
  std::vector<int> at_rest, before(contacts_.size());
  for (int j = 0; j < m(); ++j) {
    before[j] = contacts_[j].mode;
    if (contacts_[j].set_valued() && y[n() + j] == 0) at_rest.push_back(j), contacts_[j].mode = 0;
  }
  std::vector<bool> again(contacts_.size());
  Seen s;
  for (int round = 0; round < 30; ++round) {
    see(y, s);
    // One that accelerates against its slip is held again.
    bool held = false;
    for (const int j : at_rest)
      if (auto& c = contacts_[j]; c.mode != 0 && c.mode * s.v_rate[j] < -1e-7) c.mode = 0, again[j] = held = true;
    if (held) continue;
    int worst = -1;
    double most = 1 + 1e-12;
    for (const int j : at_rest) {
      const auto& c = contacts_[j];
      if (c.mode != 0 || again[j]) continue;
      double part = std::abs(s.force[j]) / (c.mu_s * s.load[j]);
      if (is_forced(j) && part > 1 - 1e-7) part = std::max(part, 1 + 1e-9);
      if (part > most) most = part, worst = j;
    }
    if (worst < 0) return;
    contacts_[worst].mode = s.force[worst] > 0 ? 1 : -1;
  }
  throw std::runtime_error("the contacts at rest come to no decision");
}

inline void CvodeFollower::observe(const double* y, std::vector<double>& row) {
  Seen& s = seen_;
  see(y, s);
  row.clear();
  for (int i = 0; i < n(); ++i) row.push_back(y[i]);
  for (int i = 0; i < n(); ++i) row.push_back(s.rate[i]);
  for (int j = 0; j < m(); ++j) {
    const auto& c = contacts_[j];
    row.push_back(s.v[j]), row.push_back(s.force[j]), row.push_back(s.force[j] / s.load[j]), row.push_back(s.load[j]);
    if (c.state >= 0) row.push_back(c.natural(y[c.state]));
  }
}

inline void CvodeFollower::include(const double* y) {
  observe(y, row_);
  if (motion_.low.empty()) motion_.low = motion_.high = row_;
  for (std::size_t i = 0; i < row_.size(); ++i)
    motion_.low[i] = std::min(motion_.low[i], row_[i]), motion_.high[i] = std::max(motion_.high[i], row_[i]);
  for (int j = 0; j < m(); ++j) {
    fastest_[j] = std::max(fastest_[j], std::abs(seen_.v[j]));
    if (auto& slip = slipping_[j]; slip.on) {
      const double V = contacts_[j].of->speed.mean;
      slip.peak = std::max(slip.peak, std::copysign(1.0, V) * seen_.v[j]);
    }
  }
}

/// Extremes within a step: where five places of the step's polynomial hint at one it is looked for.
inline void CvodeFollower::include_step(double from, double to) {
  std::vector<std::vector<double>> rows(5);
  const auto at = [&](double part) {  // 0 … 4
    CVodeGetDky(memory_, from + (to - from) * part / 4, 0, at_);
    include(N_VGetArrayPointer(at_));
  };
  for (int k = 0; k < 5; ++k) at(k), rows[k] = row_;
  const auto look = [&](std::size_t column, double sign, double best) {
    double v[5];
    for (int k = 0; k < 5; ++k) v[k] = sign * rows[k][column];
    const int k = std::clamp(int(std::max_element(v, v + 5) - v), 1, 3);
    // The parabola through three of them.
    const double bend = v[k - 1] - 2 * v[k] + v[k + 1], slope = (v[k + 1] - v[k - 1]) / 2;
    if (bend >= 0 || std::abs(slope / bend) > 1.1 || !(v[k] - slope * slope / (2 * bend) > best - 1e-7)) return;
    double low = k - 1, high = k + 1;
    constexpr double golden = 0.6180339887498949;
    for (int i = 0; i < 40; ++i) {
      const double a = high - golden * (high - low), b = low + golden * (high - low);
      at(a);
      const double there = sign * row_[column];
      at(b);
      (there > sign * row_[column] ? high : low) = there > sign * row_[column] ? b : a;
    }
  };
  for (std::size_t c = 0; c < row_.size(); ++c) look(c, 1, motion_.high[c]), look(c, -1, -motion_.low[c]);
  for (int j = 0, c = 2 * n(); j < m(); ++j) {
    if (slipping_[j].on) look(std::size_t(c), std::copysign(1.0, contacts_[j].of->speed.mean), slipping_[j].peak);
    c += contacts_[j].state >= 0 ? 5 : 4;
  }
}

/// A switch is looked for as soon as the motion has left the last one. \returns whether bristles have reversed by less.
inline bool CvodeFollower::arm(const double* y) {
  Seen s;
  bool seen = false, reversed = false;
  for (int j = 0; j < m(); ++j) {
    auto& c = contacts_[j];
    if (c.creeps || c.armed) continue;
    double g = c.mode * y[n() + j];
    if (c.mode == 0) {
      if (!seen) see(y, s), seen = true;
      g = 1 - std::abs(s.force[j]) / (c.mu_s * s.load[j]);
    }
    if (g > 1e-9) c.armed = true;
    if (c.bristles && g < -1e-9) {
      c.mode = -c.mode, c.armed = reversed = true;
      motion_.events.push_back({clock(y), "reversal", j + 1});
    }
    if (!c.bristles && g < -1e-7) throw std::runtime_error("a switch just after another was passed over");
  }
  return reversed;
}

inline void CvodeFollower::begin_slip(int j, const double* y) {
  const auto& speed = contacts_[j].of->speed;
  if (!speed.constant() || speed.mean == 0) return;
  const Eigen::Map<const Eigen::VectorXd> q(y, n());
  slipping_[j] = {true, clock(y), contacts_[j].t.dot(q), -INFINITY};
}
inline void CvodeFollower::end_slip(int j, const double* y) {
  auto& slip = slipping_[j];
  if (!slip.on) return;
  const Eigen::Map<const Eigen::VectorXd> q(y, n());
  const double duration = clock(y) - slip.onset;
  motion_.slips.push_back({j + 1, slip.onset, duration,
                           contacts_[j].of->speed.mean * duration + slip.along - contacts_[j].t.dot(q), slip.peak});
  slip.on = false;
}

inline CvodeMotion CvodeFollower::follow() {
  const int n = this->n();
  double* y = N_VGetArrayPointer(y_);
  for (int i = 0; i < n; ++i) y[i] = of_.coordinates[i];
  const Vector p = rest_ * of_.velocities;
  for (int i = m(); i < n; ++i) y[n + i] = p[i];
  std::vector<double> breaks = {of_.duration};
  for (int j = 0; j < m(); ++j) {
    auto& c = contacts_[j];
    double v = c.of->speed.value(0) - p[j];
    if (c.set_valued()) {
      y[n + j] = v, c.mode = v > 0 ? 1 : v < 0 ? -1 : 0;
    } else if (c.bristles) {
      c.mode = v < 0 ? -1 : 1;
      y[n + j] = v, y[c.state] = c.of->state.value_or(std::copysign(c.bristle_curve(v), v) / c.sigma0);
    } else {
      const double s = std::abs(v);
      const double natural = c.of->state.value_or(c.of->law == "spinodal" ? 1 / (1 + s * c.t_heal / c.L) : c.L / s);
      y[c.state] = c.of->law == "spinodal" ? natural : std::log(natural);
      y[n + j] = c.friction(v, y[c.state]);
    }
    for (const auto* signal : {&c.of->speed, &c.of->load})
      if (signal->at < of_.duration) breaks.push_back(signal->at);
  }
  for (const auto& force : of_.force)
    if (force.at < of_.duration) breaks.push_back(force.at);
  breaks.insert(breaks.end(), of_.times.begin(), of_.times.end());
  std::ranges::sort(breaks);

  for (int i = 0; i < n; ++i) motion_.names.push_back(n == 1 ? "displacement" : fmt::format("displacement_{}", i + 1));
  for (int i = 0; i < n; ++i) motion_.names.push_back(n == 1 ? "velocity" : fmt::format("velocity_{}", i + 1));
  for (int j = 0; j < m(); ++j) {
    const auto number = m() == 1 ? "" : fmt::format("_{}", j + 1);
    for (const char* name : {"slip_rate", "friction_force", "friction_coefficient", "normal_load"})
      motion_.names.push_back(name + number);
    if (contacts_[j].state >= 0) motion_.names.push_back(contacts_[j].of->state_name() + number);
  }

  std::vector<double> was_stuck(contacts_.size());
  const auto switched = [&](const std::vector<int>& forced, const std::vector<int>& before) {
    resolve(y, forced);
    for (int j = 0; j < m(); ++j) {
      auto& c = contacts_[j];
      if (!c.set_valued() || c.mode == before[j]) continue;
      c.armed = false;
      const char* kind = c.mode == 0 ? "stick" : before[j] == 0 ? "slip" : "reversal";
      motion_.events.push_back({clock(y), kind, j + 1});
      if (before[j] == 0) motion_.works[fmt::format("stick_time_{}", j + 1)] += clock(y) - stuck_since_[j];
      if (c.mode == 0) stuck_since_[j] = clock(y), end_slip(j, y);
      if (c.mode != 0 && before[j] == 0) begin_slip(j, y);
    }
  };
  for (int j = 0; j < m(); ++j)
    if (contacts_[j].set_valued()) motion_.works[fmt::format("stick_time_{}", j + 1)] = 0;
  resolve(y, {});
  for (int j = 0; j < m(); ++j)
    if (contacts_[j].set_valued() && contacts_[j].mode == 0) stuck_since_[j] = 0;
  include(y);

  std::size_t next_sample = 0;
  double start = 0, reached = 0;  // of local time
  CVodeReInit(memory_, 0, y_);
  const auto restart = [&] {
    start = clock(y), reached = 0;
    CVodeReInit(memory_, 0, y_);
  };
  for (const double stop : breaks) {
    while (stop - start > reached) {
      CVodeSetStopTime(memory_, stop - start);
      realtype tau = reached;
      const int flag = CVode(memory_, stop - start, y_, &tau, CV_ONE_STEP);
      if (flag < 0) throw std::runtime_error(fmt::format("CVODE ends with {} at {} s", flag, clock(y)));
      if (++motion_.steps > 3'000'000) throw std::runtime_error(fmt::format("too many steps at {} s", clock(y)));
      if (tau > reached) include_step(reached, tau);
      reached = tau;
      if (flag == CV_ROOT_RETURN) {
        std::vector<int> found(contacts_.size()), forced, before(contacts_.size());
        CVodeGetRootInfo(memory_, found.data());
        bool changes = false;
        for (int j = 0; j < m(); ++j) before[j] = contacts_[j].mode;
        for (int j = 0; j < m(); ++j) {
          if (!found[j]) continue;
          auto& c = contacts_[j];
          if (c.creeps) {
            motion_.events.push_back({clock(y), "reversal", j + 1, fastest_[j]});
            fastest_[j] = 0;
          } else if (c.bristles) {
            y[n + j] = 0, c.mode = -c.mode, c.armed = false, changes = true;
            motion_.events.push_back({clock(y), "reversal", j + 1});
          } else {
            changes = true;
            if (c.mode != 0)
              y[n + j] = 0;
            else
              forced.push_back(j);
          }
        }
        if (changes) {
          switched(forced, before);
          include(y);
          restart();
        }
      } else {
        realtype h;
        CVodeGetLastStep(memory_, &h);
        if (arm(y) || reached > 1e7 * h) restart();
      }
    }
    y[size_ - 1] = stop;
    bool breaks_here = false;
    for (int j = 0; j < m(); ++j) {
      auto& c = contacts_[j];
      breaks_here |= c.of->load.at == stop;
      if (c.of->speed.at == stop) {
        breaks_here = true;
        double v = (c.creeps ? c.creep(y[n + j], y[c.state]) : y[n + j]) + c.of->speed.jump;
        if (c.creeps)
          y[n + j] = c.friction(v, y[c.state]);
        else
          y[n + j] = v;
        if (c.creeps && v * (v - c.of->speed.jump) < 0)
          motion_.events.push_back({stop, "reversal", j + 1, fastest_[j]});
        if (!c.creeps && v != 0) {
          const int mode = v > 0 ? 1 : -1;
          if (c.mode != mode) motion_.events.push_back({stop, c.mode == 0 ? "slip" : "reversal", j + 1});
          if (c.mode == 0 && c.set_valued())
            motion_.works[fmt::format("stick_time_{}", j + 1)] += stop - stuck_since_[j];
          c.mode = mode, c.armed = false;
        }
      }
    }
    for (const auto& force : of_.force) breaks_here |= force.at == stop;
    if (breaks_here) {
      std::vector<int> before(contacts_.size());
      for (int j = 0; j < m(); ++j) before[j] = contacts_[j].mode;
      switched({}, before);
      include(y);
      restart();
    }
    if (next_sample < of_.times.size() && of_.times[next_sample] == stop) {
      observe(y, row_);
      motion_.samples.push_back(row_), ++next_sample;
    }
  }
  for (int j = 0; j < m(); ++j)
    if (contacts_[j].set_valued() && contacts_[j].mode == 0)
      motion_.works[fmt::format("stick_time_{}", j + 1)] += clock(y) - stuck_since_[j];
  motion_.works["friction_work"] = y[size_ - 2];
  std::ranges::stable_sort(motion_.events, {}, &CvodeEvent::time);
  return motion_;
}

inline CvodeMotion cvode_motion(const DrawnStructure& drawn, double tolerance) {
  return CvodeFollower(drawn, tolerance).follow();
}

}  // namespace rosin::tests
