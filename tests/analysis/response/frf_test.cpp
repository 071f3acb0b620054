/// Friction frequency responses against numbers printed elsewhere, closed forms, and differences of the equations.
#include "analysis/response/frf.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "tests/bristol_board.hpp"
#include "tests/surrounded_laws.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::response;
using oscillators::Model;
using tests::any_slider;
using tests::bristol_board;
using tests::slider_under;
using Complex = std::complex<double>;

namespace {

/// Relative agreement of complex numbers.
void check_close(Complex computed, Complex expected, double tolerance) {
  INFO(computed.real() << " " << computed.imag() << " i against " << expected.real() << " " << expected.imag() << " i");
  CHECK(std::abs(computed - expected) <= tolerance * std::abs(expected));
}

struct Number {
  double omega, real, imaginary;
};

void check_numbers(const Model& model, const std::vector<Number>& numbers, double tolerance = 1e-10) {
  const FrictionResponse response(model);
  for (const auto& n : numbers) {
    const auto Z = response.tangential({0, n.omega});
    INFO("omega " << n.omega << ": " << Z.real() << " " << Z.imag());
    CHECK(std::abs(Z.real() - n.real) <= tolerance * std::abs(n.real));
    CHECK(std::abs(Z.imag() - n.imaginary) <= tolerance * std::abs(n.imaginary));
  }
}

}  // namespace

