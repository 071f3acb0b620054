/// Returns to the section in lanes. A step that holds an event is retaken so that it ends there.
#include "analysis/lanes/return_lanes.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/cycles/loop_area.hpp"
#include "analysis/cycles/stick_slip_period.hpp"
#include "analysis/motion/reversal_steps.hpp"
#include "core/instruction_set.hpp"
#include "core/stop.hpp"
#include "oscillators/time_scales.hpp"
#include "solvers/stick_slip/contact_balance.hpp"

namespace rosin::analysis::lanes {

using oscillators::Mechanics;
using oscillators::SliderSystem;

namespace {
constexpr int slip_rate_index = 1;
/// Largest distance of a retaken step's end from its event, over the step.
constexpr double largest_miss = 0.02;
constexpr double almost_all = 1 - 1e-12;  ///< part of a step; an event at its very end counts too
constexpr double differences = 1e-4;      ///< part of a step, for numerical derivatives inside it
constexpr double rest = 1e-11;            ///< slip rates below this part of V are rounding noise at a switch
/// Grazing: a lowest slip rate within this many tolerances of V about rest. Lanes give such a motion up, and
/// find_cycle() resolves it.
constexpr double grazing = 100;
/// Slip out of stick can grow by many e-foldings within a step whose error estimate stays small. From `resolved_growth`
/// tolerances of V a step spans at most `most_foldings` e-foldings.
constexpr double resolved_growth = 1e-3, most_foldings = 1.5;  ///< tolerances of V; e-foldings
/// An extremum of the slip rate this close to a threshold, relative to it, may lie on either side.
constexpr double touches = 1e-3;
}  // namespace

bool ReturnLanes::serves(const SliderSystem& slider) {
  const auto& law = *slider.model().law;
  const auto& drive = slider.model().drive;
  const bool can_stick_and_slip =
      slider.model().slider.stiffness > 0 && drive.speed.level() > 0 && drive.normal_load.level() > 0;
  return slider.mechanics() == Mechanics::inertial && slider.autonomous() &&
         (!law.set_valued() || can_stick_and_slip) && slider.size() <= solvers::lanes::Ensemble::capacity;
}

ReturnLanes::ReturnLanes(const SliderSystem& pattern, const Recording& recording)
    : sliders_(pattern),
      ensemble_(sliders_),
      recording_(recording),
      friction_index_(pattern.carries_friction() ? 2 : -1),
      rigid_(pattern.rigid() || !pattern.carries_friction()),
      switches_(sliders_.switches()) {
  if (recording.slow_fraction || (recording.stick_fraction && !switches_))  // a set-valued law sticks exactly
    levels_.push_back({recording.stick_threshold, &cycles::Metrics::slow_fraction});
  if (recording.stick_fraction_001) levels_.push_back({0.01, &cycles::Metrics::stick_fraction_001});
  if (recording.stick_fraction_05) levels_.push_back({0.5, &cycles::Metrics::stick_fraction_05});
}

/// Gives the motion up outside the range of the law; find_cycle() gives the reason.
template <class Question>
ReturnLanes::Arrival ReturnLanes::give_up_on_input_error(Question question) {
  try {
    return question();
  } catch (const InputError&) {
    return Arrival::given_up;
  }
}

template <class F>
double ReturnLanes::bisect(F f, double low, double high) {
  constexpr int halvings = 26;  // the retaken step and Newton's method refine the place
  const bool rising = f(low) < 0;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0) == rising ? low : high) = middle;
  }
  return high;
}

/// Contact slip rate less V at `theta` of the last step.
double ReturnLanes::section_value(int lane, double theta) const {
  if (rigid_) return ensemble_.interpolate(lane, slip_rate_index, theta) - lanes_[lane].V;
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  interpolate(lane, theta, y.data());
  return lanes_[lane].loaded->contact_slip_rate(0, y.data()) - lanes_[lane].V;
}

void ReturnLanes::interpolate(int lane, double theta, double* y) const {
  for (int i = 0; i < sliders_.size(); ++i) y[i] = ensemble_.interpolate(lane, i, theta);
}

template <std::size_t n>
void ReturnLanes::interpolate(const double (&theta)[n],
                              std::array<Lanes, solvers::lanes::Ensemble::capacity> (&y)[n]) const {
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p)
      for (int i = 0; i < sliders_.size(); ++i) {
        const auto unknown = ensemble_.polynomial_of_pack(p, i);
        ROSIN_UNROLL
        for (std::size_t k = 0; k < n; ++k) y[k][i].pack[p] = unknown.value(Pack(theta[k]));
      }
  });
}

