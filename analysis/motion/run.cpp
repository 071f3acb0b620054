/// Initial-value problems: choice of the solver, samples at the requested times, events, and errors by a second
/// tolerance.
#include "analysis/motion/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "analysis/motion/algorithm_run.hpp"
#include "analysis/motion/exact_run.hpp"
#include "analysis/motion/motion_end.hpp"
#include "analysis/motion/motion_record.hpp"
#include "analysis/motion/reversal_steps.hpp"
#include "analysis/motion/slider_swings.hpp"
#include "analysis/motion/stated_error.hpp"
#include "analysis/steady/linearised.hpp"
#include "analysis/steady/stability.hpp"
#include "core/eigenpairs.hpp"
#include "core/stop.hpp"
#include "oscillators/slider_system.hpp"
#include "oscillators/time_scales.hpp"
#include "solvers/steps/collocation.hpp"
#include "solvers/steps/cvode.hpp"
#include "solvers/steps/explicit.hpp"
#include "solvers/steps/growth.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"

namespace rosin::analysis::motion {

using oscillators::Mechanics;
using oscillators::SliderSystem;
using solvers::steps::Collocation;
using solvers::stick_slip::Switch;

namespace {

/// Columns before those of the states, behind which that of the acceleration stands.
enum Column : std::size_t { displacement, velocity, slip_rate, friction_force, friction_coefficient, before_states };
std::size_t columns_of(const Model& model) {
  return before_states + model.law->states().size() + (model.slider.mass > 0 ? 1 : 0);
}

/// Explicit steps until stability limits them, then collocation up to the next break of the drive.
class WhileNotStiff {
 public:
  WhileNotStiff(const SliderSystem& system, double tolerance, bool may_hand_over)
      : explicit_(system, tolerance), implicit_(system, tolerance), may_hand_over_(may_hand_over) {}

  bool start(double t, const std::vector<double>& y) {
    handed_over_ = false;
    if (!implicit_.start(t, y)) return false;  // makes algebraic unknowns consistent
    explicit_.start(t, implicit_.state());
    return true;
  }
  Outcome step(double limit) {
    if (handed_over_) return implicit_.step(limit);
    const Outcome outcome = explicit_.step(limit);
    if (may_hand_over_ && (explicit_.stiff() || !outcome.complete()) && explicit_.time() < limit) {
      if (handovers_++ == 0) first_handover_ = explicit_.time();
      handed_over_ = implicit_.start(explicit_.time(), present());
      if (!outcome.complete()) return implicit_.step(limit);
    }
    return outcome;
  }
  /// True if the last step was an implicit one.
  bool implicit() const { return handed_over_ && implicit_.time_before() < implicit_.time(); }
  double time() const { return handed_over_ ? implicit_.time() : explicit_.time(); }
  std::vector<double> state() const { return handed_over_ ? implicit_.state() : present(); }

  solvers::steps::Explicit& explicit_steps() { return explicit_; }
  Collocation& implicit_steps() { return implicit_; }
  int handovers() const { return handovers_; }
  double first_handover() const { return first_handover_; }

 private:
  std::vector<double> present() const { return {explicit_.state().begin(), explicit_.state().end()}; }

