/// Parameter planes: regimes, threshold, folds, independence of threads, resumption.
#include "analysis/planes/map.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/coexistence.hpp"
#include "analysis/steady/stability.hpp"
#include "core/stop.hpp"
#include "laws/catalogue.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::planes;
using rosin::tests::bristol_board;
using rosin::tests::slider_under;

namespace {
MapOptions small_plane(int points) {
  MapOptions options;
  options.x = make_axis("drive.normal_load", 9.81e-8, 9.81, points, true, {});
  options.y = make_axis("law.lambda", 1e-4, 1e2, points, true, {0});
  options.metrics = {"stick_fraction", "loop_area"};
  return options;
}
}  // namespace

TEST_CASE("a coarse plane of Fig 2: regimes by the closed form, metrics by the cycle", "[map]") {
  const auto model = bristol_board(1e-4, 10);
  auto options = small_plane(9);
  options.metrics.clear();
  for (const auto& metric : cycles::metric_names()) options.metrics.emplace_back(metric.name);
  const Map map = compute_map(model, options);
  REQUIRE(map.outcome.complete());
  const std::size_t nx = map.x.values.size();
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto here = model.with("drive.normal_load", map.x.values[i % nx]).with("law.lambda", map.y.values[i / nx]);
    const auto critical = steady::critical_load(here);
    const bool stable = critical && here.drive.normal_load.level() < critical->normal_load;
    INFO(map.x.values[i % nx] << " " << map.y.values[i / nx]);
    CHECK(map.points[i].regime == (stable ? Regime::stable : Regime::cycle));
    CHECK((map.points[i].origin == Origin::computed) == !stable);  // what linear stability decides is not integrated
  }
  CHECK(map.integrated + map.skipped == long(map.points.size()));
  // Scattered points against a hundred-thousandfold finer tolerance.
  for (const std::size_t i : {3ul, 22ul, 40ul, 61ul, 85ul}) {
    const auto here = model.with("drive.normal_load", map.x.values[i % nx]).with("law.lambda", map.y.values[i / nx]);
    const cycles::Cycle fine = cycles::find_cycle(here, {.tolerance = 1e-10});
    const auto& point = map.points[i];
    for (const auto& metric : cycles::metric_names()) {
      INFO(metric.name << " at " << i);
      CHECK(std::abs(point.metrics.*metric.member - fine.metrics.*metric.member) <=
            point.error.*metric.member + fine.error.*metric.member);
    }
  }
}

TEST_CASE("Coulomb friction sticks and slips beside stable sliding where the damped swing comes back to rest",
          "[map]") {
  // After the onset of slip w = u - V = R e^(-zeta w0 t) sin(wd t - phi): w = -V, dw/dt = (mu_s - mu_d) N/m at t = 0.
  Model model;
  model.law = laws::find_law("coulomb");
  model.slider = {2, 50, 0};
  model.drive.speed = 0.01;
  const double V = 0.01, w0 = 5;
  MapOptions options;
  options.x = make_axis("drive.normal_load", 0.1, 10, 7, true, {});
  options.y = make_axis("oscillator.damping", 0.02, 12, 7, true, {});
  options.metrics = {"period", "friction_mean"};
  const Map map = compute_map(model, options);
  REQUIRE(map.outcome.complete());
  int sticking = 0;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const double N = map.x.values[i % 7], c = map.y.values[i / 7];
    const double zeta = c / (2 * std::sqrt(100.0)), wd = w0 * std::sqrt(1 - zeta * zeta);
    const double B = (0.1 * N / 2 - zeta * w0 * V) / wd, R = std::hypot(V, B), phase = std::atan2(V, B);
    const double highest = (std::acos(zeta) + phase) / wd, lowest = highest + std::numbers::pi / wd;
    const double depth = R * std::sqrt(1 - zeta * zeta) * std::exp(-zeta * w0 * lowest) - V;
    INFO("N = " << N << ", c = " << c << ", slip goes on to " << depth / V << " V beyond rest");
    REQUIRE(std::abs(depth) > 1e-3 * V);
    CHECK(map.points[i].regime == (depth > 0 ? Regime::bistable : Regime::stable));
    if (depth < 0) continue;
    ++sticking;
    const cycles::Cycle fine =
        cycles::find_cycle(model.with("drive.normal_load", N).with("oscillator.damping", c), {.tolerance = 1e-9});
    for (const auto member : {&cycles::Metrics::period, &cycles::Metrics::friction_mean})
      CHECK(std::abs(map.points[i].metrics.*member - fine.metrics.*member) <=
            map.points[i].error.*member + fine.error.*member);
  }
  CHECK((sticking > 10 && sticking < 40));
}