/// Coefficient of friction of a slipping lane.
double ReturnLanes::friction_at(int lane, double theta) const {
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  interpolate(lane, theta, y.data());
  const SliderSystem& slider = *lanes_[lane].loaded;
  const auto& model = slider.model();
  return model.law->friction({y[slip_rate_index], model.drive.normal_load.level()}, slider.observe(0, y.data()).state);
}

double ReturnLanes::holding_margin(int lane, double theta) const {
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  interpolate(lane, theta, y.data());
  const SliderSystem& slider = *lanes_[lane].loaded;
  return slider.holding_limit(0, y.data()) - std::abs(slider.holding_force(0, y.data()));
}

bool ReturnLanes::take(int lane, ReturnQueue& queue) {
  Lane& at = lanes_[lane];
  at.task = queue.next();
  if (!at.task) return false;
  LaneReturn& task = *at.task;
  if (at.loaded != task.slider) {
    sliders_.load(lane, *task.slider);
    at.loaded = task.slider;
    at.V = task.slider->model().drive.speed.level();
    near_rest_.set(lane, motion::ReversalSteps::near_rest_share * motion::near_rest_slip_rate(*task.slider));
  }
  if (switches_)
    begin_mode(lane, task.from_section ? 1 : 0, task.y.data());
  else
    ensemble_.start(lane, task.y.data(), task.tolerance, task.first_step);
  at.target = {};
  at.begun = attempts_;
  at.elapsed = at.stuck = 0;
  at.may_graze = false;
  const double v = task.slider->contact_slip_rate(0, task.y.data());
  V_.set(lane, at.V);
  floor_.set(lane, switches_ ? -infinity : at.V * (1 - task.dip));
  growth_time_.set(lane, task.growth_time);
  growth_floor_.set(lane, resolved_growth * task.tolerance * at.V);
  creep_.set(lane, v);
  longest_.set(lane, task.longest);
  active_.set(lane, 1);
  has_target_.set(lane, 0);
  amplitude_.set(lane, 0);
  records_.set(lane, task.record);
  below_.set(lane, !task.from_section && v < floor_[lane]);
  armed_.set(lane, 0);
  if (switches_) {
    swing_.set(lane, 0.1 * oscillators::swing_time(task.slider->model()));
    rest_floor_.set(lane, 0.1 * task.tolerance * at.V);
  }
  if (task.record) {
    const double u = task.y[slip_rate_index], mu = task.slider->friction_coefficient(0, task.y.data());
    task.metrics = {};
    task.touches_threshold = false;
    for (Lanes* extreme : {&slip_rate_max_, &slip_rate_min_}) extreme->set(lane, u);
    for (Lanes* extreme : {&friction_max_, &friction_min_}) extreme->set(lane, mu);
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      thresholds_[k].set(lane, levels_[k].factor * at.V);
      inside_[k].set(lane, std::abs(u) <= thresholds_[k][lane]);
      at.entered[k] = 0;
    }
    for (Lanes* sum : {&loop_, &friction_sum_, &slip_rate_sum_}) sum->set(lane, 0);
  }
  return true;
}

ReturnLanes::Event ReturnLanes::first_event(int lane) {
  Lane& at = lanes_[lane];
  Event first;
  const auto consider = [&](EventKind kind, int level, double theta) {
    if (theta < first.theta) first = {kind, level, theta};
  };
  if (switches_) {
    const Event ends = first_switch(lane);
    consider(ends.kind, 0, ends.theta);
  }
  if (below_[lane] > 0 && section_[lane] >= at.V)
    consider(EventKind::section, 0, bisect([&](double theta) { return section_value(lane, theta); }, 0, 1));
  if (!at.task->record) return first;
  const Event crosses = first_level_crossing(lane);
  consider(crosses.kind, crosses.level, crosses.theta);
  if (recording_.extremes) {
    // Only extrema beyond those so far count: in deep stick rounding error makes one in every step.
    const auto consider_extremum = [&](EventKind kind, const Lanes* slopes, const Lanes& highest, const Lanes& lowest,
                                       double size, auto value, auto slope, double edge = 0) {
      if ((slopes[0][lane] > 0) == (slopes[1][lane] > 0)) return;
      const double theta = bisect(slope, edge, 1 - edge), peak = value(theta);
      const double least = 1e-3 * at.task->tolerance * size;
      if (peak > highest[lane] + least || peak < lowest[lane] - least) consider(kind, 0, theta);
    };
    const auto slip_rate = ensemble_.polynomial(lane, slip_rate_index);
    consider_extremum(
        EventKind::slip_rate_extreme, slip_rate_slope_, slip_rate_max_, slip_rate_min_,
        std::max(at.V, std::abs(ensemble_.unknown(slip_rate_index)[lane])),
        [&](double t) { return slip_rate.value(t); }, [&](double t) { return slip_rate.slope(t); });
    const auto consider_friction = [&](auto... how) {
      consider_extremum(EventKind::friction_extreme, friction_slope_, friction_max_, friction_min_,
                        friction_max_[lane] - friction_min_[lane], how...);
    };
    if (friction_index_ >= 0) {
      const auto friction = ensemble_.polynomial(lane, friction_index_);
      consider_friction([&](double t) { return friction.value(t); }, [&](double t) { return friction.slope(t); });
    } else {
      constexpr double d = differences;
      consider_friction([&](double t) { return friction_at(lane, t); },
                        [&](double t) { return friction_at(lane, t + d) - friction_at(lane, t - d); }, 2 * d);
    }
  }
  return first;
}

