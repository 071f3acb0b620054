/// Arcs of a cycle and their derivatives, the nodes between them, and what a cycle shows.
#include "analysis/branches/cycle_problem.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/eigenpairs.hpp"
#include "core/product_eigenvalues.hpp"

namespace rosin::analysis::branches {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using motion::Follower;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Complex = std::complex<double>;

namespace {
constexpr double most_growth = 1e3;  ///< of a disturbance from node to node
constexpr int most_nodes = 60;
}  // namespace

Oscillator& CycleProblem::oscillator(double p) {
  if (oscillator_ && p == at_) return *oscillator_;
  oscillator_ = family_(p), at_ = p, aside_ = 0;
  if (const double period = oscillator_->drive_period(); period > 0) drive_period_ = period;
  return *oscillator_;
}

/// The oscillator, with two beside it that differ a little in the parameter.
Oscillator& CycleProblem::vary(double p) {
  constexpr double aside = 1e-5, least = 1e-12;
  Oscillator& here = oscillator(p);
  if (aside_ != 0) return here;
  const double step = aside * std::max(std::abs(p), least);
  // At the end of the parameter's range there is nothing beyond: a difference to one side.
  const auto beside = [&](double value, std::unique_ptr<Oscillator>& into) {
    try {
      into = family_(value);
      return 0.5;
    } catch (const InputError&) {
      into = family_(p);
      return 0.0;
    }
  };
  const double sides = beside(p + step, larger_) + beside(p - step, smaller_);
  aside_ = sides * step;
  return here;
}

VectorXd CycleProblem::unknowns(const std::vector<Node>& nodes, double period) const {
  const Index m = Index(moving_.size()), first = is_driven_ ? 0 : Index(nodes.size());
  VectorXd x(first + Index(nodes.size()) * m);
  for (Index i = 0; i < first; ++i) x[i] = i == 0 ? period : nodes[std::size_t(i)].part;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (Index j = 0; j < m; ++j) x[first + Index(i) * m + j] = nodes[i].y[moving_[j]];
  return x;
}

std::vector<double> CycleProblem::full(const VectorXd& x, int node) const {
  std::vector<double> y = nodes_[node].y;
  for (std::size_t j = 0; j < moving_.size(); ++j) y[moving_[j]] = x[place(node) + Index(j)];
  return y;
}

double CycleProblem::period(const VectorXd& x, double p) {
  if (!is_driven_) return x[0];
  oscillator(p);
  return drive_period_ * turns_;
}

/// 1 of the node behind the last: the first again.
double CycleProblem::part(int node, const VectorXd& x) const {
  if (node == 0) return 0;
  if (node == int(nodes_.size())) return 1;
  return is_driven_ ? nodes_[node].part : x[node];
}

double CycleProblem::end_of(int arc, const VectorXd& x, double p) {
  return (part(arc + 1, x) - (is_driven_ ? 0 : part(arc, x))) * period(x, p);
}

VectorXd CycleProblem::rates(double t, const std::vector<double>& y, double p) {
  const System& system = oscillator(p).system();
  std::vector<double> f(y.size()), mass(y.size());
  system.evaluate(t, y.data(), f.data());
  system.mass(t, mass.data());
  VectorXd rates(moving_.size());
  for (std::size_t j = 0; j < moving_.size(); ++j)
    rates[Index(j)] = mass[moving_[j]] != 0 ? f[moving_[j]] / mass[moving_[j]] : 0;
  return rates;
}

void CycleProblem::set_scale(double period) {
  const Index m = Index(moving_.size()), count = Index(nodes_.size());
  scale_.setOnes(place(int(count)));
  if (!is_driven_) scale_[0] = period;
  for (Index i = 0; i < count; ++i) scale_.segment(place(int(i)), m) = size_ * std::sqrt(double(count));
}

/// Half ranges, at least 1e-3 of the cycle's share of the natural size.
void CycleProblem::set_sizes(const VectorXd& half, const std::vector<double>& y, double p) {
  std::vector<double> natural(y.size());
  oscillator(p).system().scale(y.data(), natural.data());
  amplitude_ = 0;
  for (Index j = 0; j < half.size(); ++j) amplitude_ = std::max(amplitude_, half[j] / natural[moving_[j]]);
  constexpr double least = 1e-3, least_amplitude = 1e-12;
  amplitude_ = std::max(amplitude_, least_amplitude);
  size_ = half;
  for (Index j = 0; j < half.size(); ++j) size_[j] = std::max(half[j], least * amplitude_ * natural[moving_[j]]);
}

/// Tolerance of the steps, whose errors are measured in natural sizes.
double CycleProblem::accuracy(double tolerance) const {
  constexpr double share = 0.1, least = 1e-14;
  return std::max(share * tolerance * std::min(1.0, amplitude_), least);
}

VectorXd CycleProblem::begin(const std::vector<double>& y, double period, double p) {
  Oscillator& here = oscillator(p);
  is_driven_ = here.drive_period() > 0;
  moving_ = moving_unknowns(here.system());
  nodes_ = {{0, y}}, turn_.reset();
  std::vector<double> natural(y.size());
  here.system().scale(y.data(), natural.data());
  size_.resize(Index(moving_.size()));
  for (std::size_t j = 0; j < moving_.size(); ++j) size_[Index(j)] = natural[moving_[j]];
  references_ = {{size_, size_}};
  set_scale(period);
  VectorXd x = unknowns(nodes_, period);
  constexpr double of_nodes = 1e-8;
  if (period > 0) refer_to(x, p, of_nodes);
  turn_.reset();  // of nodes laid out anew on a motion that need not have closed
  return x;
}

CycleProblem::Born CycleProblem::born(const std::vector<double>& y, const Eigen::VectorXcd& q, double angular_frequency,
                                      double amplitude, double p) {
  Born born;
  begin(y, 0, p);
  std::vector<double> natural(y.size());
  oscillator(p).system().scale(y.data(), natural.data());
  double largest = 0;
  const Index m = Index(moving_.size());
  // In steady sliding the deflection of an elastic contact is none of the unknowns that move.
  std::vector<double> mass(y.size());
  oscillator(p).system().mass(0, mass.data());
  Eigen::VectorXcd w = Eigen::VectorXcd::Zero(m);
  for (Index j = 0, of_mode = 0; j < m; ++j) {
    if (mass[moving_[j]] != 0) w[j] = q[of_mode++];
    largest = std::max(largest, std::abs(w[j]) / natural[moving_[j]]);
  }
  w *= amplitude / largest;
  set_sizes(w.cwiseAbs(), y, p);
  // The phase at which the cycle is farthest from steady sliding, and moves across that.
  Complex squares = 0;
  for (Index j = 0; j < m; ++j) squares += w[j] * w[j] / (size_[j] * size_[j]);
  w *= std::polar(1.0, -0.5 * std::arg(squares));
  const double period = 2 * std::numbers::pi / angular_frequency;
  set_scale(period);
  born.x = unknowns(nodes_, period);
  born.direction = VectorXd::Zero(born.x.size());
  born.direction.segment(1, m) = w.real().cwiseQuotient(size_);
  born.direction.normalize();
  references_ = {{born.x.segment(1, m), -w.imag().cwiseQuotient(size_).normalized()}};
  return born;
}

Outcome CycleProblem::follow_arc(int arc, const VectorXd& x, double p, double tolerance, Arc& result,
                                 const Observer& observe, std::vector<double>* tangent) {
  const bool by_parameter = tangent && !oscillator(p).has_stops();
  Oscillator& here = by_parameter ? vary(p) : oscillator(p);
  Follower follower = here.follower(accuracy(tolerance));
  result.begin.clear();
  follower.observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
    if (result.begin.empty()) result.begin = step.state_before();
    if (observe) observe(step, switches);
  };
  if (tangent) follower.carry(tangent, int(moving_.size()) + by_parameter);
  if (by_parameter) {
    const auto varied = [&](Oscillator& other) {
      const double period = other.drive_period();
      return Follower::Varied{&other.system(), is_driven_ && period > 0 ? period / drive_period_ : 1};
    };
    follower.vary(varied(*larger_), varied(*smaller_), aside_);
  }
  result.end = full(x, arc);
  const auto outcome = follower.follow(start_of(arc, x, p), result.end, end_of(arc, x, p));
  steps += follower.count().steps;
  return outcome;
}

