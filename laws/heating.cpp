/// Heating as a law around a law, and as a contact around its contact.
#include "laws/heating.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/tower.hpp"
#include "laws/portion.hpp"

namespace rosin::laws {

namespace {

constexpr std::size_t heating_count = 3;

/// h = 1 + ϑ/ϑ_s in steady sliding, where h² − h = q = R·F₀·v/ϑ_s and F₀ is the cold force.
template <class Real>
ROSIN_INLINE Real steady_softening(const Real& q) {
  return 0.5 * (1.0 + sqrt(1.0 + 4.0 * q));
}

/// Rows and force of a heated contact. `law` has n unknowns; ϑ follows as unknown n, then the parts of the kernel,
/// unless states are in equilibrium.
template <class Real>
struct Heated {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;
  static constexpr int most = Slopes<double>::capacity;
  bool with_friction, equilibrium;
  std::span<const HeatMode> kernel;
  Real resistance, time, softening, compliance;

  Heated(const ContactSetup& setup, const Heating& heating)
      : with_friction(setup.unknowns == Unknowns::friction),
        equilibrium(!with_friction && setup.lambda == 0),
        kernel(heating.kernel),
        resistance(heating.resistance),
        time(heating.time),
        softening(heating.softening),
        compliance(setup.compliance) {}
  void load(int lane, const ContactSetup& setup, const Heating& heating) {
    detail::set_lane(resistance, lane, heating.resistance);
    detail::set_lane(time, lane, heating.time);
    detail::set_lane(softening, lane, heating.softening);
    detail::set_lane(compliance, lane, setup.compliance);
  }
  int added() const { return equilibrium ? 0 : int(kernel.size()); }

  /// The law's unknowns: at friction μ the cold law would have friction μ·h.
  void cold(const Real* z, int n, Real* z_cold) const {
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        for (int i = 0; i < n; ++i) Part::of(z_cold[i], p) = Part::of(z[i], p);
        if (with_friction)
          Part::of(z_cold[0], p) = Part::of(z[0], p) * (1.0 + Part::of(z[n], p) / Part::of(softening, p));
      }
    });
  }
  /// What is asked of the cold contact. Its spring does not see the load rate: that goes with μ, not with μ·h.
  ContactInput<Real> asked(const ContactInput<Real>& in) const {
    return {in.slip_rate, in.normal_load, with_friction ? Real(0.0) : in.load_rate, in.direction};
  }
  /// From the cold contact's g and F to those of the heated one. `v` is the slip rate of the law.
  void finish(const ContactInput<Real>& in, const Real* z, int n, Real* g, Real& F, Real& v) const {
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        const Scalar &u = Part::of(in.slip_rate, p), &R = Part::of(resistance, p), &soft = Part::of(softening, p);
        Scalar& force = Part::of(F, p);
        Part::of(v, p) = u;
        if (with_friction) {
          Part::of(v, p) = u - Part::of(g[0], p);
          force = Part::of(in.normal_load, p) * Part::of(z[0], p);
          Part::of(g[0], p) =
              Part::of(g[0], p) - Part::of(compliance, p) * (Part::of(z[0], p) * Part::of(in.load_rate, p));
        } else if (equilibrium) {
          force = force / steady_softening(R * force * u / soft);
        } else {
          force = force / (1.0 + Part::of(z[n], p) / soft);
        }
        if (equilibrium) continue;
        Scalar rise[most] = {}, rate[most];
        for (std::size_t k = 0; k < kernel.size(); ++k) rise[k] = Part::of(z[n + k], p);
        warm(R * force * Part::of(v, p), rise, p, rate);
        for (std::size_t k = 0; k < kernel.size(); ++k) Part::of(g[n + k], p) = rate[k];
      }
    });
  }
  /// Rates of the temperatures. They are linear, so that slopes of R·F·v and of the temperatures give slopes of the
  /// rates.
  ROSIN_INLINE void warm(const Scalar& ends_at, const Scalar* rise, int p, Scalar* rate) const {
    heat_rates(kernel, ends_at, rise, rate);
    for (std::size_t k = 0; k < kernel.size(); ++k) rate[k] = rate[k] / Part::of(time, p);
  }
  void evaluate(const ContactValues<Real>& law, const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const {
    const int n = law.unknowns();
    Real z_cold[most], v;
    cold(z, n, z_cold);
    law.evaluate(asked(in), z_cold, g, F);
    finish(in, z, n, g, F, v);
  }
};

