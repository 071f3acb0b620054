/// End stops: impacts, bouncing that ends in rest, release, and spring stops, against exact piecewise solutions.
#include <catch2/catch.hpp>
#include <cmath>

#include "analysis/cycles/section_map.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "laws/catalogue.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;
using rosin::oscillators::FrictionContact;
using rosin::oscillators::Stop;

namespace {

/// m = k = 1 under Coulomb friction of normal load 1.
struct OneBlock {
  double speed, static_friction, kinetic_friction, damping = 0;
  double amplitude = 0, angular_frequency = 1;
  StructureModel model(Stop stop, double x, double v) const {
    StructureModel model;
    auto& s = model.structure;
    s.M = s.K = Eigen::MatrixXd::Ones(1, 1);
    s.C = Eigen::MatrixXd::Constant(1, 1, damping);
    s.names = {"displacement"};
    if (amplitude > 0) s.force = {Signal(Signal::Harmonics{.mean = 0, .terms = {{amplitude, angular_frequency, 0}}})};
    if (static_friction > 0) {
      FrictionContact contact;
      contact.law = laws::find_law("coulomb")->with({static_friction, kinetic_friction});
      contact.tangential = Eigen::VectorXd::Ones(1);
      contact.speed = speed;
      contact.normal_load = 1.0;
      s.contacts = {contact};
    }
    s.stops = {stop};
    model.start = {.kind = Start::Kind::given, .coordinates = {x}, .velocities = {v}};
    return model;
  }
};

Run follow(const StructureModel& model, double duration, double tolerance = 1e-11) {
  RunOptions options;
  options.duration = duration, options.samples = 100, options.tolerance = tolerance;
  Run run = run_structure(model, options);
  INFO(run.outcome.detail);
  CHECK(run.outcome.complete());
  CHECK(run.metrics.at("energy_residual") < 1e-9);
  return run;
}

struct Expected {
  double time;
  std::string kind;
  double displacement, speed = 0;
};

void check(const std::vector<RunEvent>& events, const std::vector<Expected>& expected, double accuracy = 2e-11) {
  REQUIRE(events.size() >= expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    INFO("event " << i + 1 << ", " << expected[i].kind << " at " << expected[i].time);
    CHECK(events[i].kind == expected[i].kind);
    CHECK(events[i].time == Approx(expected[i].time).margin(accuracy));
    CHECK(events[i].displacement == Approx(expected[i].displacement).margin(accuracy));
    CHECK(events[i].speed == Approx(expected[i].speed).margin(accuracy));
  }
}

const OneBlock forced{
    .speed = 0, .static_friction = 0.1, .kinetic_friction = 0.1, .amplitude = 1, .angular_frequency = 0.8};

}  // namespace

TEST_CASE("bouncing ends where the sum of all flights does", "[stops]") {
  // Between impacts the belt slips: flights are arcs of a circle about F − g, 2 atan(eⁿ V/(F − g)) long.
  const OneBlock block{.speed = 0.5, .static_friction = 1.5, .kinetic_friction = 1};
  const Run run = follow(block.model({.at = 0.8, .restitution = 0.7}, 0, 0.5), 12);
  check(run.events, {{1.6, "impact", 0.8, 0.5},
                     {3.703300425097, "impact", 0.8, 0.35},
                     {5.475658750061, "impact", 0.8, 0.245},
                     {6.893322986365, "impact", 0.8, 0.1715},
                     {7.974529593416, "impact", 0.8, 0.12005},
                     {8.770083075721, "impact", 0.8, 0.084035},
                     {9.342194892265, "impact", 0.8, 0.0588245},
                     {9.748291844610, "impact", 0.8, 0.04117715},
                     {10.034560764000, "impact", 0.8, 0.028824005}});
  double end = 1.6;
  for (int n = 1; n < 200; ++n) end += 2 * std::atan(std::pow(0.7, n) * 0.5 / 0.2);
  CHECK(end == Approx(10.70608400954055).margin(1e-13));
  CHECK(run.events.back().kind == "rest");
  CHECK(run.events.back().time == Approx(end).margin(3e-10));
  CHECK(run.columns[0].back() == 0.8);  // friction of the belt holds it there
  CHECK(run.columns[1].back() == 0);
  CHECK(run.metrics.at("impact_work") == Approx(0.5 * 0.25).margin(1e-10));  // all that it came with
}