/// The first crossing of a level by the slip rate in the last step, which may cross and come back.
ReturnLanes::Event ReturnLanes::first_level_crossing(int lane) {
  Event first;
  struct Point {
    double theta, u;
  };
  const auto q = ensemble_.polynomial(lane, slip_rate_index);
  std::array<Point, 3> points;  // monotonic between them
  std::size_t count = 0;
  points[count++] = {0, ensemble_.unknown_before(slip_rate_index)[lane]};
  if ((slip_rate_slope_[0][lane] > 0) != (slip_rate_slope_[1][lane] > 0)) {
    const double theta = bisect([&](double t) { return q.slope(t); }, 0, 1);
    points[count++] = {theta, q.value(theta)};
  }
  points[count++] = {1, ensemble_.unknown(slip_rate_index)[lane]};
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const double threshold = thresholds_[k][lane];
    const bool inside = inside_[k][lane] > 0;
    if (count == 3) lanes_[lane].task->touches_threshold |= std::abs(std::abs(points[1].u) / threshold - 1) < touches;
    for (std::size_t i = 1; i < count; ++i) {
      const Point &a = points[i - 1], &b = points[i];
      const bool begins_inside = std::abs(a.u) <= threshold, ends_inside = std::abs(b.u) <= threshold;
      const bool through = (a.u < 0) != (b.u < 0);
      if (inside ? ends_inside : !ends_inside && !through) continue;
      // A step that begins at an event may begin just short of the threshold, and then only graze it.
      const bool grazed = inside ? !begins_inside && !through : begins_inside;
      if (!grazed) {
        const double level = (inside ? b.u : a.u) > 0 ? threshold : -threshold;
        const double theta = bisect([&](double t) { return q.value(t) - level; }, a.theta, b.theta);
        if (theta < first.theta) first = {EventKind::level, int(k), theta};
      } else if (!inside || std::abs(b.u) > std::abs(a.u)) {
        cross(lane, int(k), now(lane) - ensemble_.length()[lane]);
      } else {
        continue;  // not yet inside
      }
      break;
    }
  }
  return first;
}

ReturnLanes::Event ReturnLanes::first_switch(int lane) {
  const double direction = sliders_.direction()[lane];
  if (direction == 0) {
    if (holding_margin(lane, 1) >= 0) return {};
    const double theta = bisect([&](double t) { return holding_margin(lane, t); }, 0, 1);
    return {EventKind::release, 0, std::min(theta, almost_all)};
  }
  if (!(armed_[lane] > 0)) return {};
  const double V = lanes_[lane].V, close = grazing * lanes_[lane].task->tolerance * V;
  const auto q = ensemble_.polynomial(lane, slip_rate_index);
  const auto slip = [&](double theta) { return direction * q.value(theta); };
  double end = 1;
  if (!(slip(1) < 0)) {
    // Slip may come to rest between the ends of the step and go on.
    if (!(direction * q.slope(0) < 0 && direction * q.slope(1) > 0)) return {};
    end = bisect([&](double theta) { return q.slope(theta); }, 0, 1);
    if (!(slip(end) < 0)) {
      lanes_[lane].may_graze |= slip(end) < close;
      return {};
    }
  }
  const double theta = bisect(slip, 0, end);
  // Without stick slip would continue below rest, until the spring stops it.
  const auto& slider = lanes_[lane].loaded->model().slider;
  const double rate = q.slope(theta) / ensemble_.length()[lane];
  lanes_[lane].may_graze |= 0.5 * rate * rate < close * V * slider.stiffness / slider.mass;
  return {EventKind::stop, 0, std::min(theta, almost_all)};
}

