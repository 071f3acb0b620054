/// Structures with friction: the single slider's critical load, and Nyquist against eigenvalues on random structures.
#include "analysis/response/structure.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/steady/stability.hpp"
#include "core/random.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::response;
using oscillators::Model;
using tests::any_slider;
using tests::bristol_board;
using tests::slider_under;
using Complex = std::complex<double>;

namespace {

/// Where a contact slips, and along what it is pressed.
struct Directions {
  std::vector<double> tangential, normal;
};
/// Matrices as lists of their rows.
Structure matrices(const std::vector<double>& M, const std::vector<double>& C, const std::vector<double>& K,
                   const std::vector<Directions>& contacts) {
  const auto n = Eigen::Index(contacts.front().tangential.size());
  const auto matrix = [&](const std::vector<double>& rows) -> Eigen::MatrixXd {
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(rows.data(), n, n);
  };
  Structure structure;
  structure.M = matrix(M), structure.C = matrix(C), structure.K = matrix(K);
  for (const auto& [tangential, normal] : contacts) {
    auto& contact = structure.contacts.emplace_back();
    contact.tangential = Eigen::Map<const Eigen::VectorXd>(tangential.data(), n);
    if (!normal.empty()) contact.normal = Eigen::Map<const Eigen::VectorXd>(normal.data(), n);
  }
  return structure;
}

const Structure single = matrices({1}, {0}, {1.09}, {{{1}, {}}});

}  // namespace

TEST_CASE("the single slider gives its critical load, rigid and behind a contact spring", "[structure]") {
  for (const auto& [stiffness, load] : {std::pair{infinity, 4.0877514056773e-4}, std::pair{0.5, 1.8372063200725e-4}}) {
    auto model = bristol_board(1e-4, 10);
    model.contact_stiffness.tangential = stiffness;
    const auto found = critical_values({.form = single, .model = model, .normal = {}}, "drive.normal_load", 1e-5, 1e-1);
    REQUIRE(found.size() == 1);
    CHECK(found.front().value == Approx(load).epsilon(1e-9));
    CHECK(found.front().angular_frequency == Approx(0.69102017882153).epsilon(1e-6));
    for (const double part : {0.98, 1.02}) {
      const auto loop = close_loop(single, model.with("drive.normal_load", part * load));
      CHECK(loop.stable == (part < 1));
      CHECK(loop.unstable_by_nyquist == (part < 1 ? 0 : 2));
    }
  }
}

TEST_CASE("eigenvalues are those of the slider", "[structure]") {
  for (const char* law : {"ageing", "spinodal", "two-state-slip", "lugre", "stribeck"}) {
    auto model =
        slider_under(law, laws::find_law(law)->values(), {.mass = 2, .stiffness = 300, .damping = 0.4}, 1e-3, 3);
    const auto expected = steady::stability(model).eigenvalues;
    const auto found = close_loop(matrices({2}, {0.4}, {300}, {{{1}, {}}}), model).eigenvalues;
    INFO(law);
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      CHECK(std::abs(found[i] - expected[i]) <= 1e-7 * std::abs(expected[i]));
  }
}

