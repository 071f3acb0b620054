/// The explicit method: its order, its own clock, dense output, breaks, and when it calls a problem stiff.
#include "solvers/steps/explicit.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace rosin;
using solvers::steps::Explicit;

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
  void flow(const Pack&, const Pack* y, Pack* rate, Pack& pace) const override {
    rate[0] = y[1], rate[1] = -y[0];
    pace = own_pace ? 1.0 + 0.5 * (y[0] * y[0]) : Pack(1.0);
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
  void flow(const Pack& t, const Pack* y, Pack* rate, Pack& pace) const override {
    for (int i = 0; i < pack_width; ++i)
      rate[0].block[i] = -k * (y[0].block[i] - std::cos(t.block[i])) - std::sin(t.block[i]);
    pace = 1.0;
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
  void flow(const Pack&, const Pack* y, Pack* rate, Pack& pace) const override { pace = rate[0] = exp(y[0]); }
};

double swing_error(double tolerance, bool own_pace, long& steps) {
  Swing system;
  system.own_pace = own_pace;
  Explicit solver(system, tolerance);
  const double start[] = {1, 0};
  solver.start(0, start);
  constexpr double end = 200;
  while (solver.time() < end) REQUIRE(solver.step(end).complete());
  CHECK(solver.time() == end);
  steps = solver.count().steps;
  return std::hypot(solver.state()[0] - std::cos(end), solver.state()[1] + std::sin(end));
}
}  // namespace

TEST_CASE("the tableau integrates polynomials of degree 15, and its collocation those of degree 7", "[explicit]") {
  const auto& T = solvers::steps::GaussTableau::get();
  constexpr int s = solvers::steps::GaussTableau::stages;
  for (int degree = 0; degree < 2 * s; ++degree) {
    double sum = 0;
    for (int j = 0; j < s; ++j) sum += T.b.block[j] * std::pow(T.nodes.block[j], degree);
    INFO(degree);
    CHECK(sum == Approx(1.0 / (degree + 1)).epsilon(1e-13));
    if (degree >= s) continue;
    double end = 0, top = 0;
    const auto basis = T.basis(Pack(0.3));
    double inside = 0;
    for (int j = 0; j < s; ++j) {
      const double value = std::pow(T.nodes.block[j], degree);
      end += T.end.block[j] * value;
      top += T.top[0].block[j] * value;
      inside += basis[j].block[0] * value;
    }
    CHECK(end == Approx(1).epsilon(1e-12));
    CHECK(inside == Approx(std::pow(0.3, degree)).epsilon(1e-11));
    CHECK(top == Approx(degree < s - 1 ? 0 : 1.0 / 3432).margin(1e-14));  // P₇(2θ − 1) = 3432 θ⁷ + …
    for (int i = 0; i < s; ++i) {
      double integral = 0;
      for (int j = 0; j < s; ++j) integral += T.a[j].block[i] * std::pow(T.nodes.block[j], degree);
      CHECK(integral == Approx(std::pow(T.nodes.block[i], degree + 1) / (degree + 1)).margin(1e-14));
    }
  }
}

TEST_CASE("the error falls with a power of the step between those of the estimate and the method, in either clock",
          "[explicit]") {
  for (const bool own_pace : {false, true}) {
    long coarse_steps, fine_steps;
    const double coarse = swing_error(1e-5, own_pace, coarse_steps), fine = swing_error(1e-11, own_pace, fine_steps);
    const double order = std::log(coarse / fine) / std::log(double(fine_steps) / coarse_steps);
    INFO(own_pace << ": " << coarse << " in " << coarse_steps << " steps, " << fine << " in " << fine_steps);
    CHECK(order > 10);
    CHECK(order < 18);
    CHECK(fine < 1e-9);
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
  CHECK(solver.state()[0] == Approx(26 * std::log(2.0)).epsilon(1e-5));
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

TEST_CASE("stiffness is found where convergence holds the steps, and only there", "[explicit]") {
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

namespace {
/// ẏ = A/(1 + 25 x²), x = 2t − 1, times x where odd: seen from the middle of the first step from 0 to 1, Legendre
/// coefficients of every other degree vanish.
struct Bump final : System {
  static constexpr double height = 0.3;
  bool odd;
  explicit Bump(bool is_odd) : odd(is_odd) {}
  double slope(double t) const { return height * (odd ? 2 * t - 1 : 1) / (1 + 25 * (2 * t - 1) * (2 * t - 1)); }
  double integral(double t) const {
    const double x = 2 * t - 1;
    if (odd) return height / 100 * std::log((1 + 25 * x * x) / 26);
    return height / 10 * (std::atan(5 * x) + std::atan(5.0));
  }
  int size() const override { return 1; }
  void mass(double, double* m) const override { m[0] = 1; }
  void evaluate(double t, const double*, double* f) const override { f[0] = slope(t); }
  void linearise(double t, const double* y, double* f, double* J) const override { evaluate(t, y, f), J[0] = 0; }
  void scale(const double*, double* s) const override { s[0] = 1; }
  std::string unknown(int) const override { return "y"; }
  bool has_flow() const override { return true; }
  void flow(const Pack& t, const Pack*, Pack* rate, Pack& pace) const override {
    for (int i = 0; i < pack_width; ++i) rate[0].block[i] = slope(t.block[i]);
    pace = 1.0;
  }
};
}  // namespace

TEST_CASE("a step in which the highest coefficient, or the one below it, vanishes by symmetry is not trusted",
          "[explicit]") {
  for (const bool odd : {false, true}) {
    const Bump system(odd);
    constexpr double tolerance = 1e-8, whole = 10;
    Explicit solver(system, tolerance);
    const double start[] = {0};
    solver.start(0, start);
    REQUIRE(solver.step(whole).complete());
    INFO("odd " << odd << ": to " << solver.time() << " s, off by "
                << solver.state()[0] - system.integral(solver.time()));
    // A first step of a tenth of the whole is tried, in which the slope's poles at ±i/10 s bar any such tolerance.
    CHECK(solver.count().rejected > 0);
    CHECK(solver.time() < 0.5);
    CHECK(std::abs(solver.state()[0] - system.integral(solver.time())) < tolerance);
    while (solver.time() < whole) REQUIRE(solver.step(whole).complete());
    CHECK(std::abs(solver.state()[0] - system.integral(whole)) < 1e-7);
  }
}