void ReturnLanes::begin_mode(int lane, double direction, const double* y) {
  constexpr double begins = 1e-4;
  const auto& model = lanes_[lane].loaded->model();
  const auto& s = model.slider;
  double first_step = begins * std::sqrt(s.mass / s.stiffness);
  if (direction == 0) {
    const double margin = lanes_[lane].loaded->holding_limit(0, y) - lanes_[lane].loaded->holding_force(0, y);
    first_step = std::max(begins * margin / (s.stiffness * lanes_[lane].V), 1e-12 * first_step);
  }
  sliders_.set_direction(lane, direction);
  armed_.set(lane, 0);
  ensemble_.start(lane, y, lanes_[lane].task->tolerance, first_step);
}

ReturnLanes::Arrival ReturnLanes::change_mode(int lane) {
  Lane& at = lanes_[lane];
  const SliderSystem& slider = *at.loaded;
  const auto& model = slider.model();
  const double ended = sliders_.direction()[lane];
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  for (int i = 0; i < sliders_.size(); ++i) y[i] = ensemble_.unknown(i)[lane];
  at.elapsed += ensemble_.time(lane);
  if (ended == 0) at.stuck += ensemble_.time(lane);
  if (ended == 0)
    y[slip_rate_index] = 0;
  else
    slider.stop(0, y.data());
  const double force = slider.holding_force(0, y.data()), limit = slider.holding_limit(0, y.data());
  const bool sticks = ended != 0 && solvers::stick_slip::mode_at_rest(force, limit) == ContactMode::stick;
  const bool has_states = sliders_.size() > slip_rate_index + 1;
  const bool released = (ended == 0 && force > 0) || (sticks && !has_states);
  if (sticks && !has_states) {
    // During this stick the drive loads the spring, and no state evolves.
    const double N = model.drive.normal_load.level(), time = (limit - force) / (model.slider.stiffness * at.V);
    y[0] += at.V * time;
    at.elapsed += time;
    at.stuck += time;
    friction_sum_.set(lane, friction_sum_[lane] + 0.5 * (force + limit) / N * time);
    friction_max_.set(lane, std::max(friction_max_[lane], limit / N));
    friction_min_.set(lane, std::min(friction_min_[lane], force / N));
  }
  begin_mode(lane, released ? 1 : sticks ? 0 : force > 0 ? 1 : -1, y.data());
  return released ? Arrival::finished : Arrival::continues;
}

void ReturnLanes::cross(int lane, int level, double moment) {
  Lane& at = lanes_[lane];
  const bool inside = inside_[level][lane] > 0;
  if (inside)
    at.task->metrics.*levels_[level].member += moment - at.entered[level];
  else
    at.entered[level] = moment;
  inside_[level].set(lane, !inside);
}

ReturnLanes::Arrival ReturnLanes::arrive(int lane) {
  Lane& at = lanes_[lane];
  const Event event = at.target;
  // Newton's method refines the place of the event near the end of the step.
  double theta = 1;
  const auto newton = [&](auto value, auto slope) {
    for (int i = 0; i < 4; ++i) theta -= value(theta) / slope(theta);
  };
  const auto land_on = [&](double level) {
    const auto q = ensemble_.polynomial(lane, slip_rate_index);
    newton([&](double t) { return q.value(t) - level; }, [&](double t) { return q.slope(t); });
  };
  if (event.kind == EventKind::section) {
    constexpr double d = differences;
    if (rigid_)
      land_on(at.V);
    else
      newton([&](double t) { return section_value(lane, t); },
             [&](double t) { return (section_value(lane, t + d) - section_value(lane, t - d)) / (2 * d); });
  } else if (event.kind == EventKind::stop) {
    land_on(0);
  } else if (event.kind == EventKind::release) {
    constexpr double d = differences;
    newton([&](double t) { return holding_margin(lane, t); },
           [&](double t) { return (holding_margin(lane, t + d) - holding_margin(lane, t - d)) / (2 * d); });
  } else if (event.kind == EventKind::level) {
    const double threshold = thresholds_[event.level][lane];
    land_on(ensemble_.unknown(slip_rate_index)[lane] > 0 ? threshold : -threshold);
  }
  if (!(std::abs(theta - 1) < largest_miss)) {
    if (theta > 0 && theta < 1) {  // the event lies before the step's end: retake it shorter
      ensemble_.retake(lane, theta);
      return Arrival::retaken;
    }
    at.target = {};  // the event lies in the next step
    return Arrival::continues;
  }
  at.target = {};
  if (event.kind == EventKind::level) cross(lane, event.level, now(lane) + (theta - 1) * ensemble_.length()[lane]);
  const bool switched = event.kind == EventKind::stop || event.kind == EventKind::release;
  if (event.kind != EventKind::section && !switched) return Arrival::continues;
  end_step_at(lane, theta);
  return switched ? Arrival::switched : Arrival::finished;
}

