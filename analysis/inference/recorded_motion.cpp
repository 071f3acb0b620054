/// Kalman filter and smoother of displacement, slip rate and acceleration; corners by the size of the jump that each
/// time wants.
#include "analysis/inference/recorded_motion.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "core/random.hpp"

namespace rosin::analysis::inference {

namespace {

using Matrix = Eigen::Matrix3d;
using Vector = Eigen::Vector3d;

/// Displacement, slip rate and acceleration at times counted in median spacings, with noise of unit size.
class Smoother {
 public:
  Smoother(const std::vector<double>& time, const std::vector<double>& displacement)
      : x_(displacement), corner_(time.size(), 0) {
    std::vector<double> spans;
    for (std::size_t i = 1; i < time.size(); ++i) spans.push_back(time[i] - time[i - 1]);
    const auto middle = spans.begin() + std::ptrdiff_t(spans.size() / 2);
    auto sorted = spans;
    std::nth_element(sorted.begin(), sorted.begin() + (middle - spans.begin()), sorted.end());
    unit_ = sorted[std::size_t(middle - spans.begin())];
    for (const double span : spans) span_.push_back(span / unit_);
    double largest = 0;
    for (const double x : x_) largest = std::max(largest, std::abs(x));
    rounding_ = std::max(1e-16 * largest, std::numeric_limits<double>::min());
  }
  double unit() const { return unit_; }
  std::vector<char>& corner() { return corner_; }

  /// Twice the negative logarithm of the likelihood, without constants; sets the noise.
  double filter(double roughness) {
    const auto n = x_.size();
    mean_.resize(n), covariance_.resize(n), innovation_.resize(n), variance_.resize(n);
    // Through the first three, known to some thousand times the noise, or what jerk makes between samples.
    const double d = span_[0], e = span_[1], first = (x_[1] - x_[0]) / d, second = (x_[2] - x_[1]) / e,
                 a = 2 * (second - first) / (d + e);
    Vector state(x_[0], first - a * d / 2, a);
    constexpr double unknown = 1e7;
    Matrix P = Matrix::Identity() * unknown * std::max(1.0, roughness);
    double logarithms = 0, squares = 0;
    constexpr std::size_t begin = 3;
    for (std::size_t i = 0; i < n; ++i) {
      if (i > 0) {
        const auto A = transition(i - 1);
        state = A * state;
        P = A * P * A.transpose() + growth(i - 1, roughness);
      }
      mean_[i] = state, covariance_[i] = P;
      variance_[i] = P(0, 0) + 1, innovation_[i] = x_[i] - state[0];
      const Vector gain = P.col(0) / variance_[i];
      state += gain * innovation_[i];
      Matrix rest = Matrix::Identity();
      rest.col(0) -= gain;
      P = rest * P * rest.transpose() + gain * gain.transpose();
      if (i < begin) continue;
      logarithms += std::log(variance_[i]);
      squares += innovation_[i] * innovation_[i] / variance_[i];
    }
    const double count = double(n - begin);
    noise_ = std::max(rounding_, std::sqrt(squares / count));
    return logarithms + 2 * count * std::log(noise_);
  }
  double noise() const { return noise_; }

  /// A draw of the error of the motion found, in units of the noise: that of one made at random.
  struct Error {
    std::vector<double> displacement, slip_rate;
  };
  Error draw(double roughness, std::uint64_t seed) {
    const auto n = x_.size();
    const auto normal = white_noise(4 * n, seed);
    Error error{std::vector<double>(n), std::vector<double>(n)};
    std::vector<double> recorded(n);
    Vector state = Vector::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const double* random = &normal[4 * i];
      if (i > 0) {
        const double d = span_[i - 1], size = std::sqrt(roughness * d);
        // The triangle whose square is that of white jerk over a span.
        state = transition(i - 1) * state +
                size * Vector(d * d / std::sqrt(20.0) * random[0],
                              d * (std::sqrt(20.0) / 8 * random[0] + std::sqrt(1.0 / 48) * random[1]),
                              std::sqrt(20.0) / 6 * random[0] + std::sqrt(48.0) / 12 * random[1] + random[2] / 3);
      }
      recorded[i] = state[0] + random[3];
      error.displacement[i] = state[0], error.slip_rate[i] = state[1];
    }
    x_ = std::move(recorded);
    filter(roughness);
    const auto found = smooth();
    for (std::size_t i = 0; i < n; ++i)
      error.displacement[i] -= found.displacement[i], error.slip_rate[i] -= found.slip_rate[i];
    return error;
  }

