/// Weibull distributions of errors with a given threshold, fitted in three ways, and summaries of samples.
#pragma once
#include <span>

namespace rosin::analysis::studies {

/// R(x) = exp(−((x − x₀)/(θ − x₀))^b), the share of samples above x. b > 0: x > x₀. b < 0: x < x₀, θ < x₀.
struct Weibull {
  double threshold = 0;       ///< x₀
  double characteristic = 1;  ///< θ, exceeded by 1/e of the samples
  double shape = 1;           ///< b

  double mean() const;
  /// Infinite where b is between −2 and 0.
  double standard_deviation() const;
  /// The x that a share p of the samples stays below.
  double quantile(double p) const;
};

/// Fits to samples on one side of the threshold: all above it or all below. Samples at the threshold count as the
/// smallest distance that is not zero. \throws InputError for fewer than three different samples.
Weibull weibull_by_moments(std::span<const double> samples, double threshold);
/// The straight line through the ordered samples in a Weibull plot (median ranks (i − 0.3)/(n + 0.4), least squares of
/// ln ln 1/R over ln |x − x₀|), as it is drawn by hand.
Weibull weibull_by_plot(std::span<const double> samples, double threshold);
struct WeibullLikelihood {
  Weibull fit;
  double shape_interval[2], characteristic_interval[2];  ///< of 95 % confidence, from the information of the samples
};
WeibullLikelihood weibull_by_likelihood(std::span<const double> samples, double threshold);

/// What a box plot shows, and more.
struct Summary {
  std::size_t count = 0;
  double mean = 0, standard_deviation = 0;
  double minimum = 0, quarter = 0, median = 0, three_quarters = 0, q95 = 0, maximum = 0;
};
Summary summarise(std::span<const double> samples);

}  // namespace rosin::analysis::studies
