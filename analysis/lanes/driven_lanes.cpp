/// Slip in lanes, stick and the switches between the two lane by lane.
#include "analysis/lanes/driven_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/instruction_set.hpp"
#include "core/pack_cosine.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::lanes {

using oscillators::Structure;

namespace {
constexpr double safety = 0.9, least_factor = 0.2, largest_factor = 5;
constexpr double share_of_event = 0.01;  ///< of the tolerance: what the end of slip may be off by
constexpr int most_stalls = 100;
constexpr long most_attempts = 100'000;  ///< in one period of the force

/// The first θ in (0, 1] at which the cubic with these values and slopes (by θ) at its ends is negative.
double first_negative(double g0, double d0, double g1, double d1) {
  const auto value = [&](double s) {
    const double r = 1 - s;
    return r * r * ((1 + 2 * s) * g0 + s * d0) + s * s * ((1 + 2 * r) * g1 - r * d1);
  };
  constexpr int samples = 16;
  double low = 0, high = 1;
  for (int i = 1; i <= samples; ++i) {
    const double s = double(i) / samples;
    if (value(s) < 0) {
      high = s;
      break;
    }
    low = s;
  }
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (value(middle) < 0 ? high : low) = middle;
  }
  return high;
}

/// The least value of that cubic within its ends.
double least_between(double g0, double d0, double g1, double d1) {
  // g = g0 + d0 s + p s² + q s³
  const double p = 3 * (g1 - g0) - 2 * d0 - d1, q = d0 + d1 - 2 * (g1 - g0);
  const double root = p * p - 3 * q * d0;
  if (root < 0) return std::min(g0, g1);
  // The minimum is where the slope rises through 0.
  const double s = p + std::sqrt(root) != 0 ? -d0 / (p + std::sqrt(root)) : 0;
  return s > 0 && s < 1 ? g0 + s * (d0 + s * (p + s * q)) : std::min(g0, g1);
}
}  // namespace

std::optional<DrivenBlock> DrivenBlock::of(const Structure& s) {
  if (s.size() != 1 || s.contacts.size() != 1 || !s.stops.empty() || !s.limited.empty() || !s.sampled.empty() ||
      !s.functionals.empty() || s.force.size() != 1)
    return {};
  const auto& contact = s.contacts[0];
  if (!contact.law || !contact.law->set_valued() || contact.law->has_states() || contact.normal.size() > 0 ||
      !contact.speed.constant() || !contact.normal_load.constant() || contact.tangential.size() != 1 ||
      contact.tangential[0] != 1 || contact.stiffness.present())
    return {};
  const auto values = contact.law->values();
  if (!std::ranges::all_of(values, [](const Value& value) { return std::holds_alternative<double>(value); })) return {};
  if (!std::isnan(contact.law->slip_kink(1))) return {};
  const auto& force = s.force[0];
  if (force.constant() || force.next_break(0) < infinity || !(s.K(0, 0) > 0)) return {};
  const auto piece = force.piece(0);
  const double period = oscillators::common_period(s);
  if (piece.rate != 0 || !(period > 0)) return {};
  return DrivenBlock{
      s.M(0, 0),   s.K(0, 0), s.C(0, 0), contact.speed.level(), contact.normal_load.level() * contact.load_factor,
      contact.law, piece,     period};
}

bool DrivenLanes::alike(const DrivenBlock& a, const DrivenBlock& b) {
  return a.law->card().name == b.law->card().name && a.force.terms.size() == b.force.terms.size();
}

DrivenLanes::DrivenLanes(const DrivenBlock& pattern, bool disturb)
    : setup_{.unknowns = Unknowns::states}, terms_(pattern.force.terms.size()), disturb_(disturb) {
  contact_ = pattern.law->lanes(setup_);
  for (auto& term : terms_) term.fill(0.0);
}

void DrivenLanes::run(std::span<DrivenMotion> motions) {
  waiting_ = motions;
  active_ = 0;
  for (int lane = 0; lane < lane_count; ++lane) take_next(lane);
  for (;;) {
    for (int lane = 0; lane < lane_count; ++lane)
      while (lanes_[lane].fresh) begin(lane);
    if (active_ == 0) return;
    end_if_stopped();
    attempt();
    for (int lane = 0; lane < lane_count; ++lane)
      if (lanes_[lane].motion) follow(lane);
  }
}

