/// Steps that end at events, and the balance of forces that follows each.
#include "solvers/force_algorithms/meijaard.hpp"

#include <algorithm>

#include "core/bracket.hpp"

namespace rosin::solvers::force_algorithms {

namespace {

struct Motion {
  double t, x, v;
};

/// One classical Runge–Kutta step of slip in direction `s`.
Motion stepped(const stick_slip::DryMass<1>& m, const Motion& from, double h, double s) {
  const auto a = [&](double t, double x, double v) {
    return (m.force[0].value(t) - m.damping[0] * v - m.stiffness[0] * x - s * m.dynamic_friction * m.load.value(t)) /
           m.mass;
  };
  const auto [t, x, v] = from;
  const double a0 = a(t, x, v);
  const double v1 = v + h / 2 * a0, a1 = a(t + h / 2, x + h / 2 * v, v1);
  const double v2 = v + h / 2 * a1, a2 = a(t + h / 2, x + h / 2 * v1, v2);
  const double v3 = v + h * a2, a3 = a(t + h, x + h * v2, v3);
  return {t + h, x + h / 6 * (v + 2 * v1 + 2 * v2 + v3), v + h / 6 * (a0 + 2 * a1 + 2 * a2 + a3)};
}

/// The zero of f in (0, h], f(0) > 0 > f(h), by interpolation.
template <class F>
double zero(F f, double h) {
  Bracket bracket{0, h, f(0), f(h)};
  for (int i = 0; i < 60 && bracket.width() > 1e-15 * h; ++i) {
    const double middle = bracket.secant(), value = f(middle);
    if (value == 0) return middle;
    bracket.take(middle, value);
  }
  return bracket.high;
}

}  // namespace

void follow_meijaard(const stick_slip::DryMass<1>& m, double step, double duration, double x, double v,
                     const Options& options, std::vector<SteppedMotion<1>::Point>& points, std::vector<Stick>& sticks) {
  const double V = m.surface_velocity[0];
  Motion now{0, x, v};
  const auto balance = [&](const Motion& at) {
    return m.force[0].value(at.t) - m.damping[0] * at.v - m.stiffness[0] * at.x;
  };
  const auto sign = [](double value) { return value < 0 ? -1.0 : 1.0; };
  // Direction of slip, 0 in stick, from the balance of forces at rest.
  const auto at_rest = [&](const Motion& at) {
    const double R = balance(at);
    return std::abs(R) <= m.static_friction * m.load.value(at.t) ? 0 : sign(R);
  };
  double s = v != V ? sign(v - V) : at_rest(now);
  const auto record = [&] {
    const double F = s == 0 ? -balance(now) : -s * m.dynamic_friction * m.load.value(now.t);
    points.push_back({now.t, {now.x}, {now.v}, {F}, s == 0 ? State::stick : State::slide});
  };
  const auto enter = [&](double direction) {
    if (s == 0 && !sticks.empty()) sticks.back().end = points.size();
    s = direction;
    if (s == 0) sticks.push_back({points.size(), points.size()});
  };
  enter(s);
  record();
  while (now.t < duration) {
    if (options.most_sticks > 0 && sticks.size() == options.most_sticks && s != 0) break;
    const double h = std::min(step, duration - now.t);
    const bool last = h == duration - now.t;
    if (s != 0) {
      const auto slip_after = [&](double part) { return s * (part == 0 ? now.v - V : stepped(m, now, part, s).v - V); };
      // A slip that has just begun is small and of either sign by rounding: one whole step decides.
      const bool begins = slip_after(0) <= 0;
      if (slip_after(h) < 0 && !begins) {
        now = stepped(m, now, zero(slip_after, h), s);
        now.v = V;
        enter(at_rest(now));
        record();
        continue;
      }
      now = stepped(m, now, h, s);
    } else {
      const auto stuck = [&](double part) { return Motion{now.t + part, now.x + V * part, V}; };
      const auto left = [&](double part) {
        const auto at = stuck(part);
        return m.static_friction * m.load.value(at.t) - std::abs(balance(at));
      };
      if (left(h) < 0 && left(0) > 0) {
        now = stuck(zero(left, h));
        enter(sign(balance(now)));
        record();
        continue;
      }
      if (left(h) < 0) enter(sign(balance(now)));
      now = stuck(h);
    }
    if (last) now.t = duration;
    record();
  }
  if (s == 0) sticks.back().end = points.size() - 1;
}

}  // namespace rosin::solvers::force_algorithms
