/// Two-exponential friction curve: the steady sliding friction of violin rosin.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

template <class Real = double>
struct TwoExponential {
  static constexpr Card card{
      .name = "two-exponential",
      .title = "Two-exponential friction curve",
      .formula = R"(\mu = \mu_\infty + \mu_1 e^{-|v|/v_1} + \mu_2 e^{-|v|/v_2},\quad
|F| \le (\mu_\infty + \mu_1 + \mu_2) N \text{ at } v = 0)",
      .source = "Smith & Woodhouse (2000)",
      .limits = "friction follows speed at once; measured in steady sliding, refuted for rosin by every dynamic test"};

  Real mu_inf = 0.35, mu_1 = 0.4, v_1 = 0.01, mu_2 = 0.45, v_2 = 0.1;
  static constexpr auto parameters =
      table(field(&TwoExponential::mu_inf, "mu_inf", "1", {0, 10}, "friction at high speed"),
            field(&TwoExponential::mu_1, "mu_1", "1", {0, 10}, "part that decays over v_1"),
            field(&TwoExponential::v_1, "v_1", "m/s", {1e-12, 1e3}, "first decay speed"),
            field(&TwoExponential::mu_2, "mu_2", "1", {0, 10}, "part that decays over v_2"),
            field(&TwoExponential::v_2, "v_2", "m/s", {1e-12, 1e3}, "second decay speed"));

  struct Published {
    std::string_view name, source;
    TwoExponential law;
  };
  static std::vector<Published> presets() { return {{"violin-rosin", "Smith & Woodhouse (2000)", TwoExponential{}}}; }

  Real friction(Sliding<Real> at) const {
    return mu_inf + mu_1 * exp(-at.slip_rate / v_1) + mu_2 * exp(-at.slip_rate / v_2);
  }
  Real static_limit(Sliding<Real>) const { return mu_inf + mu_1 + mu_2; }
};

}  // namespace rosin::laws
