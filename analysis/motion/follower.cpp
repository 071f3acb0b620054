/// An oscillator followed step by step, the crossings of a section located, and disturbances carried across switches.
#include "analysis/motion/follower.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/stop.hpp"

namespace rosin::analysis::motion {

using oscillators::StopMode;
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
  for (bool begins = true; t < end; begins = false) {
    const Modes until = modes_now();
    if (!(begins && stops_ ? start_on_stops(solver, t, y) : start(solver, t, y)))
      return counted({Ending::not_finite, fmt::format("at the start of a piece, t = {:.9g} s", t)});
    if (!begins) note_changes(until, t, y);
    const double limit = std::min(end, system_.next_break(t));
    while (solver.time() < limit) {
      end_if_stopped();
      if (before.steps + solver.stepper().count().steps >= most_steps)
        return counted({Ending::budget_spent, fmt::format("{} steps at t = {:.9g} s", most_steps, solver.time())});
      Switch switched;
      if (reversal_steps_ && solver.stepper().length() > 0)
        solver.bound_step(reversal_steps_->longest(solver.stepper()));
      if (Outcome outcome = solver.step(std::min(limit, stops_ ? stops_->horizon(solver.time()) : infinity), switched);
          !outcome.complete())
        return counted(outcome);
      Step& step = solver.stepper();
      if (growth_ && growth_->continues(step.length(), step.state()))
        return counted({Ending::unbounded, growth_->described(solver.time())});
      const int stop = stops_ ? stops_->find(step) : -1;
      if (section && cross_section(step, *section)) {
        if (tangent_) propagate(step);
        if (observe) observe(step, std::exchange(events_, {}));
        y = step.state();
        return counted({Ending::event, ""});
      }
      if (tangent_) propagate(step);
      if (stop >= 0) {
        if (!pass_stops(solver, stop))
          return counted({Ending::not_finite, fmt::format("at a stop, t = {:.9g} s", solver.time())});
        continue;
      }
      if (tangent_ && !solver.events().empty()) carry_across_switches(solver);
      note_switches(solver);
      if (observe) observe(step, events_);
      events_.clear();
      let_go_where_contacts_slip(solver);
    }
    y = solver.state();
    t = limit;
    if (t < end) system_.cross_break(t, y.data());
    if (structure_) structure_->sample(t, y.data());  // also at the end, from which others go on
  }
  return counted({});
}

void Follower::carry(std::vector<double>* tangent, int columns) {
  if (structure_ && !structure_->structure().sampled.empty())
    throw InputError(
        "a servo that samples reads the motion at moments of its own clock, of which its periods are no multiples: "
        "derivatives of its motion are not taken");
  tangent_ = tangent, columns_ = columns;
}

/// Across the last step, with what the parameter adds: d(s f(s t))/dp − (∂M/∂p) ẏ by differences of the varied systems,
/// where s is the period of the drive over that of the one that is followed.
void Follower::propagate(Step& step) {
  if (!varied_.larger.system) return step.propagate(*tangent_, columns_);
  const int n = system_.size();
  for (int c = 0; c < system_.contacts(); ++c)
    for (const auto& varied : {varied_.larger, varied_.smaller}) varied.system->set_mode(c, system_.mode(c));
  std::vector<double> rate(n), f(n), mass(n), by(n);
  step.propagate(*tangent_, columns_, [&](double t, const double* y, double* f_p) {
    system_.evaluate(t, y, rate.data());
    system_.mass(t, mass.data());
    for (int i = 0; i < n; ++i) rate[i] = mass[i] != 0 ? rate[i] / mass[i] : 0;
    for (const double sign : {1.0, -1.0}) {
      const auto& [varied, period] = sign > 0 ? varied_.larger : varied_.smaller;
      varied->evaluate(period * t, y, f.data());
      varied->mass(period * t, mass.data());
      for (int i = 0; i < n; ++i) by[i] = (sign > 0 ? 0 : by[i]) + sign * (period * f[i] - mass[i] * rate[i]);
    }
    std::fill_n(f_p, std::size_t(n) * columns_, 0.0);
    for (int i = 0; i < n; ++i) f_p[i * columns_ + columns_ - 1] = by[i] / (2 * varied_.step);
  });
}

bool Follower::start(StickSlip& solver, double t, const std::vector<double>& y) {
  if (!solver.start(t, y)) return false;
  settle_modes(t, y);
  return true;
}

/// What follows from the modes of contacts at a start.
void Follower::settle_modes(double t, const std::vector<double>& y) {
  if (tangent_)  // no disturbance of a slip rate that stick holds
    for (int c = 0; c < system_.contacts(); ++c)
      if (system_.mode(c) == ContactMode::stick && !system_.is_elastic(c))
        std::fill_n(tangent_->begin() + long(system_.slip_rate_unknown(c)) * columns_, columns_, 0.0);
  // Slip on a surface that rests is slip away from the stop.
  for (int s = 0; s < stop_count(); ++s) {
    const int beside = structure_->contact_beside_stop(s, t);
    if (structure_->stop_mode(s) != StopMode::holds || beside < 0 || system_.mode(beside) == ContactMode::stick)
      continue;
    structure_->set_stop_mode(s, StopMode::open);
    note_stop("leave", s, t, y);
  }
}

