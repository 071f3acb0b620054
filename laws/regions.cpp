/// Friction of slip beyond a width, as a law around a law, and how it goes on within the width.
#include "laws/regions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "laws/smoothing.hpp"

namespace rosin::laws {

namespace {

/// The slip rate that the law is asked at: within the width that of slip which has only just begun.
double beyond(double v, double width) {
  constexpr double just_begun = 1e-300;
  return std::copysign(std::max(std::abs(v) - width, just_begun), v);
}

class RegionContact final : public Contact<double> {
 public:
  RegionContact(std::unique_ptr<Contact<double>> law, double width) : law_(std::move(law)), width_(width) {}

  int unknowns() const override { return law_->unknowns(); }
  void evaluate(const ContactInput<double>& in, const double* z, double* g, double& F) const override {
    law_->evaluate(asked(in), z, g, F);
  }
  void linearise(const ContactInput<double>& in, const double* z, double* g, double& F,
                 Slopes<double>& slopes) const override {
    law_->linearise(asked(in), z, g, F, slopes);
    if (std::abs(in.slip_rate) < width_) slopes.F_u = 0;
  }
  void steady_friction(const double& u, const double& N, double& mu) const override {
    law_->steady_friction(beyond(u, width_), N, mu);
    mu = std::copysign(mu, u);
  }
  void mass(const double& N, double* m) const override { law_->mass(N, m); }
  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    law_->load(lane, parameters, setup);
  }
  void steady(int lane, double u, double N, double* z, double* weight) const override {
    law_->steady(lane, std::abs(u), N, z, weight);
  }
  void friction_slopes(int, double, double, double*) const override {}

 private:
  ContactInput<double> asked(ContactInput<double> in) const {
    in.slip_rate = beyond(in.slip_rate, width_);
    in.direction = std::copysign(1.0, in.slip_rate);
    return in;
  }
  std::unique_ptr<Contact<double>> law_;
  double width_;
};

class RegionLaw final : public FrictionLaw {
 public:
  RegionLaw(std::shared_ptr<const FrictionLaw> law, double width)
      : law_(std::move(law)),
        width_(width),
        approximation_(fmt::format(
            "friction smoothed by regions over {} m/s: what would stick creeps, ever more slowly", width)) {}
  double width() const { return width_; }

  const Card& card() const override { return law_->card(); }
  std::string_view approximation() const override { return approximation_; }
  const std::vector<Quantity>& parameters() const override { return law_->parameters(); }
  const std::vector<Quantity>& states() const override { return law_->states(); }
  const std::vector<Preset>& presets() const override { return law_->presets(); }
  const std::vector<Value>& values() const override { return law_->values(); }
  std::shared_ptr<const FrictionLaw> with(std::vector<Value> values) const override {
    return std::make_shared<RegionLaw>(law_->with(std::move(values)), width_);
  }
  bool has_slip_rate() const override { return false; }
  bool set_valued() const override { return false; }
  double friction(Sliding<double> at, std::span<const double> state) const override {
    return law_->friction({beyond(at.slip_rate, width_), at.normal_load}, state);
  }
  std::vector<double> rate(Sliding<double>, std::span<const double>) const override { return {}; }
  std::vector<double> steady(Sliding<double>) const override { return {}; }
  double slip_rate(double, double, std::span<const double>) const override {
    throw InputError(fmt::format("law '{}' has no explicit slip rate", card().name));
  }
  std::vector<double> rest(double) const override { return {}; }
  double static_limit(double, std::span<const double>) const override {
    throw InputError(fmt::format("law '{}' is smoothed and has no static limit", card().name));
  }
  std::vector<double> after_stop(std::span<const double>) const override { return {}; }
  /// At 0, where A sgn v has its kink, and at the ends of the width.
  double slip_kink(double v) const override {
    const double w = v / width_, size = std::sqrt(1 + w * w);
    return w * (w * w - 1) / (size * size * size);
  }
  Steady steady_friction(Sliding<double> at) const override {
    auto [mu, slope] = law_->steady_friction({beyond(at.slip_rate, width_), at.normal_load});
    return {mu, std::abs(at.slip_rate) < width_ ? 0 : slope};
  }
  std::unique_ptr<ContactFlow> flow() const override { refuse_flow(card()); }

 private:
  std::unique_ptr<Contact<double>> bare_contact(const ContactSetup& setup) const override {
    auto bare = setup;
    bare.spring = {};
    return std::make_unique<RegionContact>(law_->contact(bare), width_);
  }
  std::unique_ptr<Contact<Lanes>> bare_lanes(const ContactSetup&) const override { refuse(); }
  std::unique_ptr<ContactValues<Tower>> bare_tower(const ContactSetup&, const ContactChange&) const override {
    refuse();
  }
  [[noreturn]] static void refuse() {
    throw InputError(
        "solver.smoothing.type = 'multi-region' needs the force that would hold a contact, which lanes and higher "
        "derivatives are not told");
  }

  std::shared_ptr<const FrictionLaw> law_;
  double width_;
  std::string approximation_;
};

}  // namespace

std::shared_ptr<const FrictionLaw> by_regions(std::shared_ptr<const FrictionLaw> law, double width) {
  if (!law->set_valued() || law->has_states())
    throw InputError(fmt::format(
        "solver.smoothing.type = 'multi-region' takes set-valued laws without states, not '{}'; use another type",
        law->card().name));
  const auto& quantity = smoothing_width();
  require(width, quantity.range, quantity.name, quantity.meaning, quantity.unit);
  return std::make_shared<RegionLaw>(std::move(law), width);
}

double region_width(const FrictionLaw& law) {
  const auto* regions = dynamic_cast<const RegionLaw*>(&law);
  return regions ? regions->width() : 0;
}

RegionFriction region_friction(double v, double width, double slip, double holding) {
  const double w = std::min(std::abs(v) / width, 1.0), part = w * w * (3 - 2 * w), limit = std::abs(slip);
  const bool holds = std::abs(holding) < limit;
  const double side = std::copysign(1.0, slip) * std::copysign(1.0, holding), S = holds ? holding : side * slip;
  return {S + part * (slip - S), holds ? part : part + (1 - part) * side,
          std::copysign(6 * w * (1 - w) / width, v) * (slip - S), holds ? 1 - part : 0};
}

}  // namespace rosin::laws
