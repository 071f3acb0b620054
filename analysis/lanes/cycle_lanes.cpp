/// The search for a cycle as a state machine per slider: settle at a loose tolerance, settle at a tight one, compare.
#include "analysis/lanes/cycle_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "analysis/cycles/loop_area.hpp"
#include "analysis/cycles/return_map.hpp"
#include "core/eigenpairs.hpp"
#include "core/linear_solve.hpp"

namespace rosin::analysis::lanes {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double coarser = 10;           ///< ratio of the tolerances that are compared
constexpr double transient_ratio = 16;   ///< tolerance of unmeasured returns over that of measured ones
constexpr double loosest = 1e-4;         ///< tolerance above which steps are unreliable
constexpr int most_returns = 60;         ///< returns of one slider
constexpr long most_tries = 60'000;      ///< step attempts of one slider in lanes, before find_cycle() takes over
constexpr double probe_distance = 1e-3;  ///< relative distance from a cycle at which its attraction is tested
constexpr double collapsed = 1e-3;       ///< amplitudes |v − V|/V below this are left to find_cycle()
// Next to stable steady sliding:
constexpr double dead = 0.02;                      ///< amplitudes below this die out
constexpr double repeats = 1e-3;                   ///< relative change per return below which a cycle is near,
constexpr double nearly_repeats = 0.05;            ///< or below this if the changes fall fast
constexpr int most_plain_returns = 60;             ///< returns without extrapolation
constexpr std::array<double, 2> ages = {1, 1e-4};  ///< slip rates over V of the state at the start; lower: longer stick

Recording recording_for(double stick_threshold, const std::vector<std::string>& metrics) {
  Recording r;
  r.stick_threshold = stick_threshold;
  for (const auto& name : metrics) {
    const auto member = cycles::find_metric(name).member;
    const auto is = [&](auto... candidates) { return ((member == candidates) || ...); };
    r.stick_fraction |= is(&cycles::Metrics::stick_fraction);
    r.slow_fraction |= is(&cycles::Metrics::slow_fraction);
    r.stick_fraction_001 |= is(&cycles::Metrics::stick_fraction_001);
    r.stick_fraction_05 |= is(&cycles::Metrics::stick_fraction_05);
    r.loop_area |= is(&cycles::Metrics::loop_area, &cycles::Metrics::loop_area_normalised);
    r.extremes |= is(&cycles::Metrics::slip_rate_max, &cycles::Metrics::slip_rate_min, &cycles::Metrics::friction_max,
                     &cycles::Metrics::friction_min, &cycles::Metrics::loop_area_normalised);
    r.means |= is(&cycles::Metrics::friction_mean, &cycles::Metrics::slip_rate_mean);
  }
  return r;
}

/// One application of the return map P: start z, image P(z), and the metrics measured between them. Points hold the
/// differential unknowns, in units of the scale.
struct Visit {
  VectorXd start, image;
  VectorXd metrics;  ///< empty: not measured
  double tolerance;
  double noise;  ///< scatter of images by errors of the steps
};

/// The search for the cycle of one slider, by Newton's method on z = P(z) with Broyden's update of the derivative from
/// successive returns. The derivative of the metrics by z is updated likewise; it extrapolates them to the fixed point.
struct LaneSearch {
  LaneSearch(const Model& model, double wanted)
      : map(model),
        requested(wanted),
        sticks(model.law->set_valued()),
        deflects(model.law->deflects()),
        sliding_attracts(!sticks && map.growth_time() == infinity) {
    // At the onset of slip the states of the contact determine the motion.
    for (const int i : map.differential())
      if (!sticks || i > map.system().slip_rate_index()) coordinates.push_back(i);
    std::vector<double> s(map.system().size());
    map.system().relevance_scale(s.data());
    scale.resize(coordinates.size());
    for (int k = 0; k < scale.size(); ++k) scale[k] = s[coordinates[k]];
  }
  cycles::ReturnMap map;
  double requested;              ///< requested tolerance of the metrics
  bool sticks;                   ///< the law is set-valued
  bool deflects;                 ///< the contact rings through each stick
  bool sliding_attracts;         ///< steady sliding is stable
  std::size_t starts = 0;        ///< starts from stick so far
  double change = 0;             ///< distance of the last two points on the section
  VectorXd swing;                ///< deviation from steady sliding whose growth is measured
  int returns_at_amplitude = 0;  ///< returns of that motion
  std::vector<int> coordinates;  ///< indices of the unknowns that vary on the section
  VectorXd scale;                ///< scales of the coordinates
  LaneReturn task;
  enum class Stage { from_stick, coarse, fine, descent } stage = Stage::from_stick;
  int returns = 0, measured_returns = 0;  ///< returns in all, and at the current tolerance
  double tolerance = 0, sharpening = 0;   ///< current tolerance; the one before over it
  std::optional<Visit> last;
  MatrixXd derivative, sensitivity;  ///< derivatives of P and of the metrics by z
  VectorXd coarse;                   ///< metrics at the previous tolerance
  VectorXd fixed_point;              ///< fixed point at the tightest tolerance so far
  double amplitude = 1;              ///< |v − V|/V, predicted by neighbours
  bool predicted = false;            ///< started from the neighbours' prediction
  bool probed = false;               ///< only the attraction of the cycle is being tested
  double probe_offset = infinity;    ///< distance from the fixed point after the previous return
  VectorXd error_rate;               ///< relative errors over the tolerance
  VectorXd inherited;                ///< the same, from certified neighbours; empty: not known
  double expected_rate = 0;          ///< estimate of the largest of them; 0: not known

