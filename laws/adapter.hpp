/// The adapter Law<L>: from one written law to values, derivatives, SIMD lanes, contacts and descriptions.
///
/// Include this only where a law is turned into a FrictionLaw: in the law's own .cpp, or in a user's program
/// (`make_law<MyLaw>()`). Nothing beyond laws/ is templated on a law.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/tower.hpp"
#include "laws/catalogue.hpp"
#include "laws/law.hpp"
#include "laws/portion.hpp"

namespace rosin::laws {

template <template <class> class L>
concept HasStates = requires {
  L<double>::states;
};
template <template <class> class L>
concept HasPresets = requires {
  L<double>::presets();
};
template <template <class> class L>
concept HasSlipRate = requires(const L<double> law, Sliding<double> at) {
  law.slip_rate(0.0, at, {});
};
template <template <class> class L>
concept HasRest = requires(const L<double> law, Sliding<double> at) {
  law.rest(at);
};
template <template <class> class L>
concept HasSize = requires(const L<double> law) {
  law.size();
};
template <template <class> class L>
concept LimitHasStates = requires(const L<double> law, Sliding<double> at) {
  law.static_limit(at, {});
};
template <template <class> class L>
concept SetValued = LimitHasStates<L> || requires(const L<double> law, Sliding<double> at) {
  law.static_limit(at);
};
template <template <class> class L>
concept HasStopReset = requires(const L<double> law) {
  law.after_stop({});
};
template <template <class> class L>
concept HasKink = requires(const L<double> law) {
  law.kink({});
};

namespace detail {

template <class L>
inline constexpr std::size_t parameter_count = std::tuple_size_v<decltype(L::parameters)>;

template <template <class> class L>
constexpr int count_states() {
  if constexpr (HasStates<L>)
    return int(std::tuple_size_v<decltype(L<double>::states)>);
  else
    return 0;
}

/// Applies f(field, index) to each field of a table.
template <class Table, class F>
void for_each_field(const Table& fields, F f) {
  [&]<std::size_t... i>(std::index_sequence<i...>) { (f(std::get<i>(fields), i), ...); }
  (std::make_index_sequence<std::tuple_size_v<Table>>());
}

template <class Member>
Member convert(const Value& value) {
  if constexpr (std::is_same_v<Member, std::vector<double>>)
    return std::get<std::vector<double>>(value);
  else
    return Member(std::get<double>(value));
}

/// The law whose parameters are member(field, index): members that derive from them follow.
template <class L, class Member>
L assemble(const Member& member) {
  return [&]<std::size_t... i>(std::index_sequence<i...>) { return L{member(std::get<i>(L::parameters), i)...}; }
  (std::make_index_sequence<parameter_count<L>>());
}

template <class L>
L build(std::span<const Value> values) {
  return assemble<L>([&]<class Member>(const Field<L, Member>&, std::size_t i) { return convert<Member>(values[i]); });
}
/// The same with slopes of its numbers in the second direction of towers; empty: none.
template <class L>
L build(std::span<const Value> values, std::span<const double> slopes) {
  return assemble<L>([&]<class Member>(const Field<L, Member>&, std::size_t i) {
    auto x = convert<Member>(values[i]);
    if constexpr (std::is_same_v<Member, Tower>)
      if (!slopes.empty()) x = across(x.value.value.value, 0, slopes[i]);
    return x;
  });
}

template <class L>
std::vector<Value> values_of(const L& law) {
  std::vector<Value> values;
  for_each_field(L::parameters, [&](const auto& f, std::size_t) { values.emplace_back(law.*(f.member)); });
  return values;
}

template <class Table>
std::vector<Quantity> describe(const Table& fields) {
  std::vector<Quantity> list;
  for_each_field(fields, [&]<class Owner, class Member>(const Field<Owner, Member>& f, std::size_t) {
    list.push_back({std::string(f.name), std::string(f.unit), f.range, std::string(f.meaning), f.scale,
                    std::is_same_v<Member, std::vector<double>>, f.parity});
  });
  return list;
}

/// Sets the parameters of one lane and rebuilds the law, so that derived members follow. Lists are shared by all lanes.
template <class L>
void assign(L& law, std::span<const Value> parameters, int lane) {
  law = assemble<L>([&](const auto& f, std::size_t k) {
    auto x = law.*(f.member);
    if constexpr (std::is_same_v<decltype(x), std::vector<double>>)
      x = std::get<std::vector<double>>(parameters[k]);
    else
      set_lane(x, lane, std::get<double>(parameters[k]));
    return x;
  });
}

/// \throws InputError if a list in `parameters` differs from the law's.
template <class L>
void require_same_lists(const L& law, std::span<const Value> parameters) {
  for_each_field(L::parameters, [&](const auto& f, std::size_t k) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(law.*(f.member))>, std::vector<double>>)
      if (law.*(f.member) != std::get<std::vector<double>>(parameters[k]))
        throw InputError(fmt::format("law.{} differs between the lanes of one batch: they must share lists", f.name));
  });
}

