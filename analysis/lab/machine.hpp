/// The machine of an experiment: an oscillator whose load point is driven, and what its sensors show.
///
/// The surface moves under the machine at drive.speed. While that is constant it is a machine that is pulled over a
/// surface at rest; where it jumps, masses keep their velocity in the frame of the machine.
#pragma once
#include <memory>

#include "analysis/lab/experiment.hpp"

namespace rosin::analysis::lab {

/// A weighted sum of the coordinates, which are the first columns of a record, times a factor.
struct CoordinateSum {
  std::vector<double> weights;
  double factor = 1;

  /// Without the factor, at each sample.
  std::vector<double> over(const std::vector<std::vector<double>>& columns) const;
  /// What the errors of columns leave of it, without the factor.
  double error(const std::vector<double>& column_errors) const;
};

/// How a machine slides at a constant speed, in the long run and near steady sliding.
struct Regime {
  bool stable = false;              ///< steady sliding
  double settling_time = 0;         ///< s, of steady sliding; 0: it is unstable
  double friction_coefficient = 0;  ///< of steady sliding
  bool oscillates = false;          ///< stick–slip is reached from rest
  std::string why_not = {};         ///< where it is not
  struct Number {
    double value = std::numeric_limits<double>::quiet_NaN(), error = 0;
  };
  Number period, force_drop, slip_rate_max, stick_fraction;  ///< s, N, m/s, 1; of stick–slip
  /// Nearest thresholds of steady sliding: N/m at the contact, and N on all contacts.
  Number critical_stiffness, critical_load;
  std::vector<double> slip_rate = {}, friction_coefficient_over = {};  ///< of a period: the loop of friction
};

class Machine {
 public:
  virtual ~Machine() = default;

  /// The motion while the load point moves at `speed`, m/s, from a start by its kind alone, with the columns of a run.
  /// A machine with several contacts adds slip_rate, their mean by loads, friction_force, the sum, and
  /// friction_coefficient, that over the sum of loads.
  virtual motion::Run run(const Signal& speed, const motion::RunOptions&) const = 0;
  virtual std::vector<std::string> column_names() const = 0;
  /// Longest time constant of steady sliding at slip rate V, s; 0 without memory, infinity if it is unstable.
  virtual double settling_time(double V) const = 0;
  /// \throws InputError where the machine's drive varies
  virtual Regime regime(double tolerance) const = 0;

  virtual double normal_load() const = 0;  ///< N, on all contacts
  virtual double stiffness() const = 0;    ///< at the contact, N/m; infinity: it follows the load point
  /// The machine imposes the slip rate, and nothing yields.
  virtual bool rigid() const { return false; }
  virtual bool friction_may_jump() const = 0;      ///< at events of a run
  virtual CoordinateSum displacement() const = 0;  ///< of the contact along its slip, m
  virtual CoordinateSum spring_force() const = 0;  ///< that holds the contact, N
  /// The model where it imposes the slip rate and friction has no memory: its curve is the record. Null: it moves.
  virtual const Model* curve() const { return nullptr; }
};

std::unique_ptr<const Machine> slider_machine(Model);
/// Springs, dampers, masses and contacts of a structure; all surfaces move at the speed of the load point.
std::unique_ptr<const Machine> structure_machine(oscillators::Structure);
/// The task's structure, or else its slider.
std::unique_ptr<const Machine> machine_of(const Task&);

}  // namespace rosin::analysis::lab