TEST_CASE("a block on a belt is thrown back by a rigid stop and sticks again", "[stops]") {
  const OneBlock block{.speed = 0.3, .static_friction = 1, .kinetic_friction = 0.4};
  const Run run = follow(block.model({.at = 0.7, .restitution = 0.8}, 0, 0.3), 17);
  check(run.events, {{2.333333333333, "impact", 0.7, 0.3},
                     {5.696240429271, "stick", 0.16},
                     {7.496240429271, "impact", 0.7, 0.3},
                     {10.859147525208, "stick", 0.16},
                     {12.659147525208, "impact", 0.7, 0.3},
                     {16.022054621146, "stick", 0.16}});
}

TEST_CASE("a spring stop is touched under stick, and the block lets go and is thrown back", "[stops]") {
  const OneBlock block{.speed = 0.3, .static_friction = 1, .kinetic_friction = 0.4};
  const Run run = follow(block.model({.at = 0.7, .stiffness = 1000}, 0, 0.3), 17);
  check(run.events, {{2.333333333333, "contact", 0.7},
                     {2.334332334332, "slip", 0.700299700300},
                     {2.430636057882, "free", 0.7},
                     {5.570732451561, "stick", 0.099550785873},
                     {7.572229831986, "contact", 0.7},
                     {7.573228832985, "slip", 0.700299700300},
                     {7.669532556535, "free", 0.7},
                     {10.809628950215, "stick", 0.099550785873},
                     {12.811126330641, "contact", 0.7},
                     {12.812125331640, "slip", 0.700299700300},
                     {12.908429055190, "free", 0.7},
                     {16.048525448870, "stick", 0.099550785873}});
}

TEST_CASE("a harmonic force drives a block against a rigid stop", "[stops]") {
  const Run run = follow(forced.model({.at = 0.5, .restitution = 0.8}, 0, 0), 24);
  check(run.events, {{1.166273202949, "impact", 0.5, 0.676275099296},
                     {5.075265110848, "reversal", -1.547329226303},
                     {7.102359947811, "impact", 0.5, 1.821204792943},
                     {8.303347925321, "reversal", -0.513730233237},
                     {9.805709875876, "impact", 0.5, 0.838219526798},
                     {12.779422000789, "reversal", -1.947108825635},
                     {14.798381211719, "impact", 0.5, 2.086276570182},
                     {16.049072265637, "reversal", -0.739058063790},
                     {17.518900902070, "impact", 0.5, 1.151847142606},
                     {20.383111521473, "reversal", -1.902701281399},
                     {22.548049794320, "impact", 0.5, 1.904277441290},
                     {23.780382461474, "reversal", -0.623726644299}});
}

TEST_CASE("a lower stop mirrors an upper one", "[stops]") {
  auto model = forced.model({.at = -0.5, .side = -1, .restitution = 0.8}, 0, 0);
  model.structure.force = {Signal(Signal::Harmonics{.mean = 0, .terms = {{-1, 0.8, 0}}})};
  check(follow(model, 8).events, {{1.166273202949, "impact", -0.5, 0.676275099296},
                                  {5.075265110848, "reversal", 1.547329226303},
                                  {7.102359947811, "impact", -0.5, 1.821204792943}});
}

TEST_CASE("without friction a damped oscillator is thrown back once a period", "[stops]") {
  const OneBlock block{.speed = 0,
                       .static_friction = 0,
                       .kinetic_friction = 0,
                       .damping = 0.1,
                       .amplitude = 1,
                       .angular_frequency = 1.4};
  const auto model = block.model({.at = 0.3, .restitution = 0.7}, 0, 0);
  check(follow(model, 56).events, {{0.865274333127, "impact", 0.3, 0.544234945392},
                                   {5.001784925840, "impact", 0.3, 2.189487184376},
                                   {9.109965463275, "impact", 0.3, 2.256806866240},
                                   {13.574437087132, "impact", 0.3, 1.745676212883},
                                   {18.228437456145, "impact", 0.3, 1.767719572326},
                                   {22.673559514257, "impact", 0.3, 1.922300688127},
                                   {27.123529890968, "impact", 0.3, 1.875049812708},
                                   {31.631724322554, "impact", 0.3, 1.835847916631},
                                   {36.127563211718, "impact", 0.3, 1.858495564582},
                                   {40.607558222977, "impact", 0.3, 1.865819981281},
                                   {45.094765811640, "impact", 0.3, 1.857176306386},
                                   {49.585430471287, "impact", 0.3, 1.856687295129}});
}

