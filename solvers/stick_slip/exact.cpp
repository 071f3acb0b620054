/// Pieces of closed form, what ends them, and what follows.
#include "solvers/stick_slip/exact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "core/stop.hpp"
#include "solvers/stick_slip/contact_balance.hpp"

namespace rosin::solvers::stick_slip {

void DryOscillator::check() const {
  const auto positive = [](double value, const char* what, const char* unit) {
    if (!(value > 0) || !std::isfinite(value))
      throw InputError(
          fmt::format("the closed form of stick-slip needs a {} above 0 and finite, got {} {}; use solver "
                      "'events'",
                      what, value, unit));
  };
  positive(mass, "mass", "kg");
  positive(stiffness, "stiffness", "N/m");
  if (!(static_friction >= dynamic_friction) || dynamic_friction < 0)
    throw InputError(fmt::format("static friction {} and dynamic friction {}: 0 <= dynamic <= static is needed",
                                 static_friction, dynamic_friction));
  if (!load.within({0, infinity}))
    throw InputError(
        fmt::format("the normal load falls below 0 at times and would open the contact; amplitudes may add "
                    "up to the mean load, {} N, at most",
                    load.level()));
  if (viscous != 0 && !load.constant())
    throw InputError("friction that is viscous per load has a closed form only under a constant load; use 'events'");
}

template <class Real>
Exact<Real>::Exact(DryOscillator model) : model_(std::move(model)) {
  model_.check();
}

template <class Real>
void Exact<Real>::start(Real t, Real x, Real v) {
  t0_ = t1_ = last_progress_ = t;
  x_ = x, v_ = v;
  const Real slip = model_.speed.value(double(t)) - v;
  Real unused;
  leaving_ = slip == 0;
  next_ = slip > 0 ? 1 : slip < 0 ? -1 : mode_at_rest(x, t, unused);
  fresh_ = true;
  works_ = {};
  energy_at_start_ = (Real(model_.mass) * v * v + Real(model_.stiffness) * x * x) / 2;
}

namespace {
/// Value and rate of a signal in the arithmetic of Real.
template <class Real>
std::array<Real, 2> now(const Signal& signal, Real t) {
  const auto g = ClosedForm<Real>(signal.piece(double(t)), t).derivatives(0);
  return {g[0], g[1]};
}
}  // namespace

/// R: the force that friction must hold to keep the mass at rest on the surface, without friction's sign.
template <class Real>
Real Exact<Real>::balance(Real x, Real t) const {
  const auto [V, rate] = now(model_.speed, t);
  return Real(model_.mass) * rate + Real(model_.damping) * V + Real(model_.stiffness) * x - now(model_.force, t)[0];
}

/// Stick if friction can hold; else the slip V − ẋ begins along the sign of R, which is what the surface would have to
/// pull with.
template <class Real>
int Exact<Real>::mode_at_rest(Real x, Real t, Real& margin) const {
  const Real R = balance(x, t), limit = Real(model_.static_friction) * now(model_.load, t)[0];
  margin = limit > 0 ? std::abs(std::abs(R) / limit - 1) : std::numeric_limits<Real>::infinity();
  return int(sign(stick_slip::mode_at_rest<Real>(R, limit)));
}

/// The closed forms of the mode `mode_` from (origin_, x_, v_) on.
template <class Real>
void Exact<Real>::build() {
  using Form = ClosedForm<Real>;
  ++pieces_;
  const double t = double(origin_);
  speed_ = Form(model_.speed.piece(t), origin_);
  load_ = Form(model_.load.piece(t), origin_);
  force_ = Form(model_.force.piece(t), origin_);
  const Real m = model_.mass, c = model_.damping, k = model_.stiffness;
  if (mode_ == 0) {
    motion_ = Form(x_).add(1, speed_.integral());
    velocity_ = speed_;
    Form R = Form(0).add(m, speed_.derivative()).add(c, speed_).add(k, motion_).add(-1, force_);
    for (const int side : {0, 1})
      hold_[side] = Form(0).add(model_.static_friction, load_).add(side == 0 ? Real(-1) : Real(1), R);
  } else {
    const Real viscous = model_.viscous;
    Form pull = force_;
    pull.add(mode_ * Real(model_.dynamic_friction), load_).add(viscous, speed_);
    motion_ = Form::response(m, c + viscous, k, pull, x_, v_);
    velocity_ = motion_.derivative();
    slip_ = Form(0).add(mode_, speed_).add(-mode_, velocity_);
  }
}

template <class Real>
Switch Exact<Real>::advance(Real limit) {
  end_if_stopped();
  constexpr Real eps = std::numeric_limits<Real>::epsilon();
  if (fresh_) {
    mode_ = next_, origin_ = t1_;
    build();
  }
  t0_ = t1_;
  const Real drive_break =
      std::min({Real(model_.speed.next_break(double(origin_))), Real(model_.load.next_break(double(origin_))),
                Real(model_.force.next_break(double(origin_)))});
  const Real end = std::min(limit, drive_break), from = t0_ - origin_, to = end - origin_;
  const Real moment = std::max(Real(1e-9L) * std::sqrt(Real(model_.mass) / Real(model_.stiffness)), 16 * eps * t0_);

  std::optional<Real> zero;
  bool held = false;  // through what cannot be told apart
  if (mode_ == 0) {
    Real start = from;
    if (without_progress_ > 4) {
      held = true;
      start = std::min(to, from + moment);
      ++chatter_events_;
      chatter_time_ += start - from;
      without_progress_ = 0;
    }
    Real nearest = to;
    for (const auto& side : hold_) {
      const bool at_limit = leaving_ && !held && side(0) <= 64 * eps * side.bounds(0, 1)[0];
      const auto found = side.first_zero(start, nearest, at_limit);
      if (found) zero = nearest = *found;
    }
  } else {
    zero = slip_.first_zero(from, to, leaving_ && fresh_);
  }
  const Real tau = zero ? *zero : to;
  t1_ = zero ? origin_ + tau : end;
  account(from, tau);
  if (mode_ == 0) stick_time_ += tau - from;
  const auto x = motion_.derivatives(tau);
  x_ = x[0], v_ = x[1];
  fresh_ = leaving_ = false;
  if (!zero) {
    if (end == drive_break) {
      const Real speed = now(model_.speed, t1_)[0], slip = speed - v_;
      Real unused;
      // A signal that does not jump is given in double.
      const Real rounding = 64 * std::numeric_limits<double>::epsilon() * (std::abs(speed) + std::abs(v_));
      leaving_ = slip == 0 || (mode_ == 0 && std::abs(slip) <= rounding);
      if (leaving_) v_ = speed;
      next_ = leaving_ ? mode_at_rest(x_, t1_, unused) : slip > 0 ? 1 : -1;
      fresh_ = true;
      if (mode_ == 0 && next_ != 0) return Switch::slip;
      if (mode_ != 0 && next_ == -mode_) return Switch::reversal;
    }
    return Switch::none;
  }
  fresh_ = leaving_ = true;
  v_ = now(model_.speed, t1_)[0];
  // Progress is what arithmetic can tell from none.
  if (t1_ - last_progress_ > moment)
    last_progress_ = t1_, without_progress_ = 0;
  else
    ++without_progress_;
  if (mode_ == 0) {
    next_ = balance(x_, t1_) > 0 ? 1 : -1;
    return Switch::slip;
  }
  Real margin;
  next_ = mode_at_rest(x_, t1_, margin);
  if (without_progress_ > 4) next_ = 0;
  decision_margin_ = std::min(decision_margin_, margin);
  return next_ == 0 ? Switch::stick : next_ == mode_ ? Switch::none : Switch::reversal;
}

template <class Real>
typename Exact<Real>::Seen Exact<Real>::at(Real t) const {
  const Real tau = t - origin_;
  const auto x = motion_.derivatives(tau);
  const auto V = speed_.derivatives(tau);
  const Real N = load_(tau), slip = mode_ == 0 ? 0 : V[0] - x[1];
  const Real F =
      mode_ == 0 ? Real(model_.mass) * V[1] + Real(model_.damping) * V[0] + Real(model_.stiffness) * x[0] - force_(tau)
                 : mode_ * Real(model_.dynamic_friction) * N + Real(model_.viscous) * slip;
  return {x[0], mode_ == 0 ? V[0] : x[1], slip, F, N};
}

template <class Real>
Real Exact<Real>::fastest(Real tau) const {
  Real fastest = 0;
  for (const auto* form : {&motion_, &speed_, &load_, &force_}) fastest = std::max(fastest, form->fastest(tau));
  return fastest;
}

template <class Real>
Real Exact<Real>::fastest() const {
  return fastest(t0_ - origin_);
}

/// Adds the works done from τ = from to τ = to.
template <class Real>
void Exact<Real>::account(Real from, Real to) {
  if (!audits() || !(from < to)) return;
  const bool moves = mode_ != 0 || !model_.speed.constant() || model_.speed.level() != 0;
  while (moves && from < to) {
    if (--parts_left_ <= 0) {
      works_ = {};
      return;
    }
    const Real rate = fastest(from), part = rate > 0 ? std::min(to - from, 3 / rate) : to - from;
    const auto& nodes = boost::math::quadrature::gauss<Real, 15>::abscissa();
    const auto& weights = boost::math::quadrature::gauss<Real, 15>::weights();
    const Real middle = from + part / 2;
    const auto take = [&](Real tau, Real weight) {
      const Seen seen = at(origin_ + tau);
      const Real f = force_(tau), V = seen.slip_rate + seen.velocity, dt = weight * part / 2;
      const Real damper = Real(model_.damping) * seen.velocity * seen.velocity * dt;
      const Real force = f * seen.velocity * dt, surface = seen.friction_force * V * dt;
      const Real friction = std::abs(seen.friction_force * seen.slip_rate) * dt;
      works_.damper += damper, works_.force += force, works_.surface += surface, works_.friction += friction;
      works_.wear += seen.load * std::abs(seen.slip_rate) * dt;
      works_.throughput += damper + friction + std::abs(force) + std::abs(surface);
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      take(middle + nodes[i] * part / 2, weights[i]);
      if (nodes[i] != 0) take(middle - nodes[i] * part / 2, weights[i]);
    }
    from = part < to - from ? from + part : to;
  }
  const auto x = motion_.derivatives(to);
  const Real energy = (Real(model_.mass) * x[1] * x[1] + Real(model_.stiffness) * x[0] * x[0]) / 2;
  works_.residual = energy - energy_at_start_ + works_.damper + works_.friction - works_.force - works_.surface;
}

template class Exact<double>;
template class Exact<long double>;

}  // namespace rosin::solvers::stick_slip