  void take(const KnownCycle& advice) {
    fixed_point = advice.fixed_point;
    derivative = advice.derivative;
    sensitivity = advice.sensitivity;
    derivative_error = advice.derivative_error;
    slowest = largest_multiplier();
    amplitude = advice.amplitude;
    predicted = slowest < 1;
    if (!predicted) return;
    inherited = advice.error_rate;
    expected_rate = advice.expected_rate;
  }
  /// The cycle in the form that neighbours use.
  KnownCycle knowledge(bool errors_are_smooth) const {
    const VectorXd rates = errors_are_smooth ? error_rate : VectorXd();
    return {fixed_point, derivative, sensitivity, derivative_error, task.amplitude, rates, 0};
  }
  VectorXd point() const {
    VectorXd z(coordinates.size());
    for (std::size_t k = 0; k < coordinates.size(); ++k) z[k] = task.y[coordinates[k]] / scale[k];
    return z;
  }
  VectorXd steady() const {
    const auto y = map.system().steady(0);
    VectorXd z(coordinates.size());
    for (int k = 0; k < z.size(); ++k) z[k] = y[coordinates[k]] / scale[k];
    return z;
  }
  /// Reference size for changes of a point on the section.
  double size_at(const VectorXd& z) const { return sticks ? std::max(z.norm(), 1.0) : (z - steady()).norm(); }
  /// Sets the start of the next return to z, with consistent friction where friction is algebraic.
  void start_at(const VectorXd& z) {
    const auto& system = map.system();
    for (std::size_t k = 0; k < coordinates.size(); ++k) task.y[coordinates[k]] = z[k] * scale[k];
    if (sticks) {
      const auto onset = system.loaded_at_rest(system.observe(0, task.y.data()).state, 1);
      std::copy(onset.begin(), onset.end(), task.y.begin());
    } else if (system.rigid()) {
      task.y[system.slip_rate_index()] = map.drive_speed();
      system.make_consistent(task.y.data());
    }
    // The tolerance falls with A², because the amplitude growth against which errors count does. Motion that settles by
    // a factor ρ per return sums the errors of 1/(1 − ρ) returns.
    const double A = task.amplitude;
    task.tolerance = tolerance * std::clamp(A * A, 1e-6, 1.0) * std::clamp(3 * (1 - slowest), 0.02, 1.0);
    // Motion from a start just off the cycle may cross V again at once, which is no return.
    task.dip = 0.1 * std::min(1.0, A);
    start = z;
  }
  VectorXd start;

  /// Multipliers of states much slower than a period, taken from their decay in steady sliding over as long, because
  /// these states hardly move in the returns from which the derivative is learned.
  MatrixXd kept_by_slow_states() const {
    constexpr double slow = 0.3;  // part of a disturbance that decays in a period
    const auto& system = map.system();
    const int n = system.size();
    const auto y = system.steady(0);
    std::vector<double> f(n), mass(n), J(n * n);
    system.linearise(0, y.data(), f.data(), J.data());
    system.mass(0, mass.data());
    MatrixXd kept = MatrixXd::Zero(long(coordinates.size()), long(coordinates.size()));
    for (std::size_t k = 0; k < coordinates.size(); ++k) {
      const int i = coordinates[k];
      if (i < system.first_state() || mass[i] == 0) continue;
      const double forgotten = -std::expm1(J[i * n + i] / mass[i] * task.duration);
      if (forgotten > 0 && forgotten < slow) kept(long(k), long(k)) = 1 - forgotten;
    }
    return kept;
  }

