/// Values, rates and breaks of signals: binary searches in ascending lists, sums of cosines.
#include "core/signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace rosin {

namespace {

void require_finite(double x, const char* what) {
  if (!std::isfinite(x)) throw InputError(fmt::format("{} = {} is not finite", what, x));
}

/// \throws InputError unless the times are finite and each is later than the one before.
template <class List, class Time>
void require_ascending(const List& list, Time time) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    require_finite(time(list[i]), "time");
    if (i > 0 && !(time(list[i - 1]) < time(list[i])))
      throw InputError(fmt::format("times must ascend, but {} s follows {} s", time(list[i]), time(list[i - 1])));
  }
}

/// The interval [i, i+1) of a table that contains t, for t between its ends.
std::size_t interval(const Signal::Table& table, double t) {
  const auto next = std::upper_bound(table.time.begin(), table.time.end(), t);
  return static_cast<std::size_t>(next - table.time.begin()) - 1;
}

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <class... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

}  // namespace

Signal::Signal(Steps form) : form_(std::move(form)) {
  const auto& steps = std::get<Steps>(form_).steps;
  if (steps.empty()) throw InputError("a list of steps needs at least one [time, value]");
  require_ascending(steps, [](const Step& s) { return s.time; });
  for (const auto& step : steps) require_finite(step.value, "value of a step");
}

Signal::Signal(Ramp form) : form_(form) {
  require_finite(form.from, "start of the ramp");
  require_finite(form.rate, "rate of the ramp");
}

Signal::Signal(Harmonics form) : form_(std::move(form)) {
  const auto& harmonics = std::get<Harmonics>(form_);
  if (harmonics.terms.empty()) throw InputError("a list of harmonics needs at least one");
  require_finite(harmonics.mean, "mean");
  for (const auto& term : harmonics.terms) {
    require_finite(term.amplitude, "amplitude");
    require_finite(term.angular_frequency, "angular frequency");
    require_finite(term.phase, "phase");
  }
}

Signal::Signal(Table form) : form_(std::move(form)) {
  const auto& table = std::get<Table>(form_);
  if (table.time.empty()) throw InputError("a table of a signal needs at least one row");
  if (table.time.size() != table.value.size())
    throw InputError(
        fmt::format("a table of a signal has {} times but {} values", table.time.size(), table.value.size()));
  require_ascending(table.time, [](double t) { return t; });
  for (double value : table.value) require_finite(value, "value in a table");
}

Signal::Signal(Noise form) : form_(MadeNoise{form.mean, std::make_shared<const BandNoise>(form.band)}) {
  require_finite(form.mean, "mean");
}

double Signal::value(double t) const {
  return std::visit(Overloaded{
                        [](double constant) { return constant; },
                        [t](const Steps& form) {
                          const auto next = std::upper_bound(form.steps.begin(), form.steps.end(), t,
                                                             [](double x, const Step& s) { return x < s.time; });
                          return next == form.steps.begin() ? next->value : std::prev(next)->value;
                        },
                        [t](const Ramp& form) { return form.from + form.rate * t; },
                        [t](const Harmonics& form) {
                          double sum = form.mean;
                          for (const auto& h : form.terms)
                            sum += h.amplitude * std::cos(h.angular_frequency * t + h.phase);
                          return sum;
                        },
                        [t](const Table& form) {
                          if (t <= form.time.front()) return form.value.front();
                          if (t >= form.time.back()) return form.value.back();
                          const auto i = interval(form, t);
                          const double part = (t - form.time[i]) / (form.time[i + 1] - form.time[i]);
                          return std::lerp(form.value[i], form.value[i + 1], part);
                        },
                        [t](const MadeNoise& form) { return form.mean + form.noise->value(t); },
                    },
                    form_);
}

double Signal::rate(double t) const {
  return std::visit(Overloaded{
                        [](double) { return 0.0; },
                        [](const Steps&) { return 0.0; },
                        [](const Ramp& form) { return form.rate; },
                        [t](const Harmonics& form) {
                          double sum = 0;
                          for (const auto& h : form.terms)
                            sum -= h.amplitude * h.angular_frequency * std::sin(h.angular_frequency * t + h.phase);
                          return sum;
                        },
                        [t](const Table& form) {
                          if (t < form.time.front() || t >= form.time.back()) return 0.0;
                          const auto i = interval(form, t);
                          return (form.value[i + 1] - form.value[i]) / (form.time[i + 1] - form.time[i]);
                        },
                        [t](const MadeNoise& form) { return form.noise->rate(t); },
                    },
                    form_);
}

