/// Following motions from section to section in lanes: events by taking the step again so that it ends on them.
#include "analysis/lanes/passage_lanes.hpp"

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
/// A landing that misses by more of the step than this is no landing.
constexpr double largest_miss = 0.02;
constexpr double almost_all = 1 - 1e-12;  ///< of a step: what happens at its very end is landed on too
constexpr double differences = 1e-4;      ///< of a step: differentiates what is no polynomial, and not across its ends
constexpr double rest = 1e-11;            ///< slip rates below this part of V are rounding noise at a switch
/// Slip that comes closer to rest than this many times the tolerance of V, or would have gone no further beyond, only
/// just sticks or just does not: one at a time is followed more closely.
constexpr double grazing = 100;
/// Slip that the load brings back from stick grows many times within a step that is short for all else, and an error
/// estimate says nothing of that: from where it is felt, it is followed through no more e-foldings in a step.
constexpr double felt = 1e-3, followed = 1.5;  ///< of the tolerance, as part of V; e-foldings
/// A turn of the slip rate this close to a threshold, as part of it, may lie on either side.
constexpr double touches = 1e-3;
}  // namespace

bool PassageLanes::serves(const SliderSystem& slider) {
  const auto& law = *slider.model().law;
  const auto& drive = slider.model().drive;
  const bool can_stick_and_slip =
      slider.model().slider.stiffness > 0 && drive.speed.level() > 0 && drive.normal_load.level() > 0;
  return slider.mechanics() == Mechanics::inertial && slider.autonomous() &&
         (!law.set_valued() || can_stick_and_slip) && slider.size() <= solvers::lanes::Ensemble::capacity;
}

PassageLanes::PassageLanes(const SliderSystem& pattern, const Recording& recording)
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

/// Where the law has no answer the motion is given up: one at a time will say why.
template <class Question>
PassageLanes::Arrival PassageLanes::answered(Question question) {
  try {
    return question();
  } catch (const InputError&) {
    return Arrival::given_up;
  }
}

template <class F>
double PassageLanes::bisect(F f, double low, double high) {
  constexpr int halvings = 26;  // steps are taken again to land there, and end by Newton's method
  const bool rising = f(low) < 0;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(middle) < 0) == rising ? low : high) = middle;
  }
  return high;
}

/// Contact slip rate less V at `theta` of the last step.
double PassageLanes::section_value(int lane, double theta) const {
  if (rigid_) return ensemble_.interpolate(lane, slip_rate_index, theta) - lanes_[lane].V;
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  interpolate(lane, theta, y.data());
  return lanes_[lane].loaded->contact_slip_rate(0, y.data()) - lanes_[lane].V;
}

void PassageLanes::interpolate(int lane, double theta, double* y) const {
  for (int i = 0; i < sliders_.size(); ++i) y[i] = ensemble_.interpolate(lane, i, theta);
}

template <std::size_t n>
void PassageLanes::interpolate(const double (&theta)[n],
                               std::array<Lanes, solvers::lanes::Ensemble::capacity> (&y)[n]) const {
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p)
      for (int i = 0; i < sliders_.size(); ++i) {
        const auto unknown = ensemble_.polynomial_of_pack(p, i);
        ROSIN_UNROLL
        for (std::size_t k = 0; k < n; ++k) y[k][i].pack[p] = unknown.value(Pack(theta[k]));
      }
  });
}

/// Of a slipping lane.
double PassageLanes::friction_at(int lane, double theta) const {
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  interpolate(lane, theta, y.data());
  const SliderSystem& slider = *lanes_[lane].loaded;
  const auto& model = slider.model();
  return model.law->friction({y[slip_rate_index], model.drive.normal_load.level()}, slider.observe(0, y.data()).state);
}

double PassageLanes::holding_margin(int lane, double theta) const {
  std::array<double, solvers::lanes::Ensemble::capacity> y;
  interpolate(lane, theta, y.data());
  const SliderSystem& slider = *lanes_[lane].loaded;
  return slider.holding_limit(0, y.data()) - std::abs(slider.holding_force(0, y.data()));
}

