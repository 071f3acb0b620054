/// Waves on a bowed string, sampled.
#include "oscillators/bowed_string.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/instruction_set.hpp"
#include "core/sampled_response.hpp"

namespace rosin::oscillators {

using std::numbers::pi;

const std::vector<std::string>& delay_line_names() {
  static const std::vector<std::string> names = {"lagrange", "linear", "integer"};
  return names;
}

double BowedString::surface_impedance() const {
  return 1 / (1 / (2 * impedance) + (torsion ? 1 / (2 * torsion->impedance) : 0));
}

std::vector<double> BowedString::bow_positions() const {
  std::vector<double> places;
  for (int m = 0; m < bow.contacts; ++m)
    places.push_back(bow_position + (m - 0.5 * (bow.contacts - 1)) * bow.width / (bow.contacts * length));
  return places;
}

double Gesture::value(double t) const {
  if (!approach) return signal.value(t);
  return approach->to + (approach->from - approach->to) * std::exp(-t / approach->time);
}

namespace {

/// Samples that a delay needs at least.
double shortest(DelayLine line) { return line == DelayLine::lagrange ? 2 : line == DelayLine::linear ? 1 : 0.5; }

constexpr int dispersing = 16;  // all-passes

/// By which each of the all-passes delays slow waves: x = a/(1 + a) < 0, so that partials rise as √(1 + B n²) do first:
/// their phase delay falls as 1 − 2x − (x² − x/3 − 2x³/3) ω².
double dispersion_of(const BowedString& string) {
  const double step = string.frequency * string.step();
  const double wanted = string.inharmonicity / (8 * pi * pi * step * step * step) / dispersing;
  double low = -1e6, high = 0;
  constexpr int halvings = 200;
  for (int i = 0; i < halvings; ++i) {
    const double x = 0.5 * (low + high);
    (x * x - x / 3 - 2 * x * x * x / 3 > wanted ? low : high) = x;
  }
  return 0.5 * (low + high);
}

}  // namespace

void BowedString::check() const {
  const auto within = [](double x, Range range, const char* name, const char* meaning, const char* unit) {
    require(x, range, fmt::format("oscillator.{}", name), meaning, unit);
  };
  within(frequency, {0.1, 1e5}, "frequency", "frequency of the open string", "Hz");
  within(impedance, {1e-9, 1e9}, "impedance", "impedance of transverse waves", "kg/s");
  within(bow_position, {1e-4, 0.9999}, "bow_position", "distance of the bow from the bridge over the length", "1");
  within(sample_rate, {100, 1e9}, "sample_rate", "samples per second", "Hz");
  if (constexpr double most = 1e5; sample_rate > most * frequency)
    throw InputError(
        fmt::format("oscillator.sample_rate = {} Hz are {:.3g} samples in a period of the string, more than "
                    "{}; take at most {:.4g} Hz",
                    sample_rate, sample_rate / frequency, most, most * frequency));
  const auto places = bow_positions();
  if (!(places.front() > 0 && places.back() < 1))
    throw InputError(
        fmt::format("oscillator.bow.width = {} m: the outermost hairs of the bow at {:.4g} and {:.4g} of the "
                    "length are beyond the ends of the string",
                    bow.width, places.front(), places.back()));
  if (bow.hair_damping > 0 && bow.hair_stiffness == none)
    throw InputError("oscillator.bow.hair_damping has no effect on rigid hair; give hair_stiffness (N/m)");
}

StringLanes::Taps::Taps(double wanted, DelayLine kind) : delay(wanted) {
  if (kind == DelayLine::integer) {
    first = std::max(1, int(std::lround(wanted)));
    delay = first;
  } else if (kind == DelayLine::linear) {
    first = int(std::floor(wanted));
    weight = {1 - (wanted - first), wanted - first};
  } else {
    first = int(std::floor(wanted)) - 1;
    weight.assign(4, 1);
    const double at = wanted - first;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        if (i != j) weight[std::size_t(j)] *= (at - i) / (j - i);
  }
}

StringLanes::Line::Line(const Taps& at) : taps(at) {
  std::size_t size = 1;
  while (size < std::size_t(at.reach() + 2)) size *= 2;
  mask = size - 1;
  past.assign(size, Lanes(0.0));
}

double StringLanes::Smoother::keeps(double time, double step) { return time > 0 ? std::exp(-step / time) : 0; }

StringLanes::Waves StringLanes::make_waves(const BowedString& string, double impedance, double speed_ratio,
                                           double quality, double rounding, double reflection, double extra_delay) {
  Waves waves;
  waves.impedance = impedance;
  waves.at_bridge.keep = waves.at_nut.keep = Smoother::keeps(rounding, string.step());
  const auto places = string.bow_positions();
  const double period = string.period() * string.sample_rate / speed_ratio;
  const double smoothing = Smoother::delay(waves.at_bridge.keep);
  const char* kind = speed_ratio == 1 ? "transverse" : "torsional";
  const auto taps = [&](double samples, double others, std::string_view from) {
    if (samples - others < shortest(string.delays)) {
      const double rate = string.sample_rate * (shortest(string.delays) + others) / samples;
      throw InputError(fmt::format(
          "oscillator.sample_rate = {} Hz: {} waves {} take {:.3g} samples, of which rounding takes {:.3g}, "
          "and {} delays need {}; take about {:.3g} Hz or more, or less rounding",
          string.sample_rate, kind, from, samples, others, delay_line_names()[std::size_t(string.delays)],
          shortest(string.delays), rate));
    }
    return Taps(samples - others, string.delays);
  };
  const double to_bridge = places.front() * period;
  if (string.body.empty() || speed_ratio != 1)
    waves.bridge = Line(taps(to_bridge, smoothing, "from the bow to the bridge and back"));
  else
    waves.bridge = Line(taps(0.5 * to_bridge, 0, "from the bow to the bridge"));
  waves.nut = Line(taps((1 - places.back()) * period, smoothing + extra_delay, "from the bow to the nut and back"));
  for (std::size_t m = 1; m < places.size(); ++m) {
    const auto between =
        taps(0.5 * (places[m] - places[m - 1]) * period, 0, "between neighbouring contacts of the bow");
    waves.rightward.emplace_back(between);
    waves.leftward.emplace_back(between);
  }
  waves.bridge_gain = reflection;
  waves.nut_gain = std::exp(-pi / quality);
  waves.left_in.assign(places.size(), Lanes(0.0));
  waves.right_in = waves.left_in;
  return waves;
}

StringLanes::Taps StringLanes::measured_end(const BowedString& string, const BowedString::Reflection& function,
                                            const char* name, double shift) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("oscillator.reflection.{}: {}", name, why));
  };
  const auto response = sampled({function.time, function.value}, shift, string.step());
  const double integral = response.sum();
  constexpr double least_integral = 0.1;
  if (integral > -least_integral)
    refuse(
        fmt::format("its integral over time is {:.4g}, where a fixed end has -1 and slow waves come back by {} or "
                    "more of their height; look at its sign and its unit (1/s)",
                    integral, least_integral));
  if (response.first < 1)
    refuse(
        fmt::format("waves are back {:.4g} s after they leave the bow, less than a sample of oscillator.sample_rate "
                    "= {} Hz; times count from the wave that leaves the bow, with its way to the end and back",
                    function.time.front() + shift, string.sample_rate));
  if (constexpr std::size_t most = 20'000; response.weights.size() > most)
    refuse(fmt::format("it lasts {} samples, more than {}; cut its tail, or take a lower oscillator.sample_rate",
                       response.weights.size(), most));
  constexpr double rounding = 1e-6;  // of numbers in files
  if (const auto largest = largest_gain(response); largest.gain > 1 + rounding)
    refuse(
        fmt::format("waves come back {:.7g} times as high at {:.5g} Hz, and no end gives more than it takes; divide "
                    "the values by that",
                    largest.gain, largest.frequency * string.sample_rate));
  Taps taps;
  taps.delay = response.delay(), taps.first = response.first;
  taps.weight.clear();
  for (const double w : response.weights) taps.weight.push_back(-w);
  return taps;
}