Signal::Piece Signal::piece(double t) const {
  const auto* harmonics = std::get_if<Harmonics>(&form_);
  if (!harmonics) return {value(t), rate(t), {}};
  Piece piece{harmonics->mean, 0, {}};
  for (const auto& term : harmonics->terms) {
    if (term.angular_frequency == 0)
      piece.value += term.amplitude * std::cos(term.phase);
    else
      piece.terms.push_back(term);
  }
  return piece;
}

double Signal::next_break(double t) const {
  return std::visit(Overloaded{
                        [](double) { return infinity; },
                        [t](const Steps& form) {  // the first step is no jump: its value holds before it too
                          for (std::size_t i = 1; i < form.steps.size(); ++i)
                            if (form.steps[i].time > t) return form.steps[i].time;
                          return infinity;
                        },
                        [](const Ramp&) { return infinity; },
                        [](const Harmonics&) { return infinity; },
                        [t](const Table& form) {
                          const auto next = std::upper_bound(form.time.begin(), form.time.end(), t);
                          return next == form.time.end() || form.time.size() == 1 ? infinity : *next;
                        },
                        [](const MadeNoise&) { return infinity; },
                    },
                    form_);
}

double Signal::resolution() const {
  if (const auto* noise = std::get_if<MadeNoise>(&form_)) return 1 / (16 * noise->noise->band().high);
  const auto* form = std::get_if<Harmonics>(&form_);
  if (!form) return infinity;
  double fastest = 0;
  for (const auto& h : form->terms) fastest = std::max(fastest, std::abs(h.angular_frequency));
  return fastest > 0 ? 2 * std::numbers::pi / (16 * fastest) : infinity;
}

bool Signal::within(Range range) const {
  return std::visit(Overloaded{
                        [range](double constant) { return range.contains(constant); },
                        [range](const Steps& form) {
                          return std::ranges::all_of(form.steps,
                                                     [range](const Step& s) { return range.contains(s.value); });
                        },
                        [range](const Ramp& form) { return range.contains(form.from); },
                        [range](const Harmonics& form) {
                          double swing = 0;
                          for (const auto& h : form.terms) swing += std::abs(h.amplitude);
                          return range.contains(form.mean - swing) && range.contains(form.mean + swing);
                        },
                        [range](const Table& form) {
                          return std::ranges::all_of(form.value, [range](double v) { return range.contains(v); });
                        },
                        [range](const MadeNoise& form) {
                          return range.contains(form.mean + form.noise->lowest()) &&
                                 range.contains(form.mean + form.noise->highest());
                        },
                    },
                    form_);
}

int Signal::direction() const {
  const int start = value(0) < 0 ? -1 : 1;
  constexpr double least = std::numeric_limits<double>::min();
  if (const auto* ramp = std::get_if<Ramp>(&form_); ramp && start * ramp->rate < 0) return 0;
  return within(start > 0 ? Range{least, infinity} : Range{-infinity, -least}) ? start : 0;
}

double Signal::level() const {
  if (const auto* form = std::get_if<Harmonics>(&form_)) return form->mean;
  if (const auto* form = std::get_if<MadeNoise>(&form_)) return form->mean;
  return value(0);
}

Signal Signal::scaled(double factor, double offset) const {
  const auto at = [=](double value) { return factor * value + offset; };
  return std::visit(Overloaded{
                        [at](double constant) { return Signal(at(constant)); },
                        [at](Steps form) {
                          for (auto& step : form.steps) step.value = at(step.value);
                          return Signal(std::move(form));
                        },
                        [=](const Ramp& form) {
                          return Signal(Ramp{at(form.from), factor * form.rate});
                        },
                        [=](Harmonics form) {
                          form.mean = at(form.mean);
                          for (auto& term : form.terms) term.amplitude *= factor;
                          return Signal(std::move(form));
                        },
                        [at](Table form) {
                          for (auto& value : form.value) value = at(value);
                          return Signal(std::move(form));
                        },
                        [=](const MadeNoise& form) {
                          auto band = form.noise->band();
                          band.rms *= factor;
                          return band.rms > 0 ? Signal(Noise{at(form.mean), band}) : Signal(at(form.mean));
                        },
                    },
                    form_);
}

Signal Signal::with_level(double level) const {
  if (const auto* form = std::get_if<Harmonics>(&form_)) return Signal(Harmonics{level, form->terms});
  if (const auto* form = std::get_if<MadeNoise>(&form_)) {
    Signal changed(level);
    changed.form_ = MadeNoise{level, form->noise};
    return changed;
  }
  return Signal(level);
}

}  // namespace rosin
