/// Dense algebra of small systems, and banded algebra in time linear in the number of unknowns.
#include "solvers/steps/stage_algebra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "solvers/steps/banded_lu.hpp"
#include "solvers/steps/growth.hpp"
#include "solvers/steps/lu.hpp"
#include "solvers/steps/oscillations.hpp"

namespace rosin::solvers::steps {

std::vector<int> narrow_order(const Pattern& pattern) {
  const int n = pattern.size();
  std::vector<std::vector<int>> neighbours(n);
  for (int i = 0; i < n; ++i)
    for (int e = pattern.row_begin[i]; e < pattern.row_begin[i + 1]; ++e)
      if (const int j = pattern.column[e]; j != i) neighbours[i].push_back(j), neighbours[j].push_back(i);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  const auto fewer = [&](int a, int b) { return neighbours[a].size() < neighbours[b].size(); };
  for (auto& list : neighbours) std::stable_sort(list.begin(), list.end(), fewer);
  std::vector<int> order, seen(n, -1);
  int sweep = 0;
  // All that are connected with `first`, by distance from it, behind what `into` holds.
  const auto spread = [&](int first, std::vector<int>& into) {
    std::size_t next = into.size();
    into.push_back(first), seen[first] = ++sweep;
    for (; next < into.size(); ++next)
      for (const int j : neighbours[into[next]])
        if (seen[j] < sweep) into.push_back(j), seen[j] = sweep;
  };
  std::vector<bool> placed(n);
  std::vector<int> reached;
  for (int i = 0; i < n; ++i) {
    if (placed[i]) continue;
    int end = i;
    constexpr int tries = 2;  // from the farthest unknown to the one farthest from that: an end, or near one
    for (int k = 0; k < tries; ++k) {
      reached.clear();
      spread(end, reached);
      end = reached.back();
    }
    const std::size_t before = order.size();
    spread(end, order);
    for (std::size_t k = before; k < order.size(); ++k) placed[order[k]] = true;
  }
  return order;
}

namespace {

class DenseAlgebra final : public StageAlgebra {
 public:
  DenseAlgebra(const System& system, const RadauTableau& tableau, double tolerance)
      : system_(system),
        tableau_(tableau),
        n_(system.size()),
        growth_(n_),
        oscillations_(tableau, n_, tolerance),
        J_(n_ * n_),
        real_(n_ * n_),
        real_pivot_(n_) {
    for (int k = 0; k < 2; ++k) pair_[k].assign(n_ * n_, 0.0), pair_pivot_[k].assign(n_, 0);
  }
  void linearise(double t, const double* y, double* f) override { system_.linearise(t, y, f, J_.data()); }
  double own_slope(int row) const override { return J_[row * n_ + row]; }
  double size_of_terms(int row, const double* y) const override { return rosin::size_of_terms(&J_[row * n_], y, n_); }
  bool solve_algebraic(const std::vector<double>& mass, double* r) override {
    rows_.clear();
    for (int i = 0; i < n_; ++i)
      if (mass[i] == 0) rows_.push_back(i);
    const int m = int(rows_.size());
    a_.resize(m * m), x_.resize(m), a_pivot_.resize(m);
    for (int i = 0; i < m; ++i) {
      x_[i] = r[rows_[i]];
      for (int j = 0; j < m; ++j) a_[i * m + j] = J_[rows_[i] * n_ + rows_[j]];
    }
    if (!factorise_lu(a_, a_pivot_, m)) return false;
    solve_lu(a_, a_pivot_, m, x_.data());
    for (int i = 0; i < m; ++i) r[rows_[i]] = x_[i];
    return true;
  }
  void factorise(double h, const std::vector<double>& mass) override {
    const int n = n_;
    for (int i = 0; i < n * n; ++i) real_[i] = -J_[i];
    for (int k = 0; k < 2; ++k)
      for (int i = 0; i < n * n; ++i) pair_[k][i] = -J_[i];
    for (int i = 0; i < n; ++i) {
      real_[i * n + i] += tableau_.gamma / h * mass[i];
      for (int k = 0; k < 2; ++k) pair_[k][i * n + i] += tableau_.pair[k] / h * mass[i];
    }
    if (!factorise_lu(real_, real_pivot_, n)) real_[0] = NAN;
    for (int k = 0; k < 2; ++k)
      if (!factorise_lu(pair_[k], pair_pivot_[k], n)) pair_[k][0] = NAN;
  }
  void solve_real(double* x) override { solve_lu(real_, real_pivot_, n_, x); }
  void solve_pair(int pair, std::complex<double>* x) override { solve_lu(pair_[pair], pair_pivot_[pair], n_, x); }
  bool grows_faster(double rate, const std::vector<double>& mass) override {
    return growth_.faster_than(rate, mass, J_);
  }
  double error_of_oscillations(const Attempt& at) override {
    return oscillations_.error(
        {at.length, at.resolved_growth, at.y, at.mass, J_, at.scale, real_, real_pivot_, at.estimate, at.size});
  }
  double longest_step() const override { return oscillations_.longest_step(); }
  void accept() override { oscillations_.accept(); }
  void forget() override { oscillations_.forget(); }
  std::span<const double> passed_over() const override { return oscillations_.passed_over(); }