// Numbers to 14 digits from derivatives by mpmath at 30 to 40 digits, about the laws of Woodhouse et al. (2015).
TEST_CASE("rate-and-state laws, ageing or slip, have one linear response", "[frf]") {
  for (const char* law : {"ageing", "slip"})
    check_numbers(slider_under(law, {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5),
                  {{0.1, -2425.7425742574, 742.57425742574},
                   {1, 1250.0, 3750.0},
                   {10, 4925.7425742574, 742.57425742574},
                   {100, 4999.2500749925, 74.992500749925},
                   {1000, 4999.9925000075, 7.4999925000075}});
}

TEST_CASE("the spinodal law of Bristol board, rigid and behind a contact spring", "[frf]") {
  auto model = bristol_board(1e-3 / tests::gravity, 10);
  check_numbers(model, {{0.1, -1.3083848682087, 0.43142321244979},
                        {1, 0.81513758224832, 2.404971180031},
                        {10, 3.4308934474364, 0.53142729812013},
                        {100, 3.4894016695414, 0.053793471260092},
                        {1000, 3.4899939887207, 0.0053800059165631}});
  const FrictionResponse rigid(model);
  CHECK(rigid.limits().low == Approx(1e-3 * -1347.1741680293).epsilon(1e-11));
  CHECK(rigid.limits().high == Approx(1e-3 * 3489.9999724828).epsilon(1e-11));
  // s = −g and s = −g r, in the right half-plane where friction weakens
  REQUIRE(rigid.poles().size() == 1);
  REQUIRE(rigid.zeros().size() == 1);
  CHECK(rigid.poles().front().value.real() == Approx(-1.1122222222222).epsilon(1e-12));
  CHECK(rigid.zeros().front().value.real() ==
        Approx(1.1122222222222 * 1347.1741680293 / 3489.9999724828).epsilon(1e-11));

  model.contact_stiffness.tangential = 0.5;
  check_numbers(model, {{0.1, -1.4483688594723, 0.057368448669834},
                        {1, 0.047464965241346, -0.61092531226022},
                        {10, 0.00071460260308681, -0.05010027393905},
                        {100, 7.1631514458861e-6, -0.0050001001647438},
                        {1000, 7.1633221148449e-8, -0.00050000010016365}});
  const FrictionResponse sprung(model);
  CHECK(sprung.limits().low == Approx(rigid.limits().low).epsilon(1e-12));
  CHECK(sprung.limits().high == 0);
  CHECK(sprung.limits().stiffness == Approx(0.5).epsilon(1e-12));
  for (const double omega : {0.03, 0.7, 20.0}) {  // springs add as Z/(1 + s Z/k_t)
    const Complex s(0, omega), Z = rigid.tangential(s);
    check_close(sprung.tangential(s), Z / (1.0 + s * Z / 0.5), 1e-12);
  }
}

TEST_CASE("the critical load behind a contact spring is that at which the slider and its contact answer nothing",
          "[frf]") {
  // (m s² + k) + s Z = 0 at the Hopf point: N_c = 1.8372063200725e-4 N at k_t = 0.5 N/m, 4.0877514056773e-4 N rigid.
  const Complex s(0, 0.69102017882153);
  for (const auto& [stiffness, load] : {std::pair{0.5, 1.8372063200725e-4}, std::pair{infinity, 4.0877514056773e-4}}) {
    auto model = bristol_board(load / tests::gravity, 10);
    model.contact_stiffness.tangential = stiffness;
    const auto balance = s * s + 1.09 + s * FrictionResponse(model).tangential(s);
    CHECK(std::abs(balance) < 1e-11);
  }
}

TEST_CASE("LuGre and thermal friction", "[frf]") {
  // σ per newton of load: 1e5 N/m, 30 N s/m and 0.4 N s/m at 10 N
  check_numbers(slider_under("lugre", {1e4, 3.0, 0.04, 0.4, 0.3, 1e-3}, any_slider, 1e-3, 10),
                {{0.1, -735.35061134764, 2.4558465913167},
                 {1, -734.53271053148, 24.530919999731},
                 {10, -661.07385420437, 220.5691427977},
                 {100, -65.234186939112, 198.97526235995},
                 {1000, -6.7962298835116, 21.632682083357}});
  Model thermal;
  thermal.law = laws::find_law("thermal");
  thermal.drive = {.speed = 0.1, .normal_load = 1.0, .force = 0.0};
  check_numbers(thermal, {{10, -1.657271211751, 0.0019398927594461},
                          {100, -1.657046442162, 0.019396296589377},
                          {1000, -1.6348732584456, 0.19136751873701},
                          {10000, -0.69922711115019, 0.81846930092721},
                          {100000, -0.012007918632334, 0.1405568035317}});
  const FrictionResponse response(thermal);
  CHECK(response.limits().low == Approx(-1.65727348246).epsilon(1e-11));
  CHECK(response.limits().high == 0);  // temperature does not jump
}

TEST_CASE("friction curves answer by their slope, Coulomb friction not at all, whichever way they slide", "[frf]") {
  const auto curve = slider_under("two-exponential", {0.35, 0.4, 0.01, 0.45, 0.1}, any_slider, 0.05, 3);
  const double slope = 3 * (-40 * std::exp(-5.0) - 4.5 * std::exp(-0.5));
  for (const double speed : {0.05, -0.05}) {
    check_close(FrictionResponse(curve.with("drive.speed", speed)).tangential({0, 300}), slope, 1e-13);
    const auto coulomb = slider_under("coulomb", {0.5, 0.3}, any_slider, speed, 7);
    const FrictionResponse response(coulomb);
    CHECK(response.tangential({0, 300}) == 0.0);
    CHECK(response.normal({0, 300}).real() == Approx(speed > 0 ? 0.3 : -0.3).epsilon(1e-15));
    CHECK(response.poles().empty());
    CHECK(response.zeros().empty());
  }
  CHECK_THROWS_AS(FrictionResponse(curve.with("drive.speed", 0)), InputError);
  CHECK_THROWS_AS(FrictionResponse(curve.with("drive.normal_load", 0)), InputError);
}

TEST_CASE("entries of the matrix agree with differences of the contact's own equations", "[frf]") {
  // Independent of its derivatives: values of F and g alone, by five-point differences, solved at s.
  for (const auto& model : tests::surrounded_laws()) {
    if (model.lambda != 1 || model.contact_stiffness.damped()) continue;  // not written out below
    const double V = model.drive.speed.level(), N = model.drive.normal_load.level();
    const double k_t = model.contact_stiffness.tangential, kappa = model.contact_stiffness.per_load;
    INFO(model.law->card().name << ", k_t " << k_t << ", per load " << kappa);
    const FrictionResponse response(model);
    const auto& law = *model.law;
    // By hand from the law's answers alone: λψ̇ = G(v, N, ψ), F = N μ(v, ψ), and springs in series.
    const auto states = law.steady({V, N});
    const std::size_t n = states.size();
    const auto evaluate = [&](double v, double load, const std::vector<double>& x) {
      auto out = n > 0 ? law.rate({v, load}, x) : std::vector<double>{};
      out.push_back(load * law.friction({v, load}, x));
      return out;
    };
    const auto slope = [&](auto at, double size) {  // five points; steps that balance truncation and rounding
      const double h = 1e-3 * size;
      const auto a = at(h), b = at(-h), c = at(2 * h), d = at(-2 * h);
      std::vector<double> s;
      for (std::size_t i = 0; i < a.size(); ++i) s.push_back((8 * (a[i] - b[i]) - (c[i] - d[i])) / (12 * h));
      return s;
    };
    const auto by_v = slope([&](double h) { return evaluate(V + h, N, states); }, V);
    const auto by_N = slope([&](double h) { return evaluate(V, N + h, states); }, N);
    std::vector<std::vector<double>> by_state;
    for (std::size_t k = 0; k < n; ++k)
      by_state.push_back(slope(
          [&](double h) {
            auto x = states;
            x[k] += h;
            return evaluate(V, N, x);
          },
          std::max(std::abs(states[k]), 1e-12)));
    for (const double omega : {0.3, 40.0, 3e3}) {
      const Complex s(0, omega);
      // Gauss-Jordan on (s − ∂G/∂ψ) ζ = (∂G/∂v, ∂G/∂N)
      std::vector<std::vector<Complex>> rows(n, std::vector<Complex>(n + 2));
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) rows[i][j] = (i == j ? s : 0.0) - by_state[j][i];
        rows[i][n] = by_v[i], rows[i][n + 1] = by_N[i];
      }
      for (std::size_t p = 0; p < n; ++p)
        for (std::size_t i = 0; i < n; ++i) {
          if (i == p) continue;
          const Complex factor = rows[i][p] / rows[p][p];
          for (std::size_t j = 0; j < n + 2; ++j) rows[i][j] -= factor * rows[p][j];
        }
      Complex Z = by_v[n], Y = by_N[n];
      for (std::size_t k = 0; k < n; ++k) {
        Z += by_state[k][n] * rows[k][n] / rows[k][k];
        Y += by_state[k][n] * rows[k][n + 1] / rows[k][k];
      }
      // In series with a spring: v = u − s (δF/k − F δk/k²); a spring κN has δk = κ δN.
      const double stiffness = std::isfinite(kappa) ? kappa * N : k_t;
      const double force = N * law.steady_friction({V, N}).friction;
      const double spring_gain = std::isfinite(kappa) ? force / N : 0;
      const Complex series = 1.0 + s * Z / stiffness;
      const Complex Z_all = Z / series, Y_all = (Y + s * Z / stiffness * spring_gain) / series;
      const double size = std::max(std::abs(Z_all), 1e-3 * std::abs(force) / V);
      CHECK(std::abs(response.tangential(s) - Z_all) <= 1e-8 * size);
      CHECK(std::abs(response.normal(s) - Y_all) <= 1e-8 * std::max(std::abs(Y_all), 1e-3));
    }
  }
}

