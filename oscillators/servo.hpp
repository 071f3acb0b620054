/// A position servo that acts on a coordinate of a structure.
#pragma once
#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// The structure with the servo. Where it integrates, the force f = ki ∫(r − x) dt is one more coordinate, without
/// mass: ḟ + ki x = ki r ("servo_force", N); it feeds energy, as no spring does, and hunts where friction at rest is
/// above that in motion (Armstrong-Hélouvry, Dupont & Canudas de Wit 1994). Of one that samples the coordinates without
/// mass are those of SampledServo, "servo_force", "servo_integral" (N), "servo_reading" (m) and "servo_speed" (m/s).
/// \throws InputError where force and reference of the coordinate both vary, and for a feedforward of a reference whose
/// velocity jumps
Structure with_servo(Structure, const Servo&);

}  // namespace rosin::oscillators
