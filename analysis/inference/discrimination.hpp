/// Which measurement tells competing laws apart: metrics with their noise, over a plane of test conditions.
///
/// Measurements are taken as independent and normally distributed about what the model predicts. One measurement of
/// all metrics then brings, on average, the Kullback–Leibler divergence as logarithm of the likelihood ratio in favour
/// of the true law (Kullback 1959); for a parameter, its Fisher information.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "analysis/planes/varied.hpp"

namespace rosin::analysis::inference {

using planes::Varied;

/// Standard deviation of a measured metric: the root of absolute² + (relative·value)².
struct Noise {
  std::string metric;
  double absolute = 0;  ///< in the unit of the metric
  double relative = 0;
};

struct DesignOptions {
  planes::Axis x, y;  ///< test conditions
  std::vector<Noise> noise;
  double tolerance = 1e-6;  ///< of the metrics
  double stick_threshold = 0.1;
  int threads = 1;
  double confidence = 0.95;  ///< probability of the right decision that repeats are counted for
};

/// A plane of discriminability.
struct Design {
  planes::Axis x, y;
  // All row by row, [iy * x.size + ix]; NaN where a member has no result.
  std::vector<double> information;        ///< of one measurement of all metrics: nats, or Fisher's, of ln(parameter)
  std::vector<double> information_error;  ///< from the errors of the metrics
  /// From each metric alone, in the order of the noise; of more than two members, of the pair hardest to tell apart by
  /// it.
  std::vector<std::vector<double>> by_metric;
  std::vector<double> repeats;  ///< measurements needed; infinity where none helps; empty for a parameter
  /// Of a pair that cannot be told apart anywhere, information is 0.
  struct Best {
    double x = 0, y = 0, information = 0, repeats = 0;
  };
  Best best;
  std::vector<Best> best_by_metric;  ///< if only this metric is measured
  std::vector<planes::Map> maps;     ///< of the members
  Outcome outcome;
  long failed = 0;  ///< points where a member has no result
};

/// Repeats of a measurement until the likelihood ratio decides rightly with the given probability: with d² twice the
/// information (the squared distance in standard deviations), n = (2 z/d)², z the normal quantile of the probability.
/// Exact where both members have the same noise. Infinity for no information.
double repeats_needed(double information, double confidence);

/// Expected log-likelihood ratio between members; of more than two, of the pair that is hardest to tell apart, and
/// of both directions of a pair the smaller. Steady sliding counts with its own metrics (no stick, no loop, all slip
/// rates V); a period says nothing where only one member has one.
/// \throws InputError for fewer than two members, no noise, noise without size, unknown metrics.
Design discriminate(std::span<const Varied> members, const DesignOptions&, const planes::MapHooks& = {});

/// Fisher information of ln(parameter) from metrics, by central differences of relative size 0.02: what their means
/// tell, and what noise tells that is a part of them. The parameter may be one of the axes. 1/√(n·information) is the
/// standard error of ln(parameter) from n measurements.
Design inform(const Varied&, const std::string& parameter, const DesignOptions&, const planes::MapHooks& = {});

}  // namespace rosin::analysis::inference
