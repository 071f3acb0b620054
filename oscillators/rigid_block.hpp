/// A rigid block on a belt, on a face or on two feet that give way: the limit of stiff elastic blocks.
#pragma once
#include <memory>

#include "laws/normal_law.hpp"
#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// A rectangle of even mass that slides along its length, its lower face on the belt (Oden & Martins 1985, Comput.
/// Methods Appl. Mech. Eng. 52, 527). A spring holds its centre along the belt.
struct RigidBlock {
  double mass = 1;                           ///< kg
  double length = 2, height = 1;             ///< m, along the belt and away from it
  double thickness = 1;                      ///< m, across
  double spring_stiffness = 0;               ///< N/m
  bool on_feet = false;                      ///< each half of the face bears at its end, x = ±length/2
  int stations = 16;                         ///< Gauss points of the part of the face that touches
  std::shared_ptr<const NormalLaw> contact;  ///< pressure by approach
};
/// Coordinates: the centre along the belt and upwards (m), and the rotation, anticlockwise (rad). All of the face is
/// one contact. The load of the drive is the weight.
Structure rigid_block_on_belt(const RigidBlock&, FrictionContact);

}  // namespace rosin::oscillators
