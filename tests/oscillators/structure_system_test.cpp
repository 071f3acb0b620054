/// A structure's equations against the slider's, and its switches against independent event-driven integrations.
#include "oscillators/structure_system.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>
#include <sstream>

#include "oscillators/slider_system.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"
#include "tests/surrounded_laws.hpp"

using namespace rosin;
using namespace rosin::oscillators;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

Structure of_one_coordinate(const Model& model) {
  return {.M = MatrixXd::Constant(1, 1, model.slider.mass),
          .C = MatrixXd::Constant(1, 1, model.slider.damping),
          .K = MatrixXd::Constant(1, 1, model.slider.stiffness),
          .force = {model.drive.force},
          .names = {"displacement"},
          .contacts = {contact_of(model)}};
}

FrictionContact dry(const char* law, std::vector<double> values, double speed) {
  std::vector<Value> numbers(values.begin(), values.end());
  FrictionContact contact;
  contact.law = laws::find_law(law);
  if (!values.empty()) contact.law = contact.law->with(numbers);
  contact.speed = speed;
  return contact;
}

struct Event {
  double time;
  int contact;
  std::string what;
};
std::vector<Event> read(const char* text) {
  std::vector<Event> events;
  std::istringstream stream(text);
  Event event;
  for (std::string what; stream >> event.time >> event.contact >> what; events.push_back(event))
    event.what = what.substr(0, what.find(';'));
  return events;
}

/// Times of stick, slip onset and reversal at each contact.
std::vector<Event> switches(StructureSystem& system, const std::vector<double>& start, double duration) {
  solvers::stick_slip::StickSlip solver(system, 1e-12);
  REQUIRE(solver.start(0, start));
  std::vector<Event> events;
  while (solver.time() < duration) {
    solvers::stick_slip::Switch switched;
    const Outcome outcome = solver.step(duration, switched);
    INFO(outcome.detail);
    REQUIRE(outcome.complete());
    for (const auto& [contact, what] : solver.events())
      events.push_back({solver.time(), contact + 1, name(what) == "reversal" ? "rev" : name(what)});
  }
  return events;
}

void compare(const std::vector<Event>& found, const char* text, double accuracy) {
  const auto expected = read(text);
  REQUIRE(expected.size() > 5);
  std::size_t next = 0;
  for (const Event& event : expected) {
    INFO("event at t = " << event.time << " of contact " << event.contact << ": " << event.what);
    REQUIRE(next < found.size());
    CHECK(found[next].time == Approx(event.time).margin(accuracy));
    CHECK(found[next].contact == event.contact);
    CHECK(found[next].what == event.what);
    ++next;
  }
}

constexpr const char* events_A1 =
    "0.088381913604 2 stick; 2.069820771280 1 stick; 5.554343852592 2 slip; 7.525154961684 1 slip; "
    "8.531828928958 2 stick; 9.725046295233 2 slip; 10.151531959238 1 stick; 12.362716117971 2 stick; "
    "12.686697920440 1 slip; 15.676991630203 1 stick; 16.936513625121 2 slip; 18.744520054908 1 slip; "
    "19.989216515758 2 stick; 20.887040218506 2 slip; 21.404858701135 1 rev; 21.644776979163 1 stick; "
    "23.473419925429 2 stick; 24.216804844077 1 slip; 27.207098553840 1 stick; 28.738238513948 2 slip; "
    "30.491840871480 1 slip; 31.832924120971 2 stick; 32.632138242603 2 slip; 33.169140680450 1 rev; ";
constexpr const char* events_A2 =
    "0.102529794698 2 stick; 2.097749757414 1 stick; 6.998328700812 2 slip; 7.671994189260 1 slip; "
    "10.891996665583 1 stick; 11.720436363182 2 stick; 14.731634862478 1 slip; 15.767563251514 2 slip; "
    "18.927928876961 2 stick; 19.645295868800 1 stick; 22.533163708565 2 slip; 23.449968466227 1 slip; "
    "26.478145078100 1 stick; 27.576711872611 2 stick; 29.678098488275 1 slip; 31.000618328010 2 slip; "
    "33.999390268355 2 stick; 34.912282540301 1 stick; 36.892085993357 2 slip; 38.055467072360 1 slip; "
    "40.904566743694 1 stick; 42.253417312326 2 stick; 43.285224921745 1 slip; 44.987990766205 2 slip; ";