TEST_CASE("Nyquist and eigenvalues agree on 1000 random structures", "[structure][long]") {
  std::mt19937 random(7);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
  const auto decades = [&](double a, double b) { return std::pow(10, uniform(std::log10(a), std::log10(b))); };
  const std::vector<const char*> laws = {"ageing", "spinodal", "two-state-ageing", "lugre", "stribeck", "coulomb"};
  int stable = 0, unstable = 0, uncounted = 0;
  for (int k = 0; k < 1000; ++k) {
    const char* law = laws[std::size_t(k) % laws.size()];
    auto model = slider_under(law, laws::find_law(law)->values(), any_slider, decades(1e-6, 1e-2), decades(0.01, 100));
    const int n = 1 + k % 4, contacts = 1 + (k / 4) % 2;
    std::vector<double> M, C, K;
    std::vector<Directions> directions;
    std::vector<double> root(std::size_t(n) * n), stiff(root.size());
    for (auto* list : {&root, &stiff})
      for (double& x : *list) x = uniform(-1, 1);
    const double scale = decades(10, 1e5);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        double m = i == j ? 0.3 : 0, stiffness = i == j ? 0.3 : 0;
        for (int l = 0; l < n; ++l) {
          m += root[std::size_t(i * n + l)] * root[std::size_t(j * n + l)];
          stiffness += stiff[std::size_t(i * n + l)] * stiff[std::size_t(j * n + l)];
        }
        M.push_back(m), K.push_back(scale * stiffness);
      }
    const double loss = decades(1e-4, 1e-2) / std::sqrt(scale);
    for (const double x : K) C.push_back(loss * x);
    const bool pressed = k % 3 == 0;
    for (int c = 0; c < contacts; ++c) {
      Directions contact;
      for (int i = 0; i < n; ++i) contact.tangential.push_back(uniform(-1, 1));
      for (int i = 0; pressed && i < n; ++i) contact.normal.push_back(uniform(-1, 1));
      directions.push_back(contact);
    }
    const NormalContact normal{.stiffness = scale * decades(0.1, 3), .damping = 0, .lift = 0};
    const auto loop = close_loop(matrices(M, C, K, directions), model, normal);
    INFO(k << ": " << law << ", " << n << " coordinates, " << contacts << " contacts, pressed " << pressed);
    if (loop.unstable_by_nyquist < 0) {
      ++uncounted;
      CHECK(std::abs(loop.eigenvalues.front().real()) < 1e-6 * std::abs(loop.eigenvalues.front()));
      continue;
    }
    CHECK(loop.unstable_by_nyquist == loop.unstable_by_eigenvalues);
    (loop.stable ? stable : unstable)++;
  }
  CHECK(stable > 100);
  CHECK(unstable > 100);
  CHECK(uncounted < 10);
}

TEST_CASE("modes are matrices, and 1 + L is what the margin measures", "[structure]") {
  const double turn = 2 * std::numbers::pi;
  const auto s = modal({{100 / turn, 0.01, 0.5, 1.0}, {270 / turn, 0.02, 0.2, -0.6}});
  const Complex at(0, 130);
  const Complex H = 1.0 / (0.5 * (at * at + 2 * 0.01 * 100.0 * at + 1e4)) +
                    0.36 / (0.2 * (at * at + 2 * 0.02 * 270.0 * at + 270.0 * 270.0));
  CHECK(std::abs(receptance(s, at) - H) < 1e-13 * std::abs(H));
  const auto model = slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-3, 5);
  const FrictionResponse friction(model);
  const auto loop = close_loop(s, model);
  const Complex critical(0, loop.margin_frequency);
  CHECK(loop.margin ==
        Approx(std::abs(1.0 + critical * friction.tangential(critical) * receptance(s, critical))).epsilon(1e-9));
  // The same from tables that sample the loop densely.
  for (const double load : {0.5, 5.0, 500.0}) {
    const auto loaded = model.with("drive.normal_load", load);
    const FrictionResponse there(loaded);
    std::vector<double> hertz;
    std::vector<Complex> L;
    for (int i = 0; i <= 40000; ++i) {
      hertz.push_back(1e-2 * std::pow(10, i / 8000.0));
      const Complex jw(0, 2 * std::numbers::pi * hertz.back());
      L.push_back(jw * there.tangential(jw) * receptance(s, jw));
    }
    const auto table = close_table({hertz, L});
    const auto by_determinants = friction_loop(s, loaded, {}, hertz);
    for (std::size_t k = 0; k < L.size(); k += 1000)
      CHECK(std::abs(by_determinants[k] - L[k]) < 1e-11 * (1 + std::abs(L[k])));
    CHECK(table.resolved);
    CHECK(table.unstable == close_loop(s, loaded).unstable_by_eigenvalues);
  }
}

