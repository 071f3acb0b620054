/// Modes of contacts at rest: consistent, unique where they must be, and followed through switches of several contacts.
#include "solvers/stick_slip/contact_balance.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numbers>
#include <random>
#include <vector>

#include "solvers/stick_slip/stick_slip_solver.hpp"

using namespace rosin;
using namespace rosin::solvers::stick_slip;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

/// Masses M on springs K before a belt of speed V, and contacts along the columns of T under dry friction:
/// M q̈ + K q = f + T F, slip rates w = V − Tᵀ q̇. Unknowns (q, w) with as many contacts as coordinates.
class DryContacts final : public SwitchingSystem {
 public:
  MatrixXd M, K, T;
  VectorXd f, static_limit, kinetic;
  double V = 1;
  std::vector<ContactMode> modes;

  explicit DryContacts(int n)
      : M(MatrixXd::Identity(n, n)),
        K(MatrixXd::Zero(n, n)),
        T(MatrixXd::Identity(n, n)),
        f(VectorXd::Zero(n)),
        static_limit(VectorXd::Ones(n)),
        kinetic(VectorXd::Ones(n)),
        modes(n, ContactMode::stick) {}

  int contacts() const override { return int(f.size()); }
  int size() const override { return 2 * contacts(); }
  ContactMode mode(int i) const override { return modes[i]; }
  void set_mode(int i, ContactMode mode) override { modes[i] = mode; }
  int slip_rate_unknown(int i) const override { return contacts() + i; }
  double displacement(int i, const double* y) const override { return y[i]; }
  double reference_speed(int) const override { return V; }
  void mass(double, double* m) const override { std::fill(m, m + size(), 1.0); }
  void scale(const double*, double* s) const override { std::fill(s, s + size(), 1.0); }
  std::string unknown(int i) const override { return i < contacts() ? "displacement" : "slip rate"; }
  bool autonomous() const override { return true; }

  /// Friction forces that keep the stuck from slipping while the others slip with kinetic friction.
  VectorXd friction(const VectorXd& q) const {
    const MatrixXd flexibility = T.transpose() * M.inverse() * T;
    VectorXd F(contacts()), free_of_stick = T.transpose() * M.inverse() * (f - K * q);
    std::vector<int> stuck;
    for (int i = 0; i < contacts(); ++i) {
      F[i] = sign(modes[i]) * kinetic[i];
      if (modes[i] == ContactMode::stick) stuck.push_back(i);
    }
    if (!stuck.empty()) {
      const VectorXd open = free_of_stick + flexibility * F;
      F(stuck) = -flexibility(stuck, stuck).llt().solve(open(stuck));
    }
    return F;
  }
  VectorXd slip_acceleration(const VectorXd& q) const {
    return -T.transpose() * M.inverse() * (f - K * q + T * friction(q));
  }
  void held(double, const double* y, Held* held) const override {
    const VectorXd F = friction(Eigen::Map<const VectorXd>(y, contacts()));
    for (int i = 0; i < contacts(); ++i) held[i] = {F[i], static_limit[i], 1e-14 * static_limit[i]};
  }
  void slip_accelerations(double, const double* y, double* acceleration) const override {
    Eigen::Map<VectorXd>(acceleration, contacts()) = slip_acceleration(Eigen::Map<const VectorXd>(y, contacts()));
  }
  void stop(int i, double* y) const override { y[slip_rate_unknown(i)] = 0; }
  void release(int, double, double*) const override {}

  void evaluate(double, const double* y, double* rate) const override {
    const int n = contacts();
    const Eigen::Map<const VectorXd> q(y, n), w(y + n, n);
    Eigen::Map<VectorXd>(rate, n) = T.transpose().inverse() * (VectorXd::Constant(n, V) - w);
    VectorXd a = slip_acceleration(q);
    for (int i = 0; i < n; ++i) rate[n + i] = modes[i] == ContactMode::stick ? 0 : a[i];
  }
  void linearise(double t, const double* y, double* rate, double* J) const override {
    evaluate(t, y, rate);
    // The equations of a mode are linear: differences are exact but for rounding.
    std::vector<double> at(y, y + size()), there(size());
    for (int j = 0; j < size(); ++j) {
      at[j] = y[j] + 1;
      evaluate(t, at.data(), there.data());
      for (int i = 0; i < size(); ++i) J[i * size() + j] = there[i] - rate[i];
      at[j] = y[j];
    }
  }
};

/// True if no stuck contact is overloaded and no slipping one accelerates against its direction.
bool consistent(const DryContacts& system) {
  const VectorXd q = VectorXd::Zero(system.contacts()), F = system.friction(q), a = system.slip_acceleration(q);
  for (int i = 0; i < system.contacts(); ++i) {
    if (system.modes[i] == ContactMode::stick && std::abs(F[i]) > system.static_limit[i] * (1 + 1e-12)) return false;
    if (system.modes[i] != ContactMode::stick && a[i] * sign(system.modes[i]) < -1e-12) return false;
  }
  return true;
}

DryContacts drawn(int n, double static_over_kinetic, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  DryContacts system(n);
  const MatrixXd A = MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
  system.M = A * A.transpose() + 0.1 * MatrixXd::Identity(n, n);
  system.f = 2 * VectorXd::NullaryExpr(n, [&] { return normal(random); });
  system.kinetic = VectorXd::NullaryExpr(n, [&] { return 0.2 + std::abs(normal(random)); });
  system.static_limit = static_over_kinetic * system.kinetic;
  return system;
}

}  // namespace

