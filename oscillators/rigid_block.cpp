/// The three coordinates of a rigid block, and the stations that it stands on.
#include "oscillators/rigid_block.hpp"

#include "oscillators/block.hpp"

namespace rosin::oscillators {

Structure rigid_block_on_belt(const RigidBlock& block, FrictionContact contact) {
  const double inertia = block.mass * (block.length * block.length + block.height * block.height) / 12;
  Structure structure;
  structure.M = Eigen::Vector3d(block.mass, block.mass, inertia).asDiagonal();
  structure.C = Eigen::Matrix3d::Zero();
  structure.K = Eigen::Vector3d(block.spring_stiffness, 0, 0).asDiagonal();
  structure.names = {"displacement", "normal_displacement", "rotation"};
  structure.units = {"m", "m", "rad"};

  std::vector<double> place, area;
  if (block.on_feet) {
    place = {-block.length / 2, block.length / 2};
    area.assign(2, block.length * block.thickness / 2);
  } else {
    const BlockMesh face({.length = block.length,
                          .height = block.height,
                          .thickness = block.thickness,
                          .elements = {1, 1},
                          .gauss_points = block.stations});
    for (const auto& station : face.stations) place.push_back(station.place), area.push_back(station.area);
  }
  // A turn carries the face, half a height below the centre, along the belt, and presses what lies behind.
  contact.tangential = Eigen::Vector3d(1, 0, block.height / 2);
  contact.normal.resize(3, Eigen::Index(place.size()));
  for (std::size_t s = 0; s < place.size(); ++s)
    contact.normal.col(Eigen::Index(s)) = Eigen::Vector3d(0, -1, -place[s]);
  contact.area = Eigen::Map<const Eigen::VectorXd>(area.data(), Eigen::Index(area.size()));
  if (!block.on_feet)
    contact.face = {.half_length = block.length / 2,
                    .thickness = block.thickness,
                    .middle = Eigen::Vector3d(0, -1, 0),
                    .along = Eigen::Vector3d(0, 0, -1),
                    .points = gauss_points(block.stations)};
  contact.load_along = Eigen::Vector3d(0, -1, 0);
  contact.normal_law = block.contact;
  structure.contacts = {std::move(contact)};
  structure.check();
  return structure;
}

}  // namespace rosin::oscillators