/// Ends that were measured in place of those of numbers.
void StringLanes::measured_ends(const BowedString& string, Waves& waves) {
  const auto places = string.bow_positions();
  if (const auto& end = string.bridge) {
    waves.bridge = Line(measured_end(string, *end, "bridge", (places.front() - end->bow_position) * string.period()));
    waves.bridge_gain = 1, waves.at_bridge.keep = 0;
  }
  if (const auto& end = string.nut) {
    waves.nut = Line(measured_end(string, *end, "nut", (end->bow_position - places.back()) * string.period()));
    waves.nut_gain = 1, waves.at_nut.keep = 0;
  }
}

StringLanes::StringLanes(const BowedString& string, const std::shared_ptr<const FrictionLaw>& kind, double lambda)
    : string_(string), kind_(kind) {
  string.check();
  double dispersed = 0;
  if (string.inharmonicity > 0) {
    const double x = dispersion_of(string);
    dispersion_.a = x / (1 - x);
    dispersion_.state.assign(dispersing, Lanes(0.0));
    dispersed = dispersing * (1 - 2 * x);
  }
  const double R = string.bridge_resistance, Z = string.impedance;
  waves_.push_back(make_waves(string, Z, 1, string.quality, string.corner_rounding,
                              R == BowedString::none ? 1 : (R - Z) / (R + Z), dispersed));
  measured_ends(string, waves_.front());
  if (const auto& torsion = string.torsion)
    waves_.push_back(
        make_waves(string, torsion->impedance, torsion->speed_ratio, torsion->quality, torsion->rounding, 1, 0));
  const double there = 0.5 * string.bow_positions().front() * string.period() * string.sample_rate;
  const double to_nut = 0.5 * (1 - string.bow_positions().back()) * string.period() * string.sample_rate;
  to_nut_ = Taps(std::max(to_nut, shortest(string.delays)), string.delays);
  if (string.body.empty()) {
    to_bridge_ = Taps(std::max(there, shortest(string.delays)), string.delays);
  } else {
    const double smoothing = Smoother::delay(waves_[0].at_bridge.keep);
    from_bridge_ = Line(Taps(std::max(there - smoothing, shortest(string.delays)), string.delays));
    if (there - smoothing < shortest(string.delays))
      throw InputError(
          fmt::format("oscillator.sample_rate = {} Hz: waves from a bridge that moves to the bow take {:.3g} "
                      "samples, fewer than rounding and delays need; take a higher rate",
                      string.sample_rate, there));
    for (const auto& mode : string.body) {
      const double omega = 2 * pi * mode.frequency, damping = omega / mode.quality, dt = string.step();
      body_.push_back(
          {damping, omega * omega, mode.mass, 1 / (1 + 0.5 * damping * dt + 0.25 * omega * omega * dt * dt)});
    }
  }
  for (int m = 0; m < string.bow.contacts; ++m) bows_.emplace_back(kind, lambda, string.step());
  velocity_.assign(bows_.size(), Lanes(0.0));
  friction_ = hair_stretch_ = hair_speed_ = velocity_;
  constexpr double near = 0.05;
  if (const double real = realised_frequency();
      (string.bridge || string.nut) && std::abs(real / string.frequency - 1) > near)
    throw InputError(
        fmt::format("oscillator.frequency = {} Hz, but by oscillator.reflection slow waves go round in {:.6g} s, which "
                    "is {:.6g} Hz; correct the frequency, or the times of the tables",
                    string.frequency, 1 / real, real));
}

