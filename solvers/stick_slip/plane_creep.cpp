/// The equations of the mass and its contact, and their steps between breaks of the drive.
#include "solvers/stick_slip/plane_creep.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/stop.hpp"

namespace rosin::solvers::stick_slip {

namespace {
enum Place { x_0, x_1, u_0, u_1, contact_0 };
enum Account { rubbed, path, supply, accounts };

double speed_of(const PlaneMass& mass, double scale) {
  constexpr double part = 1e-4;
  const double V = length<2>(mass.surface_velocity);
  return V > 0 ? V : part * scale;
}

/// The largest steady friction at speeds up to that of the surface, or to what forces make, N.
double largest_friction(const PlaneMass& mass, const PlaneFriction& friction) {
  const double N = mass.load.level(), slowest = std::sqrt(std::min(mass.stiffness[0], mass.stiffness[1]) / mass.mass);
  double force = 0, fast = length<2>(mass.surface_velocity);
  for (const auto& f : mass.force) {
    force += std::abs(f.level());
    for (const auto& term : f.piece(0).terms) force += std::abs(term.amplitude);
  }
  fast = std::max(fast, force / (mass.mass * slowest));
  double largest = 0, mu;
  const auto include = [&](double speed) {
    friction.contact->steady_friction(speed, N, mu);
    if (std::isfinite(mu)) largest = std::max(largest, mu * N);
  };
  for (double speed = 1e-9; speed < fast; speed *= 10) include(speed);
  if (fast > 0) include(fast);
  return largest;
}
}  // namespace

/// Unknowns x, u and those of the contact, then work and distance so far.
class PlaneCreep::Motion final : public System {
 public:
  Motion(const PlaneCreep& of) : of_(of), mass_(of.mass_), contact_(of.contact_), n_(of.contact_.unknowns()) {
    const double N = mass_.load.level(), V = of.reference_speed_, m = mass_.mass;
    constexpr double usual = 0.1;  // friction that counts
    for (int d = 0; d < 2; ++d)
      displacement_scale_[d] = V * std::sqrt(m / mass_.stiffness[d]) + usual * N / mass_.stiffness[d];
  }

  int size() const override { return contact_0 + n_ + accounts; }
  void mass(double t, double* m) const override {
    std::fill(m, m + size(), 1.0);
    m[u_0] = m[u_1] = mass_.mass;
    contact_.mass(mass_.load.value(t), m + contact_0);
  }
  void evaluate(double t, const double* y, double* f) const override { rates(t, y, f, nullptr); }
  void linearise(double t, const double* y, double* f, double* jacobian) const override { rates(t, y, f, jacobian); }
  void scale(const double* y, double* s) const override {
    for (int d = 0; d < 2; ++d) {
      s[x_0 + d] = displacement_scale_[d];
      s[u_0 + d] = std::max(of_.reference_speed_, std::hypot(y[u_0], y[u_1]));
    }
    for (int i = 0; i < n_; ++i) s[contact_0 + i] = contact_.weight()[i];
    if (const int k = contact_.friction().turning; k >= 0) {
      const double *z = y + contact_0 + k, size = std::hypot(z[0], z[1]);
      constexpr double own = 0.01;  // friction that nearly vanishes in steady sliding may be large elsewhere
      for (int d = 0; d < 2; ++d) s[contact_0 + k + d] = std::max(contact_.weight()[k], own * size);
    }
    const double speed = of_.speed_scale_, energy = mass_.mass * speed * speed;
    const double sizes[] = {energy, speed / of_.fastest_, energy};
    std::copy(sizes, sizes + accounts, s + contact_0 + n_);
  }
  std::string unknown(int i) const override {
    static const char* of_mass[] = {"displacement 1", "displacement 2", "slip rate 1", "slip rate 2"};
    static const char* of_account[] = {"friction work", "path", "work of forces"};
    if (i < contact_0) return of_mass[i];
    if (i >= contact_0 + n_) return of_account[i - contact_0 - n_];
    return "unknown " + std::to_string(i - contact_0 + 1) + " of the contact";
  }
  double resolution() const override {
    return std::min({mass_.load.resolution(), mass_.force[0].resolution(), mass_.force[1].resolution()});
  }
  void kinks(double t, const double* y, std::vector<double>& values) const override {
    const auto& friction = contact_.friction();
    const double u = std::hypot(y[u_0], y[u_1]);
    values.assign({friction.slip_kink ? friction.slip_kink(u) : NAN,
                   friction.state_kink ? friction.state_kink(y + contact_0) : NAN,
                   of_.stick_speed_ > 0 ? u / of_.stick_speed_ - 1 : NAN, approach(t, y)});
  }

