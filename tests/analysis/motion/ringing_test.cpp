/// Ringing on films, contact springs and the slider's own spring, against closed forms.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>

#include "analysis/motion/run.hpp"
#include "core/eigenpairs.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using rosin::oscillators::Model;
using rosin::tests::slider_under;

TEST_CASE("an elastic film rings under a mass until damping has stilled it", "[run]") {
  // At a millionth of its activation the film is a spring and a damper: three linear equations, solved by modes.
  const double A = 1e-8, d = 1e-9, S = 1e9, tau_star = 1e6, v0 = 1e-9, lambda = 0.0786;
  const double m = 3.286e-5, k = 234.5, c = 1.28;
  const double V = 1.791e-14, N = 2.985e-13;
  Model model = slider_under("film", {A, d, S, tau_star, v0, 5e7}, {m, k, c}, V, N);
  model.lambda = lambda;
  motion::RunOptions options;
  options.times = {1e-7, 1e-5, 0.0002364, 0.0004727, 0.004727};
  options.start.kind = motion::Start::Kind::rest;
  options.tolerance = 1e-6;
  const auto found = motion::run(model, options);
  REQUIRE(found.outcome.complete());
  // x' = V - u, m u' = k x + c (V - u) - F, F' = (S A/(lambda d)) (u - v0 F/(A tau*)), in units that balance.
  const double K = S * A / (lambda * d), w = std::sqrt(K / m);
  Eigen::Matrix3d J;
  J << 0, -1, 0, k / (m * w * w), -c / (m * w), -1, 0, 1, -K * v0 / (A * tau_star) / w;
  const Eigen::Vector3d constant(1, c / (m * w), 0), steady = -J.partialPivLu().solve(constant);
  const auto [rates, modes] = eigenpairs(J, true);
  const Eigen::VectorXcd start = modes.partialPivLu().solve((-steady).cast<std::complex<double>>());
  for (std::size_t i = 0; i < options.times.size(); ++i) {
    const Eigen::VectorXcd grown = (rates * (w * options.times[i])).array().exp() * start.array();
    const Eigen::Vector3d y = steady + (modes * grown).real();
    CHECK(std::abs(found.columns[2][i] - V * y[1]) <= found.column_error[2]);
    CHECK(std::abs(found.columns[3][i] - m * w * V * y[2]) <= found.column_error[3]);
  }
  CHECK(found.column_error[2] < 1e-6 * V);
}

TEST_CASE("a run that cannot follow the ringing on a film says its frequency", "[run]") {
  auto model =
      slider_under("film", {1e-8, 1e-9, 1e9, 1e6, 1e-9, 5e7}, {0.0002211, 3614.0, 0.0006486}, 2.189e-12, 242.1);
  model.lambda = 272.3;
  motion::RunOptions options;
  options.duration = 0.4662;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = 6.176e-16;
  options.most_steps = 1000;
  const auto followed = motion::run(model, options);
  CHECK(followed.outcome.ending == Ending::budget_spent);
  // Faster than it flows the film is a spring A S/(λ d) in parallel with that of the slider: ω² = (k + A S/(λ
  // d))/m, 4.08e5/s.
  const double omega = std::sqrt((model.slider.stiffness + 1e-8 * 1e9 / (model.lambda * 1e-9)) / model.slider.mass);
  CHECK_THAT(followed.outcome.detail, Catch::Contains(fmt::format("rings with {:.3g} rad/s", omega)));
}