Outcome CycleProblem::follow_turn(const Solved& at, const Observer& observe, Turn& turn) {
  const auto& [x, p, tolerance] = at;
  turn.x = x, turn.p = p, turn.tolerance = tolerance;
  Oscillator& here = oscillator(p);
  SwitchingSystem& system = here.system();
  const bool has_stops = here.has_stops();
  const int m = int(moving_.size()), columns = m + !has_stops;
  const double T = period(x, p);
  std::vector<double> S(std::size_t(system.size()) * columns);
  const auto disturb = [&] {
    std::ranges::fill(S, 0.0);
    for (int j = 0; j < m; ++j) S[moving_[j] * columns + j] = 1;
  };
  const auto disturbed_by_start = [&] {
    MatrixXd by_start(m, m);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j) by_start(i, j) = S[moving_[i] * columns + j];
    return by_start;
  };
  int arc = 0;
  const Observer watch = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
    if (observe) observe(step, switches);
    Turn::Step next{.part = part(arc, x) + (step.time() - start_of(arc, x, p)) / T,
                    .y = step.state(),
                    .by_start = disturbed_by_start(),
                    .by_parameter = VectorXd(has_stops ? 0 : m),
                    .rate = rates(step.time(), step.state(), p),
                    .slips = switches.empty()};
    for (int i = 0; i < next.by_parameter.size(); ++i) next.by_parameter[i] = S[moving_[i] * columns + m];
    for (int c = 0; c < system.contacts(); ++c) next.slips = next.slips && system.mode(c) != ContactMode::stick;
    disturb();
    turn.steps.push_back(std::move(next));
  };
  for (arc = 0; arc < int(nodes_.size()); ++arc) {
    Arc there;
    disturb();
    if (auto outcome = follow_arc(arc, x, p, tolerance, there, watch, &S); !outcome.complete()) return outcome;
    turn.begins.push_back(std::move(there.begin));
    turn.ends.push_back(turn.steps.size() - 1);
    // A step that ends at a stop is told before the impact.
    if (has_stops) turn.steps.back().by_start = disturbed_by_start() * turn.steps.back().by_start;
  }
  return {};
}

