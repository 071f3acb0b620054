/// The pin-on-disk rig: a pin on an elastic arm, pressed on a moving track, and what its parts are in numbers.
#pragma once
#include <array>
#include <memory>

#include "laws/normal_law.hpp"
#include "oscillators/profile.hpp"
#include "oscillators/structure.hpp"

namespace rosin::oscillators {

/// Tworzydlo, Becker & Oden (1992), section 6.1, with the block's inertia of 69.0 kg cm² (96.0 in print), which its
/// rotation at 126 Hz asks for. Plane motion along the track (x), along the axis of the disk (y, from disk to block)
/// and in rotation (counter-clockwise) of three bodies: the pin, the piece of the disk under it, and the block that the
/// arm carries. Links of infinite stiffness are rigid, and take their coordinates out of the structure.
struct PinOnDisk {
  double pin_diameter = 5e-3, pin_height = 15e-3;    ///< m
  double pin_mass = 2.2972e-3;                       ///< kg
  double pin_inertia = 4.6663e-8;                    ///< kg m²
  double block_mass = 4.5, block_inertia = 6.90e-3;  ///< kg, kg m²
  double lever = 0.03085;                            ///< from the pin's centre up to the block's, m
  // Along, normal, rotation: N/m, N/m, N m/rad and the same with s.
  std::array<double, 3> arm_stiffness{84560, 773900, 4325}, arm_damping{};
  std::array<double, 3> pin_stiffness{infinity, 2.057e6, infinity}, pin_damping{};  ///< between pin and block
  std::array<double, 3> disk_stiffness{infinity, infinity, infinity};
  std::array<double, 2> disk_mass{10, 24};  ///< along, normal, kg
  double disk_inertia = infinity;           ///< kg m²; infinite: it does not rotate
  double disk_height = 0.05;                ///< of its piece, m
  double angle = 0;                         ///< of attack: tilt of the track against the pin's face, rad
  bool convective = false;                  ///< the moving disk's Coriolis force between rotation and normal motion
  int stations = 64;                        ///< of the quadrature over the pin's circular face
  std::shared_ptr<const NormalLaw> normal_law;
  Profile profile;  ///< of the track; each place of the face is at a distance of its own along it
};

/// Law, speed and load are those of the contact: the load presses the block, and the arm bears a part of it.
/// \throws InputError for damping of a rigid link, for a convective term without the motions that it couples, and for
/// a profile under a speed that varies.
Structure pin_on_disk(const PinOnDisk&, FrictionContact);

}  // namespace rosin::oscillators
