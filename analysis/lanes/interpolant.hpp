/// A quantity on the nodes of a rectangle of pixels, interpolated in the form that suits it.
#pragma once
#include <limits>
#include <optional>
#include <vector>

namespace rosin::analysis::lanes {

/// What the nodes of each column and of each row count at a place.
struct NodeWeights {
  std::vector<double> x, y;
};

/// Weights of Lagrange's polynomial through the nodes of a line.
std::vector<double> lagrange_weights(const std::vector<int>& nodes, int place);

/// Numbers at the nodes, row by row, with absolute errors.
struct NodeValues {
  std::vector<double> value, error;
  double at(const NodeWeights&) const;
  /// What the errors of the nodes make at a place, if chance distributes them: what they have in common is not
  /// magnified. Twice its standard deviation.
  double error_at(const NodeWeights&) const;
};

/// A quantity and a form: as it is, as its logarithm, or as √(threshold − helper) times something smooth, which is
/// nothing beyond the threshold.
class Interpolant {
 public:
  static Interpolant plain(NodeValues);
  /// Values must be positive.
  static Interpolant logarithm(NodeValues);
  /// On columns x and rows y of pixels. `helper` is plain and must outlive this. Where the root begins amid the nodes,
  /// the smooth factor is continued beyond; nothing if too few nodes lie before it.
  static std::optional<Interpolant> root(const std::vector<int>& x, const std::vector<int>& y, NodeValues,
                                         const Interpolant& helper, double threshold);

  double at(const NodeWeights&) const;
  double error_at(const NodeWeights&) const;
  /// The error of the polynomial itself, as found, over the larger one of 1 and the value; of helpers.
  double shown = 0;
  /// Notes a place where it has been compared with what it stands for. That shows what the helper's polynomial is wrong
  /// by as well, where no more is left before the threshold.
  void compared_at(const NodeWeights&);
  const NodeValues& nodes() const { return nodes_; }

 private:
  enum class Form { plain, logarithm, root };
  Form form_ = Form::plain;
  NodeValues nodes_;
  const Interpolant* helper_ = nullptr;
  double threshold_ = 0;
  double compared_ = std::numeric_limits<double>::infinity();  ///< least that was left where it was compared
};

}  // namespace rosin::analysis::lanes