Outcome CycleProblem::keep_turn(const Solved& at) {
  if (turn_ && turn_->p == at.p && turn_->tolerance <= at.tolerance && turn_->x.size() == at.x.size() &&
      turn_->x == at.x)
    return {};
  Turn turn;
  const auto outcome = follow_turn(at, {}, turn);
  if (outcome.complete()) turn_ = std::move(turn);
  return outcome;
}

Problem::Residual CycleProblem::residual(const VectorXd& x, double p, double tolerance, bool slopes) {
  try {
    return residual_at(x, p, tolerance, slopes);
  } catch (const InputError& error) {  // a correction has left what the parameter may be
    Residual result;
    result.outcome = {Ending::not_finite, error.what()};
    return result;
  }
}

Problem::Residual CycleProblem::residual_at(const VectorXd& x, double p, double tolerance, bool slopes) {
  Residual result;
  const Index m = Index(moving_.size()), count = Index(nodes_.size()), size = x.size();
  const double T = period(x, p);
  for (int i = 0; i < int(count); ++i)
    if (!(T > 0) || !(part(i, x) < part(i + 1, x))) {
      result.outcome = {Ending::not_finite, "a period that is not positive"};
      return result;
    }
  result.F = VectorXd::Zero(size);
  if (slopes) result.F_x = MatrixXd::Zero(size, size), result.F_p = VectorXd::Zero(size);
  const auto end_on_node = [&](const std::vector<double>& end, Index i, VectorXd& F) {
    for (Index j = 0; j < m; ++j)
      F[place(int(i)) + j] = (end[moving_[j]] - x[place(int((i + 1) % count)) + j]) / size_[j];
  };
  const auto end_on_nodes = [&](double at, VectorXd& F) -> Outcome {
    for (Index i = 0; i < count; ++i) {
      Arc arc;
      if (auto outcome = follow_arc(int(i), x, at, tolerance, arc); !outcome.complete()) return outcome;
      end_on_node(arc.end, i, F);
    }
    return {};
  };
  result.outcome = slopes ? keep_turn({x, p, tolerance}) : end_on_nodes(p, result.F);
  if (!result.outcome.complete()) return result;
  const bool has_stops = oscillator(p).has_stops();
  std::size_t k = 0;
  for (Index i = 0; slopes && i < count; ++i) {
    const Index row = place(int(i)), next = place(int((i + 1) % count));
    MatrixXd by_start = MatrixXd::Identity(m, m);
    VectorXd by_parameter = VectorXd::Zero(m);
    for (; k <= turn_->ends[std::size_t(i)]; ++k) {
      const auto& step = turn_->steps[k];
      by_start = step.by_start * by_start;
      if (!has_stops) by_parameter = step.by_start * by_parameter + step.by_parameter;
    }
    const auto& end = turn_->steps[k - 1];
    end_on_node(end.y, i, result.F);
    result.F_x.block(row, row, m, m) += size_.cwiseInverse().asDiagonal() * by_start;
    result.F_x.block(row, next, m, m) -= size_.cwiseInverse().asDiagonal() * MatrixXd::Identity(m, m);
    result.F_p.segment(row, m) = by_parameter.cwiseQuotient(size_);
    if (is_driven_) continue;
    const VectorXd rate = end.rate.cwiseQuotient(size_);
    result.F_x.col(0).segment(row, m) = end_of(int(i), x, p) / T * rate;
    if (i > 0) result.F_x.col(i).segment(row, m) -= T * rate;
    if (i + 1 < count) result.F_x.col(i + 1).segment(row, m) += T * rate;
  }
  for (Index i = 0; !is_driven_ && i < count; ++i) {
    const auto& [node, along] = references_[std::size_t(i)];
    result.F[i] = along.dot((x.segment(place(int(i)), m) - node).cwiseQuotient(size_));
    if (slopes) result.F_x.row(i).segment(place(int(i)), m) = along.cwiseQuotient(size_).transpose();
  }
  if (slopes && has_stops) {
    constexpr double aside = 3e-5;
    const double step = aside * std::max(std::abs(p), 1e-12);
    VectorXd moved = result.F;
    result.outcome = end_on_nodes(p + step, moved);
    if (!result.outcome.complete()) return result;
    result.F_p = (moved - result.F) / step;
  }
  return result;
}

