/// Polynomials through evenly spaced nodes, and their values and errors in each form.
#include "analysis/lanes/interpolant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear_solve.hpp"

namespace rosin::analysis::lanes {

namespace {

/// Extrapolates numbers from the nodes where they are known to the others, by a least-squares polynomial with most
/// weight where little is `left` before the threshold. \returns whether they are known at enough nodes.
bool continue_smoothly(const std::vector<int>& x, const std::vector<int>& y, const std::vector<double>& left,
                       NodeValues& numbers) {
  const int nodes = int(left.size()), columns = int(x.size());
  const auto known = [&](int k) { return left[k] > 0; };
  // As many terms as the known nodes determine well: the products of powers of the lowest total degree.
  const auto most = std::ranges::count_if(left, [](double l) { return l > 0; }) * 3 / 5;
  std::vector<std::pair<int, int>> terms;
  for (int degree = 0; std::ssize(terms) < most; ++degree) {
    std::vector<std::pair<int, int>> more;
    for (int i = std::max(0, degree - int(y.size()) + 1); i <= std::min(degree, columns - 1); ++i)
      more.emplace_back(i, degree - i);
    if (std::ssize(terms) + std::ssize(more) > most) break;
    terms.insert(terms.end(), more.begin(), more.end());
  }
  if (terms.size() < 3) return false;
  const auto scaled = [](const std::vector<int>& line, int i) {
    return line.size() < 2 ? 0.0 : 2.0 * (line[i] - line.front()) / (line.back() - line.front()) - 1;
  };
  const auto basis = [&](int k) {
    const double u = scaled(x, k % columns), v = scaled(y, k / columns);
    Eigen::RowVectorXd row(terms.size());
    for (std::size_t t = 0; t < terms.size(); ++t)
      row[long(t)] = std::pow(u, terms[t].first) * std::pow(v, terms[t].second);
    return row;
  };
  double least_left = std::numeric_limits<double>::infinity(), error = 0;
  for (int k = 0; k < nodes; ++k)
    if (known(k)) {
      least_left = std::min(least_left, left[k]);
      error = std::max(error, numbers.error[k]);
    }
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(nodes, long(terms.size()));
  Eigen::VectorXd b = Eigen::VectorXd::Zero(nodes);
  for (int k = 0; k < nodes; ++k)
    if (known(k)) {
      A.row(k) = least_left / left[k] * basis(k);
      b[k] = least_left / left[k] * numbers.value[k];
    }
  const Eigen::VectorXd coefficients = least_squares(A, b);
  for (int k = 0; k < nodes; ++k)
    if (!known(k)) {
      numbers.value[k] = basis(k).dot(coefficients);
      numbers.error[k] = error;
    }
  return true;
}

double root_of(double left) { return std::sqrt(std::max(0.0, left)); }

}  // namespace

std::vector<double> lagrange_weights(const std::vector<int>& nodes, int place) {
  std::vector<double> w(nodes.size(), 1.0);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != i) w[i] *= double(place - nodes[j]) / (nodes[i] - nodes[j]);
  return w;
}

double NodeValues::at(const NodeWeights& w) const {
  double sum = 0;
  for (std::size_t j = 0; j < w.y.size(); ++j) {
    double row = 0;
    for (std::size_t i = 0; i < w.x.size(); ++i) row += w.x[i] * value[j * w.x.size() + i];
    sum += w.y[j] * row;
  }
  return sum;
}

double NodeValues::error_at(const NodeWeights& w) const {
  double squares = 0, sum = 0, weights = 0;
  for (std::size_t j = 0; j < w.y.size(); ++j)
    for (std::size_t i = 0; i < w.x.size(); ++i) {
      const double weight = std::abs(w.x[i] * w.y[j]), part = weight * error[j * w.x.size() + i];
      squares += part * part;
      sum += part;
      weights += weight;
    }
  return std::max(2 * std::sqrt(squares), sum / weights);
}

Interpolant Interpolant::plain(NodeValues values) {
  Interpolant result;
  result.nodes_ = std::move(values);
  return result;
}

Interpolant Interpolant::logarithm(NodeValues values) {
  for (std::size_t k = 0; k < values.value.size(); ++k) {
    values.error[k] /= values.value[k];
    values.value[k] = std::log(values.value[k]);
  }
  Interpolant result = plain(std::move(values));
  result.form_ = Form::logarithm;
  return result;
}

std::optional<Interpolant> Interpolant::root(const std::vector<int>& x, const std::vector<int>& y, NodeValues values,
                                             const Interpolant& helper, double threshold) {
  // Close to the threshold the factor is lost in the helper's error, and extrapolation is better.
  constexpr double known = 50;  // over the helper's error
  std::vector<double> left;
  for (std::size_t k = 0; k < values.value.size(); ++k) {
    const double d = threshold - helper.nodes_.value[k], helper_error = helper.nodes_.error[k];
    left.push_back(d > known * helper_error ? d : 0);
    if (left[k] == 0) continue;
    values.error[k] = values.error[k] / std::sqrt(d) + values.value[k] * helper_error / (2 * d * std::sqrt(d));
    values.value[k] /= std::sqrt(d);
  }
  const bool begins_within = !std::ranges::all_of(left, [](double d) { return d > 0; });
  if (begins_within && !continue_smoothly(x, y, left, values)) return std::nullopt;
  Interpolant result = plain(std::move(values));
  result.form_ = Form::root;
  result.helper_ = &helper;
  result.threshold_ = threshold;
  return result;
}

double Interpolant::at(const NodeWeights& w) const {
  const double v = nodes_.at(w);
  switch (form_) {
    case Form::plain:
      return v;
    case Form::logarithm:
      return std::exp(v);
    case Form::root:
      return v * root_of(threshold_ - helper_->at(w));
  }
  return v;
}

void Interpolant::compared_at(const NodeWeights& w) {
  if (form_ != Form::root) return;
  if (const double left = threshold_ - helper_->at(w); left > 0) compared_ = std::min(compared_, left);
}

double Interpolant::error_at(const NodeWeights& w) const {
  const double e = nodes_.error_at(w);
  switch (form_) {
    case Form::plain:
      return e;
    case Form::logarithm:
      return e * at(w);
    case Form::root: {
      const double h = helper_->at(w), left = threshold_ - h;
      const double unseen = left < compared_ ? helper_->shown * std::max(1.0, std::abs(h)) : 0;
      const double helper_error = helper_->error_at(w) + unseen;
      const auto off = [&](double other) { return std::abs(root_of(other) - root_of(left)); };
      return root_of(left) * e + std::abs(nodes_.at(w)) * std::max(off(left + helper_error), off(left - helper_error));
    }
  }
  return e;
}

}  // namespace rosin::analysis::lanes
