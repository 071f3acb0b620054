/// Partials of the open string followed to those under the bow, and a count that none is missed.
#include "analysis/strings/sliding.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "analysis/response/frf.hpp"
#include "analysis/strings/bowing.hpp"

namespace rosin::analysis::strings {

using std::numbers::pi;
using Complex = std::complex<double>;
using oscillators::BowedString;
using oscillators::StringLanes;

namespace {

/// String, bow and friction about steady sliding.
class SlidingBow {
 public:
  explicit SlidingBow(const BowedStringModel& model)
      : string_(model.string), lanes_(model.string, model.law, model.lambda), friction_(contact_in_sliding(model)) {}

  const response::FrictionResponse& friction() const { return friction_; }
  /// 0 at a mode; without poles but those of friction itself.
  Complex characteristic(Complex s, double part_of_friction = 1) const {
    const auto mobility = lanes_.mobility(s);
    Complex open = 1;
    for (const Complex trip : mobility.round_trips) open *= 1.0 - trip;
    return open * loop(s, mobility, part_of_friction);
  }
  /// The same over that of the open string.
  Complex loop(Complex s) const { return loop(s, lanes_.mobility(s), 1); }
  /// What remains of a wave of one kind after its way to both ends, less 1.
  Complex open(Complex s, int kind) const { return lanes_.mobility(s).round_trips[std::size_t(kind)] - 1.0; }
  int kinds() const { return string_.torsion ? 2 : 1; }
  /// Of the open string, Hz.
  double frequency(int kind) const {
    return kind == 0 ? lanes_.realised_frequency() : lanes_.realised_frequency() * string_.torsion->speed_ratio;
  }
  /// Of the string with its hair, for changes faster than any wave returns (N s/m, of each contact).
  double impedance() const {
    const double hair = string_.bow.hair_stiffness == BowedString::none ? 0 : 1 / string_.bow.hair_damping;
    return 1 / (1 / string_.surface_impedance() + hair);
  }

  /// Of the string's surface, for a force at one contact: 1/s of Y F − Y (1 + Z (Y + H))⁻¹ Z Y F.
  Complex receptance(Complex s, int contact) const {
    const auto mobility = lanes_.mobility(s);
    const Eigen::VectorXcd open = mobility.velocity.col(contact);
    const Eigen::VectorXcd friction = closed(s, mobility, 1).partialPivLu().solve(friction_.tangential(s) * open);
    return (open - mobility.velocity * friction)[contact] / s;
  }

 private:
  Complex loop(Complex s, const StringLanes::Mobility& mobility, double part_of_friction) const {
    return closed(s, mobility, part_of_friction).determinant();
  }
  /// 1 + Z (Y + H)
  Eigen::MatrixXcd closed(Complex s, const StringLanes::Mobility& mobility, double part_of_friction) const {
    const auto n = mobility.velocity.rows();
    const auto& bow = string_.bow;
    const Complex hair =
        bow.hair_stiffness == BowedString::none ? 0.0 : s / (bow.hair_stiffness + s * bow.hair_damping);
    const Eigen::MatrixXcd answer = mobility.velocity + hair * Eigen::MatrixXcd::Identity(n, n);
    return Eigen::MatrixXcd::Identity(n, n) + part_of_friction * friction_.tangential(s) * answer;
  }

