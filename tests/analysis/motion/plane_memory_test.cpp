/// Motion in the plane under friction that remembers: against the line, against a turned line, against an outside
/// integration, and against Coulomb friction.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/run.hpp"
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "laws/plane_form.hpp"

using namespace rosin;
using namespace rosin::analysis::motion;

namespace {

Signal harmonic(double amplitude, double w, double phase = 0) {
  return Signal(Signal::Harmonics{0, {{amplitude, w, phase}}});
}

std::shared_ptr<const FrictionLaw> law_of(const char* name, std::map<std::string, double> values) {
  auto law = laws::find_law(name);
  for (const auto& [parameter, value] : values) law = law->with(parameter, value);
  return law;
}

struct LineCase {
  std::shared_ptr<const FrictionLaw> law;
  double V, load, force, w, duration;
};

/// Laws whose states keep their sign, with a slip rate of their own and without, and those with one that turns.
std::vector<LineCase> line_cases() {
  return {{law_of("ageing", {{"mu0", 0.6}, {"a", 0.01}, {"b", 0.015}, {"L", 1e-4}, {"v0", 1e-3}}), 1e-3, 10, 0, 1, 40},
          {law_of("slip", {{"a", 0.05}, {"b", 0.06}, {"L", 0.02}, {"v0", 0.1}}), 0.3, 1, 0.8, 1.1, 30},
          {laws::find_law("spinodal"), 1e-3, 5, 0.3, 0.7, 30},
          {law_of("lugre", {{"sigma0", 100}, {"sigma1", 2}, {"sigma2", 0.1}, {"v_s", 0.1}}), 0.2, 2, 1, 0.9, 30},
          {law_of("dahl", {{"sigma0", 100}}), 0.1, 2, 1, 0.9, 30},
          {law_of("film", {{"A", 1e-6}, {"S", 1e7}, {"d", 0.1}, {"v0", 0.1}}), 0.1, 2, 1, 0.9, 30}};
}

}  // namespace

TEST_CASE("friction that remembers moves a slider along a line of the plane as on the line", "[plane]") {
  for (const auto& c : line_cases())
    for (const double angle : {0.0, std::numbers::pi / 6}) {
      CAPTURE(c.law->card().name, angle);
      const double e[] = {std::cos(angle), std::sin(angle)};
      const auto both = [&](double value) { return std::array{value * e[0], value * e[1]}; };
      const double x0 = 0.3, v0 = 0.2 * c.V;
      PlaneModel plane{{1, {1, 1}, {0.05, 0.05}, 0, 0, both(c.V), c.load, {}}, both(x0), both(v0), c.law};
      for (int d = 0; d < 2; ++d) plane.mass.force[d] = harmonic(c.force * e[d], c.w);
      oscillators::Model line{.law = c.law};
      line.slider = {1, 1, 0.05};
      line.drive = {c.V, c.load, harmonic(c.force, c.w)};
      RunOptions options;
      options.duration = c.duration, options.samples = 100, options.tolerance = 1e-8;
      const Run in_plane = run_plane(plane, options);
      INFO(in_plane.outcome.detail);
      REQUIRE(in_plane.outcome.complete());
      options.start = {.kind = Start::Kind::given, .displacement = x0, .velocity = v0};
      const Run on_line = run(line, options);
      REQUIRE(on_line.outcome.complete());
      REQUIRE(in_plane.columns.size() >= 7);
      // Displacement, velocity and friction in the plane, and their columns on the line.
      for (const auto& [here, there] : {std::pair{0, 0}, std::pair{2, 1}, std::pair{4, 3}})
        for (int d = 0; d < 2; ++d) {
          const std::size_t column = std::size_t(here + d);
          CAPTURE(in_plane.column_names[column], in_plane.column_error[column], on_line.column_error[there]);
          for (std::size_t i = 0; i < on_line.time.size(); ++i)
            REQUIRE(std::abs(in_plane.columns[column][i] - on_line.columns[there][i] * e[d]) <=
                    in_plane.column_error[column] + on_line.column_error[there] + 1e-12);
        }
      const auto states = c.law->states().size();
      const bool turns = c.law->deflects();
      REQUIRE(in_plane.columns.size() == 6 + states + (turns ? 1 : 0));
      CHECK(in_plane.column_names[6] == c.law->states()[0].name + (turns ? "_x" : ""));
      for (std::size_t i = 0; i < on_line.time.size(); ++i)
        REQUIRE(std::abs(in_plane.columns[6][i] - on_line.columns[5][i] * (turns ? e[0] : 1)) <=
                in_plane.column_error[6] + on_line.column_error[5] + 1e-12 * std::abs(on_line.columns[5][i]));
      CHECK(std::abs(in_plane.metrics.at("energy_residual")) < 1e-8);
    }
}

