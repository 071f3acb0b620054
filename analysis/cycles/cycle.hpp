/// Periodic motion: the cycle that a slider settles on, its multipliers and its measurable metrics, with errors.
#pragma once
#include <array>
#include <complex>
#include <string>
#include <vector>

#include "analysis/cycles/exponent.hpp"
#include "analysis/motion/start.hpp"
#include "core/error.hpp"

namespace rosin::analysis::cycles {

using oscillators::Model;

/// Numbers that describe one period. The same type holds their absolute errors.
struct Metrics {
  double period = 0;         ///< s
  double slip_rate_max = 0;  ///< m/s
  double slip_rate_min = 0;  ///< m/s
  double friction_max = 0;   ///< coefficient
  double friction_min = 0;
  double friction_mean = 0;
  double stick_fraction = 0;        ///< part of the period with |v| <= ε V; time of exact stick for set-valued laws
  double slow_fraction = 0;         ///< part of the period with |v| <= ε V, for every law
  double stick_fraction_001 = 0;    ///< the same at ε = 0.01
  double stick_fraction_05 = 0;     ///< the same at ε = 0.5
  double loop_area = 0;             ///< |∮ (μ − μ_ss(v)) dv|, m/s
  double loop_area_normalised = 0;  ///< loop_area / (slip_rate_max · friction_max)
  double slip_rate_mean = 0;        ///< equals the drive speed on a true cycle
};

/// Names of metrics as scenes and results spell them, with unit and meaning.
struct MetricName {
  const char *name, *unit, *meaning;
  double Metrics::*member;
};
const std::vector<MetricName>& metric_names();
/// \throws InputError for an unknown name, with the nearest one.
const MetricName& find_metric(std::string_view name);

/// The size that the relative error of a metric is taken against; V: drive speed.
double size_of(const MetricName&, const Metrics&, double V);
/// True for the loop area in either form.
bool is_loop(const MetricName&);
/// True for the stick fractions, which jump where the lowest speed touches their threshold.
bool is_stick(const MetricName&);

struct CycleOptions {
  double tolerance = 1e-8;       ///< requested relative accuracy of every metric
  double stick_threshold = 0.1;  ///< ε
  bool multipliers = true;
  int max_cycles = 10'000;  ///< transient cycles integrated before giving up
  std::optional<motion::Start> start =
      std::nullopt;  ///< start of the search; none: stick. Set-valued laws always start from stick
  /// Unknowns on the section that may lie near the cycle, for a smooth law under a drive with V > 0: the first start of
  /// the search; empty: none.
  std::vector<double> near = {};
};

/// One sample of a cycle for pictures.
struct CyclePoint {
  double time, displacement, slip_rate, friction_coefficient;
  double acceleration;  ///< m/s²; NaN without mass
  std::vector<double> state;
};

struct Cycle {
  Outcome outcome;  ///< none_exists: no periodic motion was found (steady sliding is reached, or rest)
  Metrics metrics, error;
  bool ill_conditioned_stick = false;  ///< the lowest speed touches ε·V: the stick fraction jumps nearby
  /// Floquet, largest modulus first; without the trivial 1; and their absolute errors.
  std::vector<std::complex<double>> multipliers;
  std::vector<double> multiplier_errors;
  std::string multipliers_left_out;  ///< the reason why some or all are not known; empty: all requested ones are
  bool stable = false;
  /// Amplitude growth per period (ln) of a nearly neutral oscillation, below 1e-12 in magnitude. Its start sets its
  /// amplitude, and its metrics hold until the growth has added up.
  std::optional<double> growth = std::nullopt;
  std::optional<Exponent> exponent = std::nullopt;  ///< the largest, of a motion that goes on without a period
  double section_displacement = 0;                  ///< at v = V with v rising (slip onset for set-valued laws)
  std::vector<double> section_state;
  std::vector<CyclePoint> orbit;  ///< one period from the section, at the solver's own steps
  struct Cost {
    long steps = 0, evaluations = 0, cycles = 0;
  } cost;
};

/// The attracting cycle reached from stick, or from the start given. Steady sliding must not be assumed unstable:
/// coexisting cycles are found.
Cycle find_cycle(const Model&, const CycleOptions& = {});

/// The same slider under its law at λ = 0, a set-valued one, where slip can stick under it: the search for a cycle is
/// for this one. Nothing with a contact spring or without mass, where that law leaves the motion undetermined.
std::optional<Model> without_clock(const Model&);

/// True if nothing feeds an oscillation: friction nowhere falls with slip rate, and ringing on the deflected contact
/// dies out, however slowly.
bool only_rings(const Model&);

}  // namespace rosin::analysis::cycles
