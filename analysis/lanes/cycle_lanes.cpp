/// A small state machine for each slider: settle at a loose tolerance, settle at a tight one, compare.
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

constexpr double coarser = 10;       ///< ratio of the tolerances that are compared
constexpr double plainer = 16;       ///< tolerance of passages that only lead to those that are measured, over theirs
constexpr double loosest = 1e-4;     ///< tolerance: above it steps go astray
constexpr int most_passages = 60;    ///< of one slider
constexpr long most_tries = 60'000;  ///< of steps of one slider, before it is left to be followed by itself
constexpr double astray = 1e-3;      ///< amplitude by which a cycle is left to see whether motion comes back to it
constexpr double collapsed = 1e-3;   ///< amplitudes |v − V|/V below this are left to the search for small cycles
// Beside steady sliding that attracts:
constexpr double dead = 0.02;                      ///< amplitudes below this die out
constexpr double repeats = 1e-3;                   ///< passages that change by less lead to a cycle,
constexpr double nearly = 0.05;                    ///< or by this if the changes fall fast
constexpr int most_plain = 60;                     ///< passages without a guess ahead
constexpr std::array<double, 2> ages = {1, 1e-4};  ///< speeds over V at which contacts at rest have aged: later, longer

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

/// One passage through the return map P: start z, image P(z), and the metrics measured between them. Points in units of
/// the scale, differential unknowns only.
struct Visit {
  VectorXd start, image;
  VectorXd metrics;  ///< empty: not measured
  double tolerance;
  double noise;  ///< by which images scatter
};

/// One slider on its way to its cycle, by Newton's method on z = P(z) with the derivative learned from the passages
/// themselves (Broyden's update). What the metrics change with z is learned likewise, so that they can be carried on to
/// the fixed point.
struct Search {
  Search(const Model& model, double wanted)
      : map(model),
        asked(wanted),
        sticks(model.law->set_valued()),
        deflects(model.law->deflects()),
        beside(!sticks && map.growth_time() == infinity) {
    // At the onset of slip the contact's states say all.
    for (const int i : map.differential())
      if (!sticks || i > map.system().slip_rate_index()) coordinates.push_back(i);
    std::vector<double> s(map.system().size());
    map.system().relevance_scale(s.data());
    scale.resize(coordinates.size());
    for (int k = 0; k < scale.size(); ++k) scale[k] = s[coordinates[k]];
  }
  cycles::ReturnMap map;
  double asked;                  ///< tolerance of the metrics
  bool sticks;                   ///< the law is set-valued
  bool deflects;                 ///< the contact rings through each stick
  bool beside;                   ///< steady sliding attracts
  std::size_t starts = 0;        ///< from stick so far
  double change = 0;             ///< of the last two points on the section
  VectorXd swing;                ///< from steady sliding to the motion whose drift is looked at
  int turns = 0;                 ///< that this motion has made
  std::vector<int> coordinates;  ///< of the section, among the unknowns
  VectorXd scale;                ///< of the coordinates
  LanePassage passage;
  enum class Stage { from_stick, coarse, fine, descent } stage = Stage::from_stick;
  int passages = 0, visits = 0;          ///< in all; at the tolerance in use
  double tolerance = 0, sharpening = 0;  ///< in use; ratio to the one before
  std::optional<Visit> last;
  MatrixXd derivative, sensitivity;  ///< of P and of the metrics by z
  VectorXd coarse;                   ///< metrics at the tolerance before
  VectorXd fixed_point;              ///< of the finest tolerance reached
  double amplitude = 1;              ///< |v − V|/V, as neighbours have it
  bool hinted = false;               ///< started from what the neighbours know
  bool probed = false;               ///< looks only whether the cycle attracts
  double strayed = infinity;         ///< from the fixed point, after the passage before
  VectorXd error_rate;               ///< relative errors over the tolerance, as found in the end
  VectorXd inherited;                ///< the same, of certified neighbours; empty: to be found
  double expected_rate = 0;          ///< about the largest of them; 0: not known

