/// Contact springs with dampers and load memory around any law: closed forms, independent impedances, and every
/// analysis that a law without wrappers serves.
#include <catch2/catch.hpp>
#include <complex>
#include <set>
#include <string_view>

#include "analysis/cycles/cycle.hpp"
#include "analysis/lanes/cycle_lanes.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/steady/stability.hpp"
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "laws/heating.hpp"
#include "tests/surrounded_laws.hpp"

using namespace rosin;
using namespace rosin::analysis;
using oscillators::Model;
using Complex = std::complex<double>;

namespace {

Model slider(std::shared_ptr<const FrictionLaw> law, double V, double N) {
  Model model;
  model.law = std::move(law);
  model.slider = {1, 1.3, 0.02};
  model.drive = {V, N, 0.0};
  return model;
}

/// 1/D(s) + 1/(s Z(s)) + 1/κ(s): slider, friction and contact spring in series; 0 at an eigenvalue.
double imbalance(const Model& model, Complex s, Complex Z) {
  const auto& o = model.slider;
  const auto& spring = model.contact_stiffness;
  const double N = model.drive.normal_load.level();
  const Complex D = o.mass * s * s + o.damping * s + o.stiffness;
  const Complex kappa = 1 / spring.compliance(N) + s * (spring.damping + spring.damping_per_load * N);
  const Complex terms[] = {1.0 / D, 1.0 / (s * Z), 1.0 / kappa};
  const double size = std::abs(terms[0]) + std::abs(terms[1]) + std::abs(terms[2]);
  return std::abs(terms[0] + terms[1] + terms[2]) / size;
}

const std::vector<double>& column(const motion::Run& record, std::string_view name) {
  const auto at = std::find(record.column_names.begin(), record.column_names.end(), name);
  REQUIRE(at != record.column_names.end());
  return record.columns[at - record.column_names.begin()];
}

/// The ageing law as text, with its inverse left out: its contact carries no friction.
std::shared_ptr<const FrictionLaw> ageing_without_inverse() {
  laws::FormulaDescription law;
  law.parameters = {{{"mu0", "1", {0, 10}, "friction"}, 0.6},
                    {{"a", "1", {1e-4, 1}, "direct effect"}, 0.01},
                    {{"b", "1", {0, 1}, "evolution effect"}, 0.015},
                    {{"L", "m", {1e-12, 1}, "slip distance"}, 1e-5},
                    {{"v0", "m/s", {1e-12, 1}, "reference"}, 1e-6}};
  law.states = {{"theta", "s", {1e-300, 1e300}, "age", Scale::log}};
  law.friction = "a*asinh_exp(v/(2*v0), (mu0 + b*ln(theta*v0/L))/a)";
  law.rate = {"1 - abs(v)*theta/L"};
  law.steady = {"L/abs(v)"};
  return laws::make_formula(law);
}

}  // namespace

TEST_CASE("eigenvalues of a slider on a damped contact spring balance the impedances", "[wrappers]") {
  const double V = 3e-6, N = 2;
  const auto per_load = GENERATE(false, true);
  SECTION("a law that is solved for the slip rate") {
    const double a = 0.01, b = 0.015, L = 1e-5;
    Model model = slider(laws::find_law("ageing")->with({0.6, a, b, L, 1e-6}), V, N);
    model.contact_stiffness = per_load ? oscillators::ContactStiffness{infinity, 400, 0, 7}
                                       : oscillators::ContactStiffness{800, infinity, 30};
    const auto found = steady::stability(model);
    CHECK(found.eigenvalues.size() == 4);
    for (const Complex s : found.eigenvalues) {
      const Complex Z = N * (a / V - b / V / (1.0 + s * L / V));  // Rice and Ruina (1983)
      INFO(s);
      CHECK(imbalance(model, s, Z) < 1e-11);
    }
  }
  SECTION("a law that is not") {
    const double sigma0 = 1e5, sigma1 = 40, sigma2 = 0.4;
    auto law = laws::find_law("lugre");
    for (const auto& [name, value] :
         {std::pair{"sigma0", sigma0}, {"sigma1", sigma1}, {"sigma2", sigma2}, {"v_s", 1e-3}})
      law = law->with(name, value);
    Model model = slider(law, V, N);
    model.contact_stiffness =
        per_load ? oscillators::ContactStiffness{infinity, 400} : oscillators::ContactStiffness{800, infinity, 30};
    const auto found = steady::stability(model);
    CHECK(found.eigenvalues.size() == 4);
    const double h = 1e-4 * V, g = law->steady_friction({V, 1}).friction - sigma2 * V;
    const double g_v =
        (law->steady_friction({V + h, 1}).friction - law->steady_friction({V - h, 1}).friction) / (2 * h) - sigma2;
    for (const Complex s : found.eigenvalues) {
      // ż = v − σ0 |v| z/g(v) around z = g/σ0: δż = (V g'/g) δv − (σ0 V/g) δz.
      const Complex bristle = V * g_v / g / (s + sigma0 * V / g);
      const Complex Z = N * (sigma0 * bristle + sigma1 * s * bristle + sigma2);
      INFO(s);
      CHECK(imbalance(model, s, Z) < 1e-7);  // the slope of the curve is a difference
    }
  }
}