template <class Real>
class HeatedContact final : public Contact<Real> {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;
  static constexpr int most = Slopes<double>::capacity;

 public:
  HeatedContact(std::unique_ptr<Contact<Real>> law, const ContactSetup& setup, const Heating& heating)
      : law_(std::move(law)), rows_(setup, heating) {
    mass_ = Real(setup.lambda);
  }

  int unknowns() const override { return law_->unknowns() + rows_.added(); }
  void evaluate(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const override {
    rows_.evaluate(*law_, in, z, g, F);
  }

  void linearise(const ContactInput<Real>& in, const Real* z, Real* g, Real& F, Slopes<Real>& slopes) const override {
    const int n = law_->unknowns(), all = unknowns();
    Real z_cold[most], v, cold_F;
    Slopes<Real> cold;
    rows_.cold(z, n, z_cold);
    law_->linearise(rows_.asked(in), z_cold, g, cold_F, cold);
    F = cold_F;
    rows_.finish(in, z, n, g, F, v);
    const bool with_friction = rows_.with_friction, equilibrium = rows_.equilibrium;
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        const auto part = [&](Real & x) __attribute__((always_inline))->Scalar& { return Part::of(x, p); };
        const Scalar &u = Part::of(in.slip_rate, p), &N = Part::of(in.normal_load, p);
        const Scalar &R = Part::of(rows_.resistance, p), &soft = Part::of(rows_.softening, p);
        const Scalar force = part(F), cold_force = part(cold_F);
        const Scalar h = equilibrium ? steady_softening(R * cold_force * u / soft) : 1.0 + Part::of(z[n], p) / soft;
        Scalar v_z[most], v_u(1.0), v_N(0.0);
        for (int j = 0; j < all; ++j) v_z[j] = 0.0;
        for (int i = 0; i < n; ++i) {
          for (int j = 0; j < n; ++j)
            part(slopes.g_z[i * all + j]) = part(cold.g_z[i * n + j]) * (with_friction && j == 0 ? h : Scalar(1.0));
          for (int j = n; j < all; ++j)
            part(slopes.g_z[i * all + j]) =
                with_friction && j == n ? part(cold.g_z[i * n]) * Part::of(z[0], p) / soft : Scalar(0.0);
          part(slopes.g_u[i]) = part(cold.g_u[i]);
          part(slopes.g_N[i]) = part(cold.g_N[i]);
        }
        if (with_friction) {  // v = u − g₀ of the cold contact
          for (int j = 0; j < all; ++j) v_z[j] = -part(slopes.g_z[j]);
          v_u = 1.0 - part(cold.g_u[0]);
          v_N = -part(cold.g_N[0]);
          part(slopes.g_z[0]) = part(slopes.g_z[0]) - Part::of(rows_.compliance, p) * Part::of(in.load_rate, p);
          for (int j = 0; j < all; ++j) part(slopes.F_z[j]) = 0.0;
          part(slopes.F_z[0]) = N;
          part(slopes.F_u) = 0.0;
          part(slopes.F_N) = Part::of(z[0], p);
        } else if (equilibrium) {
          const Scalar stiffening = 1.0 / (2.0 * h - 1.0);  // dh/dq
          const Scalar by_force = 1.0 / h - cold_force / (h * h) * stiffening * R * u / soft;
          part(slopes.F_u) = part(cold.F_u) * by_force - cold_force / (h * h) * stiffening * R * cold_force / soft;
          part(slopes.F_N) = part(cold.F_N) * by_force;
        } else {
          for (int j = 0; j < all; ++j) part(slopes.F_z[j]) = j < n ? part(cold.F_z[j]) / h : Scalar(0.0);
          part(slopes.F_z[n]) = -force / (h * soft);
          part(slopes.F_u) = part(cold.F_u) / h;
          part(slopes.F_N) = part(cold.F_N) / h;
        }
        if (!equilibrium) {
          const auto by = [&](const Scalar& F_x, const Scalar& v_x, int moved, Real* rows, int stride)
              __attribute__((always_inline)) {
            Scalar rise[most] = {}, rate[most];
            for (int k = 0; k < all - n; ++k) rise[k] = k == moved ? 1.0 : 0.0;
            rows_.warm(R * (F_x * part(v) + force * v_x), rise, p, rate);
            for (int k = 0; k < all - n; ++k) part(rows[k * stride]) = rate[k];
          };
          for (int j = 0; j < all; ++j) by(part(slopes.F_z[j]), v_z[j], j - n, slopes.g_z + n * all + j, all);
          by(part(slopes.F_u), v_u, -1, slopes.g_u + n, 1);
          by(part(slopes.F_N), v_N, -1, slopes.g_N + n, 1);
        }
      }
    });
  }

  void steady_friction(const Real& u, const Real& N, Real& mu) const override {
    law_->steady_friction(u, N, mu);
    on_lanes<Real>([&] {
      for (int p = 0; p < Part::count; ++p) {
        Scalar& m = Part::of(mu, p);
        const Scalar power = Part::of(rows_.resistance, p) * Part::of(N, p) * m * Part::of(u, p);
        m = m / steady_softening(power / Part::of(rows_.softening, p));
      }
    });
  }

  void mass(const Real& N, Real* m) const override {
    law_->mass(N, m);
    for (int k = law_->unknowns(); k < unknowns(); ++k) m[k] = mass_;
  }

  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    const std::size_t own = parameters.size() - heating_count;
    law_->load(lane, parameters.first(own), setup);
    rows_.load(lane, setup,
               {std::get<double>(parameters[own]), std::get<double>(parameters[own + 1]),
                std::get<double>(parameters[own + 2]), rows_.kernel});
    detail::set_lane(mass_, lane, setup.lambda);
  }

  void steady(int lane, double u, double N, double* z, double* weight) const override {
    law_->steady(lane, u, N, z, weight);
    if (rows_.equilibrium) return;
    const int n = law_->unknowns();
    const double q = strength_of(lane, u, N), h = steady_softening(q), soft = of(rows_.softening, lane);
    z[n] = soft * q / h;
    weight[n] = std::max(z[n], 1e-3 * soft);
    for (std::size_t k = 1; k < rows_.kernel.size(); ++k)
      z[n + k] = rows_.kernel[k].share * z[n], weight[n + k] = rows_.kernel[k].share * weight[n];
    if (rows_.with_friction) z[0] /= h, weight[0] /= h;
  }

  void friction_slopes(int lane, double u, double N, double* slopes) const override {
    law_->friction_slopes(lane, u, N, slopes);
    if (rows_.equilibrium) return;
    const int states = law_->unknowns() - (rows_.with_friction ? 1 : 0);
    const double h = steady_softening(strength_of(lane, u, N));
    for (int i = 0; i < states; ++i) slopes[i] /= h;
    Real mu;
    law_->steady_friction(Real(u), Real(N), mu);
    std::fill_n(slopes + states, rows_.added(), 0.0);
    slopes[states] = -of(mu, lane) / (h * h * of(rows_.softening, lane));
  }

 private:
  static double of(const double& x, int) { return x; }
  static double of(const Lanes& x, int lane) { return x[lane]; }
  double strength_of(int lane, double u, double N) const {
    Real mu;
    law_->steady_friction(Real(u), Real(N), mu);
    return of(rows_.resistance, lane) * N * of(mu, lane) * u / of(rows_.softening, lane);
  }

  std::unique_ptr<Contact<Real>> law_;
  Heated<Real> rows_;
  Real mass_;
};

