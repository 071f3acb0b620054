/// Stick–slip in the plane against independent event-located integration, the line, and the balance of energy.
#include "solvers/stick_slip/plane_stick_slip.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "core/error.hpp"
#include "solvers/force_algorithms/force_algorithms.hpp"
#include "tests/solvers/stick_slip/stick_slip_cases.hpp"

using namespace rosin;
using namespace rosin::solvers;
using namespace rosin::solvers::stick_slip;

namespace {

Signal harmonic(double mean, double amplitude, double w) {
  return Signal(Signal::Harmonics{mean, {{amplitude, w, 0}}});
}

struct PlaneCase {
  PlaneMass mass;
  PlaneVector x, v;
  struct Event {
    double time, x, y;
    const char* kind;
  };
  std::vector<Event> events;
  struct Point {
    double time, x, y, vx, vy;
  };
  std::vector<Point> points;
  double stick_time, friction_work, path_length;
};

// DOP853 at 2e-13 with a stop at 1e-11 m/s and a series after each break; two runs agree to 5e-12 s and 3e-10 s.
const PlaneCase cases[] = {
    {{3, {400, 200}, {2, 2}, 0.4, 0.4, {0, 0}, harmonic(20, 4, 50), {harmonic(5, 2, 10), harmonic(4, 1, 20)}},
     {0, 0},
     {0.001, 0.001},
     {{0.004262964230, 2.367324780417e-06, 1.804732228188e-06, "stick"},
      {0.025371062276, 2.367324780417e-06, 1.804732228188e-06, "slip"},
      {0.116994370715, 0.0007838609107528, 0.0004998866901955, "stick"},
      {0.545410115724, 0.0007838609107528, 0.0004998866901955, "slip"},
      {0.633884582427, 0.001313863328219, 0.0008753360459974, "stick"},
      {0.661469871702, 0.001313863328219, 0.0008753360459974, "slip"},
      {0.732145559267, 0.001634571173204, 0.001088293055876, "stick"},
      {1.177814781318, 0.001634571173204, 0.001088293055876, "slip"},
      {1.247454147038, 0.001890618309927, 0.001273219646673, "stick"},
      {1.293346892475, 0.001890618309927, 0.001273219646673, "slip"},
      {1.354194229896, 0.002076307752185, 0.001399113266568, "stick"},
      {1.808502473420, 0.002076307752185, 0.001399113266568, "slip"},
      {1.868938612480, 0.002233989668698, 0.001514222388907, "stick"},
      {1.923917854545, 0.002233989668698, 0.001514222388907, "slip"},
      {1.978480963663, 0.002357490543847, 0.001599087047391, "stick"}},
     {{0.1, 0.000671846366827, 0.000432449186533, 0.01198118415, 0.00731527188},
      {0.5, 0.000783860910753, 0.000499886690196, 0, 0},
      {0.7, 0.00143700860911, 0.000959893628257, 0.007570354531, 0.005077830752},
      {1.2, 0.00166499014506, 0.00110912308485, 0.003607998434, 0.00250707563},
      {1.85, 0.00218206885822, 0.00147525826294, 0.004459392023, 0.003304202088},
      {2.0, 0.00235749054385, 0.00159908704739, 0, 0}},
     1.49947762174,
     0.0210200490096,
     0.00284978969691},
    {{2, {800, 500}, {1, 1}, 0.45, 0.3, {0, 0}, harmonic(19.62, 6, 13), {harmonic(0, 4, 8), harmonic(0, 3, 11)}},
     {0.05, 0.03},
     {0, 0},
     {{0.465309611381, -0.005888105812935, -0.003122240337033, "stick"},
      {0.646604859710, -0.005888105812935, -0.003122240337033, "slip"},
      {0.820564797455, 0.004171194101875, -0.001581882831659, "stick"},
      {1.117563753268, 0.004171194101875, -0.001581882831659, "slip"},
      {1.271530524834, -0.004074720989427, 0.002725039254865, "stick"},
      {1.642109248624, -0.004074720989427, 0.002725039254865, "slip"},
      {1.755577454124, -0.001013396840097, 0.003628320689848, "stick"}},
     {{0.1, -0.00107280245594, 0.0103731959028, -0.6742260236, -0.3167761238},
      {0.25, -0.00265738298583, -0.0127499612465, 0.3851096279, 0.03867237825},
      {0.7, -0.00408045220656, -0.00238909973138, 0.06857807555, 0.02329238524},
      {1.2, 8.95525994728e-05, 0.00060868473006, -0.0848930866, 0.04542012292},
      {2.0, -0.0010133968401, 0.00362832068985, 0, 0}},
     1.09329547381,
     0.962086929678,
     0.169072529247}};

}  // namespace