constexpr const char* events_A3 =
    "2.381323687456 2 rev; 2.477196350111 1 rev; 3.621105207361 1 stick; 5.428849419374 1 slip; "
    "9.393555575187 1 stick; 12.293269212646 2 stick; 12.655677580355 2 slip; 12.876675779841 1 slip; "
    "18.039200983785 1 stick; 18.238598018942 1 slip; 20.278646574646 2 stick; 21.941410690570 1 rev; "
    "21.960559746257 1 stick; 24.675522069772 2 slip; 25.915183299398 1 slip; 30.746362424804 1 stick; "
    "31.478726184311 1 slip; 32.876353958736 2 rev; 33.079965602517 2 stick; 35.222538407165 1 stick; "
    "37.449141745883 2 slip; 38.448986309516 1 slip; 43.358908259935 1 stick; 43.961736270679 1 slip; ";
constexpr const char* events_C1 =
    "0.106134632845 2 rev; 0.504948126654 1 stick; 1.429615960944 2 stick; 1.738990326697 1 slip; "
    "3.492306717071 2 slip; 6.396720563997 2 stick; 6.622025472877 1 stick; 8.564624198572 2 slip; "
    "10.499349524613 1 slip; 15.368594909858 1 stick; 15.450601439250 2 stick; 15.486249210039 1 slip; "
    "16.799020838655 2 slip; 18.344119747241 1 stick; 19.595215962188 1 slip; 24.387144252429 1 stick; "
    "24.457892957551 2 stick; 24.649712670537 1 slip; 26.172487346165 2 slip; 27.352366811213 1 stick; "
    "28.613606801199 1 slip; 33.393631019243 1 stick; ";
constexpr const char* events_C2 =
    "0.116344808570 1 stick; 2.283727694962 2 stick; 2.571883074425 1 slip; 4.920765999452 2 slip; "
    "7.504176013869 2 stick; 7.696344652765 1 stick; 7.710116283591 1 slip; 9.445865543850 2 slip; "
    "13.446398291193 1 stick; 13.529221533179 2 stick; 14.558413386317 1 slip; 17.913155640165 2 slip; "
    "20.370831700183 2 stick; 20.690319891937 1 stick; 22.645707939632 1 slip; 22.844568562362 2 slip; "
    "27.598878148198 1 stick; 27.752424829099 2 stick; 28.545599784297 1 slip; 31.716467528615 2 slip; "
    "34.251534269339 2 stick; 34.678640041691 1 stick; ";
constexpr const char* events_C3 =
    "3.566259525739 1 stick; 3.613005508446 2 stick; 4.136533648495 2 slip; 7.024678869587 2 stick; "
    "7.224961782428 1 rev; 10.709075844653 2 stick; 10.834744218489 1 stick; ";
constexpr const char* events_B1 =
    "0.294837392043 2 slip; 1.331116534187 3 slip; 1.376057450651 4 stick; 2.704968379335 5 slip; "
    "2.771872736669 4 slip; 3.232361790550 3 stick; 3.325775377848 1 stick; 3.677682744694 2 stick; "
    "5.377075877846 3 slip; 5.489847894888 5 stick; 6.379633411943 4 stick; 6.557320257813 2 slip; "
    "7.104660749234 3 stick; 7.460785564106 1 slip; 8.185214314715 2 stick; 8.556383506264 4 slip; "
    "8.943114376363 2 slip; 9.556630298475 3 slip; 9.573032793582 1 stick; 10.684814315323 2 stick; "
    "10.983836051995 5 slip; 11.431234272587 3 stick; 11.852028764007 2 slip; 12.131066319261 4 stick; "
    "12.571321507884 4 slip; 12.723162485369 1 slip; 13.170152150845 5 stick; 13.399963752931 3 slip; "
    "14.159462616812 4 stick; 15.392045932011 4 slip; 15.925019956271 2 stick; 16.660021309966 1 stick; ";
