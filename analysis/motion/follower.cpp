/// A structure followed step by step, the crossings of a section located, and disturbances carried across switches.
#include "analysis/motion/follower.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/stop.hpp"

namespace rosin::analysis::motion {

using solvers::stick_slip::StickSlip;
using solvers::stick_slip::Switch;

Outcome Follower::follow(double t, std::vector<double>& y, double end, const Section* section) {
  StickSlip solver(system_, tolerance_);
  const Count before = count_;
  const auto counted = [&](Outcome outcome) {
    const auto& done = solver.stepper().count();
    count_ = {before.steps + done.steps, before.evaluations + done.evaluations, before.choices + solver.choices()};
    time_ = solver.time();
    return outcome;
  };
  if (section) {
    constexpr double on_it = 1e-7;
    section_value_ = section->value(t, y.data());
    armed_ = std::abs(section_value_) > on_it * section->scale;
  }
  while (t < end) {
    if (!solver.start(t, y))
      return counted({Ending::not_finite, fmt::format("at the start of a piece, t = {:.9g} s", t)});
    if (tangent_)  // no disturbance of a slip rate that stick holds
      for (int c = 0; c < system_.contacts(); ++c)
        if (system_.mode(c) == ContactMode::stick)
          std::fill_n(tangent_->begin() + long(system_.slip_rate_unknown(c)) * columns_, columns_, 0.0);
    const double limit = std::min(end, system_.next_break(t));
    while (solver.time() < limit) {
      end_if_stopped();
      if (before.steps + solver.stepper().count().steps >= most_steps)
        return counted({Ending::budget_spent, fmt::format("{} steps at t = {:.9g} s", most_steps, solver.time())});
      Switch switched;
      if (Outcome outcome = solver.step(limit, switched); !outcome.complete()) return counted(outcome);
      Step& step = solver.stepper();
      if (section && cross_section(step, *section)) {
        if (tangent_) carry_across(step);
        if (observe) observe(step, {}, step.state());
        y = step.state();
        return counted({Ending::event, ""});
      }
      if (tangent_) {
        carry_across(step);
        if (!solver.events().empty()) carry_across_switches(solver);
      }
      if (observe) observe(step, solver.events(), solver.state());
    }
    y = solver.state();
    t = limit;
    if (t < end) system_.cross_break(t, y.data());
  }
  return counted({});
}

/// Looks for crossings within the last step. True where the motion is to end at one: the step then ends there.
bool Follower::cross_section(Step& step, const Section& section) {
  constexpr int nodes = Step::stages;
  std::vector<double> y(step.state().size());
  double low = 0, low_value = section_value_;
  for (int i = 0; i < nodes; ++i) {
    step.stage(i, y.data());
    const double value = section.value(step.stage_time(i), y.data());
    if (armed_ && low_value > 0 && value <= 0) {
      const auto theta = step.locate(section.value, low, step.node(i), low_value, value);
      if (theta && step.solve_at(*theta, y.data()) && section.crossed(step.time_at(*theta), y)) {
        step.shorten(*theta);
        return true;
      }
    }
    if (value < 0) armed_ = true;
    low = step.node(i), low_value = value;
  }
  section_value_ = low_value;
  return false;
}

void Follower::carry_across(Step& step) { step.propagate(*tangent_, columns_); }

std::vector<double> Follower::rates(double t, const std::vector<double>& y) const {
  std::vector<double> f(y.size()), mass(y.size());
  system_.evaluate(t, y.data(), f.data());
  system_.mass(t, mass.data());
  for (std::size_t i = 0; i < f.size(); ++i) f[i] = mass[i] != 0 ? f[i] / mass[i] : 0;
  return f;
}

/// S ← G S + (f₊ − G f₋) (∇h S)/ḣ: h vanishes at the switch, and G is what the switch makes of the unknowns.
/// \param ended  the contact whose slip ended, or −1
void Follower::jump(const std::vector<double>& before, const std::vector<double>& after,
                    const std::vector<double>& gradient, double rate, int ended, const std::vector<double>& y) {
  const int n = int(y.size());
  std::vector<double>& S = *tangent_;
  std::vector<double> turned = before, along(columns_);
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < columns_; ++c) along[c] += gradient[i] * S[i * columns_ + c] / rate;
  if (ended >= 0) {
    const int row = system_.slip_rate_unknown(ended);
    // States that a stop sets, by differences.
    const std::vector<double> S_before = S;
    std::vector<double> scale(n), set = y, ahead, behind;
    system_.scale(y.data(), scale.data());
    system_.stop(ended, set.data());
    for (int i = 0; i < n; ++i) {
      if (i == row || set[i] == y[i]) continue;
      for (int c = 0; c < columns_; ++c) S[i * columns_ + c] = 0;
      turned[i] = 0;
      for (int k = 2 * system_.coordinates(); k < n; ++k) {
        constexpr double aside = 1e-5;
        ahead = behind = y;
        ahead[k] += aside * scale[k], behind[k] -= aside * scale[k];
        system_.stop(ended, ahead.data()), system_.stop(ended, behind.data());
        const double slope = (ahead[i] - behind[i]) / (2 * aside * scale[k]);
        if (slope == 0) continue;
        turned[i] += slope * before[k];
        for (int c = 0; c < columns_; ++c) S[i * columns_ + c] += slope * S_before[k * columns_ + c];
      }
    }
    if (system_.mode(ended) == ContactMode::stick) {
      for (int c = 0; c < columns_; ++c) S[row * columns_ + c] = 0;
      turned[row] = 0;
    }
  }
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < columns_; ++c) S[i * columns_ + c] += (after[i] - turned[i]) * along[c];
}