/// The flow of a heated contact.
class HeatedFlow final : public ContactFlow {
  static constexpr int most = Slopes<double>::capacity;

 public:
  HeatedFlow(std::unique_ptr<ContactFlow> law, const Heating& heating)
      : law_(std::move(law)), rows_(ContactSetup{}, heating) {}

  int unknowns() const override { return law_->unknowns() + rows_.added(); }
  void slip(const Pack& N, const Pack* z, Pack& v, Pack* g, Pack* v_z, Pack* g_z) const override {
    const int n = law_->unknowns(), all = unknowns();
    Pack z_cold[most], cold_v_z[most], cold_g_z[most * most];
    rows_.cold(z, n, z_cold);
    law_->slip(N, z_cold, v, g, cold_v_z, cold_g_z);
    run_on_lanes([&] {
      const Pack &soft = rows_.softening, &mu = z[0], &rise = z[n];
      const Pack h = 1.0 + rise / soft;
      const auto warm = [&](const Pack* from, Pack* to) __attribute__((always_inline)) {
        for (int j = 0; j < n; ++j) to[j] = from[j] * (j == 0 ? h : Pack(1.0));
        for (int j = n; j < all; ++j) to[j] = j == n ? from[0] * mu / soft : Pack(0.0);
      };
      warm(cold_v_z, v_z);
      for (int i = 0; i < n - 1; ++i) warm(cold_g_z + i * n, g_z + i * all);
      const Pack per_slip = rows_.resistance * N * mu;
      Pack temperatures[most] = {}, rate[most];
      for (int k = 0; k < all - n; ++k) temperatures[k] = z[n + k];
      rows_.warm(per_slip * v, temperatures, 0, rate);
      for (int k = 0; k < all - n; ++k) g[n - 1 + k] = rate[k];
      for (int j = 0; j < all; ++j) {
        Pack ends_at = per_slip * v_z[j];
        if (j == 0) ends_at = ends_at + rows_.resistance * N * v;
        for (int k = 0; k < all - n; ++k) temperatures[k] = n + k == j ? 1.0 : 0.0;
        rows_.warm(ends_at, temperatures, 0, rate);
        for (int k = 0; k < all - n; ++k) g_z[(n - 1 + k) * all + j] = rate[k];
      }
    });
  }