constexpr const char* events_B2 =
    "0.222063078723 2 slip; 1.095438391721 3 slip; 1.331630522443 4 stick; 2.884261990550 3 stick; "
    "2.985349039826 5 slip; 3.046169764612 4 slip; 3.155579552676 1 stick; 3.277858355106 2 stick; "
    "4.447736546265 3 slip; 5.634724103000 5 stick; 5.771999011428 2 slip; 6.209447840279 3 stick; "
    "6.242936240871 1 slip; 6.537113892431 4 stick; 7.079036764770 3 slip; 8.370336041556 4 slip; "
    "8.731219574389 5 slip; 8.750022952571 1 stick; 9.207822516302 2 stick; 10.812604736816 1 slip; "
    "11.271925202997 2 slip; 11.368815127978 5 stick; 11.674989822399 4 stick; 13.149032292264 4 slip; "
    "14.012165669593 5 slip; 14.066052033484 1 stick; 14.779172130364 4 stick; 15.225934727293 4 slip; "
    "16.163672793124 5 stick; 16.819543175298 4 stick; 17.057485577640 1 slip; 17.591018952789 3 stick; ";

}  // namespace

TEST_CASE("a structure of one coordinate has the slider's equations, under every law in every surrounding") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> part(-1, 1);
  for (auto model : tests::surrounded_laws()) {
    if (model.lambda == 0) continue;
    model.slider = {2.0, 5e3, 3.0};
    model.drive.force = Signal(Signal::Harmonics{0.1, {{0.3, 20, 0}}});
    for (const auto mode : {ContactMode::forward, ContactMode::stick}) {
      if (mode == ContactMode::stick && !model.law->set_valued()) continue;
      SliderSystem slider(model);
      StructureSystem structure(of_one_coordinate(model));
      if (model.law->set_valued()) slider.set_mode(0, mode), structure.set_mode(0, mode);
      INFO(model.law->card().name << ", lambda " << model.lambda << ", contact stiffness "
                                  << model.contact_stiffness.tangential << ", " << model.contact_stiffness.per_load);
      const int n = slider.size();
      REQUIRE(structure.size() == n);
      auto y = slider.unknowns_at(0, 1e-4, mode == ContactMode::stick ? 0 : 2e-4, model.law->steady({3e-4, 2.0}), 0.8);
      std::vector<double> s(n), f(n), g(n), J(n * n), L(n * n), m(n), k(n);
      slider.scale(y.data(), s.data());
      for (int i = 2; i < n; ++i) y[i] += 0.1 * part(random) * s[i];
      slider.linearise(0.3, y.data(), f.data(), J.data());
      structure.linearise(0.3, y.data(), g.data(), L.data());
      slider.mass(0.3, m.data());
      structure.mass(0.3, k.data());
      for (int i = 0; i < n; ++i) {
        INFO("row " << i << ", " << structure.unknown(i));
        CHECK(m[i] == k[i]);
        // The slider's friction creeps by less than rounding where a mass reverses.
        CHECK(g[i] == Approx(f[i]).epsilon(1e-10).margin(1e-12 * std::abs(f[1])));
        for (int j = 0; j < n; ++j) {
          if (mode == ContactMode::stick && j == 1) continue;  // the slip rate is 0: nothing hangs on it
          CHECK(L[i * n + j] == Approx(J[i * n + j]).epsilon(1e-9).margin(1e-12));
        }
      }
      if (mode == ContactMode::forward) {
        model.drive.force = 0.2;
        const SliderSystem still(model);
        const StructureSystem also(of_one_coordinate(model));
        const auto a = still.steady(0), b = also.steady(0);
        for (int i = 0; i < n; ++i) CHECK(b[i] == Approx(a[i]).epsilon(1e-12));
      }
    }
  }
}

