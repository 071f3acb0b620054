/// Stability of steady sliding against closed forms and 40-digit eigenvalues.
#include "analysis/steady/stability.hpp"

#include <catch2/catch.hpp>

#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::steady;
using rosin::tests::bristol_board;
using rosin::tests::slider_under;

namespace {
/// The numerically located Hopf load: the closed form is kept out by a tiny damping's absence of one.
HopfPoint hopf_load(const Model& model) {
  const auto points = hopf_points(model, "drive.normal_load");
  REQUIRE(points.size() == 1);
  return points.front();
}
}  // namespace

TEST_CASE("Hopf loads of Bristol board are those of the closed form", "[stability]") {
  struct Case {
    double lambda, speed, load, frequency;
  };
  const auto c = GENERATE(Case{10, 1e-5, 0.00040877514056773, 0.69102017882153},
                          Case{100, 1e-5, 0.0072427657572008, 0.069102017882153},
                          Case{10, 1e-6, 0.00071799404007121, 0.069712270141778});
  const auto point = hopf_load(bristol_board(1e-4, c.lambda, c.speed));
  CHECK(point.value == Approx(c.load).epsilon(1e-12));
  CHECK(point.angular_frequency == Approx(c.frequency).epsilon(1e-12));
  CHECK(point.closed_form);
  CHECK(point.value_error < 1e-10 * point.value);  // includes the difference to the numerical location
}

TEST_CASE("eigenvalues change sign at the Hopf load as 40-digit arithmetic says", "[stability]") {
  const double critical = 0.00040877514056773;
  const auto leading = [&](double factor) {
    return stability(bristol_board(1, 10).with("drive.normal_load", factor * critical)).eigenvalues.front();
  };
  CHECK(leading(0.999).real() == Approx(-6.310897432e-5).epsilon(1e-8));
  CHECK(leading(1.001).real() == Approx(6.310261051e-5).epsilon(1e-8));
  CHECK(std::abs(leading(1.001).imag()) == Approx(0.6908089491).epsilon(1e-9));  // either of the pair may be first
}

TEST_CASE("below lambda_0 sliding is unstable at every load", "[stability]") {
  // λ₀ = 6.61877290893 at V = 1e-5 m/s: N_c = 0.
  CHECK(hopf_points(bristol_board(1e-4, 6.6), "drive.normal_load").empty());
  CHECK_FALSE(critical_load(bristol_board(1e-4, 6.6)));
  CHECK_FALSE(stability(bristol_board(1e-9, 6.6)).stable);
  CHECK(critical_load(bristol_board(1e-4, 6.62)));
}

TEST_CASE("contact stiffness lowers the Hopf load and leaves its frequency", "[stability]") {
  auto model = bristol_board(1e-4, 10);
  model.contact_stiffness.tangential = 0.5;
  const auto point = hopf_load(model);
  CHECK(point.value == Approx(1.8372063200725e-4).epsilon(1e-12));
  CHECK(point.angular_frequency == Approx(0.69102017882153).epsilon(1e-10));
  CHECK(point.value_error < 1e-10 * point.value);
  // k_t = κ N: N_c = (k − m ω²) [1/(−g μ_ss') − 1/κ].
  model.contact_stiffness = {.per_load = 5000};
  const double spring = 1.09 - 0.69102017882153 * 0.69102017882153, pull = spring / 0.00040877514056773;
  CHECK(hopf_load(model).value == Approx(spring * (1 / pull - 1 / 5000.0)).epsilon(1e-10));
}

TEST_CASE("critical stiffness of the ageing law is that of Rice and Ruina", "[stability]") {
  // k_c = N (b−a)/L · (1 + m V²/(N a L)) (Rice & Ruina 1983); the same for slip and PRZ (halved rate: g = 2·V/(2L)).
  const double a = 0.01, b = 0.015, L = 1e-5, V = 1e-3, N = 5, m = 2;
  const double expected = N * (b - a) / L * (1 + m * V * V / (N * a * L));
  for (const char* law : {"ageing", "slip", "prz"}) {
    const auto model = slider_under(law, {0.6, a, b, L, 1e-6}, {m, expected * 3, 0}, V, N);
    const auto points = hopf_points(model, "oscillator.stiffness");
    INFO(law);
    REQUIRE(points.size() == 1);
    CHECK(points[0].value == Approx(expected).epsilon(1e-10));
    CHECK(points[0].value_error < 1e-9 * points[0].value);
  }
}