  solvers::steps::Explicit explicit_;
  Collocation implicit_;
  bool may_hand_over_, handed_over_ = false;
  int handovers_ = 0;
  double first_handover_ = 0;
};

/// Eigenvalues of steady sliding; none where the drive has no steady sliding.
std::vector<std::complex<double>> eigenvalues_of(const Model& model) {
  if (!model.drive.constant() || model.drive.speed.level() == 0) return {};
  try {
    return steady::stability(model).eigenvalues;
  } catch (const InputError&) {
    return {};
  }
}

/// Remark on the number of oscillations of the fastest mode until the end, if these take the steps.
std::string ringing_remark(const Model& model, double end) {
  double fastest = 0;
  for (const auto& e : eigenvalues_of(model))
    if (std::abs(e.imag()) > 10 * std::abs(e.real())) fastest = std::max(fastest, std::abs(e.imag()));
  const double oscillations = fastest * end / (2 * std::numbers::pi);
  return oscillations > 1e4 ? fmt::format(
                                  ": about steady sliding it rings with {:.3g} rad/s, hardly damped, and turns {:.2g} "
                                  "times until t = {:.3g} s; run.duration may be shorter",
                                  fastest, oscillations, end)
                            : "";
}

/// Remark on a run from unstable steady sliding, where rounding error grows to the size of the motion.
std::string rounding_remark(const Model& model, const RunOptions& options, double end) {
  if (options.start.kind != Start::Kind::steady) return "";
  const auto eigenvalues = eigenvalues_of(model);
  const double growth = eigenvalues.empty() ? 0 : eigenvalues.front().real();
  constexpr double digits = 36;  // e-foldings from rounding error to the size of the motion
  return growth * end > digits
             ? fmt::format(
                   ": steady sliding, from which it starts, is unstable with {:.3g} 1/s, so that rounding decides "
                   "when it is left; start beside it, run.start = {{ slip_rate = … }}",
                   growth)
             : "";
}

/// Remark on a run that stays in unstable steady sliding; empty where sliding is stable, or its stability not known.
std::string instability_remark(const Model& model) {
  try {
    const auto sliding = steady::stability(model);
    if (sliding.stable || sliding.marginal) return "";
    return fmt::format(
        "steady sliding is unstable: what disturbs it grows with {:.3g} 1/s, but nothing does; to see it grow, start "
        "beside it, run.start = {{ slip_rate = … }}",
        sliding.eigenvalues.front().real());
  } catch (const InputError&) {
    return "";
  }
}

/// True where the motion starts in steady sliding under a constant drive and all rates vanish.
bool stays_steady(const Model& model, const RunOptions& options) {
  if (options.start.kind != Start::Kind::steady || !model.drive.constant()) return false;
  SliderSystem system(model);
  const auto y = starting_point(system, options.start);
  const int n = system.size();
  system.set_mode(0, slip_along(model.drive.speed.level()));
  auto at = steady::linearise(system, y);
  for (int j = 0; j < n; ++j) at.scale[j] = std::max(std::abs(y[j]), at.scale[j]);
  for (int i = 0; i < n; ++i) {
    constexpr double rounding = 1e-12;
    if (!(std::abs(at.f[i]) <= rounding * size_of_terms(at.J.row(i).data(), at.scale.data(), n))) return false;
  }
  return true;
}

/// Moves y along the fastest growing mode of an unstable balance of forces, from a start where friction falls with the
/// slip rate. The changes of drive and states set the direction of the mode, but at first by less than rounding error
/// of friction, which would choose a random direction. The mode is followed in closed form to 10⁴ times that error.
/// \returns the time at which it gets there (s). `duration`: duration of the run. Friction must respond to the slip
/// rate at once; other friction lets no mode grow that fast.
double leave_unstable_balance(SliderSystem& system, std::vector<double>& y, double duration) {
  using Eigen::VectorXd;
  const int u = system.slip_rate_index();
  if (system.model().law->set_valued()) system.set_mode(0, slip_along(y[u]));
  const auto at = steady::linearise(system, y);
  const auto& [mass, scale, f] = std::tie(at.mass, at.scale, at.f);
  const auto [moving, A] = at.moving();
  const auto slip = std::find(moving.begin(), moving.end(), u) - moving.begin();
  if (slip == std::ssize(moving) || !A.allFinite()) return 0;
  const auto modes = eigenpairs(A, true);
  Eigen::Index fastest = 0;
  modes.values.real().maxCoeff(&fastest);
  const double growth = modes.values[fastest].real();
  constexpr double digits = 36;  // e-foldings from rounding error to the size of the motion
  if (!(growth * duration > digits) || modes.values[fastest].imag() != 0) return 0;
  VectorXd rate(moving.size());  // in units of the scales
  for (std::size_t i = 0; i < moving.size(); ++i) rate[i] = f[moving[i]] / (mass[moving[i]] * scale[moving[i]]);
  const Eigen::MatrixXcd left = modes.vectors.inverse();
  const VectorXd mode = (modes.vectors.col(fastest) / modes.vectors(slip, fastest)).real();  // per unit change of u
  const double driven = (left.row(fastest) * rate)(0).real() * modes.vectors(slip, fastest).real() * scale[u];
  // The mode grows as driven/growth·e^{growth t}.
  constexpr double beyond = 1e4, digit = std::numeric_limits<double>::epsilon();
  const double begins = std::abs(driven) / growth;
  const double clear = beyond * digit * std::abs(system.observe(0, y.data()).friction_force) / (mass[u] * growth);
  if (!(begins < clear) || begins == 0) return 0;
  const double time = std::log(clear / begins) / growth;
  for (std::size_t i = 0; i < moving.size(); ++i)
    y[moving[i]] +=
        (time * rate[i] * (moving[i] != u) + std::copysign(clear / scale[u], driven) * mode[i]) * scale[moving[i]];
  return time;
}

/// One pass at one tolerance: record and events.
class SliderPass {
 public:
  SliderPass(const Model& model, const RunOptions& options, const std::string& solver, const std::vector<double>& times,
             double stick_threshold)
      : options_(options),
        times_(times),
        system_(model, solver == "cvode" ? Unknowns::states : Unknowns::friction),
        solver_(solver),
        record_(columns_of(model), 0, times, {slip_columns(system_.model(), stick_threshold)}) {
    system_.limit_creep_for(times.back());
    record_.on_sample = [this](double t) { note_errors(t, seen_at_); };
  }

  /// `perturbed`: the start differs by rounding error, and a grazing stop is decided differently, so that quantities
  /// sensitive to either differ from pass to pass.
  void run(double tolerance, bool perturbed) {
    tolerance_ = tolerance;
    try {
      outcome_ = follow(perturbed);
    } catch (const Stopped&) {  // samples until then are valid
      outcome_ = {Ending::interrupted, fmt::format("{} of {} samples are kept", record_.samples(), times_.size())};
    }
  }

  MotionRecord& record() { return record_; }

  Outcome outcome_;
  std::vector<RunEvent> events_;
  Run::Cost cost_;
  std::map<std::string, double> metrics_;
  double wear_ = 0;                ///< J, ∫ N |v| dt
  std::string handover_;           ///< message on the change from explicit steps to collocation
  double slip_rate_error_ = 0;     ///< m/s, error of the slip rate from errors of the unknowns by the tolerance
  double slip_rate_rounding_ = 0;  ///< m/s, error of the slip rate from rounding of the forces, over the damping
  /// m, error of the displacement from rounding of the slip rate.
  double displacement_rounding_ = 0;
  std::array<double, before_states> ringing_{};  ///< error of each column, from Collocation::ringing_errors()

 private:
  Outcome follow(bool perturbed) {
    auto y = starting_point(system_, options_.start);
    if (perturbed)
      for (double& value : y) value *= 1 + 2 * std::numeric_limits<double>::epsilon();
    if (options_.start.kind != Start::Kind::rest && !options_.start.displacement) {
      system_.measure_from_balance(y);
      const bool at_once =
          options_.start.kind == Start::Kind::given && (solver_ == "events" || system_.model().lambda == 0);
      if (at_once && system_.slip_rate(0, y.data()) != 0) begin_ = leave_unstable_balance(system_, y, times_.back());
    }
    if (solver_ == "steady") system_.set_mode(0, slip_along(system_.model().drive.speed.level()));
    if (system_.size() == 0 || solver_ == "steady") {
      if (system_.model().law->set_valued()) metrics_["stick_time"] = 0;
      record_.rest(times_.back(), true, at(y));
      return {};
    }
    if (solver_ == "events") return with_events(y, tolerance_, perturbed);
    if (solver_ == "cvode") return with_cvode(y, tolerance_);
    if (solver_ == "explicit") return while_not_stiff(y, tolerance_);
    return with_collocation(y, tolerance_);
  }