TEST_CASE("a contact spring is the same whether friction or its deflection is the unknown", "[wrappers]") {
  Model carried = slider(laws::find_law("ageing")->with({0.6, 0.01, 0.015, 1e-5, 1e-6}), 3e-6, 2);
  carried.contact_stiffness.tangential = 800;
  Model deflected = carried;
  deflected.law = ageing_without_inverse();
  motion::RunOptions how;
  how.start.kind = motion::Start::Kind::given;
  how.start.slip_rate = 1e-6;
  how.duration = 20;
  how.samples = 41;
  how.tolerance = 1e-9;
  const auto mass = GENERATE(1.0, 0.0);
  for (Model* model : {&carried, &deflected}) model->slider = {mass, 1.3, mass == 0 ? 0.0 : 0.02};
  const auto a = motion::run(carried, how), b = motion::run(deflected, how);
  REQUIRE(a.outcome.complete());
  REQUIRE(b.outcome.complete());
  for (const char* name : {"slip_rate", "friction_force", "theta"}) {
    const auto &x = column(a, name), &y = column(b, name);
    for (std::size_t i = 1; i < x.size(); ++i) {  // the start with its own slip rate is solved in one form only
      INFO(name << " at " << a.time[i]);
      CHECK(y[i] == Approx(x[i]).epsilon(1e-6));
    }
  }
}

TEST_CASE("a contact damper fades into the undamped spring, and a stiff one into the rigid contact", "[wrappers]") {
  Model model = slider(laws::preset(*laws::find_law("spinodal"), "bristol-board"), 1e-5, 2e-4);
  model.lambda = 10;
  model.slider = {1, 1.09, 0};
  const auto critical = [&](double k_t, double c_t) {
    Model changed = model;
    changed.contact_stiffness.tangential = k_t;
    changed.contact_stiffness.damping = c_t;
    return steady::hopf_points(changed, "drive.normal_load").at(0).value;
  };
  const double undamped = critical(0.5, 0), rigid = critical(infinity, 0);
  CHECK(std::log2((critical(0.5, 2e-3) - undamped) / (critical(0.5, 1e-3) - undamped)) == Approx(1).margin(0.02));
  CHECK(std::log2((critical(0.5, 1e3) - rigid) / (critical(0.5, 2e3) - rigid)) == Approx(1).margin(0.02));
}

