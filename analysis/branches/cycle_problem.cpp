/// Arcs of a cycle and their derivatives, the nodes between them, and what a cycle shows.
#include "analysis/branches/cycle_problem.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/cycles/multipliers.hpp"

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
  if (!oscillator_ || p != at_) oscillator_ = family_(p), at_ = p, aside_ = 0;
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
  const Index m = Index(moving_.size()), first = is_driven_ ? 0 : 1;
  VectorXd x(first + Index(nodes.size()) * m);
  if (!is_driven_) x[0] = period;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (Index j = 0; j < m; ++j) x[first + Index(i) * m + j] = nodes[i].y[moving_[j]];
  return x;
}

std::vector<double> CycleProblem::full(const VectorXd& x, int node) const {
  std::vector<double> y = nodes_[node].y;
  for (std::size_t j = 0; j < moving_.size(); ++j) y[moving_[j]] = x[place(node) + Index(j)];
  return y;
}

double CycleProblem::start_of(int arc, const VectorXd& x) const {
  return is_driven_ ? nodes_[arc].part * period(x) : 0;
}
double CycleProblem::end_of(int arc, const VectorXd& x) const {
  const double next = arc + 1 < int(nodes_.size()) ? nodes_[arc + 1].part : 1;
  return is_driven_ ? next * period(x) : (next - nodes_[arc].part) * period(x);
}

VectorXd CycleProblem::rates(double t, const std::vector<double>& y, double p) {
  const System& system = oscillator(p).system();
  std::vector<double> f(y.size()), mass(y.size());
  system.evaluate(t, y.data(), f.data());
  system.mass(t, mass.data());
  VectorXd rates(moving_.size());
  for (std::size_t j = 0; j < moving_.size(); ++j) rates[Index(j)] = f[moving_[j]] / mass[moving_[j]];
  return rates;
}

void CycleProblem::set_scale(double period) {
  const Index m = Index(moving_.size()), count = Index(nodes_.size());
  scale_.resize((is_driven_ ? 0 : 1) + count * m);
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
  drive_period_ = here.drive_period();
  is_driven_ = drive_period_ > 0;
  std::vector<double> mass(y.size());
  here.system().mass(0, mass.data());
  moving_.clear();
  for (std::size_t i = 0; i < mass.size(); ++i)
    if (mass[i] != 0) moving_.push_back(int(i));
  nodes_ = {{0, y}};
  std::vector<double> natural(y.size());
  here.system().scale(y.data(), natural.data());
  size_.resize(Index(moving_.size()));
  for (std::size_t j = 0; j < moving_.size(); ++j) size_[Index(j)] = natural[moving_[j]];
  reference_ = size_, along_ = size_;
  set_scale(period);
  VectorXd x = unknowns(nodes_, period);
  constexpr double of_nodes = 1e-8;
  if (period > 0) refer_to(x, p, of_nodes);
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
  for (Index j = 0; j < m; ++j) largest = std::max(largest, std::abs(q[j]) / natural[moving_[j]]);
  Eigen::VectorXcd w = q * (amplitude / largest);
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
  reference_ = born.x.segment(1, m);
  along_ = -w.imag().cwiseQuotient(size_).normalized();
  return born;
}

