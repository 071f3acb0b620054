/// Which starts of a grid are followed so that all borders of basins that its coarser points show are found.
#pragma once
#include <functional>
#include <vector>

namespace rosin::analysis::basins {

/// A grid whose labels are filled in from coarse to fine: where the corners of a cell and all its neighbours have one
/// label, its inside takes that label; in the end every start beside one of another label has been followed itself.
class RefinedBorders {
 public:
  /// Follows the starts that are named, and fills their labels in.
  using Follow = std::function<void(const std::vector<std::size_t>& starts, std::vector<int>& labels)>;
  RefinedBorders(int columns, int rows);

  /// Labels of all starts, row by row. \throws what `follow` throws, with the labels that are known until then
  void find(const Follow&, std::vector<int>& labels);
  const std::vector<bool>& followed() const { return followed_; }
  /// Starts that took the label of their neighbours.
  std::vector<std::size_t> filled() const;
  /// Follows some of these, and then the borders of what they show. \returns how many had another label
  std::size_t check(const std::vector<std::size_t>& sample, const Follow&, std::vector<int>& labels);

 private:
  std::size_t at(int column, int row) const { return std::size_t(row) * std::size_t(columns_) + std::size_t(column); }
  void follow_missing(std::vector<std::size_t> starts, const Follow&, std::vector<int>& labels);
  /// Until every start beside one of another label has been followed.
  void close(const Follow&, std::vector<int>& labels);

  int columns_, rows_;
  std::vector<bool> followed_;
};

}  // namespace rosin::analysis::basins