 private:
  void rates(double t, const double* y, double* f, double* jacobian) const {
    const int n = size(), account = contact_0 + n_;
    const auto& V = mass_.surface_velocity;
    const PlaneVector u = {y[u_0], y[u_1]};
    const double s = std::hypot(u[0], u[1]);
    PlaneVector F;
    PlaneContact::PlaneSlopes slopes = {};
    contact_.evaluate(u, mass_.load.value(t), y + contact_0, f + contact_0, F, jacobian ? &slopes : nullptr);
    f[account + rubbed] = dot<2>(F, u), f[account + path] = s, f[account + supply] = 0;
    for (int d = 0; d < 2; ++d) {
      const double v = V[d] - u[d], c = mass_.damping[d], force = mass_.force[d].value(t);
      f[x_0 + d] = v;
      f[u_0 + d] = mass_.stiffness[d] * y[x_0 + d] + c * v - F[d] - force;
      f[account + supply] += (force - c * v) * v + F[d] * V[d];
    }
    if (!jacobian) return;
    std::fill(jacobian, jacobian + n * n, 0.0);
    const auto J = [&](int i, int j) -> double& { return jacobian[i * n + j]; };
    for (int d = 0; d < 2; ++d) {
      const double v = V[d] - u[d], c = mass_.damping[d], force = mass_.force[d].value(t);
      J(x_0 + d, u_0 + d) = -1;
      J(u_0 + d, x_0 + d) = mass_.stiffness[d];
      J(u_0 + d, u_0 + d) = -c;
      J(account + rubbed, u_0 + d) = F[d];
      J(account + path, u_0 + d) = s > 0 ? u[d] / s : 0;
      J(account + supply, u_0 + d) = 2 * c * v - force;
    }
    const auto by_friction = [&](int column, const auto& F_slope) {  // F_slope(d): ∂F_d by the unknown of the column
      for (int d = 0; d < 2; ++d) {
        J(u_0 + d, column) -= F_slope(d);
        J(account + rubbed, column) += F_slope(d) * u[d];
        J(account + supply, column) += F_slope(d) * V[d];
      }
    };
    for (int b = 0; b < 2; ++b) by_friction(u_0 + b, [&](int d) { return slopes.F_u[d][b]; });
    for (int j = 0; j < n_; ++j) by_friction(contact_0 + j, [&](int d) { return slopes.F_z[d][j]; });
    for (int i = 0; i < n_; ++i) {
      for (int b = 0; b < 2; ++b) J(contact_0 + i, u_0 + b) = slopes.g_u[i][b];
      for (int j = 0; j < n_; ++j) J(contact_0 + i, contact_0 + j) = slopes.g_z[i][j];
    }
  }

  /// The cosine between slip rate and its change: it changes sign where slip is nearest to rest, in whose neighbourhood
  /// |u| bends sharply, and at rest itself where motion goes along a line. At rest, and where forces balance but for
  /// rounding, 1.
  double approach(double t, const double* y) const {
    const PlaneVector u = {y[u_0], y[u_1]};
    PlaneVector F, change;
    double g[PlaneContact::capacity], size = 0;
    contact_.evaluate(u, mass_.load.value(t), y + contact_0, g, F, nullptr);
    for (int d = 0; d < 2; ++d) {
      const double spring = mass_.stiffness[d] * y[x_0 + d],
                   damper = mass_.damping[d] * (mass_.surface_velocity[d] - u[d]), force = mass_.force[d].value(t);
      change[d] = spring + damper - F[d] - force;
      size += std::abs(spring) + std::abs(damper) + std::abs(F[d]) + std::abs(force);
    }
    constexpr double rounding = 1e-10;
    const double s = length<2>(u), rate = length<2>(change);
    return s > 0 && rate > rounding * size ? dot<2>(u, change) / s / rate : 1;
  }