void Follower::note_stop(const char* kind, int stop, double t, const std::vector<double>& y) {
  const double displacement = y[structure_->structure().stops[stop].coordinate];
  events_.push_back({.kind = kind, .time = t, .contact = -1, .stop = stop, .displacement = displacement, .speed = 0});
}

void Follower::note_contact(Switch what, int contact, double t, const std::vector<double>& y) {
  events_.push_back({.kind = name(what),
                     .time = t,
                     .contact = contact,
                     .stop = -1,
                     .displacement = system_.displacement(contact, y.data()),
                     .speed = 0});
}

/// Where the drive jumps contacts may switch.
void Follower::note_changes(const Modes& until, double t, const std::vector<double>& y) {
  for (int c = 0; c < system_.contacts(); ++c) {
    const ContactMode before = until.contacts[c], now = system_.mode(c);
    if (before == now) continue;
    note_contact(now == ContactMode::stick      ? Switch::stick
                 : before == ContactMode::stick ? Switch::slip
                                                : Switch::reversal,
                 c, t, y);
  }
}

/// The start of a motion, which may be rest on stops.
bool Follower::start_on_stops(StickSlip& solver, double t, std::vector<double>& y) {
  const auto may_hold = stops_->begin(t, y);
  if (!start(solver, t, y)) return false;
  if (may_hold.empty()) return true;
  for (const int s : may_hold) {
    if (structure_->contact_beside_stop(s, t) < 0 && !(structure_->stop_push(s, t, solver.state().data()) >= 0))
      continue;
    structure_->set_stop_mode(s, StopMode::holds);
    structure_->rest_on_stop(s, t, y.data());
    forget_motion_of(s);
  }
  const bool good = start(solver, t, y);
  events_.clear();  // what does not hold has not rested
  return good;
}

void Follower::note_switches(const StickSlip& solver) {
  for (const auto& [contact, what] : solver.events()) {
    int left = -1;
    for (int s = 0; s < stop_count(); ++s)
      if (what == Switch::slip && structure_->stop_mode(s) == StopMode::holds &&
          structure_->contact_beside_stop(s, solver.time()) == contact)
        left = s;
    if (left >= 0)
      note_stop("leave", left, solver.time(), solver.state());
    else
      note_contact(what, contact, solver.time(), solver.state());
  }
}

void Follower::let_go_where_contacts_slip(const StickSlip& solver) {
  for (const auto& [contact, what] : solver.events())
    for (int s = 0; s < stop_count(); ++s)
      if (what == Switch::slip && structure_->stop_mode(s) == StopMode::holds &&
          structure_->contact_beside_stop(s, solver.time()) == contact)
        structure_->set_stop_mode(s, StopMode::open);
}

void Follower::forget_motion_of(int stop) {
  if (!tangent_) return;
  const int i = structure_->structure().stops[stop].coordinate;
  for (const int row : {i, structure_->coordinates() + i})
    std::fill_n(tangent_->begin() + long(row) * columns_, columns_, 0.0);
}

/// Where the last step ends, a stop switches: then the solution begins anew.
bool Follower::pass_stops(StickSlip& solver, int first) {
  Step& step = solver.stepper();
  const double t = step.time();
  std::vector<double> y = step.state();
  const auto together = stops_->together_with(first, t, y);
  const Modes modes = modes_now();
  std::vector<Event> passed;
  std::vector<std::vector<double>> there, rates_there;
  for (const int s : together) {
    there.push_back(y), rates_there.push_back(rates(t, y));
    passed.push_back(stops_->pass(s, t, y));
  }
  events_.insert(events_.end(), passed.begin(), passed.end());
  const Modes behind = modes_now();
  set_modes(modes);  // the step is told in the modes that it was taken in
  if (observe) observe(step, events_);
  events_.clear();
  set_modes(behind);
  if (!solver.start(t, y)) return false;
  y = solver.state();
  if (tangent_) {
    rates_there.push_back(rates(t, y));
    for (std::size_t k = 0; k < together.size(); ++k)
      carry_across_stop(passed[k], rates_there[k], rates_there[k + 1], there[k]);
  }
  settle_modes(t, y);
  // The force of a stop may jump, and contacts give way; an impact tears its own off without a word.
  for (int c = 0; c < system_.contacts(); ++c)
    if (modes.contacts[c] == ContactMode::stick && behind.contacts[c] == ContactMode::stick &&
        system_.mode(c) != ContactMode::stick)
      note_contact(Switch::slip, c, t, y);
  bool rests = false;
  for (const int s : together) {
    if (Event event; stops_->bounced(s) && stops_->comes_to_rest(s, t, y, event)) {
      events_.push_back(event);
      forget_motion_of(s);
      rests = true;
    }
  }
  return !rests || start(solver, t, y);
}