/// Moves the sums of the last step from its end to the event at `theta`.
void ReturnLanes::end_step_at(int lane, double theta) {
  const SliderSystem& slider = *lanes_[lane].loaded;
  const bool sticks = switches_ && sliders_.direction()[lane] == 0, records = lanes_[lane].task->record;
  if (sticks) {  // friction never exceeds the limit of the contact
    std::array<double, solvers::lanes::Ensemble::capacity> y;
    interpolate(lane, theta, y.data());
    friction_[1].set(lane, slider.holding_force(0, y.data()) / slider.model().drive.normal_load.level());
  }
  if (records && recording_.loop_area) {
    const auto slip_rate = ensemble_.polynomial(lane, slip_rate_index);
    const auto rate = [&](double t) {
      return (friction_index_ >= 0 ? ensemble_.interpolate(lane, friction_index_, t) : friction_at(lane, t)) *
             slip_rate.slope(t);
    };
    // Simpson's rule.
    loop_.set(lane, loop_[lane] + (theta - 1) / 6 * (rate(1) + 4 * rate(0.5 * (1 + theta)) + rate(theta)));
  }
  if (records && recording_.means) {
    const double beyond = (theta - 1) * ensemble_.length()[lane];
    const double friction = sticks                 ? friction_[1][lane]
                            : friction_index_ >= 0 ? ensemble_.interpolate(lane, friction_index_, theta)
                                                   : friction_at(lane, theta);
    friction_sum_.set(lane, friction_sum_[lane] + beyond * friction);
    slip_rate_sum_.set(lane, slip_rate_sum_[lane] + beyond * ensemble_.interpolate(lane, slip_rate_index, theta));
  }
  ensemble_.adjust(lane, theta);
}

/// Bounds the steps of slip that grows out of rest to its growth time, and of slip that comes to rest to half its time
/// to rest, because friction may reverse within a small part of V.
void ReturnLanes::bound_switching_steps() {
  Lanes bounds, growth_rate, acceleration;
  sliders_.pace(ensemble_.unknowns(), growth_rate, acceleration);
  run_on_lanes([&] {
    const Pack zero = 0.0, unbounded = infinity;
    for (int p = 0; p < packs_; ++p) {
      const Pack u = ensemble_.unknown(slip_rate_index).pack[p], rate = acceleration.pack[p];
      const Mask slips = abs(sliders_.direction().pack[p]) > zero;
      const Mask slows = (u * rate < zero) & (abs(u) > rest_floor_.pack[p]);
      const Pack growth = select(growth_rate.pack[p] > zero, 1.0 / growth_rate.pack[p], unbounded);
      const Pack stopping = select(slows, 0.5 * abs(u / rate), unbounded);
      bounds.pack[p] = select(slips, min(min(swing_.pack[p], growth), stopping), unbounded);
    }
  });
  ensemble_.bound_steps(bounds);
}

