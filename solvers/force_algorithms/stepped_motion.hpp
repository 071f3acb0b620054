/// The motion that a force algorithm steps through: a mass on springs and dampers under dry friction, in D directions.
///
/// All algorithms look at the end of each step; what they find governs the next one (its state and its direction of
/// slip are held over the step). Steps are classical Runge–Kutta ones of fourth order, or the closed form of the
/// present state.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/force_algorithms/options.hpp"
#include "solvers/stick_slip/closed_form.hpp"
#include "solvers/stick_slip/dry_mass.hpp"

namespace rosin::solvers::force_algorithms {

using stick_slip::dot;
using stick_slip::DryMass;
using stick_slip::length;
using stick_slip::Vector;

enum class State : std::uint8_t { slide, stick, micro_slip };

/// Drive forces and loads at all steps and half steps: the same for every algorithm.
template <int D>
struct Forcing {
  Forcing(const stick_slip::DryMass<D>& mass, double step, std::size_t steps) : half(step / 2) {
    force.resize(2 * steps + 1), load.resize(2 * steps + 1);
    for (std::size_t i = 0; i < load.size(); ++i) {
      load[i] = mass.load.value(half * i);
      for (int d = 0; d < D; ++d) force[i][d] = mass.force[d].value(half * i);
    }
  }
  double half;
  std::vector<stick_slip::Vector<D>> force;
  std::vector<double> load;
};

/// One stick as an algorithm found it.
struct Stick {
  std::size_t begin, end;     ///< steps; the end is that of the motion if it lasts
  int back_steps = 0;         ///< by which the integration was taken back
  double smallest_speed = 0;  ///< of slip, within it
  double last_speed = 0;      ///< of slip, before its end
  bool false_start = false;   ///< ended within five steps
};

template <int D>
class SteppedMotion {
 public:
  struct Point {
    double time;
    stick_slip::Vector<D> x, v, friction;
    State state;
  };

  SteppedMotion(const stick_slip::DryMass<D>& mass, const Forcing<D>& forcing, const Options& options)
      : mass_(mass), forcing_(forcing), options_(options), step_(2 * forcing.half) {}

  /// Follows the algorithm from (x, v) at t = 0 to the end of the forcing.
  template <class Algorithm>
  void follow(Algorithm& algorithm, const stick_slip::Vector<D>& x, const stick_slip::Vector<D>& v) {
    const std::size_t steps = forcing_.load.size() / 2;
    points_.clear();
    points_.reserve(steps + 1);
    points_.push_back({0, x, v, {}, State::slide});
    const double speed = length<D>(slip(0));
    if (speed > 0) {
      slide_along(0, slip(0));
    } else if (length<D>(balance(0)) <= static_limit(0) && algorithm.can_stick) {
      algorithm.begin_stick(*this, 0, relative(0));
    } else {
      slide_along(0, balance(0));
    }
    while (points_.size() <= steps) {
      const std::size_t n = points_.size();
      points_.push_back(advanced(algorithm, n - 1));
      look_at_stick(n);
      algorithm.decide(*this, n);
      if (options_.most_sticks > 0 && sticks_.size() == options_.most_sticks && last().state != State::stick) break;
    }
    if (last().state == State::stick && !sticks_.empty()) sticks_.back().end = points_.size() - 1;
  }

  const std::vector<Point>& points() const { return points_; }
  std::vector<Point> take_points() { return std::move(points_); }
  const std::vector<Stick>& sticks() const { return sticks_; }
  const stick_slip::DryMass<D>& mass() const { return mass_; }
  const Options& options() const { return options_; }
  double step() const { return step_; }