TEST_CASE("the threshold line is the closed form to rounding", "[map]") {
  auto options = small_plane(7);
  const auto model = bristol_board(1e-4, 10);
  const Map map = compute_map(model, options);
  int points = 0;
  for (std::size_t i = 0; i < map.threshold.x.size(); ++i) {
    if (std::isnan(map.threshold.x[i])) continue;
    // N_c = A λ − B/λ with A, B by Newton in 40 digits.
    const double lambda = map.threshold.y[i], expected = 7.27463458903e-5 * lambda - 3.18688318336e-3 / lambda;
    CHECK(std::abs(map.threshold.x[i] - expected) < 1e-10 * map.threshold.x[i] + 1e-11 * lambda * 7.3e-5);
    ++points;
  }
  CHECK(points >= 5);
}

TEST_CASE("a numerically traced threshold equals the closed form", "[map]") {
  // The load kept out of the axes: λ against stiffness.
  const auto model = bristol_board(1e-4, 10);
  MapOptions options;
  options.x = make_axis("oscillator.stiffness", 0.6, 6, 6, true, {});
  options.y = make_axis("law.lambda", 5, 50, 4, true, {});
  options.metrics = {"period"};
  const Map map = compute_map(model, options);
  int points = 0;
  for (std::size_t i = 0; i < map.threshold.x.size(); ++i) {
    if (std::isnan(map.threshold.x[i])) continue;
    const auto here = model.with("oscillator.stiffness", map.threshold.x[i]).with("law.lambda", map.threshold.y[i]);
    REQUIRE(steady::critical_load(here));
    CHECK(steady::critical_load(here)->normal_load == Approx(model.drive.normal_load.level()).epsilon(1e-10));
    ++points;
  }
  CHECK(points >= 4);
}

TEST_CASE("results do not depend on threads, and known points are not computed again", "[map]") {
  const auto model = bristol_board(1e-4, 10);
  auto options = small_plane(4);
  const Map one = compute_map(model, options);
  options.threads = 3;
  int computed = 0;
  MapHooks hooks;
  hooks.known = [&](std::size_t i) { return i % 2 == 0 ? std::optional(one.points[i]) : std::nullopt; };
  hooks.finished = [&](auto indices, const auto&) { computed += int(indices.size()); };
  const Map resumed = compute_map(model, options, hooks);
  CHECK(computed == int(one.points.size() / 2));
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    CHECK(one.points[i].regime == resumed.points[i].regime);
    for (const auto& metric : cycles::metric_names()) {
      const double a = one.points[i].metrics.*metric.member, b = resumed.points[i].metrics.*metric.member;
      CHECK((a == b || (std::isnan(a) && std::isnan(b))));
    }
  }
}

