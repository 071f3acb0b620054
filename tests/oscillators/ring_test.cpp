/// Contacts inside a ring, and dry contacts behind springs whose load follows motion.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"
#include "oscillators/structure_system.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::Matrix2d, Eigen::Vector2d, Eigen::VectorXd;
using std::numbers::pi;

namespace {

std::shared_ptr<const FrictionLaw> dry_of(double mu) { return laws::find_law("coulomb")->with({mu, mu}); }

/// A mass on the same springs in both directions, inside a ring.
Structure tube_in_ring(FrictionContact contact) {
  Structure tube;
  tube.M = Matrix2d::Identity() * 0.5, tube.C = Matrix2d::Identity() * 2, tube.K = Matrix2d::Identity() * 2000;
  tube.names = {"x", "y"};
  contact.normal = Vector2d{1, 0}, contact.tangential = Vector2d{0, 1};
  contact.normal_load = contact.speed = 0.0;
  contact.gap = VectorXd::Constant(1, 5e-4);
  contact.ring.emplace();
  tube.contacts = {contact};
  return tube;
}

FrictionContact behind_spring() {
  FrictionContact contact;
  contact.law = dry_of(0.3), contact.stiffness.tangential = 7e5;
  contact.normal_law = laws::normal_law(
      laws::PowerContact{.coefficient = 1e6, .damping = 1e8, .separation_damping = 1e8, .bound_coefficient = 1e6});
  return contact;
}

FrictionContact with_bristle() {
  auto contact = behind_spring();
  contact.stiffness = {};
  contact.law = laws::find_law("lugre")->with("sigma0", 1e5);
  return contact;
}

}  // namespace

TEST_CASE("derivatives inside a ring are those of its equations") {
  for (const auto& contact : {behind_spring(), with_bristle()}) {
    auto structure = tube_in_ring(contact);
    structure.contacts[0].ring->centre[0] = 2e-5, structure.contacts[0].ring->centre[1] = -1e-5;
    structure.contacts[0].speed = 0.4;
    StructureSystem system(structure);
    const int n = system.size();
    for (const auto mode : {ContactMode::stick, ContactMode::backward}) {
      if (system.contacts() > 0) system.set_mode(0, mode);
      for (const double angle : {0.3, 2.1, -1.4}) {
        const double r = 5.4e-4;
        auto y = system.unknowns_at(0, Vector2d{r * std::cos(angle), r * std::sin(angle)}, Vector2d{0.13, -0.07});
        y.back() = 3e-6;  // deflection of spring or bristle
        std::vector<double> f(n), above(n), below(n), J(std::size_t(n) * n);
        system.linearise(0, y.data(), f.data(), J.data());
        for (int j = 0; j < n; ++j) {
          const double step = (j < 2 ? 1e-9 : j < 4 ? 1e-6 : 1e-11), centre = y[j];
          y[j] = centre + step, system.evaluate(0, y.data(), above.data());
          y[j] = centre - step, system.evaluate(0, y.data(), below.data());
          y[j] = centre;
          for (int i = 0; i < n; ++i) {
            INFO("row " << i << ", column " << j << ", angle " << angle);
            const double by_difference = (above[i] - below[i]) / (2 * step);
            CHECK(J[std::size_t(i * n + j)] ==
                  Approx(by_difference).epsilon(1e-5).margin(1e-7 + 1e-6 * std::abs(f[i]) / step));
          }
        }
      }
    }
  }
}

TEST_CASE("motion inside a ring is the same in every direction") {
  const auto turned = [](double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    auto structure = tube_in_ring(behind_spring());
    structure.contacts[0].ring->centre[0] = 1e-4 * c, structure.contacts[0].ring->centre[1] = 1e-4 * s;
    const auto force = [](double amplitude, double phase) {
      return Signal(Signal::Harmonics{0, {{amplitude, 2 * pi * 20, phase}}});
    };
    // An ellipse of forces, 40 N along the angle and 25 N across it.
    structure.force = {force(std::hypot(40 * c, 25 * s), std::atan2(-25 * s, 40 * c) * 1.0),
                       force(std::hypot(40 * s, 25 * c), std::atan2(25 * c, 40 * s))};
    return analysis::motion::run_structure({structure, {.kind = analysis::motion::Start::Kind::rest}},
                                           {.duration = 0.1, .samples = 20, .tolerance = 1e-7});
  };
  const auto straight = turned(0), aslant = turned(0.8);
  REQUIRE(straight.outcome.complete());
  REQUIRE(aslant.outcome.complete());
  for (std::size_t i = 0; i < straight.time.size(); ++i) {
    const double x = straight.columns[0][i], y = straight.columns[1][i];
    CHECK(aslant.columns[0][i] == Approx(x * std::cos(0.8) - y * std::sin(0.8)).margin(1e-9));
    CHECK(aslant.columns[1][i] == Approx(x * std::sin(0.8) + y * std::cos(0.8)).margin(1e-9));
  }
  CHECK(straight.metrics.at("wear_work_rate") > 0);
  CHECK(aslant.metrics.at("wear_work_rate") == Approx(straight.metrics.at("wear_work_rate")).epsilon(1e-5));
  CHECK(straight.metrics.at("energy_residual") < 1e-8);
}

