/// Histories against exact velocity steps, a published rate-and-state case, and closed-form stick–slip.
#include "analysis/motion/run.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "tests/bristol_board.hpp"

using namespace rosin;
using namespace rosin::analysis;
using namespace rosin::analysis::motion;
using rosin::tests::bristol_board;
using rosin::tests::slider_under;

namespace {
constexpr int friction_column = 4;

/// An imposed step of slip rate at t = 1 s, sampled at the given times after it.
std::vector<double> after_step(const char* law, std::vector<Value> values, double lambda, double before, double after,
                               std::vector<double> times, const std::string& solver) {
  auto model = slider_under(law, std::move(values), {0, infinity, 0}, before, 1);
  model.lambda = lambda;
  model.drive.speed = Signal(Signal::Steps{{{0, before}, {1, after}}});
  for (double& t : times) t += 1;
  RunOptions options;
  options.times = times;
  options.duration = times.back();
  options.tolerance = solver == "cvode" ? 1e-9 : 1e-10;  // BDF does not reach it for every law
  options.solver = solver;
  const Run result = run(model, options);
  REQUIRE(result.outcome.complete());
  CHECK(result.column_error[friction_column] < options.tolerance);
  return result.columns[friction_column];
}
void check(const std::vector<double>& found, const std::vector<double>& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - expected[i]) < 1e-11);
}
}  // namespace

TEST_CASE("velocity steps are exact for ageing, slip and spinodal laws", "[run][long]") {
  const std::string solver = GENERATE("auto", "cvode");
  const std::vector<Value> rock = {0.6, 0.010, 0.015, 1e-5, 1e-6};
  check(after_step("ageing", rock, 1, 1e-6, 1e-5, {0, 0.05, 0.5, 1, 3, 10}, solver),
        {0.62302585092994, 0.62235256109141, 0.61646867178205, 0.61040432711105, 0.59404069010018, 0.58849320227374});
  check(after_step("slip", rock, 1, 1e-6, 1e-5, {0, 0.05, 0.5, 1, 3, 10}, solver),
        {0.62302585092994, 0.62134137492812, 0.6094359013675, 0.60119318029393, 0.59020665895675, 0.58848864259305});
  check(after_step("slip", rock, 1, 1e-5, 1e-6, {0, 1, 10, 30}, solver),
        {0.56546122360509, 0.56874802274471, 0.58729389424109, 0.59828041557828});
  const auto board = laws::find_law("spinodal")->values();
  check(after_step("spinodal", board, 1, 1e-6, 1e-5, {0, 0.03, 0.3, 1, 5}, solver),
        {0.44940909531201, 0.4350257152238, 0.35102675108649, 0.33769013789609, 0.33768376115358});
  check(after_step("spinodal", board, 10, 1e-5, 1e-6, {0, 1, 5, 20, 60}, solver),
        {0.25732355502907, 0.28964440243281, 0.33391676336368, 0.36415700064572, 0.36899655579644});
}

TEST_CASE("a sample at a step of the drive has the friction after it, the last one too", "[run]") {
  // Under an imposed slip rate friction jumps by a ln 10 = 0.0230258509299 where the rate rises tenfold.
  auto model = slider_under("ageing", {0.6, 0.010, 0.015, 1e-5, 1e-6}, {0, infinity, 0}, 1e-6, 1);
  model.drive.speed = Signal(Signal::Steps{{{0, 1e-6}, {1, 1e-5}}});
  RunOptions options;
  options.solver = GENERATE("auto", "collocation");
  options.times = GENERATE(std::vector<double>{0.5, 1}, std::vector<double>{1}, std::vector<double>{0.5, 1, 2});
  options.duration = options.times.back();
  const Run result = run(model, options);
  REQUIRE(result.outcome.complete());
  const auto at_step = std::ranges::find(result.time, 1.0) - result.time.begin();
  CHECK(result.columns[friction_column][at_step] == Approx(0.6230258509299).epsilon(1e-11));
}