namespace {

/// Watches how near a motion of contacts comes to another pattern of switches.
class BorderWatch {
 public:
  /// \param accuracy  of the motion
  BorderWatch(SwitchingSystem& system, double accuracy)
      : system_(system), accuracy_(accuracy), held_(system.contacts()), rate_(system.contacts()) {
    at_.resize(system.contacts());
  }

  void add(Follower::Step& step, std::span<const Follower::Event> switches) {
    constexpr int nodes = Follower::Step::stages;
    std::vector<double> y(system_.size());
    for (int c = 0; c < system_.contacts(); ++c) {
      auto& was = at_[c];
      const bool sticks = system_.mode(c) == ContactMode::stick;
      if (sticks != was.sticks) was = {.sticks = sticks};
      // The end of an elastic contact's slip turns nothing over, at its limit or just short of it.
      if (!sticks && system_.is_elastic(c)) continue;
      const int row = system_.slip_rate_unknown(c);
      const double direction = sticks ? 1 : sign(system_.mode(c)), V = system_.reference_speed(c);
      const auto acceleration = [&](double t, const double* state) {
        system_.slip_accelerations(t, state, rate_.data());
        return direction * rate_[c];
      };
      for (int i = 0; i < nodes; ++i) {
        step.stage(i, y.data());
        const double t = step.stage_time(i);
        if (sticks) {
          system_.held(t, y.data(), held_.data());
          const double margin = (held_[c].limit - std::abs(held_[c].force)) / held_[c].limit;
          if (was.samples >= 2 && was.last < was.before && was.last < margin) holding_ = std::min(holding_, was.last);
          was.before = was.last, was.last = margin, ++was.samples;
          continue;
        }
        const double slip = direction * y[row] / V, rising = acceleration(t, y.data());
        if (was.samples >= 1 && was.rising < 0 && rising > 0 && std::min(slip, was.last) < lowest_) {
          const double low = i == 0 ? 0 : step.node(i - 1);
          const auto theta = step.locate(acceleration, low, step.node(i), was.rising, rising);
          if (theta && step.solve_at(*theta, y.data())) lowest_ = std::min(lowest_, direction * y[row] / V);
        }
        was.last = slip, was.rising = rising, ++was.samples;
      }
    }
    for (const auto& event : switches) {
      if (event.contact < 0) {
        ++count_[fmt::format("{} at stop {}", event.kind, event.stop + 1)];
        continue;
      }
      ++count_[fmt::format("{} of contact {}", event.kind, event.contact + 1)];
      if (system_.mode(event.contact) == ContactMode::stick || system_.is_elastic(event.contact)) continue;
      if (event.kind == "stick" || event.kind == "reversal")
        holding_ = std::min(holding_, std::abs(margin_at_rest(event.contact, step.time(), step.state())));
      if (event.kind != "stick") continue;
      system_.slip_accelerations(step.time(), step.state().data(), rate_.data());
      const double V = system_.reference_speed(event.contact);
      const double landing = rate_[event.contact] / V;
      landing_ = std::min(landing_, landing * landing);
    }
  }

