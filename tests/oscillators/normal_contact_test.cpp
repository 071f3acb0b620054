/// One mass on a contact that gives way, against closed forms: equilibrium, natural frequency, finite amplitude,
/// impact.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using Eigen::MatrixXd, Eigen::VectorXd;
using namespace rosin::oscillators;

namespace {

constexpr double pin_area = 1.9634954085e-5, pin_coefficient = 1.25e20 * pin_area;

/// A mass m over a surface, pressed down by F; its coordinate points into the surface.
Structure mass_on(double m, double F, laws::PowerContact law) {
  law.bound_coefficient = law.coefficient, law.bound_exponent = law.exponent;
  Structure structure;
  structure.M = MatrixXd::Constant(1, 1, m);
  structure.C = structure.K = MatrixXd::Zero(1, 1);
  structure.names = {"approach"};
  auto contact = frictionless_contact(VectorXd::Ones(1), laws::normal_law(law));
  contact.normal_load = F;
  structure.contacts = {contact};
  structure.check();
  return structure;
}

}  // namespace

TEST_CASE("a mass pressed on a power-law contact: approach and natural frequency") {
  struct Case {
    double mass, force, exponent, coefficient, approach, frequency;
  };
  const auto [m, F, n, c, a, w] = GENERATE(Case{4.5, 200, 2.5, pin_coefficient, 5.813478050158e-6, 4371.804439492},
                                           Case{4.5, 10.5, 2.5, pin_coefficient, 1.788544534171e-6, 1805.961625232},
                                           Case{1, 1, 2, 1e10, 1e-5, 447.2135955});
  const auto structure = mass_on(m, F, {.coefficient = c, .exponent = n});
  CHECK(StructureSystem(structure).steady(0)[0] == Approx(a).epsilon(1e-10));
  const auto modes = analysis::steady::stability(structure).modes;
  REQUIRE(!modes.empty());
  CHECK(modes.front().eigenvalue.imag() == Approx(w).epsilon(1e-9));
}

TEST_CASE("damping of a preloaded power-law contact gives the damping ratio b a₀ˡ/(2 √(k M))") {
  const auto structure = mass_on(4.5, 200,
                                 {.coefficient = pin_coefficient,
                                  .exponent = 2.5,
                                  .damping = 3e21 * pin_area,
                                  .separation_damping = 3e21 * pin_area,
                                  .damping_exponent = 2.5});
  CHECK(analysis::steady::stability(structure).modes.front().damping_ratio() == Approx(0.12199386791).epsilon(1e-8));
}

TEST_CASE("free vibration of finite amplitude on a power law: period by quadrature") {
  struct Case {
    double exponent, least, period, most;  ///< in approaches under the load and natural periods
  };
  const auto [n, least, period, most] =
      GENERATE(Case{2.5, 0.9, 1.00179068146, 1.09523323199}, Case{2.5, 0.5, 1.03962013079, 1.39818489278},
               Case{2, 0.5, 1.02373401717, 1.42705098312}, Case{2.5, 0.0, 1.1464443355, 1.65054442395});
  analysis::motion::StructureModel model{.structure = mass_on(1, 1, {.coefficient = 1, .exponent = n}), .start = {}};
  model.start.kind = analysis::motion::Start::Kind::given;
  model.start.coordinates = {least}, model.start.velocities = {0.0};
  const double natural = 2 * std::numbers::pi / std::sqrt(n);
  analysis::motion::RunOptions options;
  options.duration = period * natural, options.samples = 2, options.tolerance = 1e-9;
  const auto run = analysis::motion::run_structure(model, options);
  REQUIRE(run.outcome.complete());
  CHECK(run.columns[0][1] == Approx(most).epsilon(1e-8));  // half a period on
  CHECK(run.columns[0][2] == Approx(least).margin(1e-8));
  CHECK(run.columns[1][2] == Approx(0).margin(3e-8));
}

TEST_CASE("impact on a damped power law: speed of rebound in closed form") {
  struct Case {
    double mass, coefficient, exponent, speed, chi, separation, rebound;
  };
  const auto [m, c, n, vi, chi, separation, vo] = GENERATE(
      Case{4.5, pin_coefficient, 2.5, 0.01, 24, 24, 8.61806300584e-3},
      Case{4.5, pin_coefficient, 2.5, 0.01, 24, 0, 9.29617237225e-3}, Case{1, 1e10, 2, 0.1, 5, 5, 7.48434931597e-2});
  analysis::motion::StructureModel model{.structure = mass_on(m, 0,
                                                              {.coefficient = c,
                                                               .exponent = n,
                                                               .damping = chi * c,
                                                               .separation_damping = separation * c,
                                                               .damping_exponent = n}),
                                         .start = {}};
  model.start.kind = analysis::motion::Start::Kind::given;
  model.start.coordinates = {-1e-3 * vi}, model.start.velocities = {vi};  // touches after 1 ms
  analysis::motion::RunOptions options;
  options.duration = 1e-2, options.samples = 2, options.tolerance = 1e-9;
  const auto run = analysis::motion::run_structure(model, options);
  REQUIRE(run.outcome.complete());
  CHECK(run.columns[1].back() == Approx(-vo).epsilon(1e-8));
}
