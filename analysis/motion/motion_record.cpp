/// Samples, extremes and slips from the dense output of steps.
#include "analysis/motion/motion_record.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <limits>

#include "analysis/motion/stated_error.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::motion {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The vertex of the parabola through three points, where it lies between the outer ones; else NaN.
double vertex(const double* t, double a, double b, double c) {
  const double h0 = t[1] - t[0], h1 = t[2] - t[1];
  const double slope0 = (b - a) / h0, slope1 = (c - b) / h1;
  const double curvature = (slope1 - slope0) / (h0 + h1), slope = (slope0 * h1 + slope1 * h0) / (h0 + h1);
  const double to = -slope / (2 * curvature);
  return curvature < 0 && to > -h0 && to < h1 ? b + slope * to / 2 : nan;
}

}  // namespace

SlipColumns slip_columns(const Model& model, double stick_threshold) {
  const auto& speed = model.drive.speed;
  const bool listed = speed.constant() && std::isfinite(model.slider.stiffness);
  return {.slip_rate = 2,
          .displacement = 0,
          .speed = listed ? speed.level() : 0,
          .stick_threshold = model.law->set_valued() ? 0 : stick_threshold,
          .stiffness = model.slider.stiffness,
          .load = &model.drive.normal_load};
}

MotionRecord::MotionRecord(std::size_t columns, std::size_t watched, const std::vector<double>& times,
                           std::vector<SlipColumns> contacts)
    : times_(times), width_(columns + watched), values_(columns), row_(width_) {
  for (auto& column : values_) column.reserve(times.size());
  for (std::size_t c = 0; c < columns; ++c) extremes_.push_back({c, -1}), extremes_.push_back({c, 1});
  for (const auto& contact : contacts)
    if (contact.speed != 0 && std::isfinite(contact.speed))
      watches_.push_back({contact, false, {}, {contact.slip_rate, std::copysign(1.0, contact.speed)}, {}});
}

double MotionRecord::size(std::size_t column) const {
  return std::max({0.0, extremes_[2 * column].value, extremes_[2 * column + 1].value});
}

void MotionRecord::sample_until(double t, bool closed, const Row& at) {
  for (; next_ < times_.size() && (times_[next_] < t || (closed && times_[next_] == t)); ++next_) {
    end_if_stopped();
    at(times_[next_], row_.data());
    for (std::size_t c = 0; c < values_.size(); ++c) values_[c].push_back(row_[c]);
    include(row_.data());
    if (on_sample) on_sample(times_[next_]);
  }
}

void MotionRecord::include(const double* row) {
  for (auto& extreme : extremes_) extreme.value = std::max(extreme.value, extreme.sign * row[extreme.column]);
}

void MotionRecord::rest(double t, bool closed, const Row& at) {
  at(t, row_.data());
  include(row_.data());
  sample_until(t, closed, at);
}

void MotionRecord::step(double t0, double t1, std::span<const double> inside, const Row& near, const Row& at) {
  const double last = std::nextafter(t1, t0);  // at its end the drive may jump
  step_end_ = t1;
  nodes_.time.assign(1, t0);
  for (const double t : inside)
    if (t > nodes_.time.back() && t < last) nodes_.time.push_back(t);
  if (last > t0) nodes_.time.push_back(last);
  nodes_.rows.resize(nodes_.time.size() * width_);
  for (std::size_t i = 0; i < nodes_.time.size(); ++i)
    (i == 0 || i + 1 == nodes_.time.size() ? at : near)(nodes_.time[i], node(i));
  for (auto& extreme : extremes_) raise(extreme, near, at);
  for (auto& watch : watches_) follow_slip(watch, near, at);
  sample_until(t1, false, at);
}

void MotionRecord::step(solvers::steps::Collocation& step, const Observe& observe) {
  const double t0 = step.time_before(), t1 = step.time(), last = std::nextafter(t1, t0), h = step.length();
  std::vector<double>& y = point_;  // kept between steps
  y.resize(step.state().size());
  std::array<double, solvers::steps::Collocation::stages - 1> inside;
  for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = step.stage_time(int(i));
  const auto row = [&](double t, double* to, bool near) {
    const double* there = y.data();
    if (t <= t0)
      there = step.state_before().data();
    else if (t >= last)
      there = step.state().data();
    else if (near)
      step.interpolate((t - t0) / h, y.data());
    else
      step.solve_at((t - t0) / h, y.data());
    observe(t, there, to);
  };
  this->step(
      t0, t1, inside, [&](double t, double* to) { row(t, to, true); },
      [&](double t, double* to) { row(t, to, false); });
}