  BowedString string_;
  StringLanes lanes_;
  response::FrictionResponse friction_;
};

/// Newton's method from near a root; NaN where it does not settle.
template <class F>
Complex root_of(const F& f, Complex s, double frequency) {
  constexpr int most = 40;
  constexpr double small = 1e-13, aside = 1e-6;
  const double h = aside * frequency;
  for (int i = 0; i < most; ++i) {
    const Complex change = f(s) * (2 * h) / (f(s + h) - f(s - h));
    s -= change;
    if (!(std::abs(change) < frequency)) break;  // from partial to partial
    if (std::abs(change) < small * std::abs(s)) return s;
  }
  return {NAN, NAN};
}

/// A mode of the open string, and what becomes of it under the bow.
struct Followed {
  int kind, partial;
  Complex open, bowed;
};

/// Where a mode of the open string goes while friction grows from nothing to all of it; NaN where it is lost.
Complex under_the_bow(const SlidingBow& bow, Complex open, double frequency) {
  constexpr double first = 1.0 / 32, least = 1e-9, most = 0.125, near = 0.2;  // parts of friction; of the frequency
  double part = 0, before = 0, step = first;
  Complex here = open, last = open;
  while (part < 1 && step > least) {
    const double next = std::min(1.0, part + step);
    const Complex ahead = part > 0 ? here + (here - last) * ((next - part) / (part - before)) : here;
    const Complex there = root_of([&](Complex s) { return bow.characteristic(s, next); }, ahead, frequency);
    if (!(std::abs(there - ahead) < near * frequency)) {
      step /= 2;
      continue;
    }
    last = here, here = there, before = part, part = next;
    step = std::min(2 * step, most);
  }
  return part < 1 ? Complex{NAN, NAN} : here;
}

/// Partials up to a frequency, each looked for where those below it lead: high ones of a lossy string are out of tune.
std::vector<Followed> follow(const SlidingBow& bow, double highest) {
  std::vector<Followed> modes;
  for (int kind = 0; kind < bow.kinds(); ++kind) {
    const double frequency = bow.frequency(kind);
    Complex last = 0, open = 0;
    for (int n = 1; std::isfinite(open.imag()); ++n) {
      const Complex near = n < 3 ? Complex{open.real(), 2 * pi * n * frequency} : 2.0 * open - last;
      last = open, open = root_of([&](Complex s) { return bow.open(s, kind); }, near, frequency);
      if (!(open.imag() < 2 * pi * highest)) break;
      modes.push_back({kind, n, open, under_the_bow(bow, open, bow.frequency(0))});
    }
  }
  return modes;
}

/// The number of modes with growth rates above `least` and frequencies below `highest`, by the turns of the loop around
/// them (the argument principle). The open string and the contact by itself have none there.
int count_growing(const SlidingBow& bow, const std::vector<Followed>& modes, double least, double highest,
                  double sample_rate) {
  const double top = 2 * pi * highest, f = bow.frequency(0);
  std::vector<double> places = {0, top};
  for (double at = 0; at < top; at += 0.5 * f) places.push_back(at);
  for (const auto& mode : modes)
    for (const Complex s : {mode.open, mode.bowed}) {
      if (!std::isfinite(s.imag())) continue;
      double aside = std::max(std::abs(s.real() - least), 1e-12 * f);
      for (places.push_back(s.imag()); aside < f; aside *= 2)
        for (const double sign : {-0.5, 0.5}) places.push_back(s.imag() + sign * aside);
    }
  std::erase_if(places, [&](double at) { return at < 0 || at > top; });
  std::ranges::sort(places);
  double turned = 0;
  const auto turn = [&](const auto& self, Complex a, Complex b, Complex at_a, Complex at_b, int halvings) -> void {
    const double angle = std::arg(at_b / at_a);
    constexpr double small = 0.3;
    if (halvings == 0 || std::abs(angle) < small) {
      turned += angle;
      return;
    }
    const Complex middle = 0.5 * (a + b), at_middle = bow.loop(middle);
    self(self, a, middle, at_a, at_middle, halvings - 1), self(self, middle, b, at_middle, at_b, halvings - 1);
  };
  constexpr int most_halvings = 40;
  // Up the imaginary axis, then to the right where waves have died out before they return, and back to the real axis,
  // along which the loop is real. The lower half mirrors the upper.
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Complex a{least, places[i]}, b{least, places[i + 1]};
    turn(turn, a, b, bow.loop(a), bow.loop(b), most_halvings);
  }
  constexpr double ratio = 1.25, far = 30;  // samples in which nothing comes back
  double right = least;
  for (double next = 1e-3 * f; right < far * sample_rate; next *= ratio) {
    if (next <= right) continue;
    const Complex a{right, top}, b{next, top};
    turn(turn, a, b, bow.loop(a), bow.loop(b), most_halvings);
    right = next;
  }
  const Complex a{right, top}, b{right, 0};
  turn(turn, a, b, bow.loop(a), bow.loop(b), most_halvings);
  return int(std::lround(-2 * turned / (2 * pi)));
}

}  // namespace