TEST_CASE("a law that remembers the load answers a step and a ramp as Linker and Dieterich say", "[wrappers]") {
  const double a = 0.01, b = 0.02, alpha = 0.02, L = 1e-5, V = 2e-6, v0 = 1e-6, mu0 = 0.6;
  Model model;
  model.law = laws::find_law("ageing")->with({mu0, a, b, L, v0});
  model.load_memory = alpha;
  model.slider = {0, infinity, 0};
  motion::RunOptions how;
  how.start.kind = motion::Start::Kind::steady;
  how.duration = 30;
  how.tolerance = 1e-11;
  const auto friction = [&](double theta) { return mu0 + a * std::log(V / v0) + b * std::log(theta * v0 / L); };
  SECTION("step") {
    model.drive = {V, Signal(Signal::Steps{{{0, 2}, {10, 3}}}), 0.0};
    how.times = {9, 10.001, 11, 14, 20, 30};
    const auto record = motion::run(model, how);
    REQUIRE(record.outcome.complete());
    for (std::size_t i = 0; i < record.time.size(); ++i) {
      const double t = record.time[i];
      const double left = t < 10 ? 0 : (std::pow(1.5, -alpha / b) - 1) * std::exp(-V * (t - 10) / L);
      CHECK(column(record, "friction_force")[i] ==
            Approx((t < 10 ? 2 : 3) * friction(L / V * (1 + left))).epsilon(1e-9));
    }
  }
  SECTION("ramp") {  // with α = b: d(θN)/dt = N − (V/L) θN
    const double N0 = 2, rate = 0.3, w = V / L;
    model.drive = {V, Signal(Signal::Ramp{N0, rate}), 0.0};
    how.times = {0.5, 2, 10, 30};
    const auto record = motion::run(model, how);
    REQUIRE(record.outcome.complete());
    for (std::size_t i = 0; i < record.time.size(); ++i) {
      const double t = record.time[i], N = N0 + rate * t;
      const auto particular = [&](double time) { return (N0 + rate * time) / w - rate / (w * w); };
      const double theta = (particular(t) + (N0 / w - particular(0)) * std::exp(-w * t)) / N;
      CHECK(column(record, "friction_force")[i] == Approx(N * friction(theta)).epsilon(1e-9));
    }
  }
  SECTION("laws without such states are refused") {
    model.drive = {V, 2.0, 0.0};
    for (const char* name : {"lugre", "static-growth"}) {
      model.law = laws::find_law(name);
      model.slider = {1, 1, 0};
      CHECK_THROWS_WITH(motion::run(model, how), Catch::Contains("law.load_memory needs a state"));
    }
  }
}

TEST_CASE("a heated contact warms as its equation says, and answers to slip with the impedance of that", "[wrappers]") {
  const double R = 30, time = 0.4, soft = 5, mu = 0.3, N = 1.7;
  SECTION("a step of the slip rate under a rate law") {
    const double a = 0.01, v0 = 1e-3, V1 = 1e-2, V2 = 5e-2;
    Model model;
    model.law = laws::heated(laws::find_law("ageing")->with({mu, a, 0.0, 1e-5, v0}), {R, time, soft});
    model.slider = {0, infinity, 0};
    model.drive = {Signal(Signal::Steps{{{0, V1}, {1, V2}}}), N, 0.0};
    motion::RunOptions how;
    how.duration = 2;
    how.times = {1.0, 1.1, 1.4, 2.0};
    how.tolerance = 1e-11;
    const auto record = motion::run(model, how);
    REQUIRE(record.outcome.complete());
    // The temperature alone, by many steps of the classical method.
    const double F = N * (mu + a * std::log(V2 / v0)), F1 = N * (mu + a * std::log(V1 / v0));
    double rise = soft * 0.5 * (std::sqrt(1 + 4 * R * F1 * V1 / soft) - 1), t = 1;
    CHECK(column(record, "temperature_rise")[0] == Approx(rise).epsilon(1e-9));
    const auto rate = [&](double x) { return (R * F * V2 / (1 + x / soft) - x) / time; };
    const int steps = 10000;
    for (std::size_t i = 1; i < record.time.size(); t = record.time[i++]) {
      const double h = (record.time[i] - t) / steps;
      for (int k = 0; k < steps; ++k) {
        const double k1 = rate(rise), k2 = rate(rise + h / 2 * k1), k3 = rate(rise + h / 2 * k2),
                     k4 = rate(rise + h * k3);
        rise += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      }
      CHECK(column(record, "temperature_rise")[i] == Approx(rise).epsilon(1e-9));
      CHECK(column(record, "friction_force")[i] == Approx(F / (1 + rise / soft)).epsilon(1e-9));
    }
  }
  SECTION("Coulomb friction") {
    const double V = 0.3;
    Model model =
        slider(laws::heated(laws::find_law("coulomb")->with(std::vector<Value>{mu, mu}), {R, time, soft}), V, N);
    const double h = 0.5 * (1 + std::sqrt(1 + 4 * R * N * mu * V / soft)), F = N * mu / h;
    CHECK(steady::stability(model).steady.friction_force == Approx(F).epsilon(1e-14));
    const auto found = steady::stability(model);
    CHECK(found.eigenvalues.size() == 3);
    for (const Complex s : found.eigenvalues) {
      const Complex Z = -F * F * R / (h * soft) / (time * s + 1.0 + R * V * F / (h * soft));
      const Complex D = s * s * model.slider.mass + s * model.slider.damping + model.slider.stiffness;
      CHECK(std::abs(D + s * Z) < 1e-12 * (std::abs(D) + std::abs(s * Z)));
    }
    // The slope of the curve is Z at s = 0.
    const double slope = model.law->steady_friction({V, N}).slope;
    CHECK(N * slope == Approx(-F * F * R / (h * soft) / (1 + R * V * F / (h * soft))).epsilon(1e-12));
  }
}