/// A law L<T> as contacts ask it: states as lists, in the order of its table.
///
/// Contacts know laws only by this interface, so that a law whose states are counted at run time (laws/formula.hpp)
/// shares their rows, starts and weights.
template <template <class> class L, class T>
struct Written {
  static constexpr int states = count_states<L>();
  static constexpr int capacity = std::max(states, 1);  ///< length of a list of states
  static constexpr bool set_valued = SetValued<L>;
  using Number = WithLog<T>;  ///< in lists of states
  const L<T>& law;

  ROSIN_INLINE static Number from_log(const T& logarithm) { return Number::from_log(logarithm); }
  static constexpr bool logarithmic(int state) {
    bool is = false;
    if constexpr (states > 0)
      for_each_field(L<T>::states,
                     [&](const auto& f, std::size_t k) { is |= int(k) == state && f.scale == Scale::log; });
    return is;
  }
  ROSIN_INLINE T friction(const Sliding<T>& at, const Number* state) const {
    if constexpr (states == 0)
      return law.friction(at);
    else
      return law.friction(at, packed(state));
  }
  ROSIN_INLINE void rate(const Sliding<T>& at, const Number* state, T* rate) const {
    if constexpr (states > 0) unpack(law.rate(at, packed(state)), rate);
  }
  ROSIN_INLINE void steady(const Sliding<T>& at, Number* state) const {
    if constexpr (states > 0) unpack(law.steady(at), state);
  }
  /// Of a law whose friction answers to the rates of its states, and which says what it is without them.
  ROSIN_INLINE T steady_friction(const Sliding<T>& at) const requires requires(const L<T>& law) {
    law.steady_friction(at);
  }
  { return law.steady_friction(at); }
  /// The greatest size that a change of each linear state is measured by: its own in steady sliding, unless the law
  /// states one.
  ROSIN_INLINE void sizes(const Number* steady, T* sizes) const {
    if constexpr (HasSize<L>)
      unpack(law.size(), sizes);
    else
      for (int k = 0; k < states; ++k) sizes[k] = abs(steady[k]);
  }
  /// Never asked of a law without: its contacts are refused the friction unknown.
  ROSIN_INLINE T slip_rate(const T& mu, const T& N, const Number* state) const {
    if constexpr (HasSlipRate<L>)
      return law.slip_rate(mu, Sliding<T>{T(0.0), N}, packed(state));
    else
      return T(0.0);
  }

  /// ∂v/∂μ at fixed state.
  T slip_rate_slope(const T& mu, const T& N, const Number* state) const {
    if constexpr (HasSlipRate<L>) {
      using Slope = Dual<T, 1>;
      WithLog<Slope> fixed[capacity];
      for (int k = 0; k < states; ++k) fixed[k] = Slope(state[k]);
      const auto dual = build<L<Slope>>(values_of(law));
      return Written<L, Slope>{dual}.slip_rate(Slope::variable(mu, 0), Slope(N), fixed).slope[0];
    } else {
      return infinity;
    }
  }
  /// ∂μ/∂ψ of each state.
  void friction_slopes(const Sliding<T>& at, const Number* state, T* slopes) const {
    if constexpr (states > 0) {
      using Slope = Dual<T, states>;
      WithLog<Slope> varied[capacity];
      for (int k = 0; k < states; ++k) varied[k] = Slope::variable(state[k], k);
      const auto dual = build<L<Slope>>(values_of(law));
      const Slope mu = Written<L, Slope>{dual}.friction({Slope(at.slip_rate), Slope(at.normal_load)}, varied);
      std::copy(mu.slope, mu.slope + states, slopes);
    }
  }