TEST_CASE("a forced block bounces to rest on its stop, and leaves where friction holds it no longer", "[stops]") {
  const OneBlock block{.speed = 0,
                       .static_friction = 0.1,
                       .kinetic_friction = 0.1,
                       .damping = 0.05,
                       .amplitude = 1,
                       .angular_frequency = 0.5};
  const Run run = follow(block.model({.at = 0, .restitution = 0.5}, -0.5, 0), 29);
  check(run.events, {{0.885121001021, "impact", 0, 1.032758051428},
                     {1.381824585892, "reversal", -0.127593685882},
                     {1.986235565633, "impact", 0, 0.384515785626},
                     {2.305815455171, "reversal", -0.029695732876},
                     {2.791328213573, "impact", 0, 0.100671146146},
                     {3.016952521233, "stick", -0.005214454437},
                     {3.352411753550, "slip", -0.005214454437},
                     {7.440914724167, "reversal", -1.520782205957},
                     {9.746255244186, "impact", 0, 1.083015652585},
                     {10.584997396659, "reversal", -0.264227791770},
                     {11.415934131513, "impact", 0, 0.635324048808},
                     {11.727517953540, "reversal", -0.050370304203}});
  std::vector<double> rests, leaves;
  for (const auto& event : run.events) {
    if (event.kind == "rest") rests.push_back(event.time);
    if (event.kind == "leave") leaves.push_back(event.time);
  }
  REQUIRE(rests.size() == 2);
  REQUIRE(leaves.size() == 2);
  CHECK(rests[0] == Approx(12.588098455949).margin(5e-11));
  CHECK(leaves[0] == Approx(15.908298110272).margin(2e-11));
  CHECK(rests[1] == Approx(25.154602743098).margin(5e-11));
  CHECK(leaves[1] == Approx(28.474668724631).margin(2e-11));
}

TEST_CASE("a damped spring stop pushes and never pulls", "[stops]") {
  // Of a free mass that comes with speed 1: ẍ = −k x − c ẋ from touch to the moment that this pushes no more.
  StructureModel model;
  auto& s = model.structure;
  s.M = Eigen::MatrixXd::Ones(1, 1);
  s.K = s.C = Eigen::MatrixXd::Zero(1, 1);
  s.names = {"displacement"};
  const double k = 100, c = 4, decay = c / 2, w = std::sqrt(k - decay * decay);
  s.stops = {{.at = 0.2, .stiffness = k, .damping = c}};
  model.start = {.kind = Start::Kind::given, .coordinates = {0.0}, .velocities = {1.0}};
  const Run run = follow(model, 1);
  REQUIRE(run.events.size() == 2);
  CHECK(run.events[0].time == Approx(0.2).margin(1e-11));
  // x = sin(wt) exp(−dt)/w; k x + c ẋ = 0 at tan(wt) = −c w/(k − c d).
  const double free = (M_PI - std::atan(c * w / (k - c * decay))) / w;
  CHECK(run.events[1].kind == "free");
  CHECK(run.events[1].time == Approx(0.2 + free).margin(1e-11));
  CHECK(run.events[1].displacement == Approx(0.2 + std::sin(w * free) * std::exp(-decay * free) / w).margin(1e-11));
  CHECK(run.columns[1].back() ==
        Approx((std::cos(w * free) - decay / w * std::sin(w * free)) * std::exp(-decay * free)).margin(1e-10));
}

TEST_CASE("an elastic stop takes no energy, one without restitution all of it", "[stops]") {
  const OneBlock block{.speed = 0, .static_friction = 0, .kinetic_friction = 0};
  const Run elastic = follow(block.model({.at = 0, .restitution = 1}, -1, 0), 10);
  CHECK(elastic.metrics.at("impact_work") == 0);
  CHECK(elastic.events.size() == 3);  // π/2, 3π/2, 5π/2
  CHECK(elastic.events[2].time == Approx(2.5 * M_PI).margin(1e-11));
  const Run plastic = follow(block.model({.at = -0.6, .restitution = 0}, -1, 0), 10);
  CHECK(plastic.metrics.at("impact_work") == Approx(0.5 * 0.64).margin(1e-11));
  CHECK(plastic.events[0].speed == Approx(0.8).margin(1e-11));
}

