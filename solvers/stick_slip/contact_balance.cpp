/// Pivoting from "all hold" to a consistent set of modes.
#include "solvers/stick_slip/contact_balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace rosin::solvers::stick_slip {

namespace {

constexpr double located = 1e-10;  ///< part of the limit within which a located end of stick meets it

class Decision {
 public:
  Decision(SwitchingSystem& system, double t, const double* y, std::span<const Ended> ended,
           std::span<ContactMode> next)
      : system_(system),
        t_(t),
        y_(y),
        ended_(ended),
        next_(next),
        held_(ended.size()),
        acceleration_(ended.size()),
        lets_go_for_good_(ended.size()) {
    for (int i = 0; i < contacts(); ++i) before_.push_back(system.mode(i));
    bool asked = false;
    for (int i = 0; i < contacts(); ++i) {
      if (system.is_elastic(i)) {
        if (!std::exchange(asked, true)) system.held(t, y, held_.data());
        next_[i] = ended[i] == Ended::slip    ? after_slip(i)
                   : ended[i] == Ended::stick ? slip_along(held_[i].force)
                                              : before_[i];
        continue;
      }
      if (ended[i] == Ended::slip || before_[i] == ContactMode::stick) at_rest_.push_back(i);
      next_[i] = ended[i] == Ended::slip ? ContactMode::stick : before_[i];
    }
  }
  ~Decision() {
    for (int i = 0; i < contacts(); ++i) system_.set_mode(i, before_[i]);
  }

  /// \param sign  +1: the most overloaded gives way first; −1: the least
  Balance pivot(int sign) {
    Balance balance;
    order_ = sign;
    const int most_pivots = 10 + 10 * int(at_rest_.size());
    while (balance.pivots < most_pivots) {
      ask();
      int overloaded = 0;
      const int first = next_to_give_way(overloaded);
      if (overloaded > 1 && !system_.contacts_decide_alone()) balance.had_choice = true;
      if (first >= 0 && system_.contacts_decide_alone()) {
        let_all_go();
      } else if (first >= 0) {
        next_[first] = slip_along(held_[first].force);
      } else if (const int back = most_backward(); back >= 0) {
        hold_again(back);
      } else {
        return balance;
      }
      ++balance.pivots;
    }
    if (!enumerate())
      balance.outcome = {Ending::budget_spent,
                         fmt::format("at t = {:.6g} s no modes of {} contacts at rest balance the forces on them", t_,
                                     at_rest_.size())};
    return balance;
  }

 private:
  int contacts() const { return int(ended_.size()); }

  /// Of an elastic contact: rest, but where it bears nothing, as while it is open, slip turns round at once. At the
  /// moment in which it closes it bears nothing either; its slip would go on along the slip before, and it rests.
  ContactMode after_slip(int contact) {
    std::vector<SwitchingSystem::Held> held(ended_.size());
    system_.set_mode(contact, ContactMode::stick);
    system_.held(t_, y_, held.data());
    const ContactMode back = slip_along(-sign(before_[contact]));
    system_.set_mode(contact, back);
    const double along = sign(back) * system_.own_slip_rate(contact, t_, y_);
    system_.set_mode(contact, before_[contact]);
    constexpr double nothing = 1e-9;
    const bool turns = held[contact].limit == 0 && along >= -nothing * system_.reference_speed(contact);
    return turns ? back : ContactMode::stick;
  }

  /// Forces on contacts that stick, and accelerations of those that slip, in the modes of the present trial.
  void ask() {
    for (const int i : at_rest_) system_.set_mode(i, next_[i]);
    system_.held(t_, y_, held_.data());
    if (at_rest_.size() > 1) system_.slip_accelerations(t_, y_, acceleration_.data());
  }

  /// True if contact i, which sticks in the present trial, cannot.
  bool is_overloaded(int i) const {
    const auto& [force, limit, digits] = held_[i];
    if (ended_[i] == Ended::stick) return std::abs(force) >= limit * (1 - located) - digits;
    const bool reverses = ended_[i] == Ended::slip && sign(before_[i]) * force < 0;
    const double doubt = reverses || ended_[i] == Ended::nothing ? digits : 0;
    return mode_at_rest(force, limit + doubt) != ContactMode::stick;
  }