 private:
  ROSIN_INLINE static auto packed(const Number* list) {
    typename L<T>::State state;
    for_each_field(
        L<T>::states, [&](const auto& f, std::size_t k)
                          __attribute__((always_inline)) { state.*(f.member) = list[k]; });
    return state;
  }
  ROSIN_INLINE static void unpack(const auto& state, auto* list) {
    for_each_field(
        L<T>::states, [&](const auto& f, std::size_t k)
                          __attribute__((always_inline)) { list[k] = state.*(f.member); });
  }
};

/// Friction at the states of steady sliding, as rows that carry these have it, to the last digit; of set-valued laws at
/// a slip rate that is not negative.
template <class Law, class T>
ROSIN_INLINE T friction_at_steady_states(const Law& law, const Sliding<T>& at) {
  typename Law::Number state[Law::capacity];
  law.steady(at, state);
  return law.friction(at, state);
}
/// μ_ss of steady sliding; of set-valued laws at a slip rate that is not negative.
template <class Law, class T>
ROSIN_INLINE T steady_of(const Law& law, const Sliding<T>& at) {
  if constexpr (requires { law.steady_friction(at); })
    return law.steady_friction(at);
  else
    return friction_at_steady_states(law, at);
}

/// μ_ss at any slip rate; odd in it for set-valued laws too. `equilibrium`: as rows without states have it.
template <class Law, class T>
ROSIN_INLINE T steady_coefficient(const Law& law, const Sliding<T>& at, bool equilibrium = true) {
  const auto along = [&](const Sliding<T>& at) {
    return equilibrium ? steady_of(law, at) : friction_at_steady_states(law, at);
  };
  if (!law.set_valued) return along(at);
  const T direction = sign(at.slip_rate);
  return direction * along(Sliding<T>{direction * at.slip_rate, at.normal_load});
}

/// The rows of a contact, g and F, for parameters and unknowns of scalar type T.
struct Rows {
  bool with_friction;  ///< the first unknown is μ
  bool equilibrium;    ///< states are those of steady sliding and not unknowns (λ = 0)

  explicit Rows(const ContactSetup& setup)
      : with_friction(setup.unknowns == Unknowns::friction), equilibrium(!with_friction && setup.lambda == 0) {}
  bool operator==(const Rows&) const = default;

  int unknowns(int states) const { return states == 0 ? 0 : (with_friction ? 1 : 0) + (equilibrium ? 0 : states); }

  template <class Law, class T>
  ROSIN_INLINE void operator()(const Law& law, const ContactInput<T>& in, const T& compliance, const T* z, T* g,
                               T& F) const {
    const T &u = in.slip_rate, &N = in.normal_load;
    typename Law::Number state[Law::capacity];
    if (!law.set_valued && law.states > 0 && with_friction) {
      const T& mu = z[0];
      T v;
      slip(law, N, z, v, g + 1);
      g[0] = u - v - compliance * (mu * in.load_rate);  // d(Nμ)/dt = k_t (u − v)
      F = N * mu;
    } else {
      const Sliding<T> at{law.set_valued ? speed_of(in) : u, N};
      if (equilibrium) {
        F = N * steady_of(law, at);
      } else {
        read(law, z, state);
        rates(law, at, state, g);
        F = N * law.friction(at, state);
      }
      if (law.set_valued) F = in.direction * F;
    }
  }

  /// Slip rate v and rates of the states, g, of a contact that carries friction.
  template <class Law, class T>
  ROSIN_INLINE static void slip(const Law& law, const T& N, const T* z, T& v, T* g) {
    typename Law::Number state[Law::capacity];
    read(law, z + 1, state);
    v = law.slip_rate(z[0], N, state);
    rates(law, Sliding<T>{v, N}, state, g);
  }

