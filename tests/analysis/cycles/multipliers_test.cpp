/// Multipliers lie within their errors of those of the variational equations, integrated by CVODE on their own.
#include "analysis/cycles/multipliers.hpp"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/cycle_search.hpp"
#include "analysis/steady/stability.hpp"
#include "analysis/studies/stress.hpp"
#include "core/eigenpairs.hpp"
#include "solvers/steps/cvode.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::cycles;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using oscillators::SliderSystem;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

namespace {

/// ẏ = f(y), Ṡ = J(y) S of the unknowns of a slider that have a mass; the others follow by Newton's method. Its own
/// Jacobian lacks what S changes by through y, which only slows down CVODE's iteration.
class Variation final : public System {
 public:
  explicit Variation(const SliderSystem& slider) : slider_(slider), whole_(slider.steady(0)) {
    std::vector<double> mass(whole_.size());
    slider.mass(0, mass.data());
    for (int i = 0; i < int(mass.size()); ++i) (mass[std::size_t(i)] > 0 ? moving_ : following_).push_back(i);
    mass_.resize(Eigen::Index(moving_.size()));
    for (int i = 0; i < mass_.size(); ++i) mass_[i] = mass[std::size_t(moving_[std::size_t(i)])];
  }
  int moving() const { return int(moving_.size()); }
  int size() const override { return moving() * (1 + moving()); }
  void mass(double, double* m) const override { std::fill(m, m + size(), 1.0); }
  void evaluate(double t, const double* y, double* f) const override { rates(t, y, f); }
  void linearise(double t, const double* y, double* f, double* jacobian) const override {
    const MatrixXd A = rates(t, y, f);
    const int n = moving(), all = size();
    Eigen::Map<RowMajor> J(jacobian, all, all);
    J.setZero();
    J.topLeftCorner(n, n) = A;
    for (int c = 0; c < n; ++c) J.block(n * (1 + c), n * (1 + c), n, n) = A;
  }
  void scale(const double* y, double* s) const override {
    std::vector<double> of_slider(whole_.size());
    slider_.scale(whole(0, y).data(), of_slider.data());
    const int n = moving();
    for (int i = 0; i < n; ++i) s[i] = of_slider[std::size_t(moving_[std::size_t(i)])];
    for (int c = 0; c < n; ++c) {
      double size = 1e-6;  // of the column, in scales
      for (int i = 0; i < n; ++i) size = std::max(size, std::abs(y[n * (1 + c) + i]) / s[i] * s[c]);
      for (int i = 0; i < n; ++i) s[n * (1 + c) + i] = size * s[i] / s[c];
    }
  }
  std::string unknown(int i) const override { return std::to_string(i); }

  /// All unknowns of the slider.
  const std::vector<double>& whole(double t, const double* y) const {
    for (int i = 0; i < moving(); ++i) whole_[std::size_t(moving_[std::size_t(i)])] = y[i];
    if (following_.empty()) return whole_;
    std::vector<double> f(whole_.size());
    RowMajor J(whole_.size(), whole_.size());
    for (int k = 0; k < 50; ++k) {
      slider_.linearise(t, whole_.data(), f.data(), J.data());
      const VectorXd defect = Eigen::Map<VectorXd>(f.data(), Eigen::Index(f.size()))(following_);
      const VectorXd step = MatrixXd(J(following_, following_)).partialPivLu().solve(defect);
      double largest = 0;
      for (int i = 0; i < step.size(); ++i) {
        double& unknown = whole_[std::size_t(following_[std::size_t(i)])];
        unknown -= step[i];
        largest = std::max(largest, std::abs(step[i]) / std::max(1e-300, std::abs(unknown)));
      }
      if (!(largest > 1e-15)) break;
    }
    return whole_;
  }
  /// D of the return to the section that y, after one or several turns, has come to.
  MatrixXd returned(double t, const double* y) const {
    const int n = moving();
    std::vector<double> rate(static_cast<std::size_t>(size())), gradient(whole_.size());
    const MatrixXd A = rates(t, y, rate.data());
    slider_.slip_rate_gradient(t, whole_.data(), gradient.data());
    const VectorXd all = Eigen::Map<VectorXd>(gradient.data(), Eigen::Index(gradient.size()));
    VectorXd along = all(moving_);
    if (!following_.empty()) along += follow_.transpose() * all(following_);
    const Eigen::Map<const MatrixXd> S(y + n, n, n);
    const Eigen::Map<const VectorXd> f(rate.data(), n);
    return S - f * (along.transpose() * S) / along.dot(f);
  }