 private:
  const System& system_;
  const RadauTableau& tableau_;
  int n_;
  GrowthTest growth_;
  Oscillations oscillations_;
  std::vector<double> J_, real_;
  std::vector<std::complex<double>> pair_[2];
  std::vector<int> real_pivot_, pair_pivot_[2];
  std::vector<double> a_, x_;  ///< of the algebraic rows
  std::vector<int> rows_, a_pivot_;
};

/// Unknowns stand in a narrow order. Modes are not known; the error by oscillations is read off the estimate by four
/// filters instead.
class BandedAlgebra final : public StageAlgebra {
 public:
  struct Shape {
    explicit Shape(const Pattern& pattern) : order(narrow_order(pattern)), place(order.size()) {
      for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = int(k);
      for (int i = 0; i < pattern.size(); ++i)
        for (int e = pattern.row_begin[i]; e < pattern.row_begin[i + 1]; ++e) {
          const int above_diagonal = place[pattern.column[e]] - place[i];
          above = std::max(above, above_diagonal), below = std::max(below, -above_diagonal);
        }
    }
    long entries() const { return long(order.size()) * (2 * below + above + 1); }
    std::vector<int> order, place;
    int below = 0, above = 0;
  };

  BandedAlgebra(const System& system, const RadauTableau& tableau, double tolerance, Shape shape)
      : system_(system),
        pattern_(*system.pattern()),
        tableau_(tableau),
        tolerance_(tolerance),
        n_(system.size()),
        order_(std::move(shape.order)),
        J_(pattern_.entries()),
        real_(n_, shape.below, shape.above),
        other_(n_, shape.below, shape.above),
        pair_{{n_, shape.below, shape.above}, {n_, shape.below, shape.above}},
        x_(n_),
        complex_x_(n_),
        filtered_(n_),
        noise_(n_),
        passed_over_(n_),
        in_step_(n_) {
    for (int i = 0; i < n_; ++i)
      for (int e = pattern_.row_begin[i]; e < pattern_.row_begin[i + 1]; ++e) {
        where_.push_back(real_.place(shape.place[i], shape.place[pattern_.column[e]]));
        if (pattern_.column[e] == i) diagonal_.push_back(e);
      }
    // The largest error over what four filters leave of the estimate, on the rays that bound what rings.
    for (double size = 0.01; size < 1e4; size *= 1.1)
      for (const std::complex<double> ray : {std::complex<double>(0, 1), {-std::sqrt(0.5), std::sqrt(0.5)}}) {
        const auto z = size * ray;
        most_error_ = std::max(most_error_,
                               tableau_.error_over_estimate(z) * std::pow(std::abs((tableau_.gamma - z) / z), filters));
      }
  }
  void linearise(double t, const double* y, double* f) override { system_.linearise_entries(t, y, f, J_.data()); }
  double own_slope(int row) const override { return J_[diagonal_[row]]; }
  double size_of_terms(int row, const double* y) const override {
    return rosin::size_of_terms(pattern_, J_.data(), row, y);
  }
  bool solve_algebraic(const std::vector<double>& mass, double* r) override {
    if (!factorise_algebraic(mass)) return false;
    for (int k = 0; k < n_; ++k) x_[k] = mass[order_[k]] == 0 ? r[order_[k]] : 0;
    other_.solve(x_.data());
    for (int k = 0; k < n_; ++k)
      if (mass[order_[k]] == 0) r[order_[k]] = x_[k];
    return true;
  }
  void factorise(double h, const std::vector<double>& mass) override {
    if (!factorise(real_, tableau_.gamma / h, mass)) real_.entries()[real_.place(0, 0)] = NAN;
    for (int k = 0; k < 2; ++k)
      if (!factorise(pair_[k], tableau_.pair[k] / h, mass)) pair_[k].entries()[pair_[k].place(0, 0)] = NAN;
  }
  void solve_real(double* x) override {
    for (int k = 0; k < n_; ++k) x_[k] = x[order_[k]];
    real_.solve(x_.data());
    for (int k = 0; k < n_; ++k) x[order_[k]] = x_[k];
  }
  void solve_pair(int pair, std::complex<double>* x) override {
    for (int k = 0; k < n_; ++k) complex_x_[k] = x[order_[k]];
    pair_[pair].solve(complex_x_.data());
    for (int k = 0; k < n_; ++k) x[order_[k]] = complex_x_[k];
  }
  /// Signs of determinants miss modes that grow in an even number, as those of equal blocks do. What each unknown does
  /// with those in its own row and column, all else at rest, shows these.
  bool grows_faster(double rate, const std::vector<double>& mass) override {
    for (int i = 0; i < n_; ++i)
      if (mass[i] > 0 && own_slope(i) > rate * mass[i] && grows_alone(i, rate, mass)) return true;
    const int all = factorise(other_, rate, mass) ? other_.determinant_sign() : 0;
    int algebraic = 1;
    if (std::find(mass.begin(), mass.end(), 0.0) != mass.end())
      algebraic = factorise_algebraic(mass, -1) ? other_.determinant_sign() : 0;
    return all * algebraic < 0;
  }