TEST_CASE("a large plane from few points agrees with the plane of all points", "[map][long]") {
  const auto model = bristol_board(1e-4, 10);
  auto options = small_plane(100);
  options.tolerance = 1e-3;
  REQUIRE(interpolates(options));
  const Map few = compute_map(model, options);
  auto exact = options;
  exact.exact = true;
  exact.tolerance = 1e-6;
  REQUIRE_FALSE(interpolates(exact));
  const Map all = compute_map(model, exact);
  CHECK(few.integrated + few.interpolated + few.skipped == long(few.points.size()));
  CHECK(all.interpolated == 0);
  CHECK(few.integrated < all.integrated / 3);
  CHECK(few.threshold.x == all.threshold.x);
  long points = 0, beyond_stated = 0, beyond_tolerance = 0;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const auto &a = few.points[i], &b = all.points[i];
    CHECK(a.regime == b.regime);
    if (b.regime != Regime::cycle) continue;
    for (const auto& name : options.metrics) {
      const auto& metric = cycles::find_metric(name);
      const double off = std::abs(a.metrics.*metric.member - b.metrics.*metric.member);
      const double stated = a.error.*metric.member + b.error.*metric.member;
      ++points;
      beyond_stated += !(off <= stated);
      // The loop area is held against a tenth of v_max μ_max at least; v_max is not among the metrics: against itself.
      if (name == "stick_fraction") beyond_tolerance += !(off <= options.tolerance + stated * 0.01);
    }
  }
  CHECK(beyond_stated * 100 < points);
  CHECK(beyond_tolerance * 1000 <= points);

  // Threads and an interruption leave no trace.
  options.threads = 3;
  MapHooks hooks;
  const int nx = int(few.x.values.size());
  hooks.known = [&](std::size_t i) { return int(i / nx) < 60 ? std::optional(few.points[i]) : std::nullopt; };
  const Map resumed = compute_map(model, options, hooks);
  for (std::size_t i = 0; i < few.points.size(); ++i) {
    CHECK(few.points[i].origin == resumed.points[i].origin);
    const double a = few.points[i].metrics.loop_area, b = resumed.points[i].metrics.loop_area;
    CHECK((a == b || (std::isnan(a) && std::isnan(b))));
  }
}

TEST_CASE("a stop is obeyed and said", "[map]") {
  std::stop_source stop;
  MapHooks hooks;
  hooks.finished = [&](auto, const auto&) { stop.request_stop(); };
  const Listening listening(stop.get_token());
  CHECK(compute_map(bristol_board(1e-4, 10), small_plane(4), hooks).outcome.ending == Ending::interrupted);
}

TEST_CASE("folds below subcritical borders", "[map]") {
  // V = 1e-6 m/s, log10 λ = 0.6: N_fold/N_Hopf = 0.99617; V = 1e-5 m/s: down to 0.99963 within log10 λ = 1.32 … 1.57.
  const auto slow = bristol_board(1e-4, std::pow(10, 0.6), 1e-6);
  const double hopf = steady::critical_load(slow)->normal_load;
  CHECK(cycles::fold_of_cycles(slow, hopf) / hopf == Approx(0.99617).margin(5e-6));
  double lowest = 1;
  for (const double exponent : {1.41, 1.43, 1.45, 1.47}) {
    const auto model = bristol_board(1e-4, std::pow(10, exponent));
    const double border = steady::critical_load(model)->normal_load;
    lowest = std::min(lowest, cycles::fold_of_cycles(model, border) / border);
  }
  CHECK(lowest == Approx(0.99963).margin(1e-5));
}

TEST_CASE("the fold of cycles is traced along the other axis of the load", "[map]") {
  MapOptions options;
  options.y = make_axis("drive.normal_load", 1e-6, 1, 2, true, {});
  options.x = make_axis("law.lambda", 1e-4, 1e2, 2, true, {});
  options.metrics = {"period"};
  const auto slow = bristol_board(1e-4, 1, 1e-6);
  const cycles::FoldLine line = cycles::trace_folds(slow, "law.lambda", 1e-4, 1e2, true, 49, 2e-6);
  REQUIRE(line.stretches.size() == 1);
  const auto& stretch = line.stretches.front();
  // A strip of coexistence for log10 λ between 0.28 and 1.10; N_fold/N_Hopf = 0.99617 at 0.6.
  CHECK(stretch.begin / std::log(10) == Approx(0.29).margin(0.015));
  CHECK(stretch.end / std::log(10) == Approx(1.10).margin(0.015));
  CHECK(std::exp(stretch.log_ratio(0.6 * std::log(10))) == Approx(0.99617).margin(5e-6));
  CHECK(stretch.error < 2.3e-6);  // 1e-6 decades
  // Between the nodes, against folds searched for by themselves.
  for (const double exponent : {0.33, 0.47, 0.71, 0.98, 1.07}) {
    const auto here = slow.with("law.lambda", std::pow(10, exponent));
    const double hopf = steady::critical_load(here)->normal_load, alone = cycles::fold_of_cycles(here, hopf);
    CHECK(std::abs(stretch.log_ratio(exponent * std::log(10)) - std::log(alone / hopf)) < stretch.error);
  }
  // In the map, along whichever axis; the Hopf load is the closed form.
  const Map map = compute_map(slow, options);
  REQUIRE(map.fold.x.size() == map.fold.y.size());
  REQUIRE(map.fold.x.size() > 30);
  CHECK(map.fold_error < 1e-6);
  for (std::size_t i = 0; i < map.fold.x.size(); ++i) {
    const double hopf = steady::critical_load(slow.with("law.lambda", map.fold.x[i]))->normal_load;
    CHECK(map.fold.y[i] <= hopf * (1 + 1e-9));
    CHECK(map.fold.y[i] >= 0.996 * hopf);
  }
}