TEST_CASE("two motions in the plane: events to 1e-9 s, places to 1e-11 m", "[plane]") {
  for (const auto& c : cases) {
    PlaneStickSlip solver(c.mass);
    solver.start(0, c.x, c.v);
    std::size_t event = 0, point = 0;
    while (solver.time() < 2) {
      Switch what;
      REQUIRE(solver.advance(2, what).complete());
      for (; point < c.points.size() && c.points[point].time <= solver.time(); ++point) {
        const auto seen = solver.at(c.points[point].time);
        CHECK(std::abs(seen.displacement[0] - c.points[point].x) < 1e-11);
        CHECK(std::abs(seen.displacement[1] - c.points[point].y) < 1e-11);
        CHECK(std::abs(seen.velocity[0] - c.points[point].vx) < 1e-9);
        CHECK(std::abs(seen.velocity[1] - c.points[point].vy) < 1e-9);
      }
      if (what == Switch::none) continue;
      REQUIRE(event < c.events.size());
      const auto& expected = c.events[event++];
      CHECK(name(what) == expected.kind);
      CHECK(std::abs(solver.time() - expected.time) < 1e-9);
      const auto seen = solver.at(solver.time());
      CHECK(std::abs(seen.displacement[0] - expected.x) < 1e-11);
      CHECK(std::abs(seen.displacement[1] - expected.y) < 1e-11);
    }
    CHECK(event == c.events.size());
    CHECK(point == c.points.size());
    CHECK(std::abs(solver.stick_time() - c.stick_time) < 1e-9);
    CHECK(solver.friction_work() == Approx(c.friction_work).epsilon(1e-9));
    CHECK(solver.path_length() == Approx(c.path_length).epsilon(1e-9));
    CHECK(std::abs(solver.energy_residual()) < 1e-10);
  }
}

TEST_CASE("a motion along one axis of the plane is that of the line, reversals included", "[plane]") {
  for (const int axis : {0, 1}) {
    const auto& c = tests::stick_slip_cases()[0];
    PlaneMass mass{c.m, {c.k, c.k}, {c.c, c.c}, c.mus, c.muk, {0, 0}, harmonic(c.Nc, c.Nv, c.wn), {0.0, 0.0}};
    mass.force[axis] = harmonic(0, c.P, c.we);
    PlaneStickSlip solver(mass);
    PlaneVector x{};
    x[axis] = c.x0;
    solver.start(0, x, {});
    std::size_t event = 0;
    while (solver.time() < 2) {
      Switch what;
      REQUIRE(solver.advance(2, what).complete());
      if (what == Switch::none) continue;
      REQUIRE(event < c.events.size());
      const auto& expected = c.events[event++];
      CHECK(name(what) == expected.kind);
      CHECK(std::abs(solver.time() - expected.time) < 1e-8);
      CHECK(std::abs(solver.at(solver.time()).displacement[axis] - expected.displacement) < 1e-10);
    }
    CHECK(event == c.events.size());
  }
}

