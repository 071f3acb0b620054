/// Laws from text: equal to the compiled laws that they spell, in every form; and refused where they are no laws.
#include "laws/formula.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "laws/catalogue.hpp"
#include "tests/laws/formula_texts.hpp"

using namespace rosin;
using namespace rosin::laws;
using namespace rosin::tests::text;

namespace {

struct Pair {
  std::shared_ptr<const FrictionLaw> text, compiled;
};
std::vector<Pair> pairs() {
  auto solved = spinodal();
  solved.steady = {""};
  return {{make_formula(spinodal()), find_law("spinodal")},
          {make_formula(solved), find_law("spinodal")},
          {make_formula(ageing()), find_law("ageing")},
          {make_formula(two_state_slip()), find_law("two-state-slip")},
          {make_formula(stribeck()), find_law("stribeck")},
          {make_formula(slip_distance()), find_law("slip-distance")->with("mu_d", 0.2)},
          {make_formula(static_growth()), find_law("static-growth")->with("mu_d", 0.2)}};
}

/// Whose steady states depend on each other: one is solved for, both are, and each is given by the other.
std::vector<Pair> films() {
  auto by_rates = hot_film(), by_circle = hot_film();
  by_rates.steady = {"", ""};
  by_circle.steady[1] = "R*A*tau*v";
  return {{make_formula(hot_film()), find_law("hot-film")},
          {make_formula(by_rates), find_law("hot-film")},
          {make_formula(by_circle), find_law("hot-film")}};
}

/// Other values of the parameters, the same for both laws.
std::vector<Value> varied(const FrictionLaw& law, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.8, 1.2);
  auto values = law.values();
  for (auto& value : values) value = std::get<double>(value) * uniform(random);
  return values;
}

bool same(double a, double b, double scale, double tolerance = 1e-12) {
  return std::abs(a - b) <= tolerance * std::max({std::abs(a), std::abs(b), scale}) && !std::isnan(a);
}

void check_equal(const FrictionLaw& text, const FrictionLaw& compiled, double v, double N, std::mt19937& random) {
  std::uniform_real_distribution<double> decades(-2, 2);
  CAPTURE(compiled.card().name, v, N);
  const Sliding<double> at{v, N};
  auto state = compiled.steady(at);
  const auto steady = text.steady(at);
  for (std::size_t k = 0; k < state.size(); ++k) {
    CHECK(same(steady[k], state[k], 0));
    const auto range = compiled.states()[k].range;
    state[k] = std::clamp(state[k] * std::pow(10, decades(random)), range.low, range.high);
  }
  const double mu = compiled.friction(at, state);
  CHECK(same(text.friction(at, state), mu, 0));
  if (compiled.has_states()) {
    const auto a = text.rate(at, state), b = compiled.rate(at, state);
    for (std::size_t k = 0; k < a.size(); ++k) CHECK(same(a[k], b[k], 1e-3 * std::abs(state[k])));
  }
  if (compiled.has_slip_rate()) {
    // dv/v = d(μ/a): the rounding of μ/a, up to some hundreds, is magnified.
    CHECK(same(text.slip_rate(mu, N, state), compiled.slip_rate(mu, N, state), 0));
  }
  CHECK(same(text.steady_friction(at).friction, compiled.steady_friction(at).friction, 0));
  CHECK(same(text.steady_friction(at).slope, compiled.steady_friction(at).slope, 1e-3 * std::abs(mu / v)));
}

std::vector<ContactSetup> setups_of(const FrictionLaw& law) {
  std::vector<ContactSetup> list{{.lambda = 1.5, .unknowns = Unknowns::states},
                                 {.lambda = 0, .unknowns = Unknowns::states}};
  if (law.has_slip_rate()) {
    list.push_back({.lambda = 1.5, .compliance = 1e-6, .unknowns = Unknowns::friction});
    list.push_back({.lambda = 0, .compliance_per_load = 1e-6, .unknowns = Unknowns::friction});
  }
  return list;
}

std::vector<double> everything(const Contact<double>& contact, const ContactInput<double>& in, const double* z) {
  const std::size_t n = std::size_t(contact.unknowns());
  std::vector<double> g(n + 1), m(n + 1);
  Slopes<double> s{};
  double F = 0, mu = 0;
  contact.linearise(in, z, g.data(), F, s);
  contact.mass(in.normal_load, m.data());
  contact.steady_friction(in.slip_rate, in.normal_load, mu);
  std::vector<double> all{F, s.F_u, s.F_N, mu};
  for (std::size_t i = 0; i < n; ++i) {
    all.insert(all.end(), {g[i], m[i], s.F_z[i], s.g_u[i], s.g_N[i]});
    for (std::size_t j = 0; j < n; ++j) all.push_back(s.g_z[i * n + j]);
  }
  return all;
}

