/// What is continued along a parameter: F(x, p) = 0 in as many unknowns as equations, and what is seen at a solution.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <map>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace rosin::analysis::branches {

class Problem {
 public:
  virtual ~Problem() = default;

  struct Residual {
    Outcome outcome;
    Eigen::VectorXd F;    ///< in sizes of the unknowns
    Eigen::MatrixXd F_x;  ///< if slopes were asked
    Eigen::VectorXd F_p;
  };
  /// \param tolerance  relative accuracy of F
  virtual Residual residual(const Eigen::VectorXd& x, double p, double tolerance, bool slopes) = 0;
  /// Sizes of the unknowns, in which corrections and lengths are measured.
  virtual const Eigen::VectorXd& scale() const = 0;

  /// A function whose simple zeros along the branch are special points.
  struct Test {
    std::string kind;  ///< "fold", "period-doubling", "torus", "grazing", …
    double value;
    double error = 0;
    /// A border of the kind of motion: the value falls to 0 and does not change its sign; beyond it the motion differs.
    bool border = false;
    /// Whether the error leaves no doubt about the sign.
    bool has_sign() const { return std::abs(value) > 3 * error; }
  };
  struct View {
    Outcome outcome;
    bool stable = false;
    std::vector<Test> tests;
    std::string pattern;  ///< of switches: solutions of different patterns are parted by a border
    std::vector<std::complex<double>> multipliers;  ///< largest modulus first, without the trivial one
    std::vector<double> multiplier_errors;          ///< absolute
    std::map<std::string, double> metrics;
    std::vector<double> start;  ///< unknowns of the oscillator at the start of a cycle
    int turns = 1;              ///< periods of the drive in a cycle
  };
  /// A solution at a tolerance.
  struct Solved {
    const Eigen::VectorXd& x;
    double p, tolerance;
  };
  /// What is seen at a solution; its errors by the same solution at a looser tolerance.
  virtual View view(const Solved&, const Solved& looser) = 0;
  /// Takes a solution as the reference of what follows. \returns whether it is written in other unknowns from then on.
  virtual bool refer_to(Eigen::VectorXd& x, double p, double tolerance) = 0;
  /// How many of the first unknowns keep their meaning where others are written anew.
  virtual int in_common() const = 0;
};

}  // namespace rosin::analysis::branches