  static constexpr double learned = 0.01;   ///< error of a learned derivative
  static constexpr double least_move = 10;  ///< smallest useful step of Broyden's update, over the noise
  void learn(const Visit& visit) {
    const int n = int(visit.start.size());
    if (derivative.size() == 0) {
      derivative = sticks ? MatrixXd::Zero(n, n) : kept_by_slow_states();
      sensitivity = MatrixXd::Zero(visit.metrics.size(), n);
    }
    if (last && last->tolerance == visit.tolerance) {  // maps of different tolerances differ by more than the scatter
      const VectorXd moved = visit.start - last->start;
      const double square = moved.squaredNorm(), noise = visit.noise + last->noise;
      if (square > least_move * least_move * noise * noise) {
        derivative += (visit.image - last->image - derivative * moved) * moved.transpose() / square;
        if (visit.metrics.size() > 0 && last->metrics.size() > 0)
          sensitivity += (visit.metrics - last->metrics - sensitivity * moved) * moved.transpose() / square;
        derivative_error = learned;
      }
    }
    last = visit;
    slowest = largest_multiplier();
  }
  double slowest = 0;           ///< largest multiplier, as far as known
  double derivative_error = 1;  ///< rough error of the derivative
  double largest_multiplier() const {
    return derivative.size() == 0 ? 0.0 : eigenpairs(derivative).values.cwiseAbs().maxCoeff();
  }
  /// Residual of the last return, and the Newton step from it, over the cycle's size.
  double residual = 0, stepped = 0;
  /// The step from the start of a visit to the fixed point.
  VectorXd newton_step(const Visit& visit) const {
    const VectorXd change = visit.image - visit.start;
    if (change.size() == 0) return change;
    const MatrixXd A = MatrixXd::Identity(change.size(), change.size()) - derivative;
    VectorXd step = solve_linear(A, change);
    // A step backwards leads to a repelling fixed point; four times the change leads away from it.
    if (!step.allFinite() || step.dot(change) < 0) step = 4 * change;
    const double longest = 0.3 * size_at(visit.start) + change.norm();
    return step.norm() > longest ? VectorXd(step * (longest / step.norm())) : step;
  }
};

/// A batch in progress.
struct Work {
  CycleBatch batch;
  std::vector<std::unique_ptr<LaneSearch>> searches;  ///< null: not handled by lanes
  std::map<const ReturnLanes*, Neighbours> neighbours;
  std::size_t left = 0;  ///< unfinished searches
};

class CycleQueue final : public ReturnQueue {
 public:
  CycleQueue(double stick_threshold, const std::vector<std::string>& metrics) : stick_threshold_(stick_threshold) {
    for (const auto& name : metrics) metrics_.push_back(&cycles::find_metric(name));
    metrics_.push_back(&cycles::find_metric("period"));
  }

  /// Sets the kind of lanes that ask for tasks from now on.
  void serve(const ReturnLanes& lanes) { lanes_ = &lanes; }
  void add(Work& work) { open_.push_back(&work); }
  bool works_left() const { return !open_.empty(); }
  /// Called with each finished work; it may add others.
  std::function<void(Work&)> close;

  LaneReturn* next() override {
    if (!waiting_.empty()) {
      LaneReturn* task = waiting_.back();
      waiting_.pop_back();
      return task;
    }
    while (const auto found = first_ready()) {
      const auto [work, i] = *found;
      LaneSearch& search = *work->searches[i];
      if (const auto advice = work->neighbours.at(lanes_).advice(i)) search.take(*advice);
      if (begin(search)) {
        search.task.label = tasks_.size();
        tasks_.push_back({work, i});
        return &search.task;
      }
      finish(*work, i);
    }
    return nullptr;
  }

  void finished(LaneReturn& task) override {
    const auto [work, i] = tasks_[task.label];
    LaneCycle& cycle = work->batch.cycles[i];
    cycle.tries += task.tries;
    LaneSearch& search = *work->searches[i];
    bool goes_on = false;
    if (cycle.tries > most_tries) return finish(*work, i);
    try {
      goes_on = advance(search, cycle);
      if (cycle.found) search.start_at(search.fixed_point);
    } catch (const InputError&) {  // a step has left the range of the law
    }
    if (goes_on || (!cycle.found && begin_without_advice(search))) {
      waiting_.push_back(&task);
      return;
    }
    // A cycle of uncertain attraction is still near where its test ended.
    if (cycle.found || (search.probed && !search.sticks))
      cycle.near.assign(task.y.begin(), task.y.begin() + search.map.system().size());
    finish(*work, i);
  }

 private:
  struct Place {
    Work* work;
    std::size_t index;
  };
  std::optional<Place> first_ready() {
    for (Work* work : open_)
      if (const auto kind = work->neighbours.find(lanes_); kind != work->neighbours.end())
        if (const auto i = kind->second.next()) return Place{work, *i};
    return std::nullopt;
  }
  void finish(Work& work, std::size_t i) {
    const auto& cycle = work.batch.cycles[i];
    work.neighbours.at(lanes_).finished(
        i, cycle.found ? std::optional(work.searches[i]->knowledge(!cycle.ill_conditioned_stick)) : std::nullopt,
        cycle.tries);
    if (--work.left > 0) return;
    std::erase(open_, &work);
    close(work);
  }
  /// \returns false where there is no start.
  bool begin(LaneSearch& search) const {
    try {
      prepare(search);
      return true;
    } catch (const InputError&) {
      return begin_without_advice(search);
    }
  }
  /// Restarts from stick after a wrong prediction by neighbours.
  bool begin_without_advice(LaneSearch& search) const {
    if (!search.predicted) return false;
    search.predicted = false;
    search.inherited.resize(0);
    search.expected_rate = 0;
    return begin(search);
  }

