/// Any contact with states that remember the load.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "laws/wrappers.hpp"

namespace rosin::laws {

namespace {

constexpr int most = Slopes<double>::capacity;

class MemoryContact final : public Contact<double> {
 public:
  MemoryContact(std::unique_ptr<Contact<double>> law, std::unique_ptr<Contact<double>> shape,
                std::vector<int> remembering, const ContactSetup& setup)
      : law_(std::move(law)),
        shape_(std::move(shape)),
        remembering_(std::move(remembering)),
        first_(setup.unknowns == Unknowns::friction ? 1 : 0),
        alpha_(setup.load_memory),
        lambda_(setup.lambda) {}

  int unknowns() const override { return law_->unknowns(); }

  void evaluate(const ContactInput<double>& in, const double* z, double* g, double& F) const override {
    double share[most];
    if (in.load_rate != 0) shares(own_slip_rate(in, z), in.normal_load, z + first_, share);
    law_->evaluate(in, z, g, F);
    add(in, share, g);
  }

  void linearise(const ContactInput<double>& in, const double* z, double* g, double& F,
                 Slopes<double>& slopes) const override {
    law_->linearise(in, z, g, F, slopes);
    if (in.load_rate == 0) return;
    const int n = unknowns(), states = n - first_;
    // Slip rate of the law, u − g₀ without the load rate's part in g₀, and its slopes.
    Slopes<double> quiet;
    double quiet_g[most], unused, v_z[most] = {}, v_u = 1, v_N = 0;
    law_->linearise({in.slip_rate, in.normal_load, 0, in.direction}, z, quiet_g, unused, quiet);
    double v = in.slip_rate;
    if (first_ == 1) {
      v -= quiet_g[0];
      v_u = 1 - quiet.g_u[0], v_N = -quiet.g_N[0];
      for (int j = 0; j < n; ++j) v_z[j] = -quiet.g_z[j];
    }
    double share[most], by_v[most], by_N[most], by_state[most];
    shares(v, in.normal_load, z + first_, share);
    // How shares change is a second derivative of friction, 0 for a + b ln θ: by differences of fourth order.
    const double* state = z + first_;
    const auto difference = [&](double step, auto&& at, double* slope) {
      double near[2][most], far[2][most];
      at(step, near[0]), at(-step, near[1]), at(2 * step, far[0]), at(-2 * step, far[1]);
      for (int i = 0; i < states; ++i)
        slope[i] = (8 * (near[0][i] - near[1][i]) - (far[0][i] - far[1][i])) / (12 * step);
    };
    constexpr double step = 1e-3;
    const double v_step = step * std::max(std::abs(v), 1e-300), N_step = step * in.normal_load;
    difference(
        v_step, [&](double h, double* p) { shares(v + h, in.normal_load, state, p); }, by_v);
    difference(
        N_step, [&](double h, double* p) { shares(v, in.normal_load + h, state, p); }, by_N);
    const double rate = lambda_ * alpha_ * in.load_rate / in.normal_load;
    for (int i = 0; i < states; ++i) {
      for (int j = 0; j < n; ++j) slopes.g_z[(first_ + i) * n + j] -= rate * by_v[i] * v_z[j];
      slopes.g_u[first_ + i] -= rate * by_v[i] * v_u;
      slopes.g_N[first_ + i] -= rate * (by_N[i] + by_v[i] * v_N - share[i] / in.normal_load);
    }
    for (int k = 0; k < states; ++k) {
      difference(
          step,
          [&](double h, double* p) {
            double moved[most];
            std::copy(state, state + states, moved);
            moved[k] += h;
            shares(v, in.normal_load, moved, p);
          },
          by_state);
      for (int i = 0; i < states; ++i) slopes.g_z[(first_ + i) * n + first_ + k] -= rate * by_state[i];
    }
    add(in, share, g);
  }

  void steady_friction(const double& u, const double& N, double& mu) const override { law_->steady_friction(u, N, mu); }
  void mass(const double& N, double* m) const override { law_->mass(N, m); }
  void load(int lane, std::span<const Value> parameters, const ContactSetup& setup) override {
    law_->load(lane, parameters, setup);
    shape_->load(lane, parameters, {.unknowns = Unknowns::states});
    alpha_ = setup.load_memory, lambda_ = setup.lambda;
  }
  void steady(int lane, double u, double N, double* z, double* weight) const override {
    law_->steady(lane, u, N, z, weight);
  }
  void friction_slopes(int lane, double u, double N, double* slopes) const override {
    law_->friction_slopes(lane, u, N, slopes);
  }