TEST_CASE("rsfmodel's published velocity step through a loading spring", "[run]") {
  // Leeman, May & Marone (2016): a 0.005, b 0.01, Dc 10 µm, k/N = 1e-3 per µm, 1 to 10 µm/s at t = 10 s.
  auto model = slider_under("ageing", {0.6, 0.005, 0.01, 1e-5, 1e-6}, {0, 1e3, 0}, 1e-6, 1);
  model.drive.speed = Signal(Signal::Steps{{{0, 1e-6}, {10, 1e-5}}});
  RunOptions options;
  options.duration = 40;
  options.samples = 40;
  options.tolerance = 1e-9;
  options.solver = GENERATE("auto", "cvode");
  const Run result = run(model, options);
  REQUIRE(result.outcome.complete());
  const auto& mu = result.columns[friction_column];
  CHECK(std::abs(mu[11] - 0.60720485) < 1e-8);
  CHECK(std::abs(mu[13] - 0.58400910) < 1e-8);
  CHECK(*std::min_element(mu.begin(), mu.end()) == mu[13]);
  CHECK(std::abs(mu[40] - 0.58848708) < 1e-8);
  CHECK(result.column_error[friction_column] < 1e-9);
}

TEST_CASE("a stiffer loading spring, ageing and slip", "[run]") {
  struct Case {
    const char* law;
    std::vector<double> friction;
  };
  const auto c =
      GENERATE(Case{"ageing", {0.605207233704, 0.617672038645, 0.606071407260, 0.588166623558, 0.588487074534}},
               Case{"slip", {0.605206832460, 0.615352660316, 0.585160247282, 0.588611242538, 0.588487074535}});
  auto model = slider_under(c.law, {0.6, 0.010, 0.015, 1e-5, 1e-6}, {0, 3e3, 0}, 1e-6, 1);
  model.drive.speed = Signal(Signal::Steps{{{0, 1e-6}, {1, 1e-5}}});
  RunOptions options;
  options.times = {1.2, 2, 3, 6, 21};
  options.duration = 21;
  options.tolerance = 1e-10;
  const Run result = run(model, options);
  for (int i = 0; i < 5; ++i) CHECK(std::abs(result.columns[friction_column][i] - c.friction[i]) < 1e-11);
}

