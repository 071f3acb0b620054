/// Steady sliding of a structure, and its complex modes: is it stable, and what grows.
#pragma once
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "oscillators/structure_system.hpp"

namespace rosin::analysis::steady {

/// A motion e^(st) about steady sliding. Pairs are given once, with the frequency above 0.
struct ComplexMode {
  std::complex<double> eigenvalue;          ///< s, 1/s
  double error;                             ///< of the eigenvalue, that rounding leaves (1/s)
  std::vector<std::complex<double>> shape;  ///< of the coordinates, the largest of them 1; all 0 where none moves
  double frequency() const;                 ///< Hz
  double growth_rate() const { return eigenvalue.real(); }
  double damping_ratio() const;  ///< −Re s/|s|
  bool grows() const { return growth_rate() > error; }
  bool is_neutral() const { return std::abs(growth_rate()) <= error; }
};

struct StructureStability {
  std::vector<double> coordinates;  ///< of steady sliding, m
  std::vector<double> inertia;      ///< of the coordinates, by which shapes are compared (kg)
  struct Contact {
    double normal_load, friction_force, slip_rate;  ///< N, N, m/s
  };
  std::vector<Contact> contacts;
  std::vector<ComplexMode> modes;  ///< the largest growth rate first
  std::vector<std::complex<double>> eigenvalues;
  bool stable = false;
  bool marginal = false;  ///< growth is 0 within its error, as of undamped structures
  int unstable_modes() const { return int(std::ranges::count_if(modes, &ComplexMode::grows)); }
};

/// With drives that stand still, at their levels.
oscillators::Structure frozen(oscillators::Structure);

/// By the equations linearised in steady sliding at t = 0; drives that vary stand still.
/// \throws InputError where there is no steady sliding, and for a contact at rest, whose stick has no slope
StructureStability stability(const oscillators::Structure&);

}  // namespace rosin::analysis::steady
