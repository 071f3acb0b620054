/// What one step costs in one lane, law by law: any law runs at the speed of any other.
#include <chrono>

#include "bench/rows.hpp"
#include "core/instruction_set.hpp"
#include "laws/adapter.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/slider_lanes.hpp"
#include "solvers/lanes/ensemble.hpp"

namespace bench {

using namespace rosin;

/// A law as a user might write it: friction that falls with slip and heals at rest, without an explicit slip rate.
template <class Real = double>
struct Healing {
  static constexpr Card card{"a user's law", "Healing friction", R"(\mu + d\,\psi)", "none", "a bench"};
  Real mu = 0.3, d = 0.1, L = 10e-6, t_heal = 10;
  static constexpr auto parameters =
      table(field(&Healing::mu, "mu", "1", {0, 2}, "friction after long slip"),
            field(&Healing::d, "d", "1", {0, 2}, "gain at rest"), field(&Healing::L, "L", "m", {1e-9, 1}, "memory"),
            field(&Healing::t_heal, "t_heal", "s", {1e-6, 1e9}, "healing time"));
  struct State {
    Real psi;
  };
  static constexpr auto states = table(field(&State::psi, "psi", "1", {0, 1}, "healed fraction"));
  Real friction(Sliding<Real> at, State s) const {
    return (mu + d * s.psi) * at.slip_rate / (1e-7 + abs(at.slip_rate));
  }
  State rate(Sliding<Real> at, State s) const { return {(1.0 - s.psi) / t_heal - abs(at.slip_rate) * s.psi / L}; }
  State steady(Sliding<Real> at) const { return {1.0 / (1.0 + abs(at.slip_rate) * t_heal / L)}; }
};

json lane_steps(const Settings& settings) {
  struct Case {
    std::string name;
    std::shared_ptr<const FrictionLaw> law;
    double contact_stiffness;
    InstructionSet set;
  };
  const InstructionSet best = instruction_set();
  const auto spinodal = laws::find_law("spinodal");
  std::vector<Case> cases = {{"spinodal", spinodal, 0, best}};
  for (const auto& law : laws::catalogue())
    if (law->has_states() && law->card().name != "spinodal")
      cases.push_back({std::string(law->card().name), law, 0, best});
  cases.push_back({"spinodal on a contact spring", spinodal, 30, best});
  cases.push_back({"a user's law", laws::make_law<Healing>(), 0, best});
  cases.push_back({"spinodal, AVX2", spinodal, 0, InstructionSet::v3});
  cases.push_back({"spinodal, baseline", spinodal, 0, InstructionSet::baseline});
  json rows;
  double yardstick = 0;
  say(settings, "\nOne step in one of 32 lanes, least of many\n{:<30} {:>9} {:>9} {:>20}\n", "", "unknowns", "ns",
      "per unknown, ratio");
  for (const auto& c : cases) {
    use_instruction_set(c.set);
    oscillators::Model model;
    model.law = c.law;
    model.slider = {1, 1.09, 0};
    model.drive = {1e-5, 1e-2, 0.0};
    if (c.contact_stiffness > 0) model.contact_stiffness.tangential = c.contact_stiffness;
    const oscillators::SliderSystem slider(model);
    oscillators::SliderLanes lanes(slider);
    solvers::lanes::Ensemble ensemble(lanes);
    auto y = slider.steady(0);
    y[0] *= 1.05;
    double least = 1e300;
    for (int repetition = 0; repetition < (settings.quick ? 20 : 400); ++repetition) {
      if (repetition % 20 == 0)
        for (int lane = 0; lane < lane_count; ++lane) ensemble.start(lane, y.data(), 1e-6, 1e-3);
      const auto begin = std::chrono::steady_clock::now();
      for (int k = 0; k < 20; ++k) ensemble.attempt();
      const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
      least = std::min(least, spent.count() / (20 * lane_count));
    }
    const double per_unknown = least / slider.size();
    if (yardstick == 0) yardstick = per_unknown;
    say(settings, "{:<30} {:>9} {:>9.1f} {:>20.2f}\n", c.name, slider.size(), least, per_unknown / yardstick);
    rows.push_back({{"law", c.name},
                    {"unknowns", slider.size()},
                    {"nanoseconds", least},
                    {"per_unknown_over_spinodal", per_unknown / yardstick}});
  }
  use_instruction_set(best);
  return rows;
}

}  // namespace bench