  /// Tolerance at which errors like the neighbours' meet the requested tolerance.
  static double inheriting_tolerance(const LaneSearch& search) {
    return std::min(loosest_of_use(search) / coarser, 0.7 * search.requested / search.inherited.maxCoeff());
  }
  /// Tolerance of the first of two compared returns, such that the second may meet the request at the neighbours' error
  /// rate.
  static double first_tolerance(const LaneSearch& search) {
    const double usual = loosest_of_use(search);
    return search.expected_rate > 0 ? std::min(usual, 0.7 * coarser * search.requested / search.expected_rate) : usual;
  }
  static double loosest_of_use(const LaneSearch& search) { return std::min(0.5 * coarser * search.requested, loosest); }

  void prepare(LaneSearch& search) const {
    search.tolerance = first_tolerance(search);
    search.returns = search.measured_returns = 0;
    search.probed = false;
    search.last.reset();
    LaneReturn& p = search.task;
    p.slider = &search.map.system();
    p.growth_time = search.map.growth_time();
    // Slip that has not come to rest after many free oscillations belongs to another kind of cycle.
    p.longest = (search.sticks ? 0.03 : 1.0) * search.map.longest_return();
    p.first_step = 1e-4 * std::min(1.0, p.growth_time);
    if (search.predicted) {
      search.stage = LaneSearch::Stage::coarse;
      p.amplitude = search.amplitude;
      p.from_section = true;
      p.record = false;
      search.tolerance = std::min(
          transient_ratio * (search.inherited.size() > 0 ? inheriting_tolerance(search) : first_tolerance(search)),
          loosest_of_use(search));
      search.start_at(search.fixed_point);
      return;
    }
    search.slowest = 0;
    search.derivative.resize(0, 0);
    search.derivative_error = 1;
    if (search.sticks && search.coordinates.empty()) {  // without states, stick forgets the past
      search.stage = LaneSearch::Stage::coarse;
      p.from_section = p.record = true;
      search.start_at(VectorXd());
      return;
    }
    search.starts = 0;
    begin_from_stick(search);
  }

  void begin_from_stick(LaneSearch& search) const {
    search.stage = LaneSearch::Stage::from_stick;
    search.returns = 0;
    search.swing.resize(0);
    LaneReturn& p = search.task;
    p.tolerance = search.tolerance;
    p.from_section = p.record = false;
    p.dip = 1e-10;
    const auto& system = search.map.system();
    const auto y = search.sticks
                       ? system.loaded_at_rest(system.model().law->rest(system.model().drive.normal_load.level()), 0.5)
                       : search.map.stick(ages[search.starts++] * search.map.drive_speed());
    std::copy(y.begin(), y.end(), p.y.begin());
  }

  /// True if motion from stick has come to oscillate with less than `dead` about steady sliding, or to creep towards
  /// it.
  static bool dies_out(const LaneSearch& search) {
    const LaneReturn& task = search.task;
    const double V = search.map.drive_speed();
    if (task.ending == Ending::reached_end) return search.returns > 0 && task.amplitude < dead;
    return task.duration > task.longest &&
           std::abs(search.map.system().contact_slip_rate(0, task.y.data()) - V) < dead * V;
  }
  /// True if motion from stick next to stable sliding needs another return without extrapolation: slow decay looks like
  /// settling.
  static bool takes_plain_return(LaneSearch& search, const VectorXd& image) {
    const double before = search.change, size = search.size_at(image);
    search.change = search.returns == 1 ? infinity : (image - search.start).norm();
    const bool converges = search.change < nearly_repeats * size && search.change < 0.5 * before;
    if (search.returns == most_plain_returns || search.change < repeats * size || converges) {
      search.returns = 1;
      return false;
    }
    search.start = image;
    search.task.from_section = true;
    return true;
  }

  /// Motion from one stick has died out. True if a longer stick is left to try; else all motion counts as dying out.
  bool died_out(LaneSearch& search, LaneCycle& cycle) const {
    cycle.dies_out = search.starts == ages.size();
    if (cycle.dies_out) return false;
    search.tolerance = first_tolerance(search);
    begin_from_stick(search);
    return true;
  }