  // What algorithms ask, at the end of step n.
  State state() const { return state_; }
  stick_slip::Vector<D> slip(std::size_t n) const {  ///< velocity relative to the surface
    stick_slip::Vector<D> w = points_[n].v;
    for (int d = 0; d < D; ++d) w[d] -= mass_.surface_velocity[d];
    return w;
  }
  stick_slip::Vector<D> relative(std::size_t n) const {  ///< displacement relative to the surface
    stick_slip::Vector<D> z = points_[n].x;
    for (int d = 0; d < D; ++d) z[d] -= mass_.surface_velocity[d] * time(n);
    return z;
  }
  /// R = f − c ẋ − k x: what friction would have to balance.
  stick_slip::Vector<D> balance(std::size_t n) const {
    stick_slip::Vector<D> R = forcing_.force[2 * n];
    for (int d = 0; d < D; ++d) R[d] -= mass_.damping[d] * points_[n].v[d] + mass_.stiffness[d] * points_[n].x[d];
    return R;
  }
  double static_limit(std::size_t n) const { return mass_.static_friction * forcing_.load[2 * n]; }
  double dynamic_limit(std::size_t n) const { return mass_.dynamic_friction * forcing_.load[2 * n]; }
  State state_of(std::size_t n) const { return points_[n].state; }

  // What algorithms do.
  /// Slip along the direction of a vector; along the last direction if it is zero.
  void slide_along(std::size_t n, const stick_slip::Vector<D>& vector, State state = State::slide) {
    const double size = length<D>(vector);
    const auto before = direction_;
    if (size > 0)
      for (int d = 0; d < D; ++d) direction_[d] = vector[d] / size;
    enter(n, state, direction_ != before);
  }
  /// Leaves stick at step n: micro-slip along the force that cannot be held, or plain slip.
  void release(std::size_t n) {
    sticks_.back().end = n;
    sticks_.back().false_start = n <= sticks_.back().begin + 5;
    slide_along(n, options_.micro_slip ? balance(n) : slip(n), options_.micro_slip ? State::micro_slip : State::slide);
  }
  /// Micro-slip lasts until the velocity follows the force; then slip.
  void end_micro_slip(std::size_t n) {
    constexpr double plane_threshold = 1e-4;  // m/s
    const bool follows = D == 1 ? dot<D>(slip(n), balance(n)) > 0 : length<D>(slip(n)) > plane_threshold;
    if (follows)
      slide_along(n, slip(n));
    else
      slide_along(n, balance(n), State::micro_slip);
  }
  void keep(std::size_t n) { points_[n].state = state_; }
  /// Puts step n into the place and velocity of the one before.
  void take_back(std::size_t n) { points_[n].x = points_[n - 1].x, points_[n].v = points_[n - 1].v; }
  /// Sticks from step n on; later steps are undone.
  void stick(std::size_t n, int back_steps = 0) {
    points_.resize(n + 1);
    sticks_.push_back({n, n, back_steps, std::numeric_limits<double>::infinity(), 0});
    look_at(sticks_.back(), n);
    enter(n, State::stick, true);
  }

 private:
  double time(std::size_t n) const { return step_ * n; }
  Point& last() { return points_.back(); }
  void look_at(Stick& stick, std::size_t n) {
    stick.last_speed = length<D>(slip(n));
    stick.smallest_speed = std::min(stick.smallest_speed, stick.last_speed);
  }
  void look_at_stick(std::size_t n) {
    if (state_ == State::stick) look_at(sticks_.back(), n);
  }
  void enter(std::size_t n, State state, bool anew) {
    anew |= state != state_;
    state_ = points_[n].state = state;
    if (anew) origin_ = n, forms_.clear();
  }

