/// Friction falling over a distance: Rabinowicz's impulse in closed form, and Coulomb friction as the limit.
#include <boost/math/tools/roots.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "analysis/motion/run.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;

TEST_CASE("slip-distance: a block on a slope stops or runs away, by the impulse that it is given",
          "[laws][slip-distance]") {
  // s'' = -g0 cos(alpha) [mu(s) - tan(alpha)]: it stops below v_c = (mu_s - tan alpha) sqrt(g0 cos alpha d_c/(mu_s -
  // mu_d)), after the time atanh(v0/v_c)/kappa, kappa^2 = g0 cos alpha (mu_s - mu_d)/d_c.
  const double slope = std::atan(0.35), g0 = 9.81, mass = 2, d_c = 1e-5;
  oscillators::Model model;
  model.law = laws::find_law("slip-distance");
  model.slider = {.mass = mass, .stiffness = 0, .damping = 0};
  model.drive = {0.0, mass * g0 * std::cos(slope), -mass * g0 * std::sin(slope)};
  const double kappa = std::sqrt(g0 * std::cos(slope) * 0.1 / d_c), critical = 0.05 * d_c / 0.1 * kappa;
  CHECK(critical == Approx((0.4 - 0.35) * std::sqrt(g0 * std::cos(slope) * d_c / 0.1)).epsilon(1e-14));
  analysis::motion::RunOptions options;
  options.duration = 0.2;
  options.samples = 4;
  options.start.kind = analysis::motion::Start::Kind::given;
  options.start.states = {{"s", 0.0}};
  for (const double part : {0.3, 0.999, 0.999999}) {
    options.start.slip_rate = part * critical;
    const auto run = analysis::motion::run(model, options);
    REQUIRE(run.outcome.complete());
    REQUIRE(run.events.size() == 1);
    CHECK(run.events[0].kind == "stick");
    CHECK(run.events[0].time == Approx(std::atanh(part) / kappa).epsilon(1e-8));
    CHECK(run.columns[2].back() == 0);
    CHECK(run.columns[5].back() == 0);  // whole again
  }
  options.start.slip_rate = 1.000001 * critical;
  const auto run = analysis::motion::run(model, options);
  REQUIRE(run.outcome.complete());
  CHECK(run.events.empty());
  CHECK(run.columns[2].back() > 10 * critical);
}

TEST_CASE("slip-distance: stick-slip in closed form, with Coulomb friction as its limit", "[laws][slip-distance]") {
  // From onset at X0 = N (mu_s - mu_d)/k slip feeds itself, s = kV/(m c^2) (sinh(ct)/c - t), c^2 = (kX0/d_c - k)/m,
  // until s = d_c; then X = R cos(wt + phi) until the slider moves with the drive again; then it sticks up to X0.
  const double m = 1, k = 1.09, V = 0.01, N = 2, w = std::sqrt(k / m), X0 = N * 0.1 / k;
  oscillators::Model model;
  model.slider = {.mass = m, .stiffness = k, .damping = 0};
  model.drive = {V, N, 0.0};
  for (const double d_c : {1e-2, 1e-4, 1e-6}) {
    CAPTURE(d_c);
    model.law = laws::find_law("slip-distance")->with("d_c", d_c);
    const auto cycle = analysis::cycles::find_cycle(model);
    REQUIRE(cycle.outcome.complete());
    const double c = std::sqrt((k * X0 / d_c - k) / m), pull = k * V / (m * c * c);
    std::uintmax_t iterations = 200;
    const auto [low, high] =
        boost::math::tools::toms748_solve([&](double t) { return pull * (std::sinh(c * t) / c - t) - d_c; }, 0.1 / c,
                                          30 / c, boost::math::tools::eps_tolerance<double>(52), iterations);
    const double t1 = 0.5 * (low + high), u1 = pull * (std::cosh(c * t1) - 1);
    const double X1 = X0 + V * t1 - d_c, R = std::hypot(X1, (V - u1) / w), phi = std::atan2((u1 - V) / w, X1);
    const double t2 = (std::numbers::pi + std::asin(V / (R * w)) - phi) / w;
    const double stick = (X0 + std::sqrt(R * R - V * V / (w * w))) / V;
    CHECK(cycle.metrics.period == Approx(t1 + t2 + stick).epsilon(1e-9));
    CHECK(std::abs(cycle.metrics.period - (t1 + t2 + stick)) <= cycle.error.period);
    CHECK(cycle.metrics.slip_rate_max == Approx(V + R * w).epsilon(1e-9));
    CHECK(cycle.metrics.stick_fraction == Approx(stick / (t1 + t2 + stick)).epsilon(1e-9));
    CHECK(cycle.stable);
    CHECK(std::abs(cycle.multipliers.at(0)) < 1e-6);  // every stop makes the contact whole
    if (d_c == 1e-6) CHECK(cycle.metrics.period == Approx(39.806257042379).epsilon(2e-3));  // Coulomb friction
  }
}
