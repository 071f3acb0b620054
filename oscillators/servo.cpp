/// A servo as stiffness, damping and force, and coordinates for what it integrates, or for what it remembers between
/// samples.
#include "oscillators/servo.hpp"

#include <numbers>

namespace rosin::oscillators {

namespace {

/// By zeros; what is empty stays so.
void extend(Eigen::VectorXd& of, Eigen::Index size) {
  if (of.size() > 0) of.conservativeResizeLike(Eigen::VectorXd::Zero(size));
}
void extend(Eigen::MatrixXd& of, Eigen::Index rows, Eigen::Index columns) {
  of.conservativeResizeLike(Eigen::MatrixXd::Zero(rows, columns));
}

/// kp r + feedforward·ṙ (N).
Signal command_of(const Servo& servo) {
  const auto& r = servo.reference;
  if (servo.feedforward == 0 || r.constant()) return r.scaled(servo.proportional, 0);
  const auto [value, rate, terms] = r.piece(0);
  if (r.next_break(0) < infinity || (rate != 0 && !terms.empty()) || (rate == 0 && terms.empty()))
    throw InputError(
        "the servo's feedforward needs a reference that has a velocity at every time: a ramp or harmonics");
  if (terms.empty())
    return Signal(Signal::Ramp{servo.proportional * value + servo.feedforward * rate, servo.proportional * rate});
  Signal::Harmonics command{servo.proportional * value, {}};
  for (const auto& [amplitude, w, phase] : terms) {
    command.terms.push_back({servo.proportional * amplitude, w, phase});
    command.terms.push_back({servo.feedforward * amplitude * w, w, phase + std::numbers::pi / 2});
  }
  return Signal(std::move(command));
}

/// One more coordinate, without mass, that moves where its row says so.
void add_coordinate(Structure& structure, const char* name, const char* unit) {
  const Eigen::Index n = structure.size();
  for (auto* matrix : {&structure.M, &structure.C, &structure.K}) extend(*matrix, n + 1, n + 1);
  structure.C(n, n) = 1;
  structure.force.emplace_back(0.0);
  structure.units.resize(std::size_t(n), "m");
  structure.units.emplace_back(unit);
  if (!structure.names.empty()) structure.names.emplace_back(name);
  for (auto& contact : structure.contacts) {
    extend(contact.tangential, n + 1);
    extend(contact.load_along, n + 1);
    if (contact.normal.size() > 0) extend(contact.normal, n + 1, contact.normal.cols());
    if (contact.face) extend(contact.face->middle, n + 1), extend(contact.face->along, n + 1);
  }
  for (auto& functional : structure.functionals) extend(functional.row, n + 1);
}

Structure with_sampled_servo(Structure structure, const Servo& servo) {
  const SampledServo sampled{servo, structure.size()};
  add_coordinate(structure, "servo_force", "N");
  if (sampled.integral() >= 0) add_coordinate(structure, "servo_integral", "N");
  if (sampled.reading() >= 0)
    add_coordinate(structure, "servo_reading", "m"), add_coordinate(structure, "servo_speed", "m/s");
  structure.K(servo.coordinate, sampled.held) = -1;
  structure.sampled.push_back(sampled);
  return structure;
}

}  // namespace

Structure with_servo(Structure structure, const Servo& servo) {
  const Eigen::Index n = structure.size(), x = servo.coordinate;
  structure.force.resize(std::size_t(n), 0.0);
  if (servo.sampling_time > 0) return with_sampled_servo(std::move(structure), servo);
  structure.K(x, x) += servo.proportional;
  structure.C(x, x) += servo.derivative;
  Signal& force = structure.force[std::size_t(x)];
  const Signal command = command_of(servo);
  if (command.constant())
    force = force.scaled(1, command.level());
  else if (force.constant())
    force = command.scaled(1, force.level());
  else
    throw InputError("the servo's reference and the force on its coordinate both vary; one of them is to be constant");
  if (servo.limit < infinity)
    structure.limited.push_back({.coordinate = servo.coordinate,
                                 .stiffness = servo.proportional,
                                 .damping = servo.derivative,
                                 .command = command,
                                 .integral = servo.integral > 0 ? int(n) : -1,
                                 .limit = servo.limit,
                                 .tracking = 1 / servo.anti_windup});
  if (servo.integral == 0) return structure;
  add_coordinate(structure, "servo_force", "N");
  structure.K(n, x) = servo.integral;
  structure.K(x, n) = -1;
  structure.force.back() = servo.reference.scaled(servo.integral, 0);
  return structure;
}

}  // namespace rosin::oscillators