 private:
  std::unique_ptr<ContactFlow> law_;
  Heated<Pack> rows_;
};

class HeatedTower final : public ContactValues<Tower> {
 public:
  /// `slopes`: of the three numbers of the heating, or empty.
  HeatedTower(std::unique_ptr<ContactValues<Tower>> law, const ContactSetup& setup, const Heating& heating,
              const ContactSetup& change, std::span<const double> slopes)
      : law_(std::move(law)), rows_(setup, heating), mass_(across(setup.lambda, 0, change.lambda)) {
    rows_.compliance = across(setup.compliance, 0, change.compliance);
    if (slopes.empty()) return;
    rows_.resistance = across(heating.resistance, 0, slopes[0]);
    rows_.time = across(heating.time, 0, slopes[1]);
    rows_.softening = across(heating.softening, 0, slopes[2]);
  }
  int unknowns() const override { return law_->unknowns() + rows_.added(); }
  void evaluate(const ContactInput<Tower>& in, const Tower* z, Tower* g, Tower& F) const override {
    rows_.evaluate(*law_, in, z, g, F);
  }
  void mass(const Tower& N, Tower* m) const override {
    law_->mass(N, m);
    std::fill(m + law_->unknowns(), m + unknowns(), mass_);
  }

 private:
  std::unique_ptr<ContactValues<Tower>> law_;
  Heated<Tower> rows_;
  Tower mass_;
};