int StringSliding::unstable_modes() const {
  return int(std::ranges::count_if(modes, [](const Mode& mode) { return mode.eigenvalue.real() > mode.error; }));
}

oscillators::Model contact_in_sliding(const BowedStringModel& model) {
  const double speed = model.speed.value(0), load = model.load.value(0);
  if (speed == 0)
    throw InputError("drive.speed is 0 m/s at t = 0: a bow at rest does not slide; give the speed at which it slides");
  if (!(load > 0)) throw InputError("drive.normal_load is 0 N at t = 0: a bow without load has no friction");
  oscillators::Model contact;
  contact.law = model.law, contact.lambda = model.lambda;
  contact.drive.speed = speed;
  contact.drive.normal_load = load / model.string.bow.contacts;
  return contact;
}

response::SlidingReceptance sliding_receptance(const BowedStringModel& model, int contact) {
  const auto bow = std::make_shared<const SlidingBow>(model), same = std::make_shared<const SlidingBow>(finer(model));
  return {{}, [bow, same, contact](Complex s) {
            const Complex value = bow->receptance(s, contact);
            constexpr double rounding = 1e-12;
            const double error = std::abs(value - same->receptance(s, contact)) + rounding * std::abs(value);
            if (!std::isfinite(error))
              throw InputError(
                  fmt::format("at {:.10g} Hz the string has no receptance: no losses bound the waves that come back",
                              s.imag() / (2 * pi)));
            return response::SlidingReceptance::Answer{{}, {}, value, error};
          }};
}

StringSliding sliding_stability(const BowedStringModel& model) {
  const SlidingBow bow(model);
  const int contacts = model.string.bow.contacts;
  StringSliding result;
  result.slip_rate = model.speed.value(0);
  result.friction_coefficient = bow.friction().friction_coefficient();
  result.friction_force = result.friction_coefficient * model.load.value(0);
  result.slope = bow.friction().limits().high * contacts;
  result.impedance = bow.impedance() * contacts;
  result.jumps = result.slope < 0 && -result.slope >= result.impedance;
  if (result.jumps) return result;
  const double highest = 0.25 * model.string.sample_rate;
  const auto modes = follow(bow, highest), same = follow(SlidingBow(finer(model)), highest);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const auto& mode = modes[i];
    const auto other =
        std::ranges::find_if(same, [&](const Followed& m) { return m.kind == mode.kind && m.partial == mode.partial; });
    if (!std::isfinite(mode.bowed.real())) continue;  // counted below, if it grows
    constexpr double rounding = 1e-12;
    const double error =
        other == same.end() ? infinity : std::abs(mode.bowed - other->bowed) + rounding * std::abs(mode.bowed);
    Complex value = mode.bowed;
    if (std::abs(value.imag()) <= rounding * std::abs(value)) value.imag(0);  // a pair that has met: no oscillation
    result.modes.push_back({value, std::isfinite(error) ? error : infinity, mode.partial, mode.kind == 1});
  }
  std::ranges::stable_sort(result.modes, std::greater(), [](const auto& mode) { return mode.eigenvalue.real(); });
  // A count just right of the imaginary axis, or of the modes of an open string that does not lose energy.
  double least = 1e-9 * bow.frequency(0);
  for (const auto& mode : modes)
    if (std::isfinite(mode.open.real())) least = std::max(least, 2 * mode.open.real());
  const auto grows = [&](const auto& mode) { return mode.eigenvalue.real() > least; };
  const int found = 2 * int(std::ranges::count_if(result.modes, grows));
  double between = 0;  // Hz, half a partial above the last
  for (const auto& mode : modes)
    if (mode.kind == 0) between = mode.open.imag() / (2 * pi) + 0.5 * bow.frequency(0);
  if (const int all = count_growing(bow, modes, least, between, model.string.sample_rate); all != found)
    result.outcome = {
        Ending::tolerance_not_met,
        fmt::format("{} eigenvalues grow below {:.4g} Hz, and partials of the open string lead to {} of them", all,
                    between, found)};
  result.stable = result.outcome.complete() && std::ranges::none_of(result.modes, grows);
  return result;
}

}  // namespace rosin::analysis::strings
