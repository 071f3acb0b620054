/// The modes at a step, kept while they hold; the ringing ones, and the errors of the step in them.
#include "solvers/steps/oscillations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/system.hpp"
#include "solvers/steps/collocation.hpp"
#include "solvers/steps/lu.hpp"

namespace rosin::solvers::steps {

using Complex = std::complex<double>;
using Modes = Eigen::Map<const Eigen::MatrixXd>;

/// The unknowns with a rate of their own, and the algebraic ones, which follow by δy_a = −J_aa⁻¹ J_am δy_m.
struct Oscillations::Moving {
  explicit Moving(const std::vector<double>& mass) {
    for (int i = 0; i < int(mass.size()); ++i) (mass[i] != 0 ? unknowns[m++] : following[a++]) = i;
  }
  /// Eliminates the algebraic unknowns from J.
  void reduce(const Step&);

  std::array<int, most_small_rows> unknowns, following;
  int m = 0, a = 0;            ///< numbers of moving and algebraic unknowns
  SmallMatrix<double> follow;  ///< a × m
  SmallMatrix<double> rates;   ///< rates times the step's length, m × m
};

void Oscillations::Moving::reduce(const Step& step) {
  const int n = m + a;
  const double* J = step.jacobian.data();
  SmallMatrix<double> own(a, a);
  follow.resize(a, m);
  for (int i = 0; i < a; ++i) {
    for (int j = 0; j < a; ++j) own(i, j) = J[following[i] * n + following[j]];
    for (int j = 0; j < m; ++j) follow(i, j) = -J[following[i] * n + unknowns[j]];
    const double largest = own.row(i).cwiseAbs().maxCoeff();  // rows may be fifty decades apart
    own.row(i) /= largest, follow.row(i) /= largest;
  }
  if (a > 0) follow = own.partialPivLu().solve(follow).eval();
  rates.resize(m, m);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      const double* row = &J[unknowns[i] * n];
      double sum = row[unknowns[j]];
      for (int k = 0; k < a; ++k) sum += row[following[k]] * follow(k, j);
      rates(i, j) = step.length * sum / step.mass[unknowns[i]];
    }
}

Oscillations::Oscillations(const RadauTableau& tableau, int unknowns, double tolerance)
    : tableau_(tableau), tolerance_(tolerance), passed_over_(unknowns), in_step_(unknowns) {
  static_assert(Collocation::stages * most_small_rows >= largest_lu);
  for (auto* v : {&modes_, &inverse_}) v->reserve(unknowns * unknowns);
  rates_.reserve(unknowns);
  ringing_.reserve(unknowns);
  forget();
}

void Oscillations::forget() {
  rates_.clear();
  longest_step_ = infinity;
}

void Oscillations::accept() {
  for (std::size_t k = 0; k < in_step_.size(); ++k) passed_over_[k] += in_step_[k];
}

/// The solution is more accurate than the estimate only for motion of the size of the scale. A weak oscillation y' =
/// λy, for example on a stiff spring, is damped to nothing by one long step while the estimate is still small. For a
/// mode both are known: with z = hλ the error is |R(z) − e^z| and the estimate |ρ(z)|, each times the amplitude. The
/// part of the estimate in the mode times κ(z) = |R − e^z|/|ρ| is therefore the error. Modes with |Im z| < |Re z| die
/// out within a period.
double Oscillations::error(const Step& step) {
  std::fill(in_step_.begin(), in_step_.end(), 0.0);
  longest_step_ = infinity;
  Moving moving(step.mass);
  if (moving.m < 2 || !(step.size > 0)) return 0;  // a single mode cannot ring
  moving.reduce(step);
  const auto& rates = moving.rates;
  if (const double apart = rates(0, 0) - rates(1, 1);
      moving.m == 2 && apart * apart + 4 * rates(0, 1) * rates(1, 0) >= 0)
    return 0;  // both real
  outgrown_ = false;
  if (!known_modes_hold(step, moving)) {
    ringing_.clear();
    if (!find_modes(step, moving)) return 0;
    for (int k = 0; k < moving.m; ++k) {
      const bool pair = rates_[k].imag() > 0;
      note_mode(step, k, pair, step.length * rates_[k], 0);
      k += pair;
    }
  }
  return outgrown_ ? infinity : sum_of_errors(step, moving);
}

/// Notes a mode if it rings, with z known to within `radius`. \returns false if `radius` is too large to decide.
bool Oscillations::note_mode(const Step& step, int mode, bool pair, Complex z, double radius) {
  constexpr double notably = 0.05;
  if (pair && z.real() - radius > notably * std::abs(z.imag())) {
    longest_step_ = std::min(longest_step_, step.length * step.resolved_growth / std::abs(z));
    outgrown_ = outgrown_ || std::abs(z) - radius > step.resolved_growth;
  }
  const double least = RadauTableau::size_below(0.1 * tolerance_ / step.size);
  if (std::abs(z) + radius < least || std::abs(z.real()) - std::abs(z.imag()) > std::sqrt(2) * radius) return true;
  if (!pair || !(radius < 0.1 * std::abs(z))) return false;
  ringing_.push_back({mode, z});
  return true;
}

