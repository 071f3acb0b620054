/// The collocation method: orders, stiff and algebraic rows, events, variational equations.
#include "solvers/steps/collocation.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <tuple>

using namespace rosin;
using solvers::steps::Collocation;

namespace {

/// ẏ₀ = −k (y₀ − cos t) − sin t (Prothero & Robinson 1974), 0 = y₁ − y₀²: solution cos t and its square.
struct ProtheroRobinson final : System {
  double k;
  explicit ProtheroRobinson(double rate) : k(rate) {}
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = 1, m[1] = 0; }
  void evaluate(double t, const double* y, double* f) const override {
    f[0] = -k * (y[0] - std::cos(t)) - std::sin(t);
    f[1] = y[1] - y[0] * y[0];
  }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = -k, J[1] = 0, J[2] = -2 * y[0], J[3] = 1;
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "y" : "square"; }
};

/// The pendulum ẋ = v, v̇ = −sin x.
struct Pendulum final : System {
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = m[1] = 1; }
  void evaluate(double, const double* y, double* f) const override { f[0] = y[1], f[1] = -std::sin(y[0]); }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = 0, J[1] = 1, J[2] = -std::cos(y[0]), J[3] = 0;
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "angle" : "speed"; }
};

/// ẏ = y², which reaches infinity at t = 1 from y = 1.
struct BlowUp final : System {
  int size() const override { return 1; }
  void mass(double, double* m) const override { m[0] = 1; }
  void evaluate(double, const double* y, double* f) const override { f[0] = y[0] * y[0]; }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = 2 * y[0];
  }
  void scale(const double* y, double* s) const override { s[0] = 1 + std::abs(y[0]); }
  std::string unknown(int) const override { return "y"; }
};

/// ẏ = min(1, 2 − y), a slip that is counted up to twice a distance only: y = t up to 1, then 2 − exp(1 − t).
struct Counted final : System {
  int size() const override { return 1; }
  void mass(double, double* m) const override { m[0] = 1; }
  void evaluate(double, const double* y, double* f) const override { f[0] = std::min(1.0, 2 - y[0]); }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = y[0] > 1 ? -1 : 0;
  }
  void scale(const double*, double* s) const override { s[0] = 1; }
  std::string unknown(int) const override { return "y"; }
  bool autonomous() const override { return true; }
  void kinks(double, const double* y, std::vector<double>& values) const override { values.assign(1, 1 - y[0]); }
};

/// ẏ₀ = r y₀ (1 − y₀), which leaves 0 for 1, and 0 = y₁ − y₀².
struct Growth final : System {
  static constexpr double rate = 1e6;
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = 1, m[1] = 0; }
  void evaluate(double, const double* y, double* f) const override {
    f[0] = rate * y[0] * (1 - y[0]);
    f[1] = y[1] - y[0] * y[0];
  }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = rate * (1 - 2 * y[0]), J[1] = 0, J[2] = -2 * y[0], J[3] = 1;
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "y" : "square"; }
};

/// Two of them without the square, with rates that differ by less than a step may by more than the one before.
struct TwinGrowth final : System {
  double rate[2] = {1e6, 2.7e6};
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = m[1] = 1; }
  void evaluate(double, const double* y, double* f) const override {
    for (int i = 0; i < 2; ++i) f[i] = rate[i] * y[i] * (1 - y[i]);
  }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = rate[0] * (1 - 2 * y[0]), J[1] = J[2] = 0, J[3] = rate[1] * (1 - 2 * y[1]);
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "slow" : "fast"; }
};

/// ẏ = λ y with the complex λ = r + 3 i r: a spiral that grows.
struct Spiral final : System {
  static constexpr double rate = 1e6, frequency = 3e6;
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = m[1] = 1; }
  void evaluate(double, const double* y, double* f) const override {
    f[0] = rate * y[0] - frequency * y[1];
    f[1] = frequency * y[0] + rate * y[1];
  }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = J[3] = rate, J[1] = -frequency, J[2] = frequency;
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "cosine" : "sine"; }
};

