/// Pseudo-arclength continuation of the solutions of a problem, and the special points on the way.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/branches/problem.hpp"

namespace rosin::analysis::branches {

/// The parameter as branches measure it: 0 at `from` and 1 at `to`.
struct ParameterScale {
  double from = 0, to = 1;
  bool logarithmic = false;
  double coordinate(double p) const;
  double value(double coordinate) const;
  double slope(double coordinate) const;  ///< d value/d coordinate
};

struct ContinuationOptions {
  ParameterScale parameter;
  double tolerance = 1e-8;    ///< relative, of unknowns
  double first_step = 0.02;   ///< in lengths: 1 is the range of the parameter, or the size of all unknowns
  double longest_step = 0.1;  ///< the same
  int most_points = 1000;
  std::vector<double> at = {};  ///< values of the parameter at which points are wanted
};

struct BranchPoint {
  double p = 0, error = 0;  ///< of the parameter, between two tolerances
  Eigen::VectorXd x;
  double x_error = 0;  ///< largest correction between two tolerances, in sizes
  Problem::View view;
  bool asked = false;  ///< at a value that was wanted
};

struct SpecialPoint {
  std::string kind;  ///< "fold", "grazing", …, as it is told
  double p = 0, error = 0;
  Eigen::VectorXd x;
  Problem::View view;
  std::size_t after = 0;  ///< the point of the branch before it
  std::string test;       ///< the test that is 0 there: several may be told alike
};

struct Branch {
  std::vector<BranchPoint> points;
  std::vector<SpecialPoint> special;
  Outcome outcome;  ///< why it ends
};

/// A direction along a branch: of the unknowns in sizes, and of the parameter's coordinate.
struct Direction {
  Eigen::VectorXd x;
  double c = 0;
};

class Continuation {
 public:
  Continuation(Problem& problem, ContinuationOptions options) : problem_(problem), options_(std::move(options)) {}

  /// Called at each point; false: the branch ends there, "event".
  std::function<bool(const BranchPoint&)> arrived;
  /// Called where a border of the motion stops the branch, with the point before it: a solution beyond, and the sign of
  /// the parameter's coordinate along which the branch leaves from there. Nothing: the branch ends.
  struct Beyond {
    Eigen::VectorXd x;
    double p;
    int sign;
  };
  std::function<std::optional<Beyond>(const SpecialPoint&)> cross;

  /// Closes a solution near x at the parameter p.
  std::optional<BranchPoint> close(Eigen::VectorXd x, double p);
  /// Follows the branch from a solution, first along `direction`, until the parameter leaves its range, or the
  /// branch ends. Asked to stop (core/stop.hpp), it ends "interrupted" with the points until then.
  Branch follow(const BranchPoint& start, Direction direction);
  /// The branch on which p grows or falls (sign) from a solution.
  Branch follow(const BranchPoint& start, int sign);
  /// The solution at a length `step` along a direction that is not that of a branch through x, but of one that crosses
  /// there; the point to follow from.
  std::optional<BranchPoint> branch_off(const Eigen::VectorXd& x, double p, const Direction&, double step);
  long residuals() const { return residuals_; }

 private:
  struct Solution {
    Eigen::VectorXd x;
    double c = 0, x_error = 0, c_error = 0;
    int iterations = 0;
    Eigen::VectorXd looser_x = {};  ///< at the tolerance of the search, where its multipliers are taken
    double looser_c = 0;
  };
  /// The sign that a test has had, and a point since at which its error left the sign open.
  struct Sign {
    bool positive;
    std::optional<BranchPoint> open;  ///< the one nearest to 0
    double spread = 0;                ///< of the parameter over such points
  };
  using Signs = std::map<std::string, Sign>;
  void follow_into(Branch&, const BranchPoint& start, Direction along);
  /// Newton's method with normal·(x − x₀)/size + normal_c (c − c₀) = length.
  /// \param smooth  the Jacobian of the search serves for the finer tolerance as well: not near a border, where it
  ///        changes as the root of the distance
  std::optional<Solution> correct(const Solution& guess, const Direction& normal, const Solution& from, double length,
                                  bool smooth = true);
  /// The equations' slopes in sizes, with the normal as the last row.
  Eigen::MatrixXd bordered(const Problem::Residual&, const Solution&, const Direction& normal) const;
  /// \param A  the Jacobian, bordered: renewed where there is none, where corrections shrink slowly, or `always`
  bool iterate(Solution&, const Direction& normal, const Solution& from, double length, double tolerance, double& last,
               int most, Eigen::MatrixXd& A, bool always);
  std::optional<Direction> tangent(const Solution&, const Direction& along);
  Direction parameter_alone(Eigen::Index unknowns) const;
  Problem::View view_of(const Solution&);
  BranchPoint point_of(const Solution&);
  void find_special(Branch&, Signs&, const Solution& a, const BranchPoint& before, const BranchPoint& after,
                    const Direction&, double length);
  std::optional<SpecialPoint> locate(const std::string& kind, const Solution& a, const BranchPoint& before,
                                     const BranchPoint& after, const Direction&, double length);
  std::optional<SpecialPoint> approach_border(const Solution& from, const BranchPoint& before, const Direction&,
                                              double length);
  Problem& problem_;
  ContinuationOptions options_;
  long residuals_ = 0;
};

}  // namespace rosin::analysis::branches