 private:
  /// Slip rate along the direction of slip. Slip that has only just begun is not stick, which is v = 0.
  template <class T>
  ROSIN_INLINE static T speed_of(const ContactInput<T>& in) {
    constexpr double beyond_rest = 1e-300;
    return max(in.direction * in.slip_rate, T(0.0)) + beyond_rest * (in.direction * in.direction);
  }
  /// States from unknowns: those with Scale::log are carried as logarithms.
  template <class Law, class T>
  ROSIN_INLINE static void read(const Law& law, const T* z, typename Law::Number* state) {
    ROSIN_UNROLL
    for (int k = 0; k < law.states; ++k)
      if (law.logarithmic(k))
        state[k] = Law::from_log(z[k]);
      else
        state[k] = z[k];
  }
  template <class Law, class T>
  ROSIN_INLINE static void rates(const Law& law, const Sliding<T>& at, const typename Law::Number* state, T* g) {
    law.rate(at, state, g);
    ROSIN_UNROLL
    for (int k = 0; k < law.states; ++k)
      if (law.logarithmic(k)) g[k] = g[k] / state[k];
  }
};

/// Steady sliding at slip rate u and load N as the unknowns z of a contact, and their weights (Contact::steady).
template <class Law>
void start_steady(const Rows& rows, const Law& law, double u, double N, double* z, double* weight) {
  if (law.states == 0) return;
  typename Law::Number state[Law::capacity];
  law.steady(Sliding<double>{u, N}, state);
  if (rows.with_friction) {
    // Friction errors are measured by ten times the direct effect, v·∂μ/∂v = v/(∂v/∂μ).
    *z = law.friction(Sliding<double>{u, N}, state);
    const double direct_effect = u / law.slip_rate_slope(*z, N, state);
    *weight = 10 * std::max(std::abs(direct_effect), 1e-3 * std::abs(*z));
    ++z, ++weight;
  }
  if (rows.equilibrium) return;
  double size[Law::capacity];
  law.sizes(state, size);
  // The law's sizes are the greatest that matter. A drive that hardly moves a state is sensitive to smaller changes of
  // it, down to those that the rounding of friction hides.
  constexpr double least = 1e-9;
  for (int k = 0; k < law.states; ++k)
    if (const double own = std::abs(state[k]); own > 0) size[k] = std::clamp(own, least * size[k], size[k]);
  for (int k = 0; k < law.states; ++k) {
    z[k] = law.logarithmic(k) ? std::log(double(state[k])) : double(state[k]);
    weight[k] = law.logarithmic(k) ? 1.0 : size[k];
  }
}

/// ∂μ/∂z of the state unknowns in steady sliding at u and N (Contact::friction_slopes).
template <class Law>
void steady_friction_slopes(const Law& law, double u, double N, double* slopes) {
  typename Law::Number state[Law::capacity];
  law.steady(Sliding<double>{u, N}, state);
  law.friction_slopes(Sliding<double>{u, N}, state, slopes);
  for (int k = 0; k < law.states; ++k)
    if (law.logarithmic(k)) slopes[k] *= state[k];
}

}  // namespace detail

/// What surrounds the law in a contact: which unknowns it carries, and of each lane the clock factor and the spring.
template <class Real>
class Surroundings {
  using Part = Portion<Real>;

 public:
  explicit Surroundings(const ContactSetup& setup)
      : rows_(setup),
        lambda_(setup.lambda),
        compliance_(setup.compliance),
        compliance_per_load_(setup.compliance_per_load) {}
  Surroundings(const ContactSetup& setup, const ContactSetup& slopes) requires(std::is_same_v<Real, Tower>)
      : rows_(setup),
        lambda_(across(setup.lambda, 0, slopes.lambda)),
        compliance_(across(setup.compliance, 0, slopes.compliance)),
        compliance_per_load_(across(setup.compliance_per_load, 0, slopes.compliance_per_load)) {}