TEST_CASE("every law, bare and heated, has a cycle or a reason for none, and the same one in lanes", "[wrappers]") {
  std::vector<std::shared_ptr<const FrictionLaw>> all;
  for (const auto& law : laws::catalogue()) {
    all.push_back(law);
    if (!law->deflects() && law->states().size() < 5) all.push_back(laws::heated(law, {30, 0.3, 5}));
  }
  for (const char* name : {"coulomb", "spinodal", "static-growth"})
    all.push_back(laws::heated(laws::find_law(name), {30, 0.3, 5, laws::disc}));
  int cycles = 0, in_lanes = 0;
  for (const auto& law : all) {
    Model model = slider(law, 1e-4, 0.5);
    model.slider = {1, 20, 0.3};
    const auto alone = cycles::find_cycle(model, {.tolerance = 1e-3, .multipliers = false});
    INFO(law->card().name << " with " << law->states().size() << " states: " << alone.outcome.detail);
    CHECK((alone.outcome.complete() || alone.outcome.ending == Ending::none_exists));
    if (!(alone.metrics.period > 0)) continue;
    ++cycles;
    const auto lane = lanes::find_cycles(std::vector{model}, {.tolerance = 1e-4, .metrics = {"period"}}).front();
    if (!lane.found) continue;
    ++in_lanes;
    CHECK(lane.metrics.period == Approx(alone.metrics.period).epsilon(2e-3));
  }
  CHECK(cycles > 38);
  CHECK(in_lanes > 18);
}

TEST_CASE("planes of every law in all its surroundings have a regime at each point, or the reason for none",
          "[wrappers][long]") {
  int cycles = 0, stable = 0, next = 0;
  for (auto model : tests::surrounded_laws()) {
    if (next++ % 7 != 0) continue;  // every surrounding, and every law in some: all of them take minutes
    model.slider = {1, 20, 0.3};
    model.drive = {1e-4, 0.5, 0.0};
    planes::MapOptions plane;
    plane.x = planes::make_axis("oscillator.mass", 0.5, 2, 2, true, {});
    plane.y = planes::make_axis("oscillator.stiffness", 20, 200, 2, true, {});
    plane.metrics = {"period", "loop_area"};
    plane.tolerance = 1e-3;
    const auto map = planes::compute_map(model, plane);
    INFO(model.law->card().name << " with " << model.law->states().size() << " states, lambda " << model.lambda
                                << ", spring " << model.contact_stiffness.tangential << ", "
                                << model.contact_stiffness.per_load);
    for (const auto& point : map.points) {
      CAPTURE(name(point.regime), point.why);
      stable += point.regime == planes::Regime::stable;
      const bool bristle = model.law->card().name.starts_with("lugre");
      if (point.regime == planes::Regime::failed) {
        // A bristle gives energy back: behind a damped spring slip may jump, and beside one motion need not repeat.
        CHECK(bristle);
        CHECK((point.why.find("would have to jump") != std::string::npos ||
               point.why.find("no periodic motion") != std::string::npos ||
               point.why.find("chaotic") != std::string::npos));
      } else if (point.regime != planes::Regime::stable) {
        ++cycles;
        CHECK(point.metrics.period > 0);
        CHECK((point.error.period < 0.01 * point.metrics.period || (bristle && !point.why.empty())));
        CHECK(std::isfinite(point.metrics.loop_area));
      }
    }
  }
  CHECK(cycles > 45);
  CHECK(stable > 30);
}