void ReturnLanes::flag_events() {
  const int levels = int(levels_.size());
  const bool extremes = recording_.extremes;
  run_on_lanes([&] {
    const Pack zero = 0.0, one = 1.0;
    for (int p = 0; p < packs_; ++p) {
      const auto holds = [&](const Lanes& x) __attribute__((always_inline)) { return x.pack[p] > zero; };
      const Pack v = section_.pack[p], V = V_.pack[p];
      const Pack u0 = ensemble_.unknown_before(slip_rate_index).pack[p];
      const Pack u1 = ensemble_.unknown(slip_rate_index).pack[p];
      const Mask accepted = ensemble_.accepted_of_pack(p), records = holds(records_);
      const Mask reversed = (u0 < zero) ^ (u1 < zero);
      Mask event = holds(below_) & !(v < V);
      for (int k = 0; k < levels; ++k) {
        const Mask inside = holds(inside_[k]), now = !(abs(u1) > thresholds_[k].pack[p]);
        event = event | (records & (inside ^ now)) | (records & !inside & reversed);
      }
      if (levels > 0 || extremes) {
        const Pack s0 = slip_rate_slope_[0].pack[p], s1 = slip_rate_slope_[1].pack[p];
        const Mask has_extremum = records & ((s0 > zero) ^ (s1 > zero));
        if (extremes)
          event = event | has_extremum |
                  (records & ((friction_slope_[0].pack[p] > zero) ^ (friction_slope_[1].pack[p] > zero)));
        // An extremum may lie across a threshold; the extrema of rounding error in deep stick do not.
        const Pack farthest = max(abs(s0), abs(s1)), low = min(abs(u0), abs(u1)), high = max(abs(u0), abs(u1));
        for (int k = 0; k < levels; ++k) {
          const Pack threshold = thresholds_[k].pack[p];
          const Mask inside = holds(inside_[k]);
          event = event | (has_extremum &
                           ((inside & (high + farthest > threshold)) | ((!inside) & (low - farthest < threshold))));
        }
      }
      if (switches_) {
        const Pack along = sliders_.direction().pack[p];
        const Mask has_extremum =
            (along * slip_rate_slope_[0].pack[p] < zero) & (along * slip_rate_slope_[1].pack[p] > zero);
        event = event | !(abs(along) > zero) | (along * u1 < zero) | has_extremum;
      }
      const Mask late = ensemble_.times().pack[p] > longest_.pack[p];
      const Mask active = holds(active_);
      const Mask special = active & (late | holds(has_target_) | (accepted & event));
      flagged_.pack[p] = select(special, one, zero);
      counted_.pack[p] = select(active & accepted & records & !special, one, zero);
    }
  });
}

/// Updates extremes and step bounds after the last step, in the lanes without a pending event.
void ReturnLanes::update_extremes() {
  Lanes bounds;
  run_on_lanes([&] {
    const Pack zero = 0.0, one = 1.0;
    for (int p = 0; p < packs_; ++p) {
      const Mask good = ensemble_.accepted_of_pack(p) & !(flagged_.pack[p] > zero);
      const Pack v = section_.pack[p], V = V_.pack[p], departure = abs(v - V);
      const auto update = [&](Lanes & x, const Pack& value) __attribute__((always_inline)) {
        x.pack[p] = select(good, value, x.pack[p]);
      };
      update(amplitude_, max(amplitude_.pack[p], departure / V));
      update(below_, select(v < floor_.pack[p], one, below_.pack[p]));
      const Pack u = ensemble_.unknown(slip_rate_index).pack[p];
      update(slip_rate_max_, max(slip_rate_max_.pack[p], u));
      update(slip_rate_min_, min(slip_rate_min_.pack[p], u));
      if (recording_.extremes) {
        const Pack &mu0 = friction_[0].pack[p], &mu1 = friction_[1].pack[p];
        update(friction_max_, max(friction_max_.pack[p], max(mu0, mu1)));
        update(friction_min_, min(friction_min_.pack[p], min(mu0, mu1)));
      }
      if (switches_) update(armed_, select(sliders_.direction().pack[p] * u > rest * V, one, armed_.pack[p]));
      bounds.pack[p] = select(departure < 0.9 * V, growth_time_.pack[p], Pack(infinity));
      const Pack before = creep_.pack[p];
      const Mask grows = good & (before > zero) & (v > before) & (v < 0.1 * V);
      const Pack foldings = max(log(growth_floor_.pack[p] / v), Pack(most_foldings));
      bounds.pack[p] = select(grows, ensemble_.length().pack[p] * foldings / log(v / before), bounds.pack[p]);
      const Pack near_rest = near_rest_.pack[p];
      const Mask slows = good & (near_rest > zero) & (v * before > zero) & (abs(v) < abs(before));
      const Pack loses = max(motion::ReversalSteps::share * abs(v), near_rest);
      bounds.pack[p] =
          select(slows, min(bounds.pack[p], ensemble_.length().pack[p] * loses / abs(before - v)), bounds.pack[p]);
      update(creep_, v);
    }
  });
  if (!switches_) ensemble_.bound_steps(bounds);
}

