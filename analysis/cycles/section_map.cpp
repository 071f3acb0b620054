/// Returns of a structure to a moment of its drive, or to the maximum of a coordinate.
#include "analysis/cycles/section_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear_solve.hpp"

namespace rosin::analysis::cycles {

using Eigen::MatrixXd, Eigen::VectorXd;
using motion::Follower;
using motion::Section;
using oscillators::Structure;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

SectionMap::SectionMap(Structure structure)
    : system_(std::move(structure)), drive_period_(common_period(system_.structure())) {}

Section SectionMap::section() const {
  Section section;
  // A rigid stop turns a velocity at once: on that side there is no maximum.
  bool above = false, below = false;
  for (const auto& stop : system_.structure().stops)
    if (stop.rigid() && stop.coordinate == coordinate_) (stop.side > 0 ? above : below) = true;
  if (above && below)
    throw InputError(
        fmt::format("{} moves most and has rigid stops on both sides: without a periodic drive its "
                    "motion has no section there; give one stop a stiffness (N/m)",
                    system_.unknown(coordinate_)));
  section.value = [this, sign = above ? -1 : 1](double t, const double* y) {
    return sign * system_.velocity(t, y)[coordinate_];
  };
  std::vector<double> rest(system_.size()), scale(system_.size());
  system_.scale(rest.data(), scale.data());
  section.scale = scale[system_.coordinates() + coordinate_];
  return section;
}

double SectionMap::patience() const {
  const Structure& structure = system_.structure();
  std::vector<double> rest(system_.size()), scale(system_.size());
  system_.scale(rest.data(), scale.data());
  double longest = 0;
  for (int i = 0; i < system_.coordinates(); ++i) {
    if (structure.K(i, i) > 0)
      longest = std::max(longest, 2 * std::numbers::pi * std::sqrt(structure.M(i, i) / structure.K(i, i)));
    longest = std::max(longest, scale[i] / scale[system_.coordinates() + i]);
  }
  constexpr double many = 1000;
  return many * longest;
}

void SectionMap::add_to_count(const Follower& follower) {
  const auto& done = follower.count();
  count = {count.steps + done.steps, count.evaluations + done.evaluations, count.choices + done.choices};
}

SectionMap::Followers SectionMap::algebraic(const std::vector<double>& y, const std::vector<double>& mass) const {
  const int n = system_.size();
  Followers found;
  for (int i = 0; i < n; ++i) (mass[i] == 0 ? found.algebraic : found.differential).push_back(i);
  if (found.algebraic.empty()) return found;
  std::vector<double> f(n);
  RowMajor J(n, n);
  system_.linearise(0, y.data(), f.data(), J.data());
  found.slopes = -solve_columns(J(found.algebraic, found.algebraic), J(found.algebraic, found.differential));
  return found;
}

/// Of the velocity of the watched coordinate, by the differential unknowns: where it has no mass its velocity follows
/// from them.
VectorXd SectionMap::gradient_of_section(const Followers& followers) const {
  const int n = system_.size();
  std::vector<double> unit(n);
  VectorXd gradient(n);
  const double at_none = system_.velocity(0, unit.data())[coordinate_];
  for (int i = 0; i < n; ++i) {
    unit[i] = 1;
    gradient[i] = system_.velocity(0, unit.data())[coordinate_] - at_none;  // linear in the unknowns
    unit[i] = 0;
  }
  if (followers.algebraic.empty()) return gradient;
  gradient(followers.differential) += followers.slopes.transpose() * gradient(followers.algebraic);
  gradient(followers.algebraic).setZero();
  return gradient;
}

SectionMap::Return SectionMap::follow(const std::vector<double>& y, double tolerance, int returns, bool derivative,
                                      const Observer& observe) {
  const int n = system_.size();
  Return result;
  result.y = y;
  std::vector<double> S;
  Follower follower(system_, tolerance);
  follower.observe = observe;
  follower.most_steps = most_steps;
  if (derivative) {
    S.assign(std::size_t(n) * n, 0.0);
    for (int i = 0; i < n; ++i) S[i * n + i] = 1;
    follower.carry(&S, n);
  }
  if (driven()) {
    for (int turn = 0; turn < returns; ++turn) {  // each from the same moment: a long run would round its phase
      result.outcome = follower.follow(0, result.y, drive_period_);
      if (!result.outcome.complete()) break;
      result.duration += drive_period_;
    }
    if (result.outcome.complete()) result.outcome = {Ending::event, ""};
  } else {
    Section at = section();
    int crossing = 0;
    at.crossed = [&](double, const std::vector<double>&) { return ++crossing == returns; };
    result.outcome = follower.follow(0, result.y, returns * patience(), &at);
    result.duration = follower.time();
    if (result.outcome.ending == Ending::reached_end)
      result.outcome = {Ending::none_exists, "the motion does not return"};
  }
  add_to_count(follower);
  if (!derivative || result.outcome.ending != Ending::event) return result;
  result.derivative = Eigen::Map<const RowMajor>(S.data(), n, n);
  if (!driven()) {  // disturbances that arrive at another time: P = 1 − f ∇gᵀ/(∇g f)
    std::vector<double> f(n), mass(n);
    system_.evaluate(0, result.y.data(), f.data());
    system_.mass(0, mass.data());
    VectorXd rate(n);
    for (int i = 0; i < n; ++i) rate[i] = mass[i] != 0 ? f[i] / mass[i] : 0;
    const auto followers = algebraic(result.y, mass);
    const VectorXd gradient = gradient_of_section(followers);
    result.derivative -= rate * (gradient.transpose() * result.derivative) / gradient.dot(rate);
    if (!followers.algebraic.empty())
      result.derivative(followers.algebraic, Eigen::all) =
          followers.slopes * result.derivative(followers.differential, Eigen::all);
  }
  return result;
}

Outcome SectionMap::follow_crossings(
    std::vector<double> y, double tolerance,
    const std::function<bool(int crossing, double t, const std::vector<double>& y)>& crossed, const Observer& observe) {
  Follower follower(system_, tolerance);
  follower.observe = observe;
  follower.most_steps = most_steps;
  int crossing = 0;
  Outcome outcome;
  if (driven()) {
    do {
      outcome = follower.follow(0, y, drive_period_), ++crossing;
    } while (outcome.complete() && !crossed(crossing, crossing * drive_period_, y));
    if (outcome.complete()) outcome = {Ending::event, ""};
  } else {
    Section at = section();
    at.crossed = [&](double t, const std::vector<double>& there) { return crossed(++crossing, t, there); };
    double t = 0;
    for (int before = -1; outcome.complete() && outcome.ending != Ending::event && crossing > before;) {
      before = crossing;
      outcome = follower.follow(t, y, t + patience(), &at);
      t = follower.time();
    }
  }
  add_to_count(follower);
  return outcome;
}

}  // namespace rosin::analysis::cycles
