/// A string as an oscillator that is followed by steps of a sample.
#include "analysis/strings/string_exponent.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/cycles/stepped_exponent.hpp"
#include "analysis/strings/bowing.hpp"
#include "analysis/strings/string_cycle.hpp"

namespace rosin::analysis::strings {

using oscillators::StringLanes;

namespace {

class StringMotion final : public motion::SteppedMotion {
 public:
  explicit StringMotion(const BowedStringModel& model)
      : string_(std::make_unique<StringLanes>(model.string, model.law, model.lambda)), step_(model.string.step()) {
    string_->begin(0, model);
  }
  void start(double t, const std::vector<double>& state) override {
    begin_ = t, steps_ = 0;
    string_->set_state(0, state);
  }
  Outcome advance(double) override {
    string_->step();
    ++steps_;
    return {};
  }
  double time_before() const override { return begin_ + double(steps_ - 1) * step_; }
  double time() const override { return begin_ + double(steps_) * step_; }
  std::vector<double> state() const override { return string_->state(0); }
  int parts() const override { return 1; }
  void observe(double, bool, double*) override {}

 private:
  std::unique_ptr<StringLanes> string_;
  double step_, begin_ = 0;
  long steps_ = 0;
};

}  // namespace

motion::SteppedOscillator stepped(const BowedStringModel& model) {
  require_steady_bow(model);
  const double speed = std::abs(model.speed.value(0));
  StringLanes string(model.string, model.law, model.lambda);
  string.begin(0, model);
  motion::SteppedOscillator oscillator;
  oscillator.natural_period = 1 / string.realised_frequency();
  oscillator.fixed_steps = true;
  oscillator.start = string.state(0), oscillator.size = string.state_sizes();
  for (auto& size : oscillator.size) size *= speed;
  oscillator.motion = [model](double, bool) { return std::make_unique<StringMotion>(model); };
  return oscillator;
}

cycles::LyapunovSpectrum lyapunov_spectrum(const BowedStringModel& model, const cycles::LyapunovOptions& options) {
  auto half = options;
  const auto report = [&](double from) {
    if (options.progress) half.progress = [&options, from](double part) { options.progress(from + part / 2); };
  };
  report(0);
  auto spectrum = cycles::lyapunov_spectrum(stepped(model), half);
  if (!spectrum.outcome.complete()) return spectrum;
  report(0.5);
  const auto same = cycles::lyapunov_spectrum(stepped(finer(model)), half);
  spectrum.cost.steps += same.cost.steps;
  spectrum.levelled = spectrum.levelled && same.levelled;
  if (!same.outcome.complete()) {
    spectrum.outcome = same.outcome;
    return spectrum;
  }
  auto& exponent = spectrum.exponents.front();
  const auto& other = same.exponents.front();
  exponent.error = std::max(
      {exponent.error, other.error, exponent.value == other.value ? 0 : std::abs(exponent.value - other.value)});
  exponent.trivial = exponent.trivial && other.trivial;
  return spectrum;
}

}  // namespace rosin::analysis::strings