double StringLanes::realised_frequency() const {
  const auto& waves = waves_.front();
  double period = waves.bridge.taps.delay + (body_.empty() ? 0 : from_bridge_.taps.delay) + waves.nut.taps.delay +
                  Smoother::delay(waves.at_bridge.keep) + Smoother::delay(waves.at_nut.keep);
  for (const auto& line : waves.rightward) period += 2 * line.taps.delay;
  if (!dispersion_.state.empty()) period += dispersing * (1 - dispersion_.a) / (1 + dispersion_.a);
  return string_.sample_rate / period;
}

double StringLanes::realised_bow_position() const {
  const auto& waves = waves_.front();
  double to_bridge =
      waves.bridge.taps.delay + Smoother::delay(waves.at_bridge.keep) + (body_.empty() ? 0 : from_bridge_.taps.delay);
  double span = 0;
  for (const auto& line : waves.rightward) span += line.taps.delay;
  return (to_bridge + span) * realised_frequency() / string_.sample_rate;
}

void StringLanes::begin(int lane, const BowedStringModel& model) {
  if (!(model.string == string_) || model.law->card().name != kind_->card().name)
    throw InputError("strings that sound together must be of one kind, and their laws of one name");
  models_[lane] = model;
  begun_[lane] = n_;
  loads_[lane] = model.load.value(0);
  set_state(lane, std::vector<double>(state_sizes().size(), 0.0));
  for (auto& bow : bows_) bow.rest(lane, model.law, loads_[lane] / double(bows_.size()));
  for (auto* list : {&velocity_, &friction_})
    for (auto& x : *list) x.set(lane, 0);
  bridge_force_.set(lane, 0);
  if (model.start == StringStart::helmholtz) start_helmholtz(lane, model);
}