// ---------------------------------------------------------------- a step of all lanes

/// The acceleration of the stage before, and where this one is evaluated.
template <int s>
void DrivenLanes::begin_stage() {
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      const Pack h = h_.pack[p], V = speed_.pack[p];
      if constexpr (s > 0) {
        const Pack v = V - slip_rate_[s - 1].pack[p];
        acceleration_[s - 1].pack[p] = per_mass_.pack[p] * (stiffness_.pack[p] * stage_x_.pack[p] +
                                                            damping_.pack[p] * v - force_.pack[p] - friction_.pack[p]);
      }
      if constexpr (s < Method::stages) {
        Pack rise = 0.0, slipped = 0.0;
        [&]<std::size_t... j>(std::index_sequence<j...>) __attribute__((always_inline)) {
          ((Method::a[s][j] != 0 ? (rise = rise + Method::a[s][j] * acceleration_[j].pack[p],
                                    slipped = slipped + Method::a[s][j] * slip_rate_[j].pack[p], 0)
                                 : 0),
           ...);
        }
        (std::make_index_sequence<s>());
        slip_rate_[s].pack[p] = w_.pack[p] + h * rise;
        stage_x_.pack[p] = x_.pack[p] + h * (Method::c[s] * V - slipped);
        const Pack t = time_.pack[p] + Method::c[s] * h;
        Pack force = mean_.pack[p];
        for (const auto& [amplitude, frequency, phase] : terms_)
          force = force + amplitude.pack[p] * cos(frequency.pack[p] * t + phase.pack[p]);
        force_.pack[p] = force;
      }
    }
  });
}

/// The same of the disturbance: dx′ = −dw, dw′ = (k dx − (c + ∂F/∂w) dw)/m.
template <int s>
void DrivenLanes::begin_disturbed_stage() {
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      const Pack h = h_.pack[p];
      if constexpr (s > 0)
        disturbed_acceleration_[s - 1].pack[p] =
            per_mass_.pack[p] * (stiffness_.pack[p] * stage_dx_.pack[p] -
                                 (damping_.pack[p] + slopes_.F_u.pack[p]) * disturbed_slip_rate_[s - 1].pack[p]);
      if constexpr (s < Method::stages) {
        Pack rise = 0.0, slipped = 0.0;
        [&]<std::size_t... j>(std::index_sequence<j...>) __attribute__((always_inline)) {
          ((Method::a[s][j] != 0 ? (rise = rise + Method::a[s][j] * disturbed_acceleration_[j].pack[p],
                                    slipped = slipped + Method::a[s][j] * disturbed_slip_rate_[j].pack[p], 0)
                                 : 0),
           ...);
        }
        (std::make_index_sequence<s>());
        disturbed_slip_rate_[s].pack[p] = dw_.pack[p] + h * rise;
        stage_dx_.pack[p] = dx_.pack[p] - h * slipped;
      } else {
        Pack rise = 0.0, slipped = 0.0;
        for (int j = 0; j < Method::stages; ++j) {
          rise = rise + Method::b[j] * disturbed_acceleration_[j].pack[p];
          slipped = slipped + Method::b[j] * disturbed_slip_rate_[j].pack[p];
        }
        next_dw_.pack[p] = dw_.pack[p] + h * rise;
        next_dx_.pack[p] = dx_.pack[p] - h * slipped;
      }
    }
  });
}

