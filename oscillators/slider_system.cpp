/// Assembly of the slider: right-hand side, Jacobian, masses, starts and observed quantities.
#include "oscillators/slider_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>

#include "core/instruction_set.hpp"
#include "core/tower.hpp"
#include "laws/regions.hpp"

namespace rosin::oscillators {

namespace {
Mechanics mechanics_of(const Slider& slider) {
  if (slider.mass > 0) return Mechanics::inertial;
  return slider.damping > 0 ? Mechanics::damped : Mechanics::elastic;
}

double compliance_at(const SeriesSpring& spring, double N) {
  return spring.compliance + spring.compliance_per_load / N;
}

constexpr double nearly_stuck = 1e-6;  ///< over the reference speed; below it the slip rate follows from friction

/// Without load neither the contact nor a spring in series with it carries a force.
Model checked(Model model) {
  model.check();
  if (model.law->set_valued() && model.contact_stiffness.present())
    throw InputError(
        fmt::format("law '{}' behind a contact spring is the contact of a structure, of one coordinate for a slider "
                    "(oscillators::one_slider)",
                    model.law->card().name));
  if (laws::region_width(*model.law) > 0)
    throw InputError(
        "solver.smoothing.type = 'multi-region' needs the force that would hold the contact, which a structure knows, "
        "of "
        "one coordinate for a slider (oscillators::one_slider)");
  if (const auto& load = model.drive.normal_load; load.constant() && load.level() == 0) model.contact_stiffness = {};
  return model;
}
}  // namespace

SliderSystem::SliderSystem(Model model, Unknowns unknowns)
    : model_(checked(std::move(model))),
      mechanics_(mechanics_of(model_.slider)),
      rows_(model_.law, model_.lambda, model_.load_memory, model_.contact_stiffness, unknowns,
            mechanics_ == Mechanics::elastic ? 1 / model_.slider.stiffness : 0, mechanics_ != Mechanics::damped) {
  const auto& law = *model_.law;
  mechanical_ = mechanics_ == Mechanics::inertial ? 2 : mechanics_ == Mechanics::damped ? 1 : 0;
  tower_ = law.tower(rows_.setup);
  set_valued_ = law.set_valued();
  if (std::isinf(model_.slider.stiffness))
    mode_ = model_.drive.speed.value(0) < 0 ? ContactMode::backward : ContactMode::forward;
  is_constant_ = model_.drive.constant();
  if (is_constant_) {
    const auto& d = model_.drive;
    constant_ = {d.speed.level(), 0, d.normal_load.level(), 0, d.force.level(), 0};
    constant_in_lanes_ = LaneForcing(constant_);
  }
  // A flow needs rates of the states, no inertia (which is stiff in near-stick), and a spring that balances the force.
  state_clock_ = 1 / rows_.setup.lambda;
  const bool flows =
      carries_friction() && rows_.setup.lambda > 0 && !rows_.setup.spring.present() && rows_.setup.load_memory == 0 &&
      (mechanics_ == Mechanics::damped ? rigid() && model_.slider.stiffness > 0 && model_.drive.normal_load.constant()
                                       : mechanics_ == Mechanics::elastic && !rigid());
  if (flows) flow_ = law.flow();
  const Forcing start = forcing(0);
  reference_speed_ = std::max(std::abs(start.speed), std::abs(model_.drive.speed.level()));
  if (reference_speed_ == 0) reference_speed_ = 1e-9;
  rows_.weigh(reference_speed_, start.load, mechanics_ == Mechanics::inertial);
  rows_.require_slip_rate(reference_speed_, start.load,
                          mechanics_ == Mechanics::elastic ? " and the slider a mass" : "");
  const double friction_scale = carries_friction() ? rows_.weight[0] : 0.1;
  const auto& s = model_.slider;
  if (const double impedance = std::sqrt(s.stiffness * s.mass), V = std::abs(start.speed);
      set_valued_ && is_constant_ && V > 0 && std::isfinite(impedance)) {
    constexpr double weak = 1, light = 0.01;
    swings_freely_ = start.load < weak * V * impedance && s.damping < light * impedance;
    if (swings_freely_) {
      steady_coefficient_ = law.steady_friction({start.speed, start.load}).friction;
      swing_center_ = (start.load * steady_coefficient_ + start.force) / s.stiffness;
    }
  }
  displacement_scale_ =
      mechanics_ == Mechanics::inertial && s.stiffness > 0
          ? reference_speed_ * std::sqrt(s.mass / s.stiffness) + start.load * friction_scale / s.stiffness
      : s.stiffness > 0 ? std::max(start.load, 1e-300) * friction_scale / s.stiffness
                        : reference_speed_;
}

/// From m ẍ = F + f − k x − c ẋ, with ξ from steady sliding at F₀: d(ξ² + m ẋ²/k)/dt = 2 ((F − F₀) ẋ − c ẋ²)/k, and at
/// rest ẋ is the drive's speed.
double SliderSystem::swing_power(double t, const double* y) const {
  const auto& s = model_.slider;
  const double velocity = constant_.speed - y[1];
  const double friction = constant_.load * (friction_coefficient(t, y) - steady_coefficient_);
  return 2 * velocity * (friction - s.damping * velocity) / s.stiffness;
}

void SliderSystem::limit_creep_for(double duration) {
  constexpr double share = 1e-12;
  if (rows_.creep > 0 && duration > 0)
    rows_.creep = std::min(rows_.creep, share * duration * model_.drive.normal_load.level() / model_.slider.mass);
}

SliderSystem::Forcing SliderSystem::forcing(double t) const {
  if (is_constant_) return constant_;
  const auto& d = model_.drive;
  return {d.speed.value(t),      d.speed.rate(t),  d.normal_load.value(t),
          d.normal_load.rate(t), d.force.value(t), d.force.rate(t)};
}

void SliderSystem::mass(double t, double* m) const {
  const Forcing now = forcing(t);
  if (mechanical_ > 0) m[0] = 1;
  if (mechanical_ > 1) m[1] = model_.slider.mass;
  rows_.contact->mass(now.load, m + mechanical_);
}

double SliderSystem::imposed_slip_rate(const Forcing& now, const double* y, double F) const {
  switch (mechanics_) {
    case Mechanics::inertial:
      return y[1];
    case Mechanics::damped:
      return now.speed -
             ((F - origin_.friction) + (now.force - origin_.force) - model_.slider.stiffness * y[0] + origin_.drag) /
                 model_.slider.damping;
    case Mechanics::elastic:
      return now.speed - now.force_rate / model_.slider.stiffness;
  }
  return 0;
}

double SliderSystem::momentum_rate(const Forcing& now, double x, double u, double F) const {
  const auto& s = model_.slider;
  return s.mass * now.speed_rate + s.stiffness * x + (s.damping * (now.speed - u) - origin_.drag) -
         (F - origin_.friction) - (now.force - origin_.force);
}

void SliderSystem::measure_from_balance(std::vector<double>& y) {
  if (mechanical_ == 0) return;
  const Forcing now = forcing(0);
  const auto& s = model_.slider;
  const double known_force = mechanics_ == Mechanics::damped ? now.load * y[mechanical_] : 0;
  const double u = imposed_slip_rate(now, y.data(), known_force);
  double F = known_force, g[Slopes<double>::capacity];
  if (mechanics_ == Mechanics::inertial)
    rows_.contact->evaluate({u, now.load, now.load_rate, u < 0 ? -1.0 : 1.0}, y.data() + mechanical_, g, F);
  const double spring = s.stiffness * y[0], drag = s.damping * (now.speed - u);
  constexpr double rounding = 1e-13;
  const double size = std::abs(spring) + std::abs(drag) + std::abs(F) + std::abs(now.force);
  if (u == 0 || !(std::abs(spring + drag - F - now.force) <= rounding * size)) return;
  origin_ = {y[0], F, now.force, drag};
  swing_center_ -= y[0];
  y[0] = 0;
}

void SliderSystem::evaluate(double t, const double* y, double* f) const {
  const Forcing now = forcing(t);
  const double* z = y + mechanical_;
  if (sticking()) {  // the slider moves with the drive; the contact may age
    double unused;
    rows_.contact->evaluate({0, now.load, now.load_rate, sign(mode_)}, z, f + mechanical_, unused);
    f[0] = now.speed;
    f[1] = 0;
    return;
  }
  const double known_force = mechanics_ == Mechanics::damped ? now.load * z[0] : 0;
  const double u = imposed_slip_rate(now, y, known_force);
  double F;
  rows_.contact->evaluate({u, now.load, now.load_rate, sign(mode_)}, z, f + mechanical_, F);
  if (rows_.creep > 0) f[mechanical_] -= rows_.creep * z[0];
  if (mechanical_ > 0) f[0] = now.speed - u;
  if (mechanics_ == Mechanics::inertial) f[1] = momentum_rate(now, y[0], u, F);
}

void SliderSystem::linearise(double t, const double* y, double* f, double* jacobian) const {
  const Forcing now = forcing(t);
  const int n = size(), nz = rows_.contact->unknowns(), first = mechanical_;
  const double* z = y + first;
  const double known_force = mechanics_ == Mechanics::damped ? now.load * z[0] : 0;
  const double u = sticking() ? 0 : imposed_slip_rate(now, y, known_force);
  const auto& s = model_.slider;
  double F;
  Slopes<double> slopes;
  rows_.contact->linearise({u, now.load, now.load_rate, sign(mode_)}, z, f + first, F, slopes);
  std::fill(jacobian, jacobian + n * n, 0.0);
  const auto J = [&](int i, int j) -> double& { return jacobian[i * n + j]; };
  for (int i = 0; i < nz; ++i)
    for (int j = 0; j < nz; ++j) J(first + i, first + j) = slopes.g_z[i * nz + j];
  if (sticking()) {
    f[0] = now.speed;
    f[1] = 0;
    return;
  }
  if (rows_.creep > 0) {
    f[first] -= rows_.creep * z[0];
    J(first, first) -= rows_.creep;
  }
  if (mechanics_ == Mechanics::inertial) {
    f[0] = now.speed - u;
    f[1] = momentum_rate(now, y[0], u, F);
    couple_by_inertia(s, slopes, nz, jacobian);
  } else if (mechanics_ == Mechanics::damped) {
    // u = V − (N μ + f − k x)/c
    const double u_x = s.stiffness / s.damping, u_mu = -now.load / s.damping;
    f[0] = now.speed - u;
    J(0, 0) = -u_x;
    J(0, 1) = -u_mu;
    for (int i = 0; i < nz; ++i) {
      J(first + i, 0) = slopes.g_u[i] * u_x;
      J(first + i, first) += slopes.g_u[i] * u_mu;
    }
  }
}

void couple_by_inertia(const Slider& slider, const Slopes<double>& contact, int contact_unknowns, double* jacobian) {
  constexpr int first = 2;
  const int n = first + contact_unknowns;
  const auto J = [&](int i, int j) -> double& { return jacobian[i * n + j]; };
  J(0, 1) = -1;
  J(1, 0) = slider.stiffness;
  J(1, 1) = -slider.damping - contact.F_u;
  for (int j = 0; j < contact_unknowns; ++j) {
    J(1, first + j) = -contact.F_z[j];
    J(first + j, 1) = contact.g_u[j];
  }
}

void SliderSystem::flow(const Pack& t, const Pack* y, Pack* rate, Pack& pace) const {
  constexpr int most = Slopes<double>::capacity;
  LaneForcing changing;
  if (!is_constant_)
    for (int lane = 0; lane < pack_width; ++lane) changing.set(lane, forcing(t.block[lane]));
  const LaneForcing& now = is_constant_ ? constant_in_lanes_ : changing;
  const auto& s = model_.slider;
  const int nz = flow_->unknowns();
  const Pack* z = y + mechanical_;
  Pack* z_rate = rate + mechanical_;
  // The slip rate comes from the law: in creep it is far below rounding error of V − (N μ + f − k x)/c.
  Pack v, v_z[most], g_z[most * most];
  flow_->slip(now.load, z, v, z_rate + 1, v_z, g_z);
  run_on_lanes([&] {
    Pack v_rate = 0.0;  // rate of v by the change of the states
    Pack turnover = 0.0;
    const double a = direct_effect();
    for (int i = 1; i < nz; ++i) {
      z_rate[i] = z_rate[i] * state_clock_;
      v_rate = v_rate + v_z[i] * z_rate[i];
      const Pack* slopes = g_z + (i - 1) * nz;
      Pack sum = slopes[0] * slopes[0] * (a * a);
      for (int j = 1; j < nz; ++j) sum = sum + slopes[j] * slopes[j];
      turnover = turnover + z_rate[i] * z_rate[i] + sum * (state_clock_ * state_clock_);
    }
    // The pace, at which states change and respond, is smooth and never zero while the contact slips or heals.
    pace = sqrt(turnover);
    if (mechanics_ == Mechanics::damped) {
      // k x = N μ + f − c (V − v), differentiated.
      rate[0] = now.speed - v;
      z_rate[0] =
          (s.stiffness * rate[0] - now.load_rate * z[0] - now.force_rate + s.damping * (now.speed_rate - v_rate)) /
          (now.load + s.damping * v_z[0]);
    } else {
      const Pack u = now.speed - now.force_rate * (1 / s.stiffness);
      z_rate[0] = (u - v - rows_.setup.compliance * z[0] * now.load_rate) /
                  (now.load * rows_.setup.compliance + rows_.setup.compliance_per_load);
    }
  });
}

void SliderSystem::restore(double t, double* y) const {
  if (mechanics_ != Mechanics::damped) return;
  const Forcing now = forcing(t);
  const auto& s = model_.slider;
  const double v = slip_rate(t, y), friction = now.load * y[1];
  const double balanced =
      ((friction - origin_.friction) + (now.force - origin_.force) - (s.damping * (now.speed - v) - origin_.drag)) /
      s.stiffness;
  // Under a strong damper the spring force is a small difference of large forces: within their rounding error
  // integration gives the better value.
  constexpr double digits = 4 * std::numeric_limits<double>::epsilon();
  const double slip = std::abs(v * y[1]) / direct_effect() + std::abs(now.speed);  // ∂v/∂μ = v/a
  const double known = digits * (std::abs(friction) + std::abs(now.force) + s.damping * slip) / s.stiffness;
  if (!(std::abs(balanced - y[0]) <= known)) y[0] = balanced;
}

void SliderSystem::expand(double t, const double* y, const double* direction, double* second, double* third) const {
  const Forcing now = forcing(t);
  const int nz = rows_.contact->unknowns();
  const double u = imposed_slip_rate(now, y, mechanics_ == Mechanics::damped ? now.load * y[mechanical_] : 0);
  const double u_d = mechanics_ == Mechanics::inertial ? direction[1]
                     : mechanics_ == Mechanics::damped
                         ? (model_.slider.stiffness * direction[0] - now.load * direction[1]) / model_.slider.damping
                         : 0.0;
  Tower z[Slopes<double>::capacity], g[Slopes<double>::capacity], F;
  for (int i = 0; i < nz; ++i) z[i] = along(y[mechanical_ + i], direction[mechanical_ + i]);
  tower_->evaluate({along(u, u_d), Tower(now.load), Tower(now.load_rate), sign(mode_)}, z, g, F);
  std::fill(second, second + size(), 0.0);
  std::fill(third, third + size(), 0.0);
  const auto curvature = [](const Tower& f) { return f.slope[0].slope[0].value; };
  const auto jerk = [](const Tower& f) { return f.slope[0].slope[0].slope[0]; };
  for (int i = 0; i < nz; ++i) {
    second[mechanical_ + i] = curvature(g[i]);
    third[mechanical_ + i] = jerk(g[i]);
  }
  if (mechanics_ == Mechanics::inertial) {  // everything else in the mechanics is linear
    second[1] = -curvature(F);
    third[1] = -jerk(F);
  }
}

void SliderSystem::slip_rate_gradient(double t, const double* y, double* gradient) const {
  std::fill(gradient, gradient + size(), 0.0);
  if (contact_slip_rate_index() >= 0) {
    gradient[contact_slip_rate_index()] = 1;
  } else if (rows_.setup.spring.present()) {
    // v = u − ė.
    std::vector<double> f(size()), J(size() * size());
    linearise(t, y, f.data(), J.data());
    for (int j = 0; j < size(); ++j) gradient[j] = -J[(size() - 1) * size() + j];
    if (mechanics_ == Mechanics::inertial) {
      gradient[1] += 1;
    } else if (mechanics_ == Mechanics::damped) {
      gradient[0] += model_.slider.stiffness / model_.slider.damping;
      gradient[1] -= forcing(t).load / model_.slider.damping;
    }
  } else if (mechanics_ == Mechanics::inertial && rigid()) {
    gradient[1] = 1;
  } else if (mechanics_ == Mechanics::damped && rigid()) {
    gradient[0] = model_.slider.stiffness / model_.slider.damping;
    gradient[1] = -forcing(t).load / model_.slider.damping;
  } else if (carries_friction()) {
    // g₀ = u − v(μ, ψ) at a steady load.
    std::vector<double> f(size()), J(size() * size());
    linearise(t, y, f.data(), J.data());
    const int row = mechanical_;
    for (int j = mechanical_; j < size(); ++j) gradient[j] = -J[row * size() + j];
    if (mechanics_ == Mechanics::damped) gradient[mechanical_] -= forcing(t).load / model_.slider.damping;
  }
}

void SliderSystem::scale(const double* y, double* s) const {
  if (mechanical_ > 0) s[0] = displacement_scale_;
  if (model_.slider.stiffness == 0 &&
      mechanical_ > 0)  // no force depends on the displacement of a slider without spring
    s[0] = std::max(displacement_scale_, std::abs(y[0]));
  if (mechanical_ > 1) s[1] = std::max(reference_speed_, std::abs(y[1]));
  rows_.scale(y + mechanical_, s + mechanical_);
  if (const int v = contact_slip_rate_index(); v >= 0) s[v] = std::max(reference_speed_, std::abs(y[v]));
}

void SliderSystem::relevance_scale(double* s) const {
  const std::vector<double> rest(size());
  scale(rest.data(), s);
  if (!carries_friction()) return;
  double slopes[Slopes<double>::capacity];
  rows_.contact->friction_slopes(0, reference_speed_, constant_.load, slopes);
  for (int i = 0; i < rows_.states; ++i) {
    double& scale = s[first_state() + i];
    scale = std::clamp(s[mechanical_] / std::abs(slopes[i]), scale, 10 * scale);
  }
}

std::string SliderSystem::unknown(int i) const {
  if (i < mechanical_) return i == 0 ? "displacement" : "slip rate";
  return rows_.unknown(i - mechanical_);
}

double SliderSystem::next_break(double t) const {
  const auto& d = model_.drive;
  return std::min({d.speed.next_break(t), d.normal_load.next_break(t), d.force.next_break(t)});
}

double SliderSystem::resolution() const {
  const auto& d = model_.drive;
  return std::min({d.speed.resolution(), d.normal_load.resolution(), d.force.resolution()});
}

std::vector<double> SliderSystem::unknowns_at(double t, double x, double u, std::span<const double> state,
                                              double friction) const {
  const Forcing now = forcing(t);
  const auto& law = *model_.law;
  std::vector<double> y;
  if (mechanical_ > 0) y.push_back(x);
  if (mechanical_ > 1) y.push_back(u);
  if (carries_friction()) {
    if (rigid() && mechanics_ != Mechanics::damped)
      y.push_back(law.friction({u, now.load}, state));
    else
      y.push_back(friction / now.load);
  }
  y.resize(size());
  if (rows_.states > 0) rows_.write_states(state, y.data() + mechanical_);
  if (rows_.setup.spring.present()) {
    // While the contact spring does not stretch, the contact slips at the slider's rate.
    const double N = std::max(now.load, 1e-300);
    y.back() = friction * compliance_at(rows_.setup.spring, N);
    if (const int v = contact_slip_rate_index(); v >= 0) y[v] = u;
    settle(t, y.data());
  }
  return y;
}

/// Solves the algebraic row of a contact behind a spring, for friction or for the contact's own slip rate. The unknown
/// keeps its value where that is a solution to rounding error, or where no solution is near.
void SliderSystem::settle(double t, double* y) const {
  const int n = size(), row = carries_friction() ? mechanical_ : contact_slip_rate_index();
  std::vector<double> m(n), f(n), jacobian(n * n);
  mass(t, m.data());
  if (m[row] != 0) return;
  double& x = y[row];
  const double start = x, size_of_x = std::max(rows_.weight[row - mechanical_], std::abs(start));
  constexpr double close = 1e-10, rounding = 1e-14;
  linearise(t, y, f.data(), jacobian.data());
  double allowed = close * size_of_x * std::abs(jacobian[row * n + row]);
  for (int j = 0; j < n; ++j) allowed += rounding * std::abs(jacobian[row * n + j] * y[j]);
  if (std::abs(f[row]) <= allowed) return;
  const auto residual = [&](double trial) {  // decreases with x
    x = trial;
    evaluate(t, y, f.data());
    return f[row];
  };
  const double here = residual(start);
  if (here == 0 || !std::isfinite(here)) {
    x = start;
    return;
  }
  double step = 1e-3 * size_of_x;
  double near = start, far = start, at_near = here, at_far = here;
  for (int i = 0; i < 60 && at_near * at_far > 0; ++i, step *= 2) {
    near = far, at_near = at_far;
    far += here > 0 ? step : -step;
    at_far = residual(far);
  }
  if (!(at_near * at_far <= 0)) {
    x = start;
    return;
  }
  std::uintmax_t iterations = 200;
  const auto [a, b] =
      far > near ? boost::math::tools::toms748_solve(residual, near, far, at_near, at_far,
                                                     boost::math::tools::eps_tolerance<double>(52), iterations)
                 : boost::math::tools::toms748_solve(residual, far, near, at_far, at_near,
                                                     boost::math::tools::eps_tolerance<double>(52), iterations);
  x = 0.5 * (a + b);
}

std::vector<double> SliderSystem::steady(double t) const {
  const Forcing now = forcing(t);
  const auto& law = *model_.law;
  const auto state = law.steady({now.speed, now.load});
  const double F = now.load * law.steady_friction({now.speed, now.load}).friction;
  const double k = model_.slider.stiffness;
  if (k == 0 && F + now.force != 0)
    throw InputError("oscillator.stiffness = 0: without a spring the slider has no steady sliding (stiffness, N/m)");
  return unknowns_at(t, k == 0 ? 0 : (F + now.force) / k, now.speed, state, F);
}

std::vector<double> SliderSystem::loaded_at_rest(std::span<const double> state, double share) const {
  auto y = unknowns_at(0, 0, 0, state, 0);
  y[0] = (share * holding_limit(0, y.data()) - model_.slider.damping * model_.drive.speed.level() +
          model_.drive.force.level()) /
         model_.slider.stiffness;
  return y;
}

double SliderSystem::friction_coefficient(double t, const double* y) const {
  if (carries_friction()) return y[mechanical_];
  if (sticking()) return holding_force(t, y) / forcing(t).load;
  const Forcing now = forcing(t);
  const double load = now.load > 0 ? now.load : 1;  // the coefficient exists for N = 0 too
  if (const int v = contact_slip_rate_index(); v >= 0)
    return model_.law->friction({y[v], load}, rows_.natural_states(y[v], load, y + mechanical_));
  double g[Slopes<double>::capacity], F;
  rows_.contact->evaluate({imposed_slip_rate(now, y, 0), load, 0, sign(mode_)}, y + mechanical_, g, F);
  return F / load;
}

void SliderSystem::kinks(double t, const double* y, std::vector<double>& values) const {
  const auto& law = *model_.law;
  const double of_states = rows_.states == 0 ? NAN : law.kink({y + first_state(), std::size_t(rows_.states)});
  // Kinks in the slip rate are at reversals too. They matter to masses: without one friction sets the slip rate.
  double at_slip = mechanics_ == Mechanics::inertial ? law.slip_kink(contact_slip_rate(t, y)) : NAN;
  if (std::isnan(at_slip) && marks_reversals_ && rows_.states > 0) at_slip = contact_slip_rate(t, y) / reference_speed_;
  values.assign({of_states, at_slip});
}

double SliderSystem::slip_rate(double t, const double* y) const {
  const Forcing now = forcing(t);
  if (mechanics_ == Mechanics::inertial && !(rows_.creep > 0 && std::abs(y[1]) < nearly_stuck * reference_speed_))
    return y[1];
  if (mechanics_ == Mechanics::damped && rows_.setup.spring.present())
    return imposed_slip_rate(now, y, now.load * y[mechanical_]);
  if (rows_.setup.spring.present() && std::isinf(model_.slider.stiffness)) return now.speed;
  if (contact_slip_rate_index() >= 0) {  // elastic: the slider's spring shares the deflection
    std::vector<double> f(size());
    evaluate(t, y, f.data());
    const double compliance = compliance_at(rows_.setup.spring, now.load);
    const double k_N = rows_.setup.spring.compliance_per_load / (now.load * now.load * compliance * compliance);
    const double F_rate = f[size() - 1] / compliance + k_N * now.load_rate * y[size() - 1];
    return now.speed - (F_rate + now.force_rate) / model_.slider.stiffness;
  }
  if (!carries_friction()) return imposed_slip_rate(now, y, 0);
  // Without mass the contact's own slip rate follows from friction, without the cancellation in V − ẋ.
  const double* z = y + mechanical_;
  const double v = rows_.own_slip_rate(now.load, z);
  if (!model_.contact_stiffness.present()) return v;
  if (mechanics_ == Mechanics::damped) return imposed_slip_rate(now, y, now.load * z[0]);
  // u = v + Ḟ_t/k_t, with the springs of contact and slider in series.
  double g[Slopes<double>::capacity], m[Slopes<double>::capacity], F;
  rows_.contact->evaluate({imposed_slip_rate(now, y, 0), now.load, now.load_rate, sign(mode_)}, z, g, F);
  rows_.contact->mass(now.load, m);
  const double F_rate = now.load * g[0] / m[0] + now.load_rate * z[0];
  const double u = now.speed - (F_rate + now.force_rate) / model_.slider.stiffness;
  if (!rows_.setup.spring.present() || now.load_rate != 0 || now.force_rate != 0) return u;
  // A weak damper parallel to the contact's spring gives its rate from the difference of two forces. Where that is
  // rounding error, the damper has relaxed, and both springs follow friction.
  const double share = model_.slider.stiffness * compliance_at(rows_.setup.spring, now.load);
  const double relaxed = (v + share * now.speed) / (1 + share);
  const double digits = 100 * std::numeric_limits<double>::epsilon() * std::abs(now.load * z[0]) /
                        (rows_.setup.spring.damping + rows_.setup.spring.damping_per_load * now.load);
  return std::abs(u - relaxed) <= digits ? relaxed : u;
}

double SliderSystem::contact_slip_rate(double t, const double* y) const {
  if (contact_slip_rate_index() < 0 && (rigid() || !carries_friction())) return slip_rate(t, y);
  return rows_.own_slip_rate(forcing(t).load, y + mechanical_);
}

double SliderSystem::holding_force(double t, const double* y) const { return momentum_rate(forcing(t), y[0], 0, 0); }

double SliderSystem::holding_limit(double t, const double* y) const {
  return rows_.limit_at_rest(forcing(t).load, y + mechanical_);
}

double SliderSystem::holding_rounding(double t, const double* y) const {
  constexpr double digits = 8 * std::numeric_limits<double>::epsilon();
  return digits * (holding_limit(t, y) + model_.slider.stiffness * std::abs(y[0]));
}

void SliderSystem::held(double t, const double* y, Held* held) const {
  if (contacts() == 0) return;
  held[0] = {holding_force(t, y), holding_limit(t, y), holding_rounding(t, y)};
}

void SliderSystem::slip_accelerations(double t, const double* y, double* acceleration) const {
  std::vector<double> f(size());
  evaluate(t, y, f.data());
  acceleration[0] = f[1] / model_.slider.mass;
}

void SliderSystem::release(int, double t, double* y) const {
  const double k = model_.slider.stiffness, sure = holding_rounding(t, y);
  std::vector<double> f(size());
  evaluate(t, y, f.data());
  const double driving = sign(mode_) * f[1];
  if (k > 0 && driving < sure) y[0] += sign(mode_) * (sure - driving) / k;
}

void SliderSystem::stop(int, double* y) const {
  y[slip_rate_index()] = 0;
  rows_.stop(y + mechanical_);
}

Observation SliderSystem::observe(double t, const double* y) const {
  const Forcing now = forcing(t);
  Observation seen;
  seen.friction_coefficient = friction_coefficient(t, y);
  seen.friction_force = now.load * seen.friction_coefficient;
  seen.slip_rate = slip_rate(t, y);
  seen.velocity = now.speed - seen.slip_rate;
  seen.displacement =
      mechanical_ > 0 ? origin_.displacement + y[0] : (seen.friction_force + now.force) / model_.slider.stiffness;
  seen.state = rows_.natural_states(contact_slip_rate_index() >= 0 ? contact_slip_rate(t, y) : seen.slip_rate, now.load,
                                    y + mechanical_);
  seen.acceleration = mechanics_ != Mechanics::inertial ? std::numeric_limits<double>::quiet_NaN()
                      : sticking()                      ? now.speed_rate
                                   : now.speed_rate - momentum_rate(now, y[0], seen.slip_rate, seen.friction_force) /
                                                          model_.slider.mass;
  return seen;
}

void SliderSystem::cross_break(double t, double* y) const {
  const Forcing before = forcing(std::nextafter(t, -infinity)), after = forcing(t);
  if (before.load != after.load)
    rows_.contact->change_load(contact_slip_rate(std::nextafter(t, -infinity), y), before.load, after.load,
                               y + mechanical_);
  if (mechanics_ == Mechanics::inertial) y[1] += after.speed - before.speed;  // the slider's velocity is continuous
  double* z = y + mechanical_;
  if (contact_slip_rate_index() >= 0 && mechanics_ == Mechanics::elastic)  // a jump of the force stretches its spring
    y[size() - 1] -= (after.force - before.force) / model_.slider.stiffness;
  if (rows_.setup.spring.present() && rows_.setup.compliance == 0 && rows_.setup.compliance_per_load == 0)
    return settle(t, y);
  if (!carries_friction()) return;
  if (!rigid() || mechanics_ == Mechanics::damped) {
    // The force in the spring is continuous, unless the force on a massless slider jumps.
    double F = before.load * z[0];
    if (mechanics_ == Mechanics::elastic && rows_.setup.compliance > 0)
      F -= (after.force - before.force) / (model_.slider.stiffness * rows_.setup.compliance);
    if (rows_.setup.compliance_per_load == 0 || mechanics_ == Mechanics::damped) z[0] = F / after.load;
    return;
  }
  // Rigid contact: the slip rate is given, friction follows from it.
  const double u = mechanics_ == Mechanics::inertial ? y[1] : imposed_slip_rate(after, y, 0);
  rows_.make_friction_fit(u, after.load, z);
}

}  // namespace rosin::oscillators