TEST_CASE("the loop's area is as accurate as the cycle where the slider rings on its contact spring", "[wrappers]") {
  // Slip reverses some hundred times in a period, and with it μ_ss turns over.
  Model model = slider(laws::find_law("bowden-tabor"), 1e-4, 0.05);
  model.lambda = 3;
  model.slider = {1, 200, 0.3};
  model.contact_stiffness.tangential = 3e5;
  const auto cycle = cycles::find_cycle(model, {.tolerance = 1e-6}),
             fine = cycles::find_cycle(model, {.tolerance = 1e-9});
  REQUIRE(cycle.outcome.complete());
  REQUIRE(fine.outcome.complete());
  CHECK(cycle.metrics.slip_rate_min < 0);
  CHECK(cycle.error.loop_area < 1e-6 * cycle.metrics.loop_area);
  CHECK(std::abs(cycle.metrics.loop_area - fine.metrics.loop_area) < cycle.error.loop_area + fine.error.loop_area);
  // The area of the polygon through the solver's steps, from friction alone.
  double area = 0;
  for (std::size_t i = 1; i < fine.orbit.size(); ++i)
    area += 0.5 * (fine.orbit[i].friction_coefficient + fine.orbit[i - 1].friction_coefficient) *
            (fine.orbit[i].slip_rate - fine.orbit[i - 1].slip_rate);
  CHECK(std::abs(area) == Approx(fine.metrics.loop_area).epsilon(0.01));
}

TEST_CASE("every law in every wrapper slides, oscillates and is judged", "[wrappers]") {
  std::vector<std::shared_ptr<const FrictionLaw>> all;
  for (const auto& law : laws::catalogue()) {
    if (law->set_valued()) continue;
    all.push_back(law);
    if (!law->deflects()) all.push_back(laws::heated(law, {1e4, 0.3, 5}));
  }
  for (const auto& law : all) {
    for (const bool damped : {false, true})
      for (const double mass : {1.0, 0.0}) {
        INFO(law->card().name << (damped ? ", damped" : ", undamped") << ", mass " << mass);
        Model model = slider(law, 1e-4, 0.5);
        // On springs stiffer than the critical one, below which slip without mass runs away.
        model.slider = mass == 0 ? oscillators::Slider{0, 1e6, 0} : oscillators::Slider{1, 20, 0.3};
        model.contact_stiffness = {1e6, infinity, damped ? 5.0 : 0.0};
        if (!law->has_slip_rate() && damped) model.contact_stiffness.damping = 1e3;  // or slip would jump
        if (std::ranges::any_of(law->states(), [](const auto& state) { return state.scale == Scale::log; }))
          model.load_memory = 0.1;
        if (damped && mass == 0 && !law->has_slip_rate()) {
          CHECK_THROWS_WITH(steady::stability(model), Catch::Contains("goes with springs alone"));
          continue;
        }
        if (!damped && (law->card().name == "dahl" || law->card().name.ends_with("film"))) {
          CHECK_THROWS_WITH(steady::stability(model), Catch::Contains("only by way of its states"));
          continue;
        }
        const auto judged = steady::stability(model);
        for (const Complex s : judged.eigenvalues) CHECK(std::isfinite(std::abs(s)));
        motion::RunOptions how;
        how.start.kind = motion::Start::Kind::given;
        how.start.slip_rate = 0.5e-4;
        how.duration = 1;
        how.samples = 5;
        const auto record = motion::run(model, how);
        CAPTURE(record.outcome.detail);
        CHECK((record.outcome.complete() || (law->card().name.starts_with("lugre") && !damped &&
                                             record.outcome.detail.find("would have to jump") != std::string::npos)));
      }
  }
}