  /// What the times behind say to each: states, their variances, and the jumps of slip rate over their standard errors.
  struct Smooth {
    std::vector<double> displacement, slip_rate, error, jump;
  };
  Smooth smooth() const {
    const auto n = x_.size();
    Smooth found;
    for (auto* list : {&found.displacement, &found.slip_rate, &found.error, &found.jump}) list->resize(n);
    Vector r = Vector::Zero();
    Matrix N = Matrix::Zero();
    for (std::size_t i = n; i-- > 0;) {
      if (i + 1 < n) {
        const auto A = transition(i);
        r = A.transpose() * r;
        N = A.transpose() * N * A;
        found.jump[i] = N(1, 1) > 0 ? r[1] / (std::sqrt(N(1, 1)) * noise_) : 0;
      }
      // What the sample itself says.
      const Matrix& P = covariance_[i];
      const Vector gain = P.col(0) / variance_[i];
      Matrix L = Matrix::Identity();
      L.col(0) -= gain;
      r = L.transpose() * r;
      r[0] += innovation_[i] / variance_[i];
      N = L.transpose() * N * L;
      N(0, 0) += 1 / variance_[i];
      const Vector state = mean_[i] + P * r;
      found.displacement[i] = state[0], found.slip_rate[i] = state[1];
      found.error[i] = noise_ * std::sqrt(std::max(0.0, P(1, 1) - P.row(1) * N * P.col(1)));
    }
    return found;
  }

 private:
  Matrix transition(std::size_t i) const {
    const double d = span_[i];
    Matrix A;
    A << 1, d, d * d / 2, 0, 1, d, 0, 0, 1;
    return A;
  }
  /// Of the covariance, by white jerk and by a jump of the slip rate just behind the sample.
  Matrix growth(std::size_t i, double roughness) const {
    const double d = span_[i], q = roughness * d, d2 = d * d;
    Matrix Q;
    Q << q * d2 * d2 / 20, q * d2 * d / 8, q * d2 / 6, q * d2 * d / 8, q * d2 / 3, q * d / 2, q * d2 / 6, q * d / 2, q;
    if (corner_[i]) {
      constexpr double unknown = 1e7;
      const Vector jump(d, 1, 0);
      Q += unknown * std::max(1.0, roughness) * jump * jump.transpose();
    }
    return Q;
  }

  std::vector<double> x_;
  std::vector<char> corner_;
  std::vector<double> span_;
  double unit_ = 1, rounding_ = 0, noise_ = 0;
  std::vector<Vector> mean_;  ///< as each sample is foretold
  std::vector<Matrix> covariance_;
  std::vector<double> innovation_, variance_;
};

/// The roughness that maximises the likelihood.
double likeliest(Smoother& smoother) {
  const auto misfit = [&](double exponent) { return smoother.filter(std::pow(10, exponent)); };
  constexpr double from = -16, to = 6, step = 2;
  double best = from, least = std::numeric_limits<double>::infinity();
  for (double exponent = from; exponent <= to; exponent += step)
    if (const double here = misfit(exponent); here < least) least = here, best = exponent;
  constexpr int bits = 8;
  best = boost::math::tools::brent_find_minima(misfit, best - step, best + step, bits).first;
  return std::pow(10, best);
}

/// Marks the corners that a motion wants which has none there yet: the largest jumps of their surroundings.
bool mark_corners(const std::vector<double>& jump, std::vector<char>& corner) {
  constexpr double improbable = 5;
  constexpr std::ptrdiff_t about = 5;
  const auto n = std::ptrdiff_t(jump.size());
  bool any = false;
  for (std::ptrdiff_t i = 1; i + 1 < n; ++i) {
    if (corner[std::size_t(i)] || !(std::abs(jump[std::size_t(i)]) > improbable)) continue;
    bool largest = true;
    for (auto k = std::max<std::ptrdiff_t>(1, i - about); k <= std::min(n - 2, i + about) && largest; ++k)
      largest = corner[std::size_t(k)] || std::abs(jump[std::size_t(k)]) <= std::abs(jump[std::size_t(i)]);
    if (largest) corner[std::size_t(i)] = 1, any = true;
  }
  return any;
}

/// The smallest step between neighbours, if noise is what rounding to such steps makes; else 0.
double resolution_of(const std::vector<double>& x, double noise) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] != x[i - 1]) step = std::min(step, std::abs(x[i] - x[i - 1]));
  const double of_steps = step / std::sqrt(12.0);
  return noise > 0.5 * of_steps && noise < 1.5 * of_steps ? step : 0;
}