  /// Tests, after motion from stick has found no cycle, whether all smaller amplitudes decay onto steady sliding. True
  /// if another return is wanted.
  bool descend(LaneSearch& search, LaneCycle& cycle) const {
    constexpr int settling = 2;    // returns in which the fast directions relax
    constexpr double lower = 0.8;  // from one amplitude to the next
    constexpr double tolerance = 1e-5,
                     surely = 1e-4;  // tolerance of the returns; least relative loss of amplitude in one
    LaneReturn& task = search.task;
    if (search.stage != LaneSearch::Stage::descent) {
      search.stage = LaneSearch::Stage::descent;
      search.tolerance = tolerance;
      search.slowest = 0;
      task.record = false;
      task.from_section = true;
      search.returns_at_amplitude = 0;
    } else {
      if (task.ending != Ending::reached_end) return false;
      const VectorXd image = search.point();
      const VectorXd swing = image - search.steady();
      const double ratio = swing.norm() / search.swing.norm();
      search.swing = swing;
      if (++search.returns_at_amplitude <= settling) {
        search.start_at(image);
        return true;
      }
      if (!(ratio < 1 - surely)) return false;
      if (task.amplitude < dead) return died_out(search, cycle);
      search.returns_at_amplitude = 0;
      search.swing *= lower;
    }
    search.start_at(search.steady() + search.swing);
    return true;
  }

  /// Processes a finished return. True if another is wanted.
  bool advance(LaneSearch& search, LaneCycle& cycle) const {
    LaneReturn& task = search.task;
    if (search.stage == LaneSearch::Stage::descent) return descend(search, cycle);
    if (search.sliding_attracts && search.stage == LaneSearch::Stage::from_stick && dies_out(search))
      return died_out(search, cycle);
    const bool lost = task.ending != Ending::reached_end || task.amplitude < collapsed;
    if (lost && search.sliding_attracts && search.swing.size() > 0) return descend(search, cycle);
    if (lost || ++search.returns > most_returns) return false;
    const VectorXd image = search.point();
    if (!image.allFinite()) return false;
    task.first_step = std::min(task.last_step, 0.01 * task.duration);
    if (search.stage == LaneSearch::Stage::from_stick) {
      if (search.sliding_attracts && takes_plain_return(search, image)) return true;
      if (search.sliding_attracts) search.swing = image - search.steady();
      search.stage = LaneSearch::Stage::coarse;
      task.from_section = true;
      task.record = true;
      search.start_at(image);
      return true;
    }
    const double size = search.size_at(image);
    const Visit visit{search.start, image, task.record ? vector_of(task.metrics) : VectorXd(), search.tolerance,
                      task.tolerance * size};
    search.learn(visit);
    if (search.probed) return probe(search, image, cycle);
    const bool unlearned = search.predicted ? search.returns == 1 : search.derivative_error == 1;
    if (unlearned && !search.sticks && hides_contraction(search, visit)) {
      // The next start differs in amplitude.
      const double distance =
          std::max(probe_distance, 6 * LaneSearch::least_move * task.tolerance);  // enough for Broyden's update
      search.start_at(image + distance * (image - search.steady()));
      return true;
    }
    const VectorXd step = search.newton_step(visit);
    const bool fine = search.stage == LaneSearch::Stage::fine;
    // Metrics are measured on a return that starts at the distance of the step from the cycle. Their error after
    // extrapolation is a fraction of that step, and all of it where the derivative hardly differs from 1.
    const double derivative_error = search.derivative_error;
    const double fraction = std::max(0.05, derivative_error / std::max(1 - search.slowest - derivative_error, 1e-3));
    const double offset = (search.deflects ? std::max(0.5, fraction) : fraction) * step.norm() / size;
    const VectorXd next = visit.start + step;
    // The neighbours' error rates hold where their prediction of the cycle does.
    if (!fine && step.norm() > 0.01 * size) search.inherited.resize(0);
    const bool inherits = search.inherited.size() > 0;
    if (!task.record) {
      task.record = true;
      search.stage = inherits ? LaneSearch::Stage::fine : LaneSearch::Stage::coarse;
      search.tolerance = inherits ? inheriting_tolerance(search) : first_tolerance(search);
      search.start_at(next);
      return true;
    }
    // Once changes are down to the scatter of the map, more returns do not help.
    const bool scatter = ++search.measured_returns > 5 && offset < 5 * search.tolerance;
    const double allowed = inherits ? 0.15 * search.requested : (fine ? 0.3 : 1.5) * search.tolerance;
    if (offset > allowed && !scatter) {
      search.start_at(next);
      return true;
    }
    search.measured_returns = 0;
    // A stick fraction of 0 stays 0, and none leaves 0 … 1.
    VectorXd correction = search.sensitivity * step;
    for (std::size_t k = 0; k < metrics_.size(); ++k)
      if (cycles::is_stick(*metrics_[k]))
        correction[k] = visit.metrics[k] > 0 && visit.metrics[k] < 1
                            ? std::clamp(correction[k], -visit.metrics[k], 1 - visit.metrics[k])
                            : 0;
    const VectorXd metrics = visit.metrics + correction;
    double sharpening = coarser;
    if (fine) {
      const double reached = judge(search, metrics, correction, cycle, offset);
      if (inherits && reached > search.requested) {
        if (search.returns > 6) return false;
        search.start_at(next);  // closer to the cycle
        return true;
      }
      search.fixed_point = next;
      if (reached <= search.requested) {
        const auto [multiplier, direction] = slowest_mode(search);
        constexpr double surely = 0.9;
        const bool neighbours_certify = search.predicted && !hides_contraction(search, visit);
        cycle.found = !search.deflects &&
                      (neighbours_certify || (multiplier < surely && (search.sticks || !may_be_neutral(search))));
        if (cycle.found) return false;
        // The learned derivative may not suffice: weak friction gives multipliers close to 1 on either side, and a
        // ringing contact may repeat itself only after several returns. A return next to the cycle then tests
        // attraction.
        search.probed = true;
        task.record = false;
        search.probe_offset = infinity;
        search.residual = (image - visit.start).norm() / size;
        search.stepped = step.norm() / size;
        // The start differs in displacement (the amplitude) too: rounding error in the derivative may point the
        // direction anywhere, and states that a return forgets at once may dominate it.
        VectorXd swing = search.sticks ? direction : VectorXd(VectorXd::Unit(next.size(), 0));
        if (swing.dot(direction) < 0) swing = -swing;
        search.start_at(next + probe_distance * size * (direction + swing).normalized());
        return true;
      }
      sharpening = std::clamp(1.5 * reached / search.requested, 2.0, 30.0);
      if (!(search.tolerance / sharpening > 1e-13)) return false;
    }
    search.coarse = metrics;
    search.sharpening = sharpening;
    search.stage = LaneSearch::Stage::fine;
    search.tolerance /= sharpening;
    search.start_at(next);
    return true;
  }