Outcome CycleProblem::follow_arc(int arc, const VectorXd& x, double p, double tolerance, Slopes slopes, Arc& result,
                                 const Observer& observe, std::vector<double>* own_tangent) {
  const bool by_parameter = slopes == Slopes::by_start_and_parameter;
  Oscillator& here = by_parameter ? vary(p) : oscillator(p);
  const int n = here.system().size(), m = int(moving_.size()), columns = m + by_parameter;
  Follower follower = here.follower(accuracy(tolerance));
  result.begin.clear();
  follower.observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
    if (result.begin.empty()) result.begin = step.state_before();
    if (observe) observe(step, switches);
  };
  std::vector<double> S;
  if (slopes != Slopes::none) {
    std::vector<double>& tangent = own_tangent ? *own_tangent : S;
    tangent.assign(std::size_t(n) * columns, 0.0);
    for (int j = 0; j < m; ++j) tangent[moving_[j] * columns + j] = 1;
    follower.carry(&tangent, columns);
    if (by_parameter) follower.vary(larger_->system(), smaller_->system(), aside_);
  }
  result.end = full(x, arc);
  const double begin = start_of(arc, x), end = end_of(arc, x);
  const auto outcome = follower.follow(begin, result.end, end);
  steps += follower.count().steps;
  if (!outcome.complete()) return outcome;
  if (slopes == Slopes::none || own_tangent) return {};
  result.derivative.resize(m, m), result.by_parameter.resize(m);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < m; ++j) result.derivative(i, j) = S[moving_[i] * columns + j];
    if (by_parameter) result.by_parameter[i] = S[moving_[i] * columns + m];
  }
  return {};
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
  const double T = period(x);
  if (!(T > 0)) {
    result.outcome = {Ending::not_finite, "a period that is not positive"};
    return result;
  }
  result.F = VectorXd::Zero(size);
  if (slopes) result.F_x = MatrixXd::Zero(size, size), result.F_p = VectorXd::Zero(size);
  const bool has_stops = oscillator(p).has_stops();
  const auto wanted = !slopes ? Slopes::none : has_stops ? Slopes::by_start : Slopes::by_start_and_parameter;
  const auto end_on_nodes = [&](const Arc& arc, Index i, VectorXd& F) {
    for (Index j = 0; j < m; ++j)
      F[place(int(i)) + j] = (arc.end[moving_[j]] - x[place(int((i + 1) % count)) + j]) / size_[j];
  };
  for (Index i = 0; i < count; ++i) {
    Arc arc;
    result.outcome = follow_arc(int(i), x, p, tolerance, wanted, arc);
    if (!result.outcome.complete()) return result;
    end_on_nodes(arc, i, result.F);
    if (!slopes) continue;
    const Index row = place(int(i)), next = place(int((i + 1) % count));
    result.F_x.block(row, row, m, m) += size_.cwiseInverse().asDiagonal() * arc.derivative;
    result.F_x.block(row, next, m, m) -= size_.cwiseInverse().asDiagonal() * MatrixXd::Identity(m, m);
    if (!has_stops) result.F_p.segment(row, m) = arc.by_parameter.cwiseQuotient(size_);
    if (!is_driven_)
      result.F_x.block(row, 0, m, 1) =
          (end_of(int(i), x) - start_of(int(i), x)) / T * rates(end_of(int(i), x), arc.end, p).cwiseQuotient(size_);
  }
  if (!is_driven_) {
    result.F[0] = along_.dot((x.segment(1, m) - reference_).cwiseQuotient(size_));
    if (slopes) result.F_x.block(0, 1, 1, m) = along_.cwiseQuotient(size_).transpose();
  }
  if (slopes && has_stops) {
    constexpr double aside = 3e-5;
    const double step = aside * std::max(std::abs(p), 1e-12);
    VectorXd moved = result.F;
    for (Index i = 0; i < count; ++i) {
      Arc arc;
      result.outcome = follow_arc(int(i), x, p + step, tolerance, Slopes::none, arc);
      if (!result.outcome.complete()) return result;
      end_on_nodes(arc, i, moved);
    }
    result.F_p = (moved - result.F) / step;
  }
  return result;
}

namespace {

/// Watches how near a motion of contacts comes to another pattern of switches.
class BorderWatch {
 public:
  explicit BorderWatch(SwitchingSystem& system) : system_(system), held_(system.contacts()), rate_(system.contacts()) {
    at_.resize(system.contacts());
  }

  void add(Follower::Step& step, std::span<const Follower::Event> switches) {
    constexpr int nodes = Follower::Step::stages;
    std::vector<double> y(system_.size());
    for (int c = 0; c < system_.contacts(); ++c) {
      auto& was = at_[c];
      const bool sticks = system_.mode(c) == ContactMode::stick;
      if (sticks != was.sticks) was = {.sticks = sticks};
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
      if (event.kind != "stick" || system_.mode(event.contact) == ContactMode::stick) continue;
      system_.slip_accelerations(step.time(), step.state().data(), rate_.data());
      const double V = system_.reference_speed(event.contact);
      const double landing = rate_[event.contact] / V;
      landing_ = std::min(landing_, landing * landing);
    }
  }