TEST_CASE("a two-state law with equal states has the Hopf load of one state, found numerically", "[stability]") {
  const double N = 5, V = 1e-3, m = 2, k = 5e4;
  const auto one = slider_under("ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {m, k, 0}, V, N);
  const auto two = slider_under("two-state-ageing", {0.6, 0.01, 0.009, 1e-5, 0.006, 1e-5, 1e-6}, {m, k, 0}, V, N);
  const auto numerical = hopf_load(two), closed = hopf_load(one);
  CHECK_FALSE(numerical.closed_form);
  CHECK(numerical.value == Approx(closed.value).epsilon(1e-10));
  CHECK(std::abs(numerical.value - closed.value) <= numerical.value_error + closed.value_error);
}

TEST_CASE("damping moves the border to m k g = (c + m g + N mu_v)(k + c g + N g mu_ss')", "[stability]") {
  auto model = bristol_board(1e-4, 10);
  model.slider.damping = 1e-3;
  const auto point = hopf_load(model);
  const double g = 1.1122222222222222, mu_v = 3489.9999724828, slope = -1347.1741680293, N = point.value;
  const double left = 1.09 * g, right = (1e-3 + g + N * mu_v) * (1.09 + 1e-3 * g + N * g * slope);
  CHECK(left == Approx(right).epsilon(1e-11));
}

TEST_CASE("the border at 0.01 mm/s is subcritical for log10 lambda from 1.32 to 1.57 only", "[stability]") {
  for (const double exponent : {1.0, 1.2, 1.3, 1.6, 1.8}) {
    INFO(exponent);
    CHECK(hopf_load(bristol_board(1e-4, std::pow(10, exponent))).criticality == Criticality::supercritical);
  }
  for (const double exponent : {1.33, 1.45, 1.56}) {
    INFO(exponent);
    CHECK(hopf_load(bristol_board(1e-4, std::pow(10, exponent))).criticality == Criticality::subcritical);
  }
}

TEST_CASE("the first Lyapunov coefficient predicts the amplitude law of a van der Pol-like friction curve",
          "[stability]") {
  // m ẍ + k x = F(V − ẋ) with the friction curve λ = 0: averaging gives dA/dt = −(F'/2m) A − (F'''/16 m) V² A³ for
  // v = V(1 + A cos), so c₁ = −F''' V²/(16 m). F'' enters at the same order only through the mean, which a linear
  // spring absorbs. A weak load makes averaging exact.
  auto model = bristol_board(1e-6, 0, 4e-4);
  const auto hopf = hopf_points(model, "drive.speed");
  REQUIRE_FALSE(hopf.empty());
  const double V = hopf[0].value, N = model.drive.normal_load.level();
  const auto slope = [&](double v) { return model.law->steady_friction({v, N}).slope; };
  const double h = 1e-3 * V, third = (slope(V + h) - 2 * slope(V) + slope(V - h)) / (h * h);
  const double omega = std::sqrt(1.09);
  CHECK(hopf[0].first_lyapunov_coefficient == Approx(-N * third * V * V / (16 * omega)).epsilon(1e-3));
}

TEST_CASE("Coulomb sliding on an undamped slider is marginal", "[stability]") {
  auto model = slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.01, 2);
  CHECK(stability(model).marginal);
  CHECK_FALSE(stability(model).stable);
  model.slider.damping = 0.1;
  CHECK(stability(model).stable);
}

TEST_CASE("steady sliding needs a drive and a spring", "[stability]") {
  CHECK_THROWS_AS(steady_sliding(bristol_board(1e-4, 10, 0)), InputError);
  CHECK_THROWS_AS(steady_sliding(bristol_board(1e-4, 10).with("oscillator.stiffness", 0)), InputError);
}

TEST_CASE("a damper far weaker than friction's slope leaves the slow eigenvalue to its digits", "[stability]") {
  // No mass, no memory: (c + N dmu/dv) u = k x and x' = V - u, so that the eigenvalue is -k/(c + N (a - b)/V).
  const double a = 0.02, b = 0.009, V = 1e-5, N = 2e4, k = 1.3;
  auto model = slider_under("slip", {0.6, a, b, 1e-5, 1e-6}, {0, k, 0}, V, N);
  model.lambda = 0;
  for (const double c : {1e-20, 1e-12, 1e-4, 1.0, 1e4}) {
    model.slider.damping = c;
    const auto sliding = stability(model);
    REQUIRE(sliding.eigenvalues.size() == 1);
    const double exact = -k / (c + N * (a - b) / V);
    CHECK(sliding.eigenvalues[0].real() == Approx(exact).epsilon(1e-13));
    CHECK(sliding.eigenvalue_errors[0] < 1e-12 * std::abs(exact));
    CHECK(sliding.stable);
  }
}

