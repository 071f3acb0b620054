/// Steady sliding of the bow over the string, by linear theory: does it grow into a sound, and at which partials?
#pragma once
#include <complex>
#include <string>
#include <vector>

#include "analysis/response/sliding_receptance.hpp"
#include "core/error.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::analysis::strings {

using oscillators::BowedStringModel;

/// Modes of the string under the sliding bow, with all waves as they are sampled. They obey
///   det(1 + Z(s) (Y(s) + H(s))) = 0,
/// Z the answer of friction to slip rate (response::FrictionResponse), Y the mobility of the string under the bow, and
/// H that of the bow's hair. A lossless string under a bow in its middle, on which friction falls by κ < 2Z₀ with the
/// slip rate, has growth rates of 2f₀ ln((2Z₀ + κ)/(2Z₀ − κ)) at odd partials.
struct StringSliding {
  Outcome outcome;  ///< tolerance_not_met: more modes grow than partials were followed to
  double slip_rate, friction_force, friction_coefficient;
  double slope;      ///< of friction, at once, by slip rate (N s/m): of the whole bow
  double impedance;  ///< of string and hair together, at once (N s/m)
  /// Friction falls with the slip rate by more than the impedance: the slip rate jumps before a wave returns, and there
  /// are no modes.
  bool jumps = false;
  struct Mode {
    std::complex<double> eigenvalue;  ///< 1/s, Im ≥ 0; 0: no oscillation
    double error;                     ///< absolute: the difference to twice the sample rate
    int partial;                      ///< of the open string that it comes from
    bool torsional;
  };
  std::vector<Mode> modes;  ///< up to a quarter of the sample rate, the fastest growing first
  bool stable = false;      ///< no mode grows
  int unstable_modes() const;
};

/// At the speed and the load with which the bow begins.
/// \throws InputError for a bow at rest or without load
StringSliding sliding_stability(const BowedStringModel&);

/// One contact of the bow by itself, at the speed with which the bow begins and its share of the load.
oscillators::Model contact_in_sliding(const BowedStringModel&);
/// How the surface of the string under a contact of the sliding bow answers a small force there, with the friction of
/// all contacts: (1 + Y Z (1 + H Z)⁻¹)⁻¹ Y/s, from Y, H and Z of StringSliding. Errors are the difference to twice the
/// sample rate.
/// \param contact  from 0
/// \throws InputError for a bow at rest or without load
response::SlidingReceptance sliding_receptance(const BowedStringModel&, int contact);

}  // namespace rosin::analysis::strings
