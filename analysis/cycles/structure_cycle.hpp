/// Periodic motion of a structure: that which it settles on, or its answer to a periodic drive; and of a slider, as a
/// structure of one coordinate.
#pragma once
#include <complex>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/motion/structure_start.hpp"

namespace rosin::analysis::cycles {

struct StructureCycleOptions {
  double tolerance = 1e-8;       ///< relative, of period and extremes
  int max_cycles = 10'000;       ///< returns of the transient before giving up
  double stick_threshold = 0.1;  ///< ε: a contact whose law has no stick counts as stuck at |v| ≤ ε V
  bool multipliers = true;
  bool exponent = false;        ///< the largest Lyapunov exponent, where no period is found
  long most_steps = 5'000'000;  ///< of all that is followed
};

struct StructureCycle {
  Outcome outcome;  ///< none_exists: the motion settles on steady sliding, or comes to rest; unbounded: it grows
  int returns = 0;  ///< of the section in a period: periods of the drive, or maxima of the coordinate; 0: none found
  struct Measure {
    double value, error;  ///< absolute
    std::string unit, meaning = {};
  };
  std::map<std::string, Measure> metrics;              ///< of one period, by the names of cycle_metrics_of()
  std::string metrics_left_out;                        ///< the reason why some are not known; empty: all are
  std::vector<double> coordinate_max, coordinate_min;  ///< m
  /// Floquet, largest modulus first, without the trivial 1 of a structure that is not driven; of what stick forgets 0.
  std::vector<std::complex<double>> multipliers;
  std::vector<double> multiplier_errors;
  std::string multipliers_left_out;
  bool stable = false;
  bool ill_conditioned_stick = false;  ///< of a slider, as in Cycle
  std::optional<double> growth;        ///< of a slider, as in Cycle
  std::optional<Exponent> exponent;    ///< the largest, of a motion that goes on without a period
  /// "symmetric": after half a period all coordinates are reversed; "twin": the drive has that symmetry but the motion
  /// has not, so that its mirror image is another motion; "": the drive has none.
  std::string symmetry;
  std::vector<motion::RunEvent> events;  ///< of one period, by the time since its start
  std::vector<double> start;             ///< unknowns at the start of the period, or where the search for one ended
  std::vector<std::string> column_names, column_units;
  std::vector<double> time;                  ///< at the stages of the solver's steps
  std::vector<std::vector<double>> columns;  ///< [column][moment]
  struct Cost {
    long steps = 0, evaluations = 0, cycles = 0;
  } cost;
};

/// The list of metrics of a period, by name, with units and meanings: "period"; of each column of the record "…_max",
/// "…_min", "…_mean" and "…_amplitude", half its range (friction coefficients as "friction_max" or "friction_1_max");
/// of each coordinate its harmonics and their distortion; of each contact with friction the parts of the period at rest
/// and at low slip rates, the distance slipped and the friction loop; and "friction_work", the heat of friction.
std::map<std::string, StructureCycle::Measure> cycle_metrics_of(const oscillators::Structure&);

/// The motion from the start is followed until it recurs after some returns; Newton's method on the map of a period,
/// with its exact derivative, then closes it at two tolerances, whose difference is the error.
/// \throws InputError where the drive has no period, and for a start that does not fit.
StructureCycle find_cycle(const motion::StructureModel&, const StructureCycleOptions&);

/// The cycle that find_cycle(Model) certifies, with all metrics of the list above. Those of Metrics are its own; of the
/// others one more period from the same point, as a structure of one coordinate, shows values and errors at two
/// tolerances. Where no cycle is found, those of Metrics are NaN. \throws InputError as find_cycle(Model)
StructureCycle find_measured_cycle(const Model&, const CycleOptions&);

}  // namespace rosin::analysis::cycles
