/// Slip in logarithmic speed, its start and end, and the release from stick.
#include "solvers/stick_slip/plane_stick_slip.hpp"

#include <algorithm>
#include <cmath>

#include "core/dual.hpp"
#include "core/error.hpp"
#include "core/stop.hpp"
#include "solvers/stick_slip/closed_form.hpp"

namespace rosin::solvers::stick_slip {

namespace {
constexpr double least_speed = 1e-10;  ///< over the speed scale: below it a closed form completes the stop
enum Unknown { time_, x_0, x_1, log_speed, angle, rubbed, path, supply, unknowns };

template <class Real>
Real lifted(double value, double derivative, const Real& a) {
  if constexpr (std::is_same_v<Real, double>)
    return value;
  else
    return detail::chain(a, value, derivative);
}
double plain(double x) { return x; }
template <int n>
double plain(const Dual<double, n>& x) {
  return x.value;
}
}  // namespace

/// The equations of slip: unknowns t, x, ln |w|, the angle of w, and work and distance so far, over s with dt = |w| ds.
class PlaneStickSlip::Slip final : public System {
 public:
  Slip(const PlaneStickSlip& of, double fastest, double speed)
      : of_(of), mass_(of.mass_), fastest_(fastest), speed_(speed) {}

  int size() const override { return unknowns; }
  void mass(double, double* m) const override { std::fill(m, m + unknowns, 1.0); }
  void evaluate(double, const double* y, double* f) const override { rates<double>(y, f); }
  void linearise(double, const double* y, double* f, double* jacobian) const override {
    using Real = Dual<double, unknowns>;
    Real z[unknowns], g[unknowns];
    for (int i = 0; i < unknowns; ++i) z[i] = Real::variable(y[i], i);
    rates<Real>(z, g);
    for (int i = 0; i < unknowns; ++i) {
      f[i] = g[i].value;
      for (int j = 0; j < unknowns; ++j) jacobian[i * unknowns + j] = g[i].slope[j];
    }
  }
  void scale(const double*, double* s) const override {
    const double length = speed_ / fastest_, energy = mass_.mass * speed_ * speed_;
    const double sizes[] = {1 / fastest_, length, length, 1, 1, energy, length, energy};
    std::copy(sizes, sizes + unknowns, s);
  }
  std::string unknown(int i) const override {
    static const char* names[] = {"time",      "displacement 1", "displacement 2", "speed",
                                  "direction", "friction work",  "path",           "work of forces"};
    return names[i];
  }
  bool autonomous() const override { return true; }
  void kinks(double, const double* y, std::vector<double>& values) const override {
    const auto& of_speed = of_.slip_friction_.kink;
    values.assign(1, of_speed ? of_speed(std::exp(y[log_speed])) : NAN);
  }