  void load(int lane, const ContactSetup& setup) {
    if (detail::Rows(setup) != rows_) throw InputError("the lanes of one batch must carry the same unknowns");
    detail::set_lane(lambda_, lane, setup.lambda);
    detail::set_lane(compliance_, lane, setup.compliance);
    detail::set_lane(compliance_per_load_, lane, setup.compliance_per_load);
  }
  /// ContactValues::mass
  void mass(const Real& N, int states, Real* m) const {
    for (int p = 0; p < Part::count; ++p) {
      int i = 0;
      if (states > 0 && rows_.with_friction)
        Part::of(m[i++], p) = Part::of(N, p) * Part::of(compliance_, p) + Part::of(compliance_per_load_, p);
      while (i < rows_.unknowns(states)) Part::of(m[i++], p) = Part::of(lambda_, p);
    }
  }

  const detail::Rows& rows() const { return rows_; }
  const Real& compliance() const { return compliance_; }  ///< 1/k_t, m/N

 private:
  detail::Rows rows_;
  Real lambda_, compliance_, compliance_per_load_;
};

/// The contact of law L for one system (Real = double) or for 32 (Real = Lanes).
template <template <class> class L, class Real>
class LawContact final : public Contact<Real>, public Portions<Real> {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;
  using Wide = WidePortion<Real>;
  using WideScalar = typename Wide::Scalar;
  static constexpr int states = detail::count_states<L>();
  static constexpr int directions = states + 3;  // derivatives by (μ, states), u and N
  using Derivative = Dual<Scalar, directions>;
  static_assert(states + 1 <= Slopes<Real>::capacity);

 public:
  LawContact(std::span<const Value> parameters, const ContactSetup& setup) : setup_(setup) {
    law_.fill(detail::build<L<WideScalar>>(parameters));
    steady_law_.fill(detail::build<L<Scalar>>(parameters));
    derivative_law_.fill(detail::build<L<Derivative>>(parameters));
    lane_law_.fill(detail::build<L<double>>(parameters));
  }

  int unknowns() const override { return setup_.rows().unknowns(states); }

  void evaluate(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const override {
    on_lanes<Real>([&] { evaluate_here(in, z, g, F); });
  }

  void linearise(const ContactInput<Real>& in, const Real* z, Real* g, Real& F, Slopes<Real>& slopes) const override {
    on_lanes<Real>([&] { linearise_here(in, z, g, F, slopes); });
  }

  void steady_friction(const Real& u, const Real& N, Real& mu) const override {
    on_lanes<Real>([&] {
      for (int p = 0; p < this->portions(); ++p)  // asked too seldom for kernels twice as wide
        Part::of(mu, p) =
            detail::steady_coefficient(detail::Written<L, Scalar>{steady_law_[p]},
                                       Sliding<Scalar>{Part::of(u, p), Part::of(N, p)}, setup_.rows().equilibrium);
    });
  }

  void mass(const Real& N, Real* m) const override { setup_.mass(N, states, m); }

  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    if constexpr (Wide::count > 1) detail::require_same_lists(law_[0], parameters);
    setup_.load(lane, setup);
    lane_law_[lane] = detail::build<L<double>>(parameters);
    detail::assign(law_[lane / Wide::width], parameters, lane % Wide::width);
    detail::assign(steady_law_[lane / pack_width], parameters, lane % pack_width);
    detail::assign(derivative_law_[lane / pack_width], parameters, lane % pack_width);
  }

  void steady(int lane, double u, double N, double* z, double* weight) const override {
    detail::start_steady(setup_.rows(), detail::Written<L, double>{lane_law_[lane]}, u, N, z, weight);
  }

  void friction_slopes(int lane, double u, double N, double* slopes) const override {
    detail::steady_friction_slopes(detail::Written<L, double>{lane_law_[lane]}, u, N, slopes);
  }

