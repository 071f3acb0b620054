/// Location of stick, slip and reversal of each contact, and the switch that comes first.
#include "solvers/stick_slip/stick_slip_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/maths.hpp"

namespace rosin::solvers::stick_slip {

namespace {
constexpr double rest = 1e-11;     ///< slip rates below this part of the reference speed are rounding noise at a switch
constexpr double doubtful = 1e-4;  ///< or below this one may be rest: no solution is worse
constexpr std::size_t few_ends = 4;  ///< of modes in one step, which are all located
constexpr double last_digits = 4 * std::numeric_limits<double>::epsilon();  ///< below which part no energy tells more

/// How far a polynomial through the nodes of a step falls below the lowest of them, at most, as a part of the distance
/// to the highest: the largest sum of negative weights.
double below_nodes() {
  static const double most = [] {
    constexpr int fine = 1000;
    double largest = 0;
    for (int i = 0; i <= fine; ++i) {
      double sum = 0;
      for (std::size_t node = 0; node <= steps::Collocation::stages; ++node) {
        std::array<double, steps::Collocation::stages + 1> values{};
        values[node] = 1;
        sum += std::max(0.0, -steps::RadauTableau::get().interpolate(values, double(i) / fine));
      }
      largest = std::max(largest, sum);
    }
    return 1.01 * largest;
  }();
  return most;
}
}  // namespace

void StickSlip::rest_in_doubt(bool even_if_not_held) {
  rest_below(10 * tolerance_ * system_.reference_speed(0), even_if_not_held);
  energy_.rest_in_doubt(tolerance_);
}

std::string name(Switch what) { return what == Switch::stick ? "stick" : what == Switch::slip ? "slip" : "reversal"; }

StickSlip::StickSlip(SwitchingSystem& system, double tolerance, const FreeSwings* swings)
    : system_(system),
      collocation_(system, tolerance),
      energy_(swings, tolerance),
      tolerance_(tolerance),
      contacts_(system.contacts()),
      upcoming_(system.contacts()),
      held_(system.contacts()),
      work_(system.size()),
      jacobian_(system.pattern() ? system.pattern()->entries() : system.size() * system.size()),
      mass_(system.size()) {
  events_.reserve(contacts_.size());
}

bool StickSlip::slips() const {
  for (int i = 0; i < int(contacts_.size()); ++i)
    if (system_.mode(i) != ContactMode::stick) return true;
  return false;
}

bool StickSlip::sticks() const {
  for (int i = 0; i < int(contacts_.size()); ++i)
    if (system_.mode(i) == ContactMode::stick) return true;
  return false;
}

/// Time in which the slip that slows down first halves. Friction may turn over within a small part of the reference
/// speed just before rest, which a step from far above would not see.
double StickSlip::landing_time() {
  const int n = system_.size();
  const Pattern* pattern = system_.pattern();
  bool asked = false;
  double soonest = infinity;
  for (int contact = 0; contact < int(contacts_.size()); ++contact) {
    if (system_.is_elastic(contact)) continue;
    const int i = system_.slip_rate_unknown(contact);
    const double u = state()[i];
    if (system_.mode(contact) == ContactMode::stick || !(std::abs(u) > 1e-8 * system_.reference_speed(contact)))
      continue;
    if (!asked) {
      if (pattern)
        system_.linearise_entries(time(), state().data(), work_.data(), jacobian_.data());
      else
        system_.linearise(time(), state().data(), work_.data(), jacobian_.data());
      system_.mass(time(), mass_.data());
      asked = true;
    }
    double rate = 0;  // of the slip rate
    constexpr double rounding = 1e-14;
    const double terms = pattern ? size_of_terms(*pattern, jacobian_.data(), i, state().data())
                                 : size_of_terms(&jacobian_[i * n], state().data(), n);
    if (std::abs(work_[i]) >= rounding * terms)
      rate = work_[i] / mass_[i];
    else if (collocation_.length() > 0)  // of forces that balance but for their last digits the step before tells
      rate = (u - collocation_.state_before()[i]) / collocation_.length();
    if (u * rate < 0) soonest = std::min(soonest, std::max(0.5 * std::abs(u / rate), 1e-28 * std::abs(time())));
  }
  return soonest;
}

/// Positive while the present mode of the contact lasts. `held_` is of y where it sticks.
double StickSlip::indicator_of_held(int contact, double t, const double* y) const {
  const ContactMode mode = system_.mode(contact);
  return mode == ContactMode::stick ? held_[contact].limit - std::abs(held_[contact].force)
                                    : sign(mode) * system_.own_slip_rate(contact, t, y);
}

/// Rounding must not end a slip at the rest, nor the stick of an elastic contact at the limit, that it started from.
bool StickSlip::may_end(int contact) const {
  return contacts_[contact].armed || (system_.mode(contact) == ContactMode::stick && !system_.is_elastic(contact));
}

double StickSlip::indicator(int contact, double t, const double* y) {
  if (system_.mode(contact) == ContactMode::stick) system_.held(t, y, held_.data());
  return indicator_of_held(contact, t, y);
}

/// True if a stop in y leaves the contact more than rounding short of its limit.
bool StickSlip::holds(int contact, double t, std::vector<double> y) {
  system_.stop(contact, y.data());
  const ContactMode slip = system_.mode(contact);
  system_.set_mode(contact, ContactMode::stick);
  system_.held(t, y.data(), held_.data());
  system_.set_mode(contact, slip);
  constexpr double certainly = 1 - 1e-6;
  return std::abs(held_[contact].force) < certainly * held_[contact].limit;
}

/// Of the present modes. What states forget at rest decides when a contact gives way, and one step may take them
/// through all of it, the same at every tolerance: the first is to resolve it.
bool StickSlip::begin(double t, std::span<const double> y) {
  collocation_.resolve_starts(!slips());
  return collocation_.start(t, y);
}

bool StickSlip::start_slip(double t, std::span<const double> y, ContactMode mode) {
  contacts_[0].armed = switched_ = false;
  upcoming_[0] = mode;
  system_.set_mode(0, mode);
  std::vector<double> released(y.begin(), y.end());
  system_.release(0, t, released.data());
  energy_.begin_at_rest(released.data());
  return begin(t, released);
}

bool StickSlip::start(double t, std::span<const double> y) {
  const int count = int(contacts_.size());
  std::vector<Ended> ended(count);
  bool all_at_rest = true;
  for (int i = 0; i < count; ++i) {
    if (system_.is_elastic(i)) {
      system_.set_mode(i, mode_behind_spring(system_, i, t, y.data()));
      contacts_[i].armed = false;
      continue;
    }
    const double u = y[system_.slip_rate_unknown(i)];
    contacts_[i].armed = std::abs(u) > rest * system_.reference_speed(i);
    all_at_rest = all_at_rest && !contacts_[i].armed;
    ended[i] = contacts_[i].armed ? Ended::nothing : Ended::slip;
    system_.set_mode(i, contacts_[i].armed ? slip_along(u) : ContactMode::forward);
  }
  const Balance balance = balance_contacts(system_, t, y.data(), ended, upcoming_);
  if (!balance.outcome.complete()) return false;
  choices_ += balance.had_choice;
  for (int i = 0; i < count; ++i) system_.set_mode(i, upcoming_[i]);
  switched_ = false;
  energy_.begin_elsewhere();
  if (all_at_rest && slips()) energy_.begin_at_rest(y.data());
  return begin(t, y);
}

/// The modes that follow the last switch.
bool StickSlip::begin_upcoming(double t_limit) {
  for (int i = 0; i < int(contacts_.size()); ++i) {
    const ContactMode before = system_.mode(i);
    if (before == ContactMode::stick || contacts_[i].ended != Ended::nothing) contacts_[i].armed = false;
    system_.set_mode(i, upcoming_[i]);
  }
  for (const auto& [contact, what] : events_)
    if (what == Switch::slip && contacts_[contact].ended != Ended::slip && !system_.is_elastic(contact))
      system_.release(contact, collocation_.time(), behind_switch_.data());
  switched_ = false;
  energy_.begin_elsewhere();
  if (slips()) energy_.begin_at_rest(behind_switch_.data());
  double now = rewinds_ ? 0 : collocation_.time();
  if (rest_ && !rewinds_ && now + rest_->later < t_limit) now += rest_->later;
  return begin(now, behind_switch_);
}

/// Of every contact at the nodes of the last step.
void StickSlip::read_indicators() {
  for (int node = 0; node < nodes; ++node) {
    const double t = node == 0 ? collocation_.time_before() : collocation_.stage_time(node - 1);
    if (node > 0) collocation_.stage(node - 1, work_.data());
    const double* y = node == 0 ? collocation_.state_before().data() : work_.data();
    if (sticks()) system_.held(t, y, held_.data());
    for (int i = 0; i < int(contacts_.size()); ++i) contacts_[i].indicator[node] = indicator_of_held(i, t, y);
  }
}

/// The first node at which the mode of a contact has ended, if any.
StickSlip::End StickSlip::look_at_nodes(int contact) {
  ContactState& at = contacts_[contact];
  const bool sticks = system_.mode(contact) == ContactMode::stick;
  const double small = noise(contact);
  End end{.contact = contact, .low_value = at.indicator[0], .at = {}};
  at.lowest = infinity;
  for (int node = 1; node < nodes; ++node) {
    const double value = at.indicator[node], theta = collocation_.node(node - 1);
    if (!may_end(contact)) {
      if (value > small) at.armed = true;
      if (value > -small) {
        end.low = theta, end.low_value = value;
        continue;
      }
    }
    if (!sticks) at.lowest = std::min(at.lowest, value);
    if (value < 0) {
      end.high = theta, end.high_value = value;
      break;
    }
    end.low = theta, end.low_value = value;
  }
  return end;
}

/// The mode may end and begin again between two nodes and not show at either: the lowest point between them tells.
Outcome StickSlip::look_between_nodes(End& end) {
  const int contact = end.contact;
  ContactState& at = contacts_[contact];
  const bool sticks = system_.mode(contact) == ContactMode::stick;
  const double reference = system_.reference_speed(contact);
  constexpr int fine = 32;
  constexpr double low_beside_highest = 0.05;
  const auto [least, highest_node] = std::ranges::minmax(at.indicator);
  if (const double surely = least - below_nodes() * (highest_node - least);
      surely > low_beside_highest * highest_node && (sticks || surely > doubtful * reference))
    return {};
  const auto between = [&](double theta) { return steps::RadauTableau::get().interpolate(at.indicator, theta); };
  double lowest = 0;
  for (int i = 1; i < fine; ++i)
    if (between(double(i) / fine) < between(lowest)) lowest = double(i) / fine;
  // In the first part too, where slip still slows down, and in steps so short that slip hardly changes in them.
  constexpr double beside = 1e-3 / fine;
  const bool sinks_at_first = at.had_left && between(beside) < between(0),
             rises_at_last = between(1 - beside) < between(1);
  const double value_there = between(lowest);
  const bool is_low = value_there < low_beside_highest * highest_node ||
                      (!sticks && rises_at_last && value_there < doubtful * reference);
  if (!((lowest > 0 || sinks_at_first) && is_low)) return {};
  double left = std::max(0.0, lowest - 1.0 / fine), right = lowest + 1.0 / fine;
  for (int i = 0; i < 40; ++i) {  // ternary search
    const double a = left + (right - left) / 3, b = right - (right - left) / 3;
    if (between(a) < between(b))
      right = b;
    else
      left = a;
  }
  const double theta = 0.5 * (left + right);
  if (!collocation_.solve_at(theta, work_.data())) return {Ending::not_finite, "while looking for a switch"};
  const double t = collocation_.time_at(theta), value = indicator(contact, t, work_.data());
  if (!sticks) at.lowest = std::min(at.lowest, value);
  if (!sticks && value >= 0) {
    if (!energy_.keeps_account()) {
      if (value < touch_ && (touch_rests_ || holds(contact, t, work_))) end.at = theta, end.touched = true;
    } else if (value < doubtful * reference) {
      const bool by_rounding = touch_rests_ && value < last_digits * reference;
      if (by_rounding || energy_.rests(collocation_, t, work_.data())) end.at = theta, end.touched = true;
    }
  }
  if (value < 0) {
    end.high = theta, end.high_value = value, end.low = 0, end.low_value = at.indicator[0];
    for (int i = 0; i < steps::Collocation::stages; ++i)
      if (collocation_.node(i) < theta) end.low = collocation_.node(i), end.low_value = at.indicator[i + 1];
  }
  return {};
}

/// Adds an end to those that are located; `first` is the part of the step after which a mode ends.
bool StickSlip::locate(End& end, double& first) {
  if (!end.touched)
    end.at = collocation_.locate([&](double t, const double* y) { return indicator(end.contact, t, y); }, end.low,
                                 end.high, std::max(end.low_value, 0.0), end.high_value);
  if (!end.at) return false;
  first = std::min(first, *end.at);
  ends_.push_back(end);
  return true;
}

/// The end that comes first by the secant is located; one solution there tells which others have come before it. To
/// locate each would take ten solutions for each.
bool StickSlip::locate_first_of_many(double& first) {
  const auto secant = [](const End& end) {
    const double low = std::max(end.low_value, 0.0);
    return end.touched ? *end.at : end.low + (end.high - end.low) * low / (low - end.high_value);
  };
  while (!found_.empty()) {
    const auto next = std::ranges::min_element(found_, {}, secant);
    if (!locate(*next, first)) return false;
    found_.erase(next);
    if (!collocation_.solve_at(first, work_.data())) return false;
    if (sticks()) system_.held(collocation_.time_at(first), work_.data(), held_.data());
    std::erase_if(found_, [&](End& end) {
      if (end.touched) return *end.at >= first;
      if (end.low >= first) return true;
      end.high = std::min(end.high, first),
      end.high_value = indicator_of_held(end.contact, collocation_.time_at(first), work_.data());
      return end.high_value >= -noise(end.contact);  // what ends at the same instant switch_at finds
    });
  }
  return true;
}

/// Below which an indicator may be rounding. `held_` is of the same place where the contact sticks.
double StickSlip::noise(int contact) const {
  return system_.mode(contact) == ContactMode::stick ? held_[contact].digits : rest * system_.reference_speed(contact);
}

Outcome StickSlip::step(double t_limit, Switch& switched) {
  switched = Switch::none;
  const bool had_begun = !switched_ && collocation_.length() > 0;
  if (switched_ && !begin_upcoming(t_limit)) return {Ending::not_finite, "after a switch"};
  rest_.reset();
  events_.clear();
  collocation_.bound_step(slips() ? std::min({longest_step_, longest_slip_step_, landing_time()}) : longest_step_);
  if (Outcome outcome = collocation_.step(t_limit); !outcome.complete()) return outcome;

  read_indicators();
  found_.clear();
  for (int i = 0; i < int(contacts_.size()); ++i) {
    ContactState& at = contacts_[i];
    const bool sticks = system_.mode(i) == ContactMode::stick;
    at.had_left = sticks ? had_begun : at.armed;
    at.ended = Ended::nothing;
    End end = look_at_nodes(i);
    if (!end.found() && may_end(i))
      if (Outcome outcome = look_between_nodes(end); !outcome.complete()) return outcome;
    if (end.found()) found_.push_back(end);
  }
  double first = infinity;  // part of the step after which a mode ends
  ends_.clear();
  if (found_.size() > few_ends) {
    if (!locate_first_of_many(first)) return {Ending::not_finite, "while locating a switch"};
  } else {
    for (End& end : found_)
      if (end.low <= first && !locate(end, first)) return {Ending::not_finite, "while locating a switch"};
  }
  if (ends_.empty()) {
    energy_.add(collocation_);
    return {};
  }
  if (!collocation_.shorten(first)) return {Ending::not_finite, "while locating a switch"};
  return switch_at(first, switched);
}

/// At the end of the last step, shortened to where the first of `ends_` is.
Outcome StickSlip::switch_at(double theta, Switch& switched) {
  constexpr double same_instant = 1e-14;  // parts of a step that are not told apart
  const int count = int(contacts_.size());
  behind_switch_ = collocation_.state();
  const double t = collocation_.time();
  for (const End& end : ends_)
    if (*end.at <= theta + same_instant) contacts_[end.contact].ended = ended_mode(end.contact);
  if (sticks()) system_.held(t, collocation_.state().data(), held_.data());
  for (int i = 0; i < count; ++i) {
    ContactState& at = contacts_[i];
    if (at.ended == Ended::nothing && count > 1 && may_end(i) &&
        indicator_of_held(i, t, collocation_.state().data()) <= noise(i))
      at.ended = ended_mode(i);
    if (system_.is_elastic(i)) continue;
    if (at.ended == Ended::stick) behind_switch_[system_.slip_rate_unknown(i)] = 0;
    if (at.ended == Ended::slip) system_.stop(i, behind_switch_.data());
  }
  if (energy_.keeps_account()) rest_ = energy_.put_at_rest(collocation_, sign(system_.mode(0)), behind_switch_.data());
  ended_.resize(count);
  for (int i = 0; i < count; ++i) ended_[i] = contacts_[i].ended;
  const Balance balance = balance_contacts(system_, t, behind_switch_.data(), ended_, upcoming_);
  choices_ += balance.had_choice;
  if (!balance.outcome.complete()) return balance.outcome;
  switched_ = true;
  for (int i = 0; i < count; ++i) {
    const ContactMode before = system_.mode(i), after = upcoming_[i];
    const bool touched = std::any_of(ends_.begin(), ends_.end(), [&](const End& end) {
      return end.contact == i && end.touched && contacts_[i].ended == Ended::slip;
    });
    const Switch what = before == after && !touched    ? Switch::none
                        : before == ContactMode::stick ? Switch::slip
                        : after == ContactMode::stick  ? Switch::stick
                        : after != before              ? Switch::reversal
                                                       : Switch::slip;
    if (what != Switch::none) events_.push_back({i, what});
  }
  if (!events_.empty()) switched = events_.front().what;
  return {};
}

}  // namespace rosin::solvers::stick_slip
