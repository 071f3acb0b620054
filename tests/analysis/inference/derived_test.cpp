/// Numbers derived from fitted ones: g'Cg, ends of intervals in closed form, combinations that alone are determined.
#include "analysis/inference/derived.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/inference/fit.hpp"
#include "core/random.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis::inference;
using oscillators::Model;
using Kind = Measurement::Kind;

namespace {

Model ageing() {
  return tests::slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, {.mass = 1, .stiffness = 1, .damping = 0}, 1e-5,
                             5);
}

constexpr double noise = 1e-4, z = 1.959963984540054;

/// Steady friction μ* + (a − b) ln(V/V*) at six decades, with that noise.
Measurement curve(std::uint64_t seed) {
  Measurement m{Kind::steady_curve, "curve", 1e-6, 1e-6, 5, {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3}, {}, {}};
  m.y = predict(ageing(), m).y;
  m.error.assign(m.y.size(), noise);
  const auto drawn = white_noise(m.y.size(), seed);
  for (std::size_t i = 0; i < m.y.size(); ++i) m.y[i] += noise * drawn[i];
  return m;
}

/// Standard error of the slope of a straight line over ln V.
double slope_error() { return noise / (std::log(10.0) * std::sqrt(17.5)); }

Fit fitted(const std::vector<std::string>& parameters,
           const std::vector<std::pair<std::string, std::string>>& formulas) {
  FitOptions options{.parameters = parameters, .starts = 1, .profiles = false};
  for (const auto& [name, text] : formulas) options.derived.emplace_back(name, text, ageing());
  return fit(ageing(), {curve(7)}, options);
}

}  // namespace

TEST_CASE("the variance of a linear combination is g'Cg of the fitted numbers", "[fit][derived]") {
  const auto found = fitted({"law.mu0", "law.a"}, {{"sum", "2*law.mu0 - 3*law.a + law.b"},
                                                   {"k_c", "drive.normal_load*(law.b - law.a)/law.L"}});
  const auto &mu0 = found.parameters[0], &a = found.parameters[1], &sum = found.derived[0], &k_c = found.derived[1];
  CHECK(a.standard_error == Approx(slope_error()).epsilon(1e-6));
  CHECK(sum.value == Approx(2 * mu0.value - 3 * a.value + 0.015).epsilon(1e-14));
  const double C12 = found.correlation[1] * mu0.standard_error * a.standard_error;
  const double variance = 4 * std::pow(mu0.standard_error, 2) - 12 * C12 + 9 * std::pow(a.standard_error, 2);
  CHECK(sum.standard_error == Approx(std::sqrt(variance)).epsilon(1e-12));
  CHECK(k_c.unit == "N/m");
  CHECK(k_c.standard_error == Approx(5 / 1e-5 * slope_error()).epsilon(1e-6));
  // Of one fitted number the ends are those of that number's interval.
  CHECK(k_c.low == Approx(5 / 1e-5 * (0.015 - a.high)).epsilon(1e-10));
  CHECK(k_c.high == Approx(5 / 1e-5 * (0.015 - a.low)).epsilon(1e-10));
}

TEST_CASE("the interval of a product of positive numbers is that of its logarithm", "[fit][derived]") {
  const auto found = fitted({"law.mu0", "law.a"}, {{"product", "law.mu0^2/sqrt(law.a)"}});
  const auto &mu0 = found.parameters[0], &a = found.parameters[1], &product = found.derived[0];
  const double m = mu0.standard_error / mu0.value, n = a.standard_error / a.value;
  const double s = std::sqrt(4 * m * m - 2 * found.correlation[1] * m * n + n * n / 4);
  CHECK(product.standard_error == Approx(product.value * s).epsilon(1e-10));
  CHECK(product.low == Approx(product.value * std::exp(-z * s)).epsilon(1e-9));
  CHECK(product.high == Approx(product.value * std::exp(z * s)).epsilon(1e-9));
}

TEST_CASE("a steady curve tells a - b, although neither a nor b", "[fit][derived]") {
  const auto found = fitted({"law.mu0", "law.a", "law.b"}, {{"a-b", "law.a - law.b"}, {"a/b", "law.a/law.b"}});
  CHECK(std::isnan(found.parameters[1].standard_error));
  const auto &difference = found.derived[0], &ratio = found.derived[1];
  CHECK(difference.value == Approx(-0.005).margin(3 * slope_error()));
  CHECK(difference.standard_error == Approx(slope_error()).epsilon(1e-6));
  CHECK(difference.low < difference.value);
  CHECK(difference.high > difference.value);
  CHECK((std::isnan(ratio.standard_error) && std::isnan(ratio.low) && std::isnan(ratio.high)));
}

TEST_CASE("derived numbers of a response and a step lie in their 95 % intervals as often as they should",
          "[fit][derived]") {
  long inside = 0, all = 0;
  const double truth[] = {-0.005, 2500, 0.015 / 0.010};
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Measurement response{Kind::frequency_response, "response", 1e-5, 1e-5, 5, {}, {}, {}},
        step{Kind::velocity_step, "step", 1e-6, 1e-5, 5, {}, {}, {}};
    for (int k = 0; k < 30; ++k) response.x.push_back(0.01 * std::pow(10, k / 10.0));
    for (int k = 1; k <= 60; ++k) step.x.push_back(0.1 * k);
    std::vector<Measurement> data = {response, step};
    for (std::size_t d = 0; d < 2; ++d) {
      auto& m = data[d];
      m.y = predict(ageing(), m).y;
      m.error.assign(m.y.size(), d == 0 ? 150 : 1e-3);
      const auto drawn = white_noise(m.y.size(), 2 * seed + d);
      for (std::size_t i = 0; i < m.y.size(); ++i) m.y[i] += m.error[i] * drawn[i];
    }
    FitOptions options{.parameters = {"law.mu0", "law.a", "law.b", "law.L"}, .starts = 1, .profiles = false};
    options.derived = {{"a-b", "law.a - law.b", ageing()},
                       {"k_c", "drive.normal_load*(law.b - law.a)/law.L", ageing()},
                       {"b/a", "law.b/law.a", ageing()}};
    const auto found = fit(ageing(), data, options);
    for (std::size_t i = 0; i < 3; ++i, ++all)
      inside += found.derived[i].low <= truth[i] && truth[i] <= found.derived[i].high;
  }
  const double part = double(inside) / double(all);
  INFO(part);
  CHECK(part >= 0.92);
  CHECK(part <= 0.98);
}

TEST_CASE("a formula that cannot be derived is refused by name and place", "[fit][derived]") {
  const auto of = [](const char* text) { return DerivedNumber("k", text, ageing()); };
  CHECK_THROWS_WITH(of("law.a - law.bb"), Catch::Contains("did you mean 'law.b'?"));
  CHECK_THROWS_WITH(of("a - law.b"), Catch::Contains("fit.derived.k: unknown name 'a'; known here: law.mu0, law.a"));
  CHECK_THROWS_WITH(of("law.a - law.L"), Catch::Contains("their units differ"));
  CHECK_THROWS_WITH(of("law.a -"), Catch::Contains("fit.derived.k: ends where"));
  CHECK(of("drive.normal_load/law.L").unit() == "N/m");
  CHECK(of("pi*law.L").unit() == "m");
}