  /// Tests whether motion next to the cycle comes back to it; true if another return is wanted. After one return the
  /// motion lies along the least attracting direction. The residual of the last return over the measured attraction is
  /// the distance from the cycle: beyond the Newton step and the tolerance, the cycle is not known.
  bool probe(LaneSearch& search, const VectorXd& image, LaneCycle& cycle) const {
    const double before = search.probe_offset, size = search.size_at(search.fixed_point);
    search.probe_offset = (image - search.fixed_point).norm();
    const bool back = search.probe_offset < 0.1 * probe_distance * size;
    if (before == infinity && !back) {
      search.start_at(image);
      return true;
    }
    if (cycle.found = back; back) return false;
    // A change within the error of the steps is no sign of attraction.
    const double attracted = 1 - search.probe_offset / before, noise = search.task.tolerance;
    if (!(attracted > 10 * noise / probe_distance)) return false;
    const double offset = std::max(search.residual, noise) / attracted - search.stepped;
    cycle.found = offset < search.requested;
    for (const auto& metric : metrics_)
      cycle.error.*metric->member +=
          2 * std::max(offset, 0.0) * size_of(*metric, cycle.metrics, search.map.drive_speed());
    return false;
  }

  /// The largest known multiplier and its unit eigenvector.
  struct SlowestMode {
    double multiplier = 0;
    VectorXd direction;
  };
  static SlowestMode slowest_mode(const LaneSearch& search) {
    SlowestMode least;
    if (search.derivative.size() == 0) return least;
    const auto pairs = eigenpairs(search.derivative, true);
    for (Eigen::Index k = 0; k < pairs.values.size(); ++k)
      if (const double size = std::abs(pairs.values[k]); k == 0 || !(size <= least.multiplier)) {
        const VectorXd real = pairs.vectors.col(k).real(), imaginary = pairs.vectors.col(k).imag();
        least = {size, (real.norm() > imaginary.norm() ? real : imaginary).normalized()};
      }
    return least;
  }

  /// True if contraction may be slow in a direction that the returns so far do not show.
  static bool hides_contraction(const LaneSearch& search, const Visit& visit) {
    if (search.predicted) return search.derivative_error > 0.3 * (1 - search.slowest);
    return weakly_coupled(search) || (visit.image - visit.start).norm() < LaneSearch::least_move * 2 * visit.noise;
  }
  /// True if friction may change the amplitude in a period by so little that the learned derivative is noise.
  static bool may_be_neutral(const LaneSearch& search) {
    constexpr double back = 0.5;  // slip that sticks never reverses so fast
    const cycles::Metrics& m = search.task.metrics;
    return weakly_coupled(search) || -m.slip_rate_min > back * m.slip_rate_max;
  }
  /// True if friction changes the motion in a period only a little, so that the amplitude may settle slowly.
  static bool weakly_coupled(const LaneSearch& search) {
    const auto& model = search.map.system().model();
    const double swing = search.map.drive_speed() * std::sqrt(model.slider.mass / model.slider.stiffness);
    return search.scale[0] < 4 * swing;
  }