  /// Each falls to 0 at its border as the distance does.
  void tell(Problem::View& view) const {
    for (const auto& [what, times] : count_) view.pattern += fmt::format("{} {}; ", times, what);
    if (std::isfinite(lowest_)) view.tests.push_back({"grazing", lowest_, true});
    if (std::isfinite(landing_)) view.tests.push_back({grazing_of_landing, landing_, true});
    if (std::isfinite(holding_)) view.tests.push_back({"switching-sliding", holding_, true});
  }

 private:
  struct At {
    bool sticks = false;
    int samples = 0;
    double last = 0, before = 0, rising = 0;
  };
  SwitchingSystem& system_;
  std::vector<SwitchingSystem::Held> held_;
  std::vector<double> rate_;
  std::vector<At> at_;
  std::map<std::string, int> count_;
  double lowest_ = infinity;   ///< least slip rate within a slip, in reference speeds
  double landing_ = infinity;  ///< square of the least acceleration at which slip comes to rest
  double holding_ = infinity;  ///< least margin within a stick, of the limit
};

/// Without the eigenvalue 1 of the direction f: the part of the derivative across it.
MatrixXd across(const MatrixXd& derivative, const VectorXd& f) {
  const Eigen::HouseholderQR<MatrixXd> qr(f);
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(f.size(), f.size());
  const Index n = f.size();
  return (Q.transpose() * derivative * Q).bottomRightCorner(n - 1, n - 1);
}

}  // namespace

Problem::View CycleProblem::view(const VectorXd& x, double p, double tolerance) {
  View view;
  Oscillator& here = oscillator(p);
  BorderWatch borders(here.system());
  const auto record = here.record(accuracy(tolerance));
  const Observer observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
    record->add(step, switches);
    if (here.system().contacts() > 0) borders.add(step, switches);
  };
  const Index m = Index(moving_.size());
  MatrixXd turn = MatrixXd::Identity(m, m);
  for (int i = 0; i < int(nodes_.size()); ++i) {
    Arc arc;
    view.outcome = follow_arc(i, x, p, tolerance, Slopes::by_start, arc, observe);
    if (!view.outcome.complete()) return view;
    turn = size_.cwiseInverse().asDiagonal() * arc.derivative * size_.asDiagonal() * turn;
    if (i == 0) view.start = arc.begin;
  }
  view.metrics = record->finish(period(x));
  if (!turn.allFinite()) {
    view.outcome = {Ending::not_finite, "the derivative of a turn"};
    return view;
  }
  const auto& y = view.start;
  const MatrixXd D = is_driven_ ? turn : across(turn, rates(0, y, p).cwiseQuotient(size_));
  view.multipliers = cycles::by_modulus(D);
  Complex folds = 1, doubles = 1;
  double torus = NAN;  // of pairs alone: two real multipliers whose product is 1 are no torus
  for (std::size_t i = 0; i < view.multipliers.size(); ++i) {
    const Complex z = view.multipliers[i];
    folds *= (z - 1.0) / (1 + std::abs(z)), doubles *= (z + 1.0) / (1 + std::abs(z));
    constexpr double real = 1e-9;
    if (z.imag() > real * std::abs(z))
      torus = (std::isnan(torus) ? 1 : torus) * (std::norm(z) - 1) / (1 + std::norm(z));
  }
  view.tests = {{"fold", folds.real()}, {"period-doubling", doubles.real()}, {"torus", torus}};
  view.stable = view.multipliers.empty() || std::abs(view.multipliers.front()) < 1;
  borders.tell(view);
  return view;
}