  /// The contact that gives way next, or −1 if all hold. The first is one whose stick has ended, which does so whatever
  /// rounding has left of its limit.
  int next_to_give_way(int& overloaded) const {
    int most = -1;
    double most_part = -infinity;
    bool is_free = true;  // nothing has given way yet
    for (const int i : at_rest_) is_free = is_free && next_[i] == ContactMode::stick;
    for (const int i : at_rest_) {
      if (next_[i] != ContactMode::stick) continue;
      const bool must = is_free && !any_held_again_ && ended_[i] == Ended::stick;
      if (!must && !is_overloaded(i)) continue;
      ++overloaded;
      // A limit of 0 is passed by every force.
      const double part = order_ * (held_[i].limit > 0 ? std::abs(held_[i].force) / held_[i].limit : infinity);
      if (part > most_part) most = i, most_part = part;
    }
    return most;
  }

  /// Of contacts that each decide alone: together, for in one after another each would ask all.
  void let_all_go() {
    for (const int i : at_rest_)
      if (next_[i] == ContactMode::stick && (is_overloaded(i) || (!any_held_again_ && ended_[i] == Ended::stick)))
        next_[i] = slip_along(held_[i].force);
  }

  /// Of the contacts let go, the one that accelerates most against its direction, or −1. One that is alone accelerates
  /// along its force, because kinetic friction is no larger than static.
  int most_backward() const {
    if (at_rest_.size() < 2) return -1;
    int most = -1;
    double most_backward = 0;
    for (const int i : at_rest_) {
      if (next_[i] == ContactMode::stick || lets_go_for_good_[i]) continue;
      const double backward = -sign(next_[i]) * acceleration_[i];
      if (backward > most_backward) most = i, most_backward = backward;
    }
    return most;
  }

  /// Where even then the contact is overloaded the way that it slips, it only seemed to go back, by rounding.
  void hold_again(int i) {
    const ContactMode slip = next_[i];
    next_[i] = ContactMode::stick;
    ask();
    if (is_overloaded(i) && slip_along(held_[i].force) == slip)
      next_[i] = slip, lets_go_for_good_[i] = true;
    else
      any_held_again_ = true;
  }

  /// The first consistent set of all 3ⁿ.
  bool enumerate() {
    constexpr std::size_t most_contacts = 10;
    if (at_rest_.size() > most_contacts) return false;
    long sets = 1;
    for (std::size_t i = 0; i < at_rest_.size(); ++i) sets *= 3;
    for (long set = 0; set < sets; ++set) {
      long digit = set;
      for (const int i : at_rest_) next_[i] = ContactMode(digit % 3 - 1), digit /= 3;
      ask();
      bool consistent = most_backward() < 0;
      for (const int i : at_rest_) consistent = consistent && (next_[i] != ContactMode::stick || !is_overloaded(i));
      if (consistent) return true;
    }
    return false;
  }

  SwitchingSystem& system_;
  double t_;
  const double* y_;
  std::span<const Ended> ended_;
  std::span<ContactMode> next_;
  std::vector<ContactMode> before_;
  std::vector<int> at_rest_;
  std::vector<SwitchingSystem::Held> held_;
  std::vector<double> acceleration_;
  std::vector<bool> lets_go_for_good_;
  bool any_held_again_ = false;
  int order_ = 1;
};

}  // namespace

ContactMode mode_behind_spring(SwitchingSystem& system, int contact, double t, const double* y) {
  const ContactMode before = system.mode(contact);
  std::vector<SwitchingSystem::Held> held(system.contacts());
  system.set_mode(contact, ContactMode::stick);
  system.held(t, y, held.data());
  ContactMode mode = ContactMode::stick;
  if (const auto& [force, limit, digits] = held[contact]; std::abs(force) >= limit * (1 - located) - digits) {
    mode = slip_along(force);
    system.set_mode(contact, mode);
    const double slip_rate = system.own_slip_rate(contact, t, y);
    if (limit == 0)  // it bears nothing, as while it is open
      mode = slip_along(slip_rate);
    else if (!(sign(mode) * slip_rate > 0))
      mode = ContactMode::stick;
  }
  system.set_mode(contact, before);
  return mode;
}

Balance balance_contacts(SwitchingSystem& system, double t, const double* y, std::span<const Ended> ended,
                         std::span<ContactMode> next) {
  Balance balance = Decision(system, t, y, ended, next).pivot(+1);
  if (balance.had_choice) {  // of modes, if another order comes to others
    std::vector<ContactMode> other(next.size());
    Decision(system, t, y, ended, other).pivot(-1);
    balance.had_choice = !std::equal(other.begin(), other.end(), next.begin());
  }
  return balance;
}

}  // namespace rosin::solvers::stick_slip
