/// The free oscillation between two sticks, in closed form.
#include "analysis/cycles/dry_cycle.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/maths.hpp"

namespace rosin::analysis::cycles {

namespace {

/// Slip from rest at the static limit; τ is the time less the period of the free oscillation, near which slip ends.
/// m ẇ = k ξ − r w, ξ̇ = −w, with w the slip rate less V and ξ the displacement from steady sliding.
template <class Real>
class Swing {
 public:
  explicit Swing(const solvers::stick_slip::DryOscillator& o)
      : V_(o.speed.level()),
        N_(o.load.level()),
        f_(o.force.level()),
        mass_(o.mass),
        k_(o.stiffness),
        c_(o.damping),
        viscous_(o.viscous),
        static_(o.static_friction),
        dynamic_(o.dynamic_friction) {
    const Real m = o.mass, resistance = c_ + viscous_;
    decay_ = resistance / (2 * m);
    const Real square = k_ / m - decay_ * decay_;
    if (!(square > 0)) return;
    frequency_ = std::sqrt(square);
    const Real onset = N_ * (static_ - dynamic_) / m;  // acceleration
    sine_ = (onset - decay_ * V_) / frequency_;
    const Real phase = std::atan2(onset, V_ * frequency_ - decay_ * sine_);  // phase of the extrema of the slip rate
    const Real full = 2 * std::numbers::pi_v<Real> / frequency_;
    highest_ = -full / 2 - phase / frequency_;
    lowest_ = -phase / frequency_;
    // Slip that stays above zero, or never starts, does not stick.
    if (!(onset > 0) || slip_rate(lowest_) >= 0) return;
    end_ = root(0, highest_, lowest_);
    // A holding force at −μs N, as without friction in motion, would start slip backwards.
    constexpr Real surely = 1 - 1e-9L;
    sticks_ = holding(stretch(end_)) > -surely * static_ * N_;
  }
  bool sticks() const { return sticks_; }

  /// The slip rate, as a sum without avoidable cancellation.
  Real slip_rate(Real tau) const {
    const Real t = tau + full(), fade = std::exp(-decay_ * t), half = std::sin(frequency_ * tau / 2);
    return V_ * (-std::expm1(-decay_ * t) + fade * 2 * half * half) + fade * sine_ * std::sin(frequency_ * tau);
  }
  /// Metrics of the period; slip up to `threshold` V counts as slow.
  Metrics metrics(Real threshold) const {
    Metrics m;
    const Real stretched = start() - stretch(end_), stick = stretched / V_, slip = end_ + full(), period = slip + stick;
    const Real held = holding(stretch(end_)) / N_;
    const Real fastest = slip_rate(highest_), viscous = viscous_ / N_;
    m.period = double(period);
    m.slip_rate_max = double(fastest);
    m.slip_rate_min = 0;
    m.friction_max = double(std::max(static_, dynamic_ + viscous * fastest));
    m.friction_min = double(std::min(held, dynamic_));
    m.friction_mean = double((dynamic_ * slip + viscous * V_ * period + stick * (held + static_) / 2) / period);
    m.stick_fraction = double(stick / period);
    const auto below = [&](Real factor) {
      const Real begins = root(factor * V_, -full(), highest_), ends = root(factor * V_, highest_, end_);
      return double((stick + (begins + full()) + (end_ - ends)) / period);
    };
    m.slow_fraction = below(threshold);
    m.stick_fraction_001 = below(Real(0.01));
    m.stick_fraction_05 = below(Real(0.5));
    m.slip_rate_mean = double(V_);
    return m;  // no loop area: friction in slip equals steady friction
  }
  double onset_displacement() const { return double(displacement(start())); }

