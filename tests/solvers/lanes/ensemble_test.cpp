/// The ensemble solver: order, accuracy, independence of lanes and of instruction sets.
#include "solvers/lanes/ensemble.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.hpp"
#include "core/instruction_set.hpp"

using namespace rosin;
using solvers::lanes::Ensemble;

namespace {
/// ẏ = −r (y − s), ṡ = p, ṗ = −w² s, and an algebraic 0 = y − z: a stiff relaxation driven by an oscillator.
class Driven final : public LaneSystem {
 public:
  explicit Driven(double rate) : rate_(rate) {}
  int size() const override { return 4; }
  void mass(Lanes* m) const override { m[0] = m[1] = m[2] = 1.0, m[3] = 0.0; }
  void evaluate(const Lanes* y, Lanes* f) const override {
    for (int p = 0; p < lane_packs; ++p) {
      f[0].pack[p] = y[1].pack[p];
      f[1].pack[p] = -y[0].pack[p];
      f[2].pack[p] = -rate_ * (y[2].pack[p] - y[0].pack[p]);
      f[3].pack[p] = y[2].pack[p] * y[2].pack[p] - y[3].pack[p];
    }
  }
  void linearise(const Lanes* y, Lanes* f, Lanes* J) const override {
    evaluate(y, f);
    for (int i = 0; i < 16; ++i) J[i] = 0.0;
    J[1] = 1.0, J[4] = -1.0, J[8] = rate_, J[10] = -rate_, J[15] = -1.0;
    for (int p = 0; p < lane_packs; ++p) J[14].pack[p] = 2.0 * y[2].pack[p];
  }
  void scale(const Lanes*, const Lanes*, Lanes* s) const override {
    for (int i = 0; i < 4; ++i) s[i] = 1.0;
  }
  /// The exact solution that starts at s = 1, p = 0 on the slow manifold.
  std::array<double, 4> exact(double t) const {
    const double d = 1 + rate_ * rate_, y = rate_ * (rate_ * std::cos(t) + std::sin(t)) / d;
    return {std::cos(t), -std::sin(t), y, y * y};
  }

 private:
  double rate_;
};

/// Largest error of all unknowns over a time of 10, and the number of steps.
std::pair<double, int> error_at(const Driven& system, double tolerance) {
  Ensemble ensemble(system);
  ensemble.start(0, system.exact(0).data(), tolerance, 1e-3);
  double worst = 0;
  int steps = 0;
  while (ensemble.time(0) < 10) {
    ensemble.attempt();
    if (!ensemble.accepted(0)) continue;
    ++steps;
    const auto exact = system.exact(ensemble.time(0));
    for (int i = 0; i < 4; ++i) worst = std::max(worst, std::abs(ensemble.unknown(i)[0] - exact[i]));
  }
  return {worst, steps};
}
/// A chain of relaxations ẏ_i = r_i (y_{i-1} − y_i) behind y_{-1} = 0, from y_0 = 1 and rest: sizes beyond those that
/// are unrolled.
class Chain final : public LaneSystem {
 public:
  explicit Chain(int n) : n_(n) {}
  int size() const override { return n_; }
  void mass(Lanes* m) const override {
    for (int i = 0; i < n_; ++i) m[i] = 1.0;
  }
  void evaluate(const Lanes* y, Lanes* f) const override {
    for (int i = 0; i < n_; ++i)
      for (int p = 0; p < lane_packs; ++p)
        f[i].pack[p] = rate(i) * ((i > 0 ? y[i - 1].pack[p] : Pack(0.0)) - y[i].pack[p]);
  }
  void linearise(const Lanes* y, Lanes* f, Lanes* J) const override {
    evaluate(y, f);
    for (int i = 0; i < n_ * n_; ++i) J[i] = 0.0;
    for (int i = 0; i < n_; ++i) {
      J[i * n_ + i] = -rate(i);
      if (i > 0) J[i * n_ + i - 1] = rate(i);
    }
  }
  void scale(const Lanes*, const Lanes*, Lanes* s) const override {
    for (int i = 0; i < n_; ++i) s[i] = 1.0;
  }
  /// y_i(t) = Π_{k=1..i} r_k Σ_j e^(−r_j t)/Π_{k≠j} (r_k − r_j), H. Bateman, Proc. Camb. Phil. Soc. 15, 423 (1910).
  long double exact(int i, long double t) const {
    long double sum = 0, product = 1;
    for (int k = 1; k <= i; ++k) product *= rate(k);
    for (int j = 0; j <= i; ++j) {
      long double term = std::exp(-rate(j) * t);
      for (int k = 0; k <= i; ++k)
        if (k != j) term /= rate(k) - rate(j);
      sum += term;
    }
    return product * sum;
  }