void ReturnLanes::end(int lane, ReturnQueue& queue) {
  Lane& at = lanes_[lane];
  LaneReturn& task = *at.task;
  task.tries = attempts_ - at.begun;
  task.amplitude = amplitude_[lane];
  task.duration = now(lane);
  task.last_step = ensemble_.next_length(lane);
  for (int i = 0; i < sliders_.size(); ++i) task.y[i] = ensemble_.unknown(i)[lane];
  if (rigid_ && !switches_ && task.ending == Ending::reached_end) task.y[slip_rate_index] = at.V;
  if (task.record) {
    cycles::Metrics& m = task.metrics;
    m.period = task.duration;
    m.slip_rate_max = slip_rate_max_[lane];
    m.slip_rate_min = slip_rate_min_[lane];
    m.friction_max = friction_max_[lane];
    m.friction_min = friction_min_[lane];
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      double& stuck = m.*levels_[k].member;
      if (inside_[k][lane] > 0) stuck += task.duration - at.entered[k];
      stuck /= task.duration;
    }
    m.stick_fraction = m.slow_fraction;
    if (switches_) {
      m.stick_fraction = at.stuck / task.duration;
      // Stick is rest, which slip reaches to within rounding error.
      if (std::abs(m.slip_rate_min) < std::max(1e-10 * at.V, 1e-15 * m.slip_rate_max)) m.slip_rate_min = 0;
    }
    m.loop_area = cycles::follows_steady_curve(*at.loaded) ? 0 : std::abs(loop_[lane]);
    m.friction_mean = friction_sum_[lane] / task.duration;
    m.slip_rate_mean = slip_rate_sum_[lane] / task.duration;
    m.loop_area_normalised = m.loop_area / (m.slip_rate_max * m.friction_max);
  }
  at.task = nullptr;
  active_.set(lane, 0);
  queue.finished(task);
}

/// Slopes of slip rate and friction at both ends of the last step.
void ReturnLanes::measure_steps() {
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p) {
      const auto slip_rate = ensemble_.polynomial_of_pack(p, slip_rate_index);
      for (int end = 0; end < 2; ++end) slip_rate_slope_[end].pack[p] = slip_rate.slope(Pack(double(end)));
      if (friction_index_ < 0 || !recording_.extremes) continue;
      const auto friction = ensemble_.polynomial_of_pack(p, friction_index_);
      for (int end = 0; end < 2; ++end) {
        friction_[end].pack[p] = friction.value(Pack(double(end)));
        friction_slope_[end].pack[p] = friction.slope(Pack(double(end)));
      }
    }
  });
  if (friction_index_ >= 0 || !recording_.extremes) return;
  constexpr double d = 1e-3;
  std::array<Lanes, solvers::lanes::Ensemble::capacity> y[4];
  interpolate({0.0, d, 1 - d, 1.0}, y);
  Lanes inside[2];
  sliders_.friction_coefficient(y[0].data(), friction_[0]);
  sliders_.friction_coefficient(y[1].data(), inside[0]);
  sliders_.friction_coefficient(y[2].data(), inside[1]);
  sliders_.friction_coefficient(y[3].data(), friction_[1]);
  for (int p = 0; p < packs_; ++p) {
    friction_slope_[0].pack[p] = (1 / d) * (inside[0].pack[p] - friction_[0].pack[p]);
    friction_slope_[1].pack[p] = (1 / d) * (friction_[1].pack[p] - inside[1].pack[p]);
  }
}

/// Adds the integrals over the last step in the lanes of `counted_`. Where friction is an unknown, ∫ μ dv comes from
/// the dense output. μ_ss(v) is left out of ∮ (μ − μ_ss) dv, where its integral vanishes; it would add only rounding
/// error, or near rest, where it bends, more than the tolerance.
void ReturnLanes::accumulate() {
  if (friction_index_ < 0) return accumulate_at_nodes();
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p) {
      const Mask counts = counted_.pack[p] > Pack(0.0);
      const auto add = [&](Lanes & sum, const Pack& part) __attribute__((always_inline)) {
        sum.pack[p] = sum.pack[p] + select(counts, part, Pack(0.0));
      };
      const auto slip_rate = ensemble_.polynomial_of_pack(p, slip_rate_index);
      const auto friction = ensemble_.polynomial_of_pack(p, friction_index_);
      add(loop_, friction.integral_by(slip_rate));
      if (!recording_.means) continue;
      const Pack h = ensemble_.length().pack[p];
      add(friction_sum_, h * friction.mean());
      add(slip_rate_sum_, h * slip_rate.mean());
    }
  });
}

