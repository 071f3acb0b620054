/// A bowed string: waves that travel between bridge, bow and nut, and friction where the bow touches (McIntyre,
/// Schumacher & Woodhouse 1983, J. Acoust. Soc. Am. 74, 1325; Woodhouse 2003, Acustica 89, 355).
#pragma once
#include <Eigen/Core>
#include <complex>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/signal.hpp"
#include "laws/law.hpp"
#include "oscillators/bow_contact.hpp"

namespace rosin::oscillators {

/// How times between samples are reached: by cubic interpolation, by linear interpolation, which damps, or not at all.
enum class DelayLine { lagrange, linear, integer };
const std::vector<std::string>& delay_line_names();

struct BowedString {
  static constexpr double none = std::numeric_limits<double>::infinity();

  double frequency = 146.8;         ///< f₀, Hz
  double impedance = 0.55;          ///< Z₀, kg/s, of transverse waves
  double bow_position = 0.0899;     ///< β: distance from the bridge over the length
  double quality = 150;             ///< of the ends: amplitudes fall by e^{−π/Q} a period
  double corner_rounding = 40e-6;   ///< τ, s: each end smooths by two low passes of this time
  double bridge_resistance = none;  ///< R, kg/s: the bridge reflects −(R − Z₀)/(R + Z₀)
  struct Torsion {
    double impedance = 1.8;    ///< of torsional waves, by the velocity of the surface, kg/s
    double speed_ratio = 5.2;  ///< of torsional to transverse waves
    double quality = 34;
    double rounding = 10e-6;  ///< s
    bool operator==(const Torsion&) const = default;
  };
  std::optional<Torsion> torsion = Torsion{};
  double inharmonicity = 0;  ///< B: bending stiffness raises partial n to n f₀ √(1 + B n²)
  double length = 0.69;      ///< m; the width of the bow is measured by it
  /// The bridge moves with these modes of the body.
  struct BodyMode {
    double frequency, mass, quality;  ///< Hz, kg at the bridge, 1
    bool operator==(const BodyMode&) const = default;
  };
  std::vector<BodyMode> body;
  struct Bow {
    int contacts = 1;
    double width = 0.01;           ///< m, over which the contacts are spread evenly
    double hair_stiffness = none;  ///< N/m of each contact, along the string's motion; infinite: rigid hair
    double hair_damping = 0;       ///< N s/m
    bool operator==(const Bow&) const = default;
  } bow;
  DelayLine delays = DelayLine::lagrange;
  double sample_rate = 192000;  ///< Hz
  /// A measured reflection function of transverse waves, in place of travel, rounding and losses on one side of the bow
  /// (McIntyre, Schumacher & Woodhouse 1983, section II): an impulse that leaves the bow comes back as h(t), with the
  /// time on its way. A fixed end has ∫ h dt = −1.
  struct Reflection {
    std::vector<double> time, value;  ///< s, 1/s
    double bow_position;              ///< β at which it was measured; h shifts by the way from there to the bow
    bool operator==(const Reflection&) const = default;
  };
  std::optional<Reflection> bridge, nut;

  double period() const { return 1 / frequency; }
  double step() const { return 1 / sample_rate; }
  /// Zs: of the surface of the string under the bow, transverse and torsional waves together, to both sides.
  double surface_impedance() const;
  /// β of each contact.
  std::vector<double> bow_positions() const;
  /// \throws InputError where a quantity is out of range, or a delay is too short for the sample rate, which it names.
  void check() const;
  bool operator==(const BowedString&) const = default;
};

/// How bow speed or force changes: a signal, or an approach to a value, to + (from − to) e^{−t/time}.
struct Gesture {
  Signal signal;
  struct Approach {
    double from, to, time;
  };
  std::optional<Approach> approach = {};
  double value(double t) const;
  bool constant() const { return !approach && signal.constant(); }
};

enum class StringStart { rest, helmholtz };

/// A string, a law, and a bow that moves.
struct BowedStringModel {
  BowedString string;
  std::shared_ptr<const FrictionLaw> law;
  double lambda = 1;
  Gesture speed, load;  ///< m/s, N: of the whole bow
  StringStart start = StringStart::rest;
};

/// 32 bowed strings of one kind under bows of their own, in steps of a sample. What happens in a lane does not depend
/// on the others.
class StringLanes {
 public:
  /// \throws InputError of BowedString::check(), and for laws of another kind than a bow takes.
  StringLanes(const BowedString&, const std::shared_ptr<const FrictionLaw>& kind, double lambda);

  /// \throws InputError unless the model has this string and a law of this kind.
  void begin(int lane, const BowedStringModel&);
  /// The next sample; the first is at t = 0.
  void step();

  int contacts() const { return int(bows_.size()); }
  double sample_step() const { return string_.step(); }  ///< s
  // Of the last sample.
  const Lanes& bow_speed() const { return bow_speed_; }        ///< m/s
  const Lanes& velocity(int m) const { return velocity_[m]; }  ///< of the string's surface under contact m, m/s
  const Lanes& friction(int m) const { return friction_[m]; }  ///< N
  const BowContacts& bow(int m) const { return bows_[m]; }
  double load(int lane) const { return loads_[lane]; }         ///< of the whole bow, N
  const Lanes& bridge_force() const { return bridge_force_; }  ///< N
  /// N, of the last sample; computed where it is asked for.
  double nut_force(int lane) const;
  /// On the way from the bow, s, waves of the last sample will press on the bridge and on the nut.
  double way_to_bridge() const { return to_bridge_.delay * sample_step(); }
  double way_to_nut() const { return to_nut_.delay * sample_step(); }

