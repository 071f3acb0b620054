/// Modes beside a step, kept while they serve; those that ring, and the errors that the step makes in them.
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

/// The unknowns with a rate of their own, and what follows them at once, δy_a = −J_aa⁻¹ J_am δy_m.
struct Oscillations::Moving {
  explicit Moving(const std::vector<double>& mass) {
    for (int i = 0; i < int(mass.size()); ++i) (mass[i] != 0 ? unknowns[m++] : following[a++]) = i;
  }
  /// Eliminates what follows from J.
  void reduce(const Step&);

  std::array<int, most_small_rows> unknowns, following;
  int m = 0, a = 0;            ///< numbers of them
  SmallMatrix<double> follow;  ///< a × m
  SmallMatrix<double> rates;   ///< over the step, m × m
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

/// That the solution is better than the estimate holds for motion of the size of the scale alone. A weak oscillation
/// y' = λy, on a stiff spring say, is followed by a long step to nothing at once while the estimate is still small. But
/// for it both are known: with z = hλ the method errs by |R(z) − e^z| and estimates |ρ(z)|, each times the amplitude,
/// so that the part of the estimate in the mode times κ(z) = |R − e^z|/|ρ| is the error. Modes with |Im z| < |Re z| die
/// out within a turn.
double Oscillations::error(const Step& step) {
  std::fill(in_step_.begin(), in_step_.end(), 0.0);
  longest_step_ = infinity;
  Moving moving(step.mass);
  if (moving.m < 2 || !(step.size > 0)) return 0;  // nothing that could ring
  moving.reduce(step);
  const auto& rates = moving.rates;
  if (const double apart = rates(0, 0) - rates(1, 1);
      moving.m == 2 && apart * apart + 4 * rates(0, 1) * rates(1, 0) >= 0)
    return 0;  // both real
  outgrown_ = false;
  if (!known_serve(step, moving)) {
    ringing_.clear();
    if (!find(step, moving)) return 0;
    for (int k = 0; k < moving.m; ++k) {
      const bool pair = rates_[k].imag() > 0;
      note(step, k, pair, step.length * rates_[k], 0);
      k += pair;
    }
  }
  return outgrown_ ? infinity : sum_of_errors(step, moving);
}

/// Notes a mode if it rings, with z within `radius`. \returns false if that is not to be told so.
bool Oscillations::note(const Step& step, int mode, bool pair, Complex z, double radius) {
  constexpr double notably = 0.05;
  if (pair && z.real() - radius > notably * std::abs(z.imag())) {
    longest_step_ = std::min(longest_step_, step.length * step.followed / std::abs(z));
    outgrown_ = outgrown_ || std::abs(z) - radius > step.followed;
  }
  const double least = RadauTableau::size_below(0.1 * tolerance_ / step.size);
  if (std::abs(z) + radius < least || std::abs(z.real()) - std::abs(z.imag()) > std::sqrt(2) * radius) return true;
  if (!pair || !(radius < 0.1 * std::abs(z))) return false;
  ringing_.push_back({mode, z});
  return true;
}

/// True if the modes of an earlier step tell what rings. In their vectors J is nearly diagonal, and each rate is within
/// the sum of its row's other entries from the diagonal (Gershgorin): as long as no rate that may lie where κ matters
/// is surrounded by a tenth of its size, or is one of those that did not ring, they serve.
bool Oscillations::known_serve(const Step& step, const Moving& moving) {
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
    if (!note(step, k, pair, z, radius)) return false;
    k = last;
  }
  return true;
}

/// The modes from the answers of the filter that the embedded estimate has passed: (γM/h − J)⁻¹ M r = r h/(γ − z) where
/// J r = λ M r and z = hλ. That keeps the digits of slow modes beside those of a stuck contact, which J does not.
/// \returns false where there are none to be had.
bool Oscillations::find(const Step& step, const Moving& moving) {
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
    const int first = pairs.values[k].imag() > 0 ? k : k - 1;  // Eigen puts it before its conjugate
    rates_.push_back(tableau_.gamma / step.length - 1.0 / pairs.values[pair ? first : k]);
    for (int i = 0; i < m; ++i) {
      const auto part = pairs.vectors(i, pair ? first : k) * size(i);
      vectors(i, k) = pair && first != k ? part.imag() : part.real();
    }
  }
  modes_.assign(vectors.data(), vectors.data() + m * m);
  // The inverse by way of scales, in which the vectors are of one size.
  for (int i = 0; i < m; ++i) vectors.row(i) /= size(i);
  SmallMatrix<double> inverse = vectors.inverse();
  for (int i = 0; i < m; ++i) inverse.col(i) /= size(i);
  inverse_.assign(inverse.data(), inverse.data() + m * m);
  return true;
}

/// Of all modes that ring, in scales. What a step passes over of them is noted for each unknown.
double Oscillations::sum_of_errors(const Step& step, const Moving& moving) {
  const int m = moving.m, a = moving.a, n = m + a;
  const Modes vectors(modes_.data(), m, m), inverse(inverse_.data(), m, m);
  std::array<double, most_small_rows * most_small_rows> noise;
  double sum = 0;
  bool heard = false;
  for (const auto& [k, z] : ringing_) {
    const double kappa = tableau_.error_over_estimate(z);
    if (!(kappa * step.size > 0.1 * tolerance_)) continue;
    if (!heard) {
      // Beside the estimate the estimates of what rounding leaves of forces that balance, which rings at every start.
      std::fill_n(noise.begin(), n * n, 0.0);
      for (int i = 0; i < n; ++i) noise[i * n + i] = last_digits_of_terms(&step.jacobian[i * n], step.y.data(), n);
      solve_lu(step.filter, step.pivot, n, noise.data(), n);
      heard = true;
    }
    const auto part = [&, k = k](const double* source, int stride) {  // in the pair of modes
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
    constexpr double part_of_turn = 3;  // longer steps damp it e-fold within five thousand turns
    const bool passed_over = std::abs(z) > part_of_turn;
    double square = 0;  // of the vector, in scales
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