 private:
  /// Fills the rates. \returns ∂ẏ/∂y.
  MatrixXd rates(double t, const double* y, double* out) const {
    const int n = moving();
    whole(t, y);
    std::vector<double> f(whole_.size());
    RowMajor J(whole_.size(), whole_.size());
    slider_.linearise(t, whole_.data(), f.data(), J.data());
    MatrixXd A = J(moving_, moving_);
    if (!following_.empty()) {
      follow_ = -MatrixXd(J(following_, following_)).partialPivLu().solve(MatrixXd(J(following_, moving_)));
      A += J(moving_, following_) * follow_;
    }
    A = mass_.cwiseInverse().asDiagonal() * A;
    for (int i = 0; i < n; ++i) out[i] = f[std::size_t(moving_[std::size_t(i)])] / mass_[i];
    Eigen::Map<MatrixXd>(out + n, n, n) = A * Eigen::Map<const MatrixXd>(y + n, n, n);
    return A;
  }

  const SliderSystem& slider_;
  mutable std::vector<double> whole_;
  mutable MatrixXd follow_;
  std::vector<int> moving_, following_;
  VectorXd mass_;
};

struct CvodeMultipliers {
  std::vector<std::complex<double>> values;
  double rounding = 0;  ///< what the derivative makes of a disturbance along the motion, which should be 0
};
/// Multipliers of the motion from y on the section; none where CVODE does not come round.
CvodeMultipliers by_cvode(const ReturnMap& map, const std::vector<double>& y, int turns, double amplitude,
                          double tolerance) {
  const auto& slider = map.system();
  const Variation variation(slider);
  const int n = variation.moving();
  std::vector<double> start(std::size_t(variation.size()), 0.0);
  for (int i = 0; i < n; ++i) {
    start[std::size_t(i)] = y[std::size_t(map.differential()[std::size_t(i)])];
    start[std::size_t(n * (1 + i) + i)] = 1;
  }
  const double V = map.drive_speed();
  const auto relative = [&](double t, const double* at) {
    return slider.contact_slip_rate(t, variation.whole(t, at).data()) / V;
  };
  solvers::steps::Cvode solver(variation, tolerance, 2, [&](double t, const double* at, double* values) {
    const double v = relative(t, at);
    values[0] = v - 1, values[1] = v;
  });
  solver.start(0, start);
  bool below = false;
  for (long steps = 0; steps < 200'000; ++steps) {
    if (!solver.step(map.longest_return()).complete()) return {};
    const auto& roots = solver.root_found();
    if (relative(solver.time(), solver.state().data()) < 1 - dip_of(amplitude)) below = true;
    if (roots.empty()) continue;
    if (roots[0] > 0 && below) {
      below = false;
      if (--turns == 0) {
        VectorXd scale(n);
        for (int i = 0; i < n; ++i) scale[i] = map.scale()[i];
        const MatrixXd D = variation.returned(solver.time(), solver.state().data());
        std::vector<double> rate(start.size());
        variation.evaluate(0, start.data(), rate.data());
        const VectorXd along = Eigen::Map<const VectorXd>(rate.data(), n);
        return {multipliers_of(D, scale), (D * along).cwiseQuotient(scale).norm() / along.cwiseQuotient(scale).norm()};
      }
    }
    if (roots[1] != 0) {  // slip reverses: a kink
      const auto here = solver.state();
      solver.start(solver.time(), here);
    }
  }
  return {};
}

struct Compared {
  int cycles = 0, multipliers = 0, outside = 0, left_out = 0;
};

/// The multipliers of a scene's cycle, if it has one that a smooth law makes, beside those of CVODE at two tolerances.
void compare(const Model& model, Compared& compared) {
  const auto cycle = find_cycle(model, {.tolerance = 1e-8});
  if (!(cycle.metrics.period > 0) || cycle.growth) return;
  if (cycle.multipliers.empty()) {
    CHECK(!cycle.multipliers_left_out.empty());
    ++compared.left_out;
    return;
  }
  REQUIRE(cycle.multipliers.size() == cycle.multiplier_errors.size());
  ReturnMap map(model);
  const auto leading = steady::stability(model).eigenvalues.front();
  const double turn = 2 * M_PI / std::max(std::abs(leading.imag()), std::abs(leading.real()));
  const auto search = search_cycle(map, leading.real() * turn, {.tolerance = 1e-8});
  if (!search.point || search.point->swing || search.point->free) return;
  auto y = search.point->y;
  const int turns = search.point->returns, n = int(map.scale().size());
  const VectorXd scale = map.scale();
  for (int k = 0; k < 8; ++k) {  // Newton's method
    const auto passage =
        map.follow(y, 1e-12, turns, true, Derivative::of_steps, nullptr, dip_of(search.point->amplitude));
    if (!passage.outcome.complete()) return;
    if (std::abs(passage.duration / cycle.metrics.period - 1) > 1e-6) return;  // several periods are found to be one
    const VectorXd change = map.difference(passage.end, y).cwiseQuotient(scale);
    const MatrixXd D = scale.cwiseInverse().asDiagonal() * passage.derivative * scale.asDiagonal();
    y = map.moved(y, scale.asDiagonal() * (MatrixXd::Identity(n, n) - D).partialPivLu().solve(change), 1);
    if (change.norm() < 1e-13) break;
  }
  const auto loose = by_cvode(map, y, turns, search.point->amplitude, 1e-11);
  const auto tight = by_cvode(map, y, turns, search.point->amplitude, 1e-12);
  if (tight.values.empty() || loose.values.size() != tight.values.size()) return;
  ++compared.cycles;
  for (std::size_t i = 0; i < cycle.multipliers.size(); ++i) {
    double nearest = infinity, own = 0;
    for (std::size_t j = 0; j < tight.values.size(); ++j)
      if (const double apart = std::abs(tight.values[j] - cycle.multipliers[i]); apart < nearest)
        nearest = apart, own = std::abs(loose.values[j] - tight.values[j]);
    // What two tolerances of CVODE differ by is all that is known of its error, and no bound of it: errors of formulas
    // of changing order scatter, and S grows along the motion by up to 10⁶ before that is taken out.
    own = 10 * (own + tight.rounding) + 1e-7;
    if (!(own < 1e-3)) continue;
    ++compared.multipliers;
    INFO("multiplier " << i << ": " << cycle.multipliers[i] << " ± " << cycle.multiplier_errors[i] << ", CVODE within "
                       << nearest << ", by itself known to " << own);
    CHECK(nearest <= cycle.multiplier_errors[i] + own);
    compared.outside += nearest > cycle.multiplier_errors[i] + own;
  }
}

}  // namespace