void DrivenLanes::decide() {
  constexpr double order = Method::estimate_order;
  run_on_lanes([&] {
    for (int p = 0; p < lane_packs; ++p) {
      Pack rise = 0.0, slipped = 0.0, fifth[2] = {0.0, 0.0}, third[2] = {0.0, 0.0};
      [&]<std::size_t... j>(std::index_sequence<j...>) __attribute__((always_inline)) {
        const auto add = [&](int i) __attribute__((always_inline)) {
          const Pack a = acceleration_[i].pack[p], w = slip_rate_[i].pack[p];
          rise = rise + Method::b[i] * a, slipped = slipped + Method::b[i] * w;
          fifth[0] = fifth[0] + Method::fifth[i] * a, fifth[1] = fifth[1] + Method::fifth[i] * w;
          third[0] = third[0] + Method::third[i] * a, third[1] = third[1] + Method::third[i] * w;
        };
        (add(int(j)), ...);
      }
      (std::make_index_sequence<Method::stages>());
      const Pack h = h_.pack[p];
      next_w_.pack[p] = w_.pack[p] + h * rise;
      next_x_.pack[p] = x_.pack[p] + h * (speed_.pack[p] - slipped);
      Pack squares = 0.0, coarse = 0.0;
      for (int i = 0; i < 2; ++i) {
        const Pack per_size = h / ((i == 0 ? speed_size_ : size_).pack[p] * tolerance_.pack[p]);
        const Pack five = per_size * fifth[i], three = per_size * third[i];
        squares = squares + five * five, coarse = coarse + three * three;
      }
      const Pack error = squares / sqrt(max(2.0 * (squares + 0.01 * coarse), Pack(1e-60)));
      error_.pack[p] = error;
      factor_.pack[p] =
          min(max(safety * exp((-1 / order) * log(max(error, Pack(1e-12)))), Pack(least_factor)), Pack(largest_factor));
    }
  });
}

void DrivenLanes::attempt() {
  ContactInput<Lanes> in{0.0, load_, 0.0, direction_};
  [&]<std::size_t... s>(std::index_sequence<s...>) {
    const auto stage = [&]<int number>(std::integral_constant<int, number>) {
      begin_stage<number>();
      in.slip_rate = slip_rate_[number];
      if (disturb_) {
        begin_disturbed_stage<number>();
        contact_->linearise(in, nullptr, nullptr, friction_, slopes_);
      } else {
        contact_->evaluate(in, nullptr, nullptr, friction_);
      }
    };
    (stage(std::integral_constant<int, int(s)>()), ...);
  }
  (std::make_index_sequence<Method::stages>());
  begin_stage<Method::stages>();
  if (disturb_) begin_disturbed_stage<Method::stages>();
  decide();
}

// ---------------------------------------------------------------- what it means for one lane

void DrivenLanes::follow(int lane) {
  auto& at = lanes_[lane];
  const double h = h_[lane], error = error_[lane];
  if (++at.attempts > most_attempts) return give_up(lane, "too many steps in one period of the force");
  if (!(error < 1)) {
    at.step = h * std::min(safety, std::isfinite(error) ? factor_[lane] : least_factor);
    if (!(at.step > 1e-14 * at.motion->block.period)) return give_up(lane, "steps become too short");
    at.locating = false;
    return plan_step(lane);
  }
  const double direction = direction_[lane];
  const double g0 = direction * w_[lane], g1 = direction * next_w_[lane];
  const double slope0 = direction * acceleration_[0][lane];
  const double slope1 = direction * acceleration_[Method::stages - 1][lane];  // at the end of the step, nearly
  const double left = -g1 / slope1;                                           // s, until slip ends
  if (at.locating && slope1 < 0) {
    const double off = std::abs(g1 * left) / at.size + std::abs((slope1 - slope0) / h) * left * left / at.speed_size;
    if (off < share_of_event * at.motion->tolerance || std::abs(left) < 1e-15 * at.motion->block.period)
      return end_slip(lane, left);
  }
  const double rounding = -1e-13 * at.speed_size;
  if (g1 < 0 || least_between(g0, h * slope0, g1, h * slope1) < rounding) {
    // The first end of slip in this step: by its cubic, then by its slope at the end.
    double theta =
        at.locating && slope1 < 0 && g1 > rounding ? 1 + left / h : first_negative(g0, h * slope0, g1, h * slope1);
    if (at.locating && g1 < 0 && slope1 < 0) theta = std::max(1 + left / h, 0.5 * theta);
    at.locating = true;
    if (!(h * theta > 1e-14 * at.motion->block.period)) return end_slip(lane, -h);
    h_.set(lane, h * theta);
    return;
  }
  if (at.locating) {  // just before it
    if (slope1 < 0 && left < h) {
      h_.set(lane, h + left);
      return;
    }
    at.locating = false;
  }
  const bool arrived = time_[lane] + h >= at.motion->block.period * (1 - 1e-15);
  at.step = h * factor_[lane] > at.step || h >= at.step ? h * factor_[lane] : at.step;
  at.stalls = 0;
  x_.set(lane, next_x_[lane]), w_.set(lane, next_w_[lane]);
  dx_.set(lane, next_dx_[lane]), dw_.set(lane, next_dw_[lane]);
  time_.set(lane, time_[lane] + h);
  if (arrived && !arrive(lane, slip_along(direction))) return;
  plan_step(lane);
}