  /// Each falls to 0 at its border as the distance does.
  void tell(Problem::View& view) const {
    for (const auto& [what, times] : count_) view.pattern += fmt::format("{} {}; ", times, what);
    if (std::isfinite(lowest_)) view.tests.push_back({"grazing", lowest_, accuracy_, true});
    if (std::isfinite(landing_)) view.tests.push_back({grazing_of_landing, landing_, accuracy_, true});
    if (std::isfinite(holding_)) view.tests.push_back({"switching-sliding", holding_, accuracy_, true});
  }

 private:
  /// Part of the limit that is left where slip has come to rest: below 0 the force turns it back without a stop.
  double margin_at_rest(int contact, double t, std::vector<double> y) {
    const auto slip = system_.mode(contact);
    system_.stop(contact, y.data());
    system_.set_mode(contact, ContactMode::stick);
    system_.held(t, y.data(), held_.data());
    system_.set_mode(contact, slip);
    return (held_[contact].limit - std::abs(held_[contact].force)) / held_[contact].limit;
  }

  struct At {
    bool sticks = false;
    int samples = 0;
    double last = 0, before = 0, rising = 0;
  };
  SwitchingSystem& system_;
  double accuracy_;
  std::vector<SwitchingSystem::Held> held_;
  std::vector<double> rate_;
  std::vector<At> at_;
  std::map<std::string, int> count_;
  double lowest_ = infinity;   ///< least slip rate within a slip, in reference speeds
  double landing_ = infinity;  ///< square of the least acceleration at which slip comes to rest
  double holding_ = infinity;  ///< least margin of a contact at rest, of the limit: within a stick, or at a reversal
};

/// An orthonormal basis across a direction.
MatrixXd across(const VectorXd& f) {
  const Eigen::HouseholderQR<MatrixXd> qr(f);
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(f.size(), f.size());
  return Q.rightCols(f.size() - 1);
}

/// Whether a matrix makes some disturbances so much larger than others that another factor would round those away.
bool is_spread(const MatrixXd& A) {
  constexpr double most = 1e4, nothing = 1e-13;
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  const VectorXd sizes = qr.matrixQR().diagonal().cwiseAbs();
  const double largest = sizes.maxCoeff();
  return std::ranges::any_of(sizes, [&](double size) { return size * most < largest && size > nothing * largest; });
}

/// Errors by the multipliers at a looser tolerance, each by the nearest. A difference may be small by chance: an error
/// is a thousandth of the largest relative one at least.
std::vector<double> errors_of(const std::vector<Complex>& values, std::vector<Complex> looser) {
  if (looser.size() != values.size()) return std::vector<double>(values.size(), infinity);
  constexpr double shared = 1e-3, rounding = 1e-13;
  std::vector<double> errors;
  double most = 0;
  for (const auto& z : values) {
    const auto nearest = std::ranges::min_element(looser, {}, [&](auto other) { return std::abs(other - z); });
    errors.push_back(std::abs(*nearest - z));
    most = std::max(most, errors.back() / std::max(1.0, std::abs(z)));
    looser.erase(nearest);
  }
  for (std::size_t i = 0; i < values.size(); ++i) errors[i] += (shared * most + rounding) * std::abs(values[i]);
  return errors;
}

/// The divergence of the flow, integrated over steps of smooth motion.
class Divergence {
 public:
  explicit Divergence(SwitchingSystem& system)
      : system_(system), y_(system.size()), f_(system.size()), mass_(system.size()), scale_(system.size()) {
    J_.resize(system.size(), system.size());
  }
  void add(const Follower::Step& step) {
    for (int i = 0; i < Follower::Step::stages; ++i) {
      step.stage(i, y_.data());
      const double t = step.stage_time(i), weight = solvers::steps::RadauTableau::get().b[i] * step.length();
      system_.linearise(t, y_.data(), f_.data(), J_.data());
      system_.mass(t, mass_.data()), system_.scale(y_.data(), scale_.data());
      const double trace = moving_part(J_, mass_, scale_).A.trace();
      sum += weight * trace, turned_over += weight * std::abs(trace);
    }
  }
  double sum = 0, turned_over = 0;