std::string refusal(const FormulaDescription& law) {
  try {
    check_formula(*make_formula(law));
  } catch (const ExpressionError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("steady states that depend on each other are solved for, with their slopes", "[laws][formula]") {
  for (const auto& [text, compiled] : films()) {
    check_formula(*text);
    for (const double v : {1e-9, -1e-6, 1e-3, 0.1, 3.0})
      for (const double N : {0.1, 1.0, 3.0}) {
        CAPTURE(v, N);
        const auto a = text->steady({v, N}), b = compiled->steady({v, N});
        for (std::size_t k = 0; k < 2; ++k) CHECK(same(a[k], b[k], 0, 1e-11));
        const auto [mu, slope] = compiled->steady_friction({v, N});
        CHECK(same(text->steady_friction({v, N}).friction, mu, 0, 1e-12));
        CHECK(same(text->steady_friction({v, N}).slope, slope, std::abs(mu / v), 1e-11));
        const ContactInput<double> in{v, N, 0, v < 0 ? -1.0 : 1.0};
        double z[1], g[2], F[2];
        Slopes<double> slopes[2];
        const ContactSetup at_once{.lambda = 0, .unknowns = Unknowns::states};
        text->contact(at_once)->linearise(in, z, g, F[0], slopes[0]);
        compiled->contact(at_once)->linearise(in, z, g, F[1], slopes[1]);
        CHECK(same(F[0], F[1], 0, 1e-12));
        CHECK(same(slopes[0].F_u, slopes[1].F_u, std::abs(F[1] / v), 1e-11));
        CHECK(same(slopes[0].F_N, slopes[1].F_N, std::abs(mu), 1e-11));
      }
  }
}

TEST_CASE("laws from text equal the compiled laws that they spell", "[laws][formula]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> log_speed(-12, 0.5), log_load(-4, 4);
  for (const auto& [text, compiled] : pairs()) {
    check_formula(*text);
    CHECK(text->has_slip_rate() == compiled->has_slip_rate());
    CHECK(text->set_valued() == compiled->set_valued());
    for (int i = 0; i < 300; ++i) {
      const auto values = varied(*compiled, random);
      const double v = std::pow(10, log_speed(random)), N = std::pow(10, log_load(random));
      check_equal(*text->with(values), *compiled->with(values), i % 3 ? v : -v, N, random);
    }
    auto state = compiled->rest(2);
    CHECK(text->rest(2) == state);
    for (double& x : state) x = x == 0 ? 3e-6 : 1.5 * x;
    CHECK(text->after_stop(state) == compiled->after_stop(state));
    const double kink = compiled->kink(state);
    CHECK((std::isnan(kink) ? std::isnan(text->kink(state)) : same(text->kink(state), kink, 0)));
    if (compiled->set_valued()) CHECK(same(text->static_limit(1, state), compiled->static_limit(1, state), 0));
  }
}

TEST_CASE("contacts of laws from text equal those of compiled laws in all forms", "[laws][formula]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> log_speed(-9, -1), uniform(-1, 1);
  for (const auto& [text, compiled] : pairs())
    for (const auto& setup : setups_of(*compiled)) {
      CAPTURE(compiled->card().name, setup.lambda, int(setup.unknowns));
      const auto ours = text->lanes(setup), theirs = compiled->lanes(setup);
      const int n = theirs->unknowns();
      REQUIRE(ours->unknowns() == n);
      ContactInput<Lanes> in{0.0, 0.0, 0.3, 1.0};
      std::vector<Lanes> z(std::size_t(n + 1)), g(std::size_t(n + 1));
      std::vector<std::unique_ptr<Contact<double>>> single;
      for (int lane = 0; lane < lane_count; ++lane) {
        const auto values = varied(*compiled, random);
        ours->load(lane, values, setup);
        theirs->load(lane, values, setup);
        const double u = std::pow(10, log_speed(random)) * (uniform(random) < -0.5 ? -1 : 1), N = 1.7;
        in.slip_rate.set(lane, u), in.normal_load.set(lane, N), in.direction.set(lane, u < 0 ? -1 : 1);
        std::vector<double> z1(std::size_t(n + 1)), w1(z1), z2(z1), w2(z1), s1(8),
            s2(8);  // slopes of all states, unknown or not
        ours->steady(lane, u, N, z1.data(), w1.data());
        theirs->steady(lane, u, N, z2.data(), w2.data());
        ours->friction_slopes(lane, u, N, s1.data());
        theirs->friction_slopes(lane, u, N, s2.data());
        for (std::size_t i = 0; i < std::size_t(n); ++i) {
          CHECK(same(z1[i], z2[i], 1e-2));
          CHECK(same(w1[i], w2[i], 0));
          CHECK(same(s1[i], s2[i], 0));
          z2[i] += 0.1 * w2[i] * uniform(random);
          z[i].set(lane, z2[i]);
        }
        // The contact for one system: values and slopes.
        const ContactInput<double> one{u, N, 0.3, u < 0 ? -1.0 : 1.0};
        const auto a = everything(*text->with(values)->contact(setup), one, z2.data());
        const auto b = everything(*compiled->with(values)->contact(setup), one, z2.data());
        for (std::size_t k = 0; k < a.size(); ++k) {
          INFO("number " << k);
          CHECK(same(a[k], b[k], 1e-9 * std::abs(b[0]), 2e-11));
        }
        // Third derivatives along a direction, for one system.
        const Tower t = Tower::variable(Dual<Dual<double, 1>, 1>::variable(Dual<double, 1>::variable(0.0, 0), 0), 0);
        std::vector<Tower> zt, gt1(std::size_t(n + 1)), gt2(gt1);
        for (std::size_t i = 0; i < std::size_t(n + 1); ++i) zt.push_back(z2[i] + 0.7 * w2[i] * t);
        const ContactInput<Tower> moved{u + 0.3 * u * t, Tower(N), Tower(0.3), Tower(one.direction)};
        Tower F1, F2;
        text->with(values)->tower(setup)->evaluate(moved, zt.data(), gt1.data(), F1);
        compiled->with(values)->tower(setup)->evaluate(moved, zt.data(), gt2.data(), F2);
        gt1.back() = F1, gt2.back() = F2;
        for (std::size_t i = 0; i < gt1.size(); ++i) {
          const auto &x = gt1[i], &y = gt2[i];
          CHECK(same(x.value.value.value, y.value.value.value, 1e-9, 1e-11));
          CHECK(same(x.slope[0].value.value, y.slope[0].value.value, 1e-9, 1e-11));
          CHECK(same(x.slope[0].slope[0].value, y.slope[0].slope[0].value, 1e-9, 1e-11));
          CHECK(same(x.slope[0].slope[0].slope[0], y.slope[0].slope[0].slope[0], 1e-9, 1e-11));
        }
      }
      // Lanes: values and slopes; and the flow.
      Lanes F1, F2, F3;
      std::vector<Lanes> g2(g), g3(g);
      Slopes<Lanes> s1, s2;
      ours->evaluate(in, z.data(), g3.data(), F3);
      ours->linearise(in, z.data(), g.data(), F1, s1);
      theirs->linearise(in, z.data(), g2.data(), F2, s2);
      const auto lanes_equal = [&](const Lanes& a, const Lanes& b) {
        for (int lane = 0; lane < lane_count; ++lane) CHECK(same(a[lane], b[lane], 1e-9 * std::abs(F2[lane]), 2e-11));
      };
      lanes_equal(F1, F2), lanes_equal(F3, F2);
      lanes_equal(s1.F_u, s2.F_u), lanes_equal(s1.F_N, s2.F_N);
      for (int i = 0; i < n; ++i) {
        lanes_equal(g[std::size_t(i)], g2[std::size_t(i)]), lanes_equal(g3[std::size_t(i)], g2[std::size_t(i)]);
        lanes_equal(s1.g_u[i], s2.g_u[i]), lanes_equal(s1.F_z[i], s2.F_z[i]);
        for (int j = 0; j < n; ++j) lanes_equal(s1.g_z[i * n + j], s2.g_z[i * n + j]);
      }
      if (setup.unknowns == Unknowns::friction) {
        const auto values = varied(*compiled, random);
        const auto our_flow = text->with(values)->flow(), their_flow = compiled->with(values)->flow();
        std::vector<Pack> at, v_z(std::size_t(n), 0.0), g_z(std::size_t(n * n), 0.0), v_z2(v_z), g_z2(g_z), r(v_z),
            r2(v_z);
        for (const Lanes& unknown : z) at.push_back(unknown.pack[0]);
        Pack v1, v2;
        our_flow->slip(in.normal_load.pack[0], at.data(), v1, r.data(), v_z.data(), g_z.data());
        their_flow->slip(in.normal_load.pack[0], at.data(), v2, r2.data(), v_z2.data(), g_z2.data());
        const auto packs_equal = [&](const Pack& a, const Pack& b) {
          for (int lane = 0; lane < pack_width; ++lane) CHECK(same(a.block[lane], b.block[lane], 1e-9, 2e-11));
        };
        packs_equal(v1, v2);
        for (int i = 0; i < n - 1; ++i) packs_equal(r[std::size_t(i)], r2[std::size_t(i)]);
        for (int i = 0; i < n; ++i) packs_equal(v_z[std::size_t(i)], v_z2[std::size_t(i)]);
        for (int i = 0; i < n * (n - 1); ++i) packs_equal(g_z[std::size_t(i)], g_z2[std::size_t(i)]);
      }
      CHECK_THROWS_AS(
          ours->load(0, compiled->values(), {.lambda = setup.lambda == 0 ? 1.0 : 0.0, .unknowns = Unknowns::states}),
          InputError);
      if (setup.unknowns == Unknowns::friction) break;
    }
}

TEST_CASE("a law from text is refused where it is none, by the name of the part", "[laws][formula]") {
  CHECK(refusal(spinodal()) == "accepted");
  const auto changed = [](auto change) {
    auto law = spinodal();
    change(law);
    return refusal(law);
  };
  using Law = FormulaDescription;
  const struct {
    void (*change)(Law&);
    const char* message;
  } cases[] = {
      {[](Law& l) { l.friction = "v/v0 + L"; }, "law.formula.friction: 'v/v0' (dimensionless) and 'L' (m) cannot be"},
      {[](Law& l) { l.friction = "v"; }, "law.formula.friction: must be dimensionless, but is in m/s"},
      {[](Law& l) { l.rate = {"1 - psi"}; }, "law.formula.rate.psi: must be in 1/s, but is dimensionless"},
      {[](Law& l) { l.slip_rate = "mu"; }, "law.formula.slip_rate: must be in m/s, but is dimensionless"},
      {[](Law& l) { l.rate = {""}; }, "there is no rate of state 'psi'"},
      {[](Law& l) { l.steady = {"psi"}; }, "law.formula.steady.psi: has no formula of v and N, and "},
      {[](Law& l) { l.steady = {""}, l.rate = {"(2 - psi)/t_heal"}; },
       "law.formula.steady.psi: has no formula of v and N, and no value between 1e-300 and 1 is steady at v = 1.7e-12"},
      {[](Law& l) { l.steady = {""}, l.rate = {"(1 - psi)*(psi - 0.5)*(psi - 0.1)/t_heal"}; },
       "law.formula.steady.psi: has no formula of v and N, and 3 values are steady at v = 1.7e-12 m/s, N = 1 N: 0.1, "
       "0.5, 1; give one, or a minimum and maximum of the state that leave one"},
      {[](Law& l) { l.friction = "mu*v/v0"; }, "law.formula.friction: uses mu, which is known in slip_rate only"},
      {[](Law& l) { l.slip_rate = "v"; }, "law.formula.slip_rate: must not depend on the slip rate v"},
      {[](Law& l) { l.define.emplace_back("E", "1"); }, "law.formula.define.E: the name 'E' is already taken"},
      {[](Law& l) { l.define.emplace_back("v", "1"); }, "law.formula.define.v: the name 'v' is already taken"},
      {[](Law& l) { l.define.emplace_back("exp", "1"); }, "'exp' cannot be a name"},
      {[](Law& l) { l.define.emplace_back("1x", "1"); }, "'1x' cannot be a name"},
      {[](Law& l) { l.define.emplace_back("unused", "L + v"); }, "law.formula.define.unused: 'L' (m) and 'v' (m/s)"},
      {[](Law& l) { l.define[1].second = "E/E"; }, "law.formula.define.E: 'E' is defined by itself: E → psi_ref → E"},
      {[](Law& l) { l.define[0].second = "E"; }, "'E' is defined by itself: E → E"},
      {[](Law& l) { l.parameters[0].quantity.unit = "zork"; },
       "law.formula.parameters.mu0: 'zork' is not a known unit"},
      {[](Law& l) { l.parameters[3].quantity.unit = "um"; }, "its unit 'um' must be plain SI, that is m"},
      {[](Law& l) { l.static_limit = "mu0"; }, "law.formula.slip_rate: does not go with a static_limit"},
      {[](Law& l) { l.kink = "1 - v*theta/L"; }, "law.formula.kink: does not go with a state in logarithms"},
      {[](Law& l) { l.after_stop = {"1"}; }, "law.formula.after_stop: is of use beside a static_limit only"},
      {[](Law& l) { l.rest = {"psi/2"}; }, "law.formula.rest.psi: must not depend on the state 'psi'"},
      {[](Law& l) { l.size = {"N/(1 N)"}; }, "law.formula.size.psi: must not depend on the normal load N"},
      // what is wrong only when it is asked
      {[](Law& l) { l.friction = "mu0 + a*ln(v/v0)"; }, "law.formula.friction: the friction of law 'formula' is not"},
      {[](Law& l) { l.friction = "mu0 + 0*v/v0"; }, "law.formula.friction: must change sign with v"},
      {[](Law& l) { l.friction = "v/v0/(mu0 - mu0)"; }, "law.formula.friction: the friction of law 'formula' is not"},
      {[](Law& l) { l.steady = {"1/(2 + abs(v)*t_heal/L)"}; }, "law.formula.steady.psi: is not steady at v = "},
      {[](Law& l) { l.steady = {"2/(1 + abs(v)*t_heal/L)"}; }, "law.formula.steady.psi: is 1.99"},
      {[](Law& l) { l.slip_rate = "v0*sinh_exp(mu/a, E)"; }, "law.formula.slip_rate: does not invert friction"},
  };
  for (const auto& c : cases) {
    INFO(c.message);
    CHECK_THAT(changed(c.change), Catch::Contains(c.message));
  }
  auto law = stribeck();
  law.slip_rate = "v_s*mu";
  CHECK_THAT(refusal(law), Catch::Contains("law.formula.slip_rate: is of use to laws with states only"));
  law = stribeck();
  law.static_limit = "mu_d - 2*mu_s";
  CHECK_THAT(refusal(law), Catch::Contains("law.formula.static_limit: is -0.5, but must not be negative"));

  law = spinodal();  // definitions that double: 2^60 parts if each were expanded, 60 as a graph
  law.define.emplace_back("d0", "1");
  for (int i = 1; i < 40; ++i) law.define.emplace_back("d" + std::to_string(i), fmt::format("d{0}*d{0}*psi", i - 1));
  CHECK(refusal(law) == "accepted");
  for (int i = 40; i < 150; ++i) law.define.emplace_back("d" + std::to_string(i), fmt::format("d{0} + psi", i - 1));
  law.friction = "d149*v/v0";
  CHECK_THAT(refusal(law), Catch::Contains("nested more than 100 deep"));
  for (int i = 150; i < 250; ++i) law.define.emplace_back("d" + std::to_string(i), "1");
  CHECK_THAT(refusal(law), Catch::Contains("more than 200 names"));
}

TEST_CASE("a law from text refuses values and questions like any law", "[laws][formula]") {
  const auto law = make_formula(spinodal());
  CHECK_THROWS_WITH(law->with("a", 3.0), Catch::Contains("law.a = 3 is outside 0.0001 … 0.5 (direct effect"));
  CHECK_THROWS_WITH(law->with("aa", 3.0), Catch::Contains("did you mean 'a'?"));
  CHECK_THROWS_WITH(law->friction({1, 1}, {}), Catch::Contains("has 1 state(s), got 0"));
  CHECK_THROWS_WITH(law->static_limit(1), Catch::Contains("no static limit"));
  const auto curve = make_formula(stribeck());
  CHECK_THROWS_WITH(curve->slip_rate(0.3, 1, {}), Catch::Contains("no explicit slip rate"));
  CHECK_THROWS_WITH(curve->contact({.unknowns = Unknowns::friction}), Catch::Contains("cannot carry μ as unknown"));
  CHECK(&law->card() == &law->with("a", 0.03)->card());  // by which lanes know that laws are one
  CHECK(&law->card() != &curve->card());
}
