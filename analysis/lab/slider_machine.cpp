/// The slider as a machine.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lab/machine.hpp"
#include "analysis/lab/tools.hpp"
#include "analysis/steady/stability.hpp"

namespace rosin::analysis::lab {

namespace {

class SliderMachine final : public Machine {
 public:
  explicit SliderMachine(Model model) : model_(std::move(model)) {}

  motion::Run run(const Signal& speed, const motion::RunOptions& options) const override {
    auto driven = model_;
    driven.drive.speed = speed;
    return motion::run(driven, options);
  }
  std::vector<std::string> column_names() const override {
    std::vector<std::string> names = {"displacement", "velocity", "slip_rate", "friction_force",
                                      "friction_coefficient"};
    for (const auto& state : model_.law->states()) names.push_back(state.name);
    return names;
  }
  double settling_time(double V) const override {
    if (curve()) return 0;
    auto sliding = model_;
    sliding.drive.speed = V;
    sliding.drive.force = 0.0;
    const auto found = steady::stability(sliding);
    if (found.eigenvalues.empty()) return 0;
    return found.eigenvalues.front().real() < 0 ? -1 / found.eigenvalues.front().real() : infinity;
  }
  Regime regime(double tolerance) const override;

  double normal_load() const override { return model_.drive.normal_load.level(); }
  double stiffness() const override { return model_.slider.stiffness; }
  bool rigid() const override {
    return model_.slider.mass == 0 && std::isinf(model_.slider.stiffness) && !model_.contact_stiffness.present();
  }
  bool friction_may_jump() const override { return model_.law->set_valued(); }
  CoordinateSum displacement() const override { return {{1}}; }
  CoordinateSum spring_force() const override { return {{1}, model_.slider.stiffness}; }
  const Model* curve() const override { return rigid() && memoryless(model_) ? &model_ : nullptr; }

 private:
  Model model_;
};

Regime SliderMachine::regime(double tolerance) const {
  if (!model_.drive.constant())
    throw InputError("spring-pulled takes a constant drive.speed, normal_load and force; 'rosin run' follows others");
  const double k = model_.slider.stiffness;
  if (!(k > 0) || std::isinf(k))
    throw InputError(fmt::format("oscillator.stiffness = {} must be a spring's (above 0, finite, N/m)", k));
  Regime regime;
  const auto steady = steady::stability(model_);
  regime.stable = steady.stable;
  regime.settling_time = steady.stable ? -1 / steady.eigenvalues.front().real() : 0;
  regime.friction_coefficient = steady.steady.friction_coefficient;
  for (const auto& [path, critical] : {std::pair{"oscillator.stiffness", &regime.critical_stiffness},
                                       std::pair{"drive.normal_load", &regime.critical_load}})
    if (const auto points = steady::hopf_points(model_, path); !points.empty())
      *critical = {points.front().value, points.front().value_error};

  const auto cycle = cycles::find_cycle(model_, {.tolerance = tolerance});
  const auto &seen = cycle.metrics, &error = cycle.error;
  regime.oscillates = seen.period > 0;
  if (!regime.oscillates) {
    regime.why_not = cycle.outcome.detail.empty() ? name(cycle.outcome.ending) : cycle.outcome.detail;
    return regime;
  }
  regime.period = {seen.period, error.period};
  regime.slip_rate_max = {seen.slip_rate_max, error.slip_rate_max};
  regime.stick_fraction = {seen.stick_fraction, error.stick_fraction};
  const auto& orbit = cycle.orbit;
  double low = infinity, high = -infinity, most = 0;
  for (const auto& point : orbit) low = std::min(low, point.displacement), high = std::max(high, point.displacement);
  for (std::size_t i = 1; i + 1 < orbit.size(); ++i) {  // what lies between two points of the orbit, at most
    const double x = orbit[i].displacement;
    if (x == low || x == high)
      most = std::max({most, std::abs(x - orbit[i - 1].displacement), std::abs(x - orbit[i + 1].displacement)});
  }
  regime.force_drop = {k * (high - low), 2 * k * most};
  for (const auto& point : orbit) {
    regime.slip_rate.push_back(point.slip_rate);
    regime.friction_coefficient_over.push_back(point.friction_coefficient);
  }
  return regime;
}

}  // namespace

std::unique_ptr<const Machine> slider_machine(Model model) { return std::make_unique<SliderMachine>(std::move(model)); }

}  // namespace rosin::analysis::lab