 private:
  ROSIN_INLINE void evaluate_here(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const {
    for (int p = 0; p < this->wide_portions(); ++p) {
      WideScalar part_z[states + 1] = {}, part_g[states + 1] = {}, part_F;
      const int n = unknowns();
      for (int i = 0; i < n; ++i) part_z[i] = Wide::get(z[i], p);
      setup_.rows()(detail::Written<L, WideScalar>{law_[p]},
                    ContactInput<WideScalar>{Wide::get(in.slip_rate, p), Wide::get(in.normal_load, p),
                                             Wide::get(in.load_rate, p), Wide::get(in.direction, p)},
                    Wide::get(setup_.compliance(), p), part_z, part_g, part_F);
      for (int i = 0; i < n; ++i) Wide::set(g[i], p, part_g[i]);
      Wide::set(F, p, part_F);
    }
  }

  ROSIN_INLINE void linearise_here(const ContactInput<Real>& in, const Real* z, Real* g, Real& F,
                                   Slopes<Real>& slopes) const {
    for (int p = 0; p < this->portions(); ++p) {
      const int n = unknowns();
      Derivative part_z[states + 1], part_g[states + 1], part_F;
      for (int i = 0; i < n; ++i) part_z[i] = Derivative::variable(Part::of(z[i], p), i);
      setup_.rows()(
          detail::Written<L, Derivative>{derivative_law_[p]},
          ContactInput<Derivative>{Derivative::variable(Part::of(in.slip_rate, p), n),
                                   Derivative::variable(Part::of(in.normal_load, p), n + 1),
                                   Derivative(Part::of(in.load_rate, p)), Derivative(Part::of(in.direction, p))},
          Derivative(Part::of(setup_.compliance(), p)), part_z, part_g, part_F);
      for (int i = 0; i < n; ++i) {
        Part::of(g[i], p) = part_g[i].value;
        for (int j = 0; j < n; ++j) Part::of(slopes.g_z[i * n + j], p) = part_g[i].slope[j];
        Part::of(slopes.g_u[i], p) = part_g[i].slope[n];
        Part::of(slopes.g_N[i], p) = part_g[i].slope[n + 1];
        Part::of(slopes.F_z[i], p) = part_F.slope[i];
      }
      Part::of(F, p) = part_F.value;
      Part::of(slopes.F_u, p) = part_F.slope[n];
      Part::of(slopes.F_N, p) = part_F.slope[n + 1];
    }
  }

  Surroundings<Real> setup_;
  std::array<L<WideScalar>, Wide::count> law_;
  std::array<L<Scalar>, Part::count> steady_law_;
  std::array<L<Derivative>, Part::count> derivative_law_;
  std::array<L<double>, std::is_same_v<Real, Lanes> ? lane_count : 1> lane_law_;  ///< for starts, one lane at a time
};

/// The flow of the contact of law L, which has a slip rate.
template <template <class> class L>
class LawFlow final : public ContactFlow {
  static constexpr int n = detail::count_states<L>() + 1;
  using Slope = Dual<Pack, n>;

 public:
  explicit LawFlow(std::span<const Value> parameters) : law_(detail::build<L<Slope>>(parameters)) {}
  int unknowns() const override { return n; }
  void slip(const Pack& N, const Pack* z, Pack& v, Pack* g, Pack* v_z, Pack* g_z) const override {
    run_on_lanes([&] {
      Slope of_z[n], of_v, of_g[n];
      ROSIN_UNROLL
      for (int i = 0; i < n; ++i) of_z[i] = Slope::variable(z[i], i);
      detail::Rows::slip(detail::Written<L, Slope>{law_}, Slope(N), of_z, of_v, of_g);
      v = of_v.value;
      ROSIN_UNROLL
      for (int j = 0; j < n; ++j) v_z[j] = of_v.slope[j];
      ROSIN_UNROLL
      for (int i = 0; i < n - 1; ++i) {
        g[i] = of_g[i].value;
        ROSIN_UNROLL
        for (int j = 0; j < n; ++j) g_z[i * n + j] = of_g[i].slope[j];
      }
    });
  }

