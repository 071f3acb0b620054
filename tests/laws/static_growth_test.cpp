/// Static friction that grows at rest: the printed forms, and the period and multiplier of stick-slip in closed form.
#include <boost/math/tools/roots.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("static-growth: a decade of rest adds beta", "[laws][static-growth]") {
  const auto law = laws::find_law("static-growth");
  CHECK(law->static_limit(1, std::vector{0.0}) == 0.4);
  CHECK(law->static_limit(1, std::vector{99.0}) == Approx(0.43).epsilon(1e-14));
  CHECK(law->static_limit(1, std::vector{999.0}) == Approx(0.445).epsilon(1e-14));
}

TEST_CASE("kato-growth: from mu_0 to mu_inf", "[laws][kato-growth]") {
  const auto law = laws::find_law("kato-growth");
  CHECK(law->static_limit(1, std::vector{0.0}) == Approx(0.35).epsilon(1e-14));
  CHECK(law->static_limit(1, std::vector{100.0}) == Approx(0.45 - 0.1 * std::exp(-1.0)).epsilon(1e-14));
  CHECK(law->static_limit(1, std::vector{1e8}) == Approx(0.45).epsilon(1e-14));
}

TEST_CASE("loading-rate: the limit solves its own definition at any time", "[laws][loading-rate]") {
  const auto law = laws::find_law("loading-rate");
  CHECK(law->static_limit(1, std::vector{0.0}) == Approx(0.35).epsilon(1e-14));
  for (const double t : {1e-6, 0.1, 3.4, 3.5, 3.6, 200.0, 1e9}) {
    const double mu = law->static_limit(1, std::vector{t});
    CHECK(mu == Approx(0.35 + 0.15 / (1 + mu / t / 0.1)).epsilon(1e-14));
  }
}

TEST_CASE("static friction that grows at rest: period and multiplier of stick-slip", "[laws][cycle]") {
  // Undamped slip from X = x - mu_d N/k ends at -X: a stick of time t regains 2X = V t, and X = N (mu_s(t) - mu_d)/k.
  // Slip lasts 2 (pi - atan(X w/V))/w. With p = N mu_s'(t)/k, the next stick changes by p/(V - p) of a change in t.
  const double k = 1.09, V = 0.01, N = 2, w = std::sqrt(k);
  for (const char* name : {"static-growth", "kato-growth", "loading-rate"}) {
    CAPTURE(name);
    oscillators::Model model;
    model.law = laws::find_law(name);
    model.slider = {.mass = 1, .stiffness = k, .damping = 0};
    model.drive = {V, N, 0.0};
    const auto onset = [&](double t) { return N * (model.law->static_limit(N, std::vector{t}) - 0.3) / k; };
    std::uintmax_t iterations = 200;
    const auto [low, high] =
        boost::math::tools::toms748_solve([&](double t) { return 2 * onset(t) - V * t; }, 1.0, 1000.0,
                                          boost::math::tools::eps_tolerance<double>(52), iterations);
    const double t = 0.5 * (low + high), h = 1e-3 * t, X = onset(t);
    const double p = (8 * (onset(t + h / 2) - onset(t - h / 2)) - (onset(t + h) - onset(t - h))) / (6 * h);
    const auto cycle = analysis::cycles::find_cycle(model);
    REQUIRE(cycle.outcome.complete());
    const double slip = 2 * (std::numbers::pi - std::atan(X * w / V)) / w;
    CHECK(cycle.metrics.period == Approx(t + slip).epsilon(1e-9));
    CHECK(std::abs(cycle.metrics.period - (t + slip)) <= cycle.error.period);
    CHECK(cycle.metrics.stick_fraction == Approx(t / (t + slip)).epsilon(1e-9));
    CHECK(cycle.metrics.slip_rate_max == Approx(V + std::hypot(V, X * w)).epsilon(1e-9));
    REQUIRE(cycle.multipliers.size() == 1);
    CHECK(cycle.multipliers[0].real() == Approx(p / (V - p)).epsilon(1e-5));
    CHECK(cycle.stable);
    REQUIRE(cycle.section_state.size() == 1);
    CHECK(cycle.section_state[0] == Approx(t).epsilon(1e-9));
  }
}