TEST_CASE("a measured response keeps the coupling of load and motion, and is scanned", "[structure]") {
  // Friction that no slip rate changes leaves mode coupling: growth of 292.4 1/s at 1137.7 Hz under μ = 0.4, from
  // μ = 0.336635733 on by the eigenvalues of M s² + C s + K + k_n (n nᵀ − μ t nᵀ).
  SlidingStructure sliding;
  sliding.form = matrices({1, 0, 0, 1}, {20, 0, 0, 30}, {5.2e7, 1e7, 1e7, 2e7}, {{{1, 0}, {0, 1}}});
  sliding.model = slider_under("coulomb", {0.6, 0.4}, any_slider, 1, 1000);
  sliding.normal = NormalContact{3e7};
  std::vector<double> hertz;
  for (int i = 0; i <= 1000; ++i) hertz.push_back(900 + 0.5 * i);
  const std::vector<Complex> none(hertz.size());
  const auto at = [&](double mu) {
    const auto changed = sliding.with("law.mu_d", mu);
    return close_table({hertz, friction_loop(changed.structure(), changed.model, changed.normal, hertz, none)});
  };
  CHECK(at(0.4).unstable == 2);
  CHECK(at(0.4).resolved);
  CHECK(at(0.3).unstable == 0);
  const auto critical = critical_values(at, 0.1, 0.5);
  REQUIRE(critical.size() == 1);
  CHECK(std::abs(critical[0].value - 0.336635733) < critical[0].error);
  CHECK(critical[0].error < 0.02);
  CHECK(critical[0].angular_frequency / (2 * std::numbers::pi) == Approx(1138).epsilon(3e-3));
  // Several contacts answer alike: on uncoupled masses the determinant is the product of their loops.
  const Structure two = matrices({1, 0, 0, 2}, {3, 0, 0, 5}, {1e4, 0, 0, 9e4}, {{{1, 0}, {}}, {{0, 1}, {}}});
  const Complex Z(-4, 2), s(0, 2 * std::numbers::pi * 20);
  const auto product = (1.0 + s * Z / (s * s + 3.0 * s + 1e4)) * (1.0 + s * Z / (2.0 * s * s + 5.0 * s + 9e4));
  CHECK(std::abs(friction_loop(two, sliding.model, {}, {20}, {Z})[0] - (product - 1.0)) < 1e-12);
}

TEST_CASE("narrow resonances are found between the frequencies of a measured response", "[structure]") {
  // Half-widths of 0.1 to 10 Hz, friction known every 40 Hz: the count is that of eigenvalues with the law itself.
  const auto law_model = slider_under("ageing", {0.4, 0.010, 0.013, 5e-7, 1e-6}, any_slider, 2e-3, 20);
  std::vector<double> hertz;
  for (int i = 0; i <= 125; ++i) hertz.push_back(20 + 40 * i);
  int unstable = 0, resolved = 0;
  const auto random = rosin::white_noise(80, 3);
  for (std::size_t i = 0; i < 20; ++i) {
    SlidingStructure sliding;
    std::vector<rosin::analysis::response::Mode> modes;
    for (std::size_t k = 0; k < 2; ++k)
      modes.push_back({150 * std::exp(1.5 * double(k) + 0.5 * random[4 * i + 2 * k]),
                       0.004 * std::exp(random[4 * i + 2 * k + 1]), 0.4, k == 0 ? 1.0 : 0.7});
    sliding.form = modes, sliding.model = law_model;
    std::vector<Complex> Z;
    for (const double f : hertz) Z.push_back(FrictionResponse(law_model).tangential({0, 2 * std::numbers::pi * f}));
    const auto closed = close_loop(sliding.structure(), law_model);
    const auto table = close_table(measured_friction_loop(sliding.structure(), law_model, {}, hertz, Z));
    INFO(i);
    unstable += closed.unstable_by_eigenvalues > 0, resolved += table.resolved;
    if (table.resolved) CHECK(table.unstable == closed.unstable_by_eigenvalues);
  }
  CHECK(unstable > 3);
  CHECK(unstable < 20);
  CHECK(resolved >= 18);
}