  const PlaneCreep& of_;
  const PlaneMass& mass_;
  const PlaneContact& contact_;
  int n_;  ///< unknowns of the contact
  double displacement_scale_[2];
};

PlaneCreep::PlaneCreep(PlaneMass mass, PlaneFriction friction, double tolerance, double stick_threshold)
    : PlaneSolver(mass, largest_friction(mass, friction)),
      reference_speed_(speed_of(mass_, speed_scale_)),
      stick_speed_(stick_threshold * reference_speed_),
      contact_(std::move(friction), reference_speed_, mass_.load.level()),
      motion_(std::make_unique<Motion>(*this)),
      collocation_(std::make_unique<steps::Collocation>(*motion_, tolerance)) {
  collocation_->resolve_starts();
  if (const auto& near_rest = contact_.friction().near_rest) near_rest_ = near_rest(reference_speed_);
}
PlaneCreep::~PlaneCreep() = default;

long PlaneCreep::steps() const { return collocation_->count().steps; }

int PlaneCreep::parts() const { return steps::Collocation::stages; }

std::vector<double> PlaneCreep::sizes() const {
  std::vector<double> y(motion_->size()), s(motion_->size());
  motion_->scale(y.data(), s.data());
  s.resize(s.size() - accounts);
  return s;
}

void PlaneCreep::take(const std::vector<double>& y) {
  const auto& V = mass_.surface_velocity;
  const auto* account = y.data() + y.size() - accounts;
  x_ = {y[x_0], y[x_1]}, v_ = {V[0] - y[u_0], V[1] - y[u_1]};
  friction_work_ = account[rubbed], path_length_ = account[path], supplied_ = account[supply];
}

void PlaneCreep::start(double t, const std::vector<double>& state) {
  t0_ = t1_ = t;
  y_ = state;
  y_.resize(y_.size() + accounts, 0.0);
  take(y_);
  open_account();
  fresh_ = true, sticks_ = false, stick_time_ = 0;
}

std::vector<double> PlaneCreep::state() const { return {y_.begin(), y_.end() - accounts}; }

Outcome PlaneCreep::advance(double limit, Switch& switched) {
  end_if_stopped();
  switched = Switch::none;
  t0_ = t1_;
  if (fresh_ && !collocation_->start(t1_, y_))
    return {Ending::not_finite, "no friction fits the motion and the states of the contact"};
  fresh_ = false;
  const double drive_break =
      std::min({mass_.load.next_break(t0_), mass_.force[0].next_break(t0_), mass_.force[1].next_break(t0_)});
  const auto speed = [](const std::vector<double>& y) { return std::hypot(y[u_0], y[u_1]); };
  double longest = motion_->resolution();
  const double before = speed(collocation_->state_before()), now = speed(y_);
  if (near_rest_ > 0 && now < before) {
    constexpr double share = 0.5, near_rest_share = 1e-3;  // of the slip rate that a step may lose
    const double loss = std::max(share * now, near_rest_share * near_rest_);
    longest = std::min(longest, loss * collocation_->length() / (before - now));
  }
  collocation_->bound_step(longest);
  const Outcome outcome = collocation_->step(std::min(limit, drive_break));
  if (!outcome.complete()) return outcome;
  t1_ = collocation_->time();
  y_ = collocation_->state();
  take(y_);
  fresh_ = t1_ >= drive_break;
  if (stick_speed_ > 0) {
    std::vector<double> middle(y_.size());
    collocation_->interpolate(0.5, middle.data());
    sticks_ = speed(middle) <= stick_speed_;
    if (sticks_) stick_time_ += t1_ - t0_;
  }
  return {};
}

PlaneCreep::Seen PlaneCreep::at(double t, bool near) {
  const auto& V = mass_.surface_velocity;
  std::vector<double> y = collocation_->state();
  double theta = (t - collocation_->time_before()) / collocation_->length();
  if (t <= t0_)
    y = collocation_->state_before();
  else if (t < t1_ && near)
    collocation_->interpolate(theta, y.data());
  else if (t < t1_)
    collocation_->solve_at(theta, y.data());
  Seen seen{{y[x_0], y[x_1]}, {V[0] - y[u_0], V[1] - y[u_1]}, {}};
  std::vector<double> g(y.size());
  contact_.evaluate({y[u_0], y[u_1]}, mass_.load.value(t), y.data() + contact_0, g.data(), seen.friction, nullptr);
  seen.memory.assign(y.begin() + contact_0, y.end() - accounts);
  return seen;
}

}  // namespace rosin::solvers::stick_slip