TEST_CASE("multipliers of periodic impacts are those of the exact return map", "[stops]") {
  using Complex = std::complex<double>;
  SECTION("with dry friction") {
    const auto cycle = analysis::cycles::find_cycle(forced.model({.at = 0.5, .restitution = 0.8}, 0, 0), {});
    INFO(cycle.outcome.detail);
    CHECK(cycle.symmetry.empty());  // the stop has no mirror image
    REQUIRE(cycle.multipliers.size() == 2);
    CHECK(std::abs(Complex(cycle.multipliers[0].real(), std::abs(cycle.multipliers[0].imag())) -
                   Complex(0.06559459, 0.53557456)) < 3e-8);
    check(cycle.events,
          {{0.252519951485, "reversal", -0.544796702566},
           {1.666748524325, "impact", 0.5, 1.036988033697},
           {4.706462191940, "reversal", -1.767742073372},
           {6.894078766733, "impact", 0.5, 1.815240317344}},
          1e-9);
  }
  SECTION("with damping alone") {
    const OneBlock block{.speed = 0,
                         .static_friction = 0,
                         .kinetic_friction = 0,
                         .damping = 0.1,
                         .amplitude = 1,
                         .angular_frequency = 1.4};
    const auto cycle = analysis::cycles::find_cycle(block.model({.at = 0.3, .restitution = 0.7}, 0, 0), {});
    REQUIRE(cycle.multipliers.size() == 2);
    CHECK(std::abs(Complex(cycle.multipliers[0].real(), std::abs(cycle.multipliers[0].imag())) -
                   Complex(-0.10556209, 0.54924486)) < 3e-8);
    check(cycle.events, {{0.216784662148, "impact", 0.3, 1.858628006229}}, 1e-9);
  }
  SECTION("against a spring") {
    const auto cycle = analysis::cycles::find_cycle(forced.model({.at = 0.5, .stiffness = 200}, 0, 0), {});
    REQUIRE(cycle.multipliers.size() == 2);
    CHECK(std::abs(Complex(cycle.multipliers[0].real(), std::abs(cycle.multipliers[0].imag())) -
                   Complex(0.52431212, 0.70380748)) < 3e-8);
  }
}

TEST_CASE("stick-slip against a stop has the period of its exact solution", "[stops]") {
  const OneBlock block{.speed = 0.3, .static_friction = 1, .kinetic_friction = 0.4};
  const auto rigid = analysis::cycles::find_cycle(block.model({.at = 0.7, .restitution = 0.8}, 0, 0.3), {});
  INFO(rigid.outcome.detail);
  CHECK(rigid.returns == 1);
  CHECK(rigid.metrics.at("period").value == Approx(5.162907095937).margin(1e-9));
  const auto spring = analysis::cycles::find_cycle(block.model({.at = 0.7, .stiffness = 1000}, 0, 0.3), {});
  CHECK(spring.metrics.at("period").value == Approx(5.238896498650).margin(1e-9));
}

TEST_CASE("disturbances are carried across impacts, jumps of force and bouncing to rest", "[stops]") {
  // Two blocks on surfaces of varying speed. A contact that sticks gives way where its damped stop is touched.
  FrictionContact contact;
  const double friction = GENERATE(0.4, 0.5);
  contact.law = laws::find_law("coulomb")->with({friction, friction});
  contact.tangential = Eigen::VectorXd::Ones(1);
  contact.speed = Signal(Signal::Harmonics{.mean = 0.4, .terms = {{0.3, 0.9, 0.2}}});
  contact.normal_load = 1.0;
  auto structure = oscillators::chain({.mass = {1, 1.5},
                                       .coupling_stiffness = {1.2},
                                       .coupling_damping = {0.1},
                                       .pull_stiffness = {1, 0.7},
                                       .pull_damping = {0.02, 0.03}},
                                      {contact, contact});
  structure.force = {Signal(Signal::Harmonics{.mean = 0, .terms = {{1.3, 0.9, 0}}}), 0.0};
  structure.stops = {{.coordinate = 0, .at = 0.4, .restitution = 0.6},
                     {.coordinate = 1, .at = 0.3, .stiffness = 50, .damping = 3}};
  analysis::cycles::SectionMap map(structure);
  auto y = map.system().unknowns_at(0, Eigen::Vector2d(0.1, -0.2), Eigen::Vector2d(0.1, 0.05));
  for (int period = 0; period < 3; ++period) {
    const auto there = map.follow(y, 1e-13, 1, true);
    for (std::size_t i = 0; i < y.size(); ++i) {
      constexpr double aside = 1e-6;
      auto ahead = y, behind = y;
      ahead[i] += aside, behind[i] -= aside;
      const auto a = map.follow(ahead, 1e-13, 1, false).y, b = map.follow(behind, 1e-13, 1, false).y;
      for (std::size_t k = 0; k < y.size(); ++k)
        CHECK(there.derivative(Eigen::Index(k), Eigen::Index(i)) ==
              Approx((a[k] - b[k]) / (2 * aside)).margin(1e-5 * there.derivative.cwiseAbs().maxCoeff()));
    }
    y = there.y;
  }
}

