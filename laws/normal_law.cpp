/// The normal laws, asked.
#include "laws/normal_law.hpp"

#include <algorithm>
#include <cmath>

namespace rosin::laws {

namespace {

class Linear final : public NormalLaw {
 public:
  explicit Linear(const LinearContact& law) : law_(law) {}
  const Card& card() const override { return LinearContact::card; }
  NormalAnswer at(double a, double rate, double preload) const override {
    const double p = preload + (law_.stiffness + law_.cubic * a * a) * a + law_.damping * rate;
    if (law_.lift_off && !(p > 0)) return {};
    const double by_approach = law_.stiffness + 3 * law_.cubic * a * a;
    return {p, by_approach, law_.damping, p, by_approach, law_.damping};
  }
  /// Counted from where the preload presses.
  double approach_under(double) const override { return 0; }
  double elastic_energy(double a) const override { return (law_.stiffness + law_.cubic * a * a / 2) * a * a / 2; }
  double kink(double a, double rate, double, double, double preload) const override {
    if (!law_.lift_off || preload == 0) return NAN;
    return 1 + ((law_.stiffness + law_.cubic * a * a) * a + law_.damping * rate) / preload;
  }

 private:
  LinearContact law_;
};

class Power final : public NormalLaw {
 public:
  explicit Power(const PowerContact& law) : law_(law) {
    const auto positive = [](double x, const char* name) {
      require(x, {0, infinity}, name, "of a power-law contact", "of its exponent");
    };
    require(law.exponent, PowerContact::exponents, "exponent", "of the contact's pressure", "1");
    require(law.damping_exponent, PowerContact::damping_exponents, "damping_exponent", "of the contact's damping", "1");
    require(law.bound_exponent, PowerContact::exponents, "bound_exponent", "of the bound of friction", "1");
    positive(law.coefficient, "coefficient"), positive(law.bound_coefficient, "bound_coefficient");
    positive(law.damping, "damping"), positive(law.separation_damping, "separation_damping");
  }
  const Card& card() const override { return PowerContact::card; }
  NormalAnswer at(double a, double rate, double) const override {
    if (!(a > 0)) return {};
    const double elastic = law_.coefficient * std::pow(a, law_.exponent);
    // At rest the slope by the rate is that of a small oscillation's first harmonic.
    const double b = rate > 0   ? law_.damping
                     : rate < 0 ? law_.separation_damping
                                : 0.5 * (law_.damping + law_.separation_damping);
    const double damping = b == 0 ? 0 : b * std::pow(a, law_.damping_exponent);
    NormalAnswer answer;
    answer.pressure = elastic + damping * rate;
    answer.pressure_by_approach = (law_.exponent * elastic + law_.damping_exponent * damping * rate) / a;
    answer.pressure_by_rate = damping;
    if (answer.pressure < 0 && !law_.adhesion) answer = {};
    if (law_.bound_of_pressure) {
      if (answer.pressure < 0) return answer;  // what is pulled has no friction
      answer.bound = answer.pressure, answer.bound_by_approach = answer.pressure_by_approach;
      answer.bound_by_rate = answer.pressure_by_rate;
    } else {
      const bool same = law_.bound_exponent == law_.exponent && law_.bound_coefficient == law_.coefficient;
      answer.bound = same ? elastic : law_.bound_coefficient * std::pow(a, law_.bound_exponent);
      answer.bound_by_approach = law_.bound_exponent * answer.bound / a;
    }
    return answer;
  }
  double approach_under(double preload) const override {
    return std::pow(std::max(preload, 0.0) / law_.coefficient, 1 / law_.exponent);
  }
  double elastic_energy(double a) const override {
    return a > 0 ? law_.coefficient * std::pow(a, law_.exponent + 1) / (law_.exponent + 1) : 0;
  }
  bool is_smooth_beside_kink() const override {
    const auto whole = [](double exponent) { return exponent == std::round(exponent); };
    return whole(law_.exponent) && (law_.damping == 0 || whole(law_.damping_exponent)) && whole(law_.bound_exponent);
  }
  /// At touching, and where damping differs between approach and separation.
  double kink(double a, double rate, double approach_size, double rate_size, double) const override {
    const double touching = a / approach_size;
    return law_.damping == law_.separation_damping ? touching : touching * rate / rate_size;
  }

 private:
  PowerContact law_;
};

}  // namespace

std::shared_ptr<const NormalLaw> normal_law(const LinearContact& law) { return std::make_shared<Linear>(law); }
std::shared_ptr<const NormalLaw> normal_law(const PowerContact& law) { return std::make_shared<Power>(law); }

}  // namespace rosin::laws
