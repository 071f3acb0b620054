/// Friction against temperature out of friction against slip rate, and the kernels of the thermal laws.
#include "laws/heat_flow.hpp"

#include <cmath>

#include "laws/heated_curve.hpp"

namespace rosin::laws {

HeatedFriction::HeatedFriction(const FrictionLaw& law, double h0, double h1) {
  const auto value = [&](const char* name) { return law.parameter(name); };
  const HeatedCurve<double> curve{value("mu_inf"), value("mu_1"), value("v_1"), value("mu_2"), value("v_2"), h0, h1};
  constexpr int points = 2048;
  // Of fastest sliding, or, if nothing is swept away and heat knows no end, of sliding at which the curve has ended.
  const double fast = 40 * std::max(curve.v_1, curve.v_2);
  const double hottest = h1 > 0 ? curve.mu_inf / h1 : curve.mu_inf * fast / h0;
  per_kelvin_ = hottest > 0 ? points / hottest : 0;
  double w = 0;
  for (int i = 0; i <= points && hottest > 0; ++i) {
    const double rise = hottest * i / points;
    const auto at = [&](double w) { return curve.friction(w) * w / (h0 + h1 * w) - rise; };
    double low = w, high = std::max(2 * w, curve.v_1);
    while (at(high) < 0 && high < 1e3 * fast) low = high, high *= 2;
    constexpr int halvings = 100;
    for (int k = 0; k < halvings; ++k) {
      const double middle = 0.5 * (low + high);
      (at(middle) < 0 ? low : high) = middle;
    }
    w = low;
    // dμ/dϑ = (dμ/dw)/(dϑ/dw), with dϑ/dw = rise_slope/(h₀ + h₁w)².
    const auto here = curve.at(w);
    const double slope = w > 0 ? here.fall / w : -(curve.mu_1 / curve.v_1 + curve.mu_2 / curve.v_2);
    const double spread = h0 + h1 * w;
    points_.push_back({here.friction, slope * spread * spread / here.rise_slope / per_kelvin_});
  }
  if (points_.empty()) points_.push_back({curve.friction(0), 0});
  points_.back() = {std::min(points_.back().friction, curve.friction(fast)), 0};
  last_ = double(points_.size() - 1);
  points_.push_back(points_.back());  // beyond the hottest
}

double HeatFlow::crowding(double normal_load) const {
  return std::pow(normal_load / N_ref, 1 - area_exponent + 0.5 * size_exponent);
}
double HeatFlow::relaxation(std::size_t mode, double normal_load) const {
  return modes[mode].time * time * std::pow(normal_load / N_ref, size_exponent);
}

std::optional<HeatFlow> heat_flow(const FrictionLaw& law) {
  const auto name = law.card().name;
  const bool is_lump = name == "thermal", is_disc = name == "thermal-disc", is_layer = name == "thermal-layer";
  if (!is_lump && !is_disc && !is_layer) return std::nullopt;
  HeatFlow flow;
  flow.h0 = law.parameter("h0"), flow.h1 = law.parameter("h1");
  flow.time = is_lump ? law.parameter("C") / flow.h0 : law.parameter("time");
  if (is_lump)
    flow.modes = lump;
  else if (is_disc)
    flow.modes = disc;
  else
    flow.modes = layered_disc;
  flow.area_exponent = law.parameter("area_exponent");
  flow.size_exponent = is_disc ? law.parameter("size_exponent") : 0;
  flow.N_ref = law.parameter("N_ref");
  flow.friction = std::make_shared<const HeatedFriction>(law, flow.h0, flow.h1);
  return flow;
}

}  // namespace rosin::laws