/// The highest value in the present step. A highest point that the nodes hint at is looked for on the polynomial, and
/// its value is the solution's: near an extreme, the error of the place enters by its square.
void MotionRecord::raise(Extreme& extreme, const Row& near, const Row& at) {
  const std::size_t last = nodes_.time.size() - 1, c = extreme.column;
  const auto value = [&](std::size_t i) { return extreme.sign * node(i)[c]; };
  extreme.value = std::max({extreme.value, value(0), value(last)});
  const auto look = [&](double from, double to) {
    const auto found = boost::math::tools::brent_find_minima(
        [&](double part) {
          near(std::lerp(from, to, part), row_.data());
          return -extreme.sign * row_[c];
        },
        0.0, 1.0, 26);
    at(std::lerp(from, to, found.first), row_.data());
    if (const double highest = extreme.sign * row_[c]; std::isfinite(highest))
      extreme.value = std::max(extreme.value, highest);
  };
  for (std::size_t i = 1; i < last; ++i) {
    const double a = value(i - 1), b = value(i), d = value(i + 1), top = vertex(&nodes_.time[i - 1], a, b, d);
    const double highest = std::isnan(top) ? b : 2 * top - std::max({a, b, d});  // the parabola is a hint
    constexpr double negligible = 1e-12;  // a motion that repeats has each extreme again and again
    if (highest > extreme.value + negligible * std::abs(extreme.value)) look(nodes_.time[i - 1], nodes_.time[i + 1]);
  }
}

/// Where the slip rate passes the speed of the surface between nodes i − 1 and i.
MotionRecord::Moment MotionRecord::crossing(const Watch& watch, std::size_t i, const Row& at) {
  const double t0 = nodes_.time[i - 1], t1 = nodes_.time[i];
  const auto beyond = [&](double part) {
    at(std::lerp(t0, t1, part), row_.data());
    return row_[watch.of.slip_rate] / watch.of.speed - 1;
  };
  double part = 1;
  const double before = beyond(0), after = beyond(1);
  if (before == 0 || (before > 0) == (after > 0)) {
    part = before == 0 ? 0 : 1;  // the polynomial and the solution differ there
  } else if (after != 0) {
    std::uintmax_t most = 100;
    const auto found = boost::math::tools::toms748_solve(beyond, 0.0, 1.0, before, after,
                                                         boost::math::tools::eps_tolerance<double>(50), most);
    part = found.second;
  }
  const double t = std::lerp(t0, t1, part);
  at(t, row_.data());
  return {t, row_[watch.of.displacement]};
}

void MotionRecord::follow_slip(Watch& watch, const Row& near, const Row& at) {
  if (watch.of.stick_threshold == 0) {  // the contact slips through the whole step, or not at all
    if (watch.begin) raise(watch.peak, near, at);
    return;
  }
  bool raised = false;
  for (std::size_t i = 1; i < nodes_.time.size(); ++i) {
    const double before = node(i - 1)[watch.of.slip_rate] / watch.of.speed,
                 now = node(i)[watch.of.slip_rate] / watch.of.speed;
    if (before < watch.of.stick_threshold) watch.stuck = true;
    if (watch.stuck && before <= 1 && now > 1) {
      watch.begin = crossing(watch, i, at), watch.stuck = false;
      watch.peak.value = -infinity;
      raised = false;
    }
    if (watch.begin && !raised) raise(watch.peak, near, at), raised = true;
    if (watch.begin && before > 1 && now <= 1) end_slip(watch, crossing(watch, i, at));
  }
}

void MotionRecord::end_slip(Watch& watch, const Moment& end) {
  if (end.time > watch.begin->time) watch.slips.push_back({*watch.begin, end, watch.peak.sign * watch.peak.value});
  watch.begin.reset();
}

void MotionRecord::switched(int contact, bool slips) {
  const auto found = std::ranges::find(watches_, contact, [](const Watch& watch) { return watch.of.contact; });
  if (found == watches_.end() || found->of.stick_threshold != 0) return;
  const std::size_t last = nodes_.time.size() - 1;
  const Moment here{step_end_, node(last)[found->of.displacement]};
  if (slips)
    found->begin = here, found->peak.value = -infinity;
  else if (found->begin)
    end_slip(*found, here);
}