  void observe(double t, const double* y, double* row) {
    const auto seen = system_.observe(t, y);
    row[displacement] = seen.displacement, row[velocity] = seen.velocity, row[slip_rate] = seen.slip_rate;
    row[friction_force] = seen.friction_force, row[friction_coefficient] = seen.friction_coefficient;
    std::ranges::copy(seen.state, row + before_states);
    if (system_.model().slider.mass > 0) row[columns_of(system_.model()) - 1] = seen.acceleration;
    seen_at_ = y;
  }
  /// The rows of a motion that stays at y.
  MotionRecord::Row at(const std::vector<double>& y) {
    return [this, &y](double t, double* row) { observe(t, y.data(), row); };
  }
  void add_event(double t, const double* y, std::string kind) {
    events_.push_back({t, std::move(kind), system_.observe(t, y).displacement});
  }
  void take_ringing(const Collocation& solver) {
    const auto errors = solver.ringing_errors();
    if (system_.carries_friction()) {
      double load = 0;
      for (const double t : times_) load = std::max(load, std::abs(system_.model().drive.normal_load.value(t)));
      ringing_[friction_coefficient] = errors[system_.first_state() - 1];
      ringing_[friction_force] = ringing_[friction_coefficient] * load;
    }
    // Without mass or damping the displacement is no unknown: the spring force equals friction.
    ringing_[displacement] = system_.mechanics() == Mechanics::elastic
                                 ? ringing_[friction_force] / system_.model().slider.stiffness
                                 : errors[0];
    if (const int u = system_.slip_rate_index(); u >= 0) ringing_[velocity] = ringing_[slip_rate] = errors[u];
  }
  /// What rounding and the solver's own error leave of the quantities at a sample.
  void note_errors(double t, const double* y) {
    const auto seen = system_.observe(t, y);
    constexpr double digit = std::numeric_limits<double>::epsilon();
    if (solver_ == "explicit") {
      slip_rate_error_ = std::max(slip_rate_error_, slip_rate_error(t, y, seen.slip_rate, tolerance_, 0));
      const double rounded = slip_rate_error(t, y, seen.slip_rate, 0, 4 * digit);
      displacement_rounding_ = std::max(displacement_rounding_, rounded * t);
    } else if (solver_ == "cvode") {
      // BDF adds up short steps with a rounding error each.
      const double digits = 3 * digit * std::sqrt(double(steps_));
      if (system_.mechanics() != Mechanics::inertial || system_.contact_setup().spring.present())
        slip_rate_error_ = std::max(slip_rate_error_, slip_rate_error(t, y, seen.slip_rate, tolerance_, digits));
    }
    if (system_.mechanics() == Mechanics::damped &&
        solver_ == "collocation")  // the damper carries the difference of the forces
      slip_rate_rounding_ = std::max(slip_rate_rounding_, slip_rate_error(t, y, seen.slip_rate, 0, digit));
    if (system_.mechanics() == Mechanics::inertial && solver_ != "steady") {
      const auto [sum, largest, loss, damping, swing_impedance] = balance_at(t, y, seen);
      const double inertia =
          system_.model().slider.mass / times_.back();  // the impedance where there is no damping and no spring
      const double resists = std::max({damping, swing_impedance, inertia});
      const bool from_balance = options_.start.kind == Start::Kind::steady;  // forces balance to rounding error
      if (solver_ == "cvode")  // whose steps excite ringing by the residual of the balance
        slip_rate_error_ = std::max(slip_rate_error_, (digit * largest + loss) / resists);
      else if (damping > swing_impedance || from_balance)
        slip_rate_rounding_ = std::max(slip_rate_rounding_, digit * largest / resists);
    }
  }

  /// Error of a slip rate (m/s) that is no unknown but follows from friction and states, or from the difference of
  /// forces.
  /// `tolerance`: error of the unknowns in their scales; `digits`: their relative rounding error. The rounding losses
  /// of the steps add.
  double slip_rate_error(double t, const double* y, double slip_rate, double tolerance, double digits) const {
    std::vector<double> neighbour(y, y + system_.size()), scale(system_.size());
    system_.scale(y, scale.data());
    double sum = 0;
    for (std::size_t i = 0; i < scale.size(); ++i) {
      const double loss = rounding_loss_.empty() ? 0 : std::abs(rounding_loss_[i]);
      neighbour[i] = y[i] + std::max(tolerance * scale[i], digits * std::abs(y[i])) + loss;
      if (const double moved = std::abs(system_.slip_rate(t, neighbour.data()) - slip_rate); std::isfinite(moved))
        sum += moved;
      neighbour[i] = y[i];
    }
    return sum;
  }