/// ẏ₀ = −2 y₀ − 1, which falls through 0 at t = ln(3)/2 from y₀ = 1, and 0 = y₀ − k y₁ with k = 1 above 0 and 4 below.
struct Corner final : System {
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = 1, m[1] = 0; }
  void evaluate(double, const double* y, double* f) const override {
    f[0] = -2 * y[0] - 1;
    f[1] = y[0] - (y[1] > 0 ? 1 : 4) * y[1];
  }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = -2, J[1] = 0, J[2] = 1, J[3] = y[1] > 0 ? -1 : -4;
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "y" : "bent"; }
};

std::vector<double> advance(Collocation& solver, double end) {
  while (solver.time() < end) REQUIRE(solver.step(end).complete());
  return solver.state();
}
}  // namespace

TEST_CASE("the tableau integrates and interpolates polynomials exactly", "[collocation]") {
  const auto& t = solvers::steps::RadauTableau::get();
  for (int degree = 0; degree <= 8; ++degree) {
    double sum = 0;
    for (int i = 0; i < 5; ++i) sum += t.b[i] * std::pow(t.c[i], degree);
    CHECK(sum == Approx(1.0 / (degree + 1)).epsilon(1e-14));
  }
  CHECK(t.c[4] == 1);
  CHECK(t.c[0] == Approx(0.05710419611452).epsilon(1e-12));  // Hairer & Wanner (1999)
  CHECK(t.gamma == Approx(6.286704751729276).epsilon(1e-12));
}

TEST_CASE("stiff and algebraic rows keep their accuracy", "[collocation]") {
  for (const double rate : {1.0, 1e3, 1e8}) {
    const ProtheroRobinson system(rate);
    Collocation solver(system, 1e-10);
    const double start[] = {1, 0.3};  // the algebraic unknown is made consistent
    REQUIRE(solver.start(0, start));
    const auto y = advance(solver, 10);
    INFO(rate);
    // Moderately stiff forcing reduces the order to that of the stages; the estimate, tolerance^(2/3), still bounds it.
    const double allowed = rate == 1 ? 1e-9 : 1e-6;
    CHECK(std::abs(y[0] - std::cos(10)) < allowed);
    CHECK(std::abs(y[1] - std::cos(10) * std::cos(10)) < allowed);
    CHECK(solver.count().steps < 60);
  }
}

TEST_CASE("a corner of an algebraic row is crossed, whichever side the last step has ended on", "[collocation]") {
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
    INFO("tolerance " << tolerance);
    const Corner system;
    Collocation solver(system, tolerance);
    REQUIRE(solver.start(0, std::vector{1.0, 1.0}));
    const auto y = advance(solver, 2);
    const double exact = 1.5 * std::exp(-4.0) - 0.5;
    CHECK(std::abs(y[0] - exact) < 10 * tolerance);
    CHECK(std::abs(y[1] - exact / 4) < 10 * tolerance);
    CHECK(solver.count().steps < 200);
  }
}

TEST_CASE("smaller tolerances give proportionally smaller errors", "[collocation]") {
  // Period of the pendulum from amplitude 2: 4 K(sin 1) = 8.34975… (elliptic integral by AGM).
  double a = 1, g = std::cos(1.0);
  for (int i = 0; i < 8; ++i) std::tie(a, g) = std::pair{(a + g) / 2, std::sqrt(a * g)};
  const double period = 2 * M_PI / a;
  const Pendulum system;
  double last = 1;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
    Collocation solver(system, tolerance);
    const double start[] = {2, 0};
    solver.start(0, start);
    const auto y = advance(solver, 5 * period);
    const double error = std::hypot(y[0] - 2, y[1]);
    INFO(tolerance);
    CHECK(error < 100 * tolerance);
    CHECK(error < last);
    last = error;
  }
}