TEST_CASE("mode coupling under Coulomb friction: two modes merge at the friction that theory names", "[structure]") {
  // Two equal masses; a normal spring k_n couples: K_c = [k1, -μ k_n; 0, k2 + k_n] cannot flutter; with an oblique
  // spring K = [k11, k12 − μ k_n; k12, k22 + k_n], det: flutter where (k12 − μ k_n) k12 < −((k11 − k22')/2)².
  const double k11 = 11e3, k22 = 0, k12 = -5e3, k_n = 10e3, m = 1;
  const double half = (k11 - (k22 + k_n)) / 2;
  const double critical = (k12 + half * half / k12) / k_n;  // negative: sliding the other way
  Structure s = matrices({m, 0, 0, m}, {0, 0, 0, 0}, {k11, -k12, -k12, k22}, {{{1, 0}, {0, 1}}});
  // with the sign of x turned, μ_c = −critical
  const NormalContact normal{.stiffness = k_n};
  for (const double part : {0.97, 1.03}) {
    const double mu = -critical * part;
    const auto loop = close_loop(s, slider_under("coulomb", {mu, mu}, any_slider, 1, 100), normal);
    const double growth = loop.eigenvalues.front().real();
    INFO(mu << ": " << growth);
    CHECK((growth > 1) == (part > 1));
  }
}

namespace {

/// A structure whose only contact, under Coulomb friction, is pressed by its own motion. With (s²M + sC + K + k nnᵀ)
/// diagonal in modes φ (damping is proportional) its characteristic function is 1 − μ f(s), f = Σ r_j/(s² + c_j s +
/// λ_j), r_j = k (n·φ_j)(t·φ_j): every μ at which a root lies on the axis follows from f(iω) alone.
struct Flutter {
  int n;
  std::vector<double> lambda, damping, residue;  ///< of each mode
  Structure structure;
  NormalContact normal;