  /// Steps of any solver, cut at breaks of the drive, where values are those after the break.
  template <class Solver, class Advance>
  Outcome between_breaks(Solver& solver, std::vector<double> y, Advance advance) {
    const double end = times_.empty() ? options_.duration : std::max(options_.duration, times_.back());
    double t = std::min(begin_, end);
    record_.rest(t, false, at(y));
    while (true) {
      start(solver, t, y);
      const double next = system_.next_break(t), limit = std::min(end, next);
      while (solver.time() < limit) {
        if (++steps_ > options_.most_steps) {
          if (const auto end = why_rest_lasts(system_, solver.time(), solver.state().data()))
            return {Ending::none_exists, *end};
          return {Ending::budget_spent, fmt::format("{} steps at t = {:.9g} s{}", options_.most_steps, solver.time(),
                                                    ringing_remark(system_.model(), end))};
        }
        if (const Outcome outcome = advance(limit); !outcome.complete()) return outcome;
        if (options_.progress) options_.progress(solver.time() / end);
        if (system_.model().lambda == 0)
          if (const auto never = why_nothing_slips_again(system_, solver.time(), solver.state().data()))
            return {Ending::none_exists, *never};
      }
      y = solver.state();
      t = limit;
      if (t == next) system_.cross_break(t, y.data());
      if (t >= end) {
        record_.rest(end, true, at(y));
        metrics_["wear_work_rate"] = wear_ / end;
        return {};
      }
    }
  }
  /// The outcome of a failed step, with the reason if the motion ends there.
  template <class Solver>
  Outcome with_reason(const Outcome& outcome, const Solver& solver) const {
    const auto end = why_motion_ends(system_, solver.time(), solver.state().data());
    return end ? Outcome{Ending::none_exists, *end} : outcome;
  }
  /// Takes a step; slip that runs away in it is an outcome.
  template <class Solver>
  Outcome take_step(Solver& solver, double limit) {
    const Outcome outcome = solver.step(limit);
    if (!outcome.complete()) return with_reason(outcome, solver);
    const auto away = why_slip_runs_away(system_, solver.time(), solver.state().data());
    return away ? Outcome{Ending::none_exists, *away} : outcome;
  }
  bool start(Collocation& solver, double t, const std::vector<double>& y) { return solver.start(t, y); }
  bool start(WhileNotStiff& solver, double t, const std::vector<double>& y) { return solver.start(t, y); }
  bool start(solvers::stick_slip::StickSlip& solver, double t, const std::vector<double>& y) {
    return solver.start(t, y);
  }
  bool start(solvers::steps::Cvode& solver, double t, const std::vector<double>& y) {
    solver.start(t, y);
    return true;
  }

  /// ∫ N |v| dt over a step. \param go_to  puts the state at a time of it into y
  template <unsigned points, class GoTo>
  void add_wear(double t0, double t1, const std::vector<double>& y, GoTo go_to) {
    const auto rate = [&](double t) {
      go_to(t);
      return system_.model().drive.normal_load.value(t) * std::abs(system_.contact_slip_rate(t, y.data()));
    };
    wear_ += boost::math::quadrature::gauss<double, points>::integrate(rate, t0, t1);
  }

  /// Records samples and, for smooth laws, reversals in the last step of a collocation.
  void record_step(Collocation& step, bool reversals) {
    std::vector<double> y(system_.size());
    const double t0 = step.time_before(), h = step.length();
    if (reversals) {
      double low = 0, before = system_.slip_rate(t0, step.state_before().data());
      for (int i = 0; i < Collocation::stages; ++i) {
        step.stage(i, y.data());
        const double theta = step.node(i), here = system_.slip_rate(step.stage_time(i), y.data());
        if ((before < 0 && here > 0) || (before > 0 && here < 0)) {
          const auto at =
              step.locate([&](double t, const double* z) { return system_.slip_rate(t, z); }, low, theta, before, here);
          if (at && step.solve_at(*at, y.data())) add_event(t0 + *at * h, y.data(), "reversal");
        }
        low = theta, before = here;
      }
    }
    add_wear<7>(t0, step.time(), y, [&](double t) { step.interpolate((t - t0) / h, y.data()); });
    record_.step(step, [this](double t, const double* z, double* row) { observe(t, z, row); });
  }

  /// The same for an explicit step. Under a constant drive slip reverses at most once in a step, and the signs at its
  /// ends show it; else a few points of the dense output count too.
  void record_step(solvers::steps::Explicit& step) {
    std::vector<double> y(system_.size());
    const double t0 = step.time_before(), t1 = step.time();
    const auto slip_rate_at = [&](double t) {
      step.interpolate(t, y.data());
      return system_.slip_rate(t, y.data());
    };
    const int parts = system_.autonomous() ? 1 : 4;
    double low = t0, before = slip_rate_at(t0);
    for (int i = 1; i <= parts; ++i) {
      const double high = i == parts ? t1 : t0 + i * (t1 - t0) / parts, here = slip_rate_at(high);
      if ((before < 0 && here > 0) || (before > 0 && here < 0)) {
        double a = low, b = high;
        for (double middle = 0.5 * (a + b); middle > a && middle < b; middle = 0.5 * (a + b))
          ((slip_rate_at(middle) > 0) == (before > 0) ? a : b) = middle;
        step.interpolate(b, y.data());
        add_event(b, y.data(), "reversal");
      }
      low = high, before = here;
    }
    add_wear<3>(t0, t1, y, [&](double t) { step.approximate(t, y.data()); });
    record_.step(
        t0, t1, step.inner_times(),
        [&](double t, double* row) {
          step.approximate(t, y.data());
          observe(t, y.data(), row);
        },
        [&, last = std::nextafter(t1, t0)](double t, double* row) {
          step.interpolate(t >= last ? t1 : t, y.data());
          observe(t, y.data(), row);
        });
  }

