/// The published force algorithms: their errors against the exact motion, their orders, and what they refuse.
#include "solvers/force_algorithms/force_algorithms.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "core/error.hpp"
#include "solvers/stick_slip/exact.hpp"
#include "tests/solvers/stick_slip/stick_slip_cases.hpp"

using namespace rosin;
using namespace rosin::solvers;
using namespace rosin::solvers::force_algorithms;
using rosin::tests::StickSlipCase;

namespace {

Signal load_of(const StickSlipCase& c) { return Signal(Signal::Harmonics{c.Nc, {{c.Nv, c.wn, 0}}}); }
Signal force_of(const StickSlipCase& c) { return Signal(Signal::Harmonics{0, {{c.P, c.we, 0}}}); }
stick_slip::DryMass<1> mass_of(const StickSlipCase& c) {
  return {c.m, {c.k}, {c.c}, c.mus, c.muk, {0}, load_of(c), {force_of(c)}};
}

Track<1> follow(const StickSlipCase& c, const char* name, const Options& options) {
  const auto mass = mass_of(c);
  const double step = step_of(mass, options);
  const Forcing<1> forcing(mass, step, std::size_t(2 / step + 1e-9));
  return follow<1>(name, mass, forcing, options, {c.x0}, {0});
}

struct Found {
  double displacement = 0, velocity = 0;  ///< largest errors on the grid of steps
  Track<1> track;
};
Found errors(const StickSlipCase& c, const char* name, const Options& options) {
  Found found{0, 0, follow(c, name, options)};
  stick_slip::Exact<double> exact({c.m, c.k, c.c, c.mus, c.muk, 0, 0.0, load_of(c), force_of(c)});
  exact.start(0, c.x0, 0);
  exact.advance(2);
  for (const auto& point : found.track.points) {
    while (exact.time() < point.time && exact.time() < 2) exact.advance(2);
    const auto seen = exact.at(point.time);
    found.displacement = std::max(found.displacement, std::abs(seen.displacement - point.x[0]));
    found.velocity = std::max(found.velocity, std::abs(seen.velocity - point.v[0]));
  }
  return found;
}

}  // namespace

TEST_CASE("errors of the algorithms in seven cases are those of an independent implementation", "[algorithms]") {
  struct Expected {
    const char* name;
    bool restart_before, refusal;
    double transition_speed;
    double displacement[7], velocity[7];  ///< m, m/s
    int sticks[7];
  };
  // Steps 3.14e-4 s in the first case, a thousandth of the shortest period in the others.
  const Expected table[] = {
      {"cfm",
       true,
       true,
       1e-3,
       {1.710e-3, 2.204e-3, 2.667e-4, 1.879e-4, 9.250e-3, 7.729e-4, 2.193e-3},
       {3.291e-2, 4.240e-2, 4.631e-3, 3.508e-3, 1.346e-1, 2.326e-2, 4.317e-2},
       {0, 0, 0, 0, 0, 0, 0}},
      {"o-fbfm",
       true,
       true,
       1e-3,
       {7.098e-5, 1.235e-4, 5.619e-5, 1.624e-5, 1.152e-2, 7.729e-4, 1.183e-4},
       {1.465e-3, 2.565e-3, 1.169e-3, 3.379e-4, 1.971e-1, 2.326e-2, 2.463e-3},
       {3, 4, 2, 8, 2, 17, 2}},
      {"r-fbfm",
       true,
       true,
       1e-3,
       {8.496e-5, 1.235e-4, 5.619e-5, 1.624e-5, 7.463e-3, 1.340e-5, 1.308e-4},
       {1.700e-3, 2.565e-3, 1.169e-3, 3.379e-4, 1.421e-1, 4.059e-4, 2.463e-3},
       {3, 4, 2, 8, 1, 18, 2}},
      {"aabg-sdfm",
       true,
       true,
       1e-3,
       {7.098e-5, 1.235e-4, 5.619e-5, 1.624e-5, 4.385e-5, 7.729e-4, 1.183e-4},
       {1.465e-3, 2.565e-3, 1.572e-3, 3.426e-4, 9.546e-4, 2.326e-2, 2.463e-3},
       {3, 4, 2, 8, 1, 17, 2}},
      {"tr-sdfm",
       true,
       true,
       1e-3,
       {7.098e-5, 1.235e-4, 5.619e-5, 1.624e-5, 4.385e-5, 7.729e-4, 1.183e-4},
       {1.465e-3, 2.565e-3, 1.572e-3, 4.084e-4, 9.546e-4, 2.326e-2, 2.463e-3},
       {3, 4, 2, 8, 1, 17, 2}},
      {"tr-sdfm",
       false,
       false,
       1e-3,
       {7.098e-5, 1.235e-4, 5.619e-5, 1.624e-5, 4.385e-5, 7.125e-6, 1.183e-4},
       {1.465e-3, 2.565e-3, 1.169e-3, 4.083e-4, 9.546e-4, 6.889e-4, 2.463e-3},
       {3, 4, 2, 8, 1, 18, 2}},
      {"vlfm",
       true,
       true,
       5e-3,
       {1.884e-3, 2.546e-3, 1.182e-3, 7.166e-4, 9.504e-3, 8.342e-4, 2.396e-3},
       {3.625e-2, 4.899e-2, 1.543e-2, 1.355e-2, 1.337e-1, 2.500e-2, 4.521e-2},
       {0, 0, 0, 0, 0, 0, 0}},
      {"svlfm",
       true,
       true,
       1e-3,
       {1.672e-3, 2.242e-3, 2.250e-4, 2.729e-4, 9.226e-3, 7.591e-4, 2.151e-3},
       {3.218e-2, 4.313e-2, 3.828e-3, 4.799e-3, 1.345e-1, 2.285e-2, 4.238e-2},
       {0, 0, 0, 0, 0, 0, 0}},
  };
  for (const auto& expected : table)
    for (int i = 0; i < 7; ++i) {
      const auto& c = tests::stick_slip_cases()[i];
      INFO(expected.name << ", " << c.name << ", refusal " << expected.refusal);
      Options options;
      options.restart_before = expected.restart_before, options.refusal = expected.refusal;
      options.transition_speed = expected.transition_speed;
      if (i == 0) options.step = 3.14e-4;
      const auto found = errors(c, expected.name, options);
      CHECK(found.displacement == Approx(expected.displacement[i]).epsilon(1e-3));
      CHECK(found.velocity == Approx(expected.velocity[i]).epsilon(1e-3));
      CHECK(int(found.track.sticks.size()) == expected.sticks[i]);
    }
}

