/// The rig's matrices, its rigid links taken out, and the stations of the pin's face.
#include "oscillators/pin_on_disk.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rosin::oscillators {

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr int coordinates = 9;
enum Coordinate { pin_x, pin_y, pin_turn, disk_x, disk_y, disk_turn, block_x, block_y, block_turn };
constexpr const char* names[coordinates] = {"pin_displacement",   "pin_normal_displacement",   "pin_rotation",
                                            "disk_displacement",  "disk_normal_displacement",  "disk_rotation",
                                            "block_displacement", "block_normal_displacement", "block_rotation"};

/// A spring and a damper along `row`; an infinite one takes out the coordinate `moves`.
struct Link {
  Coordinate moves;
  VectorXd row;
  double stiffness, damping;
  const char* name;
};

}  // namespace

Structure pin_on_disk(const PinOnDisk& rig, FrictionContact contact) {
  const auto unit = [](Coordinate i) -> VectorXd { return VectorXd::Unit(coordinates, i); };
  std::vector<Link> links;
  const auto link = [&](Coordinate moves, const VectorXd& row, double k, double c, const char* name) {
    if (std::isinf(k) && c > 0)
      throw InputError(fmt::format("{} has no effect: the link beside it is rigid (stiffness inf)", name));
    links.push_back({moves, row, k, c, name});
  };
  for (int i = 0; i < 3; ++i) {
    link(Coordinate(block_x + i), unit(Coordinate(block_x + i)), rig.arm_stiffness[i], rig.arm_damping[i],
         "arm_damping");
    const bool turns = i < 2 || std::isfinite(rig.disk_inertia);
    link(Coordinate(disk_x + i), unit(Coordinate(disk_x + i)), turns ? rig.disk_stiffness[i] : infinity, 0, "");
  }
  // The spring along the track joins the block at the height of the pin's centre.
  link(pin_x, unit(pin_x) - unit(block_x) - rig.lever * unit(block_turn), rig.pin_stiffness[0], rig.pin_damping[0],
       "pin_damping along the track");
  link(pin_y, unit(pin_y) - unit(block_y), rig.pin_stiffness[1], rig.pin_damping[1], "pin_damping normal to the track");
  link(pin_turn, unit(pin_turn) - unit(block_turn), rig.pin_stiffness[2], rig.pin_damping[2],
       "pin_damping of rotation");

  VectorXd mass(coordinates);
  mass << rig.pin_mass, rig.pin_mass, rig.pin_inertia, rig.disk_mass[0], rig.disk_mass[1], 0, rig.block_mass,
      rig.block_mass, rig.block_inertia;
  if (std::isfinite(rig.disk_inertia)) mass[disk_turn] = rig.disk_inertia;
  MatrixXd K = MatrixXd::Zero(coordinates, coordinates), C = K,
           all_of_kept = MatrixXd::Identity(coordinates, coordinates);
  std::vector<bool> kept(coordinates, true);
  for (const Link& l : links) {
    if (std::isfinite(l.stiffness)) {
      K += l.stiffness * l.row * l.row.transpose(), C += l.damping * l.row * l.row.transpose();
      continue;
    }
    // rowᵀ q = 0, solved for the coordinate, of which the row has 1.
    kept[l.moves] = false;
    all_of_kept.row(l.moves) = (unit(l.moves) - l.row).transpose() * all_of_kept;
  }
  if (rig.convective) {
    if (!kept[disk_y] || !kept[disk_turn])
      throw InputError(
          "convective has no effect: it couples the disk's normal motion to its rotation, of which one is "
          "rigid (disk_stiffness or disk_inertia inf)");
    C(disk_y, disk_turn) += 2 * contact.speed.level() * rig.disk_mass[1];
  }

  Structure structure;
  std::vector<int> stay;
  for (int i = 0; i < coordinates; ++i)
    if (kept[i]) stay.push_back(i), structure.names.push_back(names[i]);
  if (stay.empty()) throw InputError("all links of the rig are rigid: nothing can move");
  const MatrixXd R = all_of_kept(Eigen::all, stay);
  structure.M = R.transpose() * mass.asDiagonal() * R;
  structure.C = R.transpose() * C * R;
  structure.K = R.transpose() * K * R;
  for (const int i : stay) structure.units.push_back(i % 3 == 2 ? "rad" : "m");

  // Friction acts on the pin's face, half a height below its centre, and on the top of the disk's piece.
  contact.tangential = R.transpose() * (unit(pin_x) + rig.pin_height / 2 * unit(pin_turn) - unit(disk_x) +
                                        rig.disk_height / 2 * unit(disk_turn));
  contact.load_along = -R.transpose() * unit(block_y);
  // Gauss and Chebyshev's second kind: the weight is the chord of the circle.
  contact.normal.resize(Eigen::Index(stay.size()), rig.stations);
  contact.area.resize(rig.stations), contact.gap.resize(rig.stations);
  const double radius = rig.pin_diameter / 2;
  for (int k = 0; k < rig.stations; ++k) {
    const double angle = (k + 1) * std::numbers::pi / (rig.stations + 1), s = radius * std::cos(angle);
    contact.area[k] = 2 * radius * radius * std::numbers::pi / (rig.stations + 1) * std::pow(std::sin(angle), 2);
    contact.normal.col(k) = R.transpose() * (unit(disk_y) + s * unit(disk_turn) - unit(pin_y) - s * unit(pin_turn));
    contact.gap[k] = -rig.angle * s;
  }
  contact.normal_law = rig.normal_law;
  if (!rig.profile.waves.empty()) {
    // Along the track, which moves towards larger s, a place s > 0 lies over what the middle has passed before.
    std::vector<double> ahead;
    for (int k = 0; k < rig.stations; ++k)
      ahead.push_back(-radius * std::cos((k + 1) * std::numbers::pi / (rig.stations + 1)));
    contact.normal_law = std::make_shared<OverProfile>(rig.normal_law, rig.profile, contact.speed, std::move(ahead));
  }
  structure.contacts = {std::move(contact)};
  structure.check();
  return structure;
}

}  // namespace rosin::oscillators