  Outcome while_not_stiff(const std::vector<double>& y, double tolerance) {
    WhileNotStiff solver(system_, tolerance, options_.solver == "auto");
    const Outcome outcome = between_breaks(solver, y, [&](double limit) {
      const Outcome o = take_step(solver, limit);
      if (!o.complete()) return o;
      if (solver.implicit())
        record_step(solver.implicit_steps(), true);
      else
        record_step(solver.explicit_steps());
      return o;
    });
    const auto& few = solver.explicit_steps().count();
    const auto& rest = solver.implicit_steps().count();
    cost_ = {few.steps + rest.steps, few.evaluations + rest.evaluations + rest.linearisations};
    if (solver.handovers() > 0)
      handover_ =
          fmt::format("; at t = {:.6g} s stability held their steps: collocation from there{}", solver.first_handover(),
                      solver.handovers() > 1 ? fmt::format(", {} times in all", solver.handovers()) : "");
    return outcome;
  }

  Outcome with_collocation(const std::vector<double>& y, double tolerance) {
    Collocation solver(system_, tolerance);
    solver.resolve_starts();
    const ReversalSteps reversal_steps(system_);
    const Outcome outcome = between_breaks(solver, y, [&](double limit) {
      solver.bound_step(reversal_steps.longest(solver));
      const Outcome o = take_step(solver, limit);
      if (!o.complete()) return o;
      record_step(solver, true);
      return o;
    });
    cost_ = {solver.count().steps, solver.count().evaluations + solver.count().linearisations};
    take_ringing(solver);
    return outcome;
  }

  /// Whether slip with a minimum within its error of rest sticks there is uncertain (grazing). Two passes that differ
  /// in `rest_in_doubt` decide differently, and their difference shows the effect.
  Outcome with_events(const std::vector<double>& y, double tolerance, bool rest_in_doubt) {
    const SliderSwings swings(system_);
    solvers::stick_slip::StickSlip solver(system_, tolerance, swings.present());
    if (rest_in_doubt) solver.rest_in_doubt(oscillators::remembers(system_.model()));
    double stuck_since = 0, stuck = 0;
    const Outcome outcome = between_breaks(solver, y, [&](double limit) {
      const bool sticking_before = system_.mode() == ContactMode::stick;
      Switch switched;
      const Outcome o = solver.step(limit, switched);
      if (!o.complete()) return with_reason(o, solver);
      record_step(solver.stepper(), false);
      const bool sticking = system_.mode() == ContactMode::stick;
      if (sticking && !sticking_before) stuck_since = solver.stepper().time_before();
      if (sticking) {
        stuck += solver.time() - std::max(stuck_since, solver.stepper().time_before());
      }
      if (switched == Switch::stick || switched == Switch::slip) record_.switched(0, switched == Switch::slip);
      if (switched != Switch::none) add_event(solver.time(), solver.state().data(), name(switched));
      return o;
    });
    metrics_["stick_time"] = stuck;
    cost_ = {solver.stepper().count().steps,
             solver.stepper().count().evaluations + solver.stepper().count().linearisations};
    take_ringing(solver.stepper());
    return outcome;
  }

  Outcome with_cvode(const std::vector<double>& y, double tolerance) {
    solvers::steps::Cvode solver(system_, tolerance, 1,
                                 [&](double t, const double* z, double* value) { *value = system_.slip_rate(t, z); });
    const int n = system_.size();
    std::vector<double> z(n), state_before(n), rate(n);
    rounding_loss_.assign(n, 0);
    constexpr double one_ahead = 0.2;  // share of a step: CVODE has chosen the next one before the bound is set
    const ReversalSteps reversal_steps(system_, one_ahead);
    const Outcome outcome = between_breaks(solver, y, [&](double limit) {
      const double before = solver.time();
      state_before = solver.state();
      const Outcome o = solver.step(limit);
      if (!o.complete()) return with_reason(o, solver);
      solver.rate(rate.data());
      for (int i = 0; i < n; ++i)
        if (solver.state()[i] == state_before[i]) rounding_loss_[i] += (solver.time() - before) * rate[i];
      const double clock = 1e-10 * solver.time();  // shorter steps would be at rounding error of the time
      solver.bound_step(std::max(clock, reversal_steps.longest(before, state_before.data(), solver.time(),
                                                               solver.state().data(), solver.time() - before)));
      const double h = solver.time() - before;
      const double inside[] = {before + 0.25 * h, before + 0.5 * h, before + 0.75 * h};
      add_wear<3>(before, solver.time(), z, [&](double t) { solver.interpolate(t, z.data()); });
      record_.step(before, solver.time(), inside, [&](double t, double* row) {
        solver.interpolate(t, z.data());
        observe(t, z.data(), row);
      });
      if (damps_growth(solver, solver.time() - before))
        return Outcome{
            Ending::tolerance_not_met,
            fmt::format("at t = {:.9g} s a step of {:.3g} s is longer than slip takes to grow there, which it "
                        "damps; use 'collocation'",
                        solver.time(), solver.time() - before)};
      if (!in_balance(solver, rate, tolerance))
        return Outcome{Ending::tolerance_not_met,
                       fmt::format("at t = {:.9g} s slip, {:.3g} m/s, is too slow for its error to keep friction in "
                                   "balance with the spring; use 'collocation'",
                                   solver.time(), system_.slip_rate(solver.time(), solver.state().data()))};
      if (o.ending == Ending::event) add_event(solver.time(), solver.state().data(), "reversal");
      return o;
    });
    cost_ = {solver.count().steps, solver.count().evaluations};
    // Shorter steps would lose more to rounding.
    if (outcome.complete() && loses_small_changes_)
      return {Ending::tolerance_not_met,
              "steps move the spring or friction by less than the last digit of their force; use 'collocation'"};
    return outcome;
  }

  /// True if a step of this length damps a growing mode.
  bool damps_growth(const solvers::steps::Cvode& solver, double step) {
    const int n = system_.size();
    std::vector<double> f(n), mass(n), J(n * n);
    system_.linearise(solver.time(), solver.state().data(), f.data(), J.data());
    system_.mass(solver.time(), mass.data());
    return step > 0 && solvers::steps::GrowthTest(n).faster_than(1 / step, mass, J);
  }