TEST_CASE(
    "a load that follows a prescribed motion does to a contact behind a spring what the same prescribed load does") {
  constexpr double stiffness = 1e5, hold = 3e5, mass = 0.1, omega = 90, mean = 2e-4, swing = 1.2e-4;
  for (const bool per_load : {false, true}) {
    Structure prescribed;
    prescribed.M = MatrixXd::Constant(1, 1, 1.0), prescribed.C = MatrixXd::Constant(1, 1, 3.0);
    prescribed.K = MatrixXd::Constant(1, 1, 5e3), prescribed.names = {"x"};
    const Signal pull(Signal::Harmonics{0, {{12, 55, 0.4}}});
    prescribed.force = {pull};
    FrictionContact contact;
    contact.law = dry_of(0.4), contact.speed = 0.0;
    if (per_load)
      contact.stiffness.per_load = 2e3;
    else
      contact.stiffness.tangential = 4e4;
    contact.tangential = VectorXd::Ones(1);
    contact.normal_load = Signal(Signal::Harmonics{stiffness * mean, {{stiffness * swing, omega, 0}}});
    prescribed.contacts = {contact};

    Structure following;
    following.M = Vector2d{1.0, mass}.asDiagonal(), following.C = Vector2d{3, 0}.asDiagonal();
    following.K = Vector2d{5e3, hold}.asDiagonal(), following.names = {"x", "y"};
    const double dynamic = hold + stiffness - mass * omega * omega;
    following.force = {pull, Signal(Signal::Harmonics{(hold + stiffness) * mean, {{dynamic * swing, omega, 0}}})};
    contact.tangential = Vector2d{1, 0}, contact.normal = Vector2d{0, 1}, contact.normal_load = 0.0;
    contact.normal_law = laws::normal_law(laws::PowerContact{.coefficient = stiffness, .bound_coefficient = stiffness});
    following.contacts = {contact};

    analysis::motion::StructureStart start{.kind = analysis::motion::Start::Kind::given};
    start.coordinates = {0.0}, start.velocities = {0.0};
    const analysis::motion::RunOptions options{.duration = 0.5, .samples = 50, .tolerance = 1e-9};
    const auto one = run_structure({prescribed, start}, options);
    start.coordinates = {0.0, mean + swing}, start.velocities = {0.0, 0.0};
    const auto two = run_structure({following, start}, options);
    REQUIRE(one.outcome.complete());
    REQUIRE(two.outcome.complete());
    CHECK(one.metrics.at("stick_time") > 0.05);
    CHECK(two.metrics.at("stick_time") == Approx(one.metrics.at("stick_time")).epsilon(1e-7));
    CHECK(two.metrics.at("wear_work_rate") == Approx(one.metrics.at("wear_work_rate")).epsilon(1e-7));
    for (std::size_t i = 0; i < one.time.size(); ++i)
      CHECK(two.columns[0][i] == Approx(one.columns[0][i]).margin(one.column_error[0] + two.column_error[0]));
  }
}

TEST_CASE("what does not go with a ring is said") {
  const auto refuses = [](auto change, const char* why) {
    auto structure = tube_in_ring(behind_spring());
    change(structure.contacts[0]);
    CHECK_THROWS_WITH(structure.check(), Catch::Contains(why));
  };
  refuses([](FrictionContact& c) { c.stiffness = {}; }, "law.contact_stiffness");
  refuses([](FrictionContact& c) { c.normal_load = 3.0; }, "no dead load");
  refuses([](FrictionContact& c) { c.gap[0] = 0; }, "clearance");
  refuses([](FrictionContact& c) { c.tangential.setZero(); }, "normal and tangential");
  refuses(
      [](FrictionContact& c) { c.normal_law = laws::normal_law(laws::LinearContact{.stiffness = 1e6, .damping = 10}); },
      "damping");
}