  std::complex<long double> f(long double omega) const {
    std::complex<long double> sum = 0;
    for (int j = 0; j < n; ++j)
      sum += (long double)(residue[j]) /
             std::complex<long double>(lambda[j] - omega * omega, (long double)(damping[j]) * omega);
    return sum;
  }
  /// f(√λ) of undamped modes and its slope by λ.
  std::pair<long double, long double> undamped(long double square) const {
    long double value = 0, slope = 0;
    for (int j = 0; j < n; ++j) {
      const long double apart = lambda[j] - square;
      value += residue[j] / apart, slope += residue[j] / (apart * apart);
    }
    return {value, slope};
  }
  /// Roots s² of undamped modes at μ that are not positive, real or complex: those vibrations grow. By a method of its
  /// own: Newton's identities would do, but the n roots of ∏(λ_j − x) (1 − μ f(x)) are few enough to be found together.
  bool grows(double mu) const {
    using C = std::complex<long double>;
    std::vector<C> x(n);
    for (int j = 0; j < n; ++j) x[j] = C(lambda[j] * (1 + 0.01L * j), 0.03L * lambda[j] * (j % 2 ? 1 : -1));
    const auto p = [&](C at) {
      C product = 1, sum = 0;
      for (int j = 0; j < n; ++j) product *= C(lambda[j]) - at;
      for (int j = 0; j < n; ++j) {
        C others = 1;
        for (int i = 0; i < n; ++i)
          if (i != j) others *= C(lambda[i]) - at;
        sum += (long double)(residue[j]) * others;
      }
      return product - (long double)(mu)*sum;
    };
    for (int round = 0; round < 400; ++round)
      for (int j = 0; j < n; ++j) {  // Durand-Kerner; the leading coefficient is (−1)ⁿ
        C others = n % 2 ? -1 : 1;
        for (int i = 0; i < n; ++i)
          if (i != j) others *= x[j] - x[i];
        x[j] -= p(x[j]) / others;
      }
    for (const auto& root : x)
      if (root.real() < 0 || std::abs(root.imag()) > 1e-9L * std::abs(root)) return true;
    return false;
  }
  SlidingStructure sliding(double mu) const {
    return {structure, slider_under("coulomb", {10.0, mu}, any_slider, 1, 1), normal};
  }
};

/// Random modes and directions, as matrices in random coordinates x = Φ q.
Flutter random_flutter(std::mt19937& random, int n, double mass_damping, double stiffness_damping) {
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
  Flutter flutter;
  flutter.n = n;
  Eigen::MatrixXd modes(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) modes(i, j) = uniform(-1, 1) + (i == j ? 2 : 0);
  const Eigen::MatrixXd inverse = modes.inverse();
  Eigen::VectorXd t(n), normal(n), lambda(n);
  for (int i = 0; i < n; ++i) {
    t[i] = uniform(-1, 1), normal[i] = uniform(-1, 1);
    lambda[i] = std::pow(10, uniform(0, 1.5));
  }
  const double k = std::pow(10, uniform(-1, 1));
  const Eigen::MatrixXd M = inverse.transpose() * inverse,
                        clamped = inverse.transpose() * lambda.asDiagonal() * inverse,
                        K = clamped - k * normal * normal.transpose();
  const Eigen::MatrixXd C = mass_damping * M + stiffness_damping * clamped;
  for (int i = 0; i < n; ++i) {
    flutter.lambda.push_back(lambda[i]);
    flutter.damping.push_back(mass_damping + stiffness_damping * lambda[i]);
    flutter.residue.push_back(k * normal.dot(modes.col(i)) * t.dot(modes.col(i)));
  }
  flutter.structure.M = M, flutter.structure.C = C, flutter.structure.K = K;
  auto& contact = flutter.structure.contacts.emplace_back();
  contact.tangential = t, contact.normal = normal;
  flutter.normal = {.stiffness = k};
  return flutter;
}

/// Sign changes of a function on a grid, by bisection.
template <class F>
std::vector<long double> zeros(const F& f, const std::vector<long double>& grid) {
  std::vector<long double> found;
  for (std::size_t i = 1; i < grid.size(); ++i) {
    long double a = grid[i - 1], b = grid[i];
    const bool below = f(a) < 0;
    if (below == (f(b) < 0)) continue;
    for (int k = 0; k < 90; ++k) {
      const long double middle = (a + b) / 2;
      ((f(middle) < 0) == below ? a : b) = middle;
    }
    found.push_back((a + b) / 2);
  }
  return found;
}

}  // namespace