  template <class Algorithm>
  Point advanced(const Algorithm& algorithm, std::size_t n) {
    auto& from = points_[n];
    const double muk = mass_.dynamic_friction;
    const auto friction = [&](std::size_t half, const stick_slip::Vector<D>& x, const stick_slip::Vector<D>& v) {
      stick_slip::Vector<D> F;
      if (state_ == State::stick || Algorithm::regularised) {
        stick_slip::Vector<D> z = x, w = v;
        for (int d = 0; d < D; ++d)
          z[d] -= mass_.surface_velocity[d] * forcing_.half * half, w[d] -= mass_.surface_velocity[d];
        F = algorithm.friction(*this, forcing_.load[half], z, w);
      } else {
        for (int d = 0; d < D; ++d) F[d] = -muk * forcing_.load[half] * direction_[d];
      }
      return F;
    };
    const bool held = state_ == State::stick && Algorithm::holds_velocity;
    if (held) {
      const auto R = balance(n);
      Point to{time(n + 1), from.x, from.v, {}, state_};
      for (int d = 0; d < D; ++d) from.friction[d] = -R[d], to.x[d] += step_ * from.v[d];
      to.friction = from.friction;
      return to;
    }
    from.friction = friction(2 * n, from.x, from.v);
    Point to{time(n + 1), {}, {}, from.friction, state_};
    if (options_.closed_form) {
      if (forms_.empty()) build_forms(algorithm);
      for (int d = 0; d < D; ++d) {
        const auto x = forms_[d].derivatives(time(n + 1) - time(origin_));
        to.x[d] = x[0], to.v[d] = x[1];
      }
      if constexpr (D > 1) forms_.clear(), origin_ = n + 1;  // the direction is frozen for one step only
      return to;
    }
    const double h = step_;
    const auto acceleration = [&](std::size_t half, const stick_slip::Vector<D>& x, const stick_slip::Vector<D>& v) {
      auto a = friction(half, x, v);
      for (int d = 0; d < D; ++d)
        a[d] = (a[d] + forcing_.force[half][d] - mass_.damping[d] * v[d] - mass_.stiffness[d] * x[d]) / mass_.mass;
      return a;
    };
    const auto ahead = [](const stick_slip::Vector<D>& a, double h, const stick_slip::Vector<D>& b) {
      stick_slip::Vector<D> sum;
      for (int d = 0; d < D; ++d) sum[d] = a[d] + h * b[d];
      return sum;
    };
    const auto &x = from.x, &v = from.v;
    const auto a0 = acceleration(2 * n, x, v);
    const auto x1 = ahead(x, h / 2, v), v1 = ahead(v, h / 2, a0);
    const auto a1 = acceleration(2 * n + 1, x1, v1);
    const auto x2 = ahead(x, h / 2, v1), v2 = ahead(v, h / 2, a1);
    const auto a2 = acceleration(2 * n + 1, x2, v2);
    const auto x3 = ahead(x, h, v2), v3 = ahead(v, h, a2);
    const auto a3 = acceleration(2 * n + 2, x3, v3);
    for (int d = 0; d < D; ++d) {
      to.x[d] = x[d] + h / 6 * (v[d] + 2 * v1[d] + 2 * v2[d] + v3[d]);
      to.v[d] = v[d] + h / 6 * (a0[d] + 2 * a1[d] + 2 * a2[d] + a3[d]);
    }
    return to;
  }

  /// The closed form of the present state, with the clock restarted at its first step.
  template <class Algorithm>
  void build_forms(const Algorithm& algorithm) {
    using Form = stick_slip::ClosedForm<double>;
    const double t = time(origin_);
    for (int d = 0; d < D; ++d) {
      Form pull(mass_.force[d].piece(t), t);
      double damping = mass_.damping[d], stiffness = mass_.stiffness[d];
      if (state_ == State::stick) {
        const auto [Kt, Ct, anchor] = algorithm.adherence(*this, d);
        const double V = mass_.surface_velocity[d];
        damping += Ct, stiffness += Kt;
        pull.add(1, Form(Signal::Piece{Kt * (anchor + V * t) + Ct * V, Kt * V, {}}, t));
      } else {
        pull.add(-mass_.dynamic_friction * direction_[d], Form(mass_.load.piece(t), t));
      }
      forms_.push_back(
          Form::response(mass_.mass, damping, stiffness, pull, points_[origin_].x[d], points_[origin_].v[d]));
    }
  }

  const stick_slip::DryMass<D>& mass_;
  const Forcing<D>& forcing_;
  const Options& options_;
  double step_;
  std::vector<Point> points_;
  std::vector<Stick> sticks_;
  State state_ = State::slide;
  stick_slip::Vector<D> direction_{};
  std::size_t origin_ = 0;  ///< step at which the present state began
  std::vector<stick_slip::ClosedForm<double>> forms_;
};

}  // namespace rosin::solvers::force_algorithms