TEST_CASE("a multiplier of bristles that just reverse is that of the variational equations", "[multipliers]") {
  const auto model =
      tests::slider_under("lugre",
                          {401170.38124886533, 6.810307413630398, 0.036963304477857756, 0.42712097605584687,
                           0.3276648745428342, 0.09174892242259831},
                          {.mass = 6.208576509084944, .stiffness = 153.64433622226105, .damping = 0.6177095163985994},
                          0.006380598415366001, 6.724265094950062);
  // Integrated with a mantissa of 64 bits, steps ending at every reversal.
  constexpr double reference = -0.190520705;
  for (const double tolerance : {1e-6, 1e-8, 1e-11}) {
    const auto cycle = find_cycle(model, {.tolerance = tolerance});
    REQUIRE(cycle.multipliers.size() == cycle.multiplier_errors.size());
    REQUIRE(!cycle.multipliers.empty());
    CHECK(std::abs(cycle.multipliers[0] - reference) <= cycle.multiplier_errors[0]);
    CHECK(cycle.multiplier_errors[0] < 1e-3);
  }
}

namespace {

/// So many random cycles of one seed.
void compare_random_cycles(int cycles) {
  Compared compared;
  const auto catalogue = laws::catalogue();
  for (long index = 0; compared.cycles < cycles && index < 20'000; ++index) {
    auto scene = studies::draw_scene(catalogue, 36, index);
    if (scene.law->set_valued() || scene.question != studies::Question::cycle) continue;
    try {
      const auto model = studies::model_of(scene);
      INFO("scene " << index << " of seed 36: " << scene.law->card().name);
      compare(model, compared);
    } catch (const InputError&) {
    }
  }
  WARN(compared.cycles << " cycles, " << compared.multipliers << " multipliers, " << compared.outside
                       << " outside their errors; none known of " << compared.left_out << " cycles");
  CHECK(compared.cycles == cycles);
}

}  // namespace

TEST_CASE("multipliers of random cycles are within their errors of CVODE's", "[multipliers][long]") {
  compare_random_cycles(10);
}

TEST_CASE("multipliers of 200 random cycles are within their errors of CVODE's", "[.][multipliers-200]") {
  compare_random_cycles(200);  // minutes
}
