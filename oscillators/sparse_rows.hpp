/// Rows of a matrix without their zeros, for products in time linear in what stands there.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace rosin::oscillators {

class SparseRows {
 public:
  SparseRows() = default;
  explicit SparseRows(const Eigen::MatrixXd& A) : begin_{0} {
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      for (Eigen::Index j = 0; j < A.cols(); ++j)
        if (A(i, j) != 0) entries_.push_back({int(j), A(i, j)});
      begin_.push_back(entries_.size());
    }
  }
  struct Entry {
    int column;
    double value;
  };
  /// Entries of a row, in the order of columns.
  struct Row {
    const Entry *first, *last;
    const Entry* begin() const { return first; }
    const Entry* end() const { return last; }
    /// Σ A_ij x_j.
    template <class Vector>
    double times(const Vector& x) const {
      double sum = 0;
      for (const auto& [j, value] : *this) sum += value * x[j];
      return sum;
    }
    Eigen::VectorXd dense(Eigen::Index size) const {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
      for (const auto& [j, value] : *this) row[j] = value;
      return row;
    }
  };
  Row operator[](int i) const { return {entries_.data() + begin_[i], entries_.data() + begin_[i + 1]}; }
  int rows() const { return int(begin_.size()) - 1; }
  bool empty() const { return entries_.empty(); }
  template <class Vector>
  Eigen::VectorXd operator*(const Vector& x) const {
    Eigen::VectorXd product(rows());
    for (int i = 0; i < rows(); ++i) product[i] = (*this)[i].times(x);
    return product;
  }
  /// Σ|A_ij x_j|: the size of the terms that a product sums.
  template <class Vector>
  Eigen::VectorXd size_of_terms(const Vector& x) const {
    Eigen::VectorXd size(rows());
    for (int i = 0; i < rows(); ++i) {
      size[i] = 0;
      for (const auto& [j, value] : (*this)[i]) size[i] += std::abs(value) * std::abs(x[j]);
    }
    return size;
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;
};

}  // namespace rosin::oscillators
