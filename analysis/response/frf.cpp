/// Linear response of a contact from its derivatives: dense complex solves of at most sixteen unknowns.
#include "analysis/response/frf.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/response/contact_slopes.hpp"
#include "core/characteristic.hpp"
#include "core/error.hpp"
#include "core/stop.hpp"
#include "core/tower.hpp"

namespace rosin::analysis::response {

using Complex = std::complex<double>;

namespace {

constexpr int most = Slopes<double>::capacity;
using SmallMatrix = Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, most, most>;
using SmallVector = Eigen::Matrix<Complex, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;

Complex at_frequency(double hertz) { return {0, 2 * std::numbers::pi * hertz}; }

std::vector<FrictionResponse::Root> roots(const std::vector<double>& J, const std::vector<double>& mass) {
  std::vector<FrictionResponse::Root> list;
  const auto found = characteristic_roots(J, mass);
  for (std::size_t i = 0; i < found.values.size(); ++i)
    if (std::isfinite(found.values[i].real())) list.push_back({found.values[i], found.errors[i]});
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
    return std::abs(a.value) != std::abs(b.value) ? std::abs(a.value) < std::abs(b.value)
                                                  : a.value.imag() > b.value.imag();
  });
  return list;
}

}  // namespace

FrictionResponse::FrictionResponse(const Model& model) : setup_(imposed_contact_setup(model)) {
  slip_rate_ = model.drive.speed.level();
  normal_load_ = model.drive.normal_load.level();
  if (slip_rate_ == 0) throw InputError("drive.speed = 0: friction responds linearly only about steady sliding (m/s)");
  if (!(normal_load_ > 0))
    throw InputError(fmt::format("drive.normal_load = {}: a contact without load has no response (N)", normal_load_));
  direction_ = slip_rate_ < 0 ? -1 : 1;
  const auto contact = model.law->contact(setup_);
  tower_ = model.law->tower(setup_);
  const int n = contact->unknowns();

  steady_.resize(std::size_t(n));
  double z[most], weight[most], g[most], F;
  contact->steady(0, model.law->set_valued() ? std::abs(slip_rate_) : slip_rate_, normal_load_, z, weight);
  std::copy(z, z + n, steady_.begin());
  Slopes<double> slopes;
  contact->linearise(input(), z, g, F, slopes);
  friction_ = F;

  auto& l = linear_;
  const auto count = std::size_t(n);
  l.mass.resize(count);
  contact->mass(normal_load_, l.mass.data());
  l.A.assign(slopes.g_z, slopes.g_z + count * count);
  l.b_v.assign(slopes.g_u, slopes.g_u + count);
  l.b_N.assign(slopes.g_N, slopes.g_N + count);
  l.c.assign(slopes.F_z, slopes.F_z + count);
  l.d_v = slopes.F_u, l.d_N = slopes.F_N;
  // The rate of load enters contacts as it is, to the first power: a difference is exact.
  double up[most] = {}, down[most] = {}, F_up, F_down;
  contact->evaluate({slip_rate_, normal_load_, normal_load_, direction_}, z, up, F_up);
  contact->evaluate({slip_rate_, normal_load_, -normal_load_, direction_}, z, down, F_down);
  l.b_R.resize(count);
  for (std::size_t i = 0; i < count; ++i) l.b_R[i] = (up[i] - down[i]) / (2 * normal_load_);
  l.d_R = (F_up - F_down) / (2 * normal_load_);

  bool finite = std::isfinite(friction_) && std::isfinite(l.d_v) && std::isfinite(l.d_N) && std::isfinite(l.d_R);
  for (const auto* list : {&l.mass, &l.A, &l.b_v, &l.b_N, &l.b_R, &l.c})
    for (const double x : *list) finite = finite && std::isfinite(x);
  if (!finite)
    throw InputError(fmt::format(
        "steady sliding at drive.speed = {} m/s cannot be linearised: its derivatives are not finite", slip_rate_));
}

namespace {
/// s M − A, each row, which has units of its own, divided by its size.
struct ScaledPencil {
  Eigen::PartialPivLU<SmallMatrix> lu;
  SmallVector size;
};
ScaledPencil pencil(const FrictionResponse::Linear& linear, Complex s) {
  const int n = linear.size();
  SmallMatrix K(n, n);
  SmallVector sizes(n);
  for (int i = 0; i < n; ++i) {
    double size = 0;
    for (int j = 0; j < n; ++j) {
      K(i, j) = (i == j ? s * linear.mass[std::size_t(i)] : Complex(0)) - linear.A[std::size_t(i * n + j)];
      size = std::max(size, std::abs(K(i, j)));
    }
    sizes[i] = size > 0 ? size : 1;
    K.row(i) /= sizes[i];
  }
  return {K.partialPivLu(), sizes};
}
SmallVector divided(const std::vector<Complex>& b, const SmallVector& size) {
  return Eigen::Map<const SmallVector>(b.data(), Eigen::Index(b.size())).cwiseQuotient(size);
}
std::vector<Complex> list(const SmallVector& x) { return {x.data(), x.data() + x.size()}; }
}  // namespace

