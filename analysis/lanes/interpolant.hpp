/// A quantity on the nodes of a rectangle of pixels, interpolated in the form that suits it.
#pragma once
#include <limits>
#include <optional>
#include <vector>

namespace rosin::analysis::lanes {

/// Weights of the nodes of each column and of each row at a place.
struct NodeWeights {
  std::vector<double> x, y;
};

/// Weights of Lagrange's polynomial through the nodes of a line.
std::vector<double> lagrange_weights(const std::vector<int>& nodes, int place);

/// Numbers at the nodes, row by row, with absolute errors.
struct NodeValues {
  std::vector<double> value, error;
  double at(const NodeWeights&) const;
  /// Error at a place from random errors of the nodes: twice the standard deviation. A common error is not magnified.
  double error_at(const NodeWeights&) const;
};

/// A quantity in one of three forms: itself, its logarithm, or √(threshold − helper) times a smooth factor, which is
/// zero beyond the threshold.
class Interpolant {
 public:
  static Interpolant plain(NodeValues);
  /// Values must be positive.
  static Interpolant logarithm(NodeValues);
  /// The root form on columns x and rows y of pixels. `helper` is plain and must outlive the result. Where the
  /// threshold lies between the nodes, the smooth factor is extrapolated beyond it; nothing if too few nodes lie before
  /// it.
  static std::optional<Interpolant> root(const std::vector<int>& x, const std::vector<int>& y, NodeValues,
                                         const Interpolant& helper, double threshold);

  double at(const NodeWeights&) const;
  double error_at(const NodeWeights&) const;
  /// For helpers: measured error of the polynomial, over the larger one of 1 and the value.
  double shown = 0;
  /// Notes a place where the interpolant has been compared with the quantity. The comparison covers the error of the
  /// helper's polynomial too, wherever threshold − helper is no smaller.
  void compared_at(const NodeWeights&);
  const NodeValues& nodes() const { return nodes_; }

 private:
  enum class Form { plain, logarithm, root };
  Form form_ = Form::plain;
  NodeValues nodes_;
  const Interpolant* helper_ = nullptr;
  double threshold_ = 0;
  double compared_ = std::numeric_limits<double>::infinity();  ///< smallest threshold − helper at a compared place
};

}  // namespace rosin::analysis::lanes