 private:
  L<Slope> law_;
};

/// The contact of law L in Tower arithmetic: values and derivatives to third order along a direction, and mixed ones
/// by its numbers.
template <template <class> class L>
class LawTower final : public ContactValues<Tower> {
 public:
  LawTower(std::span<const Value> parameters, const ContactSetup& setup, const ContactChange& change)
      : setup_(setup, change.setup), law_(detail::build<L<Tower>>(parameters, change.parameters)) {}
  int unknowns() const override { return setup_.rows().unknowns(states); }
  void evaluate(const ContactInput<Tower>& in, const Tower* z, Tower* g, Tower& F) const override {
    setup_.rows()(detail::Written<L, Tower>{law_}, in, setup_.compliance(), z, g, F);
  }
  void mass(const Tower& N, Tower* m) const override { setup_.mass(N, states, m); }

 private:
  static constexpr int states = detail::count_states<L>();
  Surroundings<Tower> setup_;
  L<Tower> law_;
};

/// Law L behind the abstract FrictionLaw.
template <template <class> class L>
class Law final : public FrictionLaw {
  static constexpr int states_count = detail::count_states<L>();

 public:
  explicit Law(std::vector<Value> values) : values_(std::move(values)), law_(detail::build<L<double>>(values_)) {}

  const Card& card() const override { return L<double>::card; }
  const std::vector<Quantity>& parameters() const override {
    static const auto list = detail::describe(L<double>::parameters);
    return list;
  }
  const std::vector<Quantity>& states() const override {
    static const auto list = [] {
      if constexpr (HasStates<L>)
        return detail::describe(L<double>::states);
      else
        return std::vector<Quantity>();
    }();
    return list;
  }
  const std::vector<Preset>& presets() const override {
    static const auto list = [] {
      std::vector<Preset> presets;
      if constexpr (HasPresets<L>)
        for (const auto& p : L<double>::presets())
          presets.push_back({std::string(p.name), std::string(p.source), detail::values_of(p.law)});
      return presets;
    }();
    return list;
  }
  const std::vector<Value>& values() const override { return values_; }

  std::shared_ptr<const FrictionLaw> with(std::vector<Value> values) const override {
    check_values(values);
    return std::make_shared<Law>(std::move(values));
  }

  bool has_slip_rate() const override { return HasSlipRate<L>; }
  std::unique_ptr<ContactFlow> flow() const override {
    if constexpr (HasSlipRate<L>)
      return std::make_unique<LawFlow<L>>(values_);
    else
      refuse_flow(card());
  }
  bool set_valued() const override { return SetValued<L>; }

  double friction(Sliding<double> at, std::span<const double> state) const override {
    const double direction = SetValued<L> ? sign(at.slip_rate) : 1.0;
    return checked("friction", at, [&] {
      if constexpr (states_count == 0)
        return direction * law_.friction(asked(at));
      else
        return direction * law_.friction(asked(at), state_of(state));
    }());
  }
  std::vector<double> rate([[maybe_unused]] Sliding<double> at,
                           [[maybe_unused]] std::span<const double> state) const override {
    if constexpr (HasStates<L>)
      return numbers_of(at, "rate", law_.rate(asked(at), state_of(state)));
    else
      return {};
  }
  std::vector<double> steady([[maybe_unused]] Sliding<double> at) const override {
    if constexpr (HasStates<L>)
      return numbers_of(at, "steady state", law_.steady(asked(at)));
    else
      return {};
  }
  std::vector<double> rest([[maybe_unused]] double normal_load) const override {
    if constexpr (HasRest<L>)
      return numbers_of({0, normal_load}, "state at rest", law_.rest(Sliding<double>{0, normal_load}));
    else
      return steady({slowest_creep, normal_load});
  }
  double slip_rate(double mu, double normal_load, std::span<const double> state) const override {
    if constexpr (HasSlipRate<L>)
      return law_.slip_rate(mu, Sliding<double>{0, normal_load}, state_of(state));
    else
      throw InputError(fmt::format("law '{}' has no explicit slip rate", card().name));
  }
  double static_limit([[maybe_unused]] double normal_load,
                      [[maybe_unused]] std::span<const double> state) const override {
    const Sliding<double> at{0, normal_load};
    if constexpr (LimitHasStates<L>)
      return checked("static limit", at, law_.static_limit(at, state_of(state)));
    else if constexpr (SetValued<L>)
      return checked("static limit", at, law_.static_limit(at));
    else
      throw InputError(fmt::format("law '{}' has no static limit: its force at rest is unique", card().name));
  }
  std::optional<LinearFriction> linear() const override {
    if constexpr (requires { law_.linear(); }) return law_.linear();
    return std::nullopt;
  }
  std::shared_ptr<const FrictionLaw> without_clock([[maybe_unused]] double normal_load) const override {
    if constexpr (requires { law_.without_clock(normal_load); }) {
      const LawByName law = law_.without_clock(normal_load);
      return find_law(law.name)->with(law.values);
    }
    return nullptr;
  }
  std::vector<double> after_stop(std::span<const double> state) const override {
    if constexpr (HasStopReset<L>)
      return numbers_of({0, 0}, "state after a stop", law_.after_stop(state_of(state)));
    else
      return {state.begin(), state.end()};
  }
  double kink(std::span<const double> state) const override {
    if constexpr (HasKink<L>) return law_.kink(state_of(state));
    return NAN;
  }
  Steady steady_friction(Sliding<double> at) const override {
    using Slope = Dual<double, 1>;
    // At rest, a set-valued law is seen from the side of slip along the drive.
    const double direction = SetValued<L> && at.slip_rate < 0 ? -1 : 1;
    const auto law = detail::build<L<Slope>>(values_);
    const Slope mu =
        direction * detail::steady_of(detail::Written<L, Slope>{law},
                                      Sliding<Slope>{direction * Slope::variable(at.slip_rate, 0), at.normal_load});
    return {checked("steady friction", at, mu.value), mu.slope[0]};
  }