std::optional<CycleProblem::Doubled> CycleProblem::doubled(const VectorXd& x, double p, double tolerance) {
  const Index m = Index(moving_.size());
  std::vector<MatrixXd> derivative;
  MatrixXd turn = MatrixXd::Identity(m, m);
  for (int i = 0; i < int(nodes_.size()); ++i) {
    Arc arc;
    if (!follow_arc(i, x, p, tolerance, Slopes::by_start, arc).complete()) return std::nullopt;
    derivative.push_back(size_.cwiseInverse().asDiagonal() * arc.derivative * size_.asDiagonal());
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
  twice.reference_ = reference_, twice.along_ = along_;
  const int count = int(nodes_.size());
  for (int i = 0; i < 2 * count; ++i)
    twice.nodes_.push_back({(nodes_[i % count].part + (i >= count ? 1 : 0)) / 2, full(x, i % count)});
  const double T = 2 * period(x);
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
  // One turn, the states after each step, and what each makes of disturbances.
  struct Passed {
    double part;
    std::vector<double> y;
    MatrixXd derivative;
    bool slips;
  };
  Oscillator& here = oscillator(p);
  SwitchingSystem& system = here.system();
  const int m = int(moving_.size()), count = int(nodes_.size());
  const double T = period(x);
  std::vector<Passed> passed;
  std::vector<double> S;
  int arc = 0;
  const Observer observe = [&](Follower::Step& step, std::span<const Follower::Event> switches) {
    Passed next{nodes_[arc].part + (step.time() - start_of(arc, x)) / T, step.state(), MatrixXd(m, m),
                switches.empty()};
    for (int c = 0; c < system.contacts(); ++c) next.slips = next.slips && system.mode(c) != ContactMode::stick;
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j) next.derivative(i, j) = S[moving_[i] * m + j];
    std::fill(S.begin(), S.end(), 0.0);
    for (int j = 0; j < m; ++j) S[moving_[j] * m + j] = 1;
    passed.push_back(std::move(next));
  };
  for (arc = 0; arc < count; ++arc) {
    Arc there;
    if (!follow_arc(arc, x, p, tolerance, Slopes::by_start, there, observe, &S).complete()) return false;
    nodes_[arc].y = there.begin;
  }
  const auto first = nodes_[0].y;
  VectorXd low(m), high(m);
  for (int j = 0; j < m; ++j) low[j] = high[j] = first[moving_[j]];
  for (const auto& at : passed)
    for (int j = 0; j < m; ++j)
      low[j] = std::min(low[j], at.y[moving_[j]]), high[j] = std::max(high[j], at.y[moving_[j]]);
  set_sizes(0.5 * (high - low), first, p);

  // The first node: where the motion is neither at its fastest nor at its slowest, and slips.
  const auto pace = [&](const std::vector<double>& y) {
    return rates(0, y, p).cwiseQuotient(size_).cwiseAbs().maxCoeff() * T / (2 * std::numbers::pi);
  };
  const auto off = [&](const std::vector<double>& y) { return std::abs(std::log(pace(y))); };
  // Growth between neighbouring nodes as they stand.
  double most = 0;
  {
    MatrixXd product = MatrixXd::Identity(m, m);
    int node = 1;
    for (const auto& at : passed) {
      product = size_.cwiseInverse().asDiagonal() * at.derivative * size_.asDiagonal() * product;
      most = std::max(most, product.cwiseAbs().maxCoeff());
      if (node < count && at.part >= nodes_[node].part * (1 - 1e-12)) product.setIdentity(), ++node;
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
        if (const double value = off(passed[i].y); value < least) least = value, best = i;
      }
    if (slips && (off(first) > least + well)) begin = best, rewrite = true;
  }
  if (rewrite) {
    std::vector<Node> nodes{{0, begin + 1 == passed.size() ? first : passed[begin].y}};
    const double origin = begin + 1 == passed.size() ? 0 : passed[begin].part;
    MatrixXd product = MatrixXd::Identity(m, m);
    for (std::size_t k = 1; k < passed.size(); ++k) {
      const auto& at = passed[(begin + k) % passed.size()];
      product = size_.cwiseInverse().asDiagonal() * at.derivative * size_.asDiagonal() * product;
      const bool grown = product.cwiseAbs().maxCoeff() > most_growth;
      if (!grown || !at.slips || int(nodes.size()) >= most_nodes) continue;
      double part = at.part - origin;
      if (part <= 0) part += 1;
      constexpr double too_near = 1e-9;
      if (part - nodes.back().part < too_near || 1 - part < too_near) continue;
      nodes.push_back({part, at.y});
      product.setIdentity();
    }
    nodes_ = std::move(nodes);
    x = unknowns(nodes_, T);
  }
  set_scale(T);
  reference_ = x.segment(place(0), m);
  along_ = rates(0, nodes_[0].y, p).cwiseQuotient(size_).normalized();
  return rewrite;
}

}  // namespace rosin::analysis::branches