SlipEvents MotionRecord::slip_events() const {
  SlipEvents events;
  for (const auto& watch : watches_) {
    double onset_before = nan;
    for (const auto& [begin, end, peak] : watch.slips) {
      const double duration = end.time - begin.time, back = begin.displacement - end.displacement;
      if (watch.of.contact > 0) events.contact.push_back(watch.of.contact);
      events.onset.push_back(begin.time);
      events.duration.push_back(duration);
      events.slip.push_back(watch.of.speed * duration + back);
      events.peak_slip_rate.push_back(peak);
      events.recurrence.push_back(begin.time - onset_before);
      onset_before = begin.time;
      if (watch.of.stiffness == 0) continue;
      events.force_drop.push_back(watch.of.stiffness * back);
      events.friction_drop.push_back(events.force_drop.back() / watch.of.load->value(begin.time));
    }
  }
  return events;
}

double largest_difference(const std::vector<double>& coarse, const std::vector<double>& fine) {
  double largest = 0;
  for (std::size_t i = 0; i < fine.size(); ++i)
    largest = i < coarse.size() ? std::max(largest, std::abs(fine[i] - coarse[i])) : infinity;
  return largest;
}

void state_what_is_seen(const MotionRecord& record, const MotionRecord* other, const std::vector<ErrorRule>& rules,
                        Run& run) {
  for (std::size_t c = 0; c < record.values_.size(); ++c)
    for (const bool high : {false, true}) {
      const double value = high ? record.high(c) : record.low(c);
      if (!std::isfinite(value)) continue;
      const auto name = run.column_names[c] + (high ? "_max" : "_min");
      run.metrics[name] = value;
      const double difference = other ? std::abs(value - (high ? other->high(c) : other->low(c))) : infinity;
      run.metric_error[name] = rules[c].error(difference, record.size(c));
    }
  run.slips = record.slip_events();
  const auto others = other ? other->slip_events() : SlipEvents{};
  if (run.slips.onset.empty()) return;
  const bool same = other && run.slips.onset.size() == others.onset.size() && run.slips.contact == others.contact;
  const auto& of = record.watches_.front().of;
  const double place = 2 * rules.front().error(0, record.size(0));
  const auto state = [&](std::vector<double> SlipEvents::*column, double SlipEvents::Errors::*error, double floor = 0) {
    double difference = same ? 0 : infinity, size = 0;
    for (std::size_t i = 0; i < (run.slips.*column).size(); ++i) {
      const double value = (run.slips.*column)[i];
      if (std::isnan(value)) continue;
      size = std::max(size, std::abs(value));
      if (same) difference = std::max(difference, std::abs(value - (others.*column)[i]));
    }
    const auto& rule = rules.front();
    run.slips.error.*error = rule.times * difference + rule.least * size + floor;
  };
  double least_load = infinity;
  for (const double onset : run.slips.onset)
    if (of.load) least_load = std::min(least_load, of.load->value(onset));
  using Errors = SlipEvents::Errors;
  state(&SlipEvents::onset, &Errors::onset);
  state(&SlipEvents::duration, &Errors::duration);
  state(&SlipEvents::force_drop, &Errors::force_drop, of.stiffness * place);
  state(&SlipEvents::friction_drop, &Errors::friction_drop, of.stiffness * place / least_load);
  state(&SlipEvents::slip, &Errors::slip, place);
  state(&SlipEvents::peak_slip_rate, &Errors::peak_slip_rate, rules[of.slip_rate].floor);
  state(&SlipEvents::recurrence, &Errors::recurrence);
}

void state_event_errors(Run& run, const std::vector<RunEvent>& other, const ErrorRule& rule, double asked) {
  double largest = run.events.size() == other.size() ? 0 : infinity;
  for (std::size_t i = 0; i < std::min(run.events.size(), other.size()); ++i) {
    auto& event = run.events[i];
    const double size = event.time / double(i + 1);  // the mean time between events until then
    if (event.kind == other[i].kind && event.contact == other[i].contact)
      event.error = with_caution(
          rule.error(std::abs(event.time - other[i].time), size) + std::numeric_limits<double>::epsilon() * event.time,
          size, asked);
    largest = std::max(largest, event.error);
  }
  run.metrics["event_time_error"] = largest;
}

}  // namespace rosin::analysis::motion