TEST_CASE("a step of the load changes friction by -alpha ln N'/N, to the last digits and under any law", "[wrappers]") {
  const auto friction = [](const FrictionLaw& law, double v, double N, const double* z) {
    double g[16], F;
    law.contact({.unknowns = Unknowns::states})->evaluate({v, N, 0, 1}, z, g, F);
    return F / N;
  };
  const auto spinodal =
      laws::find_law("spinodal")->with({0.6, 0.0097999, 0.011613, 7.697e-6, 3.4e-7, 0.045538, 21.1647});
  struct Case {
    std::shared_ptr<const FrictionLaw> law;
    double alpha, changed;
  };
  const auto two_states = laws::find_law("two-state-ageing");
  for (const auto& [law, alpha, changed] :
       {Case{spinodal, 0.0682113, 0.6},
        {spinodal, 0.0682113, 1e-3},
        {two_states, 0.3, 0.6},
        {two_states, 0.1, 40.0},
        {laws::find_law("ageing"), 0.2, 1.3},
        {laws::heated(spinodal, {.resistance = 2e4, .time = 0.02, .softening = 30}), 0.05, 0.4}}) {
    const ContactSetup setup{.unknowns = Unknowns::states, .load_memory = alpha};
    const auto contact = law->contact(setup);
    constexpr double v = 1e-4;
    double z[16], weight[16], before[16];
    contact->steady(0, v, 1, z, weight);
    std::copy(z, z + 16, before);
    contact->change_load(v, 1, changed, z);
    INFO(law->card().name << ", N' = " << changed);
    CHECK(std::abs(friction(*law, v, changed, z) - friction(*law, v, 1, before) + alpha * std::log(changed)) < 1e-13);
    if (law == two_states) {  // b₁²: b₂² of it each, by way of a + b₁ ln θ₁ + b₂ ln θ₂
      const auto value = [&](const char* name) { return law->parameter(name); };
      CHECK(value("b1") * (z[0] - before[0]) / (value("b2") * (z[1] - before[1])) ==
            Approx(std::pow(value("b1") / value("b2"), 2)).epsilon(1e-12));
    }
  }
}

TEST_CASE("a rise of the load that no state can carry is refused by that name", "[wrappers]") {
  const auto law = laws::find_law("spinodal")->with({0.6, 0.0097999, 0.011613, 7.697e-6, 3.4e-7, 0.045538, 21.1647});
  const auto contact = law->contact({.unknowns = Unknowns::states, .load_memory = 0.0682113});
  double z[16], weight[16];
  contact->steady(0, 1e-4, 1, z, weight);
  // Friction can fall by b ln(1 + ψ/(c ψ*)) alone.
  const double psi_ref = 7.697e-6 / (7.697e-6 + 3.4e-7 * 21.1647);
  const double carried = 0.011613 * std::log1p(std::exp(z[0]) / (0.045538 * psi_ref)),
               most = std::exp(carried / 0.0682113);
  for (const double changed : {1.3, 2.0, 1.0001 * most})
    CHECK_THROWS_WITH(contact->change_load(1e-4, 1, changed, z),
                      Catch::Contains("the state carries") && Catch::Contains("law.load_memory.alpha"));
  CHECK_NOTHROW(contact->change_load(1e-4, 1, std::pow(most, 0.9), z));
}