  /// Balance of a slider with mass: sum and largest of its forces and rounding loss in them (N), damping with
  /// friction's, and impedance √(k m) of its free oscillation (N s/m).
  struct ForceBalance {
    double sum, largest, loss, damping, swing_impedance;
  };
  ForceBalance balance_at(double t, const double* y, const oscillators::Observation& seen) {
    const int n = system_.size(), u = system_.slip_rate_index();
    const auto& slider = system_.model().slider;
    work_.resize(n + n * n);
    double *f = work_.data(), *J = f + n;
    system_.linearise(t, y, f, J);
    double loss = 0;
    for (std::size_t i = 0; i < rounding_loss_.size(); ++i) loss += std::abs(J[u * n + i] * rounding_loss_[i]);
    double damping = std::abs(J[u * n + u]);
    if (const int mu = system_.first_state() - 1; system_.rigid() && mu > u && J[mu * n + mu] != 0)
      damping += std::abs(J[u * n + mu] * J[mu * n + u] / J[mu * n + mu]);  // the direct effect
    return {f[u], std::max(std::abs(seen.friction_force), std::abs(slider.stiffness * y[0])), loss, damping,
            std::sqrt(slider.stiffness * slider.mass)};
  }

  /// In deep stick friction depends on the slip rate below the resolution of natural unknowns. False where the motion
  /// has left the balance of forces for good. Notes where short steps change the spring force or friction by less than
  /// rounding error.
  bool in_balance(const solvers::steps::Cvode& solver, const std::vector<double>& rate, double tolerance) {
    if (system_.mechanics() != oscillators::Mechanics::inertial) return true;
    constexpr double gone = 0.3;
    const double t = solver.time(), *y = solver.state().data();
    const int n = system_.size(), u = system_.slip_rate_index();
    std::vector<double> mass(n), scale(n);
    system_.mass(t, mass.data());
    system_.scale(y, scale.data());
    const auto [sum, largest, loss, damping, swing_impedance] = balance_at(t, y, system_.observe(t, y));
    const double impedance = std::max(damping, swing_impedance);
    loses_small_changes_ = loses_small_changes_ || loss > tolerance * impedance * scale[u];
    return std::abs(sum - mass[u] * rate[u]) <= gone * largest;
  }