/// \param left  time from the end of the last try to the end of slip, s
void DrivenLanes::end_slip(int lane, double left) {
  auto& at = lanes_[lane];
  const double h = h_[lane] + left;
  // Slip falls to 0 linearly in what is left: its mean is half of what it is there.
  const double x = next_x_[lane] + left * (speed_[lane] - 0.5 * next_w_[lane]);
  at.stalls = h < 1e-9 * at.motion->block.period ? at.stalls + 1 : 0;
  if (at.stalls > most_stalls) return give_up(lane, "slip ends as it begins");
  const int last = Method::stages - 1;
  if (h > 0) {
    x_.set(lane, x);
    dx_.set(lane, next_dx_[lane] - left * next_dw_[lane]);
    dw_.set(lane, next_dw_[lane] + left * disturbed_acceleration_[last][lane]);
  }
  w_.set(lane, 0);
  time_.set(lane, time_[lane] + std::max(h, 0.0));
  settle(lane, acceleration_[last][lane]);
}

void DrivenLanes::settle(int lane, double before) {
  auto& at = lanes_[lane];
  for (;;) {
    const double period = at.motion->block.period, t = time_[lane], x = x_[lane], V = speed_[lane];
    const double holding = held(lane, t, x);
    // A disturbance shifts the moment of a switch, and with it that from which another acceleration counts: the
    // disturbance of the slip rate becomes dw + (before − after) × shift (Aizerman & Gantmakher 1958).
    const auto acceleration = [&](double force) {
      return per_mass_[lane] * (force - std::copysign(at.kinetic, force));
    };
    if (std::abs(holding) > at.limit * (1 + 1e-14)) {
      dw_.set(lane, dw_[lane] * acceleration(holding) / before);
      return slip(lane, holding);
    }
    dw_.set(lane, 0);
    const double stuck = time_to_release(lane, period - t);
    x_.set(lane, x + V * stuck);
    if (t + stuck < period) {
      time_.set(lane, t + stuck);
      const double released = held(lane, t + stuck, x_[lane]);
      const double rate = stiffness_[lane] * V - force_rate(lane, t + stuck);
      dw_.set(lane, acceleration(released) * stiffness_[lane] * dx_[lane] / rate);
      return slip(lane, released);
    }
    time_.set(lane, period);
    if (!arrive(lane, ContactMode::stick)) return;
  }
}

void DrivenLanes::slip(int lane, double direction) {
  auto& at = lanes_[lane];
  w_.set(lane, 0);
  direction_.set(lane, std::copysign(1.0, direction));
  at.locating = false;
  plan_step(lane);
}

void DrivenLanes::plan_step(int lane) {
  auto& at = lanes_[lane];
  const double left = at.motion->block.period - time_[lane];
  // No short step is left before the moment of the force.
  h_.set(lane, at.step >= left ? left : std::min(at.step, std::max(0.5 * left, left - at.step)));
}

double DrivenLanes::time_to_release(int lane, double most) const {
  const auto& at = lanes_[lane];
  const double k = stiffness_[lane], V = speed_[lane], x0 = x_[lane], t0 = time_[lane];
  const double period = at.motion->block.period, shortest = 1e-14 * period;
  double passed = 0;
  for (int i = 0; i < 100'000 && passed < most; ++i) {
    const double t = t0 + passed, force_held = held(lane, t, x0 + V * passed);
    const double rate = k * V - force_rate(lane, t);
    double step = infinity;
    for (const double side : {-1.0, 1.0}) {
      const double margin = std::max(at.limit - side * force_held, 0.0), falls = side * rate;
      if (falls > 0 && margin <= 1e-15 * at.limit) return passed;
      // As far as the margin stays positive whatever the force does within its largest curvature.
      const double reach = at.bend > 0 ? (std::sqrt(falls * falls + 2 * at.bend * margin) - falls) / at.bend
                                       : (falls > 0 ? margin / falls : infinity);
      step = std::min(step, reach);
    }
    passed += std::max(step, shortest);
  }
  return std::min(passed, most);
}