 private:
  SwitchingSystem& system_;
  std::vector<double> y_, f_;
  VectorXd mass_, scale_;
  RowMajor J_;
};

/// Volumes shrink by the divergence of the flow (Liouville), which gives the smallest multiplier even where steps do
/// not resolve how its direction shrinks. Where a second one is not known either, nothing is.
void complete_by(const Divergence& divergence, double accuracy, std::vector<Complex>& z, std::vector<double>& error) {
  if (z.empty() || z.back().imag() != 0) return;
  double others = 0, relative = accuracy * divergence.turned_over, sign = 1;
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    others += std::log(std::abs(z[i])), relative += error[i] / std::abs(z[i]);
    if (z[i].imag() == 0 && z[i].real() < 0) sign = -sign;
  }
  const double by_volume = sign * std::exp(divergence.sum - others);
  if (relative < 1 && std::abs(by_volume) * relative < error.back())
    z.back() = by_volume, error.back() = std::abs(by_volume) * relative + std::numeric_limits<double>::min();
  else
    error.back() = std::max(error.back(), std::abs(z.back() - by_volume));
}

/// ∏ g/(1 + size), which changes its sign with each g, and its error.
struct TestOfMultipliers {
  Complex value = 1;
  double error = 0;
  void multiply(Complex g, double size, double error_of_g) {
    error = (error * std::abs(g) + std::abs(value) * error_of_g) / (1 + size);
    value *= g / (1 + size);
  }
  Problem::Test told(const char* kind) const { return {kind, value.real(), error}; }
};

std::vector<Problem::Test> tests_of(const std::vector<Complex>& z, const std::vector<double>& error) {
  TestOfMultipliers folds, doubles, torus;
  for (std::size_t i = 0; i < z.size(); ++i) {
    folds.multiply(z[i] - 1.0, std::abs(z[i]), error[i]), doubles.multiply(z[i] + 1.0, std::abs(z[i]), error[i]);
    for (std::size_t j = 0; j < i; ++j) {
      const Complex both = z[i] * z[j];
      torus.multiply(both - 1.0, std::abs(both), std::abs(z[i]) * error[j] + std::abs(z[j]) * error[i]);
    }
  }
  std::vector<Problem::Test> tests{folds.told("fold"), doubles.told("period-doubling")};
  if (z.size() > 1) tests.push_back(torus.told("torus"));
  return tests;
}

}  // namespace

