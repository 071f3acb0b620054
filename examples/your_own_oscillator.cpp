/// An oscillator of your own: two rotors and a dry clutch in 25 lines, served by every verb for structures.
///
/// Rotor 1 is rubbed by a driven disc at the radius R, a spring k couples it to rotor 2, and a spring k2 holds that:
///   J1 q1'' = -k (q1 - q2) - c (q1' - q2') + R F + T,   J2 q2'' = k (q1 - q2) + c (q1' - q2') - k2 q2,
/// with friction F at the slip rate V - R q1'. The program is the command `rosin` with one type more:
///   your_own_oscillator stability two-rotors.toml
#include <rosin/app/add_oscillator.hpp>
#include <rosin/app/command.hpp>

using namespace rosin;

// clang-format off
struct TwoRotors {
  static constexpr std::string_view name = "two-rotors";  // oscillator.type
  double J1 = 1, J2 = 1, k = 1, k2 = 1, c = 0, R = 0.1;
  static constexpr auto parameters = table(field(&TwoRotors::J1, "inertia_1", "kg m^2", {1e-12, 1e12}, "of the rotor in the clutch"),
      field(&TwoRotors::J2, "inertia_2", "kg m^2", {1e-12, 1e12}, "of the rotor on the frame's spring"),
      field(&TwoRotors::k, "stiffness", "N m/rad", {0, 1e15}, "between the rotors"),
      field(&TwoRotors::k2, "stiffness_2", "N m/rad", {0, 1e15}, "from rotor 2 to the frame"),
      field(&TwoRotors::c, "damping", "N m s/rad", {0, 1e15}, "between the rotors"),
      field(&TwoRotors::R, "clutch_radius", "m", {1e-6, 1e6}, "at which the disc rubs"));

  oscillators::Structure structure(oscillators::FrictionContact clutch, const Signal& force) const {
    oscillators::Structure rotors;
    rotors.names = {"angle_1", "angle_2"}, rotors.units = {"rad", "rad"};
    rotors.M = Eigen::Vector2d(J1, J2).asDiagonal();
    rotors.C = Eigen::Matrix2d{{c, -c}, {-c, c}};
    rotors.K = Eigen::Matrix2d{{k, -k}, {-k, k + k2}};
    rotors.force = {force, 0.0};  // drive.force: a torque T on rotor 1, N m
    clutch.tangential = Eigen::Vector2d(R, 0);
    rotors.contacts = {clutch};
    return rotors;
  }
};
// clang-format on

int main(int argc, char** argv) {
  app::add_oscillator<TwoRotors>();
  return app::command(argc, argv);
}