  VectorXd vector_of(const cycles::Metrics& m) const {
    VectorXd values(metrics_.size());
    for (std::size_t k = 0; k < metrics_.size(); ++k) values[k] = m.*metrics_[k]->member;
    return values;
  }

  /// Fills in metrics and errors. \returns the largest relative error. Errors fall nearly in proportion to the
  /// tolerance:
  /// eight times the estimate counts, and not less than 0.7 tolerances.
  double judge(LaneSearch& search, const VectorXd& fine, const VectorXd& correction, LaneCycle& cycle,
               double offset) const {
    const double V = search.map.drive_speed(), lowest = search.task.metrics.slip_rate_min;
    for (const auto& metric : cycles::metric_names())
      cycle.metrics.*metric.member = cycle.error.*metric.member = nothing;
    cycles::Metrics sizes = search.task.metrics;
    for (std::size_t k = 0; k < metrics_.size(); ++k) sizes.*metrics_[k]->member = fine[k];
    if (sizes.friction_max == 0) sizes.friction_max = search.map.system().friction_coefficient(0, search.task.y.data());
    cycle.ill_conditioned_stick = search.task.touches_threshold;
    for (const double e : {stick_threshold_, 0.01, 0.5})
      if (std::abs(std::abs(lowest) - e * V) < 1e-3 * e * V) cycle.ill_conditioned_stick = true;
    const bool inherits = search.inherited.size() > 0;
    const auto counts = [&](const cycles::MetricName& metric) {
      return !(cycles::is_stick(metric) && cycle.ill_conditioned_stick);
    };
    VectorXd size(metrics_.size()), change = VectorXd::Zero(metrics_.size());
    double largest = 0, worst = 0;
    for (std::size_t k = 0; k < metrics_.size(); ++k) {
      size[k] = cycles::size_of(*metrics_[k], sizes, V);
      if (!inherits) change[k] = std::abs(fine[k] - search.coarse[k]) / size[k];
      if (counts(*metrics_[k])) largest = std::max(largest, change[k]);
    }
    // Errors scatter where the slider rings on a contact spring, where friction curves have kinks, and in the loop
    // integral.
    const double caution = search.map.system().rigid() && !search.sticks && !search.deflects ? 1 : 4;
    const double stop_factor = search.sticks ? stop_friction_factor(search.map.system(), sizes) : 1;
    search.error_rate.setZero(metrics_.size());
    for (std::size_t k = 0; k < metrics_.size(); ++k) {
      const cycles::MetricName& metric = *metrics_[k];
      const double scatter = caution * (cycles::is_loop(metric)                           ? 2
                                        : metric.member == &cycles::Metrics::friction_min ? stop_factor
                                                                                          : 1);
      const double own = inherits
                             ? search.inherited[k] * search.tolerance
                             : scatter * (8 / search.sharpening * change[k] + 0.15 * largest + 0.7 * search.tolerance);
      // The correction to the fixed point has an error of a fraction of itself.
      const double relative = own + scatter * offset + (inherits ? 1 : 0.3) * std::abs(correction[k]) / size[k];
      cycle.metrics.*metric.member = fine[k];
      // The stated error is three times the estimate where the tolerance leaves room; larger errors are rare.
      cycle.error.*metric.member = std::clamp(search.requested, relative, 3 * relative) * size[k];
      if (cycles::is_loop(metric) && cycles::follows_steady_curve(search.map.system())) cycle.error.*metric.member = 0;
      search.error_rate[k] = own / search.tolerance;
      if (!counts(metric)) continue;
      if (!std::isfinite(relative)) return infinity;
      worst = std::max(worst, relative);
    }
    return worst;
  }

  /// Factor from the relative error of the slip rate to that of friction at the stop. The time of the stop has the
  /// error of the slip rate over the deceleration, which is small where friction has changed little, and the drive
  /// loads the spring at its speed for that time.
  static double stop_friction_factor(const oscillators::SliderSystem& system, const cycles::Metrics& m) {
    const auto& model = system.model();
    const double N = model.drive.normal_load.level(), V = model.drive.speed.level();
    const double deceleration =
        N * std::abs(m.friction_min - model.law->steady_friction({V, N}).friction) / model.slider.mass;
    const double time = std::max(m.slip_rate_max, V) / deceleration;
    return std::max(1.0, time * V * model.slider.stiffness / N);
  }

