/// Rounding error in eigenvalues and Hopf points of steady sliding.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "analysis/steady/stability.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::slider_under;

TEST_CASE("eigenvalues twenty-eight decades apart all keep their digits", "[stability]") {
  // Slip law, N a/(V m) = 3e19 1/s next to loading at 1e-12 1/s: QR returned 0 for the least.
  const auto model =
      slider_under("slip", {0.4459, 0.0263, 0.03411, 0.000496, 4.823e-8}, {0.003189, 4.429e4, 0}, 6.973e-12, 2.399e7);
  const auto found = steady::stability(model);
  REQUIRE(found.eigenvalues.size() == 3);
  CHECK(!found.stable);
  CHECK(!found.marginal);
  // The two slow ones are those without mass: (N a s + k V)(s + V/L) = N b s V/L.
  const double a = 0.0263, b = 0.03411, N = 2.399e7, k = 4.429e4;
  const double V = 6.973e-12, rate = V / 0.000496;
  const double linear = k * V + N * (a - b) * rate, constant = k * V * rate;
  const double root = std::sqrt(linear * linear - 4 * N * a * constant);
  CHECK(found.eigenvalues[0].real() == Approx((-linear + root) / (2 * N * a)).epsilon(1e-9));
  CHECK(found.eigenvalues[1].real() == Approx(2 * constant / (-linear + root)).epsilon(1e-9));
}

TEST_CASE("growth within rounding error is marginal, and has no Hopf points", "[stability]") {
  // Heat in ten parts under a mass at 16 m/s: friction hardly depends on the slip rate any more, growth is 1e-17 1/s.
  const auto model = slider_under(
      "thermal-disc", {0.1788, 0.2359, 0.004453, 0.3142, 0.0985, 0.00783, 0.005374, 0.008425, 0.6339, 4.655e-5, 0.9548},
      {2.026e-5, 39.25, 0}, 15.92, 1.169);
  const auto found = steady::stability(model);
  REQUIRE(found.eigenvalues.size() == 12);
  CHECK(found.marginal);
  CHECK(steady::hopf_points(model, "drive.normal_load").empty());
}

TEST_CASE("rounding error of 5 kN does not move a weakening contact to another slip rate", "[stability]") {
  // Within rounding error of 5e3 N lies sliding at 7e3 m/s, where viscous friction alone bears the load.
  Model model = slider_under("lugre-unscaled", {4.648e4, 93.5, 0.9755, 1.362, 0.09652, 0.001058}, {0.7443, 0.05649, 0},
                             1.061e-8, 3946.0);
  model.lambda = 0;
  model.contact_stiffness.tangential = 11.67;
  model.drive.force = 95.34;
  // The mass rings on the contact spring k_t against a falling curve of slope Z: growth k_t^2/(-2 Z m w^2).
  const auto at = [&](double N) { return steady::stability(model.with("drive.normal_load", N)).eigenvalues.front(); };
  for (double N = 2e3; N < 2e5; N *= 1.07) {
    const double slope = N * model.law->steady_friction({1.061e-8, N}).slope, k_t = 11.67;
    CHECK(at(N).real() == Approx(-k_t * k_t / (2 * slope * (k_t + 0.05649))).epsilon(0.01));
  }
  // Stability changes once, where the falling curve and the viscous part balance: there the mass oscillates freely.
  const auto points = steady::hopf_points(model, "drive.normal_load");
  REQUIRE(points.size() == 1);
  CHECK(points[0].angular_frequency == Approx(std::sqrt(0.05649 / 0.7443)).epsilon(1e-9));
}

TEST_CASE("Hopf points lie where growth changes its sign, though bristles cancel all but 1e-12 of it", "[stability]") {
  Model model = slider_under("lugre-unscaled", {9.895e4, 88.74, 0.7516, 1.911, 0.05283, 0.002422},
                             {0.0005591, 1.341e5, 0}, 4.262e-6, 0.3);
  model.lambda = 1.708e-5;
  const auto points = steady::hopf_points(model, "drive.normal_load", 1);
  REQUIRE_FALSE(points.empty());
  for (const auto& p : points) {
    const double step = std::max(3 * p.value_error, 1e-12 * p.value);
    const auto below = steady::stability(model.with("drive.normal_load", p.value - step)),
               above = steady::stability(model.with("drive.normal_load", p.value + step));
    CHECK((below.marginal || above.marginal || below.stable != above.stable));
  }
}

TEST_CASE("rounding error of damping that cancels against falling friction is in the errors of growth", "[stability]") {
  // m s^2 + (c + N dmu/dv) s + k = 0, where the sum in brackets keeps 1e-5 of its terms.
  const double m = 0.160881, k = 0.0458821, c = 7075.26, N = 7.67535;
  const double V = 6.40602e-8;
  const std::vector<double> v = {0.0, 8.87544e-5, 0.000266263}, mu = {0.436322, 0.370874, 0.33815};
  const auto model = slider_under("tabulated", {v, mu}, {m, k, c}, V, N);
  const auto found = steady::stability(model);
  const double D = c + N * model.law->steady_friction({V, N}).slope;
  REQUIRE(std::abs(D) < 1e-4 * c);
  const std::complex<double> s = (-D + std::sqrt(std::complex<double>(D * D - 4 * m * k))) / (2 * m);
  REQUIRE(found.eigenvalues.size() == 2);
  const double digits = 4 * std::numeric_limits<double>::epsilon() * c / m;  // of this closed form
  CHECK(std::abs(found.eigenvalues.front() - s) <= found.eigenvalue_errors.front() + digits);
  CHECK(found.eigenvalue_errors.front() > 0.01 * digits);
  CHECK(found.eigenvalue_errors.front() < 100 * digits);
}