  void take(const KnownCycle& advice) {
    fixed_point = advice.fixed_point;
    derivative = advice.derivative;
    sensitivity = advice.sensitivity;
    derivative_error = advice.derivative_error;
    slowest = largest_multiplier();
    amplitude = advice.amplitude;
    hinted = slowest < 1;
    if (!hinted) return;
    inherited = advice.error_rate;
    expected_rate = advice.expected_rate;
  }
  /// What can be told of the cycle that was found.
  KnownCycle knowledge(bool errors_are_smooth) const {
    const VectorXd told = errors_are_smooth ? error_rate : VectorXd();
    return {fixed_point, derivative, sensitivity, derivative_error, passage.amplitude, told, 0};
  }
  VectorXd point() const {
    VectorXd z(coordinates.size());
    for (std::size_t k = 0; k < coordinates.size(); ++k) z[k] = passage.y[coordinates[k]] / scale[k];
    return z;
  }
  VectorXd steady() const {
    const auto y = map.system().steady(0);
    VectorXd z(coordinates.size());
    for (int k = 0; k < z.size(); ++k) z[k] = y[coordinates[k]] / scale[k];
    return z;
  }
  /// What changes of a point on the section are measured against.
  double size_at(const VectorXd& z) const { return sticks ? std::max(z.norm(), 1.0) : (z - steady()).norm(); }
  /// The next passage starts at z, with friction in agreement where it is algebraic.
  void start_at(const VectorXd& z) {
    const auto& system = map.system();
    for (std::size_t k = 0; k < coordinates.size(); ++k) passage.y[coordinates[k]] = z[k] * scale[k];
    if (sticks) {
      const auto onset = system.loaded_at_rest(system.observe(0, passage.y.data()).state, 1);
      std::copy(onset.begin(), onset.end(), passage.y.begin());
    } else if (system.rigid()) {
      passage.y[system.slip_rate_index()] = map.drive_speed();
      system.make_consistent(passage.y.data());
    }
    // Small motions are followed more closely: what matters are errors against their drift, which falls with A².
    // And a motion that settles slowly, by the factor ρ a turn, sums up the errors of 1/(1 − ρ) turns.
    const double A = passage.amplitude;
    passage.tolerance = tolerance * std::clamp(A * A, 1e-6, 1.0) * std::clamp(3 * (1 - slowest), 0.02, 1.0);
    // A start a little off the cycle may pass V at once again: that is no turn.
    passage.dip = 0.1 * std::min(1.0, A);
    begun = z;
  }
  VectorXd begun;