  /// Of a mode with z = hλ the error is κ(z) = |R(z) − e^z|/|ρ(z)| times its part of the estimate. κ rises with z⁴ and
  /// stays, like (z/(γ − z))⁴, which four filters make of the estimate in all modes at once; the factor between them is
  /// the largest of what rings. Unknowns that decay within the step by their own slope, and those that follow others,
  /// are left out: of an oscillation that outlasts the step another unknown shows as much. Other modes that only decay
  /// are counted, so that the error is overestimated.
  double error_of_oscillations(const Attempt& at) override {
    std::fill(in_step_.begin(), in_step_.end(), 0.0);
    if (!(at.size > 0)) return 0;
    std::copy(at.estimate.begin(), at.estimate.end(), filtered_.begin());
    for (int filter = 0; filter < filters; ++filter) {
      for (int i = 0; i < n_; ++i) noise_[i] = tableau_.gamma / at.length * at.mass[i] * filtered_[i];
      solve_real(noise_.data());
      for (int i = 0; i < n_; ++i) filtered_[i] = noise_[i] - filtered_[i];
    }
    const double amplitude = size_of_ringing(filtered_, at);
    if (!(most_error_ * amplitude > 0.1 * tolerance_)) return 0;
    // The estimate holds rounding error of balanced forces, which rings at every start; its part is subtracted.
    for (int i = 0; i < n_; ++i) noise_[i] = last_digits_of_terms(size_of_terms(i, at.y.data()));
    solve_real(noise_.data());
    const double beyond = amplitude - size_of_ringing(noise_, at);
    if (!(beyond > 0)) return 0;
    for (int i = 0; i < n_; ++i) in_step_[i] = most_error_ * std::abs(filtered_[i]);
    return most_error_ * beyond;
  }
  double longest_step() const override { return infinity; }
  void accept() override {
    for (int i = 0; i < n_; ++i) passed_over_[i] += in_step_[i];
  }
  void forget() override {}
  std::span<const double> passed_over() const override { return passed_over_; }