Follower::Modes Follower::modes_now() const {
  Modes modes;
  for (int c = 0; c < system_.contacts(); ++c) modes.contacts.push_back(system_.mode(c));
  for (int s = 0; s < stop_count(); ++s) modes.stops.push_back(structure_->stop_mode(s));
  return modes;
}

void Follower::set_modes(const Modes& modes) {
  for (int c = 0; c < system_.contacts(); ++c) system_.set_mode(c, modes.contacts[c]);
  for (int s = 0; s < stop_count(); ++s) structure_->set_stop_mode(s, modes.stops[s]);
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

std::vector<double> Follower::rates(double t, const std::vector<double>& y) const {
  std::vector<double> f(y.size()), mass(y.size());
  system_.evaluate(t, y.data(), f.data());
  system_.mass(t, mass.data());
  for (std::size_t i = 0; i < f.size(); ++i) f[i] = mass[i] != 0 ? f[i] / mass[i] : 0;
  return f;
}

/// S ← G S + (f₊ − G f₋) (∇h S + ∂h/∂p)/ḣ: h vanishes at the switch, and G is what the switch makes of the unknowns.
/// \param ended  the contact whose slip ended, or −1
void Follower::jump(const std::vector<double>& before, const std::vector<double>& after,
                    const std::vector<double>& gradient, double rate, double by_parameter, int ended,
                    const std::vector<double>& y) {
  const int n = int(y.size());
  std::vector<double>& S = *tangent_;
  std::vector<double> turned = before, along(columns_);
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < columns_; ++c) along[c] += gradient[i] * S[i * columns_ + c] / rate;
  along[columns_ - 1] += by_parameter / rate;
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
      for (int k = 0; k < n; ++k) {
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

/// Where a gap closes: as a switch, with the velocity reversed by an impact. \param y  before it
void Follower::carry_across_stop(const Event& event, const std::vector<double>& before,
                                 const std::vector<double>& after, const std::vector<double>& y) {
  if (event.kind != "impact" && event.kind != "contact") return;  // else forces are continuous
  const auto& stop = structure_->structure().stops[event.stop];
  const int i = stop.coordinate, row = structure_->coordinates() + i, n = int(y.size());
  std::vector<double>& S = *tangent_;
  std::vector<double> along(columns_), turned = before;
  const double v = stop.side * structure_->stop_speed(event.stop, event.time, y.data());
  for (int c = 0; c < columns_; ++c) along[c] = S[i * columns_ + c] / v;
  if (event.kind == "impact") {
    // Of the slip rate V − v the surface keeps V.
    const double e = stop.restitution, surface = structure_->surface_acceleration(i, event.time);
    for (int c = 0; c < columns_; ++c) S[row * columns_ + c] *= -e;
    turned[row] = -e * before[row] + (1 + e) * surface;
  }
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < columns_; ++c) S[k * columns_ + c] += (after[k] - turned[k]) * along[c];
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
  const auto margin_of = [&](SwitchingSystem& system, double at, const double* state, int contact) {
    system.held(at, state, held.data());
    return held[contact].limit - std::abs(held[contact].force);
  };
  const auto margin = [&](double at, const double* state, int contact) {
    return margin_of(system_, at, state, contact);
  };
  for (const auto& [contact, what] : solver.events()) {
    if (modes[contact] != ContactMode::stick) {
      // A touch of rest changes nothing, nor does stick of an elastic contact.
      if (what != Switch::slip && !system_.is_elastic(contact)) ended.push_back(contact);
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
    jump(before, after, gradient, before[row], 0, contact, y);
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
        gradient[i] = (margin(t, ahead.data(), released) - margin(t, behind.data(), released)) / (2 * aside * scale[i]);
        rate += gradient[i] * before[i];
      }
      if (const double moment = aside * system_.resolution(); std::isfinite(moment))
        rate += (margin(t + moment, y.data(), released) - margin(t - moment, y.data(), released)) / (2 * moment);
      double by_parameter = 0;
      const auto& [larger, smaller, step_of_parameter] = varied_;
      if (larger.system)
        by_parameter = (margin_of(*larger.system, larger.period * t, y.data(), released) -
                        margin_of(*smaller.system, smaller.period * t, y.data(), released)) /
                       (2 * step_of_parameter);
      jump(before, after, gradient, rate, by_parameter, -1, y);
    }
  }
  for (int c = 0; c < count; ++c) system_.set_mode(c, modes[c]);
}

}  // namespace rosin::analysis::motion