std::vector<Complex> FrictionResponse::solve(Complex s, const std::vector<Complex>& b) const {
  const auto K = pencil(linear_, s);
  return list(K.lu.solve(divided(b, K.size)));
}

FrictionResponse::Passage FrictionResponse::passage(Complex s) const {
  const auto K = pencil(linear_, s);
  const std::vector<Complex> b(linear_.b_v.begin(), linear_.b_v.end()), c(linear_.c.begin(), linear_.c.end());
  const SmallVector weight = K.lu.transpose().solve(Eigen::Map<const SmallVector>(c.data(), Eigen::Index(c.size())));
  Passage passage{s, list(K.lu.solve(divided(b, K.size))), list(weight.cwiseQuotient(K.size)), linear_.d_v};
  for (std::size_t i = 0; i < c.size(); ++i) passage.force += c[i] * passage.answer[i];
  return passage;
}

Complex FrictionResponse::tangential(Complex s) const {
  Complex Z = linear_.d_v;
  const auto x = solve(s, {linear_.b_v.begin(), linear_.b_v.end()});
  for (std::size_t i = 0; i < x.size(); ++i) Z += linear_.c[i] * x[i];
  return Z;
}

Complex FrictionResponse::normal(Complex s) const {
  std::vector<Complex> b(linear_.b_N.size());
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = linear_.b_N[i] + s * linear_.b_R[i];
  Complex answer = linear_.d_N + s * linear_.d_R;
  const auto x = solve(s, b);
  for (std::size_t i = 0; i < x.size(); ++i) answer += linear_.c[i] * x[i];
  return answer;
}

ResponseMatrix response_matrix(Complex s, Complex by_slip_rate, Complex by_load,
                               const std::optional<NormalContact>& contact) {
  if (!contact) return {by_slip_rate, by_load, 0, 1};
  const Complex approach = contact->stiffness / s + contact->damping;
  return {by_slip_rate + by_load * contact->lift, by_load * approach, contact->lift, approach};
}

ResponseMatrix FrictionResponse::matrix(Complex s, const std::optional<NormalContact>& contact) const {
  return response_matrix(s, tangential(s), normal(s), contact);
}

Complex FrictionResponse::tangential(Complex s, const Rig& rig) const { return tangential(s) + rig.sensor_mass * s; }

ResponseMatrix FrictionResponse::matrix(Complex s, const Rig& rig) const {
  auto seen = matrix(s, rig.normal);
  seen.tt += rig.sensor_mass * s;
  return seen;
}

FrictionResponse::Limits FrictionResponse::limits() const {
  // Unknowns with mass do not follow at high frequency, those without always do: Z → D₀ + D₁/s.
  const auto& l = linear_;
  std::vector<int> slow, fast;
  for (int i = 0; i < l.size(); ++i) (l.mass[std::size_t(i)] > 0 ? slow : fast).push_back(i);
  using Real = Eigen::MatrixXd;
  const int n = l.size();
  const auto A =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(l.A.data(), n, n);
  const auto b = Eigen::Map<const Eigen::VectorXd>(l.b_v.data(), n),
             c = Eigen::Map<const Eigen::VectorXd>(l.c.data(), n);
  Real b_slow = b(slow), c_slow = c(slow).transpose();
  Limits limits{tangential(0).real(), l.d_v, 0};
  double size = std::abs(l.d_v);
  if (!fast.empty()) {
    const auto lu = Real(A(fast, fast)).partialPivLu();
    const Real answer = lu.solve(Real(b(fast))), followed = lu.solve(Real(A(fast, slow)));
    const double by_fast = (c(fast).transpose() * answer)(0);
    limits.high -= by_fast;
    size = std::max(size, std::abs(by_fast));
    b_slow -= A(slow, fast) * answer;
    c_slow -= c(fast).transpose() * followed;
  }
  if (std::abs(limits.high) <= 1e-14 * size) limits.high = 0;
  if (limits.high == 0)
    for (std::size_t i = 0; i < slow.size(); ++i)
      limits.stiffness += c_slow(0, Eigen::Index(i)) * b_slow(Eigen::Index(i), 0) / l.mass[std::size_t(slow[i])];
  return limits;
}

std::vector<FrictionResponse::Root> FrictionResponse::poles() const {
  return linear_.size() == 0 ? std::vector<Root>() : roots(linear_.A, linear_.mass);
}

std::vector<FrictionResponse::Root> FrictionResponse::zeros() const {
  // det(s M − A)·Z is the determinant of the bordered pencil.
  const std::size_t n = linear_.mass.size();
  if (n == 0) return {};
  std::vector<double> bordered, mass = linear_.mass;
  for (std::size_t i = 0; i < n; ++i) {
    bordered.insert(bordered.end(), linear_.A.begin() + std::ptrdiff_t(i * n),
                    linear_.A.begin() + std::ptrdiff_t((i + 1) * n));
    bordered.push_back(linear_.b_v[i]);
  }
  bordered.insert(bordered.end(), linear_.c.begin(), linear_.c.end());
  bordered.push_back(linear_.d_v);
  mass.push_back(0);
  return roots(bordered, mass);
}