  std::vector<CyclePoint> orbit() const {
    constexpr int points = 96;
    std::vector<CyclePoint> list;
    const Real slip = end_ + full(), stick = (start() - stretch(end_)) / V_;
    for (int i = 0; i <= points; ++i) {
      const Real tau = -full() + slip * i / points, u = i == 0 || i == points ? Real(0) : slip_rate(tau);
      const Real friction = i == 0 ? static_ : dynamic_ + viscous_ / N_ * u;
      const Real x = displacement(stretch(tau)), a = (N_ * friction + f_ - k_ * x - c_ * (V_ - u)) / mass_;
      list.push_back({double(tau + full()), double(x), double(u), double(friction), double(a), {}});
    }
    for (const Real part : {Real(0), Real(1)}) {
      const Real load = stretch(end_) + part * stick * V_;
      const Real x = displacement(load);
      list.push_back({double(slip + part * stick), double(x), 0.0, double(holding(load) / N_), 0.0, {}});
    }
    return list;
  }

 private:
  Real full() const { return 2 * std::numbers::pi_v<Real> / frequency_; }
  /// ξ at the onset, where the holding force is the static limit.
  Real start() const { return (N_ * (static_ - dynamic_) - (c_ + viscous_) * V_) / k_; }
  /// ξ at τ.
  Real stretch(Real tau) const {
    const Real t = tau + full(), fade = std::exp(-decay_ * t), s = std::sin(frequency_ * tau);
    const Real c = std::cos(frequency_ * tau);
    // ξ(t) = e^{−γt} (ξ₀ cos + (γ ξ₀ + V)/ω sin), from ξ̇ = −w = V at t = 0.
    return fade * (start() * c + (decay_ * start() + V_) / frequency_ * s);
  }
  Real displacement(Real xi) const { return xi + (N_ * dynamic_ + viscous_ * V_ + f_) / k_; }
  /// Friction force that holds at rest, N.
  Real holding(Real xi) const { return k_ * displacement(xi) + c_ * V_ - f_; }
  /// τ at which the slip rate is `value`, between two extrema; NaN where rounding error puts both on one side of it.
  Real root(Real value, Real low, Real high) const {
    const auto excess = [&](Real tau) { return slip_rate(tau) - value; };
    if (!(low < high) || sign(excess(low)) * sign(excess(high)) > 0) return std::numeric_limits<Real>::quiet_NaN();
    std::uintmax_t most = 200;
    const auto [a, b] =
        boost::math::tools::toms748_solve(excess, low, high, boost::math::tools::eps_tolerance<Real>(), most);
    return (a + b) / 2;
  }

  Real V_, N_, f_, mass_, k_, c_, viscous_, static_, dynamic_;
  Real decay_ = 0, frequency_ = 1, sine_ = 0;  ///< w = e^{−γt} (−V cos ωt + sine · sin ωt)
  Real highest_ = 0, lowest_ = 0, end_ = 0;    ///< τ of the extrema of the slip rate, and of the end of slip
  bool sticks_ = false;
};

}  // namespace

std::optional<Cycle> find_dry_cycle(const solvers::stick_slip::DryOscillator& oscillator, const CycleOptions& options) {
  const Swing<double> swing(oscillator);
  const Swing<long double> exact(oscillator);
  if (!swing.sticks() || !exact.sticks()) return std::nullopt;
  Cycle cycle;
  cycle.metrics = exact.metrics(options.stick_threshold);
  const Metrics rounded = swing.metrics(options.stick_threshold);
  const double V = oscillator.speed.level();
  for (const auto& metric : metric_names()) {
    constexpr double digits = 4 * std::numeric_limits<double>::epsilon();
    const double value = cycle.metrics.*metric.member, off = std::abs(rounded.*metric.member - value);
    cycle.error.*metric.member = off + digits * size_of(metric, cycle.metrics, V);
    if (!(cycle.error.*metric.member <= options.tolerance * size_of(metric, cycle.metrics, V))) return std::nullopt;
  }
  cycle.section_displacement = exact.onset_displacement();
  cycle.orbit = exact.orbit();
  if (options.multipliers) cycle.multipliers = {0.0}, cycle.multiplier_errors = {0.0};
  cycle.stable = true;
  return cycle;
}

}  // namespace rosin::analysis::cycles
