/// The explicit method: its order, its own clock, dense output, breaks, and when it calls a problem stiff.
#include "solvers/explicit.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin;
using solvers::Explicit;

namespace {

/// ẋ = v, v̇ = −x, with a pace that is not constant: 1 + x²/2.
struct Swing final : System {
  bool own_pace = true;
  int size() const override { return 2; }
  void mass(double, double* m) const override { m[0] = m[1] = 1; }
  void evaluate(double, const double* y, double* f) const override { f[0] = y[1], f[1] = -y[0]; }
  void linearise(double t, const double* y, double* f, double* J) const override {
    evaluate(t, y, f);
    J[0] = 0, J[1] = 1, J[2] = -1, J[3] = 0;
  }
  void scale(const double*, double* s) const override { s[0] = s[1] = 1; }
  std::string unknown(int i) const override { return i == 0 ? "x" : "v"; }
  bool autonomous() const override { return true; }
  bool has_flow() const override { return true; }
  void flow(double t, const double* y, double* rate, double& pace) const override {
    evaluate(t, y, rate);
    pace = own_pace ? 1 + y[0] * y[0] / 2 : 1;
  }
};

/// ẏ = −k (y − cos t) − sin t; stiff for large k (Prothero & Robinson 1974).
struct Relaxation final : System {
  double k;
  explicit Relaxation(double rate) : k(rate) {}
  int size() const override { return 1; }
  void mass(double, double* m) const override { m[0] = 1; }
  void evaluate(double t, const double* y, double* f) const override { f[0] = -k * (y[0] - std::cos(t)) - std::sin(t); }
  void linearise(double t, const double* y, double* f, double* J) const override { evaluate(t, y, f), J[0] = -k; }
  void scale(const double*, double* s) const override { s[0] = 1; }
  std::string unknown(int) const override { return "y"; }
  bool has_flow() const override { return true; }
  void flow(double t, const double* y, double* rate, double& pace) const override {
    evaluate(t, y, rate);
    pace = 1;
  }
};

/// ẏ = e^y runs away, y = −ln(1 − t): its rate spans decades while y changes evenly in the pace e^y.
struct Runaway final : System {
  int size() const override { return 1; }
  void mass(double, double* m) const override { m[0] = 1; }
  void evaluate(double, const double* y, double* f) const override { f[0] = std::exp(y[0]); }
  void linearise(double t, const double* y, double* f, double* J) const override { evaluate(t, y, f), J[0] = f[0]; }
  void scale(const double*, double* s) const override { s[0] = 1; }
  std::string unknown(int) const override { return "ln y"; }
  bool autonomous() const override { return true; }
  bool has_flow() const override { return true; }
  void flow(double t, const double* y, double* rate, double& pace) const override {
    evaluate(t, y, rate);
    pace = rate[0];
  }
};

double swing_error(double tolerance, bool own_pace, long& steps) {
  Swing system;
  system.own_pace = own_pace;
  Explicit solver(system, tolerance);
  const double start[] = {1, 0};
  solver.start(0, start);
  while (solver.time() < 20) REQUIRE(solver.step(20).complete());
  CHECK(solver.time() == 20);
  steps = solver.count().steps;
  return std::hypot(solver.state()[0] - std::cos(20.0), solver.state()[1] + std::sin(20.0));
}
}  // namespace

TEST_CASE("the tableau meets the conditions of quadrature and of collocation of rows", "[explicit]") {
  using T = solvers::ExplicitTableau;
  for (int degree = 0; degree < T::order; ++degree) {
    double sum = 0;
    for (int j = 0; j < T::stages; ++j) sum += T::a[T::stages][j] * std::pow(T::c[j], degree);
    CHECK(sum == Approx(1.0 / (degree + 1)).epsilon(1e-13));
  }
  for (int i = 0; i < T::all; ++i) {
    double sum = 0;
    for (int j = 0; j < i; ++j) sum += T::a[i][j];
    CHECK(sum == Approx(T::c[i]).margin(1e-14));
  }
}

TEST_CASE("the error falls with the eighth power of the step, in either clock", "[explicit]") {
  for (const bool own_pace : {false, true}) {
    long coarse_steps, fine_steps;
    const double coarse = swing_error(1e-6, own_pace, coarse_steps), fine = swing_error(1e-11, own_pace, fine_steps);
    const double order = std::log(coarse / fine) / std::log(double(fine_steps) / coarse_steps);
    INFO(own_pace);
    CHECK(order > 7);
    CHECK(order < 10);
    CHECK(fine < 1e-10);
  }
}

TEST_CASE("a system's own pace makes steps through many decades of time few and alike", "[explicit]") {
  const Runaway system;
  Explicit solver(system, 1e-11);
  const double start[] = {0};
  solver.start(0, start);
  const double end = 1 - 0x1p-26;
  while (solver.time() < end) REQUIRE(solver.step(end).complete());
  // The motion itself magnifies early errors 2^26 times.
  CHECK(solver.state().size() == std::size_t(system.size()));  // without the padding of its vectors
  CHECK(solver.state()[0] == Approx(26 * std::log(2.0)).epsilon(1e-6));
  CHECK(solver.count().steps < 70);
}

TEST_CASE("dense output is as good as the steps, and time is exact at limits", "[explicit]") {
  const Swing system;
  Explicit solver(system, 1e-11);
  const double start[] = {1, 0};
  solver.start(0, start);
  double y[2], sample = 0.05, largest = 0;
  while (solver.time() < 7) {
    REQUIRE(solver.step(7).complete());
    for (; sample < solver.time(); sample += 0.1) {
      solver.interpolate(sample, y);
      largest = std::max(largest, std::hypot(y[0] - std::cos(sample), y[1] + std::sin(sample)));
    }
  }
  CHECK(largest < 1e-9);
  CHECK(largest > 0);
}

TEST_CASE("stiffness is found where stability holds the steps, and only there", "[explicit]") {
  for (const double rate : {1.0, 1e4}) {
    const Relaxation system(rate);
    Explicit solver(system, 1e-8);
    const double start[] = {1};
    solver.start(0, start);
    while (solver.time() < 10 && !solver.stiff()) REQUIRE(solver.step(10).complete());
    INFO(rate);
    CHECK(solver.stiff() == (rate > 1));
    CHECK(std::abs(solver.state()[0] - std::cos(solver.time())) < 1e-6);
  }
}