TEST_CASE("the Jacobian of contacts that share masses is that of differences, in every mode") {
  Structure structure;
  structure.M = MatrixXd{{1, 0.3, 0.1}, {0.3, 0.8, 0}, {0.1, 0, 1.2}};
  structure.K = MatrixXd{{2, -0.7, 0}, {-0.7, 1.5, 0.2}, {0.3, 0.2, 1}};
  structure.C = 0.1 * structure.K;
  structure.contacts = {dry("stribeck", {}, 0.3), dry("hyperbolic", {0.5, 2}, 0.2), dry("ageing", {}, 1e-3)};
  structure.contacts[0].tangential = VectorXd{{1, 0.5, 0}};
  structure.contacts[1].tangential = VectorXd{{-0.3, 1, 0.2}};
  structure.contacts[2].tangential = VectorXd{{0.7, 1.5, 0.2}};  // the sum of the two: no speed of its own
  structure.contacts[1].speed = Signal(Signal::Harmonics{0.2, {{0.1, 3, 0}}});
  StructureSystem system(structure);
  REQUIRE(system.contacts() == 2);
  const int n = system.size();
  auto y = system.unknowns_at(0.1, VectorXd{{0.1, -0.2, 0.3}}, VectorXd{{0.05, 0.02, -0.04}});
  for (const auto first : {ContactMode::forward, ContactMode::stick})
    for (const auto second : {ContactMode::forward, ContactMode::stick}) {
      system.set_mode(0, first);
      system.set_mode(1, second);
      std::vector<double> f(n), there(n), J(n * n);
      system.linearise(0.1, y.data(), f.data(), J.data());
      for (int j = 0; j < n; ++j) {
        constexpr double h = 1e-6;
        auto moved = y;
        moved[j] += h;
        system.evaluate(0.1, moved.data(), there.data());
        for (int i = 0; i < n; ++i) {
          INFO(system.unknown(i) << " by " << system.unknown(j));
          CHECK((there[i] - f[i]) / h == Approx(J[i * n + j]).epsilon(1e-4).margin(1e-4));
        }
      }
      // M q̈ = −K q − C q̇ + Σ t F gives the rates of all speeds, also where a surface that accelerates pulls by stick.
      std::vector<double> force(3);
      system.friction_forces(0.1, y.data(), force.data());
      const Eigen::Map<const VectorXd> q(y.data(), 3);
      VectorXd R = -structure.K * q - structure.C * system.velocity(0.1, y.data());
      for (int j = 0; j < 3; ++j) R += force[j] * structure.contacts[j].tangential;
      const VectorXd acceleration = structure.M.inverse() * R;
      for (int i = 0; i < 3; ++i) {
        double expected = acceleration[i];
        for (int c = 0; c < 2; ++c)
          if (system.slip_rate_unknown(c) == 3 + i)
            expected = structure.contacts[c].speed.rate(0.1) - structure.contacts[c].tangential.dot(acceleration);
        CHECK(f[3 + i] == Approx(expected).margin(1e-12));
      }
      // A contact that sticks keeps its slip rate, and the force that does so balances V̇ − tᵀ M⁻¹ (R + t F).
      for (int c = 0; c < 2; ++c)
        if (system.mode(c) == ContactMode::stick) CHECK(f[system.slip_rate_unknown(c)] == 0);
    }
}

TEST_CASE("two blocks on a belt switch when independent integrations say") {
  const auto belt = [](std::vector<double> m, std::vector<double> k, double coupling,
                       std::vector<FrictionContact> contacts) {
    return chain({.mass = m,
                  .coupling_stiffness = {coupling},
                  .coupling_damping = {0},
                  .pull_stiffness = k,
                  .pull_damping = {0, 0}},
                 std::move(contacts));
  };
  SECTION("friction that falls with the slip rate from its static value") {
    StructureSystem system(
        belt({1, 1}, {1, 1}, 1.2, {dry("hyperbolic", {1, 3}, 0.2), dry("hyperbolic", {1.3, 3}, 0.2)}));
    compare(switches(system, system.unknowns_at(0, VectorXd{{0.5, -0.3}}, VectorXd{{0, 0}}), 33.2), events_A1, 1e-8);
  }
  SECTION("kinetic friction below static") {
    StructureSystem system(belt({1, 1}, {1, 1}, 1.2, {dry("coulomb", {1, 0.6}, 0.2), dry("coulomb", {1.3, 0.7}, 0.2)}));
    compare(switches(system, system.unknowns_at(0, VectorXd{{0.5, -0.3}}, VectorXd{{0, 0}}), 45), events_A2, 1e-8);
  }
  SECTION("one block faster than the belt") {
    StructureSystem system(
        belt({1, 2}, {1, 0.5}, 0.4, {dry("hyperbolic", {1, 1}, 0.5), dry("hyperbolic", {1, 1}, 0.5)}));
    compare(switches(system, system.unknowns_at(0, VectorXd{{1.2, -1.5}}, VectorXd{{0, 1.2}}), 44), events_A3, 1e-8);
  }
}