TEST_CASE("a normal contact turns approach into load and load into friction", "[frf]") {
  const auto model = slider_under("coulomb", {0.5, 0.3}, any_slider, 1e-2, 7);
  const FrictionResponse response(model);
  const Complex s(0, 100);
  const auto m = response.matrix(s, NormalContact{.stiffness = 2e4, .damping = 5, .lift = -3});
  const Complex approach = 2e4 / s + 5.0;
  check_close(m.tn, 0.3 * approach, 1e-14);
  check_close(m.nn, approach, 1e-14);
  check_close(m.tt, 0.3 * -3.0, 1e-14);
  CHECK(m.nt == -3.0);
  CHECK(response.matrix(s).nn == 1.0);
  check_close(response.matrix(s).tn, 0.3, 1e-14);
}

TEST_CASE("sensitivities hold their error, against the closed form", "[frf]") {
  // Z = (N/V)(a − b/(1 + s L/V)): ∂Z/∂L = (N/V) b (s/V)/(1 + s L/V)²
  const double N = 5, V = 1e-5, b = 0.015, L = 1e-5;
  const auto model = slider_under("ageing", {0.6, 0.010, b, L, 1e-6}, any_slider, V, N);
  const std::vector<double> hertz = {0.02, 0.2, 2};
  const auto slopes = frf_sensitivities(model, {"law.L", "law.a"}, hertz);
  const auto &by_length = slopes[0], &by_direct = slopes[1];
  for (std::size_t k = 0; k < hertz.size(); ++k) {
    const Complex s(0, 2 * std::numbers::pi * hertz[k]), lag = 1.0 + s * L / V;
    const Complex exact = N / V * b * (s / V) / (lag * lag);
    CHECK(std::abs(by_length.slope[k] - exact) <= by_length.error[k]);
    CHECK(by_length.error[k] <= 1e-8 * std::abs(exact));
    CHECK(std::abs(by_direct.slope[k] - N / V) <= by_direct.error[k] + 1e-12 * N / V);
  }
}

TEST_CASE("the second harmonic of a friction curve and of a rate-and-state law", "[frf]") {
  // F(V + ε cos ωt) of a curve: second harmonic ¼ N μ'' ε² against N μ' ε.
  const auto curve = slider_under("two-exponential", {0.35, 0.4, 0.01, 0.45, 0.1}, any_slider, 0.05, 3);
  const double first = -40 * std::exp(-5.0) - 4.5 * std::exp(-0.5);
  const double second = (4000 * std::exp(-5.0) + 45 * std::exp(-0.5)) / 4;
  CHECK(FrictionResponse(curve).amplitude_of_harmonic(70, 0.01) == Approx(-0.01 * first / second).epsilon(1e-12));
  // At high frequency the state stands still: a ln v alone, −a ε²/(4 V²) against a ε/V.
  const auto ageing = slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, any_slider, 1e-5, 5);
  CHECK(FrictionResponse(ageing).amplitude_of_harmonic(1e7, 0.01) == Approx(0.04 * 1e-5).epsilon(1e-5));
}