 private:
  static double rate(int i) { return std::ldexp(1.0, i % 2 == 0 ? i / 2 : -(i + 1) / 2); }
  int n_;
};
}  // namespace

TEST_CASE("systems of any size up to the capacity are solved", "[ensemble]") {
  const int n = GENERATE(1, 8, 9, 13, 18);
  const Chain chain(n);
  Ensemble ensemble(chain);
  std::array<double, Ensemble::capacity> y{1};
  ensemble.start(5, y.data(), 1e-8, 1e-4);
  while (ensemble.time(5) < 3) ensemble.attempt();
  for (int i = 0; i < n; ++i) {
    INFO("unknown " << i << " of " << n);
    CHECK(std::abs(ensemble.unknown(i)[5] - double(chain.exact(i, ensemble.time(5)))) < 1e-7);
  }
  CHECK_THROWS_AS(Ensemble(Chain(19)), InputError);
}

TEST_CASE("errors follow the tolerance, on easy, stiff and algebraic unknowns", "[ensemble]") {
  const double rate = GENERATE(1.0, 30.0, 1e3, 1e6);
  const Driven system(rate);
  INFO("rate " << rate);
  const auto [loose, few] = error_at(system, 1e-4);
  const auto [tight, many] = error_at(system, 1e-8);
  CHECK(loose < 3e-4);
  CHECK(tight < 3e-8);
  CHECK(many < 20 * few);  // fifth order: 6.3 times the steps for 10⁴ times the accuracy; fourth order would need 10
}

TEST_CASE("dense output and retaken steps meet the solution", "[ensemble]") {
  const Driven system(5);
  Ensemble ensemble(system);
  ensemble.start(3, system.exact(0).data(), 1e-7, 0.05);
  while (ensemble.time(3) < 2) ensemble.attempt();
  const double end = ensemble.time(3), h = ensemble.length()[3];
  for (const double theta : {0.2, 0.5, 0.9}) {
    const auto exact = system.exact(end - h + theta * h);
    for (int i = 0; i < 4; ++i) CHECK(std::abs(ensemble.interpolate(3, i, theta) - exact[i]) < 3e-6);
    CHECK(std::abs(ensemble.slope(3, 0, theta) / h - exact[1]) < 1e-4);
  }
  ensemble.retake(3, 0.5);
  CHECK(ensemble.time(3) == Approx(end - h));
  ensemble.attempt();
  REQUIRE(ensemble.accepted(3));
  CHECK(ensemble.time(3) == Approx(end - h / 2));
  CHECK(std::abs(ensemble.unknown(0)[3] - std::cos(ensemble.time(3))) < 1e-6);
}

TEST_CASE("a lane does not see its neighbours, nor the instruction set", "[ensemble]") {
  const Driven system(100);
  const InstructionSet best = instruction_set();
  const auto follow = [&](bool company, int packs = lane_packs) {
    Ensemble ensemble(system);
    ensemble.use_packs(packs);
    ensemble.start(5, system.exact(0).data(), 1e-6, 1e-3);
    if (company)
      for (int lane = 6; lane < lane_count; ++lane)
        ensemble.start(lane, system.exact(lane).data(), std::pow(10.0, -lane % 9), 1e-3 * lane);
    std::vector<double> seen;
    for (int k = 0; k < 60; ++k) {
      ensemble.attempt();
      seen.push_back(ensemble.time(5));
      for (int i = 0; i < 4; ++i) seen.push_back(ensemble.unknown(i)[5]);
    }
    return seen;
  };
  const auto alone = follow(false);
  CHECK(follow(true) == alone);
  CHECK(follow(true, 1) == alone);
  for (const auto set : {InstructionSet::baseline, InstructionSet::v3}) {
    use_instruction_set(set);
    CHECK(follow(true) == alone);  // the same bits
  }
  use_instruction_set(best);
  CHECK(instruction_set() == best);
}

TEST_CASE("a lane that is not finite shortens its step and leaves the others alone", "[ensemble]") {
  const Driven system(100);
  Ensemble ensemble(system);
  std::array<double, 4> broken = system.exact(0);
  broken[0] = std::nan("");
  ensemble.start(0, broken.data(), 1e-6, 1e-3);
  ensemble.start(1, system.exact(0).data(), 1e-6, 1e-3);
  for (int k = 0; k < 50; ++k) {
    ensemble.attempt();
    CHECK_FALSE(ensemble.accepted(0));
  }
  CHECK(ensemble.time(0) == 0);
  CHECK(ensemble.time(1) > 0.05);
}