/// The same by Gauss's rule with three nodes on the dense output.
void ReturnLanes::accumulate_at_nodes() {
  constexpr int nodes = 3;
  constexpr double node[nodes] = {0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr double weight[nodes] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  Lanes mu[nodes];
  std::array<Lanes, solvers::lanes::Ensemble::capacity> y[nodes];
  interpolate(node, y);
  for (int k = 0; k < nodes; ++k) sliders_.friction_coefficient(y[k].data(), mu[k]);
  run_on_lanes([&] {
    for (int p = 0; p < packs_; ++p) {
      const auto slip_rate = ensemble_.polynomial_of_pack(p, slip_rate_index);
      const Mask counts = counted_.pack[p] > Pack(0.0);
      const auto add = [&](Lanes & sum, const Pack& part) __attribute__((always_inline)) {
        sum.pack[p] = sum.pack[p] + select(counts, part, Pack(0.0));
      };
      if (recording_.loop_area) {
        Pack part = 0.0;
        ROSIN_UNROLL
        for (int k = 0; k < nodes; ++k) part = part + weight[k] * (mu[k].pack[p] * slip_rate.slope(Pack(node[k])));
        add(loop_, part);
      }
      if (recording_.means) {
        const Pack h = ensemble_.length().pack[p];
        Pack friction = 0.0, slip = 0.0;
        for (int k = 0; k < nodes; ++k) {
          friction = friction + weight[k] * mu[k].pack[p];
          slip = slip + weight[k] * y[k][slip_rate_index].pack[p];
        }
        add(friction_sum_, h * friction);
        add(slip_rate_sum_, h * slip);
      }
    }
  });
}

ReturnLanes::Arrival ReturnLanes::follow(int lane) {
  Lane& at = lanes_[lane];
  if (ensemble_.time(lane) > at.task->longest || attempts_ - at.begun > most_tries) return Arrival::given_up;
  if (!ensemble_.accepted(lane)) {
    at.target = {};  // the retaken step failed: events are searched for again
    has_target_.set(lane, 0);
    return Arrival::retaken;
  }
  if (at.target.kind != EventKind::none) {
    const Arrival arrival = arrive(lane);
    if (arrival != Arrival::retaken) has_target_.set(lane, 0);
    return arrival;
  }
  const Event event = first_event(lane);
  if (at.may_graze) return Arrival::given_up;
  if (!(event.theta < 1)) return Arrival::continues;
  ensemble_.retake(lane, std::max(event.theta, 1e-6));
  at.target = event;
  has_target_.set(lane, 1);
  return Arrival::retaken;
}

void ReturnLanes::leave_idle_packs_out() {
  int used = lane_count;
  while (used > 0 && !lanes_[used - 1].task) --used;
  packs_ = (used + pack_width - 1) / pack_width;
  ensemble_.use_packs(packs_);
  sliders_.use_packs(packs_);
}

void ReturnLanes::run(ReturnQueue& queue) {
  int working = 0;
  for (int lane = 0; lane < lane_count; ++lane) working += take(lane, queue);
  leave_idle_packs_out();
  while (working > 0) {
    end_if_stopped();
    if (switches_) bound_switching_steps();
    ensemble_.attempt();
    ++attempts_;
    sliders_.contact_slip_rate(ensemble_.unknowns(), section_);
    if (switches_ || ((recording_.extremes || !levels_.empty()) && any(records_))) measure_steps();
    flag_events();
    std::array<bool, lane_count> ended{}, switched{};
    bool any_ended = false, any_switched = false;
    const auto ends = [&](int lane, Ending how) {
      lanes_[lane].task->ending = how;
      any_ended = ended[lane] = true;
    };
    for (int lane = 0; lane < packs_ * pack_width; ++lane) {
      const Lane& at = lanes_[lane];
      if (at.task && attempts_ - at.begun > most_tries) flagged_.set(lane, 1);
      if (!(flagged_[lane] > 0)) continue;
      const Arrival arrival = give_up_on_input_error([&] { return follow(lane); });
      if (arrival == Arrival::retaken) continue;
      if (arrival == Arrival::given_up) {
        ends(lane, Ending::budget_spent);
        continue;
      }
      if (arrival == Arrival::finished) ends(lane, Ending::reached_end);
      if (arrival == Arrival::switched) any_switched = switched[lane] = true;
      flagged_.set(lane, 0);
      counted_.set(lane, records_[lane]);
    }
    update_extremes();
    if ((recording_.loop_area || recording_.means) && any(counted_)) accumulate();
    for (int lane = 0; any_switched && lane < lane_count; ++lane) {
      if (!switched[lane]) continue;
      const Arrival arrival = give_up_on_input_error([&] { return change_mode(lane); });
      if (arrival != Arrival::continues)
        ends(lane, arrival == Arrival::finished ? Ending::reached_end : Ending::budget_spent);
    }
    if (!any_ended) continue;
    for (int lane = 0; lane < lane_count; ++lane)
      if (ended[lane]) end(lane, queue);
    for (int lane = 0; lane < lane_count; ++lane)
      if (ended[lane] || !lanes_[lane].task) working += take(lane, queue) - ended[lane];
    leave_idle_packs_out();
  }
}

}  // namespace rosin::analysis::lanes