double FrictionResponse::amplitude_of_harmonic(double omega, double share) const {
  // v = V + Re(ε e^{iωt}) and z = z₀ + Re(ε ζ e^{iωt}): the second derivative of g and F along D = (1, ζ), bilinear
  // in D, drives ¼ Q(D, D) ε² at 2ω.
  const int n = linear_.size();
  const auto first = solve({0, omega}, {linear_.b_v.begin(), linear_.b_v.end()});
  const auto curvature = [&](double v, const std::vector<double>& z) {
    Tower unknown[most], g[most], F;
    for (int i = 0; i < n; ++i) unknown[i] = along(steady_[std::size_t(i)], z[std::size_t(i)]);
    tower_->evaluate({along(slip_rate_, v), Tower(normal_load_), Tower(0.0), Tower(direction_)}, unknown, g, F);
    std::vector<double> Q(std::size_t(n) + 1);
    for (int i = 0; i < n; ++i) Q[std::size_t(i)] = g[i].slope[0].slope[0].value;
    Q.back() = F.slope[0].slope[0].value;
    return Q;
  };
  std::vector<double> real, imaginary, sum, difference;
  for (const auto& x : first) {
    real.push_back(x.real());
    imaginary.push_back(x.imag());
    sum.push_back(x.real() + x.imag());
    difference.push_back(x.real() - x.imag());
  }
  const auto rr = curvature(1, real), ii = curvature(0, imaginary);
  const auto plus = curvature(1, sum), minus = curvature(1, difference);
  std::vector<Complex> Q(rr.size());
  for (std::size_t i = 0; i < Q.size(); ++i) Q[i] = Complex(rr[i] - ii[i], (plus[i] - minus[i]) / 2) / 4.0;
  Complex second = Q.back();
  Q.pop_back();
  const auto z = solve({0, 2 * omega}, Q);
  Complex Z = linear_.d_v;
  for (std::size_t i = 0; i < z.size(); ++i) {
    second += linear_.c[i] * z[i];
    Z += linear_.c[i] * first[i];
  }
  return second == 0.0 ? infinity : share * std::abs(Z) / std::abs(second);
}

namespace {

FrfCurve predict_curve(const Model& model, const FrfOptions& options) {
  const FrictionResponse response(model);
  FrfCurve curve;
  curve.slip_rate = response.slip_rate();
  curve.normal_load = response.normal_load();
  curve.friction_coefficient = response.friction_coefficient();
  curve.limits = response.limits();
  curve.poles = response.poles();
  curve.zeros = response.zeros();
  constexpr double share = 0.01;
  for (const double f : options.frequencies) {
    end_if_stopped();
    const auto s = at_frequency(f);
    curve.tangential.push_back(response.tangential(s, options.rig));
    curve.linear_amplitude.push_back(response.amplitude_of_harmonic(s.imag(), share));
    if (options.rig.matrix) curve.matrix.push_back(response.matrix(s, options.rig));
  }
  return curve;
}

}  // namespace

std::vector<FrfSensitivity> frf_sensitivities(const Model& model, const std::vector<std::string>& parameters,
                                              const std::vector<double>& frequencies) {
  const FrictionResponse response(model);
  std::vector<FrictionResponse::Passage> passages;
  for (const double f : frequencies) passages.push_back(response.passage(at_frequency(f)));
  std::vector<FrfSensitivity> results;
  for (const auto& parameter : parameters) {
    FrfSensitivity result{parameter, "N s/m per " + readable_unit(model.describe(parameter).unit), {}, {}};
    const ResponseSlope slope(response, model, parameter);
    for (const auto& passage : passages) {
      const auto answer = slope(passage);
      result.slope.push_back(answer.slope);
      result.error.push_back(answer.error);
    }
    results.push_back(std::move(result));
  }
  return results;
}

FrfPrediction predict_frf(const Model& model, const FrfOptions& options) {
  FrfPrediction prediction;
  prediction.curve = predict_curve(model, options);
  if (!options.sensitivities.empty())
    prediction.sensitivities = frf_sensitivities(model, options.sensitivities, options.frequencies);
  for (const double value : options.family_values) {
    prediction.family.push_back(predict_curve(model.with(options.family, value), options));
    prediction.family.back().value = value;
  }
  if (options.family == "drive.normal_load" && prediction.family.size() > 1)
    for (std::size_t k = 0; k < options.frequencies.size(); ++k) {
      end_if_stopped();
      double x = 0, y = 0, xx = 0, xy = 0;
      const double count = double(prediction.family.size());
      for (const auto& member : prediction.family) {
        const double ln_N = std::log(member.value), ln_Z = std::log(std::abs(member.tangential[k]));
        x += ln_N, y += ln_Z, xx += ln_N * ln_N, xy += ln_N * ln_Z;
      }
      prediction.load_exponent.push_back((xy - x * y / count) / (xx - x * x / count));
    }
  return prediction;
}

}  // namespace rosin::analysis::response