TEST_CASE("random sliders in the plane: energy balances, none fails", "[plane]") {
  std::mt19937_64 random(3);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  long events = 0;
  for (int i = 0; i < 60; ++i) {
    INFO(i);
    const double m = std::pow(10, uniform(-1, 1)), N = 10 * m, muk = uniform(0.05, 0.5),
                 mus = muk * (i % 3 ? uniform(1, 2) : 1);
    PlaneMass mass{m, {}, {}, mus, muk, {}, harmonic(N, uniform(0, 0.9) * N, uniform(1, 60)), {}};
    PlaneVector x;
    for (int d = 0; d < 2; ++d) {
      const double w0 = std::pow(10, uniform(0.5, 2));
      mass.stiffness[d] = m * w0 * w0, mass.damping[d] = 2 * m * w0 * (i % 4 ? uniform(0, 0.2) : uniform(0, 3));
      mass.force[d] = harmonic(uniform(-1, 1) * N, uniform(0, 2) * mus * N, uniform(1, 60));
      if (i % 5 == 0) mass.surface_velocity[d] = uniform(-0.1, 0.1);
      x[d] = uniform(-3, 3) * N / mass.stiffness[d];
    }
    PlaneStickSlip solver(mass, 1e-11);
    solver.start(0, x, {});
    long steps = 0;
    while (solver.time() < 2) {
      Switch what;
      const auto outcome = solver.advance(2, what);
      INFO(outcome.detail);
      REQUIRE(outcome.complete());
      REQUIRE(++steps < 100'000);
      events += what != Switch::none;
      const auto seen = solver.at(solver.time());
      REQUIRE(std::isfinite(seen.displacement[0] + seen.velocity[1]));
      if (solver.sticking())
        CHECK(std::hypot(seen.friction[0], seen.friction[1]) <= mus * mass.load.value(solver.time()) * (1 + 1e-12));
    }
    CHECK(std::abs(solver.energy_residual()) < 1e-9);
  }
  CHECK(events > 200);
}

TEST_CASE("algorithms in the plane: first-order, down to what the adherence spring gives", "[plane][long]") {
  using namespace rosin::solvers::force_algorithms;
  const auto& c = cases[1];
  const auto error = [&](const char* name, double step, bool closed_form, double Kt = 0) {
    Options options;
    options.step = step, options.closed_form = closed_form, options.adherence_stiffness = Kt;
    const Forcing<2> forcing(c.mass, step, std::size_t(std::llround(2 / step)));
    const auto track = follow<2>(name, c.mass, forcing, options, c.x, c.v);
    double largest = 0;
    for (const auto& point : c.points) {
      const auto& found = track.points.at(std::size_t(std::llround(point.time / step)));
      largest = std::max(largest, std::hypot(found.x[0] - point.x, found.x[1] - point.y));
    }
    return largest;
  };
  for (const bool closed_form : {false, true}) {
    const double coarse = error("r-fbfm", 1e-4, closed_form), fine = error("r-fbfm", 1e-5, closed_form);
    INFO("closed form " << closed_form << ": " << coarse << " " << fine);
    CHECK(coarse < 2e-4);
    CHECK(fine < 0.25 * coarse);
    for (const char* name : {"aabg-sdfm", "tr-sdfm"}) {
      INFO(name);
      CHECK(error(name, 1e-5, closed_form) < 2e-5);
    }
  }
  for (const char* name : {"aabg-sdfm", "tr-sdfm"})
    CHECK(error(name, 4e-6, true, 8e8) < 0.3 * error(name, 4e-6, true, 8e6));
  CHECK(error("cfm", 1e-5, false) > 1e-4);
  CHECK_THROWS_WITH(check("meijaard", c.mass, Options{}), Catch::Contains("none to hit"));
}

TEST_CASE("what the plane cannot have is refused", "[plane]") {
  auto mass = cases[0].mass;
  mass.load = harmonic(20, 20, 3);
  CHECK_THROWS_WITH(PlaneStickSlip(mass), Catch::Contains("stay above 0"));
  mass = cases[0].mass;
  mass.stiffness[1] = 0;
  CHECK_THROWS_WITH(PlaneStickSlip(mass), Catch::Contains("two springs"));
}