/// Waves of the motion with one corner (Helmholtz; Raman 1918): leftward a sawtooth w, rightward its reflection, so
/// that w(t) − w(t − βT) is the speed of the bow but in a part β of the period. A force F = N μ(v/β) pulls the string
/// aside; the bridge, which is nearer, bears the part 1 − β of it.
void StringLanes::start_helmholtz(int lane, const BowedStringModel& model) {
  const double speed = model.speed.value(0), beta = realised_bow_position();
  const double period = string_.sample_rate / realised_frequency();
  const double pull =
      loads_[lane] * model.law->steady_friction({speed / beta, loads_[lane]}).friction / (2 * string_.impedance);
  const auto sawtooth = [&](double n) {
    const double from_jump = n / period - 0.5;  // the corner passes the bow half a period from now
    return speed / beta * (from_jump - std::floor(from_jump + 1e-9) - 0.5);
  };
  const auto leftward = [&](double n) { return sawtooth(n) + (1 - beta) * pull; };
  const auto rightward = [&](double n) { return -sawtooth(n - beta * period) + beta * pull; };
  const auto places = string_.bow_positions();
  const auto fill = [&](Line& line, std::size_t m, double sign, const auto& wave, double gain = 1) {
    const double behind = sign * (places[m] - string_.bow_position) * 0.5 * period;
    const long size = long(line.past.size());
    for (long n = -size; n < 0; ++n)
      line.past[std::size_t(n_ + n) & line.mask].set(lane, gain * wave(double(n) - behind));
  };
  auto& waves = waves_.front();
  fill(waves.bridge, 0, -1, leftward);
  if (!body_.empty()) {
    const double half = 0.5 * beta * period;
    fill(from_bridge_, 0, -1, [&](double n) { return -leftward(n - half); });
  }
  fill(waves.nut, places.size() - 1, 1, rightward);
  for (std::size_t m = 0; m + 1 < places.size(); ++m) {
    fill(waves.rightward[m], m, 1, rightward);
    fill(waves.leftward[m], m + 1, -1, leftward);
  }
}

ROSIN_INLINE Pack StringLanes::reflect_at_bridge(int p) {
  auto& waves = waves_.front();
  const double Z = waves.impedance;
  if (body_.empty()) {
    bridge_force_.pack[p] = 2 * Z * waves.bridge.read(n_, p, to_bridge_);
    return -waves.bridge_gain * waves.at_bridge(waves.bridge.read(n_, p), p);
  }
  // The modes of the body by the trapezoidal rule, together with the string's end: F = Z (2a − v).
  const Pack arriving = waves.bridge.read(n_, p);
  const double dt = string_.step();
  Pack free = 0.0;
  double admittance = 0;
  for (auto& mode : body_) {
    const Pack v = mode.velocity.pack[p];
    mode.displacement.pack[p] = mode.displacement.pack[p] + 0.5 * dt * v;
    mode.velocity.pack[p] =
        mode.share * (v + 0.5 * dt * (mode.acceleration.pack[p] - mode.stiffness * mode.displacement.pack[p]));
    free = free + mode.velocity.pack[p];
    admittance += 0.5 * dt * mode.share / mode.mass;
  }
  const Pack v = (free + 2 * Z * admittance * arriving) / (1 + Z * admittance), F = Z * (2.0 * arriving - v);
  for (auto& mode : body_) {
    mode.velocity.pack[p] = mode.velocity.pack[p] + 0.5 * dt * mode.share / mode.mass * F;
    mode.displacement.pack[p] = mode.displacement.pack[p] + 0.5 * dt * mode.velocity.pack[p];
    mode.acceleration.pack[p] =
        F / mode.mass - mode.damping * mode.velocity.pack[p] - mode.stiffness * mode.displacement.pack[p];
  }
  bridge_force_.pack[p] = F;
  const Pack back = from_bridge_.read(n_, p);
  from_bridge_.write(n_, p, waves.bridge_gain * (v - arriving));
  return waves.at_bridge(back, p);
}

void StringLanes::arrive() {
  const int contacts = int(bows_.size());
  run_on_lanes([&] {
    for (std::size_t k = 0; k < waves_.size(); ++k) {
      auto& waves = waves_[k];
      for (int p = 0; p < lane_packs; ++p) {
        waves.left_in[0].pack[p] =
            k == 0 ? reflect_at_bridge(p) : Pack(-waves.bridge_gain * waves.at_bridge(waves.bridge.read(n_, p), p));
        Pack back = waves.at_nut(waves.nut.read(n_, p), p);
        if (k == 0) back = dispersion_(back, p);
        waves.right_in[contacts - 1].pack[p] = -waves.nut_gain * back;
        for (int m = 1; m < contacts; ++m) {
          waves.left_in[m].pack[p] = waves.rightward[m - 1].read(n_, p);
          waves.right_in[m - 1].pack[p] = waves.leftward[m - 1].read(n_, p);
        }
      }
    }
  });
}

