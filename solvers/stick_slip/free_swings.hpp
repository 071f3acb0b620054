/// Where slip between rest and rest ends, by the energy of an oscillator that swings nearly free.
#pragma once
#include <optional>
#include <vector>

#include "solvers/steps/collocation.hpp"

namespace rosin::solvers::stick_slip {

/// An oscillator that friction and damping hardly slow down. It comes down to rest along the slope of a wide swing, so
/// that the time of the stop is known from the slip rate only to the root of its error; the energy, which friction and
/// damping hardly change, tells it as exactly as they are known.
class FreeSwings {
 public:
  virtual ~FreeSwings() = default;
  /// Displacement from that of steady sliding (m), and the place for another.
  virtual double swing(const double* y) const = 0;
  virtual void set_swing(double swing, double* y) const = 0;
  /// The mass's velocity while the contact is at rest (m/s), and how wide it makes the mass swing (m).
  virtual double velocity_at_rest() const = 0;
  virtual double swing_of_drive() const = 0;
  /// Rate at which friction and damping change the square of the swing that the mass has at rest, m²/s.
  virtual double power(double t, const double* y) const = 0;
};

/// Keeps account of the energy of one slip from its start at rest.
class SlipEnergy {
 public:
  /// \param swings  outlives this; nullptr: there is no account
  SlipEnergy(const FreeSwings* swings, double tolerance) : swings_(swings), tolerance_(tolerance) {}
  /// Slip within so much of the energy's work of rest counts as rest.
  void rest_in_doubt(double part_of_work) { in_doubt_ = part_of_work; }
  /// A slip begins at rest in y; or somewhere else, so that its energy at rest is not known.
  void begin_at_rest(const double* y);
  void begin_elsewhere() { before_.reset(); }
  bool keeps_account() const { return before_.has_value(); }
  /// The last step of the solver belongs to the slip.
  void add(const steps::Collocation& step);
  /// True if slip that is lowest in y, within the last step, comes to rest there by the energy that is left.
  bool rests(const steps::Collocation& step, double t, const double* y) const;
  /// How much later than the step's end slip came to rest (s), and to which time both it and, times the drive's speed,
  /// the displacement there are known (s).
  struct Rest {
    double later, known;
  };
  /// Puts the mass of y, at the end of the last step, where by the energy it comes to rest. Nothing if there is none
  /// left.
  std::optional<Rest> put_at_rest(const steps::Collocation& step, double direction, double* y) const;

 private:
  /// By how much friction and damping have changed the square of the swing, and the size of what they did (m²).
  struct Work {
    double sum = 0, size = 0;
  };
  Work with(const steps::Collocation& step) const;
  double turning_swing(double t, const double* y) const;

  const FreeSwings* swings_;
  double tolerance_, in_doubt_ = 0;
  Work done_;
  std::optional<double> before_;  ///< swing at rest, before the present slip
  mutable std::vector<double> stage_;
};

}  // namespace rosin::solvers::stick_slip