TEST_CASE("events inside a step are located at the order of the method", "[collocation]") {
  const Pendulum system;
  Collocation solver(system, 1e-12);
  double a = 1, g = std::cos(1.0);
  for (int i = 0; i < 8; ++i) std::tie(a, g) = std::pair{(a + g) / 2, std::sqrt(a * g)};
  const double quarter = M_PI / 2 / a;
  const double start[] = {2, 0};
  solver.start(0, start);
  for (double before = 2; solver.step(100).complete(); before = solver.state()[0]) {
    if (solver.state()[0] > 0) continue;
    const auto theta = solver.locate([](double, const double* y) { return y[0]; }, 0, 1, before, solver.state()[0]);
    REQUIRE(theta);
    REQUIRE(solver.shorten(*theta));
    CHECK(solver.time() == Approx(quarter).epsilon(1e-12));
    CHECK(std::abs(solver.state()[0]) < 1e-14);
    break;
  }
}

TEST_CASE("the derivative of the flow is that of neighbouring solutions", "[collocation]") {
  const Pendulum system;
  const auto end = [&](double x, double v) {
    Collocation solver(system, 1e-13);
    const double start[] = {x, v};
    solver.start(0, start);
    return advance(solver, 7);
  };
  Collocation solver(system, 1e-12);
  const double start[] = {1.5, 0.4};
  solver.start(0, start);
  std::vector<double> S = {1, 0, 0, 1};
  while (solver.time() < 7) {
    REQUIRE(solver.step(7).complete());
    solver.propagate(S, 2);
  }
  const double h = 1e-5;
  const auto left = end(1.5 - h, 0.4), right = end(1.5 + h, 0.4), down = end(1.5, 0.4 - h), up = end(1.5, 0.4 + h);
  for (int i = 0; i < 2; ++i) {
    CHECK(S[i * 2] == Approx((right[i] - left[i]) / (2 * h)).epsilon(1e-7));
    CHECK(S[i * 2 + 1] == Approx((up[i] - down[i]) / (2 * h)).epsilon(1e-7));
  }
  CHECK(S[0] * S[3] - S[1] * S[2] == Approx(1).epsilon(1e-11));  // Hamiltonian: area is kept
}

TEST_CASE("a solution that ceases to exist ends in a typed outcome", "[collocation]") {
  const BlowUp system;
  Collocation solver(system, 1e-8);
  const double start[] = {1};
  solver.start(0, start);
  Outcome outcome;
  for (int i = 0; i < 100000 && outcome.complete() && solver.time() < 2; ++i) outcome = solver.step(2);
  CHECK_FALSE(outcome.complete());
  CHECK(solver.time() == Approx(1).epsilon(1e-6));
  CHECK_THAT(outcome.detail, Catch::Contains("'y'"));
}

