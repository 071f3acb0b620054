/// Signals: quantities prescribed in time (drive speed, normal load, force) that know their rate and where they break.
#pragma once
#include <memory>
#include <variant>
#include <vector>

#include "core/noise.hpp"
#include "core/parameters.hpp"

namespace rosin {

/// A prescribed function of time, t >= 0. Immutable. At a step the value is the one after it.
class Signal {
 public:
  struct Step {
    double time, value;
  };
  struct Harmonic {
    double amplitude, angular_frequency, phase;  ///< amplitude·cos(ω t + phase), t absolute
  };
  struct Steps {
    std::vector<Step> steps;  ///< ascending times; before the first, its value holds
  };
  struct Ramp {
    double from, rate;
  };
  struct Harmonics {
    double mean;
    std::vector<Harmonic> terms;
  };
  struct Noise {
    double mean;
    NoiseBand band;
  };
  struct Table {
    std::vector<double> time, value;  ///< linear between points, constant outside
  };

  Signal(double constant = 0) : form_(constant) {}
  /// \throws InputError if times are not strictly ascending, a number is not finite, or a list is empty.
  explicit Signal(Steps);
  explicit Signal(Ramp);
  explicit Signal(Harmonics);
  explicit Signal(Table);
  explicit Signal(Noise);

  /// The signal from t to its next break: at t + τ it is value + rate·τ + Σ terms, cosines of absolute time.
  struct Piece {
    double value, rate;
    std::vector<Harmonic> terms;
  };
  Piece piece(double t) const;

  double value(double t) const;
  /// Time derivative; at a break the one after it.
  double rate(double t) const;
  /// The next time after t at which the value or its rate jumps; infinity if none.
  double next_break(double t) const;
  /// True if the value never changes.
  bool constant() const { return std::holds_alternative<double>(form_); }
  /// Longest step of time that resolves the signal (1/16 of the shortest period, or of that of the band's upper end);
  /// infinity if it has no period.
  double resolution() const;
  /// All values stay within the range (checked at break points, by the sum of amplitudes for harmonics, and at its
  /// start for a ramp, which has no end of its own).
  bool within(Range) const;
  /// +1 or −1 if all values have that sign, else 0.
  int direction() const;
  /// The constant value or the mean of harmonics or noise; the value at t = 0 for other forms.
  double level() const;
  /// factor·signal + offset, for a factor >= 0.
  Signal scaled(double factor, double offset) const;
  /// The same signal with another level; other forms than constant, harmonics and noise become constant.
  Signal with_level(double) const;

 private:
  struct MadeNoise {
    double mean;
    std::shared_ptr<const BandNoise> noise;  ///< large, and shared by copies
  };
  std::variant<double, Steps, Ramp, Harmonics, Table, MadeNoise> form_;
};

}  // namespace rosin