TEST_CASE("flutter of undamped and damped structures sets in where the characteristic function says",
          "[structure][long]") {
  std::mt19937 random(36);
  constexpr int structures = 1000, scan_points = 60;
  constexpr double low = 0.02, high = 10;
  const double cell = std::log(high / low) / scan_points;
  int compared = 0, undamped = 0, known = 0, precise = 0;
  for (int k = 0; k < structures; ++k) {
    const bool damped = k % 3 == 2;
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    const auto flutter = random_flutter(random, 2 + k % 5, damped ? std::pow(10, uniform(-6, 0)) : 0,
                                        damped ? std::pow(10, uniform(-6, -1)) : 0);
    std::vector<long double> grid;  // of ω², denser beside each mode
    for (int i = 0; i <= 3000; ++i) grid.push_back(std::pow(10.0L, -4 + i / 300.0L));
    for (const double pole : flutter.lambda)
      for (int i = -200; i <= 200; ++i)
        if (i != 0) grid.push_back(pole * (1 + std::copysign(std::pow(10.0L, -std::abs(i) / 20.0L), i)));
    std::ranges::sort(grid);
    // Where roots cross the axis: at a real value of f, or where f turns round, or at ω = 0.
    std::vector<double> candidates{double(1 / flutter.undamped(0).first)};
    if (damped) {
      for (auto& square : grid) square = std::sqrt(square);
      for (const auto omega : zeros([&](auto w) { return flutter.f(w).imag(); }, grid))
        candidates.push_back(double(1 / flutter.f(omega).real()));
    } else {
      for (const auto square : zeros([&](auto x) { return flutter.undamped(x).second; }, grid))
        candidates.push_back(double(1 / flutter.undamped(square).first));
    }
    std::erase_if(candidates, [&](double mu) { return !(mu > low && mu < high); });
    std::ranges::sort(candidates);
    const auto found = critical_values(flutter.sliding(0.1), "law.mu_d", low, high, scan_points);
    INFO("structure " << k << " of " << flutter.n << " coordinates, " << (damped ? "damped" : "undamped"));
    // Every value found is one of these, and within its error.
    for (const auto& critical : found) {
      double nearest = infinity;
      for (const double mu : candidates) nearest = std::min(nearest, std::abs(mu - critical.value));
      INFO("found " << critical.value << " ± " << critical.error);
      CHECK(nearest <= critical.error);
      CHECK(critical.error < 1e-6 * critical.value);  // as coordinates that are nearly dependent leave it
      ++known, precise += critical.error < 1e-9 * critical.value;
    }
    // The first change of undamped structures is seen, unless another follows within a step of the scan.
    if (damped) continue;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const double mu = candidates[c], before = c == 0 ? low : candidates[c - 1],
                   after = c + 1 == candidates.size() ? high : candidates[c + 1];
      if (std::log(mu / before) < 2 * cell || std::log(after / mu) < 2 * cell) continue;
      if (flutter.grows(std::sqrt(mu * before)) == flutter.grows(std::sqrt(mu * after))) continue;
      ++compared;
      CHECK(std::ranges::any_of(found,
                                [&](const auto& critical) { return std::abs(critical.value - mu) <= critical.error; }));
    }
    ++undamped;
    if (!candidates.empty() && !flutter.grows(low)) {
      const auto below = flutter.sliding(0.5 * candidates.front());
      CHECK((candidates.front() < 2 * low || close_loop(below.structure(), below.model, below.normal).marginal));
    }
  }
  CHECK(precise > 0.95 * known);
  CHECK(undamped > 600);
  CHECK(compared > 100);
}

TEST_CASE("undamped pairs merge at the friction of theory; defective structures have eigenvalues, small and large",
          "[structure]") {
  const auto under = [](double mu) { return slider_under("coulomb", {mu, mu}, any_slider, 1, 1); };
  const NormalContact normal{.stiffness = 4.0 / 3};
  struct Pair {
    std::vector<double> K;
    double k_n, critical, omega;
  };
  for (const auto& [K, k_n, critical, omega] : {Pair{{2, 1, 1, 2.0 / 3}, 4.0 / 3, 0.75, std::sqrt(2.0)},
                                                Pair{{5.2e7, 1e7, 1e7, 2e7}, 3e7, 404.0 / 1200, std::sqrt(5.1e7)}}) {
    // An undamped pair of unit masses merges where 4 k12 (k12 − μ k_n) = −(k11 − k22 − k_n)²; Hoffmann et al. (2002).
    const Structure pair = matrices({1, 0, 0, 1}, {0, 0, 0, 0}, K, {{{1, 0}, {0, 1}}});
    for (const auto& [low, high, points] : {std::tuple{0.01, 3.0, 60}, {0.01, 3.0, 61}, {0.2, 0.8, 7}}) {
      const auto found = critical_values({.form = pair,
                                          .model = slider_under("coulomb", {5.0, 0.1}, any_slider, 1, 1),
                                          .normal = NormalContact{.stiffness = k_n}},
                                         "law.mu_d", low, high, points);
      REQUIRE(found.size() == 1);
      CHECK(std::abs(found[0].value - critical) <= found[0].error);
      CHECK(found[0].error < 1e-11);
      CHECK(found[0].angular_frequency == Approx(omega).epsilon(1e-6));
    }
  }
  // Hoffmann et al. (2002): an undamped pair merges at μ = ¾; equal damping shifts the merged roots as a whole.
  for (const double damping : {0.0, 20.0}) {
    const Structure pair = matrices({1, 0, 0, 1}, {damping, 0, 0, damping}, {2, 1, 1, 2.0 / 3}, {{{1, 0}, {0, 1}}});
    const auto loop = close_loop(pair, under(0.75), normal);
    CHECK(loop.marginal == (damping == 0));
    CHECK(loop.stable == (damping > 0));
    // s² + c s + 2 = 0 twice
    const auto s = std::sqrt(Complex(damping * damping / 4 - 2)) - damping / 2;
    CHECK(std::abs(loop.eigenvalues.front().real() - s.real()) < 1e-6 * std::abs(s));
  }
  // A chain of identical, undamped masses whose stiffness is one Jordan block; with memory at ten contacts, 28
  // unknowns.
  for (const int n : {3, 6, 9}) {
    Structure chain;
    chain.M = Eigen::MatrixXd::Identity(n, n), chain.C = Eigen::MatrixXd::Zero(n, n);
    chain.K = chain.M;
    chain.K.diagonal(-1).setOnes();
    chain.contacts.emplace_back().tangential = Eigen::VectorXd::Unit(n, 0);
    const auto loop = close_loop(chain, under(0.3));
    CHECK(loop.eigenvalues.size() == std::size_t(2 * n));
    CHECK(loop.marginal);
    const auto equal = [&] {
      Structure same = chain;
      same.C = 2 * chain.M, same.K = chain.M;
      return same;
    }();
    // Critically damped: every eigenvalue is −1, 2n times.
    for (const auto& z : close_loop(equal, under(0.3)).eigenvalues) CHECK(std::abs(z + 1.0) < 0.1);
  }
}

