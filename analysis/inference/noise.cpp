/// Noise by the restricted likelihood, one series at a time.
#include "analysis/inference/noise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

namespace rosin::analysis::inference {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void whiten(std::span<double> values, std::size_t columns, double correlation, std::span<const char> apart) {
  if (correlation == 0) return;
  const double rest = std::sqrt(1 - correlation * correlation);
  for (std::size_t i = values.size(); i-- > columns;)
    if (const auto row = i / columns; apart.empty() || !(apart[row] || apart[row - 1]))
      values[i] = (values[i] - correlation * values[i - columns]) / rest;
}

Neighbours neighbours(std::span<const double> r) {
  double square = 0, product = 0, difference = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    square += r[i] * r[i];
    if (i == 0) continue;
    product += r[i] * r[i - 1];
    difference += (r[i] - r[i - 1]) * (r[i] - r[i - 1]);
  }
  if (!(square > 0)) return {};
  const double correlation = product / square;
  return {correlation, difference / square, correlation * std::sqrt(double(r.size()))};
}

double roughness(std::span<const double> y) {
  std::vector<double> bends;
  for (std::size_t i = 2; i < y.size(); ++i) bends.push_back(std::abs(y[i] - 2 * y[i - 1] + y[i - 2]));
  double largest = 0;
  for (const double v : y) largest = std::max(largest, std::abs(v));
  const double least = 1e-12 * largest + 1e-300;
  if (bends.empty()) return std::max(least, 1e-3 * largest);
  const auto middle = bends.begin() + std::ptrdiff_t(bends.size() / 2);
  std::nth_element(bends.begin(), middle, bends.end());
  constexpr double median_of_normal = 0.6744897501960817;
  return std::max(least, *middle / (median_of_normal * std::sqrt(6.0)));
}

namespace {

/// Σ over whitened series of products of their columns, as it depends on the correlation ρ:
/// begins + (ends − ρ lagged + ρ² before)/(1 − ρ²).
struct Products {
  explicit Products(const Leftover& part) {
    const auto n = Index(part.residual.size()), p = Index(part.slopes.size()) / n;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    MatrixXd all(n, p + 1);
    all << Eigen::Map<const Rows>(part.slopes.data(), n, p), Eigen::Map<const VectorXd>(part.residual.data(), n);
    const auto apart = [&](Index k) { return k < 0 || (!part.apart.empty() && part.apart[std::size_t(k)]); };
    std::vector<Index> first, later, last;  // of series, and in them each and its predecessor
    for (Index k = 0; k < n; ++k)
      if (!apart(k) && apart(k - 1))
        first.push_back(k);
      else if (!apart(k))
        later.push_back(k), last.push_back(k - 1);
    points = double(first.size() + later.size()), pairs = double(later.size());
    const MatrixXd end = all(later, Eigen::all), begin = all(last, Eigen::all);
    begins = all(first, Eigen::all).transpose() * all(first, Eigen::all);
    ends = end.transpose() * end;
    before = begin.transpose() * begin;
    lagged = end.transpose() * begin + begin.transpose() * end;
  }
  MatrixXd at(SeriesNoise noise) const {
    const double rho = noise.correlation;
    return (begins + (ends - rho * lagged + rho * rho * before) / (1 - rho * rho)) / (noise.size * noise.size);
  }
  double points = 0, pairs = 0;
  MatrixXd begins, ends, before, lagged;
};

/// What all series say together at given noise.
struct Together {
  explicit Together(const std::vector<Products>& products, const std::vector<Leftover>& parts) {
    const Index p = products.front().ends.rows() - 1;
    information = MatrixXd::Zero(p, p);
    VectorXd gradient = VectorXd::Zero(p);
    for (std::size_t m = 0; m < parts.size(); ++m) {
      const MatrixXd sum = products[m].at(parts[m].noise);
      information += sum.topLeftCorner(p, p);
      gradient += sum.topRightCorner(p, 1);
    }
    // Variables that nothing determines take up nothing: their directions are left out.
    const VectorXd unit = information.diagonal().cwiseSqrt().unaryExpr([](double d) { return d > 0 ? 1 / d : 1; });
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(unit.asDiagonal() * information * unit.asDiagonal());
    inverse = MatrixXd::Zero(p, p);
    for (Index i = 0; i < p; ++i) {
      const double value = solver.eigenvalues()[i];
      if (!(value > 1e-13)) continue;
      const VectorXd direction = unit.asDiagonal() * solver.eigenvectors().col(i);
      inverse += direction * direction.transpose() / value;
      log_determinant += std::log(value);
    }
    log_determinant -= 2 * unit.array().log().sum();
    shift = -inverse * gradient;
  }
  /// Σ of whitened squares of one series over its noise's, after the variables have moved to their best.
  double square(const Products& products, SeriesNoise noise) const {
    VectorXd moved(shift.size() + 1);
    moved << shift, 1;
    return moved.dot(products.at(noise) * moved);
  }
  MatrixXd information, inverse;
  VectorXd shift;
  double log_determinant = 0;
};

}  // namespace

void find_noise(std::vector<Leftover>& parts) {
  std::vector<Products> products;
  for (const auto& part : parts) products.emplace_back(part);
  constexpr int rounds = 20;
  const bool single = parts.size() == 1;
  for (int round = 0; round < (single ? 1 : rounds); ++round) {
    double changed = 0;
    for (std::size_t m = 0; m < parts.size(); ++m) {
      auto& noise = parts[m].noise;
      if (!parts[m].unknown) continue;
      const double n = products[m].points;
      const double least = noise.size * 1e-9;
      // The size at a correlation: squares over the numbers that the variables have not taken up.
      const auto size_at = [&](double rho) {
        noise.correlation = rho;
        for (int i = 0; i < 4; ++i) {
          const Together all(products, parts);
          const Index p = all.information.rows();
          const double taken = (all.inverse * products[m].at(noise).topLeftCorner(p, p)).trace();
          const double square = all.square(products[m], noise) * noise.size * noise.size;
          noise.size = std::max(least, std::sqrt(square / std::max(n - taken, 1.0)));
        }
      };
      const SeriesNoise before = noise;
      const auto misfit = [&](double rho) {
        noise.size = before.size;
        size_at(rho);
        const Together all(products, parts);
        double sum = all.log_determinant + 2 * n * std::log(noise.size) + products[m].pairs * std::log(1 - rho * rho);
        for (std::size_t k = 0; k < parts.size(); ++k) sum += all.square(products[k], parts[k].noise);
        return sum;
      };
      constexpr double least_correlation = -0.6, most_correlation = 0.98;
      constexpr int least_series = 20, digits = 20;  // of 2
      double rho = 0;
      if (parts[m].series && n >= least_series)
        rho = boost::math::tools::brent_find_minima(misfit, least_correlation, most_correlation, digits).first;
      noise.size = before.size;
      size_at(rho);
      changed = std::max({changed, std::abs(noise.size / before.size - 1), std::abs(rho - before.correlation)});
    }
    if (changed < 1e-4) break;
  }
}

}  // namespace rosin::analysis::inference
