/// Noise found from residuals, against closed forms and against noise that was made.
#include "analysis/inference/noise.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "core/random.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;

TEST_CASE("independent noise around a mean has the size that n - 1 numbers tell", "[noise]") {
  const auto x = white_noise(15, 3);
  double mean = 0, square = 0;
  for (const double v : x) mean += v / 15;
  for (const double v : x) square += (v - mean) * (v - mean);
  // Slopes by the mean are 1; that the residuals are not yet at it makes no difference.
  std::vector<Leftover> parts = {{x, std::vector<double>(15, 1.0), {5, 0}, true, false}};
  find_noise(parts);
  CHECK(parts.front().noise.size == Approx(std::sqrt(square / 14)).epsilon(1e-9));
  CHECK(parts.front().noise.correlation == 0);
}

TEST_CASE("size and correlation of two series come back, though many variables take some of the noise up", "[noise]") {
  // Straight lines and waves, a third of them in each series' own noise of standard deviation 1: sizes to 3/√(2n),
  // correlations to 3 √((1 − ρ²)/n).
  constexpr std::size_t n = 1000, p = 12;
  std::vector<Leftover> parts;
  const SeriesNoise truth[] = {{2e-3, 0.6}, {0.3, -0.2}};
  for (std::size_t s = 0; s < 2; ++s) {
    const auto independent = white_noise(n, 7 + s);
    Leftover part{{}, {}, {truth[s].size * 3, 0}, true, true};
    double last = independent[0];
    for (std::size_t k = 0; k < n; ++k) {
      const double rho = truth[s].correlation;
      if (k > 0) last = rho * last + std::sqrt(1 - rho * rho) * independent[k];
      part.residual.push_back(truth[s].size * last);
      for (std::size_t j = 0; j < p; ++j)
        part.slopes.push_back(j == 0 ? double(k) / n : std::cos(double(j * k) * 3.14159265358979 / n));
    }
    parts.push_back(std::move(part));
  }
  find_noise(parts);
  for (std::size_t s = 0; s < 2; ++s) {
    const auto& found = parts[s].noise;
    const double rho = truth[s].correlation;
    CHECK(found.correlation == Approx(rho).margin(3 * std::sqrt((1 - rho * rho) / n)));
    // neighbours that know each other tell less
    const double numbers = n * (1 - rho * rho) / (1 + rho * rho);
    CHECK(found.size == Approx(truth[s].size).epsilon(3 / std::sqrt(2 * numbers)));
  }
}

TEST_CASE("neighbours and roughness of plain series", "[noise]") {
  const double alternating[] = {1, -1, 1, -1, 1, -1};
  CHECK(neighbours(alternating).durbin_watson == Approx(5 * 4 / 6.0));
  CHECK(neighbours(alternating).correlation == Approx(-5 / 6.0));
  std::vector<double> line;
  const auto noise = white_noise(4000, 1);
  for (std::size_t k = 0; k < noise.size(); ++k) line.push_back(3 * double(k) + 0.1 * noise[k]);
  CHECK(roughness(line) == Approx(0.1).epsilon(0.05));
  // What is whitened is as large, and knows nothing of its neighbour.
  std::vector<double> walk = {1};
  for (int k = 1; k < 5; ++k) walk.push_back(0.8 * walk.back());
  whiten(walk, 1, 0.8);
  CHECK(walk[0] == 1);
  for (std::size_t k = 1; k < 5; ++k) CHECK(walk[k] == Approx(0).margin(1e-15));
}

TEST_CASE("points that stand apart part a series, and tell nothing of its noise", "[noise]") {
  // Stretches of 50 points with noise of 0.7 and correlation 0.6, and 25 between them of any size.
  const auto independent = white_noise(3000, 5);
  Leftover part{{}, {}, {1, 0}, true, true};
  double last = 0;
  for (std::size_t k = 0; k < independent.size(); ++k) {
    const bool apart = k % 75 >= 50;
    last = k % 75 == 0 ? independent[k] : 0.6 * last + 0.8 * independent[k];
    part.residual.push_back(apart ? 1e3 * independent[k] : 0.7 * last);
    part.slopes.push_back(1);
    part.apart.push_back(apart);
  }
  std::vector<Leftover> parts = {part};
  find_noise(parts);
  CHECK(parts[0].noise.size == Approx(0.7).epsilon(0.06));
  CHECK(parts[0].noise.correlation == Approx(0.6).margin(0.06));
  std::vector<double> values = {1, 2, 3, 4};
  whiten(values, 1, 0.6, std::vector<char>{0, 0, 1, 0});
  CHECK(values[1] == Approx((2 - 0.6) / 0.8));
  CHECK(values[2] == 3);
  CHECK(values[3] == 4);
}