TEST_CASE("uncertain inputs move stability by as much as their spread", "[structure]") {
  auto model = bristol_board(4.0877514056773e-4 / tests::gravity, 10);
  // At the critical load itself any spread of load makes half of the samples unstable.
  const auto spread =
      propagate({.form = single, .model = model, .normal = {}}, {{"drive.normal_load", 0.1}, {"law.mu0", 0.1}}, 400, 3);
  CHECK(std::abs(spread.probability - 0.5) < 4 * spread.standard_error);
  CHECK(spread.influence[0] > 0.99);
  CHECK(std::abs(spread.influence[1]) < 0.2);  // the mean coefficient does not matter
  CHECK(spread.low < 0);
  CHECK(spread.high > 0);
}

TEST_CASE("parameters of the structure move stability as those of the model do", "[structure]") {
  // At the damping that is critical half of the samples are unstable, and more damping is more stable.
  const auto model = bristol_board(1e-3 / tests::gravity, 10);
  const double omega = std::sqrt(1.09);
  const SlidingStructure sliding{std::vector<Mode>{{omega / (2 * std::numbers::pi), 1e-3, 1, 1}}, model, {}};
  const auto critical = critical_values(sliding, "structure.modes.1.damping_ratio", 1e-6, 1);
  REQUIRE(critical.size() == 1);
  const auto at_it = sliding.with("structure.modes.1.damping_ratio", critical[0].value);
  CHECK(at_it.get("structure.modes.1.damping_ratio") == critical[0].value);
  // The same damping on the slider makes the load critical.
  auto slider = sliding.model;
  slider.slider = {.mass = 1, .stiffness = 1.09, .damping = 2 * critical[0].value * omega};
  CHECK(std::abs(steady::stability(slider).eigenvalues.front().real()) < 1e-9);
  const auto spread = propagate(at_it, {{"structure.modes.1.damping_ratio", 0.1}, {"law.mu0", 0.1}}, 400, 3);
  CHECK(std::abs(spread.probability - 0.5) < 4 * spread.standard_error);
  CHECK(spread.influence[0] < -0.99);
  CHECK_THROWS_WITH(sliding.describe("structure.modes.1.damping"), Catch::Contains("structure.modes.1.damping_ratio"));
  CHECK_THROWS_WITH(sliding.with("structure.modes.1.mass", -1), Catch::Contains("is outside"));

  // The model's own slider as the structure follows its parameters, and factors scale matrices.
  const SlidingStructure own{{}, slider, {}};
  CHECK(own.with("oscillator.mass", 3.0).structure().M(0, 0) == 3);
  const SlidingStructure by_matrices{single, model, {}};
  CHECK(by_matrices.with("structure.K", 2.0).structure().K(0, 0) == Approx(2.18));
}

