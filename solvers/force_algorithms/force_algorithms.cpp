/// Dispatch by name, and the conditions under which each algorithm means anything.
#include "solvers/force_algorithms/force_algorithms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "core/error.hpp"
#include "solvers/force_algorithms/meijaard.hpp"
#include "solvers/force_algorithms/regularised.hpp"
#include "solvers/force_algorithms/spring_damper.hpp"

namespace rosin::solvers::force_algorithms {

namespace {
constexpr Description list[] = {
    {"cfm", "Coulomb friction model"},
    {"o-fbfm", "original force-balance model (Karnopp; Tan & Rogers)"},
    {"svlfm", "smoothed velocity-limited model (Oden & Martins)"},
    {"vlfm", "velocity-limited model"},
    {"aabg-sdfm", "spring-damper model (Antunes, Axisa, Beaufils & Guilbaud)"},
    {"meijaard", "steps interpolated to events (Meijaard)"},
    {"r-fbfm", "revised force-balance model (Tan & Rogers)"},
    {"tr-sdfm", "spring-damper model with back-stepping (Tan & Rogers)"},
};

bool spring_damped(std::string_view name) { return name.ends_with("-sdfm"); }
bool regularised(std::string_view name) { return name.ends_with("vlfm"); }
}  // namespace

std::span<const Description> algorithms() { return list; }
bool is_algorithm(std::string_view name) {
  return std::ranges::any_of(list, [&](const auto& known) { return known.name == name; });
}

template <int D>
double step_of(const stick_slip::DryMass<D>& mass, const Options& options) {
  if (options.step > 0) return options.step;
  double fastest = 0;
  const auto look_at = [&](const Signal& signal) {
    for (const auto& term : signal.piece(0).terms) fastest = std::max(fastest, std::abs(term.angular_frequency));
  };
  look_at(mass.load);
  for (int d = 0; d < D; ++d) {
    look_at(mass.force[d]);
    fastest = std::max(fastest, std::sqrt(mass.stiffness[d] / mass.mass));
  }
  return 2 * std::numbers::pi / fastest / 1000;
}

template <int D>
void check(std::string_view name, const stick_slip::DryMass<D>& mass, const Options& options) {
  double most_load = std::abs(mass.load.level()), most_force = 0, slowest = infinity;
  for (const auto& term : mass.load.piece(0).terms) most_load += std::abs(term.amplitude);
  for (int d = 0; d < D; ++d) {
    double force = std::abs(mass.force[d].level());
    for (const auto& term : mass.force[d].piece(0).terms) force += std::abs(term.amplitude);
    most_force = std::max(most_force, force), slowest = std::min(slowest, std::sqrt(mass.stiffness[d] / mass.mass));
  }
  // What forces of this size give the mass for speed: a window or transition as wide would cover all motion.
  const double reach = (most_force + mass.static_friction * most_load) / (mass.mass * slowest);
  const auto within = [&](double value, const char* key, const char* why) {
    if (!(value > 0 && value < reach))
      throw InputError(
          fmt::format("solver.{} = {} m/s must be above 0 and below {:.3g} m/s, the speed that forces and "
                      "friction give the mass: {}",
                      key, value, reach, why));
  };
  if (name == "o-fbfm") within(options.window, "window", "the mass counts as at rest while it is slower");
  if (regularised(name)) within(options.transition_speed, "transition_speed", "friction falls to zero below it");
  if (options.closed_form && (regularised(name) || name == "meijaard"))
    throw InputError(
        fmt::format("solver.stepping = 'closed-form' does not go with '{}', whose force within a step has "
                    "no closed form; use 'runge-kutta'",
                    name));
  if (name == "meijaard" && D > 1)
    throw InputError("'meijaard' interpolates to the zero of one velocity, and in the plane there is none to hit");
  const double step = step_of(mass, options);
  // Classical Runge–Kutta is stable up to |λ| dt = 2.785 on the negative axis and 2.828 on the imaginary one.
  constexpr double stable = 2.785;
  const auto bound_step = [&](double rate, std::string_view what) {
    if (!options.closed_form && step * rate > stable)
      throw InputError(
          fmt::format("solver.step = {:.6g} s is too long for {}, a rate of {:.6g} 1/s: Runge-Kutta steps "
                      "are stable up to {:.6g} s",
                      step, what, rate, stable / rate));
  };
  for (int d = 0; d < D; ++d) {
    const double m = mass.mass, k = mass.stiffness[d], c = mass.damping[d];
    const double alpha = c / (2 * m), natural = std::sqrt(k / m);
    bound_step(alpha > natural ? alpha + std::sqrt(alpha * alpha - natural * natural) : natural, "spring and damper");
    if (regularised(name))
      bound_step((name == "svlfm" ? 2 : 1) * mass.dynamic_friction * most_load / (m * options.transition_speed),
                 "friction below solver.transition_speed");
    if (!spring_damped(name)) continue;
    if (options.adherence_stiffness < 0 || !std::isfinite(options.adherence_stiffness))
      throw InputError(fmt::format("solver.adherence_stiffness = {} N/m must be above 0: stick is a spring",
                                   options.adherence_stiffness));
    const Adhesion<D> adhesion(mass, options);
    const double w = std::sqrt((k + adhesion.stiffness) / m), ratio = (c + adhesion.damping) / (2 * m * w);
    if (!(ratio > 1)) {
      const double a = adhesion.stiffness / k,
                   least = std::sqrt((1 + a) / a) - c / (2 * std::sqrt(k * m) * std::sqrt(a));
      throw InputError(
          fmt::format("solver.adherence_damping = {} makes stick ring (ratio {:.6g} with the slider's own "
                      "spring and damper); it must be above {:.6g} for overdamped adherence",
                      options.adherence_damping, ratio, least));
    }
    bound_step(w * (ratio + std::sqrt(ratio * ratio - 1)), "the adherence spring and damper");
  }
}

template <int D>
Track<D> follow(std::string_view name, const stick_slip::DryMass<D>& mass, const Forcing<D>& forcing,
                const Options& options, const stick_slip::Vector<D>& x, const stick_slip::Vector<D>& v) {
  Track<D> track;
  if (name == "meijaard") {
    if constexpr (D == 1)
      follow_meijaard(mass, 2 * forcing.half, forcing.half * double(forcing.load.size() - 1), x[0], v[0], options,
                      track.points, track.sticks);
    return track;
  }
  SteppedMotion<D> motion(mass, forcing, options);
  const auto with = [&](auto algorithm) { motion.follow(algorithm, x, v); };
  if (name == "cfm") with(Cfm<D>{});
  if (name == "o-fbfm") with(OriginalForceBalance<D>{});
  if (name == "r-fbfm") with(RevisedForceBalance<D>{});
  if (name == "aabg-sdfm") with(SpringDamper<D, false>{Adhesion<D>(mass, options)});
  if (name == "tr-sdfm") with(SpringDamper<D, true>{Adhesion<D>(mass, options)});
  if (name == "vlfm") with(Regularised<D, false>{});
  if (name == "svlfm") with(Regularised<D, true>{});
  track.points = motion.take_points();
  track.sticks = motion.sticks();
  return track;
}

template double step_of(const stick_slip::DryMass<1>&, const Options&);
template double step_of(const stick_slip::DryMass<2>&, const Options&);
template void check(std::string_view, const stick_slip::DryMass<1>&, const Options&);
template void check(std::string_view, const stick_slip::DryMass<2>&, const Options&);
template Track<1> follow<1>(std::string_view, const stick_slip::DryMass<1>&, const Forcing<1>&, const Options&,
                            const stick_slip::Vector<1>&, const stick_slip::Vector<1>&);
template Track<2> follow<2>(std::string_view, const stick_slip::DryMass<2>&, const Forcing<2>&, const Options&,
                            const stick_slip::Vector<2>&, const stick_slip::Vector<2>&);

}  // namespace rosin::solvers::force_algorithms