TEST_CASE("ringing far below the scale is followed as closely as asked, not damped away", "[collocation]") {
  // The pendulum at 5e-7 rad swings as cos t; the square root of this is what the embedded estimate alone lets go at.
  const Pendulum system;
  const double amplitude = 5e-7, end = 40;
  for (const double tolerance : {1e-9, 1e-11}) {
    Collocation solver(system, tolerance);
    solver.start(0, std::vector{amplitude, 0.0});
    const auto y = advance(solver, end);
    CHECK(std::abs(y[0] - amplitude * std::cos(end)) < 30 * tolerance);
    CHECK(std::abs(y[1] + amplitude * std::sin(end)) < 30 * tolerance);
  }
  // Below the tolerance it is nothing that was asked for.
  Collocation solver(system, 1e-6);
  solver.start(0, std::vector{amplitude, 0.0});
  advance(solver, 1e4);
  CHECK(solver.count().steps < 1'000);
}

TEST_CASE("weak ringing is followed while its frequency drifts tenfold from where its mode was found",
          "[collocation]") {
  // A weak oscillator whose frequency drifts as 1 + t/2, beside a decay of 1e6/s: y'' = −w² y, as WKB has it,
  // amplitude w^(−1/2) and phase ∫ w dt.
  struct Drifting final : System {
    int size() const override { return 3; }
    void mass(double, double* m) const override { std::fill_n(m, 3, 1.0); }
    void evaluate(double t, const double* y, double* f) const override {
      const double w = 20 * (1 + t / 2);
      f[0] = w * y[1];
      f[1] = -w * y[0] - y[1] * 10 / w;  // y₁ = y'/w
      f[2] = 1e6 * (std::cos(t) - y[2]);
    }
    void linearise(double t, const double* y, double* f, double* J) const override {
      const double w = 20 * (1 + t / 2);
      evaluate(t, y, f);
      const double entries[] = {0, w, 0, -w, -10 / w, 0, 0, 0, -1e6};
      std::copy_n(entries, 9, J);
    }
    void scale(const double*, double* s) const override { std::fill_n(s, 3, 1.0); }
    std::string unknown(int i) const override { return std::string(1, char('a' + i)); }
  };
  const Drifting system;
  const double amplitude = 1e-6, end = 20;
  Collocation solver(system, 1e-10);
  solver.start(0, std::vector{amplitude, -amplitude / 80, 1.0});
  const auto y = advance(solver, end);
  const double w = 1 + end / 2, phase = 20 * (end + end * end / 4);
  CHECK(std::abs(y[0] - amplitude * std::cos(phase) / std::sqrt(w)) < 2e-8);  // of 3e-7, in 380 turns
  CHECK(solver.count().steps > 0.2 * phase);                                  // followed, not damped away
}

TEST_CASE("the error of an oscillation over the embedded estimate falls with the fourth power of the step",
          "[collocation]") {
  const auto& tableau = solvers::steps::RadauTableau::get();
  // Followed: one step of R(z) and e^z by the stability function of Radau IIA, the (4, 5) Padé approximant of e^z.
  const auto pade = [](std::complex<double> z) {
    const double p[] = {1, 4.0 / 9, 1.0 / 12, 1.0 / 126, 1.0 / 3024};
    const double q[] = {1, -5.0 / 9, 5.0 / 36, -5.0 / 252, 5.0 / 3024, -1.0 / 15120};
    std::complex<double> top = 0, bottom = 0;
    for (int k = 4; k >= 0; --k) top = top * z + p[k];
    for (int k = 5; k >= 0; --k) bottom = bottom * z + q[k];
    return top / bottom;
  };
  const auto estimate = [&](std::complex<double> z) {  // (γ − z)⁻¹ (z + γ Σ e_i Z_i), Z from the five equations
    Eigen::MatrixXcd A(5, 5);
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) A(i, j) = tableau.a_inverse[i][j] - (i == j ? z : 0.0);
    const Eigen::VectorXcd Z = A.partialPivLu().solve(Eigen::VectorXcd::Constant(5, z));
    std::complex<double> sum = z;
    for (int i = 0; i < 5; ++i) sum += tableau.gamma * tableau.error_weights[i] * Z[i];
    return sum / (tableau.gamma - z);
  };
  for (const std::complex<double> z : {std::complex<double>(0, 1.5), {-1, 3}, {-0.1, 8}, {0, 40}, {2, 30}})
    CHECK(tableau.error_over_estimate(z) ==
          Approx(std::abs(pade(z) - std::exp(z)) / std::abs(estimate(z))).epsilon(1e-6));
  CHECK(tableau.error_over_estimate({0, 1e12}) == Approx(1).epsilon(1e-6));
  const double ratio = tableau.error_over_estimate({0, 0.1}) / tableau.error_over_estimate({0, 0.05});
  CHECK(ratio == Approx(16).epsilon(1e-9));
  CHECK(tableau.error_over_estimate({0, 0.999999}) == Approx(tableau.error_over_estimate({0, 1.000001})).epsilon(1e-3));
  // Oscillations smaller than the size that is told from a ratio stay below it, in all directions that ring.
  for (const double least : {1e-6, 1e-4, 1e-3, 5e-3, 1e-1})
    for (double angle = 45; angle <= 135; angle += 5)
      for (double part = 1; part > 1e-3; part *= 0.7) {
        const auto z = std::polar(0.9999 * part * tableau.size_below(least), angle * std::numbers::pi / 180);
        CHECK(tableau.error_over_estimate(z) < least);
      }
}