TEST_CASE("contacts at rest that share masses get consistent modes, the only ones where static is kinetic friction") {
  std::mt19937_64 random(4);
  int choices = 0, several = 0, cases = 0;
  for (const double ratio : {1.0, 1.5, 3.0})
    for (int n = 2; n <= 5; ++n)
      for (int draw = 0; draw < 60; ++draw, ++cases) {
        DryContacts system = drawn(n, ratio, random);
        const std::vector<double> y(system.size());
        std::vector<ContactMode> next(n);
        system.modes.assign(n, ContactMode::forward);
        const Balance balance = balance_contacts(system, 0, y.data(), std::vector<Ended>(n, Ended::slip), next);
        INFO("static over kinetic friction " << ratio << ", " << n << " contacts, draw " << draw);
        REQUIRE(balance.outcome.complete());
        CHECK(system.modes == std::vector<ContactMode>(n, ContactMode::forward));  // the trial leaves no trace
        system.modes = next;
        CHECK(consistent(system));
        choices += balance.had_choice;
        if (ratio == 1) CHECK(!balance.had_choice);
        int sets = 0, all = 1;
        for (int i = 0; i < n; ++i) all *= 3;
        for (int set = 0; set < all; ++set) {
          for (int i = 0, rest = set; i < n; ++i, rest /= 3) system.modes[i] = ContactMode(rest % 3 - 1);
          sets += consistent(system);
        }
        REQUIRE(sets >= 1);
        if (ratio == 1) CHECK(sets == 1);
        several += sets > 1;
      }
  CHECK(several > cases / 10);  // the rule does choose
  CHECK(choices > 0);
}

TEST_CASE("contacts on masses of their own decide alone") {
  DryContacts system(3);
  system.f << 0.5, 1.5, -2;
  const std::vector<double> y(6);
  std::vector<ContactMode> next(3);
  system.modes.assign(3, ContactMode::forward);
  REQUIRE(balance_contacts(system, 0, y.data(), std::vector<Ended>(3, Ended::slip), next).outcome.complete());
  // A pull along q is held by friction against it: the contact would slip backward, faster than the belt.
  CHECK(next == std::vector<ContactMode>{ContactMode::stick, ContactMode::backward, ContactMode::forward});
}

TEST_CASE("stick that has ended gives way though rounding leaves it below its limit") {
  DryContacts system(2);
  system.M << 2, 0.5, 0.5, 1;
  const std::vector<double> y(4);
  std::vector<ContactMode> next(2);
  const VectorXd F = VectorXd{{-(1 - 1e-15), -0.2}};
  system.f = -system.T * F;
  const std::vector<Ended> ended{Ended::stick, Ended::nothing};
  REQUIRE(balance_contacts(system, 0, y.data(), ended, next).outcome.complete());
  CHECK(next == std::vector<ContactMode>{ContactMode::backward, ContactMode::stick});
}

TEST_CASE("masses that do not touch switch when each would alone") {
  // m ẍ + k x = F: stick while k V t < static friction; slip then swings by (μs − μd)N/k and V/ω about μd N/k.
  DryContacts both(2);
  both.K.diagonal() << 1, 2.5;
  both.kinetic << 0.4, 0.7;
  StickSlip solver(both, 1e-10);
  REQUIRE(solver.start(0, std::vector<double>(4)));
  std::vector<double> onsets[2], stops[2];
  while (solver.time() < 20) {
    Switch switched;
    REQUIRE(solver.step(20, switched).complete());
    for (const auto& [contact, what] : solver.events())
      (what == Switch::slip ? onsets : stops)[contact].push_back(solver.time());
  }
  for (const int i : {0, 1}) {
    const double k = both.K(i, i), w = std::sqrt(k), drop = (1 - both.kinetic[i]) / k;
    const double slip_time = (2 * std::numbers::pi - 2 * std::atan2(drop, both.V / w)) / w,
                 stick_time = 2 * drop / both.V;
    REQUIRE(onsets[i].size() >= 3);
    CHECK(onsets[i][0] == Approx(1 / (k * both.V)).epsilon(1e-12));
    for (std::size_t j = 0; j < stops[i].size(); ++j)
      CHECK(stops[i][j] - onsets[i][j] == Approx(slip_time).epsilon(1e-8));
    for (std::size_t j = 1; j < onsets[i].size(); ++j)
      CHECK(onsets[i][j] - stops[i][j - 1] == Approx(stick_time).epsilon(1e-7));
  }
}

TEST_CASE("equal masses in step stay in step: their contacts switch in the same instant") {
  DryContacts chain(3);
  chain.K << 2, -1, 0, -1, 3, -1, 0, -1, 2;  // rows sum to 1: equal displacements feel a spring of 1 each
  chain.kinetic.setConstant(0.4);
  StickSlip solver(chain, 1e-10);
  REQUIRE(solver.start(0, std::vector<double>(6)));
  int switches = 0;
  while (solver.time() < 30) {
    Switch switched;
    REQUIRE(solver.step(30, switched).complete());
    if (switched == Switch::none) continue;
    ++switches;
    INFO("at t = " << solver.time());
    CHECK(solver.events().size() == 3);
    CHECK(solver.state()[1] == Approx(solver.state()[0]).epsilon(1e-9));
    CHECK(solver.state()[2] == Approx(solver.state()[0]).epsilon(1e-9));
  }
  CHECK(switches > 6);
  CHECK(solver.choices() == 0);
}