bool PassageLanes::take(int lane, PassageQueue& queue) {
  Lane& at = lanes_[lane];
  at.passage = queue.next();
  if (!at.passage) return false;
  LanePassage& passage = *at.passage;
  if (at.loaded != passage.slider) {
    sliders_.load(lane, *passage.slider);
    at.loaded = passage.slider;
    at.V = passage.slider->model().drive.speed.level();
    landed_.set(lane, motion::ReversalSteps::near_rest_share * motion::near_rest_slip_rate(*passage.slider));
  }
  if (switches_)
    begin_mode(lane, passage.from_section ? 1 : 0, passage.y.data());
  else
    ensemble_.start(lane, passage.y.data(), passage.tolerance, passage.first_step);
  at.landing = {};
  at.begun = attempts_;
  at.elapsed = at.stuck = 0;
  at.grazes = false;
  const double v = passage.slider->contact_slip_rate(0, passage.y.data());
  V_.set(lane, at.V);
  floor_.set(lane, switches_ ? -infinity : at.V * (1 - passage.dip));
  growth_time_.set(lane, passage.growth_time);
  felt_.set(lane, felt * passage.tolerance * at.V);
  creep_.set(lane, v);
  longest_.set(lane, passage.longest);
  active_.set(lane, 1);
  landing_.set(lane, 0);
  amplitude_.set(lane, 0);
  records_.set(lane, passage.record);
  below_.set(lane, !passage.from_section && v < floor_[lane]);
  armed_.set(lane, 0);
  if (switches_) {
    swing_.set(lane, 0.1 * oscillators::swing_time(passage.slider->model()));
    landing_floor_.set(lane, 0.1 * passage.tolerance * at.V);
  }
  if (passage.record) {
    const double u = passage.y[slip_rate_index], mu = passage.slider->friction_coefficient(0, passage.y.data());
    passage.metrics = {};
    passage.touches_threshold = false;
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

PassageLanes::Event PassageLanes::look_for_events(int lane) {
  Lane& at = lanes_[lane];
  Event first;
  const auto consider = [&](Landing kind, int level, double theta) {
    if (theta < first.theta) first = {kind, level, theta};
  };
  if (switches_) {
    const Event ends = look_for_switch(lane);
    consider(ends.kind, 0, ends.theta);
  }
  if (below_[lane] > 0 && section_[lane] >= at.V)
    consider(Landing::section, 0, bisect([&](double theta) { return section_value(lane, theta); }, 0, 1));
  if (!at.passage->record) return first;
  const Event crosses = look_for_level(lane);
  consider(crosses.kind, crosses.level, crosses.theta);
  if (recording_.extremes) {
    // Only turns that reach beyond what was seen so far: in deep stick, rounding turns at every step.
    const auto consider_turn = [&](Landing kind, const Lanes* slopes, const Lanes& highest, const Lanes& lowest,
                                   double size, auto value, auto slope, double edge = 0) {
      if ((slopes[0][lane] > 0) == (slopes[1][lane] > 0)) return;
      const double theta = bisect(slope, edge, 1 - edge), peak = value(theta);
      const double least = 1e-3 * at.passage->tolerance * size;
      if (peak > highest[lane] + least || peak < lowest[lane] - least) consider(kind, 0, theta);
    };
    const auto slip_rate = ensemble_.polynomial(lane, slip_rate_index);
    consider_turn(
        Landing::slip_rate_extreme, slip_rate_slope_, slip_rate_max_, slip_rate_min_,
        std::max(at.V, std::abs(ensemble_.unknown(slip_rate_index)[lane])),
        [&](double t) { return slip_rate.value(t); }, [&](double t) { return slip_rate.slope(t); });
    const auto consider_friction = [&](auto... how) {
      consider_turn(Landing::friction_extreme, friction_slope_, friction_max_, friction_min_,
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

/// Where the slip rate first crosses one of the levels in the last step, which it may do and come back.
PassageLanes::Event PassageLanes::look_for_level(int lane) {
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
    if (count == 3)
      lanes_[lane].passage->touches_threshold |= std::abs(std::abs(points[1].u) / threshold - 1) < touches;
    for (std::size_t i = 1; i < count; ++i) {
      const Point &a = points[i - 1], &b = points[i];
      const bool begins_inside = std::abs(a.u) <= threshold, ends_inside = std::abs(b.u) <= threshold;
      const bool through = (a.u < 0) != (b.u < 0);
      if (inside ? ends_inside : !ends_inside && !through) continue;
      // After a landing a step may begin a little short of the threshold; then it may only have grazed it.
      const bool grazed = inside ? !begins_inside && !through : begins_inside;
      if (!grazed) {
        const double level = (inside ? b.u : a.u) > 0 ? threshold : -threshold;
        const double theta = bisect([&](double t) { return q.value(t) - level; }, a.theta, b.theta);
        if (theta < first.theta) first = {Landing::level, int(k), theta};
      } else if (!inside || std::abs(b.u) > std::abs(a.u)) {
        cross(lane, int(k), now(lane) - ensemble_.length()[lane]);
      } else {
        continue;  // still on its way in
      }
      break;
    }
  }
  return first;
}

PassageLanes::Event PassageLanes::look_for_switch(int lane) {
  const double direction = sliders_.direction()[lane];
  if (direction == 0) {
    if (holding_margin(lane, 1) >= 0) return {};
    const double theta = bisect([&](double t) { return holding_margin(lane, t); }, 0, 1);
    return {Landing::release, 0, std::min(theta, almost_all)};
  }
  if (!(armed_[lane] > 0)) return {};
  const double V = lanes_[lane].V, close = grazing * lanes_[lane].passage->tolerance * V;
  const auto q = ensemble_.polynomial(lane, slip_rate_index);
  const auto slip = [&](double theta) { return direction * q.value(theta); };
  double end = 1;
  if (!(slip(1) < 0)) {
    // Slip may come to rest between the ends of the step and go on.
    if (!(direction * q.slope(0) < 0 && direction * q.slope(1) > 0)) return {};
    end = bisect([&](double theta) { return q.slope(theta); }, 0, 1);
    if (!(slip(end) < 0)) {
      lanes_[lane].grazes |= slip(end) < close;
      return {};
    }
  }
  const double theta = bisect(slip, 0, end);
  // Beyond rest it would have gone on to where the spring stops it.
  const auto& slider = lanes_[lane].loaded->model().slider;
  const double rate = q.slope(theta) / ensemble_.length()[lane];
  lanes_[lane].grazes |= 0.5 * rate * rate < close * V * slider.stiffness / slider.mass;
  return {Landing::stop, 0, std::min(theta, almost_all)};
}

void PassageLanes::begin_mode(int lane, double direction, const double* y) {
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
  ensemble_.start(lane, y, lanes_[lane].passage->tolerance, first_step);
}

PassageLanes::Arrival PassageLanes::change_mode(int lane) {
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
    // Nothing happens but that the drive loads the spring.
    const double N = model.drive.normal_load.level(), time = (limit - force) / (model.slider.stiffness * at.V);
    y[0] += at.V * time;
    at.elapsed += time;
    at.stuck += time;
    friction_sum_.set(lane, friction_sum_[lane] + 0.5 * (force + limit) / N * time);
    friction_max_.set(lane, std::max(friction_max_[lane], limit / N));
    friction_min_.set(lane, std::min(friction_min_[lane], force / N));
  }
  begin_mode(lane, released ? 1 : sticks ? 0 : force > 0 ? 1 : -1, y.data());
  return released ? Arrival::finished : Arrival::go_on;
}

void PassageLanes::cross(int lane, int level, double moment) {
  Lane& at = lanes_[lane];
  const bool inside = inside_[level][lane] > 0;
  if (inside)
    at.passage->metrics.*levels_[level].member += moment - at.entered[level];
  else
    at.entered[level] = moment;
  inside_[level].set(lane, !inside);
}

PassageLanes::Arrival PassageLanes::arrive(int lane) {
  Lane& at = lanes_[lane];
  const Event event = at.landing;
  // Where exactly the event lies, near the end of the step.
  double theta = 1;
  const auto newton = [&](auto value, auto slope) {
    for (int i = 0; i < 4; ++i) theta -= value(theta) / slope(theta);
  };
  const auto land_on = [&](double level) {
    const auto q = ensemble_.polynomial(lane, slip_rate_index);
    newton([&](double t) { return q.value(t) - level; }, [&](double t) { return q.slope(t); });
  };
  if (event.kind == Landing::section) {
    constexpr double d = differences;
    if (rigid_)
      land_on(at.V);
    else
      newton([&](double t) { return section_value(lane, t); },
             [&](double t) { return (section_value(lane, t + d) - section_value(lane, t - d)) / (2 * d); });
  } else if (event.kind == Landing::stop) {
    land_on(0);
  } else if (event.kind == Landing::release) {
    constexpr double d = differences;
    newton([&](double t) { return holding_margin(lane, t); },
           [&](double t) { return (holding_margin(lane, t + d) - holding_margin(lane, t - d)) / (2 * d); });
  } else if (event.kind == Landing::level) {
    const double threshold = thresholds_[event.level][lane];
    land_on(ensemble_.unknown(slip_rate_index)[lane] > 0 ? threshold : -threshold);
  }
  if (!(std::abs(theta - 1) < largest_miss)) {
    if (theta > 0 && theta < 1) {  // passed already: shorter
      ensemble_.retake(lane, theta);
      return Arrival::retaken;
    }
    at.landing = {};  // not yet there: the next step will cross
    return Arrival::go_on;
  }
  at.landing = {};
  if (event.kind == Landing::level) cross(lane, event.level, now(lane) + (theta - 1) * ensemble_.length()[lane]);
  const bool switched = event.kind == Landing::stop || event.kind == Landing::release;
  if (event.kind != Landing::section && !switched) return Arrival::go_on;
  end_step_at(lane, theta);
  return switched ? Arrival::switched : Arrival::finished;
}

/// The step is summed to its end; what was to be landed on lies a little off.
void PassageLanes::end_step_at(int lane, double theta) {
  const SliderSystem& slider = *lanes_[lane].loaded;
  const bool sticks = switches_ && sliders_.direction()[lane] == 0, records = lanes_[lane].passage->record;
  if (sticks) {  // the contact never bore more than its limit
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

/// Slip that feeds its own growth is followed step by step, and so is slip that comes to rest: friction may turn over
/// within a small part of V.
void PassageLanes::bound_switching_steps() {
  Lanes bounds, growth_rate, acceleration;
  sliders_.pace(ensemble_.unknowns(), growth_rate, acceleration);
  run_on_lanes([&] {
    const Pack zero = 0.0, unbounded = infinity;
    for (int p = 0; p < lane_packs; ++p) {
      const Pack u = ensemble_.unknown(slip_rate_index).pack[p], rate = acceleration.pack[p];
      const Mask slips = abs(sliders_.direction().pack[p]) > zero;
      const Mask slows = (u * rate < zero) & (abs(u) > landing_floor_.pack[p]);
      const Pack growth = select(growth_rate.pack[p] > zero, 1.0 / growth_rate.pack[p], unbounded);
      const Pack landing = select(slows, 0.5 * abs(u / rate), unbounded);
      bounds.pack[p] = select(slips, min(min(swing_.pack[p], growth), landing), unbounded);
    }
  });
  ensemble_.bound_steps(bounds);
}

void PassageLanes::screen() {
  const int levels = int(levels_.size());
  const bool extremes = recording_.extremes;
  run_on_lanes([&] {
    const Pack zero = 0.0, one = 1.0;
    for (int p = 0; p < lane_packs; ++p) {
      const auto holds = [&](const Lanes& x) __attribute__((always_inline)) { return x.pack[p] > zero; };
      const Pack v = section_.pack[p], V = V_.pack[p];
      const Pack u0 = ensemble_.unknown_before(slip_rate_index).pack[p];
      const Pack u1 = ensemble_.unknown(slip_rate_index).pack[p];
      const Mask accepted = ensemble_.accepted_of_pack(p), records = holds(records_);
      const Mask turned = (u0 < zero) ^ (u1 < zero);
      Mask event = holds(below_) & !(v < V);
      for (int k = 0; k < levels; ++k) {
        const Mask inside = holds(inside_[k]), now = !(abs(u1) > thresholds_[k].pack[p]);
        event = event | (records & (inside ^ now)) | (records & !inside & turned);
      }
      if (levels > 0 || extremes) {
        const Pack s0 = slip_rate_slope_[0].pack[p], s1 = slip_rate_slope_[1].pack[p];
        const Mask turns = records & ((s0 > zero) ^ (s1 > zero));
        if (extremes)
          event =
              event | turns | (records & ((friction_slope_[0].pack[p] > zero) ^ (friction_slope_[1].pack[p] > zero)));
        // The turn may reach across a threshold; in deep stick, where rounding turns at every step, it does not.
        const Pack farthest = max(abs(s0), abs(s1)), low = min(abs(u0), abs(u1)), high = max(abs(u0), abs(u1));
        for (int k = 0; k < levels; ++k) {
          const Pack threshold = thresholds_[k].pack[p];
          const Mask inside = holds(inside_[k]);
          event =
              event | (turns & ((inside & (high + farthest > threshold)) | ((!inside) & (low - farthest < threshold))));
        }
      }
      if (switches_) {
        const Pack along = sliders_.direction().pack[p];
        const Mask turns = (along * slip_rate_slope_[0].pack[p] < zero) & (along * slip_rate_slope_[1].pack[p] > zero);
        event = event | !(abs(along) > zero) | (along * u1 < zero) | turns;
      }
      const Mask late = ensemble_.times().pack[p] > longest_.pack[p];
      const Mask active = holds(active_);
      const Mask special = active & (late | holds(landing_) | (accepted & event));
      flagged_.pack[p] = select(special, one, zero);
      counted_.pack[p] = select(active & accepted & records & !special, one, zero);
    }
  });
}

/// Takes note of where the last step has led, in the lanes that are not flagged any more.
void PassageLanes::see() {
  Lanes bounds;
  run_on_lanes([&] {
    const Pack zero = 0.0, one = 1.0;
    for (int p = 0; p < lane_packs; ++p) {
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
      const Pack foldings = max(log(felt_.pack[p] / v), Pack(followed));
      bounds.pack[p] = select(grows, ensemble_.length().pack[p] * foldings / log(v / before), bounds.pack[p]);
      const Pack landed = landed_.pack[p];
      const Mask slows = good & (landed > zero) & (v * before > zero) & (abs(v) < abs(before));
      const Pack loses = max(motion::ReversalSteps::share * abs(v), landed);
      bounds.pack[p] =
          select(slows, min(bounds.pack[p], ensemble_.length().pack[p] * loses / abs(before - v)), bounds.pack[p]);
      update(creep_, v);
    }
  });
  if (!switches_) ensemble_.bound_steps(bounds);
}

void PassageLanes::end(int lane, PassageQueue& queue) {
  Lane& at = lanes_[lane];
  LanePassage& passage = *at.passage;
  passage.tries = attempts_ - at.begun;
  passage.amplitude = amplitude_[lane];
  passage.duration = now(lane);
  passage.last_step = ensemble_.next_length(lane);
  for (int i = 0; i < sliders_.size(); ++i) passage.y[i] = ensemble_.unknown(i)[lane];
  if (rigid_ && !switches_ && passage.ending == Ending::reached_end) passage.y[slip_rate_index] = at.V;
  if (passage.record) {
    cycles::Metrics& m = passage.metrics;
    m.period = passage.duration;
    m.slip_rate_max = slip_rate_max_[lane];
    m.slip_rate_min = slip_rate_min_[lane];
    m.friction_max = friction_max_[lane];
    m.friction_min = friction_min_[lane];
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      double& stuck = m.*levels_[k].member;
      if (inside_[k][lane] > 0) stuck += passage.duration - at.entered[k];
      stuck /= passage.duration;
    }
    m.stick_fraction = m.slow_fraction;
    if (switches_) {
      m.stick_fraction = at.stuck / passage.duration;
      // Stick is rest, which slip comes to within its rounding.
      if (std::abs(m.slip_rate_min) < std::max(1e-10 * at.V, 1e-15 * m.slip_rate_max)) m.slip_rate_min = 0;
    }
    m.loop_area = cycles::follows_steady_curve(*at.loaded) ? 0 : std::abs(loop_[lane]);
    m.friction_mean = friction_sum_[lane] / passage.duration;
    m.slip_rate_mean = slip_rate_sum_[lane] / passage.duration;
    m.loop_area_normalised = m.loop_area / (m.slip_rate_max * m.friction_max);
  }
  at.passage = nullptr;
  active_.set(lane, 0);
  queue.finished(passage);
}

/// Slopes of slip rate and friction at both ends of the last step.
void PassageLanes::measure_steps() {
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
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
  for (int p = 0; p < lane_packs; ++p) {
    friction_slope_[0].pack[p] = (1 / d) * (inside[0].pack[p] - friction_[0].pack[p]);
    friction_slope_[1].pack[p] = (1 / d) * (friction_[1].pack[p] - inside[1].pack[p]);
  }
}

/// Adds the integrals over the last step of the lanes that count. Where friction is an unknown, ∫ μ dv is that of the
/// dense output; functions of v, which ∮ (μ − μ_ss) dv is free to take off, would change it by rounding alone, or where
/// they bend near rest by more than the tolerance.
void PassageLanes::accumulate() {
  if (friction_index_ < 0) return accumulate_at_nodes();
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
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
void PassageLanes::accumulate_at_nodes() {
  constexpr int nodes = 3;
  constexpr double node[nodes] = {0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr double weight[nodes] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  Lanes mu[nodes];
  std::array<Lanes, solvers::lanes::Ensemble::capacity> y[nodes];
  interpolate(node, y);
  for (int k = 0; k < nodes; ++k) sliders_.friction_coefficient(y[k].data(), mu[k]);
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
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

PassageLanes::Arrival PassageLanes::follow(int lane) {
  Lane& at = lanes_[lane];
  if (ensemble_.time(lane) > at.passage->longest || attempts_ - at.begun > most_tries) return Arrival::given_up;
  if (!ensemble_.accepted(lane)) {
    at.landing = {};  // a step that was to land has failed: look again
    landing_.set(lane, 0);
    return Arrival::retaken;
  }
  if (at.landing.kind != Landing::none) {
    const Arrival arrival = arrive(lane);
    if (arrival != Arrival::retaken) landing_.set(lane, 0);
    return arrival;
  }
  const Event event = look_for_events(lane);
  if (at.grazes) return Arrival::given_up;
  if (!(event.theta < 1)) return Arrival::go_on;
  ensemble_.retake(lane, std::max(event.theta, 1e-6));
  at.landing = event;
  landing_.set(lane, 1);
  return Arrival::retaken;
}

void PassageLanes::run(PassageQueue& queue) {
  int working = 0;
  for (int lane = 0; lane < lane_count; ++lane) working += take(lane, queue);
  while (working > 0) {
    end_if_stopped();
    if (switches_) bound_switching_steps();
    ensemble_.attempt();
    ++attempts_;
    sliders_.contact_slip_rate(ensemble_.unknowns(), section_);
    if (switches_ || ((recording_.extremes || !levels_.empty()) && any(records_))) measure_steps();
    screen();
    std::array<bool, lane_count> ended{}, switched{};
    bool any_ended = false, any_switched = false;
    const auto ends = [&](int lane, Ending how) {
      lanes_[lane].passage->ending = how;
      any_ended = ended[lane] = true;
    };
    for (int lane = 0; lane < lane_count; ++lane) {
      const Lane& at = lanes_[lane];
      if (at.passage && attempts_ - at.begun > most_tries) flagged_.set(lane, 1);
      if (!(flagged_[lane] > 0)) continue;
      const Arrival arrival = answered([&] { return follow(lane); });
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
    see();
    if ((recording_.loop_area || recording_.means) && any(counted_)) accumulate();
    for (int lane = 0; any_switched && lane < lane_count; ++lane) {
      if (!switched[lane]) continue;
      const Arrival arrival = answered([&] { return change_mode(lane); });
      if (arrival != Arrival::go_on)
        ends(lane, arrival == Arrival::finished ? Ending::reached_end : Ending::budget_spent);
    }
    if (!any_ended) continue;
    for (int lane = 0; lane < lane_count; ++lane)
      if (ended[lane]) end(lane, queue);
    for (int lane = 0; lane < lane_count; ++lane)
      if (ended[lane] || !lanes_[lane].passage) working += take(lane, queue) - ended[lane];
  }
}

}  // namespace rosin::analysis::lanes