TEST_CASE("growth is followed, not damped, however small it begins and long the steps could be", "[collocation]") {
  const Growth system;
  // s: first steps that it bounds are up to 2^40 times too long
  for (const double end : {1.0, 1e7, 2e7, 4e7, 8e7, 1.6e8, 3.2e8})
    for (const double first : {1e-6, 1e-12, 1e-18})
      for (const double tolerance : {1e-4, 1e-8}) {
        Collocation solver(system, tolerance);
        REQUIRE(solver.start(0, std::vector{first, first * first}));
        while (solver.time() < end && solver.state()[0] < 0.5) REQUIRE(solver.step(end).complete());
        const auto half = solver.locate([](double, const double* y) { return y[0] - 0.5; }, 0, 1,
                                        solver.state_before()[0] - 0.5, solver.state()[0] - 0.5);
        REQUIRE(half);
        // y/(1 − y) grows as e^(rt).
        CAPTURE(end, first, tolerance);
        CHECK(solver.time_at(*half) * Growth::rate == Approx(std::log(1 / first - 1)).epsilon(10 * tolerance));
      }
}

TEST_CASE("growth in pairs is followed too", "[solvers]") {
  const TwinGrowth system;
  for (const double first : {1e-6, 1e-12})
    for (const double tolerance : {1e-4, 1e-8}) {
      Collocation solver(system, tolerance);
      REQUIRE(solver.start(0, std::vector{first, first}));
      while (solver.time() < 1 && solver.state()[0] < 0.5) REQUIRE(solver.step(1).complete());
      const auto half = solver.locate([](double, const double* y) { return y[0] - 0.5; }, 0, 1,
                                      solver.state_before()[0] - 0.5, solver.state()[0] - 0.5);
      REQUIRE(half);
      CAPTURE(first, tolerance);
      CHECK(solver.time_at(*half) * system.rate[0] == Approx(std::log(1 / first - 1)).epsilon(10 * tolerance));
    }
}

TEST_CASE("an oscillation that grows is followed, however small it begins", "[solvers]") {
  const Spiral system;
  for (const double end : {1e-2, 1.0, 1e6})
    for (const double first : {1e-6, 1e-12, 1e-18})
      for (const double tolerance : {1e-4, 1e-8}) {
        Collocation solver(system, tolerance);
        REQUIRE(solver.start(0, std::vector{first, 0.0}));
        const auto amplitude = [&] { return std::hypot(solver.state()[0], solver.state()[1]); };
        while (solver.time() < end && amplitude() < 0.5) REQUIRE(solver.step(end).complete());
        CAPTURE(end, first, tolerance);
        const long steps = solver.count().steps;
        CHECK(amplitude() ==
              Approx(first * std::exp(Spiral::rate * solver.time())).epsilon(1.5 * double(steps) * tolerance));
        CHECK(steps < 120);
      }
}

TEST_CASE("a step ends at a kink, wherever that lies in it", "[solvers]") {
  const Counted system;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10})
    for (double start = 0; start < 1; start += 0.013) {
      Collocation solver(system, tolerance);
      REQUIRE(solver.start(0, std::vector{start}));
      const double end = 3 - start;
      bool ended_there = false;
      while (solver.time() < end) {
        REQUIRE(solver.step(end).complete());
        ended_there = ended_there || std::abs(solver.state()[0] - 1) < 1e-14;
      }
      INFO("tolerance " << tolerance << ", start " << start);
      CHECK(ended_there);
      CHECK(std::abs(solver.state()[0] - (2 - std::exp(-2.0))) <= 0.1 * tolerance + 1e-14);
    }
}