TEST_CASE("TR-SDFM goes back as many steps as published for its example, and more where steps are shorter",
          "[algorithms]") {
  const auto& base = tests::stick_slip_cases()[0];
  const auto back = [&](double step, bool before) {
    Options options;
    options.step = step, options.restart_before = before;
    std::vector<int> steps;
    for (const auto& stick : follow(base, "tr-sdfm", options).sticks) steps.push_back(stick.back_steps);
    return steps;
  };
  CHECK(back(3.14e-4, true) == std::vector{2, 2, 2});  // "two time steps" in the publication's figure
  CHECK(back(3.14e-4, false) == std::vector{1, 1, 1});
  CHECK(back(1.57e-4, true) == std::vector{2, 3, 2});
  CHECK(back(3.14e-5, true) == std::vector{10, 11, 6});
}

TEST_CASE("observed orders: held directions make every algorithm first-order, interpolation keeps the fourth",
          "[algorithms][long]") {
  const auto& base = tests::stick_slip_cases()[0];
  const auto order = [&](const char* name, bool closed_form, double coarse) {
    // The errors of steps vary with where events fall between them: fit over many lengths.
    double sum_h = 0, sum_e = 0, sum_hh = 0, sum_he = 0;
    constexpr int lengths = 24;
    for (int i = 0; i < lengths; ++i) {
      Options options;
      options.step = coarse * std::pow(2, -i * 6.0 / lengths);
      options.closed_form = closed_form, options.window = 0.5 * options.step / 3.14e-4 * 1e-3;
      const double h = std::log(options.step), e = std::log(errors(base, name, options).displacement);
      sum_h += h, sum_e += e, sum_hh += h * h, sum_he += h * e;
    }
    return (lengths * sum_he - sum_h * sum_e) / (lengths * sum_hh - sum_h * sum_h);
  };
  for (const char* name : {"o-fbfm", "r-fbfm", "aabg-sdfm", "tr-sdfm"})
    for (const bool closed_form : {false, true}) {
      INFO(name << ", closed form " << closed_form);
      CHECK(order(name, closed_form, 3.14e-4) == Approx(1).margin(0.25));
    }
  CHECK(order("meijaard", false, 2e-2) == Approx(4).margin(0.3));
  // CFM leaves at μd N, VLFM creeps: shorter steps do not help.
  CHECK(order("cfm", false, 3.14e-4) == Approx(0).margin(0.05));
  CHECK(order("vlfm", false, 3.14e-4) == Approx(0).margin(0.05));
}