std::vector<MatrixXd> CycleProblem::factors_of(const Turn& turn) const {
  const Index m = Index(moving_.size());
  std::vector<MatrixXd> factors;
  MatrixXd basis;  // across the motion alone: along it a disturbance comes back as it was
  const auto across_motion = [&](std::size_t k) { return across(turn.steps[k].rate.cwiseQuotient(size_)); };
  if (!is_driven_) basis = across_motion(turn.steps.size() - 1);
  std::size_t k = 0;
  for (const std::size_t end : turn.ends) {
    MatrixXd product = is_driven_ ? MatrixXd::Identity(m, m) : basis;
    for (; k <= end; ++k) {
      product = in_sizes(turn.steps[k].by_start) * product;
      if (k == end || !is_spread(product)) continue;
      factors.push_back(product);
      product.setIdentity(m, m);
    }
    if (!is_driven_) basis = across_motion(end), product = basis.transpose() * product;
    factors.push_back(product);
  }
  return factors;
}

Problem::View CycleProblem::view(const Solved& at, const Solved& looser) {
  View view;
  const auto& [x, p, tolerance] = at;
  std::vector<Complex> rough;
  if (keep_turn(looser).complete()) rough = product_eigenvalues(factors_of(*turn_));
  Oscillator& here = oscillator(p);
  BorderWatch borders(here.system(), accuracy(tolerance));
  Divergence divergence(here.system());
  const auto record = here.record(accuracy(tolerance));
  const Observer observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
    record->add(step, switches);
    if (here.system().contacts() > 0)
      borders.add(step, switches);
    else if (!here.has_stops())
      divergence.add(step);
  };
  Turn turn;
  view.outcome = follow_turn(at, observe, turn);
  if (!view.outcome.complete()) return view;
  view.start = turn.begins.front();
  view.turns = turns_;
  view.metrics = record->finish(period(x, p));
  view.multipliers = product_eigenvalues(factors_of(turn));
  turn_ = std::move(turn);
  if (!std::ranges::all_of(view.multipliers, [](auto z) { return std::isfinite(std::abs(z)); })) {
    view.outcome = {Ending::not_finite, "the derivative of a turn"};
    return view;
  }
  view.multiplier_errors = errors_of(view.multipliers, std::move(rough));
  if (here.system().contacts() == 0 && !here.has_stops())
    complete_by(divergence, accuracy(tolerance), view.multipliers, view.multiplier_errors);
  view.tests = tests_of(view.multipliers, view.multiplier_errors);
  view.stable = view.multipliers.empty() || std::abs(view.multipliers.front()) < 1;
  borders.tell(view);
  return view;
}

std::optional<CycleProblem::Doubled> CycleProblem::doubled(const VectorXd& x, double p, double tolerance) {
  const Index m = Index(moving_.size());
  if (!keep_turn({x, p, tolerance}).complete()) return std::nullopt;
  std::vector<MatrixXd> derivative;
  MatrixXd turn = MatrixXd::Identity(m, m);
  std::size_t k = 0;
  for (const std::size_t end : turn_->ends) {
    derivative.push_back(MatrixXd::Identity(m, m));
    for (; k <= end; ++k) derivative.back() = in_sizes(turn_->steps[k].by_start) * derivative.back();
    turn = derivative.back() * turn;
  }
  // The null vector of turn + 1.
  const MatrixXd A = turn + MatrixXd::Identity(m, m);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A.transpose());
  VectorXd v = (qr.householderQ() * MatrixXd::Identity(m, m)).col(m - 1);
  Doubled result{std::make_unique<CycleProblem>(family_, 2 * turns_), {}, {}};
  auto& twice = *result.problem;
  twice.moving_ = moving_, twice.is_driven_ = is_driven_, twice.drive_period_ = drive_period_;
  twice.size_ = size_, twice.amplitude_ = amplitude_;
  for (int i = 0; i < 2; ++i) twice.references_.insert(twice.references_.end(), references_.begin(), references_.end());
  const int count = int(nodes_.size());
  for (int i = 0; i < 2 * count; ++i)
    twice.nodes_.push_back({(part(i % count, x) + (i >= count ? 1 : 0)) / 2, full(x, i % count)});
  const double T = 2 * period(x, p);
  twice.set_scale(T);
  result.x = twice.unknowns(twice.nodes_, T);
  result.direction = VectorXd::Zero(result.x.size());
  for (int i = 0; i < 2 * count; ++i) {
    result.direction.segment(twice.place(i), m) = v;
    v = derivative[i % count] * v;
  }
  result.direction.normalize();
  return result;
}