class HeatedLaw final : public FrictionLaw {
 public:
  HeatedLaw(std::shared_ptr<const FrictionLaw> law, const Heating& heating) : law_(std::move(law)), heating_(heating) {
    parameters_ = law_->parameters();
    for (const auto& quantity : heating_parameters()) {
      parameters_.push_back(quantity);
      parameters_.back().name = "heating." + quantity.name;
    }
    states_ = law_->states();
    own_states_ = states_.size();
    states_.push_back({"temperature_rise", "K", {0, 1e15}, "temperature of the contact above its surroundings"});
    for (std::size_t k = 1; k < heating.kernel.size(); ++k)
      states_.push_back(
          {fmt::format("temperature_part_{}", k),
           "K",
           {0, 1e15},
           fmt::format("part of it with the relaxation time {:.3g} heating.time", heating.kernel[k].time)});
    constexpr int beside_states = 2;  // friction, or the law's slip rate, and the deflection of a spring
    if (int(states_.size()) + beside_states > Slopes<double>::capacity)
      throw InputError(
          fmt::format("law '{}' with heating has {} states, and a contact has room for {}; take conduction "
                      "through one lump",
                      card().name, states_.size(), Slopes<double>::capacity - beside_states));
    values_ = law_->values();
    for (const double x : {heating.resistance, heating.time, heating.softening}) values_.emplace_back(x);
    check_parameters(card(), parameters_, values_);
  }

  const Card& card() const override { return law_->card(); }
  std::string_view approximation() const override {
    return heating_.kernel.data() == disc ? disc_approximation : law_->approximation();
  }
  const std::vector<Quantity>& parameters() const override { return parameters_; }
  const std::vector<Quantity>& states() const override { return states_; }
  const std::vector<Preset>& presets() const override { return law_->presets(); }
  const std::vector<Value>& values() const override { return values_; }
  std::shared_ptr<const FrictionLaw> with(std::vector<Value> values) const override {
    check_parameters(card(), parameters_, values);
    const auto own = std::ptrdiff_t(values.size() - heating_count);
    const auto number = [&](std::ptrdiff_t i) { return std::get<double>(values[std::size_t(own + i)]); };
    return std::make_shared<HeatedLaw>(law_->with({values.begin(), values.begin() + own}),
                                       Heating{number(0), number(1), number(2), heating_.kernel});
  }

  bool has_slip_rate() const override { return law_->has_slip_rate(); }
  bool set_valued() const override { return law_->set_valued(); }

  double friction(Sliding<double> at, std::span<const double> state) const override {
    return law_->friction(at, cold(state)) / softened(state);
  }
  std::vector<double> rate(Sliding<double> at, std::span<const double> state) const override {
    auto rates = law_->rate(at, cold(state));
    const double power = at.normal_load * friction(at, state) * at.slip_rate;
    const auto rise = state.subspan(own_states_);
    rates.resize(states_.size());
    heat_rates(heating_.kernel, heating_.resistance * power, rise.data(), rates.data() + own_states_);
    for (std::size_t k = own_states_; k < rates.size(); ++k) rates[k] /= heating_.time;
    return rates;
  }
  std::vector<double> steady(Sliding<double> at) const override {
    auto state = law_->steady(at);
    const double q = strength(at, law_->steady_friction(at).friction);
    const double rise = heating_.softening * q / steady_softening(q);  // ϑ/ϑ_s = h − 1, free of its cancellation
    state.push_back(rise);
    for (const auto& mode : heating_.kernel.subspan(1)) state.push_back(mode.share * rise);
    return state;
  }
  double slip_rate(double mu, double normal_load, std::span<const double> state) const override {
    const auto own = cold(state);
    return law_->slip_rate(mu * softened(state), normal_load, own);
  }
  std::vector<double> rest(double normal_load) const override {
    auto state = law_->rest(normal_load);
    state.resize(states_.size(), 0.0);
    return state;
  }
  double static_limit(double normal_load, std::span<const double> state) const override {
    return law_->static_limit(normal_load, cold(state)) / softened(state);
  }
  std::vector<double> after_stop(std::span<const double> state) const override {
    auto after = law_->after_stop(cold(state));
    after.insert(after.end(), state.begin() + std::ptrdiff_t(own_states_), state.end());
    return after;
  }
  double kink(std::span<const double> state) const override { return law_->kink(state.first(own_states_)); }
  double slip_kink(double slip_rate) const override { return law_->slip_kink(slip_rate); }
  Steady steady_friction(Sliding<double> at) const override {
    const auto [mu, slope] = law_->steady_friction(at);
    const double q = strength(at, mu), h = steady_softening(q);
    const double q_v = heating_.resistance * at.normal_load * (slope * at.slip_rate + mu) / heating_.softening;
    return {mu / h, slope / h - mu * q_v / (h * h * (2 * h - 1))};
  }
  std::unique_ptr<ContactFlow> flow() const override { return std::make_unique<HeatedFlow>(law_->flow(), heating_); }

