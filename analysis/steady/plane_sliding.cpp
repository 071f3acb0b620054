/// The damper that friction makes across the direction of slip.
#include "analysis/steady/plane_sliding.hpp"

#include "core/error.hpp"

namespace rosin::analysis::steady {

oscillators::Structure sliding_in_plane(const solvers::stick_slip::DryMass<2>& mass,
                                        oscillators::FrictionContact contact) {
  const Eigen::Vector2d V(mass.surface_velocity[0], mass.surface_velocity[1]);
  const double speed = V.norm(), load = mass.load.level();
  if (speed == 0)
    throw InputError(
        "a plane slider slides steadily on a surface that moves alone: give drive.speed = [x, y] (m/s); on one at rest "
        "it sticks");
  const Eigen::Vector2d e = V / speed;
  const auto diagonal = [](const auto& pair) -> Eigen::Matrix2d {
    return Eigen::Vector2d(pair[0], pair[1]).asDiagonal();
  };
  oscillators::Structure structure;
  structure.M = mass.mass * Eigen::Matrix2d::Identity();
  structure.K = diagonal(mass.stiffness);
  structure.C = diagonal(mass.damping);
  const double friction = load * contact.law->steady_friction({speed, load}).friction;
  structure.C += friction / speed * (Eigen::Matrix2d::Identity() - e * e.transpose());
  structure.force = {mass.force[0], mass.force[1]};
  structure.names = {"displacement_x", "displacement_y"};
  contact.tangential = e, contact.speed = speed, contact.normal_load = mass.load;
  structure.contacts.push_back(std::move(contact));
  return structure;
}

}  // namespace rosin::analysis::steady