double StringLanes::nut_force(int lane) const {
  const auto& waves = waves_.front();
  double pressing = 0;
  for (std::size_t i = 0; i < to_nut_.weight.size(); ++i)
    pressing +=
        to_nut_.weight[i] * waves.nut.past[std::size_t(n_ - 1 - to_nut_.first - long(i)) & waves.nut.mask][lane];
  return 2 * waves.impedance * pressing;
}

StringLanes::UnderBow StringLanes::step_between(double leftward, double rightward) {
  arrive();
  auto& transverse = waves_.front();
  const double Z = transverse.impedance, from_bridge = transverse.left_in[0][0], from_nut = transverse.right_in[0][0];
  const double to_left = 2 * Z * (leftward - from_nut), to_right = 2 * Z * (rightward - from_bridge);
  UnderBow bow{0.5 * (leftward + from_bridge + rightward + from_nut), 0.5 * (to_left + to_right),
               leftward + from_bridge - rightward - from_nut, to_left - to_right};
  transverse.bridge.past[std::size_t(n_) & transverse.bridge.mask].set(0, leftward);
  transverse.nut.past[std::size_t(n_) & transverse.nut.mask].set(0, rightward);
  for (std::size_t k = 1; k < waves_.size(); ++k) {
    auto& waves = waves_[k];
    const double push = 0.5 * bow.friction / waves.impedance, left = waves.left_in[0][0], right = waves.right_in[0][0];
    bow.velocity += left + right + push;
    waves.bridge.past[std::size_t(n_) & waves.bridge.mask].set(0, right + push);
    waves.nut.past[std::size_t(n_) & waves.nut.mask].set(0, left + push);
  }
  ++n_;
  return bow;
}

void StringLanes::step() {
  const int contacts = int(bows_.size());
  const double dt = string_.step();
  for (int lane = 0; lane < lane_count; ++lane) {
    if (!models_[lane]) continue;
    const double t = double(n_ - begun_[lane]) * dt;
    const auto& model = *models_[lane];
    bow_speed_.set(lane, model.speed.value(t));
    if (model.load.constant()) continue;
    loads_[lane] = model.load.value(t);
    for (auto& bow : bows_) bow.set_load(lane, loads_[lane] / contacts);
  }

  arrive();

  const double Z = string_.surface_impedance(), k = string_.bow.hair_stiffness;
  const bool rigid = k == BowedString::none;
  const double hair = rigid ? 0 : 0.5 * dt * k + string_.bow.hair_damping;  // force of the hair over its speed
  for (int m = 0; m < contacts; ++m) {
    Lanes carried, D, seen = rigid ? Z : 1 / (1 / Z + 1 / hair);
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        Pack v = 0.0;
        for (const auto& waves : waves_) v = v + (waves.left_in[m].pack[p] + waves.right_in[m].pack[p]);
        carried.pack[p] = v;
        D.pack[p] = bow_speed_.pack[p] - v;
        if (!rigid) D.pack[p] = D.pack[p] + k / hair * (hair_stretch_[m].pack[p] + 0.5 * dt * hair_speed_[m].pack[p]);
      }
    });
    bows_[m].step(D, seen, friction_[m]);
    run_on_lanes([&] {
      for (int p = 0; p < lane_packs; ++p) {
        const Pack f = friction_[m].pack[p];
        velocity_[m].pack[p] = carried.pack[p] + f * (1 / Z);
        if (!rigid) {
          const Pack before = hair_stretch_[m].pack[p] + 0.5 * dt * hair_speed_[m].pack[p];
          hair_speed_[m].pack[p] = (f - k * before) * (1 / hair);
          hair_stretch_[m].pack[p] = before + 0.5 * dt * hair_speed_[m].pack[p];
        }
        for (auto& waves : waves_) {
          const Pack push = f * (0.5 / waves.impedance);
          const Pack left = waves.right_in[m].pack[p] + push, right = waves.left_in[m].pack[p] + push;
          (m == 0 ? waves.bridge : waves.leftward[m - 1]).write(n_, p, left);
          (m == contacts - 1 ? waves.nut : waves.rightward[m]).write(n_, p, right);
        }
      }
    });
  }
  ++n_;
}

}  // namespace rosin::oscillators