  /// dz/d(ln N) = −α·share, by the classical fourth-order method with twice as many steps until that changes no digit.
  void change_load(double v, double N, double changed, double* z) const override {
    if (N == changed) return;
    if (!(N > 0) || !(changed > 0))
      throw InputError("law.load_memory: the load must stay above 0 N, where its logarithm has no value");
    refuse_what_no_state_carries(v, N, changed, z + first_);
    const int states = unknowns() - first_;
    constexpr double largest = 0.02, digits = 1e-14;  // of ln N; of a state, as a logarithm
    constexpr int most_steps = 1 << 20;
    double* state = z + first_;
    double now[most], before[most];
    std::fill(before, before + most, infinity);
    bool known = false;
    for (int steps = int(std::ceil(std::abs(std::log(changed / N)) / largest)); !known; steps *= 2) {
      if (steps > most_steps)
        throw InputError(fmt::format("law.load_memory: states cannot follow the load from {} to {} N", N, changed));
      std::copy(state, state + states, now);
      change_load_in(steps, v, N, std::log(changed / N), now);
      known = true;
      for (int i = 0; i < states; ++i)
        known = known && std::abs(now[i] - before[i]) <= 15 * digits * (1 + std::abs(now[i]));
      std::copy(now, now + states, before);
    }
    std::copy(now, now + states, state);
  }

 private:
  void change_load_in(int steps, double v, double N, double logarithm, double* state) const {
    const int states = unknowns() - first_;
    const double h = logarithm / steps;
    double k[4][most], at[most];
    for (int step = 0; step < steps; ++step)
      for (int stage = 0; stage < 4; ++stage) {
        constexpr double node[] = {0, 0.5, 0.5, 1};
        for (int i = 0; i < states; ++i)
          at[i] = state[i] - (stage == 0 ? 0 : alpha_ * h * node[stage] * k[stage - 1][i]);
        shares(v, N * std::exp(h * (step + node[stage])), at, k[stage]);
        if (stage == 3)
          for (int i = 0; i < states; ++i) state[i] -= alpha_ * h * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]) / 6;
      }
  }
  /// Friction falls by way of the states no lower than where none of their contacts is left.
  void refuse_what_no_state_carries(double v, double N, double changed, const double* state) const {
    const double fall = alpha_ * std::log(changed / N);
    double empty[most];
    std::copy(state, state + unknowns() - first_, empty);
    constexpr double nothing = -700;  // the logarithm of what is left
    for (const int i : remembering_) empty[i] = nothing;
    const double most_fall = coefficient(v, N, state) - coefficient(v, N, empty);
    if (fall < most_fall || fall <= 0) return;
    throw InputError(fmt::format(
        "law.load_memory: as the load rises from {} to {} N, friction should fall by alpha ln(N'/N) = {:.4g}, "
        "but the state carries {:.4g} at most; lower law.load_memory.alpha, {}, or the rise of drive.normal_load",
        N, changed, fall, most_fall, alpha_));
  }
  double coefficient(double v, double N, const double* state) const {
    double g[most], F;
    shape_->evaluate({v, N, 0, 1}, state, g, F);
    return F / N;
  }
  double own_slip_rate(const ContactInput<double>& in, const double* z) const {
    if (first_ == 0) return in.slip_rate;
    double g[most], F;
    law_->evaluate({in.slip_rate, in.normal_load, 0, in.direction}, z, g, F);
    return in.slip_rate - g[0];
  }
  /// The least change of the state unknowns that raises friction by 1 at slip rate v: s/|s|², s = ∂μ/∂z.
  void shares(double v, double N, const double* state, double* share) const {
    double g[most], F, square = 0;
    Slopes<double> slopes;
    shape_->linearise({v, N, 0, 1}, state, g, F, slopes);
    std::fill(share, share + most, 0.0);
    for (const int i : remembering_) square += (slopes.F_z[i] / N) * (slopes.F_z[i] / N);
    if (square > 0)
      for (const int i : remembering_) share[i] = slopes.F_z[i] / N / square;
  }
  void add(const ContactInput<double>& in, const double* share, double* g) const {
    if (in.load_rate == 0) return;
    for (int i = 0; i < unknowns() - first_; ++i)
      g[first_ + i] -= lambda_ * alpha_ * (in.load_rate / in.normal_load) * share[i];
  }

  std::unique_ptr<Contact<double>> law_, shape_;
  std::vector<int> remembering_;  ///< among the states
  int first_;                     ///< the first state among the unknowns
  double alpha_, lambda_;
};

}  // namespace

std::unique_ptr<Contact<double>> with_load_memory(std::unique_ptr<Contact<double>> law,
                                                  std::unique_ptr<Contact<double>> shape, std::vector<int> remembering,
                                                  const ContactSetup& setup) {
  return std::make_unique<MemoryContact>(std::move(law), std::move(shape), std::move(remembering), setup);
}

}  // namespace rosin::laws
