/// A position servo that acts on a coordinate of a structure.
#pragma once
#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// u = kp (r − x) + ki ∫(r − x) dt − kd ẋ on coordinate x (N), without delay, and no more than its limit. Where u is
/// beyond the limit the integral goes on, or, with an anti-windup time T, follows what the limit leaves of u: f being
/// the integral's part, ḟ = ki (r − x) − (u − limited u)/T (back-calculation, Åström & Hägglund 1995, section 3.5).
struct Servo {
  int coordinate = 0;
  double proportional = 0, integral = 0, derivative = 0;  ///< N/m, N/(m s), N s/m
  double feedforward = 0;                                 ///< N s/m: the force on a velocity ṙ, added to u
  Signal reference = 0.0;                                 ///< m
  double limit = infinity;                                ///< N
  double anti_windup = infinity;                          ///< s; infinity: the integral goes on
};

/// The structure with the servo. Where it integrates, the force f = ki ∫(r − x) dt is one more coordinate, without
/// mass: ḟ + ki x = ki r ("servo_force", N); it feeds energy, as no spring does, and hunts where friction at rest is
/// above that in motion (Armstrong-Hélouvry, Dupont & Canudas de Wit 1994). \throws InputError where force and
/// reference of the coordinate both vary, and for a feedforward of a reference whose velocity jumps
Structure with_servo(Structure, const Servo&);

}  // namespace rosin::oscillators