TEST_CASE("friction that remembers turns with the slip as an outside integration has it", "[plane]") {
  // scipy 1.10 solve_ivp, DOP853 at a relative tolerance of 3e-14 and 1e-12, and Radau at 1e-11: the digits that agree.
  struct Case {
    std::shared_ptr<const FrictionLaw> law;
    std::array<double, 2> surface, amplitude, velocity;
    std::map<std::string, double> states;
    std::vector<std::vector<double>> points;  ///< t, x, y, vx, vy, states
  };
  const Case cases[] = {
      {law_of("ageing", {{"mu0", 0.6}, {"a", 0.05}, {"b", 0.03}, {"L", 0.02}, {"v0", 0.1}}),
       {0.3, 0.1},
       {0.8, 0.6},
       {0.2, -0.1},
       {{"theta", 0.05}},
       {{5, -0.5824463245676, 0.3380436747656, 0.440358816504, 0.0866975089074, 0.142361011197},
        {10, -0.7683632601105, -0.0216405824645, -0.4288380978479, -0.6329124437014, 0.0190338323059},
        {20, 0.4780650976608, 0.2809155881782, -0.9513653503168, 0.1429629251362, 0.0160898865245},
        {30, 1.060211175445, -0.1234891761516, 0.1912428008543, 0.3228263248461, 0.0915867517784}}},
      {law_of("lugre", {{"sigma0", 40}, {"sigma1", 1.5}, {"sigma2", 0.1}, {"mu_s", 0.6}, {"mu_d", 0.4}, {"v_s", 0.2}}),
       {0.2, 0},
       {0.9, 0.7},
       {0.2, -0.1},
       {{"z_x", -0.002}, {"z_y", -0.001}},
       {{5, -0.9075061787025, 0.4390845688036, 0.6590070776331, 0.3638710713825, -0.0075298867612, -0.0065650371634},
        {10, -1.566016950396, 0.1692058534422, -0.5615376743841, -0.9460378747852, 0.0063586464521, 0.0077171831847},
        {20, 0.8697510737805, 0.3980724593019, -1.891295492518, 0.4585320348007, 0.0097615290949, -0.0021706375214},
        {30, 1.807119502872, -0.4044847715811, 0.9609640799068, 0.5984939608771, -0.0079967014517, -0.0060003471696}}}};
  for (const auto& c : cases) {
    CAPTURE(c.law->card().name);
    PlaneModel model{{1,
                      {1, 1.7},
                      {0.05, 0.02},
                      0,
                      0,
                      c.surface,
                      1.0,
                      {harmonic(c.amplitude[0], 1.1), harmonic(c.amplitude[1], 1.7, -0.5)}},
                     {0.4, -0.2},
                     c.velocity,
                     c.law};
    model.states = c.states;
    RunOptions options;
    options.times = {5, 10, 20, 30}, options.duration = 30;
    for (const double tolerance : {1e-6, 1e-9}) {
      options.tolerance = tolerance;
      const Run run = run_plane(model, options);
      REQUIRE(run.outcome.complete());
      const auto at = [&](std::size_t column) { return column < 4 ? column : column + 2; };
      for (std::size_t i = 0; i < c.points.size(); ++i)
        for (std::size_t k = 0; k + 1 < c.points[i].size(); ++k) {
          CAPTURE(tolerance, i, run.column_names[at(k)], run.column_error[at(k)]);
          CHECK(std::abs(run.columns[at(k)][i] - c.points[i][k + 1]) <= run.column_error[at(k)] + 2e-12);
          CHECK(run.column_error[at(k)] < tolerance);
        }
    }
  }
}