 private:
  static constexpr int filters = 4;

  double size_of_ringing(const std::vector<double>& v, const Attempt& at) const {
    double sum = 0;
    for (int i = 0; i < n_; ++i)
      if (at.mass[i] > 0 && -own_slope(i) * at.length < at.mass[i]) sum += v[i] / at.scale[i] * (v[i] / at.scale[i]);
    return std::sqrt(sum / n_);
  }
  /// The sign of r M − J in row i once the unknowns beside it are eliminated, of which each has its own slope only.
  bool grows_alone(int i, double rate, const std::vector<double>& mass) const {
    double left = rate * mass[i] - own_slope(i);
    for (int e = pattern_.row_begin[i]; e < pattern_.row_begin[i + 1]; ++e) {
      const int j = pattern_.column[e], back = pattern_.place(j, i);
      const bool answers = j != i && back < pattern_.row_begin[j + 1] && pattern_.column[back] == i;
      if (answers && J_[e] * J_[back] != 0) left -= J_[e] * J_[back] / (rate * mass[j] - own_slope(j));
    }
    return left < 0;
  }
  template <class Number>
  bool factorise(BandedLu<Number>& lu, Number shift, const std::vector<double>& mass) {
    lu.clear();
    auto& a = lu.entries();
    for (std::size_t e = 0; e < J_.size(); ++e) a[where_[e]] = -J_[e];
    for (int i = 0; i < n_; ++i) a[where_[diagonal_[i]]] += shift * mass[i];
    return lu.factorise();
  }
  /// J_aa among rows of the unit matrix.
  bool factorise_algebraic(const std::vector<double>& mass, double sign = 1) {
    other_.clear();
    auto& a = other_.entries();
    for (int i = 0; i < n_; ++i) {
      if (mass[i] != 0) a[where_[diagonal_[i]]] = 1;
      for (int e = pattern_.row_begin[i]; mass[i] == 0 && e < pattern_.row_begin[i + 1]; ++e)
        if (mass[pattern_.column[e]] == 0) a[where_[e]] = sign * J_[e];
    }
    return other_.factorise();
  }

  const System& system_;
  const Pattern& pattern_;
  const RadauTableau& tableau_;
  double tolerance_, most_error_ = 0;
  int n_;
  std::vector<int> order_, diagonal_;
  std::vector<std::size_t> where_;  ///< entries of J in the band
  std::vector<double> J_;
  BandedLu<double> real_, other_;
  BandedLu<std::complex<double>> pair_[2];
  std::vector<double> x_;
  std::vector<std::complex<double>> complex_x_;
  std::vector<double> filtered_, noise_, passed_over_, in_step_;
};

}  // namespace

std::unique_ptr<StageAlgebra> stage_algebra(const System& system, const RadauTableau& tableau, double tolerance) {
  constexpr int most_dense = largest_lu / RadauTableau::stages;
  const int n = system.size();
  if (n <= most_dense) return std::make_unique<DenseAlgebra>(system, tableau, tolerance);
  if (!system.pattern())
    throw InputError(fmt::format(
        "{} unknowns are more than the collocation takes, {}, of a system whose masses are shared", n, most_dense));
  BandedAlgebra::Shape shape(*system.pattern());
  constexpr long most_entries = 4'000'000;  // of each of four factors, 200 MB in all
  if (shape.entries() > most_entries)
    throw InputError(fmt::format(
        "{} unknowns that are coupled over {} others make factors of {:.1e} entries, and {:.0e} are accepted; "
        "couplings between neighbours cost least",
        n, shape.below, double(shape.entries()), double(most_entries)));
  return std::make_unique<BandedAlgebra>(system, tableau, tolerance, std::move(shape));
}

}  // namespace rosin::solvers::steps