 private:
  std::unique_ptr<Contact<double>> bare_contact(const ContactSetup& setup) const override {
    return std::make_unique<HeatedContact<double>>(law_->contact(bare(setup)), setup, heating_);
  }
  std::unique_ptr<Contact<Lanes>> bare_lanes(const ContactSetup& setup) const override {
    return std::make_unique<HeatedContact<Lanes>>(law_->lanes(bare(setup)), setup, heating_);
  }
  std::unique_ptr<ContactValues<Tower>> bare_tower(const ContactSetup& setup,
                                                   const ContactChange& change) const override {
    ContactChange of_law = change;
    of_law.parameters.resize(change.parameters.empty() ? 0 : change.parameters.size() - heating_count);
    const auto of_heating = std::span(change.parameters).subspan(of_law.parameters.size());
    return std::make_unique<HeatedTower>(law_->tower(bare(setup), of_law), setup, heating_, change.setup, of_heating);
  }
  /// Load memory and series springs go around the heated contact, not inside.
  static ContactSetup bare(ContactSetup setup) {
    setup.spring = {};
    setup.load_memory = 0;
    return setup;
  }
  std::span<const double> cold(std::span<const double> state) const {
    if (state.empty()) return state;  // of a law that is asked without, and answers or refuses itself
    if (state.size() != states_.size())
      throw InputError(
          fmt::format("law '{}' with heating has {} state(s), got {}", card().name, states_.size(), state.size()));
    return state.first(own_states_);
  }
  double softened(std::span<const double> state) const {
    return state.empty() ? 1 : 1 + state[own_states_] / heating_.softening;
  }
  /// q = R·F₀·v/ϑ_s from the cold coefficient.
  double strength(Sliding<double> at, double mu) const {
    return heating_.resistance * at.normal_load * mu * at.slip_rate / heating_.softening;
  }

  std::shared_ptr<const FrictionLaw> law_;
  Heating heating_;
  std::vector<Quantity> parameters_, states_;
  std::size_t own_states_;  ///< of the law without heating
  std::vector<Value> values_;
};

}  // namespace

const std::vector<Quantity>& heating_parameters() {
  static const std::vector<Quantity> list = {
      {"resistance", "K/W", {0, 1e15}, "temperature rise of the contact in steady sliding per frictional power"},
      {"time", "s", {1e-15, 1e15}, "time in which the contact warms and cools"},
      {"softening", "K", {1e-6, 1e15}, "temperature rise that halves friction"}};
  return list;
}

std::shared_ptr<const FrictionLaw> heated(std::shared_ptr<const FrictionLaw> law, const Heating& heating) {
  if (law->deflects())
    throw InputError(
        fmt::format("law.heating does not go with law '{}': a part of its friction is elastic and makes no heat",
                    law->card().name));
  return std::make_shared<HeatedLaw>(std::move(law), heating);
}

}  // namespace rosin::laws
