/// A servo as stiffness, damping and force, and one coordinate for what it integrates.
#include "oscillators/servo.hpp"

namespace rosin::oscillators {

namespace {

/// By zeros; what is empty stays so.
void extend(Eigen::VectorXd& of, Eigen::Index size) {
  if (of.size() > 0) of.conservativeResizeLike(Eigen::VectorXd::Zero(size));
}
void extend(Eigen::MatrixXd& of, Eigen::Index rows, Eigen::Index columns) {
  of.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, columns));
}

}  // namespace

Structure with_servo(Structure structure, const Servo& servo) {
  const Eigen::Index n = structure.size(), x = servo.coordinate;
  structure.K(x, x) += servo.proportional;
  structure.C(x, x) += servo.derivative;
  structure.force.resize(std::size_t(n), 0.0);
  Signal& force = structure.force[std::size_t(x)];
  if (servo.reference.constant())
    force = force.scaled(1, servo.proportional * servo.reference.level());
  else if (force.constant())
    force = servo.reference.scaled(servo.proportional, force.level());
  else
    throw InputError("the servo's reference and the force on its coordinate both vary; one of them is to be constant");
  if (servo.limit < infinity)
    structure.limited.push_back({.coordinate = servo.coordinate,
                                 .stiffness = servo.proportional,
                                 .damping = servo.derivative,
                                 .command = servo.reference.scaled(servo.proportional, 0),
                                 .integral = servo.integral > 0 ? int(n) : -1,
                                 .limit = servo.limit,
                                 .tracking = 1 / servo.anti_windup});
  if (servo.integral == 0) return structure;

  for (auto* matrix : {&structure.M, &structure.C, &structure.K}) extend(*matrix, n + 1, n + 1);
  structure.C(n, n) = 1;
  structure.K(n, x) = servo.integral;
  structure.K(x, n) = -1;
  structure.force.push_back(servo.reference.scaled(servo.integral, 0));
  structure.units.resize(std::size_t(n), "m");
  structure.units.push_back("N");
  if (!structure.names.empty()) structure.names.push_back("servo_force");
  for (auto& contact : structure.contacts) {
    extend(contact.tangential, n + 1);
    extend(contact.load_along, n + 1);
    if (contact.normal.size() > 0) extend(contact.normal, n + 1, contact.normal.cols());
    if (contact.face) extend(contact.face->middle, n + 1), extend(contact.face->along, n + 1);
  }
  for (auto& functional : structure.functionals) extend(functional.row, n + 1);
  return structure;
}

}  // namespace rosin::oscillators