  /// States that take far longer than a turn hardly move in the passages that teach the derivative: of what they
  /// forget in one, steady sliding over as long tells.
  MatrixXd kept_by_slow_states() const {
    constexpr double slow = 0.3;  // part that is forgotten in a turn
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
      const double forgotten = -std::expm1(J[i * n + i] / mass[i] * passage.duration);
      if (forgotten > 0 && forgotten < slow) kept(long(k), long(k)) = 1 - forgotten;
    }
    return kept;
  }

  static constexpr double learned = 0.01;   ///< error of what was
  static constexpr double least_move = 10;  ///< over the noise, from which something is learned
  void learn(const Visit& visit) {
    const int n = int(visit.start.size());
    if (derivative.size() == 0) {
      derivative = sticks ? MatrixXd::Zero(n, n) : kept_by_slow_states();
      sensitivity = MatrixXd::Zero(visit.metrics.size(), n);
    }
    if (last && last->tolerance == visit.tolerance) {  // maps of different tolerances differ by more than scatter
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
  double derivative_error = 1;  ///< of the derivative, guessed
  double largest_multiplier() const {
    return derivative.size() == 0 ? 0.0 : eigenpairs(derivative).values.cwiseAbs().maxCoeff();
  }
  /// Of the last turn, over the cycle's size: what it left over, and the step that was to make it good.
  double residual = 0, stepped = 0;
  /// How far the fixed point is from the start of a visit.
  VectorXd newton_step(const Visit& visit) const {
    const VectorXd change = visit.image - visit.start;
    if (change.size() == 0) return change;
    const MatrixXd A = MatrixXd::Identity(change.size(), change.size()) - derivative;
    VectorXd step = solve_linear(A, change);
    // Backwards: towards a fixed point that repels. Ahead, then.
    if (!step.allFinite() || step.dot(change) < 0) step = 4 * change;
    const double longest = 0.3 * size_at(visit.start) + change.norm();
    return step.norm() > longest ? VectorXd(step * (longest / step.norm())) : step;
  }
};

/// A batch at work.
struct Work {
  CycleBatch batch;
  std::vector<std::unique_ptr<Search>> searches;  ///< null: not for lanes
  std::map<const PassageLanes*, Neighbours> neighbours;
  std::size_t left = 0;  ///< searches under way or yet to begin
};

class Settling final : public PassageQueue {
 public:
  Settling(double stick_threshold, const std::vector<std::string>& metrics) : stick_threshold_(stick_threshold) {
    for (const auto& name : metrics) metrics_.push_back(&cycles::find_metric(name));
    metrics_.push_back(&cycles::find_metric("period"));
  }

  /// What begins from now on is of this kind.
  void serve(const PassageLanes& lanes) { lanes_ = &lanes; }
  void add(Work& work) { open_.push_back(&work); }
  bool works_left() const { return !open_.empty(); }
  /// What is to be done with a work that is finished; it may add others.
  std::function<void(Work&)> close;

  LanePassage* next() override {
    if (!again_.empty()) {
      LanePassage* passage = again_.back();
      again_.pop_back();
      return passage;
    }
    while (const auto found = first_ready()) {
      const auto [work, i] = *found;
      Search& search = *work->searches[i];
      if (const auto advice = work->neighbours.at(lanes_).advice(i)) search.take(*advice);
      if (begin(search)) {
        search.passage.label = begun_.size();
        begun_.push_back({work, i});
        return &search.passage;
      }
      finish(*work, i);
    }
    return nullptr;
  }

  void finished(LanePassage& passage) override {
    const auto [work, i] = begun_[passage.label];
    LaneCycle& cycle = work->batch.cycles[i];
    cycle.tries += passage.tries;
    Search& search = *work->searches[i];
    bool goes_on = false;
    if (cycle.tries > most_tries) return finish(*work, i);
    try {
      goes_on = go_on(search, cycle);
    } catch (const InputError&) {  // a step has led beyond what the law answers to
    }
    if (goes_on || (!cycle.found && begin_by_itself(search))) {
      again_.push_back(&passage);
      return;
    }
    // One whose attraction could not be told is near all the same.
    if (!cycle.found && search.probed && !search.sticks)
      cycle.near.assign(passage.y.begin(), passage.y.begin() + search.map.system().size());
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
  /// \returns false where there is nothing to start from.
  bool begin(Search& search) const {
    try {
      prepare(search);
      return true;
    } catch (const InputError&) {
      return begin_by_itself(search);
    }
  }
  /// Once more where neighbours have misled.
  bool begin_by_itself(Search& search) const {
    if (!search.hinted) return false;
    search.hinted = false;
    search.inherited.resize(0);
    search.expected_rate = 0;
    return begin(search);
  }

  /// At which the errors that neighbours met are small enough.
  static double inheriting_tolerance(const Search& search) {
    return std::min(loosest_of_use(search) / coarser, 0.7 * search.asked / search.inherited.maxCoeff());
  }
  /// Of the first of two passages that are compared, the second of which may then meet what neighbours met.
  static double first_tolerance(const Search& search) {
    const double usual = loosest_of_use(search);
    return search.expected_rate > 0 ? std::min(usual, 0.7 * coarser * search.asked / search.expected_rate) : usual;
  }
  static double loosest_of_use(const Search& search) { return std::min(0.5 * coarser * search.asked, loosest); }

  void prepare(Search& search) const {
    search.tolerance = first_tolerance(search);
    search.passages = search.visits = 0;
    search.probed = false;
    search.last.reset();
    LanePassage& p = search.passage;
    p.slider = &search.map.system();
    p.growth_time = search.map.growth_time();
    // Slip that has not come to rest after many free swings will not: that is another kind of cycle.
    p.longest = (search.sticks ? 0.03 : 1.0) * search.map.longest_return();
    p.first_step = 1e-4 * std::min(1.0, p.growth_time);
    if (search.hinted) {
      search.stage = Search::Stage::coarse;
      p.amplitude = search.amplitude;
      p.from_section = true;
      p.record = false;
      search.tolerance =
          std::min(plainer * (search.inherited.size() > 0 ? inheriting_tolerance(search) : first_tolerance(search)),
                   loosest_of_use(search));
      search.start_at(search.fixed_point);
      return;
    }
    search.slowest = 0;
    search.derivative.resize(0, 0);
    search.derivative_error = 1;
    if (search.sticks && search.coordinates.empty()) {  // stick forgets the past
      search.stage = Search::Stage::coarse;
      p.from_section = p.record = true;
      search.start_at(VectorXd());
      return;
    }
    search.starts = 0;
    begin_from_stick(search);
  }

  void begin_from_stick(Search& search) const {
    search.stage = Search::Stage::from_stick;
    search.passages = 0;
    search.swing.resize(0);
    LanePassage& p = search.passage;
    p.tolerance = search.tolerance;
    p.from_section = p.record = false;
    p.dip = 1e-10;
    const auto& system = search.map.system();
    const auto y = search.sticks
                       ? system.loaded_at_rest(system.model().law->rest(system.model().drive.normal_load.level()), 0.5)
                       : search.map.stick(ages[search.starts++] * search.map.drive_speed());
    std::copy(y.begin(), y.end(), p.y.begin());
  }

  /// True if motion from stick has come to swing but little about steady sliding, or to creep towards it.
  static bool dies_out(const Search& search) {
    const LanePassage& passage = search.passage;
    const double V = search.map.drive_speed();
    if (passage.ending == Ending::reached_end) return search.passages > 0 && passage.amplitude < dead;
    return passage.duration > passage.longest &&
           std::abs(search.map.system().contact_slip_rate(0, passage.y.data()) - V) < dead * V;
  }
  /// True if motion from stick beside stable sliding is to be followed without a guess where it leads: what dies out
  /// slowly looks like what settles.
  static bool goes_plainly(Search& search, const VectorXd& image) {
    const double before = search.change, size = search.size_at(image);
    search.change = search.passages == 1 ? infinity : (image - search.begun).norm();
    const bool converges = search.change < nearly * size && search.change < 0.5 * before;
    if (search.passages == most_plain || search.change < repeats * size || converges) {
      search.passages = 1;
      return false;
    }
    search.begun = image;
    search.passage.from_section = true;
    return true;
  }

  /// The motion from one stick dies out: so does all motion, if there is no longer stick to try. True if there is.
  bool died_out(Search& search, LaneCycle& cycle) const {
    cycle.dies_out = search.starts == ages.size();
    if (cycle.dies_out) return false;
    search.tolerance = first_tolerance(search);
    begin_from_stick(search);
    return true;
  }

  /// Motion from stick that hardly changes from turn to turn has led to no cycle: looks whether it drifts towards
  /// steady sliding from there down. True if another passage is wanted.
  bool descend(Search& search, LaneCycle& cycle) const {
    constexpr int settling = 2;                        // turns that forget how an amplitude was chosen
    constexpr double lower = 0.8;                      // from one amplitude to the next
    constexpr double tolerance = 1e-5, surely = 1e-4;  // of the passages; least loss of amplitude in a turn
    LanePassage& passage = search.passage;
    if (search.stage != Search::Stage::descent) {
      search.stage = Search::Stage::descent;
      search.tolerance = tolerance;
      search.slowest = 0;
      passage.record = false;
      passage.from_section = true;
      search.turns = 0;
    } else {
      if (passage.ending != Ending::reached_end) return false;
      const VectorXd image = search.point();
      const VectorXd swing = image - search.steady();
      const double ratio = swing.norm() / search.swing.norm();
      search.swing = swing;
      if (++search.turns <= settling) {
        search.start_at(image);
        return true;
      }
      if (!(ratio < 1 - surely)) return false;
      if (passage.amplitude < dead) return died_out(search, cycle);
      search.turns = 0;
      search.swing *= lower;
    }
    search.start_at(search.steady() + search.swing);
    return true;
  }

  /// True if another passage is wanted.
  bool go_on(Search& search, LaneCycle& cycle) const {
    LanePassage& passage = search.passage;
    if (search.stage == Search::Stage::descent) return descend(search, cycle);
    if (search.beside && search.stage == Search::Stage::from_stick && dies_out(search)) return died_out(search, cycle);
    const bool lost = passage.ending != Ending::reached_end || passage.amplitude < collapsed;
    if (lost && search.beside && search.swing.size() > 0) return descend(search, cycle);
    if (lost || ++search.passages > most_passages) return false;
    const VectorXd image = search.point();
    if (!image.allFinite()) return false;
    passage.first_step = std::min(passage.last_step, 0.01 * passage.duration);
    if (search.stage == Search::Stage::from_stick) {
      if (search.beside && goes_plainly(search, image)) return true;
      if (search.beside) search.swing = image - search.steady();
      search.stage = Search::Stage::coarse;
      passage.from_section = true;
      passage.record = true;
      search.start_at(image);
      return true;
    }
    const double size = search.size_at(image);
    const Visit visit{search.begun, image, passage.record ? vector_of(passage.metrics) : VectorXd(), search.tolerance,
                      passage.tolerance * size};
    search.learn(visit);
    if (search.probed) return probe(search, image, cycle);
    const bool unlearned = search.hinted ? search.passages == 1 : search.derivative_error == 1;
    if (unlearned && !search.sticks && hides_contraction(search, visit)) {
      // Look along the amplitude.
      const double ahead = std::max(astray, 6 * Search::least_move * passage.tolerance);  // surely enough to learn
      search.start_at(image + ahead * (image - search.steady()));
      return true;
    }
    const VectorXd step = search.newton_step(visit);
    const bool fine = search.stage == Search::Stage::fine;
    // Metrics are measured on a passage that starts off the cycle by the step; carried on to it they are off by a
    // fraction of that, all of it where the derivative, learned or told, hardly differs from 1.
    const double doubt = search.derivative_error;
    const double fraction = std::max(0.05, doubt / std::max(1 - search.slowest - doubt, 1e-3));
    const double off = (search.deflects ? std::max(0.5, fraction) : fraction) * step.norm() / size;
    const VectorXd next = visit.start + step;
    // Errors are like the neighbours' where the cycle itself is as they foretold.
    if (!fine && step.norm() > 0.01 * size) search.inherited.resize(0);
    const bool inherits = search.inherited.size() > 0;
    if (!passage.record) {
      passage.record = true;
      search.stage = inherits ? Search::Stage::fine : Search::Stage::coarse;
      search.tolerance = inherits ? inheriting_tolerance(search) : first_tolerance(search);
      search.start_at(next);
      return true;
    }
    // Where changes have come down to the scatter of the map, more passages bring no more.
    const bool scatter = ++search.visits > 5 && off < 5 * search.tolerance;
    const double allowed = inherits ? 0.15 * search.asked : (fine ? 0.3 : 1.5) * search.tolerance;
    if (off > allowed && !scatter) {
      search.start_at(next);
      return true;
    }
    search.visits = 0;
    // A fraction that is nought stays nought, and none leaves 0 … 1.
    VectorXd correction = search.sensitivity * step;
    for (std::size_t k = 0; k < metrics_.size(); ++k)
      if (cycles::is_stick(*metrics_[k]))
        correction[k] = visit.metrics[k] > 0 && visit.metrics[k] < 1
                            ? std::clamp(correction[k], -visit.metrics[k], 1 - visit.metrics[k])
                            : 0;
    const VectorXd metrics = visit.metrics + correction;
    double sharpening = coarser;
    if (fine) {
      const double reached = judge(search, metrics, correction, cycle, off);
      if (inherits && reached > search.asked) {
        if (search.passages > 6) return false;
        search.start_at(next);  // closer to the cycle
        return true;
      }
      search.fixed_point = next;
      if (reached <= search.asked) {
        const auto [multiplier, direction] = least_attracted(search);
        constexpr double surely = 0.9;
        const bool told = search.hinted && !hides_contraction(search, visit);
        cycle.found = !search.deflects && (told || (multiplier < surely && (search.sticks || !swings_freely(search))));
        if (cycle.found) return false;
        // By what was learned on the way, which may be too little: where friction is weak, multipliers are close to 1,
        // below it or above, and a contact that rings may repeat itself after several turns only.
        search.probed = true;
        passage.record = false;
        search.strayed = infinity;
        search.residual = (image - visit.start).norm() / size;
        search.stepped = step.norm() / size;
        // Along the amplitude too, which is the displacement: what rounding has taught of the derivative may point
        // anywhere, and states that a turn forgets at once may be far larger.
        VectorXd swing = search.sticks ? direction : VectorXd(VectorXd::Unit(next.size(), 0));
        if (swing.dot(direction) < 0) swing = -swing;
        search.start_at(next + astray * size * (direction + swing).normalized());
        return true;
      }
      sharpening = std::clamp(1.5 * reached / search.asked, 2.0, 30.0);
      if (!(search.tolerance / sharpening > 1e-13)) return false;
    }
    search.coarse = metrics;
    search.sharpening = sharpening;
    search.stage = Search::Stage::fine;
    search.tolerance /= sharpening;
    search.start_at(next);
    return true;
  }

  /// True if another passage is wanted to see whether motion that has strayed from the cycle comes back to it. After
  /// one turn it lies where it is least attracted. How fast it comes tells how far off the cycle what the last turn
  /// left over was: where that is more than was thought, and than the tolerance, the cycle is not known.
  bool probe(Search& search, const VectorXd& image, LaneCycle& cycle) const {
    const double before = search.strayed, size = search.size_at(search.fixed_point);
    search.strayed = (image - search.fixed_point).norm();
    const bool back = search.strayed < 0.1 * astray * size;
    if (before == infinity && !back) {
      search.start_at(image);
      return true;
    }
    if (cycle.found = back; back) return false;
    // What steps err in a turn is no sign of attraction.
    const double attracted = 1 - search.strayed / before, noise = search.passage.tolerance;
    if (!(attracted > 10 * noise / astray)) return false;
    const double off = std::max(search.residual, noise) / attracted - search.stepped;
    cycle.found = off < search.asked;
    for (const auto& metric : metrics_)
      cycle.error.*metric->member += 2 * std::max(off, 0.0) * size_of(*metric, cycle.metrics, search.map.drive_speed());
    return false;
  }

  /// The largest multiplier as far as known, and the unit vector that it goes with.
  struct LeastAttracted {
    double multiplier = 0;
    VectorXd direction;
  };
  static LeastAttracted least_attracted(const Search& search) {
    LeastAttracted least;
    if (search.derivative.size() == 0) return least;
    const auto pairs = eigenpairs(search.derivative, true);
    for (Eigen::Index k = 0; k < pairs.values.size(); ++k)
      if (const double size = std::abs(pairs.values[k]); k == 0 || !(size <= least.multiplier)) {
        const VectorXd real = pairs.vectors.col(k).real(), imaginary = pairs.vectors.col(k).imag();
        least = {size, (real.norm() > imaginary.norm() ? real : imaginary).normalized()};
      }
    return least;
  }

  /// True if contraction may be slow in a direction that the way here does not show.
  static bool hides_contraction(const Search& search, const Visit& visit) {
    if (search.hinted) return search.derivative_error > 0.3 * (1 - search.slowest);
    return weakly_coupled(search) || (visit.image - visit.start).norm() < Search::least_move * 2 * visit.noise;
  }
  /// True if friction may change the swing of one turn by so little that what was learned of it is noise.
  static bool swings_freely(const Search& search) {
    constexpr double back = 0.5;  // no slip that sticks swings back so fast
    const cycles::Metrics& m = search.passage.metrics;
    return weakly_coupled(search) || -m.slip_rate_min > back * m.slip_rate_max;
  }
  /// True if friction changes the motion of one turn only a little, so that the amplitude may settle slowly.
  static bool weakly_coupled(const Search& search) {
    const auto& model = search.map.system().model();
    const double swing = search.map.drive_speed() * std::sqrt(model.slider.mass / model.slider.stiffness);
    return search.scale[0] < 4 * swing;
  }

  VectorXd vector_of(const cycles::Metrics& m) const {
    VectorXd values(metrics_.size());
    for (std::size_t k = 0; k < metrics_.size(); ++k) values[k] = m.*metrics_[k]->member;
    return values;
  }

  /// Fills in metrics and errors; returns the worst relative error. Errors fall nearly in proportion to the tolerance:
  /// eight times that is stated, and not less than what the tolerance makes likely.
  double judge(Search& search, const VectorXd& fine, const VectorXd& correction, LaneCycle& cycle, double off) const {
    const double V = search.map.drive_speed(), lowest = search.passage.metrics.slip_rate_min;
    for (const auto& metric : cycles::metric_names())
      cycle.metrics.*metric.member = cycle.error.*metric.member = nothing;
    cycles::Metrics sizes = search.passage.metrics;
    for (std::size_t k = 0; k < metrics_.size(); ++k) sizes.*metrics_[k]->member = fine[k];
    if (sizes.friction_max == 0)
      sizes.friction_max = search.map.system().friction_coefficient(0, search.passage.y.data());
    cycle.ill_conditioned_stick = search.passage.touches_threshold;
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
    // On a contact spring the slider rings, and errors scatter; so they do where friction curves have kinks, and so
    // does the loop integral.
    const double caution = search.map.system().rigid() && !search.sticks && !search.deflects ? 1 : 4;
    const double landing = search.sticks ? landing_of(search.map.system(), sizes) : 1;
    search.error_rate.setZero(metrics_.size());
    for (std::size_t k = 0; k < metrics_.size(); ++k) {
      const cycles::MetricName& metric = *metrics_[k];
      const double scatter = caution * (cycles::is_loop(metric)                           ? 2
                                        : metric.member == &cycles::Metrics::friction_min ? landing
                                                                                          : 1);
      const double own = inherits
                             ? search.inherited[k] * search.tolerance
                             : scatter * (8 / search.sharpening * change[k] + 0.15 * largest + 0.7 * search.tolerance);
      // What was carried on to the fixed point is known to a fraction of itself.
      const double relative = own + scatter * off + (inherits ? 1 : 0.3) * std::abs(correction[k]) / size[k];
      cycle.metrics.*metric.member = fine[k];
      // Three times the estimate is stated where the tolerance leaves room: seldom is an error larger than that.
      cycle.error.*metric.member = std::clamp(search.asked, relative, 3 * relative) * size[k];
      if (cycles::is_loop(metric) && cycles::follows_steady_curve(search.map.system())) cycle.error.*metric.member = 0;
      search.error_rate[k] = own / search.tolerance;
      if (!counts(metric)) continue;
      if (!std::isfinite(relative)) return infinity;
      worst = std::max(worst, relative);
    }
    return worst;
  }

  /// By how much the error of the slip rate, over its highest, shows in the friction that a slip comes to rest at. The
  /// slider then moves at the drive's speed, and the time of rest is known to that error over the deceleration, which
  /// is the less the less friction has changed.
  static double landing_of(const oscillators::SliderSystem& system, const cycles::Metrics& m) {
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
  const PassageLanes* lanes_ = nullptr;
  std::vector<Work*> open_;
  std::vector<Place> begun_;  ///< by label
  std::vector<LanePassage*> again_;
};

}  // namespace

void find_cycles(std::vector<CycleBatch> batches, double stick_threshold, const std::vector<std::string>& metrics,
                 const std::function<std::optional<CycleBatch>(CycleBatch&)>& finished) {
  const Recording recording = recording_for(stick_threshold, metrics);
  Settling queue(stick_threshold, metrics);
  std::deque<PassageLanes> kinds;  // sliders of one kind share lanes
  std::deque<Work> works;          // all of them until the end: lanes know sliders by their address
  const auto prepare = [&](Work& work) {
    std::map<const PassageLanes*, std::vector<std::size_t>> members;
    const auto& models = work.batch.models;
    work.batch.cycles.resize(models.size());
    work.searches.resize(models.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
      auto search = std::make_unique<Search>(models[i], work.batch.tolerance);
      const auto& slider = search->map.system();
      // A swing that friction hardly moves drifts by less in a turn than steps err.
      constexpr double hardly = 1e-4;
      if (!PassageLanes::serves(slider) || cycles::only_rings(models[i]) ||
          cycles::friction_over_swing(models[i]) < hardly)
        continue;
      auto kind = std::ranges::find_if(kinds, [&](const PassageLanes& lanes) { return lanes.fits(slider); });
      const PassageLanes& lanes = kind == kinds.end() ? kinds.emplace_back(slider, recording) : *kind;
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
    for (std::size_t k = 0; k < kinds.size(); ++k) {  // which batches on the way may add to
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

}  // namespace rosin::analysis::lanes
