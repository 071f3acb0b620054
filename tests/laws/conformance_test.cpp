/// What every friction law must satisfy, proved for each law of the catalogue; a new law is covered by standing there.
#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "core/tower.hpp"
#include "core/units.hpp"
#include "laws/adapter.hpp"
#include "laws/catalogue.hpp"
#include "laws/heating.hpp"
#include "laws/shipped.hpp"
#include "laws/smoothing.hpp"
#include "tests/laws/long_double.hpp"

using namespace rosin;

namespace {

using State = std::vector<double>;

const double speeds[] = {2.3e-13, 7.1e-9, 4.1e-6, 7e-4, 0.021, 0.6};  // not near a knot of the tabulated law
const double load = 1.7;

/// States of steady sliding at other speeds: far from, near and at the steady state of a test speed.
std::vector<State> states_of(const FrictionLaw& law) {
  if (!law.has_states()) return {State()};
  std::vector<State> list;
  for (const double v : {1e-11, 4.1e-6, 3e-2}) list.push_back(law.steady({v, load}));
  return list;
}

/// State or rate of the mirrored motion.
State mirrored(const FrictionLaw& law, State state) {
  for (std::size_t i = 0; i < state.size(); ++i)
    if (law.states()[i].parity == Parity::odd) state[i] = -state[i];
  return state;
}

/// |a − b| ≤ tolerance·scale; false for NaN.
bool near(double a, double b, double tolerance, double scale) { return std::abs(a - b) <= tolerance * scale; }

/// df/dx by central differences with steps h, h/2, h/4, extrapolated: error of order h⁶.
template <class F>
double difference(F f, double x, double h) {
  const auto central = [&](double step) { return (f(x + step) - f(x - step)) / (2 * step); };
  const double d1 = central(h), d2 = central(h / 2), d4 = central(h / 4);
  const double e1 = d2 + (d2 - d1) / 3, e2 = d4 + (d4 - d2) / 3;
  return e2 + (e2 - e1) / 15;
}

/// The forms of contact that a law has.
std::vector<ContactSetup> setups_of(const FrictionLaw& law) {
  std::vector<ContactSetup> list{{.lambda = 1.5, .unknowns = Unknowns::states},
                                 {.lambda = 0, .unknowns = Unknowns::states}};
  if (law.has_slip_rate()) {
    list.push_back({.lambda = 1.5, .compliance = 1e-6, .unknowns = Unknowns::friction});
    list.push_back({.lambda = 0, .compliance_per_load = 1e-6, .unknowns = Unknowns::friction});
  }
  if (!law.set_valued()) {  // wrapped: behind a damped spring
    const auto unknowns = law.has_slip_rate() ? Unknowns::friction : Unknowns::states;
    list.push_back({.lambda = 1.5, .unknowns = unknowns, .spring = {.compliance = 1e-6, .damping = 1e4}});
    list.push_back(
        {.lambda = 0, .unknowns = unknowns, .spring = {.compliance_per_load = 1e-6, .damping_per_load = 1e3}});
  }
  return list;
}

/// A point (u, N, z) beside steady sliding, and the size of each coordinate's natural step.
struct Point {
  ContactInput<double> in;
  std::vector<double> z, weight;
};
Point point_near_steady(const Contact<double>& contact, double u, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Point p{{u, load, 0.3, u < 0 ? -1.0 : 1.0}, {}, {}};
  p.z.resize(contact.unknowns() + 1), p.weight.resize(contact.unknowns() + 1);
  contact.steady(0, u, load, p.z.data(), p.weight.data());
  p.z.resize(contact.unknowns()), p.weight.resize(contact.unknowns());
  for (std::size_t i = 0; i < p.z.size(); ++i) {
    p.weight[i] *= 0.1;
    p.z[i] += p.weight[i] * uniform(random);
  }
  return p;
}

/// (g, F) at the point moved by `by` in direction number k of (z, u, N).
std::vector<double> answer(const Contact<double>& contact, Point p, std::size_t k, double by) {
  const std::size_t n = p.z.size();
  (k < n ? p.z[k] : k == n ? p.in.slip_rate : p.in.normal_load) += by;
  std::vector<double> g(n + 1);
  double F = 0;
  contact.evaluate(p.in, p.z.data(), g.data(), F);
  g[n] = F;
  return g;
}

double slope_of(const Slopes<double>& s, std::size_t n, std::size_t row, std::size_t k) {
  if (row == n) return k < n ? s.F_z[k] : k == n ? s.F_u : s.F_N;
  return k < n ? s.g_z[row * n + k] : k == n ? s.g_u[row] : s.g_N[row];
}

/// Other values of the same parameters, within their ranges.
std::vector<Value> varied(const FrictionLaw& law, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.9, 1.1);
  auto values = law.values();
  for (std::size_t i = 0; i < values.size(); ++i)
    if (double* x = std::get_if<double>(&values[i])) *x = *x == 0 ? 0.1 * uniform(random) : *x * uniform(random);
  return values;
}