 private:
  std::unique_ptr<Contact<double>> bare_contact(const ContactSetup& setup) const override {
    return std::make_unique<LawContact<L, double>>(values_, accepted(setup));
  }
  std::unique_ptr<Contact<Lanes>> bare_lanes(const ContactSetup& setup) const override {
    return std::make_unique<LawContact<L, Lanes>>(values_, accepted(setup));
  }
  std::unique_ptr<ContactValues<Tower>> bare_tower(const ContactSetup& setup,
                                                   const ContactChange& change) const override {
    return std::make_unique<LawTower<L>>(values_, accepted(setup), change);
  }
  static const ContactSetup& accepted(const ContactSetup& setup) {
    if (setup.unknowns == Unknowns::friction && !HasSlipRate<L>)
      throw InputError(fmt::format("law '{}' has no explicit slip rate: its contact cannot carry μ as unknown",
                                   L<double>::card.name));
    return setup;
  }
  /// Set-valued laws are asked for slip along v.
  static Sliding<double> asked(Sliding<double> at) {
    if constexpr (SetValued<L>) at.slip_rate = std::abs(at.slip_rate);
    return at;
  }
  auto state_of(std::span<const double> values) const {
    if (int(values.size()) != states_count)
      throw InputError(fmt::format("law '{}' has {} state(s), got {}", card().name, states_count, values.size()));
    if constexpr (HasStates<L>) {
      typename L<double>::State state;
      detail::for_each_field(L<double>::states, [&](const auto& f, std::size_t i) { state.*(f.member) = values[i]; });
      return state;
    } else {
      return 0;
    }
  }
  std::vector<double> numbers_of(Sliding<double> at, const char* what, const auto& state) const {
    std::vector<double> list;
    detail::for_each_field(L<double>::states,
                           [&](const auto& f, std::size_t) { list.push_back(checked(what, at, state.*(f.member))); });
    return list;
  }
  double checked(const char* what, Sliding<double> at, double x) const { return finite_answer(card(), what, at, x); }
  void check_values(const std::vector<Value>& values) const;

  std::vector<Value> values_;
  L<double> law_;
};

template <template <class> class L>
void Law<L>::check_values(const std::vector<Value>& values) const {
  check_parameters(card(), parameters(), values);
  if constexpr (requires { L<double>::check(law_); }) L<double>::check(detail::build<L<double>>(values));
}

template <template <class> class L>
std::shared_ptr<const FrictionLaw> make_law(const L<double>& law) {
  return Law<L>(detail::values_of(L<double>{})).with(detail::values_of(law));
}

}  // namespace rosin::laws
