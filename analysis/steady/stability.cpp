/// Eigenvalues of steady sliding, Hopf points by closed form and by root finding, and their criticality.
#include "analysis/steady/stability.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "analysis/steady/certain_sign.hpp"
#include "analysis/steady/curve.hpp"
#include "analysis/steady/normal_form.hpp"
#include "core/characteristic.hpp"
#include "core/eigenpairs.hpp"
#include "oscillators/slider_system.hpp"

namespace rosin::analysis::steady {

using oscillators::Mechanics;
using oscillators::SliderSystem;
using Complex = std::complex<double>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

namespace {

/// M ẏ = J y around steady sliding, with every slip rate an unknown: where a solver's form eliminates one by a damper,
/// friction that resists far more than the damper cancels.
struct Pencil {
  RowMajor J, sizes;  ///< and what each entry was summed from
  std::vector<double> mass;

  explicit Pencil(const SliderSystem& system) : model_(system.model()), mechanics_(system.mechanics()) {
    auto setup = system.contact_setup();
    // An undamped spring is carried by the friction unknown.
    if (setup.compliance == 0 && setup.compliance_per_load == 0) setup.unknowns = Unknowns::states;
    contact_ = model_.law->contact(setup);
    const auto& d = model_.drive;
    const int mechanical = mechanics_ == Mechanics::elastic ? 0 : 2, n = mechanical + contact_->unknowns();
    std::vector<double> z(contact_->unknowns()), weight(contact_->unknowns());
    contact_->steady(0, d.speed.level(), d.normal_load.level(), z.data(), weight.data());
    mass.resize(n);
    if (mechanical > 0) mass[0] = 1, mass[1] = model_.slider.mass;
    contact_->mass(d.normal_load.level(), mass.data() + mechanical);
    J = rows(d.speed.level(), z);
    sizes = J.cwiseAbs();
    // Damping may all but cancel against friction that falls with the slip rate.
    if (mechanical > 0) sizes(1, 1) += 2 * model_.slider.damping;
    // Entries may be differences of larger numbers: what the last digits of the unknowns change is not known.
    constexpr double digits = 2 * std::numeric_limits<double>::epsilon();
    for (const double pattern : {1.0, -0.7, 0.4}) {
      auto beside = z;
      for (std::size_t i = 0; i < z.size(); ++i) beside[i] *= 1 + digits * (i % 2 ? -pattern * pattern : pattern);
      const double u = mechanical > 0 ? d.speed.level() * (1 + digits * pattern) : d.speed.level();
      sizes = sizes.cwiseMax((rows(u, beside) - J).cwiseAbs() / entry_rounding);
    }
  }

 private:
  /// Unknowns x, u and those of the contact; of a spring in series alone these.
  RowMajor rows(double u, const std::vector<double>& z) const {
    const int nz = int(z.size()), first = mechanics_ == Mechanics::elastic ? 0 : 2;
    std::vector<double> g(nz);
    double F;
    Slopes<double> slopes;
    contact_->linearise({u, model_.drive.normal_load.level(), 0, u < 0 ? -1.0 : 1.0}, z.data(), g.data(), F, slopes);
    RowMajor A = RowMajor::Zero(first + nz, first + nz);
    for (int i = 0; i < nz; ++i)
      for (int j = 0; j < nz; ++j) A(first + i, first + j) = slopes.g_z[i * nz + j];
    if (first == 0) return A;
    oscillators::couple_by_inertia(model_.slider, slopes, nz, A.data());
    return A;
  }

  const Model& model_;
  Mechanics mechanics_;
  std::unique_ptr<Contact<double>> contact_;
};

/// Steady sliding in the unknowns of a solver.
struct Linearisation {
  SliderSystem system;
  Linearised at;

  explicit Linearisation(const Model& model) : system(frozen(model), Unknowns::states) {
    system.set_mode(0, slip_along(model.drive.speed.level()));
    at = linearise(system, system.steady(0));
  }

  /// Signals replaced by their levels.
  static Model frozen(Model model) {
    auto& d = model.drive;
    d = {d.speed.level(), d.normal_load.level(), d.force.level()};
    return model;
  }