  const RunOptions& options_;
  const std::vector<double>& times_;
  SliderSystem system_;
  std::string solver_;
  double tolerance_ = 0;
  MotionRecord record_;
  const double* seen_at_ = nullptr;  ///< the unknowns of the last row of the record
  std::vector<double> work_;
  double begin_ = 0;  ///< s, start of the steps
  long steps_ = 0;
  std::vector<double> rounding_loss_;  ///< change of each unknown that CVODE's steps lost to rounding
  bool loses_small_changes_ = false;   ///< the rounding loss exceeds the tolerance
};

struct Choice {
  std::string solver, why;
};
Choice choose_solver(const Model& model, const RunOptions& options) {
  const std::string& requested = options.solver;
  const auto known = solver_names();
  if (std::find(known.begin(), known.end(), requested) == known.end()) {
    const auto near = nearest_name(requested, known);
    throw InputError(fmt::format("unknown solver '{}' (known: {}){}", requested, fmt::join(known, ", "),
                                 near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
  }
  if (requested == "auto" && stays_steady(model, options))
    return {"steady", "it starts in steady sliding, and under a constant drive nothing changes: nothing is integrated"};
  const bool set_valued = model.law->set_valued();
  if (solvers::force_algorithms::is_algorithm(requested)) {
    const auto form = dry_oscillator(model);
    if (const auto* why_not = std::get_if<std::string>(&form))
      throw InputError(
          fmt::format("solver '{}' is for Coulomb friction on a mass and a spring: {}", requested, *why_not));
    return {requested, "as asked, with steps of its own; its errors are the differences to the exact motion"};
  }
  if (set_valued && std::isinf(model.slider.stiffness)) {
    if (requested != "auto" && requested != "collocation")
      throw InputError(fmt::format("solver '{}' does not fit an imposed slip rate; use 'collocation'", requested));
    return {"collocation", SliderSystem(model).size() == 0
                               ? "the slip rate is imposed and friction follows at once: nothing is integrated"
                               : "the slip rate is imposed and keeps its sign: nothing sticks"};
  }
  if (set_valued && (requested == "auto" || requested == "exact")) {
    const auto form = dry_oscillator(model);
    const auto* why_not = std::get_if<std::string>(&form);
    if (!why_not)
      return {"exact", "motion is linear between events: its closed form, with events that cannot be missed"};
    if (requested == "exact") throw InputError(fmt::format("solver 'exact' has no closed form here: {}", *why_not));
    return {"events", "the law is set-valued at rest: switches are located events; no closed form: " + *why_not};
  }
  if (requested != "auto" && set_valued != (requested == "events"))
    throw InputError(fmt::format("solver '{}' does not fit law '{}', which is {} at rest; use '{}'", requested,
                                 model.law->card().name, set_valued ? "set-valued" : "smooth",
                                 set_valued ? "events" : "collocation"));
  if (requested != "auto" && requested != "explicit") return {requested, "as asked"};
  const bool has_flow = SliderSystem(model).has_flow();
  if (requested == "explicit") {
    if (!has_flow)
      throw InputError(
          "solver 'explicit' needs a slider without mass on a spring, a law with explicit slip rate and lambda > 0 "
          "(with a damper: a rigid contact and a constant load); use 'collocation'");
    return {requested, "as asked, also where stability holds its steps"};
  }
  if (!has_flow) return {"collocation", "the motion is stiff, or may be"};
  constexpr double explicit_least = 1e-11;
  if (options.tolerance < explicit_least) return {"collocation", "order 9 wins at so small a tolerance"};
  return {"explicit", "no inertia, friction and logarithmic states change evenly: explicit steps while none is stiff"};
}

/// Smallest reference size of each column, which may pass zero or hold only rounding error: the drive speed for slip
/// rate and velocity of a mass, the natural size for states, friction in steady sliding where a state carries friction,
/// and that over the mass for the acceleration, in which spring and friction nearly cancel.
std::vector<double> least_sizes(const Model& model) {
  const SliderSystem system(model);
  const auto& law = *model.law;
  const double V = std::abs(model.drive.speed.level()), N = model.drive.normal_load.level();
  std::vector<double> sizes(columns_of(model));
  // Without mass the slip rate follows from friction, to its own rounding error.
  if (model.slider.mass > 0) sizes[velocity] = sizes[slip_rate] = V;
  if (model.slider.mass > 0 && V > 0)
    sizes.back() = std::abs(law.steady_friction({V, N}).friction) * N / model.slider.mass;
  if (law.deflects() && V > 0) {
    sizes[friction_coefficient] = std::abs(law.steady_friction({V, N}).friction);
    sizes[friction_force] = N * sizes[friction_coefficient];
  }
  if (model.lambda == 0) return sizes;
  std::vector<double> scale(system.size());
  const std::vector<double> zero(system.size());
  system.scale(zero.data(), scale.data());
  for (std::size_t i = 0; i < law.states().size(); ++i)
    if (law.states()[i].scale == Scale::linear) sizes[before_states + i] = scale[system.first_state() + i];
  return sizes;
}

/// Reference size for the errors of each column: its largest value in the motion, and at least `least`.
std::vector<double> sizes_of(const MotionRecord& record, std::vector<double> least) {
  for (std::size_t c = 0; c < least.size(); ++c) least[c] = std::max(least[c], record.size(c));
  least[velocity] = std::max(least[velocity], least[slip_rate]);
  return least;
}

/// Two passes of a stepping solver, the finer of which is kept; their difference is the error.
void run_twice(const Model& model, const RunOptions& options, double stick_threshold, const std::vector<double>& times,
               Run& result) {
  // BDF's errors exceed its tolerance about tenfold; collocation mostly stays below it. The measured error, not the
  // solver's, must meet the requested tolerance: the pair of passes is tightened until it does.
  const double least = result.solver == "cvode"      ? 3e-15
                       : result.solver == "explicit" ? solvers::steps::Explicit::least_tolerance
                                                     : Collocation::least_tolerance;
  double tolerance = options.tolerance * (result.solver == "cvode" ? 0.03 : 0.3);
  const auto least_size = least_sizes(model);
  const auto add_cost = [&](const SliderPass& pass) {
    result.cost.steps += pass.cost_.steps, result.cost.evaluations += pass.cost_.evaluations;
  };
  const auto new_pass = [&] {
    return std::make_unique<SliderPass>(model, options, result.solver, times, stick_threshold);
  };
  auto coarse = new_pass();
  // A decaying perturbation would look stiff to explicit steps.
  const bool perturbs = result.solver != "explicit";
  coarse->run(tolerance, perturbs);
  add_cost(*coarse);
  std::unique_ptr<SliderPass> fine;
  std::vector<ErrorRule> rules;
  for (int attempt = 0;; ++attempt, coarse = std::move(fine)) {
    tolerance = std::max(0.01 * tolerance, least);
    fine = new_pass();
    fine->run(tolerance, perturbs && attempt % 2 == 1);
    if (fine->outcome_.ending == Ending::interrupted && fine->record().samples() < coarse->record().samples()) {
      fine = std::move(coarse);  // the coarse pass came further
      fine->outcome_ = {Ending::interrupted, fmt::format("{} of {} samples are kept, without errors",
                                                         fine->record().samples(), times.size())};
      coarse = new_pass();
    }
    result.outcome = fine->outcome_;
    add_cost(*fine);
    const auto& sizes = result.column_size = sizes_of(fine->record(), least_size);
    // Samples may be of a part of the motion that is small, such as the creep behind a slip.
    auto sampled = least_size;
    for (std::size_t c = 0; c < sampled.size(); ++c)
      for (const double x : fine->record().columns()[c]) sampled[c] = std::max(sampled[c], std::abs(x));
    // Two passes may agree by chance: the stated error is at least a hundredth of the requested tolerance. Where curves
    // have kinks, errors do not fall with the tolerance: six times the difference is stated.
    const double least_claimed = std::max((result.solver == "cvode" ? 30 : 3) * tolerance, 0.01 * options.tolerance);
    rules.assign(sizes.size(), {6, least_claimed + 5e-14, 0});
    for (std::size_t c = 0; c < before_states; ++c) rules[c].floor = fine->ringing_[c];
    rules[displacement].floor += fine->displacement_rounding_;
    constexpr double exceed = 10;  // largest error of the unknowns, in tolerances
    for (const Column c : {velocity, slip_rate})
      rules[c].floor += exceed * fine->slip_rate_error_ + fine->slip_rate_rounding_;
    const auto& [mass, stiffness, damping] = model.slider;
    if (mass > 0)
      rules.back().floor =
          (rules[friction_force].floor + stiffness * rules[displacement].floor + damping * rules[velocity].floor) /
          mass;
    // The acceleration follows from the others, and magnifies their errors: the tolerance is not of it.
    const std::size_t counted = sizes.size() - (mass > 0 ? 1 : 0);
    std::vector<double> ratio(counted);
    std::size_t worst = 0;
    const auto state_errors = [&] {
      result.column_error.clear();
      for (std::size_t c = 0; c < sizes.size(); ++c) {
        const double difference = largest_difference(coarse->record().columns()[c], fine->record().columns()[c]);
        result.column_error.push_back(rules[c].error(difference, sampled[c]));
        if (c < counted) ratio[c] = sizes[c] > 0 ? result.column_error[c] / sizes[c] : 0;
      }
      worst = std::size_t(std::ranges::max_element(ratio) - ratio.begin());
    };
    state_errors();
    const bool last_attempt = attempt == 3 || tolerance <= least;
    const auto ended = [](const SliderPass& pass) { return pass.outcome_.ending == Ending::none_exists; };
    if (ended(*fine) && !ended(*coarse) && !last_attempt) continue;  // only one pass came to an end
    if (!result.outcome.complete()) break;
    if (ratio[worst] > options.tolerance && last_attempt && coarse->outcome_.complete()) {
      // The difference is the error of the coarser pass; that of the finer shows beside one nearly as fine, from a
      // start that differs by rounding.
      constexpr double nearly = 3;
      auto beside = new_pass();
      beside->run(nearly * tolerance, !perturbs || attempt % 2 == 0);
      add_cost(*beside);
      if (beside->outcome_.complete()) coarse = std::move(beside);
      state_errors();
    }
    if (ratio[worst] <= options.tolerance) {
      for (std::size_t c = 0; c < sizes.size(); ++c)
        result.column_error[c] = with_caution(result.column_error[c], sizes[c], options.tolerance);
      break;
    }
    if (last_attempt) {
      result.outcome = {Ending::tolerance_not_met,
                        fmt::format("{} is known to {:.1e} of its size only{}", result.column_names[worst],
                                    ratio[worst], rounding_remark(model, options, times.back()))};
      break;
    }
  }
  state_what_is_seen(fine->record(), coarse->record().samples() > 0 ? &coarse->record() : nullptr, rules, result);
  result.columns = fine->record().columns();
  result.why = result.why + fine->handover_;
  result.events = std::move(fine->events_);
  state_event_errors(result, coarse->events_, {rules.front().times, rules.front().least}, options.tolerance);
  for (const auto& [name, value] : fine->metrics_) result.metrics[name] = value;
  if (const auto wear = fine->metrics_.find("wear_work_rate"); wear != fine->metrics_.end()) {
    const auto other = coarse->metrics_.find(wear->first);
    const double difference = other != coarse->metrics_.end() ? std::abs(other->second - wear->second) : infinity;
    result.metric_error[wear->first] =
        ErrorRule{rules.front().times, rules.front().least}.error(difference, wear->second);
  }
}

}  // namespace

std::vector<double> sample_times(const RunOptions& options) {
  if (!options.times.empty()) {
    double before = -1;
    for (const double t : options.times) {
      if (!(t > before) || !std::isfinite(t) || t < 0)
        throw InputError(fmt::format("run.times must ascend from 0 or later, got {} s after {} s", t, before));
      before = t;
    }
    return options.times;
  }
  require(options.duration, {1e-300, 1e300}, "run.duration", "time to run", "s");
  require(options.samples, {1, 1e8}, "run.samples", "number of intervals between samples", "1");
  std::vector<double> times(options.samples + 1);
  for (int i = 0; i <= options.samples; ++i) times[i] = options.duration * i / options.samples;
  return times;
}

std::vector<std::string> solver_names() {
  std::vector<std::string> names = {"auto", "exact", "explicit", "collocation", "cvode", "events"};
  for (const auto& algorithm : solvers::force_algorithms::algorithms()) names.emplace_back(algorithm.name);
  return names;
}

Run run(const Model& model, const RunOptions& options, double stick_threshold) {
  model.check();
  require(options.tolerance, {1e-13, 0.1}, "tolerance", "relative accuracy of a run", "1");
  Run result;
  const Choice choice = choose_solver(model, options);
  result.solver = choice.solver;
  result.why = choice.why;
  if (choice.solver == "steady") result.remark = instability_remark(model);
  const auto times = sample_times(options);
  result.column_names = {"displacement", "velocity", "slip_rate", "friction_force", "friction_coefficient"};
  result.column_units = {"m", "m/s", "m/s", "N", "1"};
  for (const auto& s : model.law->states()) {
    result.column_names.push_back(s.name);
    result.column_units.push_back(s.unit);
  }
  if (model.slider.mass > 0)
    result.column_names.emplace_back("acceleration"), result.column_units.emplace_back("m/s^2");
  const Run empty = result;
  if (result.solver == "exact")
    run_exactly(model, std::get<solvers::stick_slip::DryOscillator>(dry_oscillator(model)), options, times, result);
  else if (solvers::force_algorithms::is_algorithm(result.solver))
    run_algorithm(model, std::get<solvers::stick_slip::DryOscillator>(dry_oscillator(model)), options, times, result);
  else
    run_twice(model, options, stick_threshold, times, result);
  if (result.outcome.ending == Ending::tolerance_not_met && result.solver == "explicit" && options.solver == "auto") {
    // Explicit steps are accurate to 1e-14 of the unknowns at best, and successive slips may magnify that error.
    Run tighter = empty;
    tighter.solver = "collocation";
    tighter.why = "explicit steps come too little close";
    run_twice(model, options, stick_threshold, times, tighter);
    tighter.cost.steps += result.cost.steps, tighter.cost.evaluations += result.cost.evaluations;
    if (tighter.outcome.complete()) result = std::move(tighter);
  }
  result.time.assign(times.begin(), times.begin() + result.columns[0].size());
  for (std::size_t c = 0; c < result.columns.size(); ++c)
    for (const double x : result.columns[c])
      if (!std::isfinite(x) && result.outcome.complete())
        result.outcome = {Ending::not_finite, fmt::format("in column '{}'", result.column_names[c])};
  return result;
}

}  // namespace rosin::analysis::motion