/// Where several contacts come to rest at one instant each jumps in turn, and what they make others do goes with the
/// last of them.
void Follower::carry_across_switches(const StickSlip& solver) {
  const Step& step = solver.stepper();
  const double t = step.time();
  const std::vector<double>& y = step.state();
  const int n = int(y.size()), count = system_.contacts();
  std::vector<ContactMode> modes(count);
  for (int c = 0; c < count; ++c) modes[c] = system_.mode(c);
  std::vector<int> ended;  // contacts whose slip has ended
  int released = -1;       // the one that gave way by itself
  double least = infinity;
  std::vector<SwitchingSystem::Held> held(count);
  const auto margin = [&](double at, const double* state, int contact) {
    system_.held(at, state, held.data());
    return held[contact].limit - std::abs(held[contact].force);
  };
  for (const auto& [contact, what] : solver.events()) {
    if (modes[contact] != ContactMode::stick) {
      if (what != Switch::slip) ended.push_back(contact);  // a touch of rest changes nothing
    } else if (const double left = margin(t, y.data(), contact) / held[contact].limit; left < least) {
      least = left, released = contact;
    }
  }
  std::vector<double> before = rates(t, y), gradient(n);
  const auto set_upcoming = [&] {
    for (int c = 0; c < count; ++c) system_.set_mode(c, solver.upcoming(c));
  };
  for (std::size_t k = 0; k < ended.size(); ++k) {
    const int contact = ended[k], row = system_.slip_rate_unknown(contact);
    if (k + 1 < ended.size())
      system_.set_mode(contact, solver.upcoming(contact));
    else
      set_upcoming();
    std::vector<double> behind = y;
    system_.stop(contact, behind.data());
    const auto after = rates(t, behind);
    gradient.assign(n, 0.0);
    gradient[row] = 1;
    jump(before, after, gradient, before[row], contact, y);
    before = after;
  }
  if (ended.empty() && released >= 0) {
    set_upcoming();
    const auto after = rates(t, y);
    for (int c = 0; c < count; ++c) system_.set_mode(c, modes[c]);
    double jumps = 0;
    for (int i = 0; i < n; ++i) jumps = std::max(jumps, std::abs(after[i] - before[i]));
    if (jumps > 0) {  // a release without a jump of the force is tangential
      std::vector<double> scale(n), ahead, behind;
      system_.scale(y.data(), scale.data());
      double rate = 0;
      constexpr double aside = 1e-5;
      for (int i = 0; i < n; ++i) {
        ahead = behind = y;
        ahead[i] += aside * scale[i], behind[i] -= aside * scale[i];
        gradient[i] =
            (margin(t, ahead.data(), released) - margin(t, behind.data(), released)) / (2 * aside * scale[i]);
        rate += gradient[i] * before[i];
      }
      if (const double moment = aside * system_.resolution(); std::isfinite(moment))
        rate += (margin(t + moment, y.data(), released) - margin(t - moment, y.data(), released)) / (2 * moment);
      jump(before, after, gradient, rate, -1, y);
    }
  }
  for (int c = 0; c < count; ++c) system_.set_mode(c, modes[c]);
}

}  // namespace rosin::analysis::motion