TEST_CASE("cycles beside stable sliding: a bistable point", "[map]") {
  MapOptions options;
  options.x = make_axis("drive.normal_load", 0.09, 0.0981, 2, false, {});
  options.y = make_axis("law.lambda", 0.5, 1, 2, false, {});
  options.metrics = {"period"};
  const Map map = compute_map(bristol_board(1e-2, 1, 1e-3), options);
  for (const auto& point : map.points) CHECK(point.regime == Regime::bistable);
  CHECK(map.points.back().metrics.period == Approx(21.782286).epsilon(1e-6));
  // Inside the subcritical strip: 0.99975 of the Hopf load at log10 λ = 1.45.
  const auto strip = bristol_board(1e-4, std::pow(10, 1.45));
  const double load = 0.99975 * steady::critical_load(strip)->normal_load;
  options.x = make_axis("drive.normal_load", 0.5 * load, load, 2, false, {});
  options.y = make_axis("law.lambda", strip.lambda, 1.001 * strip.lambda, 2, false, {});
  const Map border = compute_map(strip, options);
  CHECK(border.points[0].regime == Regime::stable);
  CHECK(border.points[0].origin == Origin::decided);
  CHECK(border.points[1].regime == Regime::bistable);
}

TEST_CASE("axes that cannot be are refused", "[map]") {
  CHECK_THROWS_AS(make_axis("drive.speed", 1, 2, 1, true, {}), InputError);
  CHECK_THROWS_AS(make_axis("drive.speed", -1, 2, 5, true, {}), InputError);
  CHECK_THROWS_AS(make_axis("drive.speed", 1, 1, 5, true, {}), InputError);
  auto options = small_plane(3);
  options.x = make_axis("law.a", 0.01, 3, 3, true, {});
  CHECK_THROWS_WITH(compute_map(bristol_board(1e-4, 10), options), Catch::Contains("law.a = 3"));
}

TEST_CASE("a search beside a neighbour's cycle that dies out goes on from stick", "[map][long]") {
  // Slip at 10⁹ times what friction does in a turn: the neighbour's motion is a swing whose start is its own.
  Model model;
  model.law = laws::find_law("two-state-ageing");
  model.slider = {.mass = 1, .stiffness = 1e9, .damping = 0};
  model.drive = {.speed = 2e-4, .normal_load = 9.81, .force = 0.0};
  for (const auto& [path, value] : {std::pair{"law.a", 0.018}, {"law.L1", 2.5e-8}, {"law.b2", 0.5}, {"law.L2", 9e-5}})
    model = model.with(path, value);
  MapOptions options;
  options.x = {"drive.normal_load", {9.81}, 1};
  options.y = {"law.lambda", {1e-4, 1.0001e-4}, 2};
  options.tolerance = 1e-2;
  options.metrics = {"stick_fraction"};
  const Map map = compute_map(model, options);
  for (const auto& point : map.points) {
    INFO(point.why);
    CHECK(point.regime != Regime::failed);
  }
}