TEST_CASE("contacts that remember the load and press themselves: eigenvalues balance the structure by hand",
          "[structure]") {
  // δF = Z δv + Y δN with Z = (N/V)(a − b/(1 + s L/V)) (Rice & Ruina 1983) and Y = μ − α s/(s + V/L) (Linker &
  // Dieterich 1992, about steady sliding); δv = −s tᵀx, δN = (k_n + c_n s) nᵀx − lift s tᵀx; t δF − n δN on the
  // structure.
  const double mu0 = 0.6, a = 0.01, b = 0.015, L = 1e-5, V = 1e-4, v0 = 1e-6, N = 5, alpha = 0.3;
  auto model = slider_under("ageing", {mu0, a, b, L, v0}, any_slider, V, N);
  model.load_memory = alpha;
  const double mu = mu0 + (a - b) * std::log(V / v0);
  const Structure s = matrices({2, 0.3, 0.3, 1}, {4, 0, 0, 3}, {9e3, -2e3, -2e3, 5e3}, {{{1, 0.4}, {-0.3, 1}}});
  const NormalContact normal{.stiffness = 7e3, .damping = 11, .lift = -2};
  const auto loop = close_loop(s, model, normal);
  CHECK(loop.eigenvalues.size() == 5);
  CHECK(loop.unstable_by_nyquist == loop.unstable_by_eigenvalues);
  const double t[] = {1, 0.4}, n[] = {-0.3, 1};
  for (const Complex at : loop.eigenvalues) {
    const Complex Z = N / V * (a - b / (1.0 + at * L / V)), Y = mu - alpha * at / (at + V / L);
    Complex D[2][2];
    double size = 0;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const Complex load = (normal.stiffness + normal.damping * at) * n[j] - normal.lift * at * t[j];
        D[i][j] = at * at * s.M(i, j) + at * s.C(i, j) + s.K(i, j) + t[i] * (Z * at * t[j] - Y * load) + n[i] * load;
        size = std::max(size, std::abs(D[i][j]));
      }
    INFO(at);
    CHECK(std::abs(D[0][0] * D[1][1] - D[0][1] * D[1][0]) < 1e-10 * size * size);
  }
  const FrictionResponse response(model);
  for (const double omega : {0.3, 10.0, 1e3}) {
    const Complex at(0, omega), Y = mu - alpha * at / (at + V / L);
    CHECK(std::abs(response.normal(at) - Y) < 1e-12 * std::abs(Y));
  }
}

TEST_CASE("friction changes the load of a contact that its structure couples to sliding", "[response]") {
  // k₁ x + c y = μ N, c x + k₂ y = −k_n y and N = N₀ + k_n y.
  const double k1 = 3, k2 = 2, c = 0.7, k_n = 5, mu = 0.4, N = 2;
  analysis::response::Structure structure;
  structure.M = Eigen::Matrix2d::Identity(), structure.C = Eigen::Matrix2d::Zero(),
  structure.K = Eigen::Matrix2d{{k1, c}, {c, k2}};
  auto& contact = structure.contacts.emplace_back();
  contact.tangential = Eigen::Vector2d(1, 0), contact.normal = Eigen::Vector2d(0, 1);
  oscillators::Model model;
  model.law = laws::find_law("coulomb")->with({mu, mu});
  model.drive.speed = 1.0, model.drive.normal_load = N;
  const auto loads = analysis::response::loads_under_friction(structure, model, {.stiffness = k_n});
  REQUIRE(loads.size() == 1);
  CHECK(loads[0] == Approx(N / (1 + k_n * c * mu / ((k2 + k_n) * k1 - c * c))));
  structure.contacts[0].normal.resize(0, 0);
  CHECK(analysis::response::loads_under_friction(structure, model, {.stiffness = k_n}).empty());
}
