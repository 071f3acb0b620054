/// Weibull distributions: published moments, and fits that find what samples were drawn from.
#include "analysis/studies/weibull.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "core/error.hpp"

using namespace rosin::analysis;
using namespace rosin::analysis::studies;

TEST_CASE("moments and quantiles of Weibull distributions on both sides of a threshold", "[weibull]") {
  const Weibull above{0, 0.05, 0.8}, below{0.3, 0.1, -3};
  CHECK(above.mean() == Approx(0.05665015482).epsilon(1e-9));
  CHECK(above.standard_deviation() == Approx(0.07140824452).epsilon(1e-9));
  CHECK(above.quantile(0.95) == Approx(0.1970601241).epsilon(1e-9));
  CHECK(below.mean() == Approx(0.02917641211).epsilon(1e-9));
  CHECK(below.standard_deviation() == Approx(0.1838807375).epsilon(1e-9));
  CHECK(below.quantile(0.95) == Approx(0.1612619254).epsilon(1e-9));
  // Fits that are printed with their means and standard deviations (two-dimensional study, four algorithms).
  const double printed[][5] = {{0.2751, 0.235, -2.7020, 0.2180, 0.0482},
                               {0, 3.48e-2, 0.7734, 0.04043, 0.05287},
                               {0, 2.33e-3, 0.5285, 4.225e-3, 8.756e-3},
                               {0, 2.17e-3, 0.5180, 4.073e-3, 8.677e-3}};
  for (const auto& [x0, theta, b, mean, deviation] : printed) {
    const Weibull fit{x0, theta, b};
    CHECK(fit.mean() == Approx(mean).epsilon(2e-3));
    CHECK(fit.standard_deviation() == Approx(deviation).epsilon(3e-3));
  }
}

TEST_CASE("all three fits find the distribution of ten thousand samples", "[weibull]") {
  const Weibull drawn = GENERATE(Weibull{0, 0.05, 0.8}, Weibull{0.376, 0.2, -4.3});
  std::mt19937_64 random(1);
  std::vector<double> samples(10'000);
  for (double& x : samples) x = drawn.quantile(std::uniform_real_distribution<double>(0, 1)(random));
  for (const auto& fit : {weibull_by_moments(samples, drawn.threshold), weibull_by_plot(samples, drawn.threshold),
                          weibull_by_likelihood(samples, drawn.threshold).fit}) {
    CHECK(fit.shape == Approx(drawn.shape).epsilon(0.05));
    CHECK(fit.characteristic == Approx(drawn.characteristic).epsilon(0.05));
  }
}

TEST_CASE("intervals of the likelihood hold the truth in about 95 of 100 samples", "[weibull]") {
  const Weibull drawn{0, 2, 1.5};
  std::mt19937_64 random(2);
  int shape_held = 0, characteristic_held = 0;
  constexpr int repeats = 1000;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<double> samples(200);
    for (double& x : samples) x = drawn.quantile(std::uniform_real_distribution<double>(0, 1)(random));
    const auto fit = weibull_by_likelihood(samples, 0);
    shape_held += fit.shape_interval[0] <= drawn.shape && drawn.shape <= fit.shape_interval[1];
    characteristic_held += fit.characteristic_interval[0] <= drawn.characteristic &&
                           drawn.characteristic <= fit.characteristic_interval[1];
  }
  CHECK(shape_held == Approx(950).margin(25));
  CHECK(characteristic_held == Approx(950).margin(25));
}

TEST_CASE("intervals are as wide as the tabulated variances of the estimates say", "[weibull]") {
  // n var(b̂)/b² → 0.6079 and n b² var(ln θ̂) → 1.1087: Lawless (1982), Statistical Models and Methods for Lifetime
  // Data, section 4.1 (its σ = 1/b).
  const std::vector<double> samples = {0.4, 0.9, 1.1, 1.6, 1.9, 2.4, 2.6, 3.3, 4.1};
  const double n = double(samples.size()), normal = 1.959964;
  const auto above = weibull_by_likelihood(samples, 0);
  const auto width = [](const double(&interval)[2], double from) {
    return 0.5 * std::log(std::abs((interval[1] - from) / (interval[0] - from)));
  };
  CHECK(width(above.shape_interval, 0) == Approx(normal * std::sqrt(0.6079 / n)).epsilon(1e-4));
  CHECK(width(above.characteristic_interval, 0) ==
        Approx(normal * std::sqrt(1.1087 / n) / above.fit.shape).epsilon(1e-4));
  CHECK(above.characteristic_interval[0] * above.characteristic_interval[1] ==
        Approx(std::pow(above.fit.characteristic, 2)).epsilon(1e-12));
  // Below a threshold x₀ the inverse distance is what is distributed.
  std::vector<double> mirrored;
  for (const double y : samples) mirrored.push_back(7 - 1 / y);
  const auto below = weibull_by_likelihood(mirrored, 7);
  CHECK(below.fit.shape == Approx(-above.fit.shape).epsilon(1e-10));
  CHECK(7 - 1 / above.characteristic_interval[0] == Approx(below.characteristic_interval[0]).epsilon(1e-10));
  CHECK(7 - 1 / above.characteristic_interval[1] == Approx(below.characteristic_interval[1]).epsilon(1e-10));
}

TEST_CASE("a summary is what a box plot shows", "[weibull]") {
  const std::vector<double> samples = {4, 1, 3, 2, 5};
  const auto summary = summarise(samples);
  CHECK(summary.median == 3);
  CHECK(summary.quarter == 2);
  CHECK(summary.q95 == Approx(4.8));
  CHECK(summary.standard_deviation == Approx(std::sqrt(2.5)));
  CHECK_THROWS_AS(weibull_by_plot(std::vector<double>{1, 1, 1}, 0), rosin::InputError);
  CHECK_THROWS_AS(weibull_by_plot(std::vector<double>{-1, 1, 2}, 0), rosin::InputError);
}