/// Behind a corner the slip rate changes evenly, else it is that before.
void set_slip_rate_behind(const std::vector<double>& time, RecordedMotion& motion) {
  const auto &x = motion.displacement, &v = motion.before;
  motion.after = v;
  for (std::size_t i = 0; i + 1 < time.size(); ++i)
    if (motion.corner[i]) motion.after[i] = 2 * (x[i + 1] - x[i]) / (time[i + 1] - time[i]) - v[i + 1];
}

/// Rest while neighbouring displacements are equal and the slip rate is 0 within its error: for two intervals, or one
/// between corners or ends of the record.
void rest_where_nothing_moves(const std::vector<double>& x, RecordedMotion& motion) {
  constexpr double none = 3;  // standard errors
  const auto n = x.size();
  const auto slow = [&](std::size_t i, double v) { return std::abs(v) <= none * motion.standard_error[i]; };
  const auto ends = [&](std::size_t i) { return i == 0 || i + 1 == n || motion.corner[i]; };
  for (std::size_t from = 0, to = 0; from + 1 < n; from = std::max(to, from + 1)) {
    for (to = from; to + 1 < n && x[to + 1] == x[from]; ++to)
      if (!slow(to, motion.after[to]) || !slow(to + 1, motion.before[to + 1])) break;
    if (to < from + 2 && !(to == from + 1 && ends(from) && ends(to))) continue;
    for (auto i = from; i < to; ++i) {
      motion.after[i] = motion.before[i + 1] = 0;
      motion.displacement[i + 1] = motion.displacement[i];
      if (!motion.corner[i]) motion.before[i] = 0;
    }
    if (!motion.corner[to]) motion.after[to] = 0;
  }
}

RecordedMotion motion_of(const std::vector<double>& time, const std::vector<double>& x, Smoother& smoother,
                         double roughness) {
  smoother.filter(roughness);
  auto smooth = smoother.smooth();
  RecordedMotion motion;
  motion.corner = smoother.corner(), motion.noise = smoother.noise(), motion.roughness = roughness;
  motion.resolution = resolution_of(x, motion.noise);
  for (double& v : smooth.slip_rate) v /= smoother.unit();
  for (double& error : smooth.error) error /= smoother.unit();
  motion.displacement = std::move(smooth.displacement), motion.standard_error = std::move(smooth.error);
  motion.before = std::move(smooth.slip_rate);
  set_slip_rate_behind(time, motion);
  rest_where_nothing_moves(x, motion);
  return motion;
}

}  // namespace

RecordedMotion recorded_motion(const std::vector<double>& time, const std::vector<double>& displacement) {
  Smoother smoother(time, displacement);
  constexpr int most_rounds = 20;
  double roughness = likeliest(smoother);
  for (int round = 0; round < most_rounds; ++round) {
    smoother.filter(roughness);
    if (!mark_corners(smoother.smooth().jump, smoother.corner())) break;
    roughness = likeliest(smoother);
  }
  return motion_of(time, displacement, smoother, roughness);
}

RecordedMotion recorded_again(const std::vector<double>& time, const RecordedMotion& motion, std::uint64_t seed) {
  Smoother smoother(time, motion.displacement);
  smoother.corner() = motion.corner;
  const auto error = smoother.draw(motion.roughness, seed);
  const auto n = time.size();
  auto again = motion;
  for (std::size_t i = 0; i < n; ++i) {
    again.displacement[i] += motion.noise * error.displacement[i];
    again.before[i] += motion.noise * error.slip_rate[i] / smoother.unit();
  }
  set_slip_rate_behind(time, again);
  for (std::size_t i = 0; i + 1 < n; ++i)  // what rests does in every draw
    if (motion.after[i] == 0 && motion.before[i + 1] == 0 && motion.displacement[i] == motion.displacement[i + 1]) {
      again.after[i] = again.before[i + 1] = 0;
      again.displacement[i + 1] = again.displacement[i];
    }
  return again;
}

}  // namespace rosin::analysis::inference