TEST_CASE("magnitudes scale with load at low frequency and forget it behind a contact spring", "[frf]") {
  auto model = slider_under("ageing", {0.4, 0.010, 0.012, 2e-6, 1e-6}, any_slider, 2e-3, 16);
  FrfOptions options;
  options.frequencies = {0.5, 2000};
  options.family = "drive.normal_load";
  options.family_values = {3, 16, 26, 37, 47};
  for (const double exponent : predict_frf(model, options).load_exponent) CHECK(exponent == Approx(1).epsilon(1e-12));
  model.contact_stiffness.tangential = 1e4;
  const auto sprung = predict_frf(model, options).load_exponent;
  CHECK(sprung.front() == Approx(1).epsilon(1e-3));
  CHECK(std::abs(sprung.back()) < 0.05);
}

TEST_CASE("every law responds with finite numbers at ten thousand frequencies", "[frf]") {
  for (const auto& model : tests::surrounded_laws()) {
    const FrictionResponse response(model);
    long finite = 0;
    for (int k = 0; k < 10000; ++k) finite += std::isfinite(std::abs(response.tangential({0, 0.1 * (k + 1)})));
    CHECK(finite == 10000);
  }
}

TEST_CASE("a response tends to its limits, bare, heated and behind springs with and without dampers", "[frf]") {
  int stiff = 0, direct = 0;
  for (const auto& model : tests::surrounded_laws()) {
    const FrictionResponse response(model);
    const auto limits = response.limits();
    INFO(model.law->card().name << ", damped " << model.contact_stiffness.damped() << ", high " << limits.high
                                << ", stiffness " << limits.stiffness);
    double fastest = 1;
    for (const auto& pole : response.poles()) fastest = std::max(fastest, std::abs(pole.value));
    for (const auto& zero : response.zeros()) fastest = std::max(fastest, std::abs(zero.value));
    const Complex s(0, 1e5 * fastest), Z = response.tangential(s);
    if (limits.high != 0) {
      ++direct;
      CHECK(limits.stiffness == 0);
      check_close(Z, limits.high, 1e-4);
    } else if (limits.stiffness != 0) {
      ++stiff;
      check_close(s * Z, limits.stiffness, 1e-4);
    }
  }
  CHECK(direct > 20);
  CHECK(stiff > 20);
}

TEST_CASE("behind a damped spring a bristle's stiffness is what is left, and of a direct effect the dampers in series",
          "[frf]") {
  const double N = 5, V = 1e-3, a = 0.01, c = 30, sigma0 = 1e4, sigma1 = 3;
  auto ageing = slider_under("ageing", {0.6, a, 0.015, 1e-5, 1e-6}, any_slider, V, N);
  ageing.contact_stiffness = {.tangential = 2e4, .damping = c};
  CHECK(FrictionResponse(ageing).limits().high == Approx(1 / (V / (N * a) + 1 / c)).epsilon(1e-12));
  CHECK(FrictionResponse(ageing).limits().stiffness == 0);
  // A bristle's ż = v − σ₀|v|z/g(v) has δz = (V g'/g) δv/s at high frequency. Behind a damper, 1/(1/Z + 1/c) does not
  // know the damper where Z falls as 1/s.
  const double fallen = 0.1 * std::exp(-1), follows = -2 * fallen / (0.3 + fallen);  // V g'/g at V = v_s
  auto bristle = slider_under("lugre", {sigma0, 0.0, 0.0, 0.4, 0.3, 1e-3}, any_slider, V, N);
  CHECK(FrictionResponse(bristle).limits().stiffness == Approx(sigma0 * N * follows).epsilon(1e-12));
  bristle.contact_stiffness = {.tangential = 2e4, .damping = c};
  CHECK(FrictionResponse(bristle).limits().high == 0);
  CHECK(FrictionResponse(bristle).limits().stiffness == Approx(sigma0 * N * follows).epsilon(1e-12));
  auto damped = slider_under("lugre", {sigma0, sigma1, 0.0, 0.4, 0.3, 1e-3}, any_slider, V, N);
  damped.contact_stiffness = bristle.contact_stiffness;
  CHECK(FrictionResponse(damped).limits().high == Approx(1 / (1 / (sigma1 * N * follows) + 1 / c)).epsilon(1e-12));
}
