/// Smoothing as a law around a law, and as a contact around its contact.
#include "laws/smoothing.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/tower.hpp"
#include "laws/portion.hpp"

namespace rosin::laws {

namespace {

/// S(w). Factors are odd or even without a sign of w, whose slope at 0 would be lost.
template <class Real>
ROSIN_INLINE Real shape(Smoothing::Type type, const Real& w) {
  const Real within = max(Real(-1.0), min(w, Real(1.0)));
  switch (type) {
    case Smoothing::Type::tanh:
      return tanh(w);
    case Smoothing::Type::arctan:
      return (2 * std::numbers::inv_pi) * arctan(w);
    case Smoothing::Type::linear:
      return within;
    case Smoothing::Type::parabolic:
      return (2.0 - abs(within)) * within;
  }
  return w;
}

/// The side on which the set-valued law is asked; at rest, where S = 0, that of the drive.
template <class Real>
ROSIN_INLINE Real side_of(const Real& u) {
  return select(u < Real(0.0), Real(-1.0), Real(1.0));
}

/// The question to the set-valued law's contact.
template <class Real>
ContactInput<Real> asked(ContactInput<Real> in) {
  using Part = Portion<Real>;
  on_lanes<Real>([&] {
    for (int p = 0; p < Part::count; ++p) Part::of(in.direction, p) = side_of(Part::of(in.slip_rate, p));
  });
  return in;
}

/// From friction on the side of the slip to smoothed friction.
template <class Real>
void smooth(const Smoothing& smoothing, const Real& u, Real& friction) {
  using Part = Portion<Real>;
  on_lanes<Real>([&] {
    for (int p = 0; p < Part::count; ++p) {
      const auto& v = Part::of(u, p);
      Part::of(friction, p) =
          side_of(v) * shape<typename Part::Scalar>(smoothing.type, v / smoothing.width) * Part::of(friction, p);
    }
  });
}

template <class Real>
class SmoothedContact final : public Contact<Real> {
  using Part = Portion<Real>;
  using Scalar = typename Part::Scalar;

 public:
  SmoothedContact(std::unique_ptr<Contact<Real>> law, const Smoothing& smoothing)
      : law_(std::move(law)), smoothing_(smoothing) {}

  int unknowns() const override { return law_->unknowns(); }
  void evaluate(const ContactInput<Real>& in, const Real* z, Real* g, Real& F) const override {
    law_->evaluate(asked(in), z, g, F);
    smooth(smoothing_, in.slip_rate, F);
  }
  void linearise(const ContactInput<Real>& in, const Real* z, Real* g, Real& F, Slopes<Real>& slopes) const override {
    law_->linearise(asked(in), z, g, F, slopes);
    const int n = unknowns();
    on_lanes<Real>([&] {
      using Slope = Dual<Scalar, 1>;
      for (int p = 0; p < Part::count; ++p) {
        const Scalar& u = Part::of(in.slip_rate, p);
        const Slope S = shape(smoothing_.type, Slope::variable(u, 0) / Slope(smoothing_.width));
        const Scalar side = side_of(u), value = side * S.value, slope = side * S.slope[0];
        const auto part = [&](Real & x) __attribute__((always_inline))->Scalar& { return Part::of(x, p); };
        part(slopes.F_u) = value * part(slopes.F_u) + slope * part(F);
        part(slopes.F_N) = value * part(slopes.F_N);
        for (int i = 0; i < n; ++i) part(slopes.F_z[i]) = value * part(slopes.F_z[i]);
        part(F) = value * part(F);
      }
    });
  }
  void steady_friction(const Real& u, const Real& N, Real& mu) const override {
    law_->steady_friction(u, N, mu);  // on the side of u, and 0 at rest
    smooth(smoothing_, u, mu);
  }
  void mass(const Real& N, Real* m) const override { law_->mass(N, m); }
  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    law_->load(lane, parameters, setup);
  }
  void steady(int lane, double u, double N, double* z, double* weight) const override {
    law_->steady(lane, std::abs(u), N, z, weight);
  }
  void friction_slopes(int lane, double u, double N, double* slopes) const override {
    law_->friction_slopes(lane, std::abs(u), N, slopes);
    for (int i = 0; i < unknowns(); ++i) slopes[i] *= shape(smoothing_.type, u / smoothing_.width);
  }

 private:
  std::unique_ptr<Contact<Real>> law_;
  Smoothing smoothing_;
};

class SmoothedTower final : public ContactValues<Tower> {
 public:
  SmoothedTower(std::unique_ptr<ContactValues<Tower>> law, const Smoothing& smoothing)
      : law_(std::move(law)), smoothing_(smoothing) {}
  int unknowns() const override { return law_->unknowns(); }
  void evaluate(const ContactInput<Tower>& in, const Tower* z, Tower* g, Tower& F) const override {
    law_->evaluate(asked(in), z, g, F);
    smooth(smoothing_, in.slip_rate, F);
  }
  void mass(const Tower& N, Tower* m) const override { law_->mass(N, m); }