TEST_CASE(
    "a ramp of the load adds up to its sudden change where states do nothing else, and its slopes are those of it",
    "[wrappers]") {
  // The law's own rate is taken off: what is left of ż at the load rate R is −(α R/N) s/|s|², s = ∂μ/∂z.
  constexpr double v = 1e-4, N = 1, changed = 0.6, R = -0.3, alpha = 0.05, lambda = 1.7;
  const ContactSetup setup{.lambda = lambda, .unknowns = Unknowns::states, .load_memory = alpha};
  auto all = laws::catalogue();
  all.push_back(laws::heated(laws::find_law("spinodal"), {.resistance = 2e4, .time = 0.02, .softening = 30}));
  std::set<std::string_view> asked;
  for (const auto& law : all) {
    if (law->set_valued() || std::ranges::none_of(law->states(), [](auto& s) { return s.scale == Scale::log; }))
      continue;
    INFO(law->card().name << " with " << law->states().size() << " states");
    asked.insert(law->card().name);
    const auto contact = law->contact(setup);
    const int n = contact->unknowns();
    double z[16], weight[16], sudden[16], F;
    contact->steady(0, v, N, z, weight);
    for (int i = 0; i < n; ++i) z[i] += 0.1 * weight[i] * (i % 2 ? -1 : 1);  // beside steady sliding
    std::copy(z, z + n, sudden);
    contact->change_load(v, N, changed, sudden);
    const auto slope = [&](double load, const double* at, double* by_load) {
      double ramped[16], held[16];
      contact->evaluate({v, load, R, 1}, at, ramped, F);
      contact->evaluate({v, load, 0, 1}, at, held, F);
      for (int i = 0; i < n; ++i) by_load[i] = (ramped[i] - held[i]) / (lambda * R);
    };
    constexpr int steps = 500;
    constexpr double h = (changed - N) / steps;
    double k[4][16] = {}, at[16];
    for (int step = 0; step < steps; ++step) {
      constexpr double node[] = {0, 0.5, 0.5, 1};
      for (int stage = 0; stage < 4; ++stage) {
        for (int i = 0; i < n; ++i) at[i] = z[i] + (stage == 0 ? 0 : node[stage] * h * k[stage - 1][i]);
        slope(N + h * (step + node[stage]), at, k[stage]);
      }
      for (int i = 0; i < n; ++i) z[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
    for (int i = 0; i < n; ++i) CHECK(z[i] == Approx(sudden[i]).epsilon(1e-9).margin(1e-10));

    for (const auto unknowns : {Unknowns::states, Unknowns::friction}) {
      if (unknowns == Unknowns::friction && !law->has_slip_rate()) continue;
      const auto remembering =
          law->contact({.lambda = lambda, .compliance = 1e-6, .unknowns = unknowns, .load_memory = alpha});
      const int m = remembering->unknowns();
      double g[16];
      remembering->steady(0, v, N, z, weight);
      for (int i = 0; i < m; ++i) z[i] += 0.1 * weight[i] * (i % 2 ? -1 : 1);
      // A load rate at which what it adds is no less than the rates themselves.
      const ContactInput<double> in{v, N, 2e3, 1};
      Slopes<double> slopes;
      remembering->linearise(in, z, g, F, slopes);
      for (int direction = 0; direction < m + 2; ++direction) {
        const double size = direction < m ? 0.1 * weight[direction] : direction == m ? v : N, step = 1e-3 * size;
        const auto moved = [&](double by) {
          std::vector<double> there(z, z + m), answer(std::size_t(m) + 1);
          there.resize(std::size_t(m) + 1);
          auto input = in;
          (direction < m ? there[std::size_t(direction)] : direction == m ? input.slip_rate : input.normal_load) += by;
          remembering->evaluate(input, there.data(), answer.data(), F);
          return answer;
        };
        const auto a = moved(step), b = moved(-step), c = moved(2 * step), d = moved(-2 * step);
        for (int i = 0; i < m; ++i) {
          const auto row = std::size_t(i);
          const double expected = (8 * (a[row] - b[row]) - (c[row] - d[row])) / (12 * step);
          const double given = direction < m    ? slopes.g_z[i * m + direction]
                               : direction == m ? slopes.g_u[i]
                                                : slopes.g_N[i];
          CAPTURE(int(unknowns), direction, i, given, expected);
          CHECK(std::abs(given - expected) * size <= 1e-8 * (std::abs(g[i]) + std::abs(expected) * size));
        }
      }
    }
  }
  for (const char* name : {"ageing", "spinodal", "prz", "kato-tullis", "nagata", "two-state-slip"})
    CHECK(asked.contains(name));
}