 private:
  template <class Real>
  void rates(const Real* y, Real* f) const {
    const double t = plain(y[time_]);
    const auto at = [&](const Signal& signal) { return lifted(signal.value(t), signal.rate(t), y[time_]); };
    const double sine = std::sin(plain(y[angle])), cosine = std::cos(plain(y[angle]));
    const Real e[2] = {lifted(cosine, -sine, y[angle]), lifted(sine, cosine, y[angle])};
    const Real s = exp(y[log_speed]), limit = friction(s, at(mass_.load));
    Real R[2], supplied = 0.0;
    for (int d = 0; d < 2; ++d) {
      const Real v = s * e[d] + mass_.surface_velocity[d], force = at(mass_.force[d]);
      R[d] = force - mass_.damping[d] * v - mass_.stiffness[d] * y[x_0 + d];
      f[x_0 + d] = s * v;
      supplied = supplied + (force - mass_.damping[d] * v) * v - limit * e[d] * mass_.surface_velocity[d];
    }
    f[time_] = s;
    f[log_speed] = (R[0] * e[0] + R[1] * e[1] - limit) / mass_.mass;
    f[angle] = (R[1] * e[0] - R[0] * e[1]) / mass_.mass;
    f[rubbed] = limit * s * s;
    f[path] = s * s;
    f[supply] = supplied * s;
  }
  template <class Real>
  Real friction(const Real& speed, const Real& load) const {
    const auto [force, by_speed, by_load] = of_.friction(plain(speed), plain(load));
    if constexpr (std::is_same_v<Real, double>)
      return force;
    else
      return detail::chain(speed, load, force, by_speed, by_load);
  }
  const PlaneStickSlip& of_;
  const PlaneMass& mass_;
  double fastest_, speed_;
};

PlaneStickSlip::Friction PlaneStickSlip::friction(const PlaneMass& mass, const SlipFriction& of, double speed,
                                                  double load) {
  if (!of.contact) return {mass.dynamic_friction * load, 0, mass.dynamic_friction};
  double g[Slopes<double>::capacity], force;
  Slopes<double> slopes;
  of.contact->linearise({speed, load, 0, 1}, nullptr, g, force, slopes);
  return {force, slopes.F_u, slopes.F_N};
}

double PlaneStickSlip::largest_friction(const PlaneMass& mass, const SlipFriction& of) {
  const double load = mass.load.level();
  double force = mass.dynamic_friction * load;
  if (of.contact)
    for (double speed = 1e-9; speed < 1e3; speed *= 10) force = std::max(force, friction(mass, of, speed, load).force);
  return force;
}

PlaneStickSlip::PlaneStickSlip(PlaneMass mass, double tolerance, SlipFriction friction)
    : PlaneSolver(mass, largest_friction(mass, friction)), slip_friction_(std::move(friction)) {
  const auto& m = mass_;
  const bool holds_nothing = slip_friction_.contact && m.static_friction == 0;
  if (!(m.static_friction >= m.dynamic_friction) || !(m.dynamic_friction > 0 || holds_nothing))
    throw InputError("in the plane 0 < dynamic friction <= static friction is needed");
  slip_ = std::make_unique<Slip>(*this, fastest_, speed_scale_);
  collocation_ = std::make_unique<steps::Collocation>(*slip_, tolerance);
}
PlaneStickSlip::~PlaneStickSlip() = default;

int PlaneStickSlip::parts() const {
  constexpr double radians = 0.5, most = 1e5;
  return int(std::min(std::ceil((t1_ - t0_) * fastest_ / radians) + 1, most));
}

long PlaneStickSlip::steps() const { return collocation_->count().steps; }

void PlaneStickSlip::start(double t, PlaneVector x, PlaneVector v) {
  t0_ = t1_ = t;
  x_ = x, v_ = v;
  PlaneVector w;
  for (int d = 0; d < 2; ++d) w[d] = v[d] - mass_.surface_velocity[d];
  speed_scale_ = std::max(speed_scale_, length<2>(w));
  const auto R = balance(t, x, v);
  from_rest_ = length<2>(w) == 0;
  next_stick_ = from_rest_ && length<2>(R) <= mass_.static_friction * mass_.load.value(t);
  release_direction_ = from_rest_ ? R : w;
  fresh_ = true;
  stick_time_ = 0;
  open_account();
}

/// The time for which slip from rest at acceleration `a` changes friction in proportion to its speed, to 1e-14.
double PlaneStickSlip::while_friction_is_linear(double t, double a) const {
  if (!slip_friction_.contact) return infinity;
  const double N = mass_.load.value(t);
  const auto rest = friction(0, N);
  // Release without acceleration is slower than that of the whole limit.
  const double fastest = a > 0 ? a : rest.force / mass_.mass;
  double h = std::min(1e-5 / fastest_, 1e-5 * mass_.mass / std::max(std::abs(rest.by_speed), 1e-300));
  const auto bend = [&] { return std::abs(friction(fastest * h, N).force - rest.force - rest.by_speed * fastest * h); };
  constexpr double negligible = 1e-14, shortest = 1e-12;
  while (bend() > negligible * (rest.force + mass_.mass * a) && h > shortest / fastest_) h /= 4;
  return h;
}

/// Sets the unknowns of slip from (t1_, x_, v_) on; from rest by a series of speed and direction over a first short
/// time.
void PlaneStickSlip::begin_slip(double t, double end, bool from_rest, const PlaneVector& direction) {
  const auto& V = mass_.surface_velocity;
  std::vector<double> y(unknowns, 0.0);
  y[time_] = t, y[x_0] = x_[0], y[x_1] = x_[1];
  if (!from_rest) {
    y[log_speed] = std::log(length<2>(direction)), y[angle] = std::atan2(direction[1], direction[0]);
  } else {
    // R + Ṙ t + R̈ t²/2 along e = R/|R| and across it; friction subtracts μd N + F' |w| from the part along e.
    const double m = mass_.mass, muk = mass_.dynamic_friction, r = length<2>(direction);
    const PlaneVector e = {direction[0] / r, direction[1] / r};
    const auto N = ClosedForm<double>(mass_.load.piece(t), t).derivatives(0);
    const double a = std::max(0.0, (r - muk * N[0]) / m), by_speed = friction(0, N[0]).by_speed;
    const double h = std::min({1e-5 / fastest_, (end - t) / 2, while_friction_is_linear(t, a)});
    PlaneVector first, second;
    for (int d = 0; d < 2; ++d) {
      const auto f = ClosedForm<double>(mass_.force[d].piece(t), t).derivatives(0);
      first[d] = f[1] - mass_.damping[d] * a * e[d] - mass_.stiffness[d] * V[d];
      second[d] = f[2] - mass_.stiffness[d] * a * e[d];
    }
    const double along = dot<2>(first, e), across = first[1] * e[0] - first[0] * e[1];
    const double jerk = (along - muk * N[1] - by_speed * a) / m;
    for (int d = 0; d < 2; ++d) second[d] -= mass_.damping[d] * jerk * e[d];
    const double turn_rate = across / (r + m * a);  // rate of the direction, rad/s
    // Second derivative of the part of R along the direction of slip, which rotates at the rate `turn_rate`.
    const double snap =
        (dot<2>(second, e) + 2 * turn_rate * across - turn_rate * turn_rate * r - muk * N[2] - by_speed * jerk) / m;
    const double s = h * (a + h * (jerk / 2 + h * snap / 6));
    const double moved = h * h * (a / 2 + h * (jerk / 6 + h * snap / 24));
    // With inertia the direction of slip lags behind R.
    const double lag = a > 0 ? 0 : across / r * m * s / r;
    const double phi = std::atan2(e[1], e[0]) + turn_rate * h - lag;
    y[time_] = t + h;
    for (int d = 0; d < 2; ++d) y[x_0 + d] += V[d] * h + moved * e[d];
    y[log_speed] = std::log(std::max(s, 1e-3 * least_speed * speed_scale_)), y[angle] = phi;
    y[rubbed] = muk * N[0] * moved, y[path] = moved;
    for (int d = 0; d < 2; ++d)
      y[supply] += (mass_.force[d].value(t) - mass_.damping[d] * V[d]) * (V[d] * h + moved * e[d]) -
                   muk * N[0] * e[d] * V[d] * h;
  }
  friction_work_ += y[rubbed], path_length_ += y[path], supplied_ += y[supply];
  collocation_->start(0, y);
}

/// The first time in (from, to] at which stick ends, or infinity.
double PlaneStickSlip::release(double from, double to) const {
  using Form = ClosedForm<double>;
  Form N(mass_.load.piece(from), from), R[2];
  for (int d = 0; d < 2; ++d) {
    const double V = mass_.surface_velocity[d], k = mass_.stiffness[d];
    R[d] = Form(mass_.force[d].piece(from), from);
    R[d].add(-1, Form(Signal::Piece{mass_.damping[d] * V + k * x_[d], k * V, {}}, from));
  }
  const double mus = mass_.static_friction, span = to - from;
  const auto bound_N = N.bounds(0, span), bound_0 = R[0].bounds(0, span), bound_1 = R[1].bounds(0, span);
  const auto second = [](const auto& b) { return 2 * (b[1] * b[1] + b[0] * b[2]); };
  const double bend = mus * mus * second(bound_N) + second(bound_0) + second(bound_1);
  const double size = mus * mus * bound_N[0] * bound_N[0] + bound_0[0] * bound_0[0] + bound_1[0] * bound_1[0];
  if (size == 0) return infinity;  // nothing holds, and nothing pulls
  double tau = 0;
  while (true) {
    const auto n = N.derivatives(tau), a = R[0].derivatives(tau), b = R[1].derivatives(tau);
    const double left = mus * mus * n[0] * n[0] - a[0] * a[0] - b[0] * b[0];
    const double slope = 2 * (mus * mus * n[0] * n[1] - a[0] * a[1] - b[0] * b[1]);
    if (left <= 4e-16 * size) {
      if (slope < 0) return from + std::clamp(tau - left / slope, 0.0, span);
      // at the limit and moving away from it
      tau += std::max(1e-9 / fastest_, bend > 0 ? slope / bend : 0);
    } else {
      if (tau >= span) return infinity;
      const double root = std::sqrt(slope * slope + 2 * bend * left);
      const double step = bend == 0 ? span : slope > 0 ? (slope + root) / bend : 2 * left / (root - slope);
      if (tau + step == tau) return from + tau;
      tau += step;
    }
    if (tau > span) {
      tau = span;
      const double last = mus * N(span);
      if (last * last >= R[0](span) * R[0](span) + R[1](span) * R[1](span)) return infinity;
    }
  }
}

Outcome PlaneStickSlip::advance(double limit, Switch& switched) {
  end_if_stopped();
  switched = Switch::none;
  const auto& V = mass_.surface_velocity;
  t0_ = t1_;
  const double drive_break =
      std::min({mass_.load.next_break(t0_), mass_.force[0].next_break(t0_), mass_.force[1].next_break(t0_)});
  const double end = std::min(limit, drive_break);
  if (fresh_) {
    stick_ = next_stick_;
    if (!stick_) begin_slip(t1_, end, from_rest_, release_direction_);
    fresh_ = false;
  }
  if (stick_) {
    stick_x_ = x_;
    const double until = release(t0_, end);
    t1_ = std::min(until, end);
    for (int d = 0; d < 2; ++d) {
      x_[d] += V[d] * (t1_ - t0_);
      v_[d] = V[d];
    }
    stick_time_ += t1_ - t0_;
    for (int d = 0; d < 2; ++d) {  // a moving surface works against spring and damper
      supplied_ += mass_.stiffness[d] * (x_[d] * x_[d] - stick_x_[d] * stick_x_[d]) / 2;
    }
    if (until <= end) {
      switched = Switch::slip;
      release_direction_ = balance(t1_, x_, v_);
      from_rest_ = fresh_ = true, next_stick_ = false;
    } else if (end == drive_break) {
      release_direction_ = balance(t1_, x_, v_);
      next_stick_ = length<2>(release_direction_) <= mass_.static_friction * mass_.load.value(t1_);
      if (!next_stick_) switched = Switch::slip, from_rest_ = fresh_ = true;
    }
    return {};
  }

  const auto before = collocation_->state();
  const Outcome outcome = collocation_->step(infinity);
  if (!outcome.complete()) return outcome;
  const double stop = std::log(least_speed * speed_scale_);
  const auto until = [&](int unknown, double value) {
    const auto& now = collocation_->state();
    const auto theta = collocation_->locate([&](double, const double* y) { return y[unknown] - value; }, 0, 1,
                                            before[unknown] - value, now[unknown] - value);
    return theta && collocation_->shorten(*theta);
  };
  // Slip may begin below the speed that ends it; its speed then rises.
  const double lowest = collocation_->state()[log_speed];
  bool stops = lowest < stop && lowest < before[log_speed];
  if (stops && before[log_speed] > stop && !until(log_speed, stop))
    return {Ending::not_finite, "while locating a stop"};
  const bool ends = collocation_->state()[time_] >= end;
  if (ends && collocation_->state()[time_] > end) {
    stops = false;
    if (!until(time_, end)) return {Ending::not_finite, "while locating the end of a piece"};
  }
  const auto& y = collocation_->state();
  friction_work_ += y[rubbed] - before[rubbed];
  path_length_ += y[path] - before[path];
  supplied_ += y[supply] - before[supply];
  const double s = std::exp(y[log_speed]);
  const PlaneVector e = {std::cos(y[angle]), std::sin(y[angle])};
  t1_ = ends ? end : y[time_];
  x_ = {y[x_0], y[x_1]};
  for (int d = 0; d < 2; ++d) v_[d] = V[d] + s * e[d];
  const double rubbing = friction(s, mass_.load.value(t1_)).force;
  const double brake = (rubbing - dot<2>(balance(t1_, x_, v_), e)) / mass_.mass;
  if (stops && brake > 0) {
    const double rest = s / brake;
    t1_ += rest;
    for (int d = 0; d < 2; ++d) x_[d] += rest * (V[d] + s * e[d] / 2), v_[d] = V[d];
    const double last_friction = friction(0, mass_.load.value(t1_)).force;
    friction_work_ += last_friction * s * rest / 2;
    path_length_ += s * rest / 2;
    for (int d = 0; d < 2; ++d)
      supplied_ += (mass_.force[d].value(t1_) - mass_.damping[d] * V[d]) * (V[d] + s * e[d] / 2) * rest -
                   last_friction * e[d] * V[d] * rest;
    release_direction_ = balance(t1_, x_, v_);
    next_stick_ = length<2>(release_direction_) <= mass_.static_friction * mass_.load.value(t1_);
    from_rest_ = fresh_ = true;
    switched = next_stick_ ? Switch::stick : Switch::reversal;
  } else if (ends && end == drive_break) {
    fresh_ = true, from_rest_ = false;
    for (int d = 0; d < 2; ++d) release_direction_[d] = s * e[d];
  }
  return {};
}

PlaneStickSlip::Seen PlaneStickSlip::at(double t, bool near) {
  const auto& V = mass_.surface_velocity;
  if (stick_) {
    Seen seen{stick_x_, V, {}};
    for (int d = 0; d < 2; ++d) seen.displacement[d] += V[d] * (t - t0_);
    seen.friction = balance(t, seen.displacement, V);
    for (double& F : seen.friction) F = -F;
    return seen;
  }
  // The point of the step at time t.
  std::vector<double> y(unknowns);
  const auto& last = collocation_->state();
  const auto clock = [&](double theta) {
    collocation_->interpolate(theta, y.data());
    return y[time_];
  };
  Seen seen{x_, v_, {}};
  double phi = last[angle];
  if (t <= collocation_->state_before()[time_]) {  // within the series at the start of slip
    const auto& first = collocation_->state_before();
    const double s = std::exp(first[log_speed]);
    phi = first[angle];
    for (int d = 0; d < 2; ++d) {
      const double w = s * (d == 0 ? std::cos(phi) : std::sin(phi));
      seen.displacement[d] = first[x_0 + d] - (V[d] + w) * (first[time_] - t);
      seen.velocity[d] = V[d] + w;
    }
  } else if (t < last[time_]) {
    double low = 0, high = 1, theta = 0.5;
    for (int i = 0; i < 60 && high - low > 1e-15; ++i) (clock(theta = 0.5 * (low + high)) < t ? low : high) = theta;
    // The polynomial has a lower order than the step: Newton's method corrects it at full order.
    for (int i = 0; i < 3 && !near; ++i) {
      collocation_->solve_at(theta, y.data());
      const double rate = std::exp(y[log_speed]) * collocation_->length();
      theta = std::clamp(theta - (y[time_] - t) / rate, 1e-14, 1.0);
    }
    if (!near) collocation_->solve_at(theta, y.data());
    const double s = std::exp(y[log_speed]);
    phi = y[angle];
    seen = {{y[x_0], y[x_1]}, {V[0] + s * std::cos(phi), V[1] + s * std::sin(phi)}, {}};
  }
  const double limit =
      friction(length<2>({seen.velocity[0] - V[0], seen.velocity[1] - V[1]}), mass_.load.value(t)).force;
  seen.friction = {-limit * std::cos(phi), -limit * std::sin(phi)};
  return seen;
}

}  // namespace rosin::solvers::stick_slip