TEST_CASE("five blocks in a row switch when independent integrations say") {
  const std::vector<double> holds = {1, 1.1, 0.9, 1.05, 0.95};
  const VectorXd q{{0.9, 0.8, 0.6, 0.7, 0.5}}, still = VectorXd::Constant(5, 0.1);
  const auto row = [&](const char* law, double kinetic) {
    std::vector<FrictionContact> contacts;
    for (const double Fs : holds) contacts.push_back(dry(law, {Fs, law[0] == 'h' ? 2 : kinetic * Fs}, 0.1));
    return chain({.mass = std::vector<double>(5, 1.0),
                  .coupling_stiffness = std::vector<double>(4, 2.5),
                  .coupling_damping = std::vector<double>(4, 0.0),
                  .pull_stiffness = std::vector<double>(5, 1.0),
                  .pull_damping = std::vector<double>(5, 0.0)},
                 contacts);
  };
  SECTION("friction that falls with the slip rate") {
    StructureSystem system(row("hyperbolic", 0));
    compare(switches(system, system.unknowns_at(0, q, still), read(events_B1).back().time + 1e-3), events_B1, 1e-8);
  }
  SECTION("kinetic friction below static") {
    StructureSystem system(row("coulomb", 0.7));
    compare(switches(system, system.unknowns_at(0, q, still), read(events_B2).back().time + 1e-3), events_B2, 1e-8);
  }
}

TEST_CASE("two contacts that share masses switch when independent integrations say, at the same instant too") {
  const auto structure = [](MatrixXd M, MatrixXd C, MatrixXd K, VectorXd first, VectorXd second, double speed,
                            double other_speed, std::vector<double> holds, std::vector<Signal> force) {
    Structure made{.M = M, .C = C, .K = K, .force = force, .names = {}, .contacts = {}};
    made.contacts = {dry("coulomb", {holds[0], holds[0]}, speed), dry("coulomb", {holds[1], holds[1]}, other_speed)};
    made.contacts[0].tangential = first, made.contacts[1].tangential = second;
    return made;
  };
  const auto harmonic = [](double amplitude, double w, double phase) {
    return Signal(Signal::Harmonics{0, {{amplitude, w, phase}}});
  };
  const MatrixXd M{{1, -0.4}, {-0.4, 0.7}}, C{{0.05, 0.01}, {0.01, 0.04}}, K{{1.5, 0.4}, {0.4, 1.2}};
  SECTION("weakly coupled contacts") {
    StructureSystem system(structure(MatrixXd{{1, 0.3}, {0.3, 0.8}}, MatrixXd{{0.06, -0.02}, {-0.02, 0.05}},
                                     MatrixXd{{2, -0.7}, {-0.7, 1.5}}, VectorXd{{1, 0.5}}, VectorXd{{-0.3, 1}}, 0.3,
                                     0.2, {0.5, 0.4}, {harmonic(0.6, 0.7, 0), harmonic(0.2, 0.7, 0)}));
    compare(switches(system, system.unknowns_at(0, VectorXd{{0.3, -0.2}}, VectorXd{{0, 0}}), 33.5), events_C1, 1e-8);
  }
  SECTION("strongly coupled contacts: stick of one lets the other go") {
    StructureSystem system(structure(M, C, K, VectorXd{{1, 0.2}}, VectorXd{{0.6, 1}}, 0.1, 0, {0.6, 0.5},
                                     {harmonic(0.8, 0.45, 0.3), harmonic(-0.5, 0.45, 0.3)}));
    const auto found = switches(system, system.unknowns_at(0, VectorXd{{0, 0.4}}, VectorXd{{0, 0}}), 34.7);
    // The other contact's slip in the instant in which the first sticks is an event of its own.
    std::vector<Event> first_of_instant;
    int at_once = 0;
    for (const Event& event : found)
      if (!first_of_instant.empty() && event.time == first_of_instant.back().time)
        ++at_once;
      else
        first_of_instant.push_back(event);
    CHECK(at_once == 1);
    compare(first_of_instant, events_C2, 1e-8);
  }
}

