/// Dry friction behind a spring and a damper: an elastic-perfectly-plastic contact.
#include <algorithm>

#include "laws/wrappers.hpp"

namespace rosin::laws {

namespace {

class DrySpringContact final : public Contact<double> {
 public:
  DrySpringContact(std::unique_ptr<Contact<double>> law, const ContactSetup& setup)
      : law_(std::move(law)), spring_(setup.spring) {}

  int unknowns() const override { return 1; }

  void evaluate(const ContactInput<double>& in, const double* z, double* g, double& F) const override {
    const double N = in.normal_load;
    if (in.direction == 0) {
      g[0] = in.slip_rate;
      F = stiffness(N) * z[0] + damping(N) * in.slip_rate;
      return;
    }
    law_->evaluate(in, nullptr, nullptr, F);
    g[0] = damped() ? (F - stiffness(N) * z[0]) / damping(N) : relaxed(in, F) - z[0];
  }

  void linearise(const ContactInput<double>& in, const double* z, double* g, double& F,
                 Slopes<double>& slopes) const override {
    evaluate(in, z, g, F);
    const double N = carried(in.normal_load), k = stiffness(N), c = damping(N);
    const double of_load = spring_.compliance_per_load;
    const double k_N = of_load == 0 ? 0 : (k / N) * (k / N) * of_load, c_N = spring_.damping_per_load;
    if (in.direction == 0) {
      slopes.g_z[0] = slopes.g_N[0] = 0, slopes.g_u[0] = 1;
      slopes.F_z[0] = k, slopes.F_u = c, slopes.F_N = k_N * z[0] + c_N * in.slip_rate;
      return;
    }
    Slopes<double> of_law;
    law_->linearise(in, nullptr, nullptr, F, of_law);
    slopes.F_z[0] = slopes.F_u = slopes.g_u[0] = 0, slopes.F_N = of_law.F_N;
    slopes.g_z[0] = damped() ? -k / c : -1;
    slopes.g_N[0] = damped() ? (of_law.F_N - k_N * z[0] - g[0] * c_N) / c : of_law.F_N * spring_.compliance;
  }

  void steady_friction(const double& u, const double& N, double& mu) const override { law_->steady_friction(u, N, mu); }

  void mass(const double&, double* m) const override { m[0] = 1; }

  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    law_->load(lane, parameters, setup);
    spring_ = setup.spring;
  }

  void steady(int, double u, double N, double* z, double* weight) const override {
    double mu;
    law_->steady_friction(u, N, mu);
    constexpr double least = 0.1;  // coefficient by which a contact without friction is measured
    const double of_one = compliance(N) * carried(N);
    z[0] = mu * of_one, weight[0] = std::max(std::abs(mu), least) * of_one;
  }

  void friction_slopes(int, double, double, double*) const override {}

 private:
  static double carried(double N) { return std::max(N, 1e-300); }
  double compliance(double N) const { return spring_.compliance + spring_.compliance_per_load / carried(N); }
  double stiffness(double N) const { return 1 / compliance(N); }
  double damping(double N) const { return spring_.damping + spring_.damping_per_load * carried(N); }
  bool damped() const { return spring_.damping > 0 || spring_.damping_per_load > 0; }
  /// Deflection under the force of slip: with a stiffness that scales with the load it does not depend on it.
  double relaxed(const ContactInput<double>& in, double F) const {
    double mu = F / carried(in.normal_load);
    if (in.normal_load <= 0) law_->steady_friction(in.direction, 1, mu);
    return mu * (spring_.compliance * in.normal_load + spring_.compliance_per_load);
  }

  std::unique_ptr<Contact<double>> law_;
  SeriesSpring spring_;
};

}  // namespace

std::unique_ptr<Contact<double>> dry_behind_spring(std::unique_ptr<Contact<double>> law, const ContactSetup& setup) {
  return std::make_unique<DrySpringContact>(std::move(law), setup);
}

}  // namespace rosin::laws
