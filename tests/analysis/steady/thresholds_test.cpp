/// Thresholds of flutter: closed forms of two modes, and 40-digit roots of three and five.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/steady/mode_windows.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::steady;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

/// One contact that gives way, sliding along the first coordinate and pressed along the second.
Scan along_friction(const MatrixXd& M, const MatrixXd& C, const MatrixXd& K, double stiffness, double to) {
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) values.push_back(0.01 + (to - 0.01) * i / 39);
  return scan(
      [&](double coefficient) {
        oscillators::Structure structure;
        structure.M = M, structure.C = C, structure.K = K;
        for (Eigen::Index i = 0; i < M.rows(); ++i) structure.names.push_back("displacement_" + std::to_string(i + 1));
        oscillators::FrictionContact contact;
        contact.law = laws::find_law("coulomb")->with({5.0, coefficient});
        contact.tangential = VectorXd::Unit(M.rows(), 0), contact.normal = VectorXd::Unit(M.rows(), 1);
        contact.normal_law = laws::normal_law(laws::LinearContact{stiffness, 0, 0, false});
        structure.contacts = {contact};
        return stability(structure);
      },
      values);
}

}  // namespace

TEST_CASE("modes merge at the closed form's friction, undamped, with equal and with unequal damping") {
  const MatrixXd I = MatrixXd::Identity(2, 2);
  const MatrixXd minimal{{2, 1}, {1, 2.0 / 3}}, stiff{{5.2e7, 1e7}, {1e7, 2e7}};
  struct Row {
    MatrixXd C, K;
    double stiffness, wanted, within;
  };
  const Row rows[] = {{0 * I, minimal, 4.0 / 3, 0.75, 1e-12},
                      {0.02 * I, minimal, 4.0 / 3, 0.7506, 1e-14},
                      {MatrixXd{{0.02, 0}, {0, 0.06}}, minimal, 4.0 / 3, 0.7518, 1e-14},
                      {0 * I, stiff, 3e7, 404.0 / 1200, 1e-12},
                      {MatrixXd{{20, 0}, {0, 30}}, stiff, 3e7, 0.336635733333, 1e-12}};
  for (const auto& row : rows) {
    INFO(row.wanted);
    const auto found = along_friction(I, row.C, row.K, row.stiffness, 1.5);
    REQUIRE(found.thresholds.size() == 1);
    const auto& threshold = found.thresholds[0];
    CHECK(threshold.onset);
    CHECK(std::abs(threshold.value - row.wanted) < threshold.error + row.within);
    CHECK(threshold.error < 1e-11);
  }
  CHECK(along_friction(I, 0 * I, minimal, 4.0 / 3, 1.5).thresholds[0].angular_frequency ==
        Approx(std::sqrt(2)).epsilon(5e-12));
}

TEST_CASE("flutter of three modes begins where 40 digits say, undamped and damped") {
  const MatrixXd M{{1.08, 0.1, 0.23}, {0.1, 1.3, 0.04}, {0.23, 0.04, 1}},
      K{{3.77, 0.27, -0.13}, {0.27, 3.72, -0.19}, {-0.13, -0.19, 3.87}},
      C{{0.056, -0.003, 0.006}, {-0.003, 0.017, 0.002}, {0.006, 0.002, 0.029}};
  const auto undamped = along_friction(M, 0 * C, K, 2.3, 1), damped = along_friction(M, C, K, 2.3, 1);
  REQUIRE_FALSE(undamped.thresholds.empty());
  CHECK(std::abs(undamped.thresholds[0].value - 0.150132746354472) < undamped.thresholds[0].error);
  CHECK(undamped.thresholds[0].angular_frequency == Approx(2.19321044721427).epsilon(1e-11));
  REQUIRE_FALSE(damped.thresholds.empty());
  CHECK(damped.thresholds[0].value == Approx(0.158338744340044).epsilon(1e-12));
}

TEST_CASE("no friction against the direction that couples: no threshold, and a window between values is found") {
  const MatrixXd I = MatrixXd::Identity(2, 2);
  CHECK(along_friction(I, 0 * I, MatrixXd{{2, -0.5}, {-0.5, 1.2}}, 1, 1.5).thresholds.empty());
  // A growth rate that is positive between 0.4999 and 0.5001 only.
  std::vector<double> values;
  for (int i = 0; i <= 10; ++i) values.push_back(0.03 + 0.1 * i);
  const auto window = scan(
      [](double p) {
        StructureStability s;
        const double rate = 1e-8 - (p - 0.5) * (p - 0.5);
        s.modes = {ComplexMode{{rate, 1}, 1e-15, {1}}};
        s.eigenvalues = {{rate, 1}};
        return s;
      },
      values);
  REQUIRE(window.thresholds.size() == 2);
  CHECK(window.thresholds[0].value == Approx(0.4999).epsilon(1e-9));
  CHECK(window.thresholds[1].value == Approx(0.5001).epsilon(1e-9));
  CHECK_FALSE(window.thresholds[1].onset);
}

TEST_CASE("a threshold that rounding hides lies in the range that was looked at, with an error as large") {
  // Growth of 1.6e-8 1/s rises by a thousandth over the range, and its error is half of it: calm by chance at 0.
  const auto hidden = locate(
      [](double value) {
        return Leading{value > 0.3 ? 1.6e-8 * (1 + 1e-3 * value) : 0, 9e-9, 137};
      },
      0, 1);
  CHECK(hidden.value >= 0);
  CHECK(hidden.value <= 1);
  CHECK(hidden.error > 0.5);
}