TEST_CASE("the regularised models converge to their own equations", "[algorithms]") {
  // Integrated to 1e-12 by DOP853.
  const auto& base = tests::stick_slip_cases()[0];
  const auto at = [&](const char* name, double Vl, double t) {
    Options options;
    options.step = 1e-5, options.transition_speed = Vl;
    return follow(base, name, options).points.at(std::size_t(std::llround(t / 1e-5)));
  };
  CHECK(std::abs(at("svlfm", 1e-3, 1).x[0] + 9.4974018959e-3) < 1e-9);
  CHECK(std::abs(at("svlfm", 1e-3, 1).v[0] - 6.9608854e-4) < 1e-8);
  CHECK(std::abs(at("svlfm", 5e-3, 1.75).x[0] + 7.0612865921e-3) < 1e-9);
  CHECK(std::abs(at("vlfm", 5e-3, 1.25).x[0] - 3.2836059153e-3) < 1e-9);
  CHECK(std::abs(at("vlfm", 5e-3, 1.25).v[0] - 2.4672296e-3) < 1e-8);
}

TEST_CASE("adherence in closed form", "[algorithms]") {
  // Kt = 1e4 k, ζt = 1.5, under 3 cos 10 t from t = 0.92 s; integrated independently to 1e-17 m.
  const double Kt = 4e6, Ct = 6000, X0 = -0.0095;
  stick_slip::ClosedForm<double> pull(Signal(Signal::Harmonics{0, {{3, 10, 0}}}).piece(0.92), 0.92);
  pull.add(1, stick_slip::ClosedForm<double>(Kt * X0));
  const auto x = stick_slip::ClosedForm<double>::response(1, 1 + Ct, 400 + Kt, pull, -0.009501, 0.0008);
  CHECK(std::abs(x(1e-4) + 0.0095009201528598) < 2e-16);
  CHECK(std::abs(x(1e-3) + 0.0095003628183802) < 2e-16);
  CHECK(std::abs(x(5e-2) + 0.0094997747088114) < 2e-16);
  const auto late = x.derivatives(5e-3);
  CHECK(std::abs(late[1] - 1.955216596e-5) < 1e-14);
  CHECK(-Kt * (late[0] - X0) - Ct * late[1] == Approx(-0.8615522984).epsilon(1e-9));
}

TEST_CASE("a moving surface: stick is at rest on it", "[algorithms]") {
  // A block carried along, released at k V t + c V = μs N; from then on the algorithms stay near the exact motion.
  const double V = 0.1;
  const stick_slip::DryMass<1> mass{1, {400}, {0.1}, 0.4, 0.3, {V}, 10.0, {0.0}};
  stick_slip::Exact<double> exact({1, 400, 0.1, 0.4, 0.3, 0, V, 10.0, 0.0});
  exact.start(0, 0, V);
  exact.advance(3);
  for (const char* name : {"o-fbfm", "r-fbfm", "aabg-sdfm", "tr-sdfm"}) {
    INFO(name);
    const Forcing<1> forcing(mass, 1e-5, 200'000);
    Options options;
    options.window = 1e-3;  // ten times the change of speed in a step
    const auto track = follow<1>(name, mass, forcing, options, {0}, {V});
    REQUIRE(track.sticks.size() >= 2);
    CHECK(track.points[track.sticks[0].end].time == Approx(double(exact.time())).margin(3e-4));
    const auto& stick = track.sticks[1];
    const auto &a = track.points[stick.begin + 50], &b = track.points[stick.end - 50];
    CHECK((b.x[0] - a.x[0]) / (b.time - a.time) == Approx(V).epsilon(1e-2));
  }
}

TEST_CASE("what has no meaning is refused with the admissible range", "[algorithms]") {
  const auto mass = mass_of(tests::stick_slip_cases()[0]);
  Options options;
  options.step = 1e-3;
  CHECK_THROWS_WITH(check("tr-sdfm", mass, options), Catch::Contains("stable up to 0.000531"));
  CHECK_NOTHROW(check("r-fbfm", mass, options));
  options.closed_form = true;
  CHECK_NOTHROW(check("tr-sdfm", mass, options));
  CHECK_THROWS_WITH(check("vlfm", mass, options), Catch::Contains("no closed form"));
  options = {};
  options.adherence_damping = 0.9;
  CHECK_THROWS_WITH(check("aabg-sdfm", mass, options), Catch::Contains("above 0.9998"));
  options.adherence_damping = 0.9999;
  CHECK_NOTHROW(check("aabg-sdfm", mass, options));
  options.window = 0;
  CHECK_THROWS_WITH(check("o-fbfm", mass, options), Catch::Contains("above 0"));
  options.window = 3;  // (3 + 0.4·14.8) N/(1 kg 20/s) = 0.446 m/s
  CHECK_THROWS_WITH(check("o-fbfm", mass, options), Catch::Contains("above 0 and below 0.446 m/s"));
  options.window = 0.4;
  CHECK_NOTHROW(check("o-fbfm", mass, options));
  options.transition_speed = 1e-4;
  CHECK_THROWS_WITH(check("svlfm", mass, options), Catch::Contains("transition_speed"));
}