 private:
  std::unique_ptr<ContactValues<Tower>> law_;
  Smoothing smoothing_;
};

class SmoothedLaw final : public FrictionLaw {
 public:
  SmoothedLaw(std::shared_ptr<const FrictionLaw> law, const Smoothing& smoothing)
      : law_(std::move(law)), smoothing_(smoothing) {
    approximation_ = fmt::format("friction smoothed by {} over {} m/s: what would stick creeps",
                                 smoothing_names()[std::size_t(smoothing.type)], smoothing.width);
    if (!law_->approximation().empty()) approximation_ += fmt::format("; {}", law_->approximation());
  }

  const Card& card() const override { return law_->card(); }
  std::string_view approximation() const override { return approximation_; }
  const std::vector<Quantity>& parameters() const override { return law_->parameters(); }
  const std::vector<Quantity>& states() const override { return law_->states(); }
  const std::vector<Preset>& presets() const override { return law_->presets(); }
  const std::vector<Value>& values() const override { return law_->values(); }
  std::shared_ptr<const FrictionLaw> with(std::vector<Value> values) const override {
    return std::make_shared<SmoothedLaw>(law_->with(std::move(values)), smoothing_);
  }

  bool has_slip_rate() const override { return false; }
  bool set_valued() const override { return false; }

  double friction(Sliding<double> at, std::span<const double> state) const override {
    return part_at(at) * law_->friction(at, state);
  }
  std::vector<double> rate(Sliding<double> at, std::span<const double> state) const override {
    return law_->rate(at, state);
  }
  std::vector<double> steady(Sliding<double> at) const override { return law_->steady(at); }
  double slip_rate(double, double, std::span<const double>) const override {
    throw InputError(fmt::format("law '{}' has no explicit slip rate", card().name));
  }
  std::vector<double> rest(double normal_load) const override { return law_->rest(normal_load); }
  double static_limit(double, std::span<const double>) const override {
    throw InputError(fmt::format("law '{}' is smoothed and has no static limit", card().name));
  }
  std::vector<double> after_stop(std::span<const double> state) const override { return {state.begin(), state.end()}; }
  double kink(std::span<const double> state) const override { return law_->kink(state); }
  /// At 0, where μ(|v|) has its kink unless it is constant, and at the ends of the width, where S has one.
  double slip_kink(double v) const override {
    const double w = v / smoothing_.width, size = std::sqrt(1 + w * w);
    if (smoothing_.type == Smoothing::Type::linear || smoothing_.type == Smoothing::Type::parabolic)
      return w * (w * w - 1) / (size * size * size);
    const auto linear = law_->linear();
    return linear && linear->slope == 0 ? NAN : w / size;
  }
  Steady steady_friction(Sliding<double> at) const override {
    const auto [mu, slope] = law_->steady_friction(at);
    const auto S = shape(smoothing_.type,
                         Dual<double, 1>::variable(std::abs(at.slip_rate), 0) / Dual<double, 1>(smoothing_.width));
    return {S.value * mu, S.value * slope + S.slope[0] * std::abs(mu)};
  }
  std::unique_ptr<ContactFlow> flow() const override { refuse_flow(card()); }

 private:
  std::unique_ptr<Contact<double>> bare_contact(const ContactSetup& setup) const override {
    return std::make_unique<SmoothedContact<double>>(law_->contact(bare(setup)), smoothing_);
  }
  std::unique_ptr<Contact<Lanes>> bare_lanes(const ContactSetup& setup) const override {
    return std::make_unique<SmoothedContact<Lanes>>(law_->lanes(bare(setup)), smoothing_);
  }
  std::unique_ptr<ContactValues<Tower>> bare_tower(const ContactSetup& setup,
                                                   const ContactChange& change) const override {
    return std::make_unique<SmoothedTower>(law_->tower(bare(setup), change), smoothing_);
  }
  /// A series spring goes around the smoothed contact, not inside.
  static ContactSetup bare(ContactSetup setup) {
    setup.spring = {};
    setup.load_memory = 0;
    return setup;
  }
  /// The part of friction in motion that smoothing leaves.
  double part_at(Sliding<double> at) const { return shape(smoothing_.type, std::abs(at.slip_rate) / smoothing_.width); }

  std::shared_ptr<const FrictionLaw> law_;
  Smoothing smoothing_;
  std::string approximation_;
};

}  // namespace

std::span<const std::string_view> smoothing_names() {
  static constexpr std::string_view names[] = {"tanh", "arctan", "linear", "parabolic"};
  return names;
}

const Quantity& smoothing_width() {
  static const Quantity width{"solver.smoothing.width", "m/s", {1e-9, 1e3}, "slip rate over which friction rises"};
  return width;
}

std::shared_ptr<const FrictionLaw> smoothed(std::shared_ptr<const FrictionLaw> law, const Smoothing& smoothing) {
  if (!law->set_valued())
    throw InputError(
        fmt::format("solver.smoothing has no effect: law '{}' is smooth as it is; leave it out", law->card().name));
  const auto& width = smoothing_width();
  require(smoothing.width, width.range, width.name, width.meaning, width.unit);
  return std::make_shared<SmoothedLaw>(std::move(law), smoothing);
}

}  // namespace rosin::laws