  /// What happens under a bow of one contact, by the waves of both sides.
  struct UnderBow {
    double velocity, friction;           ///< of the surface of the string, m/s; N: means of both sides
    double velocity_apart, force_apart;  ///< by which the two sides differ
  };
  /// The next sample of a string in lane 0 whose transverse waves away from the bow are known in place of its friction:
  /// that makes what leaves to one side of what comes from the other (Schumacher, Garoff & Woodhouse 2005). Torsional
  /// waves follow from the friction.
  UnderBow step_between(double leftward, double rightward);

  /// Place of the string as the delays have it: frequency of its length (Hz), and β.
  double realised_frequency() const;
  double realised_bow_position() const;
  /// All that the motion of a lane from now on depends on, under a bow of constant speed and load.
  std::vector<double> state(int lane);
  /// Each number of a state as it differs between motions whose speeds differ by 1 m/s; infinite where it follows from
  /// others or is no continuous number, as stick and slip are not.
  std::vector<double> state_sizes();
  /// \param values  a state of this string
  void set_state(int lane, std::span<const double> values);
  /// The answer to small forces e^{st} under the bow.
  struct Mobility {
    Eigen::MatrixXcd velocity;  ///< of the surface under a contact (row), for a force at a contact (column), m/(N s)
    /// What is left of a wave after a round trip of the string, for each kind of waves; 1 at a mode of the open string.
    std::vector<std::complex<double>> round_trips;
  };
  Mobility mobility(std::complex<double> s) const;

 private:
  /// Weights of the samples that a delay lies between.
  struct Taps {
    Taps() = default;
    Taps(double delay, DelayLine);
    int reach() const { return first + int(weight.size()) - 1; }  ///< the earliest sample
    double delay = 0;                                             ///< as it has become, of slow waves, samples
    int first = 1;
    std::vector<double> weight = {1};
  };
  /// Samples of the past, as far as its taps reach.
  struct Line {
    Line() = default;
    explicit Line(const Taps&);
    ROSIN_INLINE Pack read(long n, int p, const Taps& at) const {
      const double* weight = at.weight.data();
      Pack sum = weight[0] * past[std::size_t(n - at.first) & mask].pack[p];
      for (int i = 1, count = int(at.weight.size()); i < count; ++i)
        sum = sum + weight[i] * past[std::size_t(n - at.first - i) & mask].pack[p];
      return sum;
    }
    ROSIN_INLINE Pack read(long n, int p) const { return read(n, p, taps); }
    ROSIN_INLINE void write(long n, int p, const Pack& x) { past[std::size_t(n) & mask].pack[p] = x; }
    Taps taps;
    std::size_t mask = 0;
    std::vector<Lanes> past;
  };
  /// Two equal low passes.
  struct Smoother {
    double keep = 0;
    Lanes first = 0.0, second = 0.0;
    static double keeps(double time, double step);
    static double delay(double keep) { return 2 * keep / (1 - keep); }  ///< samples, at low frequency
    ROSIN_INLINE Pack operator()(const Pack& x, int p) {
      first.pack[p] = first.pack[p] + (1 - keep) * (x - first.pack[p]);
      second.pack[p] = second.pack[p] + (1 - keep) * (first.pack[p] - second.pack[p]);
      return second.pack[p];
    }
  };
  /// First-order all-passes, (a + z⁻¹)/(1 + a z⁻¹) each, by which high partials run ahead.
  struct Dispersion {
    double a = 0;
    std::vector<Lanes> state = {};
    ROSIN_INLINE Pack operator()(Pack x, int p) {
      for (auto& s : state) {
        const Pack y = a * x + s.pack[p];
        s.pack[p] = x - a * y;
        x = y;
      }
      return x;
    }
  };
  /// Waves of one kind along the string, in units of the velocity of its surface.
  struct Waves {
    double impedance;
    Line bridge, nut;
    std::vector<Line> rightward, leftward;  ///< between neighbouring contacts
    double bridge_gain = 1, nut_gain = 1;
    Smoother at_bridge, at_nut;
    std::vector<Lanes> left_in, right_in;
  };
  struct BodyMode {
    double damping, stiffness, mass, share;  ///< 2ζω, ω², kg, and 1/(1 + ζω dt + ω² dt²/4)
    Lanes displacement = 0.0, velocity = 0.0, acceleration = 0.0;
  };

  /// f(numbers of all lanes, size as in state_sizes()) for each number of a state, in one order.
  template <class F>
  void each_number(const F& f);
  static Waves make_waves(const BowedString&, double impedance, double speed_ratio, double quality, double rounding,
                          double reflection, double extra_delay);
  /// \throws InputError where the function gives more than it takes, or is too quick or too long for the sample rate
  static Taps measured_end(const BowedString&, const BowedString::Reflection&, const char* name, double shift);
  void measured_ends(const BowedString&, Waves&);
  /// What comes to each contact from both sides.
  void arrive();
  /// What comes back from the bridge, and its force.
  ROSIN_INLINE Pack reflect_at_bridge(int p);
  void start_helmholtz(int lane, const BowedStringModel&);

  BowedString string_;
  std::shared_ptr<const FrictionLaw> kind_;
  long n_ = 0;
  std::vector<Waves> waves_;  ///< transverse, then torsional
  Dispersion dispersion_;
  std::vector<BodyMode> body_;
  Line from_bridge_;  ///< from a bridge that moves
  std::vector<BowContacts> bows_;
  std::vector<Lanes> velocity_, friction_, hair_stretch_, hair_speed_;
  Lanes bow_speed_ = 0.0, bridge_force_ = 0.0;
  std::optional<BowedStringModel> models_[lane_count];
  long begun_[lane_count] = {};
  double loads_[lane_count] = {};
  Taps to_bridge_, to_nut_;  ///< of the waves that press on the bridge and on the nut now
};

}  // namespace rosin::oscillators