TEST_CASE("an eigenvalue beside one that rounding hides is known no better than that", "[stability]") {
  // The contact is a million times as stiff as the springs. Roots of the cubic, with 50 digits: a constant within
  // rounding of nought moves the first by 7e-13 too.
  auto model = tests::slider_under("kato-tullis",
                                   {0.99629081791090934, 0.0039366717246881915, 0.015499252393864666,
                                    1.2260545466553461e-06, 5.099278973070066e-06, 2.0419671719085569e-09},
                                   {0, 0.027853665215837153, 0}, 3.5464543846803448e-10, 43.516406881545173);
  model.contact_stiffness.tangential = 0.0011209729047942938;
  model.contact_stiffness.damping = 0.00064711268497190768;
  const double exact[] = {0.00138011047989815770, 7.0439548578619607e-13, -44.775259075511952};
  const auto found = stability(model);
  REQUIRE(found.eigenvalues.size() == 3);
  for (int i = 0; i < 3; ++i) CHECK(std::abs(found.eigenvalues[i] - exact[i]) <= found.eigenvalue_errors[i]);
}

TEST_CASE("the closed critical load of a slider with mass is where Hurwitz' determinant vanishes", "[stability]") {
  // (m s² + k)[(s + g) + s A (s + g r)/k_t] + s A (s + g r) = 0 with A = N a/V, g = V/(λL), r = (a − b)/a: a quartic.
  const double a = 0.01, b = 0.015, L = 1e-5, V = 1e-3, k = 4e3;
  struct Case {
    double mass, lambda;
    oscillators::ContactStiffness spring;
  };
  for (const auto& [m, lambda, spring] :
       {Case{0.2, 1, {}}, {0.2, 1, {.tangential = 9e3}}, {0.3, 1, {.per_load = 6e3}}, {2, 3, {.tangential = 2e3}}}) {
    auto model = slider_under("ageing", {0.6, a, b, L, 1e-6}, {m, k, 0}, V, 1);
    model.lambda = lambda;
    model.contact_stiffness = spring;
    const double g = V / (lambda * L), r = (a - b) / a;
    struct Coefficients {
      double c4, c3, c2, c1, c0;
    };
    const auto quartic = [&](double N) {
      const double A = N * a / V, q = A / (std::isfinite(spring.per_load) ? spring.per_load * N : spring.tangential);
      return Coefficients{m * q, m * (1 + q * g * r), m * g + k * q + A, k * (1 + q * g * r) + A * g * r, k * g};
    };
    const auto determinant = [&](double N) {  // 0 at N = 0 too, by its factor N
      const auto [c4, c3, c2, c1, c0] = quartic(N);
      return (c1 * (c2 * c3 - c1 * c4) - c0 * c3 * c3) / N;
    };
    double low = 1e-3, high = 1e-3;
    for (const double sign = determinant(low); determinant(high) * sign > 0; high *= 1.01) low = high;
    for (int i = 0; i < 100; ++i) {
      const double middle = 0.5 * (low + high);
      (determinant(middle) * determinant(high) > 0 ? high : low) = middle;
    }
    const auto closed = critical_load(model);
    INFO("mass " << m << ", spring " << spring.tangential << ", per load " << spring.per_load);
    REQUIRE(closed);
    CHECK(closed->normal_load == Approx(low).epsilon(1e-10));
    const auto there = quartic(low);
    CHECK(closed->angular_frequency == Approx(std::sqrt(there.c1 / there.c3)).epsilon(1e-8));
  }
  // No spring holds a mass whose inertia outweighs it at the frequency of the contact, ω² = g² (b − a)/a.
  CHECK_FALSE(critical_load(slider_under("ageing", {0.6, a, b, L, 1e-6}, {0.81, k, 0}, V, 1)));
  CHECK(critical_load(slider_under("ageing", {0.6, a, b, L, 1e-6}, {0.79, k, 0}, V, 1)));
}