bool DrivenLanes::arrive(int lane, ContactMode contact) {
  auto& at = lanes_[lane];
  auto& motion = *at.motion;
  time_.set(lane, 0);
  at.attempts = 0;
  const bool recorded = ++at.passed > motion.transient;
  if (recorded) motion.moments.push_back({x_[lane], w_[lane], contact});
  if (disturb_) {
    const double along = dx_[lane] / at.size, across = dw_[lane] / at.speed_size, grown = std::hypot(along, across);
    if (recorded) motion.growth.push_back({std::log(grown), along / grown, across / grown});
    dx_.set(lane, dx_[lane] / grown), dw_.set(lane, dw_[lane] / grown);
  }
  if (at.passed < motion.transient + motion.keep) return true;
  motion.displacement = x_[lane], motion.slip_rate = w_[lane];
  --active_;
  take_next(lane);
  return false;
}

void DrivenLanes::give_up(int lane, std::string why) {
  lanes_[lane].motion->why = std::move(why);
  --active_;
  take_next(lane);
}

void DrivenLanes::take_next(int lane) {
  auto& at = lanes_[lane];
  at = {};
  h_.set(lane, 0);  // an idle lane goes on trying, with numbers that stay as they are
  if (waiting_.empty()) return;
  at.motion = &waiting_.front(), at.fresh = true;
  waiting_ = waiting_.subspan(1);
  ++active_;
}

void DrivenLanes::begin(int lane) {
  auto& at = lanes_[lane];
  at.fresh = false;
  auto& motion = *at.motion;
  const auto& block = motion.block;
  motion.moments.clear(), motion.growth.clear();
  contact_->load(lane, block.law->values(), setup_);
  mean_.set(lane, block.force.value);
  double swing = std::abs(block.force.value), fastest = std::sqrt(block.stiffness / block.mass);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const auto& [amplitude, frequency, phase] = block.force.terms[i];
    terms_[i][0].set(lane, amplitude), terms_[i][1].set(lane, frequency), terms_[i][2].set(lane, phase);
    at.bend += std::abs(amplitude) * frequency * frequency;
    swing += std::abs(amplitude);
    fastest = std::max(fastest, std::abs(frequency));
  }
  per_mass_.set(lane, 1 / block.mass), stiffness_.set(lane, block.stiffness), damping_.set(lane, block.damping);
  speed_.set(lane, block.speed), load_.set(lane, block.load);
  at.limit = block.load * block.law->static_limit(block.load);
  at.kinetic = block.load * block.law->friction({std::numeric_limits<double>::min(), block.load}, {});
  at.size = std::max((swing + at.limit) / block.stiffness, std::abs(motion.displacement));
  at.speed_size = std::max(std::abs(block.speed), at.size * std::sqrt(block.stiffness / block.mass));
  size_.set(lane, at.size), speed_size_.set(lane, at.speed_size), tolerance_.set(lane, motion.tolerance);
  at.step = 0.1 / fastest;
  x_.set(lane, motion.displacement), w_.set(lane, motion.slip_rate), time_.set(lane, 0);
  dx_.set(lane, at.size), dw_.set(lane, 0);
  if (motion.slip_rate == 0) return settle(lane, 1);
  direction_.set(lane, std::copysign(1.0, motion.slip_rate));
  plan_step(lane);
}

double DrivenLanes::force(int lane, double t) const {
  double sum = mean_[lane];
  for (const auto& [amplitude, frequency, phase] : terms_)
    sum += amplitude[lane] * std::cos(frequency[lane] * t + phase[lane]);
  return sum;
}
double DrivenLanes::force_rate(int lane, double t) const {
  double sum = 0;
  for (const auto& [amplitude, frequency, phase] : terms_)
    sum -= amplitude[lane] * frequency[lane] * std::sin(frequency[lane] * t + phase[lane]);
  return sum;
}
double DrivenLanes::held(int lane, double t, double x) const {
  return stiffness_[lane] * x + damping_[lane] * speed_[lane] - force(lane, t);
}

}  // namespace rosin::analysis::lanes