namespace {
/// The single-degree stick–slip case of QDYN (Luo et al. 2017), per unit area.
Model earthquakes() { return slider_under("ageing", {0.6, 0.01, 0.025, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 1e-6, 5e6); }
RunOptions from_creep(double theta, double slip_rate, double duration) {
  RunOptions options;
  options.duration = duration;
  options.samples = 2;
  options.tolerance = 1e-9;
  options.start.kind = Start::Kind::given;
  options.start.slip_rate = slip_rate;
  options.start.states["theta"] = theta;
  return options;
}
}  // namespace

TEST_CASE("an earthquake cycle with radiation damping keeps the creep that follows to many digits", "[run]") {
  auto options = from_creep(10, 0.9e-6, 5000);
  options.solver = GENERATE("auto", "explicit", "collocation");
  options.tolerance = 1e-11;
  const Run result = run(earthquakes(), options);
  REQUIRE(result.outcome.complete());
  CHECK(result.solver == (options.solver == "collocation" ? "collocation" : "explicit"));
  // ln v after 5000 s: −27.8503968 is printed; further digits from an 8th order method in extended precision.
  CHECK(std::abs(std::log(result.columns[2].back()) + 27.8503968238) < 1e-8);
  CHECK(result.column_error[2] / result.columns[2][1] < 1e-3);
}

TEST_CASE("explicit steps and collocation agree on many laws, loads and drives", "[run]") {
  struct Case {
    const char* what;
    const char* law;
    std::vector<Value> values;
    oscillators::Slider slider;
    double load;
  };
  const std::vector<Value> two = {0.6, 0.01, 0.02, 1e-5, 0.005, 1e-4, 1e-6};
  const auto c =
      GENERATE_COPY(Case{"earthquakes", "ageing", {0.6, 0.01, 0.025, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 5e6},
                    Case{"earthquakes, slip law", "slip", {0.6, 0.01, 0.014, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 5e6},
                    Case{"earthquakes, prz law", "prz", {0.6, 0.01, 0.02, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 5e6},
                    Case{"two states", "two-state-ageing", two, {0, 2e9, 2e10 / 6000}, 5e6},
                    Case{"strengthening", "ageing", {0.6, 0.015, 0.010, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 5e6},
                    Case{"spinodal", "spinodal", laws::find_law("spinodal")->values(), {0, 30, 1e-3}, 1e-3},
                    Case{"heavy damper", "ageing", {0.6, 0.01, 0.025, 1e-5, 1e-6}, {0, 2e9, 1e12}, 5e6},
                    Case{"light damper", "ageing", {0.6, 0.01, 0.025, 1e-5, 1e-6}, {0, 2e9, 1e4}, 5e6},
                    Case{"stiff spring, no damper", "ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {0, 3e3, 0}, 1});
  const int drive = GENERATE(0, 1, 2);
  INFO(c.what << ", drive " << drive);
  auto model = slider_under(c.law, c.values, c.slider, 1e-6, c.load);
  if (drive == 1) model.drive.speed = Signal(Signal::Steps{{{0, 1e-6}, {150, 3e-5}, {200, 1e-7}}});
  if (drive == 2) model.drive.speed = Signal(Signal::Harmonics{1e-6, {{5e-7, 0.1, 0.3}}});
  RunOptions options;
  options.duration = 400;
  options.samples = 100;
  options.tolerance = 1e-8;
  options.start.kind = Start::Kind::given;
  options.start.slip_rate = 0.9e-6;
  const Run quick = run(model, options);
  options.solver = "collocation";
  const Run sure = run(model, options);
  INFO(quick.outcome.detail << " / " << sure.outcome.detail << " / " << quick.why);
  REQUIRE(quick.solver == "explicit");
  REQUIRE(sure.outcome.complete());
  REQUIRE(quick.outcome.complete());
  for (std::size_t column = 0; column < sure.columns.size(); ++column) {
    INFO(sure.column_names[column]);
    for (std::size_t i = 0; i < sure.time.size(); ++i)
      CHECK(std::abs(quick.columns[column][i] - sure.columns[column][i]) /
                (quick.column_error[column] + sure.column_error[column]) <=
            1);
  }
}

TEST_CASE("a run that starts in steady sliding stays there, whichever way it goes", "[run]") {
  // Friction of the Stribeck curve at v_s: mu_d + (mu_s − mu_d)/e.
  for (const double speed : {1e-3, -1e-3}) {
    const auto model = slider_under("stribeck", {0.4, 0.3, 1e-3, 1.0, 0.0}, {1, 100, 0.5}, speed, 2);
    RunOptions options;
    options.duration = 10;
    const auto found = run(model, options);
    REQUIRE(found.outcome.complete());
    CHECK(found.cost.steps == 0);
    CHECK(found.columns[2].back() == speed);
    CHECK(found.columns[3].back() == Approx(std::copysign(2 * (0.3 + 0.1 / std::numbers::e), speed)).epsilon(1e-14));
  }
}

TEST_CASE("in the first instants of a motion from rest friction follows the spring at once", "[run]") {
  // The contact sticks, so that the spring is loaded by V t, and friction by k V t.
  const double V = 0.8, k = 9500;
  auto model = slider_under("slip", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {20, k, 0}, V, 0.14);
  RunOptions options;
  options.start.kind = Start::Kind::rest;
  for (const double duration : {1e-9, 1e-7}) {
    INFO("duration " << duration);
    options.duration = duration;
    const auto found = run(model, options);
    REQUIRE(found.outcome.complete());
    CHECK(found.columns[3].back() == Approx(k * V * duration).epsilon(1e-8));
  }
}

TEST_CASE("explicit steps give way where stability holds them, unless they were asked for", "[run]") {
  // Strengthening friction under a steady drive: after a while nothing changes, but contacts renew every second.
  auto model = slider_under("ageing", {0.6, 0.015, 0.010, 1e-5, 1e-6}, {0, 2e9, 2e10 / 6000}, 1e-5, 5e6);
  auto options = from_creep(1, 2e-5, 1e5);
  const Run given_way = run(model, options);
  REQUIRE(given_way.outcome.complete());
  CHECK_THAT(given_way.why, Catch::Contains("collocation from there"));
  options.solver = "explicit";
  const Run held = run(model, options);
  REQUIRE(held.outcome.complete());
  CHECK(held.cost.steps > 20 * given_way.cost.steps);
  CHECK(held.columns[2].back() == Approx(given_way.columns[2].back()).epsilon(1e-9));
  // Inertia is stiff in near-stick: no explicit steps there, and a reason why.
  options.start.states.clear();
  CHECK_THROWS_WITH(run(bristol_board(1e-4, 10), options), Catch::Contains("without mass"));
  options.solver = "auto";
  options.duration = 1;
  CHECK(run(bristol_board(1e-4, 10), options).solver == "collocation");
}

TEST_CASE("Coulomb stick-slip from rest switches at the closed-form times", "[run]") {
  RunOptions options;
  options.duration = 200;
  options.samples = 400;
  options.start.kind = Start::Kind::rest;
  const Run result = run(slider_under("coulomb", {0.4, 0.3}, {1, 1.09, 0}, 0.01, 2), options);
  REQUIRE(result.outcome.complete());
  REQUIRE(result.events.size() == 8);
  const double first = 0.4 * 2 / 1.09 / 0.01, slip = 3.1090093359567, period = 39.806257042379;
  for (int i = 0; i < 8; ++i) {
    CHECK(result.events[i].kind == (i % 2 == 0 ? "slip" : "stick"));
    CHECK(result.events[i].time == Approx(first + i / 2 * period + i % 2 * slip).epsilon(1e-11));
  }
  // In stick the slip rate is exactly zero.
  CHECK(result.columns[2][10] == 0);
}

TEST_CASE("a force that turns over makes a block reverse, and weak ones leave it at rest", "[run]") {
  auto model = slider_under("coulomb", {0.4, 0.4}, {1, 1, 0.1}, 1, 1);
  model.drive.speed = 0.0;
  RunOptions options;
  options.duration = 20;
  options.start.kind = Start::Kind::rest;
  model.drive.force = Signal(Signal::Harmonics{0, {{0.39, 1.0, 0.0}}});
  const Run held = run(model, options);
  CHECK(held.events.empty());
  CHECK(held.metrics.at("slip_rate_max") == 0);
  model.drive.force = Signal(Signal::Harmonics{0, {{2.0, 1.0, 0.0}}});
  const Run moved = run(model, options);
  REQUIRE(moved.outcome.complete());
  int turns = 0;
  for (const auto& e : moved.events) turns += e.kind == "reversal" || e.kind == "slip";
  CHECK(turns >= 6);
  CHECK(moved.metrics.at("slip_rate_min") < -0.1);
  // Energy: the force works against friction and damper, the spring returns what it took (checked over the record).
  CHECK(moved.column_error[0] < 1e-6);
}

TEST_CASE("without load a slider swings freely, whatever lies between it and the contact", "[run]") {
  const double m = 2, k = 50, c = 0.4, V = 1e-3, u0 = 3e-3, decay = c / (2 * m);
  const double ringing = std::sqrt(k / m - decay * decay);
  auto model = slider_under("ageing", {0.6, 0.015, 0.010, 1e-5, 1e-6}, {m, k, c}, V, 0);
  RunOptions options;
  options.duration = 5;
  options.start.kind = Start::Kind::given;
  options.start.slip_rate = u0;
  for (const auto& [tangential, per_load] : {std::pair(infinity, infinity), {7.0, infinity}, {infinity, 3.0}}) {
    model.contact_stiffness.tangential = tangential;
    model.contact_stiffness.per_load = per_load;
    const auto motion = run(model, options);
    REQUIRE(motion.outcome.complete());
    // From the balance of spring and damper: m w'' + c w' + k w = 0 of w = u - V with w'(0) = 0.
    const double w =
        (u0 - V) * std::exp(-decay * 5) * (std::cos(ringing * 5) + decay / ringing * std::sin(ringing * 5));
    CHECK(std::abs(motion.columns[2].back() - (V + w)) < 1e-8 * u0);
    CHECK(motion.columns[3].back() == 0);
  }
}

TEST_CASE("samples that all fall on zeros of the displacement do not make it unknown", "[run]") {
  // Friction of 1e-9 N on a block that swings by V/ω on its spring, sampled once in fifteen turns.
  const double k = 5.762257280597793, m = 4.7346221275764303e-05, V = 0.00013501899968, load = 1.68254477e-09;
  const double omega = std::sqrt(k / m), turns = 15;
  auto model = slider_under("slip-distance", {0.623, 0.115, 0.183}, {m, k, 0}, V, load);
  RunOptions options;
  options.start.kind = Start::Kind::rest;
  options.samples = 20;
  options.duration = options.samples * turns * 2 * std::numbers::pi / omega;
  options.tolerance = 1e-6;
  const auto result = run(model, options);
  REQUIRE(result.outcome.complete());
  const double swing = V / omega, pushed = 0.623 * load / k;
  CHECK(result.column_error[0] <= 1e-6 * swing);
  // A constant friction shifts the swing by what it stretches the spring, and turns it by no more.
  for (const double x : result.columns[0]) CHECK(std::abs(x) < 4 * options.samples * turns * pushed);
}

TEST_CASE("wrong runs are refused before any work", "[run]") {
  const auto model = bristol_board(1e-4, 10);
  RunOptions options;
  options.solver = "cvod";
  CHECK_THROWS_WITH(run(model, options), Catch::Contains("did you mean 'cvode'"));
  options.solver = "events";
  CHECK_THROWS_WITH(run(model, options), Catch::Contains("set-valued") || Catch::Contains("smooth"));
  options.solver = "auto";
  options.duration = -1;
  CHECK_THROWS_AS(run(model, options), InputError);
  options.duration = 1;
  options.start.kind = Start::Kind::given;
  options.start.states["phi"] = 0.5;
  CHECK_THROWS_WITH(run(model, options), Catch::Contains("no state 'phi'"));
  options.start.states = {{"psi", 2.0}};
  CHECK_THROWS_WITH(run(model, options), Catch::Contains("outside"));
  options = {};
  options.duration = NAN;
  CHECK_THROWS_AS(run(model, options), InputError);
}

TEST_CASE("a start that rings on a stiff film is followed, and its force is that of the film", "[run]") {
  const double m = 3.3e-5, c = 1.28, k = 234, V = 1e-6, N = 3e-7, lambda = 0.08;
  Model model;
  model.law = laws::find_law("film");
  model.lambda = lambda;
  model.slider = {m, k, c};
  model.drive = {V, N, 0.0};
  RunOptions options;
  options.start.kind = Start::Kind::rest;
  options.times = {1e-7, 3e-6, 1e-5, 4e-5};
  options.duration = 4e-5;
  options.tolerance = 1e-10;
  const auto record = run(model, options);
  REQUIRE(record.outcome.complete());
  // ẋ = V − u, m u̇ = k x + c ẋ − F, Ḟ = (A S/(λ d)) (u − v₀ F/(A τ*)), linear at so small a stress, by the classical
  // method in steps of a five-hundredth of the period.
  const auto of = [&](const char* name) { return model.law->parameter(name); };
  const double film = of("A") * of("S") / (lambda * of("d")), flow = of("v0") / (of("A") * of("tau_star"));
  using Motion = std::array<double, 3>;
  const auto rate = [&](const Motion& y) {
    return Motion{V - y[1], (k * y[0] + c * (V - y[1]) - y[2]) / m, film * (y[1] - flow * y[2])};
  };
  const auto moved = [](Motion y, const Motion& by, double h) {
    for (int i = 0; i < 3; ++i) y[i] += h * by[i];
    return y;
  };
  Motion y{};
  long step = 0;
  const double h = 2e-10;
  for (std::size_t i = 0; i < record.time.size(); ++i) {
    for (; step < std::lround(record.time[i] / h); ++step) {
      const auto k1 = rate(y), k2 = rate(moved(y, k1, h / 2)), k3 = rate(moved(y, k2, h / 2)),
                 k4 = rate(moved(y, k3, h));
      for (int j = 0; j < 3; ++j) y[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    CHECK(record.columns[3][i] == Approx(y[2]).epsilon(1e-5));
    CHECK(record.columns[3][i] == Approx(of("A") * record.columns[5][i]).epsilon(1e-12));
  }
}

TEST_CASE("a run that explicit steps cannot bring close enough goes on by collocation", "[run]") {
  // Stick and slip of a contact damped by radiation, to 1e-9 of its peak of slip, whose largest explicit steps and
  // collocation have alike.
  auto model =
      slider_under("ageing", {0.6, 0.002, 0.003, 20e-6, 1e-6}, {.mass = 0, .stiffness = 20, .damping = 0.3}, 10e-6, 1);
  RunOptions options;
  options.duration = 600;
  options.samples = 9999;
  options.start.kind = Start::Kind::given;
  options.start.slip_rate = 1e-6;
  options.start.states["theta"] = 20;
  options.tolerance = 1e-9;
  const auto result = run(model, options);
  CHECK(result.outcome.complete());
  CHECK(result.solver == "collocation");
  CHECK(result.metrics.at("slip_rate_max") == Approx(0.02777896611).epsilon(1e-9));
}

TEST_CASE("slip that reaches infinite speed is told so, although a step may pass over that moment", "[run]") {
  // Neither mass nor damping, 0.64 of the critical stiffness: slip diverges in finite time (Rice & Gu 1983).
  const auto model = slider_under(
      "ageing", {0.6482150458470213, 0.023946421924161236, 0.04128455196373481, 3.158949348528406e-06, 1e-06},
      {.mass = 0, .stiffness = 1807.0719277213511}, 6.49967161604592e-05, 0.5117072649749906);
  const auto cycle = cycles::find_cycle(model);
  CHECK(cycle.outcome.ending == Ending::none_exists);
  CHECK(cycle.outcome.detail.find("infinite speed") != std::string::npos);
}

TEST_CASE("a run tells how far each of its passes has come", "[run]") {
  for (const char* solver : {"collocation", "explicit", "cvode"}) {
    Model model = slider_under("ageing", {0.6, 0.01, 0.015, 1e-5, 1e-6}, {1, 100, 0.1}, 1e-4, 2);
    RunOptions how;
    how.start.kind = Start::Kind::given;
    how.start.slip_rate = 5e-5;
    how.duration = 3;
    how.solver = solver;
    if (how.solver == "explicit") model.slider.mass = 0;
    std::vector<double> parts;
    how.progress = [&](double part) { parts.push_back(part); };
    const auto record = run(model, how);
    INFO(solver << ": " << record.outcome.detail);
    int passes = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      CHECK(parts[i] > 0);
      if (i + 1 < parts.size() && parts[i + 1] > parts[i]) continue;
      CHECK(parts[i] == 1);
      ++passes;
    }
    CHECK(passes >= 2);
  }
}