TEST_CASE("blocks that reach their stops together are all thrown back, and forget no switch of others", "[stops]") {
  // Three blocks in a row that move as one, and one alone.
  const OneBlock block{.speed = 0.3, .static_friction = 1, .kinetic_friction = 0.4};
  auto one = block.model({.at = 0.7, .restitution = 0.8}, 0, 0.3), three = one;
  const auto contact = one.structure.contacts[0];
  three.structure = oscillators::chain({.mass = {1, 1, 1},
                                        .coupling_stiffness = {7, 3},
                                        .coupling_damping = {0.2, 0.1},
                                        .pull_stiffness = {1, 1, 1},
                                        .pull_damping = {0, 0, 0}},
                                       {contact, contact, contact});
  for (const int i : {0, 1, 2}) three.structure.stops.push_back({.coordinate = i, .at = 0.7, .restitution = 0.8});
  three.start.coordinates = {0.0, 0.0, 0.0}, three.start.velocities = {0.3, 0.3, 0.3};
  const Run alone = follow(one, 9), together = follow(three, 9);
  REQUIRE(together.events.size() == 3 * alone.events.size());
  for (std::size_t i = 0; i < together.events.size(); ++i) {
    CHECK(together.events[i].kind == alone.events[i / 3].kind);
    CHECK(together.events[i].time == Approx(alone.events[i / 3].time).margin(1e-10));
  }
}

TEST_CASE("a block without a spring rests on its stop until the force pulls it away from friction", "[stops]") {
  // On the ground, under a force 1 − t: there by 0.4 t² − t³/6 = 0.2, and back from −0.3 on.
  auto model = OneBlock{.speed = 0, .static_friction = 0.3, .kinetic_friction = 0.2}.model({.at = 0.2}, 0, 0);
  model.structure.K.setZero();
  model.structure.force = {Signal(Signal::Ramp{1, -1})};
  const Run run = follow(model, 3);
  REQUIRE(run.events.size() == 3);
  const double t = run.events[0].time;
  CHECK(0.4 * t * t - t * t * t / 6 == Approx(0.2).margin(1e-11));
  check(run.events, {{t, "impact", 0.2, 0.8 * t - 0.5 * t * t}, {t, "rest", 0.2}, {1.3, "leave", 0.2}});
  const double since = 3 - 1.3;
  CHECK(run.columns[0].back() == Approx(0.2 - 0.05 * since * since - since * since * since / 6).margin(1e-10));
}

TEST_CASE("a start on a stop, at rest, stays there while all else pushes", "[stops]") {
  // A belt pushes with 1 and the spring pulls with 0.8; beside a lower stop both pull away from it.
  const OneBlock block{.speed = 0.5, .static_friction = 1.5, .kinetic_friction = 1};
  const Run stays = follow(block.model({.at = 0.8}, 0.8, 0), 3);
  CHECK(stays.events.empty());
  CHECK(stays.columns[0].back() == 0.8);
  CHECK(stays.metrics.at("friction_work") == Approx(1.5).margin(1e-12));  // the belt slides below it
  const Run leaves = follow(block.model({.at = 0.8, .side = -1}, 0.8, 0), 1);
  CHECK(leaves.columns[0].back() == Approx(1 - 0.2 * std::cos(1.0)).margin(1e-11));
}

TEST_CASE("stops that cannot be, and starts behind them, are refused", "[stops]") {
  const OneBlock block{.speed = 0.3, .static_friction = 1, .kinetic_friction = 0.4};
  CHECK_THROWS_WITH(follow(block.model({.at = 0.7}, 0.8, 0), 1),
                    "the start at displacement = 0.8 m lies behind the stop at 0.7 m; give one below it");
  CHECK_THROWS_AS(follow(block.model({.at = 0.7}, 0.7, 0.1), 1), InputError);
  auto model = block.model({.at = 0.7}, 0, 0);
  model.structure.stops.push_back({.at = 0.7, .side = -1});
  CHECK_THROWS_AS(model.structure.check(), InputError);
  model.structure.stops[1] = {.at = 0.9};
  CHECK_THROWS_AS(model.structure.check(), InputError);
  model.structure.stops = {{.coordinate = 1, .at = 0.9}};
  CHECK_THROWS_AS(model.structure.check(), InputError);
  auto& s = model.structure;
  s.M = Eigen::Matrix2d{{2, 0.5}, {0.5, 1}}, s.K = s.C = Eigen::Matrix2d::Identity();
  s.names = {"a", "b"}, s.contacts = {};
  s.stops = {{.at = 0.7}};
  CHECK_THROWS_AS(s.check(), InputError);
  s.stops = {{.at = 0.7, .stiffness = 10}};
  CHECK_NOTHROW(s.check());
}