std::string refusal(const FrictionLaw& law, const std::string& parameter, Value value) {
  try {
    law.with(parameter, std::move(value));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

namespace {
struct Subject {
  std::shared_ptr<const FrictionLaw> law;
  std::string surroundings;  ///< empty: the law alone
};
/// The laws of the catalogue, all that may be heated once more with heat, and all that are set-valued smoothed.
std::vector<Subject> subjects() {
  std::vector<Subject> list;
  for (const auto& law : laws::catalogue()) list.push_back({law, ""});
  for (const auto& law : laws::catalogue())
    if (!law->deflects()) list.push_back({laws::heated(law, {30, 0.2, 5}), ", heated,"});
  for (const char* name : {"coulomb", "spinodal", "two-state-ageing", "static-growth"})  // of each form of contact one
    list.push_back({laws::heated(laws::find_law(name), {30, 0.2, 5, laws::disc}), ", heated as a disc,"});
  const auto names = laws::smoothing_names();
  std::size_t next = 0;
  for (const auto& law : laws::catalogue()) {
    if (!law->set_valued()) continue;
    const auto type = next++ % names.size();
    list.push_back(
        {laws::smoothed(law, {laws::Smoothing::Type(type), 2e-3}), fmt::format(", smooth by {},", names[type])});
  }
  list.push_back({laws::heated(list.back().law, {30, 0.2, 5}), ", smooth and heated,"});
  return list;
}
}  // namespace

TEST_CASE("every law of the catalogue keeps the promises of a friction law", "[laws]") {
  std::set<std::string_view> names;
  for (const auto& [shared, surroundings] : subjects()) {
    const FrictionLaw& law = *shared;
    const std::string label = std::string(law.card().name) + surroundings;
    const bool alone = surroundings.empty();
    if (alone) CHECK(names.insert(law.card().name).second);

    DYNAMIC_SECTION(label << " says what it is") {
      const Card& card = law.card();
      CHECK(card.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos);
      for (const auto text : {card.title, card.formula, card.source, card.limits}) CHECK(text.size() > 5);
      CHECK((card.source.find("(1") != std::string_view::npos ||
             card.source.find("(2") != std::string_view::npos));  // a year
      auto quantities = law.parameters();
      quantities.insert(quantities.end(), law.states().begin(), law.states().end());
      std::set<std::string> own;
      for (const auto& q : quantities) {
        INFO(q.name);
        CHECK(own.insert(q.name).second);
        CHECK(unit_known(q.unit));
        CHECK(q.meaning.size() > 5);
        CHECK(q.range.low < q.range.high);
        if (q.scale == Scale::log) CHECK(q.range.low > 0);
      }
      REQUIRE(law.values().size() == law.parameters().size());
    }

    DYNAMIC_SECTION(label << " accepts its defaults and presets and refuses what lies outside") {
      CHECK_NOTHROW(law.with(law.values()));
      if (!alone) continue;  // presets are the law's own
      CHECK(laws::find_law(law.card().name) == shared);
      for (const auto& p : law.presets()) {
        const auto published = laws::preset(law, p.name);
        CHECK(p.source.size() > 5);
        CHECK(published->values() == p.values);
        CHECK(published->steady_friction({1e-3, load}).friction > 0);
      }
      for (const auto& q : law.parameters()) {
        INFO(q.name);
        const auto wrong = [&](double x) { return q.is_list ? Value(State{0.1, x}) : Value(x); };
        const double above = 3 * q.range.high + 1;
        const auto message = refusal(law, q.name, wrong(above));
        for (const auto& part :
             {"law." + q.name, fmt::format("= {} ", above), fmt::format("{} … {}", q.range.low, q.range.high)})
          CHECK_THAT(message, Catch::Contains(part));
        CHECK_THAT(refusal(law, q.name, wrong(q.range.low - 1)), Catch::Contains("is outside"));
        CHECK_THAT(refusal(law, q.name, wrong(NAN)), Catch::Contains("law." + q.name) && Catch::Contains("NaN"));
        CHECK_THAT(refusal(law, q.name, q.is_list ? Value(1.0) : Value(State{1.0})), Catch::Contains("must be a"));
        CHECK_THAT(refusal(law, q.name + "x", wrong(0)), Catch::Contains("did you mean"));
      }
    }

    DYNAMIC_SECTION(label << " is odd in the slip rate and dissipates") {
      for (const double v : speeds)
        for (const State& state : states_of(law)) {
          CAPTURE(v, state);
          const double mu = law.friction({v, load}, state);
          if (!law.deflects()) CHECK(mu >= 0);
          CHECK(law.friction({-v, load}, mirrored(law, state)) == -mu);
          CHECK(law.rate({-v, load}, mirrored(law, state)) == mirrored(law, law.rate({v, load}, state)));
          CHECK(law.steady_friction({v, load}).friction >= 0);
          CHECK(law.steady({-v, load}) == mirrored(law, law.steady({v, load})));
        }
      const State rest = law.rest(load);
      CHECK(rest.size() == law.states().size());
      CHECK(law.friction({0, load}, rest) == 0);
      if (!law.deflects())
        for (const State& state : states_of(law)) CHECK(law.friction({0, load}, state) == 0);
      if (law.set_valued()) {
        // Slip begins at no more than what held.
        for (const State& state : {rest, law.after_stop(rest)})
          for (const double v : {1e-14, 1e-12})
            CHECK(law.static_limit(load, state) >= law.friction({v, load}, state) * (1 - 1e-9));
      } else {
        CHECK_THROWS_AS(law.static_limit(load, rest), InputError);
        for (const State& state : states_of(law)) CHECK(law.after_stop(state) == state);
      }
    }

    DYNAMIC_SECTION(label << " rests at its steady state, which the contact starts from") {
      for (const double v : speeds) {
        CAPTURE(v);
        const State steady = law.steady({v, load}), rate = law.rate({v, load}, steady);
        State doubled = steady;
        for (double& x : doubled) x *= 2;
        const State away = law.rate({v, load}, doubled);
        for (std::size_t i = 0; i < rate.size(); ++i) CHECK(near(rate[i], 0, 1e-13, std::abs(away[i])));

        const auto curve = law.steady_friction({v, load});
        CHECK(near(curve.friction, law.friction({v, load}, steady), 1e-14, curve.friction));
        const auto on_curve = [&](double x) { return law.steady_friction({x, load}).friction; };
        CHECK(near(curve.slope, difference(on_curve, v, 0.01 * v), 1e-10, std::abs(curve.slope) + curve.friction / v));
        CHECK(law.steady_friction({-v, load}).friction == -curve.friction);
        CHECK(law.steady_friction({-v, load}).slope == curve.slope);

        for (const auto& setup : setups_of(law)) {
          const auto contact = law.contact(setup);
          const int n = contact->unknowns();
          std::vector<double> z(n + 1), weight(n + 1), g(n + 1), mass(n + 1);
          double F;
          Slopes<double> slopes;
          contact->steady(0, v, load, z.data(), weight.data());
          contact->linearise({v, load, 0, 1}, z.data(), g.data(), F, slopes);
          CHECK(near(F, load * curve.friction, 1e-13, F));
          for (int i = 0; i < n; ++i) {
            CHECK(weight[i] > 0);
            CHECK(near(g[i], 0, 1e-12, std::abs(slopes.g_z[i * n + i]) * weight[i]));
          }
          contact->mass(load, mass.data());
          const bool with_friction = setup.unknowns == Unknowns::friction;
          const bool behind_spring = setup.spring.present();
          const int states = n - (with_friction ? 1 : 0) - (behind_spring ? (with_friction ? 1 : 2) : 0);
          if (with_friction && !behind_spring) {
            // Balance of the series spring, d(Nμ)/dt = k_t (u − v): at v = u, μ̇ makes up for the load rate.
            CHECK(mass[0] == load * setup.compliance + setup.compliance_per_load);
            contact->evaluate({v, load, 2 * v, 1}, z.data(), g.data(), F);
            const double expected = -setup.compliance * curve.friction * 2 * v;
            CHECK(near(g[0], expected, 1e-12, v));
          }
          for (int i = 0; i < states; ++i) CHECK(mass[with_friction + i] == setup.lambda);
          if (behind_spring) {
            CHECK(mass[n - 1] == 1);                       // ė = u − v
            CHECK(mass[with_friction ? 0 : states] == 0);  // balance of forces
          }
          // λ = 0 without μ as unknown: the friction curve itself, in both directions.
          if (!with_friction && !behind_spring && setup.lambda == 0) {
            CHECK(n == 0);
            contact->evaluate({-v, load, 0, -1}, nullptr, nullptr, F);
            CHECK(near(F, -load * curve.friction, 1e-14, load * curve.friction));
          }
        }
      }
    }

    DYNAMIC_SECTION(label << " inverts friction where it offers a slip rate") {
      if (!law.has_slip_rate()) CHECK_THROWS_AS(law.slip_rate(0.1, load, {}), InputError);
      if (law.has_slip_rate())
        for (const State& state : states_of(law)) {
          CHECK(law.slip_rate(0, load, state) == 0);
          for (double v = 1e-30; v < 100; v *= 31.7)
            for (const double slip : {v, -v}) {
              CAPTURE(slip, state);
              CHECK(near(law.slip_rate(law.friction({slip, load}, state), load, state), slip, 1e-12, v));
            }
        }
    }

    DYNAMIC_SECTION(label << " has the derivatives that differences give, to third order") {
      std::mt19937 random(7);
      for (const auto& setup : setups_of(law)) {
        const auto contact = law.contact(setup);
        const auto tower = law.tower(setup);
        for (const double v : speeds)
          for (const double u : {v, -v}) {
            const Point p = point_near_steady(*contact, u, random);
            const std::size_t n = p.z.size();
            std::vector<double> g(n + 1), step(p.weight);
            for (double& x : step) x *= 0.3;  // rates may go as a high power of the slip rate
            step.insert(step.end(), {0.01 * v, 0.01 * load});
            const auto slopes_at = [&](double s) {
              Point q = p;
              for (std::size_t i = 0; i < n; ++i) q.z[i] += s * step[i];
              q.in.slip_rate += s * step[n], q.in.normal_load += s * step[n + 1];
              Slopes<double> slopes;
              double F;
              contact->linearise(q.in, q.z.data(), g.data(), F, slopes);
              g[n] = F;
              return slopes;
            };
            const auto slopes = slopes_at(0);
            const auto linearised = g;
            const auto evaluated = answer(*contact, p, 0, 0);

            std::vector<Tower> tower_z(n + 1), tower_g(n + 1);
            for (std::size_t i = 0; i < n; ++i) tower_z[i] = along(p.z[i], step[i]);
            tower->evaluate({along(u, step[n]), along(load, step[n + 1]), p.in.load_rate, p.in.direction},
                            tower_z.data(), tower_g.data(), tower_g[n]);

            for (std::size_t row = 0; row <= n; ++row) {
              // Terms of a row may cancel; errors are measured by their size.
              double size = std::abs(evaluated[row]);
              for (std::size_t k = 0; k < n + 2; ++k)
                size = std::max(size, std::abs(slope_of(slopes, n, row, k)) * step[k]);
              CAPTURE(setup.lambda, int(setup.unknowns), u, row, size);
              CHECK(near(linearised[row], evaluated[row], 1e-14, size));
              for (std::size_t k = 0; k < n + 2; ++k) {
                CAPTURE(k);
                const auto f = [&](double by) { return answer(*contact, p, k, by)[row]; };
                const double h = 0.1 * step[k];
                CHECK(near(slope_of(slopes, n, row, k), difference(f, 0, h), 1e-8, size / step[k]));
              }
              const auto first = [&](double s) {
                const auto here = slopes_at(s);
                double sum = 0;
                for (std::size_t k = 0; k < n + 2; ++k) sum += slope_of(here, n, row, k) * step[k];
                return sum;
              };
              const auto second = [&](double s) { return difference(first, s, 0.04); };
              CHECK(near(tower_g[row].value.value.value, evaluated[row], 1e-14, size));
              CHECK(near(tower_g[row].slope[0].value.value, first(0), 1e-12, size));
              CHECK(near(tower_g[row].slope[0].slope[0].value, second(0), 1e-10, size));
              CHECK(near(tower_g[row].slope[0].slope[0].slope[0], difference(second, 0, 0.04), 1e-9, size));
            }
          }
      }
    }

    DYNAMIC_SECTION(label << " flows at the rates of its contact, with their slopes") {
      if (!law.has_slip_rate() || law.set_valued()) continue;
      std::mt19937 random(13);
      const auto flow = law.flow();
      const auto contact = law.contact({.unknowns = Unknowns::friction});
      const int n = flow->unknowns();
      REQUIRE(n == contact->unknowns());
      const auto size = std::size_t(n);
      for (const double v : speeds) {
        const Point p = point_near_steady(*contact, v, random);
        const auto flown = [&](const std::vector<double>& z) {  // v, then the rates
          std::vector<Pack> at(z.begin(), z.end()), g(size), v_z(size), g_z(size * size);
          Pack slip;
          flow->slip(load, at.data(), slip, g.data(), v_z.data(), g_z.data());
          std::vector<double> answer{slip.block[0]};
          for (std::size_t i = 0; i + 1 < size; ++i) answer.push_back(g[i].block[0]);
          return answer;
        };
        std::vector<Pack> at(p.z.begin(), p.z.end()), g(size), v_z(size), g_z(size * size);
        Pack slip;
        flow->slip(load, at.data(), slip, g.data(), v_z.data(), g_z.data());
        const auto here = flown(p.z);
        std::vector<double> of_contact(size + 1);
        double F;
        contact->evaluate({v, load, 0, 1}, p.z.data(), of_contact.data(), F);
        of_contact[0] = v - of_contact[0];
        for (std::size_t row = 0; row < size; ++row) {
          double terms = std::abs(here[row]);  // a row may cancel
          const auto slope = [&](std::size_t k) { return (row == 0 ? v_z[k] : g_z[(row - 1) * size + k]).block[0]; };
          for (std::size_t k = 0; k < size; ++k) terms = std::max(terms, std::abs(slope(k)) * p.weight[k]);
          CAPTURE(v, row, terms);
          CHECK(near(here[row], of_contact[row], 1e-11, terms));
          for (std::size_t k = 0; k < size; ++k) {
            const auto moved = [&](double by) {
              auto z = p.z;
              z[k] += by;
              return flown(z)[row];
            };
            CAPTURE(k);
            CHECK(near(slope(k), difference(moved, 0, 0.03 * p.weight[k]), 1e-8, terms / p.weight[k]));
          }
        }
      }
    }

    DYNAMIC_SECTION(label << " answers for 32 different lanes as for each alone") {
      std::mt19937 random(11);
      std::uniform_real_distribution<double> uniform(-1, 1);
      for (auto setup : setups_of(law)) {
        const auto lanes = law.lanes(setup);
        const int n = lanes->unknowns();
        REQUIRE(n == law.contact(setup)->unknowns());
        for (const double direction : {1.0, -1.0}) {
          std::vector<Point> points;
          std::vector<std::unique_ptr<Contact<double>>> alone;
          ContactInput<Lanes> in{0.0, 0.0, 0.0, direction};
          std::vector<Lanes> z(n + 1), g(n + 1), mass(n + 1);
          Lanes F;
          for (int lane = 0; lane < lane_count; ++lane) {
            const auto values = varied(law, random);
            if (setup.lambda > 0) setup.lambda = 1 + 0.5 * uniform(random);
            if (setup.compliance > 0) setup.compliance = 1e-6 * (2 + uniform(random));
            if (setup.spring.damping > 0) setup.spring.damping = 1e4 * (2 + uniform(random));
            alone.push_back(law.contact(setup));
            alone.back()->load(0, values, setup);
            lanes->load(lane, values, setup);
            points.push_back(point_near_steady(*alone.back(), direction * speeds[lane % std::size(speeds)], random));
            const Point& p = points.back();
            in.slip_rate.set(lane, p.in.slip_rate);
            in.normal_load.set(lane, p.in.normal_load);
            in.load_rate.set(lane, p.in.load_rate);
            for (int i = 0; i < n; ++i) z[i].set(lane, p.z[i]);
          }
          Slopes<Lanes> slopes;
          lanes->evaluate(in, z.data(), g.data(), F);
          const auto evaluated = g;
          const Lanes evaluated_F = F;
          lanes->linearise(in, z.data(), g.data(), F, slopes);
          lanes->mass(in.normal_load, mass.data());
          for (int lane = 0; lane < lane_count; ++lane) {
            const Point& p = points[lane];
            CAPTURE(setup.lambda, int(setup.unknowns), p.in.slip_rate, lane);
            std::vector<double> one_g(n + 1), one_mass(n + 1);
            double one_F;
            Slopes<double> one;
            alone[lane]->linearise(p.in, p.z.data(), one_g.data(), one_F, one);
            alone[lane]->mass(p.in.normal_load, one_mass.data());
            CHECK(near(F[lane], one_F, 1e-13, std::abs(one_F)));
            CHECK(evaluated_F[lane] == F[lane]);
            CHECK(near(slopes.F_u[lane], one.F_u, 1e-13, std::abs(one.F_u)));
            CHECK(near(slopes.F_N[lane], one.F_N, 1e-13, std::abs(one.F_N)));
            for (int i = 0; i < n; ++i) {
              // g is a difference of terms as large as g_z·weight: these carry the rounding.
              const double size = std::max(std::abs(one_g[i]), std::abs(one.g_z[i * n + i] * 10 * p.weight[i]));
              CHECK(mass[i][lane] == one_mass[i]);
              CHECK(near(g[i][lane], one_g[i], 3e-13, size));
              CHECK(near(evaluated[i][lane], g[i][lane], 1e-14, size));
              CHECK(near(slopes.g_u[i][lane], one.g_u[i], 1e-13, std::abs(one.g_u[i])));
              CHECK(near(slopes.g_N[i][lane], one.g_N[i], 1e-13, std::abs(one.g_N[i])));
              CHECK(near(slopes.F_z[i][lane], one.F_z[i], 1e-13, std::abs(one.F_z[i])));
              for (int j = 0; j < n; ++j)
                CHECK(near(slopes.g_z[i * n + j][lane], one.g_z[i * n + j], 3e-13, size / p.weight[j]));
            }
          }
        }
      }
    }
  }
}

// The same formulas in 80-bit arithmetic share neither the rounding nor the dual numbers of the library.
namespace {

using oracle::Long;

/// A law's answers in scalar type T: friction, rates and (at that friction) the slip rate.
template <template <class> class L, class T>
std::vector<T> answers(const std::vector<Value>& values, const T& v, const std::vector<T>& state_values) {
  const auto law = laws::detail::build<L<T>>(values);
  const Sliding<T> at{v, T(load)};
  if constexpr (laws::HasStates<L>) {
    typename L<T>::State state;
    laws::detail::for_each_field(L<T>::states,
                                 [&](const auto& f, std::size_t i) { state.*(f.member) = state_values[i]; });
    std::vector<T> list{law.friction(at, state)};
    const auto rate = law.rate(at, state);
    laws::detail::for_each_field(L<T>::states, [&](const auto& f, std::size_t) { list.push_back(rate.*(f.member)); });
    if constexpr (laws::HasSlipRate<L>) list.push_back(law.slip_rate(list[0], at, state));
    return list;
  } else {
    return {law.friction(at)};
  }
}

template <template <class> class L>
void agrees_with_long_double() {
  const auto shared = laws::find_law(L<double>::card.name);
  const auto& values = shared->values();
  for (double v = 1e-34; v < 1; v *= 17)  // from deep in the linear part of asinh
    for (const State& state : states_of(*shared)) {
      INFO(L<double>::card.name);
      CAPTURE(v, state);
      constexpr std::size_t n = laws::detail::count_states<L>();
      using Slope = Dual<double, n + 1>;
      std::vector<Slope> state_slopes;
      for (std::size_t i = 0; i < n; ++i) state_slopes.push_back(Slope::variable(state[i], int(i)));
      const auto in_double = answers<L, Slope>(values, Slope::variable(v, n), state_slopes);

      const std::vector<Long> state_long(state.begin(), state.end());
      const auto in_long = answers<L, Long>(values, Long(v), state_long);
      const auto slope_long = [&](std::size_t k, std::size_t row) {
        const auto moved = [&](Long h) {
          auto s = state_long;
          Long speed(v);
          (k == n ? speed : s[k]) = (k == n ? speed : s[k]) * (1.0 + h);
          return answers<L, Long>(values, speed, s)[row];
        };
        const Long h(1e-5), near = (moved(h) - moved(-h)) / (2.0 * h),
                            wide = (moved(2.0 * h) - moved(-2.0 * h)) / (4.0 * h);
        return double((4.0 * near - wide) / 3.0);  // derivative by ln x, error of order h⁴
      };
      for (std::size_t row = 0; row < in_long.size(); ++row) {
        CAPTURE(row);
        double size = std::abs(double(in_long[row]));
        if (row == 0 || row == n + 1) CHECK(near(in_double[row].value, double(in_long[row]), 3e-14, size));
        for (std::size_t k = 0; k <= n; ++k) {
          const double x = k == n ? v : state[k], exact = slope_long(k, row);
          size = std::max(size, std::abs(exact));
          CHECK(near(in_double[row].slope[k] * x, exact, 1e-12, size));
        }
        CHECK(near(in_double[row].value, double(in_long[row]), 3e-14, size));
      }
    }
}

template <template <class> class... L>
void all_agree(laws::LawList<L...>) {
  (agrees_with_long_double<L>(), ...);
}

}  // namespace

TEST_CASE("every law agrees in value and derivative with 80-bit arithmetic", "[laws]") { all_agree(laws::Shipped{}); }