TEST_CASE("structures that do not fit are refused") {
  Structure structure = two_mass_belt({{1, 1, 0}, {2, 3, 0}}, dry("coulomb", {0.4, 0.3}, 1), 0.0);
  CHECK_NOTHROW(structure.check());
  auto wrong = structure;
  wrong.K = MatrixXd::Identity(3, 3);
  CHECK_THROWS_WITH(wrong.check(), Catch::Contains("K is 3 × 3, but M has 2 coordinates"));
  wrong = structure;
  wrong.M(0, 1) = 0.1;
  CHECK_THROWS_WITH(wrong.check(), Catch::Contains("not symmetric and positive definite"));
  wrong = structure;
  wrong.contacts[0].tangential = VectorXd::Ones(3);
  CHECK_THROWS_WITH(wrong.check(), Catch::Contains("contact 1: tangential has 3 entries"));
  wrong = structure;
  wrong.contacts.push_back(wrong.contacts[0]);
  CHECK_THROWS_WITH(wrong.check(), Catch::Contains("directions that depend on each other"));
  CHECK_THROWS_WITH(
      StructureSystem(two_mass_belt({{1, 1, 0}, {2, 0, 0}}, dry("coulomb", {0.4, 0.3}, 1), 0.0)).steady(0),
      Catch::Contains("no steady sliding"));
}

TEST_CASE("loads that follow motion: the Jacobian, lift-off, and steady sliding by Newton's method") {
  Structure structure;
  structure.M = MatrixXd{{1, 0.1}, {0.1, 0.8}};
  structure.K = MatrixXd{{3, 0.4}, {0.4, 2}};
  structure.C = 0.1 * structure.K;
  auto contact = dry("stribeck", {}, 0.3);
  contact.tangential = VectorXd{{1, 0.2}};
  contact.normal = VectorXd{{0.1, 1}};
  contact.normal_load = 0.7;
  contact.normal_law = laws::normal_law(laws::LinearContact{.stiffness = 2, .cubic = 5, .damping = 0.3});
  structure.contacts = {contact, contact};
  structure.contacts[1].law = laws::find_law("ageing");
  structure.contacts[1].tangential = VectorXd{{0.1, 0.9}};
  structure.contacts[1].normal_law = laws::normal_law(laws::LinearContact{.stiffness = 2, .cubic = 5});
  StructureSystem system(structure);
  const int n = system.size();
  for (const auto mode : {ContactMode::forward, ContactMode::stick})
    for (const double a : {0.1, -0.8}) {  // pressed, and lifted off
      system.set_mode(0, mode);
      const auto y = system.unknowns_at(0, VectorXd{{0.3, a}}, VectorXd{{0.05, 0.02}});
      CHECK((system.normal_load(0, 0, y.data()) > 0) == (a > 0));
      std::vector<double> f(n), there(n), J(n * n);
      system.linearise(0, y.data(), f.data(), J.data());
      for (int j = 0; j < n; ++j) {
        constexpr double h = 1e-6;
        auto moved = y;
        moved[j] += h;
        system.evaluate(0, moved.data(), there.data());
        for (int i = 0; i < n; ++i) {
          INFO(system.unknown(i) << " by " << system.unknown(j) << ", a = " << a);
          CHECK((there[i] - f[i]) / h == Approx(J[i * n + j]).epsilon(1e-4).margin(1e-4));
        }
      }
    }
  system.set_mode(0, ContactMode::forward);
  const auto y = system.steady(0);
  std::vector<double> f(n);
  system.evaluate(0, y.data(), f.data());
  for (int i = 0; i < n; ++i) CHECK(f[i] == Approx(0).margin(1e-9));
  structure.contacts[0].stiffness.tangential = 1e3;
  CHECK_THROWS_WITH(StructureSystem(structure), Catch::Contains("damping adds to it"));
  std::swap(structure.contacts[0].stiffness, structure.contacts[1].stiffness);  // under a law that creeps
  CHECK_THROWS_WITH(StructureSystem(structure), Catch::Contains("contact stiffness does not go with"));
}