bool CycleProblem::refer_to(VectorXd& x, double p, double tolerance) {
  if (!keep_turn({x, p, tolerance}).complete()) return false;
  auto& [of, at_p, at_tolerance, begins, passed, ends] = *turn_;
  const int m = int(moving_.size()), count = int(nodes_.size());
  const double T = period(x, p);
  for (int arc = 0; arc < count; ++arc) nodes_[arc] = {part(arc, x), begins[arc]};
  const auto first = nodes_[0].y;
  VectorXd low(m), high(m);
  for (int j = 0; j < m; ++j) low[j] = high[j] = first[moving_[j]];
  for (const auto& at : passed)
    for (int j = 0; j < m; ++j)
      low[j] = std::min(low[j], at.y[moving_[j]]), high[j] = std::max(high[j], at.y[moving_[j]]);
  set_sizes(0.5 * (high - low), first, p);

  // The first node: where the motion is neither at its fastest nor at its slowest, and slips.
  const auto off = [&](const Turn::Step& at) {
    return std::abs(std::log(at.rate.cwiseQuotient(size_).cwiseAbs().maxCoeff() * T / (2 * std::numbers::pi)));
  };
  // Growth between neighbouring nodes as they stand.
  double most = 0;
  std::size_t k = 0;
  for (const std::size_t end : ends) {
    MatrixXd product = MatrixXd::Identity(m, m);
    for (; k <= end; ++k) {
      product = in_sizes(passed[k].by_start) * product;
      most = std::max(most, product.cwiseAbs().maxCoeff());
    }
  }
  std::size_t begin = passed.size() - 1;  // the state before the first node is that of the last step
  bool rewrite = most > 3 * most_growth;
  if (!is_driven_) {
    constexpr double well = 1.5;  // e-folds
    std::size_t best = begin;
    bool slips = false;
    double least = infinity;
    for (std::size_t i = 0; i < passed.size(); ++i)
      if (passed[i].slips) {
        slips = true;
        if (const double value = off(passed[i]); value < least) least = value, best = i;
      }
    if (slips && (off(passed.back()) > least + well)) begin = best, rewrite = true;
  }
  if (rewrite) {
    if (begin + 1 < passed.size()) {
      const double origin = passed[begin].part;
      for (std::size_t i = 0; i < passed.size(); ++i) passed[i].part += (i <= begin) - origin;
      std::ranges::rotate(passed, passed.begin() + long(begin) + 1);
      nodes_ = {{0, passed.back().y}};
    } else {
      nodes_ = {{0, first}};
    }
    ends.clear();
    MatrixXd product = MatrixXd::Identity(m, m);
    for (std::size_t i = 0; i + 1 < passed.size(); ++i) {
      const auto& at = passed[i];
      product = in_sizes(at.by_start) * product;
      const bool grown = product.cwiseAbs().maxCoeff() > most_growth;
      if (!grown || !at.slips || int(nodes_.size()) >= most_nodes) continue;
      constexpr double too_near = 1e-9;
      if (at.part - nodes_.back().part < too_near || 1 - at.part < too_near) continue;
      nodes_.push_back({at.part, at.y});
      ends.push_back(i);
      product.setIdentity();
    }
    ends.push_back(passed.size() - 1);
    begins.clear();
    for (const auto& node : nodes_) begins.push_back(node.y);
    of = x = unknowns(nodes_, T);
  }
  set_scale(T);
  references_.clear();
  for (std::size_t i = 0; !is_driven_ && i < nodes_.size(); ++i) {
    const auto& before = passed[i == 0 ? passed.size() - 1 : ends[i - 1]];
    references_.push_back({x.segment(place(int(i)), m), before.rate.cwiseQuotient(size_).normalized()});
  }
  return rewrite;
}

}  // namespace rosin::analysis::branches
