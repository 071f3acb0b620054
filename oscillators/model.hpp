/// A model: a friction law, the slider that it acts on, and the drive; every number in it has a path.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/signal.hpp"
#include "laws/law.hpp"

namespace rosin::oscillators {

/// Mass, spring and damper: m ẍ = −k x − c ẋ + F + f. The spring is fixed, x along the drive.
struct Slider {
  double mass = 1;       ///< kg; 0: quasi-static
  double stiffness = 1;  ///< N/m; infinity with mass 0: the slip rate is imposed
  double damping = 0;    ///< N s/m
};

/// What moves and loads the slider.
struct Drive {
  Signal speed = 1.0;        ///< V, m/s, of the driving surface
  Signal normal_load = 1.0;  ///< N, newton
  Signal force = 0.0;        ///< f, newton, along x
  bool constant() const { return speed.constant() && normal_load.constant() && force.constant(); }
};

/// Tangential contact stiffness in series with the law, and a damper beside it; infinite: rigid contact.
struct ContactStiffness {
  double tangential = infinity;  ///< k_t independent of load, N/m
  double per_load = infinity;    ///< k_t/N, 1/m
  double damping = 0;            ///< c_t independent of load, N s/m
  double damping_per_load = 0;   ///< c_t/N, s/m
  bool present() const { return tangential < infinity || per_load < infinity; }
  bool damped() const { return damping > 0 || damping_per_load > 0; }
  double compliance(double N) const { return 1 / tangential + 1 / (per_load * N); }  ///< 1/k_t at load N, m/N
};

/// Law, slider and drive. A value: copy and change it freely.
struct Model {
  std::shared_ptr<const FrictionLaw> law;
  double lambda = 1;  ///< clock factor of the law's states
  ContactStiffness contact_stiffness;
  double load_memory = 0;  ///< α of Linker and Dieterich: a step of the load changes friction by −α ln(N'/N) first
  Slider slider;
  Drive drive;

  /// Every scalar parameter: its path as name ("law.a", "drive.normal_load"), unit, accepted range and meaning.
  std::vector<Quantity> parameters() const;
  /// \throws InputError for an unknown path, with the nearest one.
  Quantity describe(std::string_view path) const;
  double get(std::string_view path) const;
  /// The model with one parameter changed (the level, for a signal). \throws InputError outside its range.
  Model with(std::string_view path, double value) const;
  /// \throws InputError if parts do not fit together (a massless slider under a set-valued law, …).
  void check() const;
};

/// Accepted ranges of the parameters that are not a law's, by path.
const std::vector<Quantity>& mechanical_parameters();

/// Additional creep of a rigid contact that carries friction, far below the accuracy of any result: the direct effect
/// reverses friction within e^(−μ/a) of the slip rate, which no arithmetic resolves where a mass reverses; with it
/// friction reverses within a range as wide as rounding error.
struct FrictionCreep {
  double share;  ///< over the reference speed, at the largest friction of steady sliding at that speed and in stick
  double stuck;  ///< slip rate of stick, over the reference speed
};
/// Without memory a start from rest slips at 1e-14 of the reference speed, and the creep stays below it.
inline FrictionCreep friction_creep(double lambda) {
  return lambda == 0 ? FrictionCreep{1e-28, 1e-14} : FrictionCreep{1e-14, 1e-3};
}

}  // namespace rosin::oscillators