TEST_CASE("friction that ages and nearly holds in the plane stops as an outside integration does", "[plane]") {
  // scipy 1.10 solve_ivp, Radau at 1e-10 and 1e-8, whose slip rates come down to 1e-9 m/s: the digits that agree.
  PlaneModel model{{1, {1, 1.7}, {0.05, 0.02}, 0, 0, {0, 0}, 1.0, {harmonic(0.75, 0.5), harmonic(0.5, 0.8, -0.5)}},
                   {0.1, -0.2},
                   {0.3, 0.2},
                   law_of("ageing", {{"mu0", 0.6}, {"a", 0.01}, {"b", 0.015}, {"L", 1e-3}, {"v0", 1e-3}})};
  model.states = {{"theta", 0.01}};
  RunOptions options;
  options.times = {4, 8, 12}, options.duration = 12;
  const Run run = run_plane(model, options);
  REQUIRE(run.outcome.complete());
  const double outside[][5] = {{0.4222570444, 0.10607399, -0.3249631967, -0.3304256196, 0.0021615962246},
                               {-0.7197298391596, -0.0110003479747, 0.0494118106, 0.180979806, 0.00532256091},
                               {0.2134106081, -0.1201547362, 0.509587053, -0.259958074, 0.00174795725}};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 5; ++k) {
      CAPTURE(i, k);
      CHECK(std::abs(run.columns[k < 4 ? k : 6][i] - outside[i][k]) < 2e-9);
    }
}

TEST_CASE("stiff bristles in the plane tend to Coulomb friction", "[plane]") {
  PlaneModel model{
      {3, {400, 400}, {2, 2}, 0.4, 0.4, {0, 0}, 20.0, {harmonic(10, 5), harmonic(8, 7, 1)}}, {0.01, 0.01}, {0, 0}};
  RunOptions options;
  options.duration = 3, options.samples = 300, options.tolerance = 1e-6;
  const Run coulomb = run_plane(model, options);
  REQUIRE(coulomb.outcome.complete());
  REQUIRE(coulomb.events.size() > 3);
  double before = infinity;
  model.mass.static_friction = model.mass.dynamic_friction = 0;
  for (const double stiffness : {1e4, 1e5, 1e6}) {
    model.law = law_of("lugre", {{"sigma0", stiffness}, {"sigma1", 1}, {"sigma2", 0}, {"mu_s", 0.4}, {"mu_d", 0.4}});
    const Run bristles = run_plane(model, options);
    REQUIRE(bristles.outcome.complete());
    double apart = 0;
    for (int c = 0; c < 2; ++c)
      for (std::size_t i = 0; i < coulomb.time.size(); ++i)
        apart = std::max(apart, std::abs(bristles.columns[c][i] - coulomb.columns[c][i]));
    CAPTURE(stiffness, apart, before);
    CHECK(apart < 0.3 * before);
    before = apart;
  }
  CHECK(before < 3e-5);  // of 0.05 m
}

TEST_CASE("laws with memory have a form in the plane, or say why not", "[plane]") {
  for (const auto& law : laws::catalogue()) {
    if (!law->has_states()) continue;
    CAPTURE(law->card().name);
    const auto why = laws::refusal_in_plane(*law, 10);
    CHECK(why.empty() == !law->set_valued());
  }
  CHECK(laws::turning_state(*laws::find_law("hot-film")) == 0);
  CHECK(laws::turning_state(*laws::find_law("ageing")) == -1);
  PlaneModel model{.mass = {1, {1, 1}, {0, 0}, 0, 0, {1, 0}, 1.0, {0.0, 0.0}}, .law = laws::find_law("static-growth")};
  CHECK_THROWS_WITH(run_plane(model, {}), Catch::Contains("set-valued at rest"));
}