  static constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  double stick_threshold_;
  std::vector<const cycles::MetricName*> metrics_;
  const ReturnLanes* lanes_ = nullptr;
  std::vector<Work*> open_;
  std::vector<Place> tasks_;  ///< indexed by the task's label
  std::vector<LaneReturn*> waiting_;
};

}  // namespace

void find_cycles(std::vector<CycleBatch> batches, double stick_threshold, const std::vector<std::string>& metrics,
                 const std::function<std::optional<CycleBatch>(CycleBatch&)>& finished) {
  const Recording recording = recording_for(stick_threshold, metrics);
  CycleQueue queue(stick_threshold, metrics);
  std::deque<ReturnLanes> kinds;  // sliders of one kind share lanes
  std::deque<Work> works;         // kept until the end, because lanes refer to sliders by address
  const auto prepare = [&](Work& work) {
    std::map<const ReturnLanes*, std::vector<std::size_t>> members;
    const auto& models = work.batch.models;
    work.batch.cycles.resize(models.size());
    work.searches.resize(models.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
      auto search = std::make_unique<LaneSearch>(models[i], work.batch.tolerance);
      const auto& slider = search->map.system();
      // The amplitude growth of a nearly neutral oscillation is below the error of the steps in a period.
      constexpr double hardly = 1e-4;
      if (!ReturnLanes::serves(slider) || cycles::only_rings(models[i]) ||
          cycles::friction_over_swing(models[i]) < hardly)
        continue;
      auto kind = std::ranges::find_if(kinds, [&](const ReturnLanes& lanes) { return lanes.fits(slider); });
      const ReturnLanes& lanes = kind == kinds.end() ? kinds.emplace_back(slider, recording) : *kind;
      members[&lanes].push_back(i);
      work.searches[i] = std::move(search);
      ++work.left;
    }
    for (const auto& [kind, of_kind] : members) work.neighbours.try_emplace(kind, of_kind, work.batch.places);
  };
  const auto begin = [&](std::optional<CycleBatch> batch) {
    while (batch) {
      Work& work = works.emplace_back(std::move(*batch));
      prepare(work);
      if (work.left > 0) return queue.add(work);
      batch = finished(work.batch);
    }
  };
  queue.close = [&](Work& work) { begin(finished(work.batch)); };
  for (auto& batch : batches) begin(std::move(batch));
  while (queue.works_left())
    for (std::size_t k = 0; k < kinds.size(); ++k) {  // a batch may add kinds meanwhile
      queue.serve(kinds[k]);
      kinds[k].run(queue);
    }
}

LaneCycleOptions every_metric(double tolerance) {
  LaneCycleOptions options;
  options.tolerance = tolerance;
  for (const auto& metric : cycles::metric_names()) options.metrics.emplace_back(metric.name);
  return options;
}

std::vector<LaneCycle> find_cycles(std::span<const Model> models, const LaneCycleOptions& options,
                                   std::span<const GridPlace> places) {
  std::vector<LaneCycle> cycles;
  find_cycles({{.models = {models.begin(), models.end()},
                .places = {places.begin(), places.end()},
                .tolerance = options.tolerance}},
              options.stick_threshold, options.metrics, [&](CycleBatch& batch) {
                cycles = std::move(batch.cycles);
                return std::nullopt;
              });
  return cycles;
}

cycles::Cycle find_cycle(const Model& model, const LaneCycleOptions& options) {
  constexpr double tightest = 1e-7;  // below, steps of the order of collocation are so much longer that they win
  model.check();
  for (const auto& name : options.metrics) cycles::find_metric(name);  // which throws
  const auto& drive = model.drive;
  const bool smooth = !model.law->set_valued() && model.lambda != 0;  // else closed forms may answer
  const bool moves = drive.constant() && drive.speed.level() > 0 && drive.normal_load.level() > 0;
  LaneCycle lane;
  if (smooth && moves && model.slider.stiffness > 0 && options.tolerance >= tightest)
    lane = find_cycles(std::span(&model, 1), options).front();
  if (!lane.found && !lane.dies_out)
    return cycles::find_cycle(model, {.tolerance = options.tolerance,
                                      .stick_threshold = options.stick_threshold,
                                      .multipliers = false,
                                      .near = lane.near});
  cycles::Cycle cycle;
  cycle.cost.steps = lane.tries;
  if (lane.dies_out) {
    cycle.outcome = {Ending::none_exists, "the motion started from stick dies out onto steady sliding"};
    return cycle;
  }
  cycle.metrics = lane.metrics;
  cycle.error = lane.error;
  cycle.ill_conditioned_stick = lane.ill_conditioned_stick;
  cycle.stable = true;
  const auto seen = oscillators::SliderSystem(model).observe(0, lane.near.data());
  cycle.section_displacement = seen.displacement;
  cycle.section_state = seen.state;
  return cycle;
}

}  // namespace rosin::analysis::lanes