  struct Eigenvalue {
    Complex value;
    double error, real_error;
  };
  /// Largest real part first.
  std::vector<Eigenvalue> eigenvalues() const {
    if (!at.J.allFinite()) throw InputError("steady sliding cannot be linearised here: its derivatives are not finite");
    std::vector<Eigenvalue> list;
    if (const Pencil pencil(system); pencil.mass.size() <= most_expanded) {
      const auto count = std::size_t(pencil.J.size());
      const auto roots = characteristic_roots({pencil.J.data(), count}, pencil.mass, {pencil.sizes.data(), count});
      for (std::size_t i = 0; i < roots.values.size(); ++i)
        list.push_back({roots.values[i], roots.errors[i], roots.real_errors[i]});
    } else {
      // By QR: good to rounding of the largest.
      const auto values = eigenpairs(at.moving().A).values;
      double largest = 0;
      for (const auto& e : values) largest = std::max(largest, std::abs(e));
      for (const auto& e : values) list.push_back({e, 1e-14 * largest, 1e-14 * largest});
    }
    for (const auto& e : list)
      if (!std::isfinite(e.value.real()) || !std::isfinite(e.value.imag()))
        throw InputError("the eigenvalues of steady sliding could not be computed here");
    std::sort(list.begin(), list.end(), [](const Eigenvalue& a, const Eigenvalue& b) {
      return a.value.real() != b.value.real() ? a.value.real() > b.value.real() : a.value.imag() > b.value.imag();
    });
    return list;
  }
};

constexpr double coefficient_rounding = 1e-10;  ///< of Re c₁/ω

/// What single-state laws need for closed forms, at steady sliding.
struct SingleState {
  double g, direct, slope;  ///< G_ψ/λ (1/s), ∂μ/∂v and dμ_ss/dv (s/m)
};
std::optional<SingleState> single_state(const Model& model) {
  const auto& law = *model.law;
  if (law.states().size() != 1 || model.lambda == 0 || law.set_valued() || model.contact_stiffness.damped())
    return std::nullopt;
  const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
  if (!(V != 0) || !(N > 0)) return std::nullopt;
  const auto contact = law.contact({.lambda = model.lambda, .unknowns = Unknowns::states});
  double z[1], weight[1], g[1], F;
  Slopes<double> s;
  contact->steady(0, V, N, z, weight);
  contact->linearise({V, N, 0, 1}, z, g, F, s);
  return SingleState{-s.g_z[0] / model.lambda, s.F_u / N, law.steady_friction({V, N}).slope};
}

/// The largest real part among the eigenvalues, and the frequency that goes with it.
struct Growth {
  double rate, frequency, error;
  bool decided() const { return std::abs(rate) > 4 * error; }  ///< the sign of the rate is beyond rounding
};
std::optional<Growth> growth(const Model& model) {
  try {
    const auto values = Linearisation(model).eigenvalues();
    if (values.empty()) return std::nullopt;
    const auto& leading = values.front();
    return Growth{leading.value.real(), std::abs(leading.value.imag()), leading.real_error};
  } catch (const InputError&) {
    return std::nullopt;  // no steady sliding at this value
  }
}

}  // namespace

std::string name(Criticality c) {
  return c == Criticality::supercritical ? "supercritical"
         : c == Criticality::subcritical ? "subcritical"
                                         : "degenerate";
}

std::optional<NormalFormCoefficient> normal_form(const Model& model, double angular_frequency) {
  const Linearisation sliding(model);
  const auto& system = sliding.system;
  Expansion at{sliding.at, {}, {}, Vector(system.size()), model.drive.speed.level()};
  system.slip_rate_gradient(0, at.linear.y.data(), at.slip_rate_gradient.data());
  const auto derivatives = [&](const Vector& d) {
    Vector second(system.size()), third(system.size());
    system.expand(0, at.linear.y.data(), d.data(), second.data(), third.data());
    return std::pair{second, third};
  };
  at.second = [&](const Vector& d) { return derivatives(d).first; };
  at.third = [&](const Vector& d) { return derivatives(d).second; };
  const auto c1 = normal_form_coefficient(at, {0, angular_frequency});
  if (!c1) return std::nullopt;
  return NormalFormCoefficient{*c1 / angular_frequency, coefficient_rounding};
}

SteadySliding steady_sliding(const Model& model) {
  const double V = model.drive.speed.level(), N = model.drive.normal_load.level(), f = model.drive.force.level();
  if (V == 0) throw InputError("drive.speed = 0: there is no steady sliding without a drive (speed, m/s)");
  SteadySliding steady;
  steady.slip_rate = V;
  steady.friction_coefficient = model.law->steady_friction({V, N}).friction;
  steady.friction_force = N * steady.friction_coefficient;
  const double k = model.slider.stiffness;
  if (k == 0)
    throw InputError("oscillator.stiffness = 0: without a spring the slider has no steady sliding (stiffness, N/m)");
  steady.displacement = (steady.friction_force + f) / k;
  steady.state = model.law->steady({V, N});
  return steady;
}

Stability stability(const Model& model) {
  Stability result;
  result.steady = steady_sliding(model);
  result.stable = true;
  result.marginal = false;
  for (const auto& e : Linearisation(model).eigenvalues()) {
    result.eigenvalues.push_back(e.value);
    result.eigenvalue_errors.push_back(e.error);
    const bool decided = std::abs(e.value.real()) > 4 * e.real_error;
    if (decided && e.value.real() > 0) result.stable = false;
    if (!decided) result.marginal = true;
  }
  if (!result.stable) result.marginal = false;
  if (result.marginal) result.stable = false;
  return result;
}

namespace {
/// Where the critical load has a closed form.
std::optional<SingleState> undamped_single_state(const Model& model) {
  if (model.slider.damping != 0 || !std::isfinite(model.slider.stiffness)) return std::nullopt;
  return single_state(model);
}
}  // namespace

bool critical_load_is_closed(const Model& model) { return undamped_single_state(model).has_value(); }

std::optional<CriticalLoad> critical_load(const Model& model) {
  const auto law = undamped_single_state(model);
  const auto& slider = model.slider;
  if (!law || !(law->slope < 0)) return std::nullopt;
  // ω_c² = −g² μ_ss'/μ_v; −g μ_ss' N_c = [1/(k − m ω_c²) + 1/k_t]⁻¹, and with k_t = κ N:
  // N_c = (k − m ω_c²) [1/(−g μ_ss') − 1/κ].
  const double omega = law->g * std::sqrt(-law->slope / law->direct), pull = -law->g * law->slope;
  const double spring = slider.stiffness - slider.mass * omega * omega;
  if (!(spring > 0)) return std::nullopt;
  const auto& contact = model.contact_stiffness;
  const double N = std::isfinite(contact.per_load) ? spring * (1 / pull - 1 / contact.per_load)
                                                   : 1 / (1 / spring + 1 / contact.tangential) / pull;
  if (!(N > 0)) return std::nullopt;
  return CriticalLoad{N, omega};
}

std::optional<bool> surely_stable(const Model& model) {
  const auto law = undamped_single_state(model);
  if (!law || model.contact_stiffness.present()) return std::nullopt;
  // Routh's condition is k − m ω_c² > −g N μ_ss'.
  const double omega_squared = -law->g * law->g * law->slope / law->direct;
  const double inertia = model.slider.mass * omega_squared,
               pull = -law->g * model.drive.normal_load.level() * law->slope;
  constexpr double surely = 1e-6, rounding = 1e-9;
  if (!(law->g > 0 && law->direct > 0 && law->slope < -rounding * law->direct)) return std::nullopt;
  const double excess = model.slider.stiffness / (inertia + pull) - 1;
  return std::abs(excess) > surely ? std::optional(excess > 0) : std::nullopt;
}

namespace {
/// The critical stiffness at the model's load, in closed form.
std::optional<double> critical_stiffness(const Model& model) {
  const auto law = single_state(model);
  if (!law || model.slider.damping != 0 || !(law->slope < 0)) return std::nullopt;
  const double N = model.drive.normal_load.level();
  const double omega2 = -law->g * law->g * law->slope / law->direct, pull = -law->g * law->slope * N;
  const double rest = 1 / pull - model.contact_stiffness.compliance(N);  // 1/(k − m ω²)
  if (!(rest > 0)) return std::nullopt;
  return model.slider.mass * omega2 + 1 / rest;
}

/// Whether vibration sets in softly or with a jump at a point where `there` is at. \throws InputError where that is
/// beyond the range of numbers.
void classify(HopfPoint& point, const Model& there) {
  const auto form = normal_form(there, point.angular_frequency);
  const double l = point.first_lyapunov_coefficient = form ? form->value : NAN;
  if (!std::isfinite(l))
    throw InputError(fmt::format(
        "at the Hopf point {} = {:.6g} the slider oscillates with {:.2g} rad/s: its normal form is beyond the "
        "range of numbers; oscillator.stiffness, {:.3g} N/m, or the mass is out of any range",
        point.parameter, point.value, point.angular_frequency, there.slider.stiffness));
  point.criticality = !(std::abs(l) > certain_sign * form->error) ? Criticality::degenerate
                      : l < 0                                     ? Criticality::supercritical
                                                                  : Criticality::subcritical;
}
}  // namespace

std::optional<HopfPoint> hopf_at_critical_load(const Model& model) {
  const auto closed = critical_load(model);
  if (!closed) return std::nullopt;
  const auto at = [&](double load) { return growth(model.with("drive.normal_load", load)); };
  constexpr double beside = 1e-6;
  const double N = closed->normal_load;
  const auto below = at(N * (1 - beside)), here = at(N), above = at(N * (1 + beside));
  if (!below || !here || !above || !below->decided() || !above->decided()) return std::nullopt;
  if (!(below->rate < 0 && above->rate > 0 && here->frequency > 0)) return std::nullopt;
  const double slope = (above->rate - below->rate) / (2 * beside);  // by ln N
  const double error = N * std::max((std::abs(here->rate) + here->error) / slope, 4e-16);
  HopfPoint point{"drive.normal_load", N, error, closed->angular_frequency, {}, 0, true};
  classify(point, model.with("drive.normal_load", N));
  return point;
}

std::vector<HopfPoint> hopf_points(const Model& model, std::string_view parameter, double decades) {
  model.check();
  const Quantity quantity = model.describe(parameter);
  const double here = model.get(parameter);
  if (!(here > 0) || !std::isfinite(here)) return {};
  const Range& range = quantity.range;
  const double low = std::max({here * std::pow(10.0, -decades), range.low, range.smallest, 1e-290});
  const double high = std::min({here * std::pow(10.0, decades), range.high, range.largest, 1e290});
  if (!(low < high)) return {};
  const auto at = [&](double w) -> std::optional<Growth> {
    if (!std::isfinite(w)) return std::nullopt;
    return growth(model.with(parameter, std::clamp(std::exp(w), low, high)));
  };
  std::vector<HopfPoint> found;
  constexpr int points_per_decade = 12;
  const int count = std::max(2, int(std::log10(high / low) * points_per_decade) + 1);
  std::optional<Growth> before;
  double w_before = 0;
  for (int i = 0; i < count; ++i) {
    const double w = std::log(low) + std::log(high / low) * i / (count - 1);
    const auto now = at(w);
    if (before && now && now->decided() && (before->rate > 0) != (now->rate > 0)) {
      std::uintmax_t iterations = 100;
      const auto rate = [&](double x) {
        const auto g = at(x);
        return g ? g->rate : NAN;
      };
      // A real eigenvalue may come back from infinity here, where there is none for once: interpolation must not end
      // there.
      const double most = 1e3 * std::min(std::abs(before->rate), std::abs(now->rate));
      const auto bounded = [&](double x) {
        const double value = rate(x);
        return std::clamp(std::isfinite(value) ? value : now->rate, -most, most);
      };
      const auto [a, b] = boost::math::tools::toms748_solve(bounded, w_before, w, std::clamp(before->rate, -most, most),
                                                            std::clamp(now->rate, -most, most),
                                                            boost::math::tools::eps_tolerance<double>(52), iterations);
      // Where resistance passes through zero it does so as a pair turns unstable, and the last digit decides which of
      // them is seen.
      const auto oscillates = [&](double x, double most_growth) {  // of the frequency
        const auto g = at(x);
        return g && g->frequency > 0 && std::abs(g->rate) <= most_growth * g->frequency;
      };
      double root = 0.5 * (a + b);
      if (!oscillates(root, infinity))
        for (const double end : {a, b})
          if (oscillates(end, 1e-9)) root = end;
      const auto there = at(root);
      if (there && there->frequency > 0) {
        HopfPoint point{std::string(parameter), std::exp(root), 0, there->frequency, {}, 0, false};
        // The slope of the growth rate turns its error into one of the value.
        const double step = 1e-4;
        const double slope = std::abs(rate(root + step) - rate(root - step)) / (2 * step);
        point.value_error = point.value * ((b - a) + 1e-15 + there->error / std::max(slope, 1e-300));
        if (!(point.value_error < point.value)) continue;  // the sign changes by rounding
        const auto closed =
            parameter == "drive.normal_load" && model.slider.mass >= 0 ? [&]() -> std::optional<double> {
          const auto c = critical_load(model);
          return c ? std::optional(c->normal_load) : std::nullopt;
        }()
            : parameter == "oscillator.stiffness" ? critical_stiffness(model)
                                                  : std::nullopt;
        if (closed && std::abs(*closed / point.value - 1) < 1e-6) {
          point.value_error = std::max(std::abs(*closed - point.value), 4e-16 * *closed);
          point.value = *closed;
          point.closed_form = true;
          if (parameter == "drive.normal_load") point.angular_frequency = critical_load(model)->angular_frequency;
        }
        classify(point, model.with(parameter, std::clamp(point.value, low, high)));
        found.push_back(point);
      }
    }
    if (now && now->decided()) before = now, w_before = w;
  }
  std::sort(found.begin(), found.end(), [&](const HopfPoint& a, const HopfPoint& b) {
    return std::abs(std::log(a.value / here)) < std::abs(std::log(b.value / here));
  });
  return found;
}

}  // namespace rosin::analysis::steady
