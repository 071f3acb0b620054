/// From cells of the coarsest grid to single starts.
#include "analysis/basins/refined_borders.hpp"

#include <algorithm>

namespace rosin::analysis::basins {

namespace {

constexpr int unknown = -1;
constexpr int coarsest = 16;    ///< most starts along a side of a cell
constexpr int cells_along = 8;  ///< least number of cells along the shorter side of the grid

/// Lines of the grid: every so many, and the last.
std::vector<int> lines(int count, int stride) {
  std::vector<int> at;
  for (int i = 0; i < count - 1; i += stride) at.push_back(i);
  at.push_back(count - 1);
  return at;
}

}  // namespace

RefinedBorders::RefinedBorders(int columns, int rows)
    : columns_(columns), rows_(rows), followed_(std::size_t(columns) * std::size_t(rows), false) {}

void RefinedBorders::follow_missing(std::vector<std::size_t> starts, const Follow& follow, std::vector<int>& labels) {
  std::erase_if(starts, [&](std::size_t i) { return followed_[i]; });
  std::ranges::sort(starts);
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
  if (starts.empty()) return;
  for (const std::size_t i : starts) labels[i] = unknown;
  follow(starts, labels);
  for (const std::size_t i : starts) followed_[i] = true;
}

void RefinedBorders::find(const Follow& follow, std::vector<int>& labels) {
  labels.assign(followed_.size(), unknown);
  int stride = 1;
  while (2 * stride <= coarsest && 2 * stride * cells_along < std::min(columns_, rows_)) stride *= 2;
  for (; stride >= 1; stride /= 2) {
    // Corners of the cells of this stride that nothing is known of: those of cells of one label were filled before.
    std::vector<std::size_t> missing;
    const auto x = lines(columns_, stride), y = lines(rows_, stride);
    for (const int row : y)
      for (const int column : x)
        if (labels[at(column, row)] == unknown) missing.push_back(at(column, row));
    follow_missing(std::move(missing), follow, labels);
    if (stride == 1) break;
    const auto of_one_label = [&](std::size_t i, std::size_t j) {
      const int label = labels[at(x[i], y[j])];
      for (std::size_t a = i > 0 ? i - 1 : 0; a <= std::min(i + 2, x.size() - 1); ++a)
        for (std::size_t b = j > 0 ? j - 1 : 0; b <= std::min(j + 2, y.size() - 1); ++b)
          if (labels[at(x[a], y[b])] != label) return false;
      return true;
    };
    std::vector<std::pair<std::size_t, std::size_t>> uniform;
    for (std::size_t j = 0; j + 1 < y.size(); ++j)
      for (std::size_t i = 0; i + 1 < x.size(); ++i)
        if (of_one_label(i, j)) uniform.emplace_back(i, j);
    for (const auto& [i, j] : uniform)
      for (int row = y[j]; row <= y[j + 1]; ++row)
        for (int column = x[i]; column <= x[i + 1]; ++column)
          if (labels[at(column, row)] == unknown) labels[at(column, row)] = labels[at(x[i], y[j])];
  }
  close(follow, labels);
}

void RefinedBorders::close(const Follow& follow, std::vector<int>& labels) {
  while (true) {
    std::vector<std::size_t> doubtful;
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) {
        if (followed_[at(column, row)]) continue;
        bool beside = false;
        for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r)
          for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns_ - 1); ++c)
            beside |= labels[at(c, r)] != labels[at(column, row)];
        if (beside) doubtful.push_back(at(column, row));
      }
    if (doubtful.empty()) return;
    follow_missing(std::move(doubtful), follow, labels);
  }
}

std::vector<std::size_t> RefinedBorders::filled() const {
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < followed_.size(); ++i)
    if (!followed_[i]) starts.push_back(i);
  return starts;
}

std::size_t RefinedBorders::check(const std::vector<std::size_t>& sample, const Follow& follow,
                                  std::vector<int>& labels) {
  std::vector<int> before;
  for (const std::size_t i : sample) before.push_back(labels[i]);
  follow_missing(sample, follow, labels);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < sample.size(); ++k) wrong += labels[sample[k]] != before[k];
  close(follow, labels);
  return wrong;
}

}  // namespace rosin::analysis::basins