/// True if the modes of an earlier step still decide which ones ring. In their basis J is nearly diagonal, and each
/// rate lies within a radius of its diagonal entry, the sum of the row's other entries (Gershgorin). The modes hold as
/// long as this radius is below a tenth of the rate for every rate where κ matters, and these rates belong to ringing
/// modes.
bool Oscillations::known_modes_hold(const Step& step, const Moving& moving) {
  const int m = moving.m;
  ringing_.clear();
  if (int(rates_.size()) != m) return false;
  SmallMatrix<double> B = moving.rates.lazyProduct(Modes(modes_.data(), m, m));
  B = Modes(inverse_.data(), m, m).lazyProduct(B).eval();
  for (int k = 0; k < m; ++k) {
    const bool pair = rates_[k].imag() > 0;
    const int last = pair ? k + 1 : k;
    double radius = 0;
    for (int j = 0; j < m; ++j)
      if (j < k || j > last) radius += pair ? std::hypot(B(k, j), B(last, j)) : std::abs(B(k, j));
    Complex z = B(k, k);
    if (pair) {
      z = {0.5 * (B(k, k) + B(last, last)), 0.5 * (B(k, last) - B(last, k))};
      radius += 0.5 * std::hypot(B(k, k) - B(last, last), B(k, last) + B(last, k));
    }
    if (!note_mode(step, k, pair, z, radius)) return false;
    k = last;
  }
  return true;
}

/// The modes from the filter of the embedded estimate: (γM/h − J)⁻¹ M r = r h/(γ − z) where J r = λ M r and z = hλ. The
/// filter keeps the accuracy of slow modes next to the fast ones of a stuck contact, which J itself loses. \returns
/// false where the eigenvalues are not finite.
bool Oscillations::find_modes(const Step& step, const Moving& moving) {
  const int m = moving.m, n = m + moving.a;
  const auto size = [&](int i) { return step.scale[moving.unknowns[i]]; };
  std::array<double, most_small_rows * most_small_rows> columns;
  std::fill_n(columns.begin(), n * m, 0.0);
  for (int j = 0; j < m; ++j) columns[moving.unknowns[j] * m + j] = step.mass[moving.unknowns[j]] * size(j);
  solve_lu(step.filter, step.pivot, n, columns.data(), m);
  SmallMatrix<double> G(m, m), vectors(m, m);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) G(i, j) = columns[moving.unknowns[i] * m + j] / size(i);
  rates_.clear();
  if (!G.allFinite()) return false;
  const auto pairs = small_eigenpairs(G, true);
  if (!pairs.values.allFinite()) return false;
  for (int k = 0; k < m; ++k) {
    const bool pair = pairs.values[k].imag() != 0;
    const int first = pairs.values[k].imag() > 0 ? k : k - 1;  // Eigen puts the positive frequency before its conjugate
    rates_.push_back(tableau_.gamma / step.length - 1.0 / pairs.values[pair ? first : k]);
    for (int i = 0; i < m; ++i) {
      const auto part = pairs.vectors(i, pair ? first : k) * size(i);
      vectors(i, k) = pair && first != k ? part.imag() : part.real();
    }
  }
  modes_.assign(vectors.data(), vectors.data() + m * m);
  // The inverse is computed in scales, in which the vectors have similar sizes.
  for (int i = 0; i < m; ++i) vectors.row(i) /= size(i);
  SmallMatrix<double> inverse = vectors.inverse();
  for (int i = 0; i < m; ++i) inverse.col(i) /= size(i);
  inverse_.assign(inverse.data(), inverse.data() + m * m);
  return true;
}

/// Sum of the errors of all ringing modes, in scales. The errors of passed-over modes are kept for each unknown.
double Oscillations::sum_of_errors(const Step& step, const Moving& moving) {
  const int m = moving.m, a = moving.a, n = m + a;
  const Modes vectors(modes_.data(), m, m), inverse(inverse_.data(), m, m);
  std::array<double, most_small_rows * most_small_rows> noise;
  double sum = 0;
  bool noise_known = false;
  for (const auto& [k, z] : ringing_) {
    const double kappa = tableau_.error_over_estimate(z);
    if (!(kappa * step.size > 0.1 * tolerance_)) continue;
    if (!noise_known) {
      // The estimate holds rounding error of balanced forces, which rings at every start; its part is subtracted.
      std::fill_n(noise.begin(), n * n, 0.0);
      for (int i = 0; i < n; ++i) noise[i * n + i] = last_digits_of_terms(&step.jacobian[i * n], step.y.data(), n);
      solve_lu(step.filter, step.pivot, n, noise.data(), n);
      noise_known = true;
    }
    const auto part = [&, k = k](const double* source, int stride) {  // amplitude in the pair of modes
      double real = 0, imaginary = 0;
      for (int j = 0; j < m; ++j) {
        real += inverse(k, j) * source[moving.unknowns[j] * stride];
        imaginary += inverse(k + 1, j) * source[moving.unknowns[j] * stride];
      }
      return std::hypot(real, imaginary);
    };
    double amplitude = part(step.estimate.data(), 1);
    for (int i = 0; i < n; ++i) amplitude -= part(&noise[i], n);
    if (!(amplitude > 0)) continue;
    const double error = kappa * amplitude;
    constexpr double most_phase = 3;  // radians: longer steps damp it e-fold within five thousand periods
    const bool passed_over = std::abs(z) > most_phase;
    double square = 0;  // squared size of the vector, in scales
    const auto add = [&](int i, double real, double imaginary) {
      const double length = std::hypot(real, imaginary);
      square += length * length / (step.scale[i] * step.scale[i]);
      if (passed_over) in_step_[i] += error * length;
    };
    for (int j = 0; j < m; ++j) add(moving.unknowns[j], vectors(j, k), vectors(j, k + 1));
    for (int i = 0; i < a; ++i) {
      double real = 0, imaginary = 0;
      for (int j = 0; j < m; ++j) {
        real += moving.follow(i, j) * vectors(j, k);
        imaginary += moving.follow(i, j) * vectors(j, k + 1);
      }
      add(moving.following[i], real, imaginary);
    }
    sum += error * std::sqrt(square / n);
  }
  return std::isnan(sum) ? 0 : sum;
}

}  // namespace rosin::solvers::steps