TEST_CASE("a film rings with the slip rate however far apart their sizes are", "[run]") {
  // Slip in a film that carries 1e-16 of its flow stress: x' = V - u, m u' = k x + F - A tau, tau' = S (u - v(tau))/d.
  // Closed form: the flow is v0 e^{-p/p0} tau/tau_*, linear, so that the motion is that of constant coefficients.
  const double A = 3.079e-8, d = 3.425e-9, S = 4.786e8;
  const double tau_star = 3.238e5, v0 = 1.552e-10, p0 = 4.397e8;
  const double k = 1.664e4, m = 0.7495, V = 5.888e-15, N = 15.43;
  const double u0 = 1.132e-17;
  auto model = slider_under("film", {A, d, S, tau_star, v0, p0}, {m, k, 0}, V, N);
  model.drive.force = Signal(-0.05809);
  motion::RunOptions options;
  options.duration = 0.01777;
  options.samples = 8;
  options.start.kind = motion::Start::Kind::given;
  options.start.slip_rate = u0;
  // Deviations q from the start, at which forces balance: q' = M q + (V - u0, 0, 0).
  Eigen::Matrix3d M;
  const double flow = v0 * std::exp(-N / (A * p0)) / tau_star;
  M << 0, -1, 0, k / m, 0, -A / m, 0, S / d, -S / d * flow;
  // Sizes of x, u and tau that make it even.
  const Eigen::Vector3d size(1 / std::sqrt(k), 1 / std::sqrt(m), std::sqrt(S / (d * A)));
  const Eigen::Matrix3d even = size.cwiseInverse().asDiagonal() * M * size.asDiagonal();
  const Eigen::Vector3d pushed = Eigen::Vector3d(V - u0, 0, 0).cwiseQuotient(size);
  const Eigen::EigenSolver<Eigen::Matrix3d> modes(even);
  const Eigen::Vector3cd share = modes.eigenvectors().partialPivLu().solve(pushed.cast<std::complex<double>>());
  for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    REQUIRE(motion.outcome.complete());
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
      Eigen::Vector3cd grown;
      for (int j = 0; j < 3; ++j)
        grown[j] = share[j] * (std::exp(modes.eigenvalues()[j] * motion.time[i]) - 1.0) / modes.eigenvalues()[j];
      const double u = u0 + (modes.eigenvectors() * grown)[1].real() * size[1];
      CAPTURE(tolerance, motion.time[i], u);
      CHECK(std::abs(motion.columns[2][i] - u) <= motion.column_error[2]);
    }
  }
}

TEST_CASE("ringing that long steps damp is in the stated error of friction", "[run]") {
  // A slider let go with the drive loads its spring through a stiff contact at rest: m x'' + k x = k_t (V t - x). It
  // rings with 2.6e-9 V, which is less than the tolerance, but under forces as small as these 4.6e-4 N count.
  const double k = 11.3078, m = 0.18471, V = 6.78975, N = 11215.9;
  auto model =
      slider_under("flash-heating", {0.495277, 0.0383579, 0.0397207, 4.77723e-7, 4.37075e-11, 0.0691989, 0.00224926},
                   {m, k, 0}, V, N);
  model.lambda = 0.000660381;
  model.contact_stiffness.per_load = 406341.0;
  const double k_t = model.contact_stiffness.per_load * N, frequency = std::sqrt((k + k_t) / m);
  motion::RunOptions options;
  options.duration = 0.2;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::rest;
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6}) {
    options.tolerance = tolerance;
    const auto motion = motion::run(model, options);
    double largest = 0;
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
      const double t = motion.time[i];
      const double exact = k_t * k / (k + k_t) * V * (t - std::sin(frequency * t) / frequency);
      largest = std::max(largest, std::abs(motion.columns[3][i] - exact));
    }
    CAPTURE(tolerance);
    CHECK(largest <= motion.column_error[3]);
  }
}

TEST_CASE("ten million free oscillations are followed in closed form, without their works", "[run]") {
  const double m = 3.072, k = 1e15, c = 0.3535, V = 8.496e-5;
  const auto model = slider_under("coulomb", {1.084, 0.1056}, {m, k, c}, V, 4.771e-7);
  motion::RunOptions options;
  options.duration = 4.748;
  options.samples = 20;
  options.start.kind = motion::Start::Kind::rest;
  const auto result = motion::run(model, options);
  REQUIRE(result.outcome.complete());
  CHECK(result.metrics.count("friction_work") == 0);
  CHECK_THAT(result.remark, Catch::Contains("works"));
  // The speed V at which stick ends oscillates and decays: with γ = c/(2 m), (v + γ x)² + ω² x² falls as e^(-2γt).
  const double gamma = c / (2 * m), x = result.columns[0].back(), v = result.columns[1].back();
  const double left = std::hypot(v + gamma * x, std::sqrt(k / m) * x);
  CHECK(left == Approx(V * std::exp(-gamma * options.duration)).epsilon(1e-9));
}
