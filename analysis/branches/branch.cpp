/// Branches of cycles from where they begin to where they end.
#include "analysis/branches/branch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/branches/cycle_problem.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/steady/stability.hpp"
#include "analysis/steady/verdict.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::branches {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using motion::Follower;

namespace {

/// The eigenvector of the moving unknowns that oscillates with ω, in natural units.
Eigen::VectorXcd mode(const steady::Linearised& at, double angular_frequency) {
  const auto moving = at.moving();
  const auto pairs = eigenpairs(moving.A, true);
  Index nearest = 0;
  const auto off = [&](Index k) { return std::abs(pairs.values[k] - std::complex<double>(0, angular_frequency)); };
  for (Index k = 1; k < pairs.values.size(); ++k)
    if (off(k) < off(nearest)) nearest = k;
  Eigen::VectorXcd q = pairs.vectors.col(nearest);
  for (Index j = 0; j < q.size(); ++j) q[j] *= at.scale[moving.unknowns[std::size_t(j)]];
  return q;
}

/// One branch of cycles and those that double from it.
class Tracer {
 public:
  Tracer(const Family& family, const BranchOptions& options, Branches& result)
      : family_(family), options_(options), result_(result) {
    // Where disturbances grow a thousandfold in an arc, a looser one leaves too little to find the next cycle by.
    constexpr double loosest = 1e-5;
    options_.tolerance = std::min(options_.tolerance, loosest);
  }

  ContinuationOptions continuation() const {
    ContinuationOptions options;
    options.parameter = options_.parameter;
    options.tolerance = options_.tolerance;
    options.longest_step = options_.longest_step;
    options.first_step = 0.2 * options_.longest_step;
    options.most_points = options_.most_points;
    options.at = options_.at;
    return options;
  }

  void from_hopf(const steady::Crossing& hopf) {
    auto problem = std::make_unique<CycleProblem>(family_, 1);
    Continuation continuation(*problem, this->continuation());
    const auto at = problem->oscillator(hopf.value).linearised();
    const auto q = mode(at, hopf.angular_frequency);
    std::optional<BranchPoint> point;
    for (const double amplitude : {1e-2, 1e-3, 1e-4}) {
      const auto born = problem->born(at.y, q, hopf.angular_frequency, amplitude, hopf.value);
      point = continuation.branch_off(born.x, hopf.value, {born.direction, 0}, 1);
      if (point) break;
    }
    if (!point) {
      result_.notes.push_back(fmt::format("the cycles born at the Hopf point {:.9g} could not be closed", hopf.value));
      return;
    }
    problem->refer_to(point->x, point->p, options_.tolerance);
    // Along the branch the first node leaves steady sliding.
    const auto steady = problem->oscillator(point->p).steady();
    Direction outward{VectorXd::Zero(point->x.size()), 0};
    for (std::size_t j = 0; j < problem->moving().size(); ++j) {
      const Index i = 1 + Index(j);
      outward.x[i] = (point->x[i] - steady[std::size_t(problem->moving()[j])]) / problem->scale()[i];
    }
    outward.x.normalize();
    const double least = 0.3 * problem->amplitude();
    trace("hopf", hopf.value, -1, std::move(problem), *point, outward, least, options_.doublings);
  }

  /// Along the parameter with the sign.
  void from_cycle(const Settled& settled, double value, int sign) {
    auto problem = std::make_unique<CycleProblem>(family_, settled.turns);
    Continuation continuation(*problem, this->continuation());
    auto x = problem->begin(settled.y, settled.period, value);
    auto point = continuation.close(x, value);
    if (!point) {
      result_.notes.push_back(fmt::format("the cycle at {:.9g} could not be closed", value));
      return;
    }
    problem->refer_to(point->x, value, options_.tolerance);
    Direction along{VectorXd::Zero(point->x.size()), double(sign)};
    trace("cycle", value, -1, std::move(problem), *point, along, no_motion, options_.doublings);
  }

 private:
  static constexpr double no_motion = 1e-4;  ///< amplitude of a cycle that has come to steady sliding

  /// \param least  amplitude below which a cycle has come to steady sliding
  void trace(const std::string& from, double value, int parent, std::unique_ptr<CycleProblem> problem,
             const BranchPoint& start, const Direction& along, double least, int doublings) {
    Continuation continuation(*problem, this->continuation());
    std::string pattern = start.view.pattern;
    double p_before = start.p, amplitude_before = problem->amplitude();
    std::optional<steady::Crossing> end;
    VectorXd halves;  // between those of a period that has doubled
    double apart = 0;
    bool is_single = false;
    continuation.arrived = [&](const BranchPoint& point) {
      pattern = point.view.pattern;
      if (point.asked) return true;
      if (parent >= 0) {
        VectorXd now = between_halves(*problem, point);
        constexpr double near = 0.5;  // of the largest: a step beside a border may exchange the halves
        is_single =
            halves.size() == now.size() && halves.dot(now) < 0 && std::min(halves.norm(), now.norm()) < near * apart;
        halves = std::move(now), apart = std::max(apart, halves.norm());
        if (is_single) return false;
      }
      if (problem->driven()) return true;
      const double amplitude = problem->amplitude();
      end = hopf_ahead(p_before, amplitude_before, point, amplitude);
      p_before = point.p, amplitude_before = amplitude;
      return !end && amplitude > least;
    };
    continuation.cross = [&](const SpecialPoint& special) { return beyond(*problem, special, pattern); };
    const auto place = result_.cycles.size();
    result_.cycles.push_back({from, value, parent, {}, continuation.follow(start, along)});
    auto& branch = result_.cycles[place].branch;
    if (end) {
      branch.outcome.detail = fmt::format("it ends at the Hopf point {:.12g}", end->value);
      result_.cycles[place].to_value = end->value;
      note_crossing(*end);
    }
    if (is_single) end_where_doubled(result_.cycles[place]);
    std::erase_if(branch.special, is_neutral_saddle);
    const double range = std::abs(options_.parameter.to - options_.parameter.from);
    std::erase_if(branch.special, [&](const SpecialPoint& special) { return !(special.error < range); });
    for (auto& special : branch.special) special.kind = shown_kind(special.test);
    if (const auto at = branch.outcome.detail.find(grazing_of_landing); at != std::string::npos)
      branch.outcome.detail.replace(at, std::string_view(grazing_of_landing).size(), "grazing");
    if (branch.outcome.ending == Ending::interrupted) throw Stopped{};  // with the points until then
    result_.residuals += continuation.residuals();
    result_.steps += problem->steps;
    if (doublings == 0) return;
    const auto specials = branch.special;
    for (const auto& special : specials) {
      if (special.kind != "period-doubling") continue;
      // A branch of doubled cycles begins at one doubling and may end at another.
      if (std::ranges::any_of(result_.cycles, [&](const CycleBranch& doubled) {
            return doubled.parent == int(place) && doubled.to_value == special.p;
          }))
        continue;
      // The nodes are those of the branch's end: the problem is laid out anew.
      CycleProblem single(family_, problem->turns());
      Continuation again(single, this->continuation());
      const auto x = single.begin(special.view.start, special.view.metrics.at("period"), special.p);
      auto doubled = single.doubled(x, special.p, options_.tolerance * 1e-2);
      if (!doubled) continue;
      Continuation branching(*doubled->problem, this->continuation());
      // Multipliers of a doubled cycle are squares where it is born: one below -1 says that it has doubled again
      // before.
      const auto has_doubled = [](const BranchPoint& at) {
        return std::ranges::any_of(at.view.multipliers, [](auto m) { return m.imag() == 0 && m.real() < -1; });
      };
      std::optional<BranchPoint> point;
      for (const double step : {0.02, 0.005, 0.001, 2e-4}) {
        auto there = branching.branch_off(doubled->x, special.p, {doubled->direction, 0}, step);
        if (!there) continue;
        point = std::move(there);
        if (!has_doubled(*point)) break;
      }
      if (!point) {
        result_.notes.push_back(fmt::format("the doubled cycles at {:.9g} could not be closed", special.p));
        continue;
      }
      doubled->problem->refer_to(point->x, point->p, options_.tolerance);
      const double c = options_.parameter.coordinate(point->p) - options_.parameter.coordinate(special.p);
      Direction away{VectorXd::Zero(point->x.size()), c};
      trace("period-doubling", special.p, int(place), std::move(doubled->problem), *point, away, no_motion,
            doublings - 1);
    }
  }

  /// What half the period of a doubled cycle makes of its start, in sizes: 0 where it is the single one twice.
  VectorXd between_halves(CycleProblem& problem, const BranchPoint& at) const {
    auto y = problem.start(at.x);
    const auto begin = y;
    Follower follower = problem.oscillator(at.p).follower(options_.tolerance);
    if (!follower.follow(0, y, 0.5 * problem.period(at.x, at.p)).complete()) return {};
    VectorXd apart(Index(problem.moving().size()));
    for (Index j = 0; j < apart.size(); ++j) {
      const auto i = std::size_t(problem.moving()[std::size_t(j)]);
      apart[j] = (y[i] - begin[i]) / problem.scale()[problem.scale().size() - apart.size() + j];
    }
    return apart;
  }

  /// The halves of the period have changed places in the last step: between, at a doubling of the branch that this one
  /// comes from, they are equal, and what follows is what came before, half a period later.
  void end_where_doubled(CycleBranch& doubled) const {
    auto& branch = doubled.branch;
    const double p = branch.points.back().p;
    branch.points.pop_back();
    const auto last = branch.points.size() - 1;
    // The parameter of doubled cycles turns there.
    std::erase_if(branch.special, [&](const SpecialPoint& at) { return at.after >= last && at.kind == "fold"; });
    branch.outcome.detail = fmt::format("it ends near {:.6g}, where its period is halved", p);
    double nearest = infinity;
    for (const auto& special : result_.cycles[std::size_t(doubled.parent)].branch.special) {
      const double off = std::abs(options_.parameter.coordinate(special.p) - options_.parameter.coordinate(p));
      if (special.kind != "period-doubling" || off >= std::min(nearest, options_.longest_step)) continue;
      nearest = off;
      doubled.to_value = special.p;
      branch.outcome.detail = fmt::format("it ends at the period doubling {:.9g}", special.p);
    }
  }

  /// The Hopf point that a cycle comes to: its amplitude shrinks as the root of the distance.
  std::optional<steady::Crossing> hopf_ahead(double p_before, double amplitude_before, const BranchPoint& at,
                                             double amplitude) const {
    constexpr double small = 0.02;
    if (!(amplitude < small && amplitude < amplitude_before)) return std::nullopt;
    const double ratio = amplitude / amplitude_before, ahead = (at.p - p_before) * ratio * ratio / (1 - ratio * ratio);
    const double turn = 2 * std::numbers::pi / at.view.metrics.at("period");
    const auto growth = [&](double p) {
      const auto spectrum = spectrum_of(family_(p)->linearised().moving().A);
      const auto off = [&](std::size_t k) { return std::abs(spectrum.values[k] - std::complex(0.0, turn)); };
      std::size_t nearest = 0;
      for (std::size_t k = 1; k < spectrum.values.size(); ++k)
        if (off(k) < off(nearest)) nearest = k;
      return steady::Leading{spectrum.values[nearest].real(), spectrum.errors[nearest],
                             std::abs(spectrum.values[nearest].imag())};
    };
    std::vector<double> around{at.p, at.p + 2 * ahead};
    std::ranges::sort(around);
    try {
      for (const auto& crossing : steady::crossings(growth, around))
        if (crossing.angular_frequency > 0) return crossing;
    } catch (const InputError&) {  // no steady sliding there
    }
    return std::nullopt;
  }

  void note_crossing(const steady::Crossing& found) {
    constexpr double same = 1e-9;
    if (std::ranges::none_of(result_.crossings, [&](const auto& known) {
          return std::abs(known.value - found.value) <= known.error + found.error + same * std::abs(found.value);
        }))
      result_.crossings.push_back(found);
  }

  /// A zero of the torus test at which two real multipliers have the product 1.
  static bool is_neutral_saddle(const SpecialPoint& special) {
    if (special.test != "torus") return false;
    const auto& z = special.view.multipliers;
    double least = infinity;
    bool is_pair = true;
    for (std::size_t i = 0; i < z.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (const double off = std::abs(z[i] * z[j] - 1.0); off < least) least = off, is_pair = z[i].imag() != 0;
    return !is_pair;
  }

  /// Beyond a border: the motion that a disturbed one settles on, or the smaller cycle that no longer touches.
  std::optional<Continuation::Beyond> beyond(CycleProblem& problem, const SpecialPoint& special,
                                             const std::string& pattern) {
    const double c = options_.parameter.coordinate(special.p), T = problem.period(special.x, special.p);
    const auto y = problem.start(special.x);
    for (const double aside : {1e-4, 1e-3, 1e-2})
      for (const int sign : {1, -1}) {
        const double at = c + sign * aside;
        if (at < 0 || at > 1) continue;
        const double p = options_.parameter.value(at);
        std::vector<std::pair<std::vector<double>, double>> starts;
        if (auto relaxed = relax(y, T, p, problem.turns())) starts.push_back(*relaxed);
        std::vector<double> steady;
        try {
          steady = problem.oscillator(p).steady();
        } catch (const InputError&) {
        }
        for (const double nearer : {1e-3, 1e-2}) {
          auto inner = y;
          for (std::size_t i = 0; i < steady.size(); ++i) inner[i] += nearer * (steady[i] - inner[i]);
          if (!steady.empty()) starts.emplace_back(inner, T);
        }
        for (const auto& [start, period] : starts) {
          CycleProblem trial(family_, problem.turns());
          Continuation closing(trial, this->continuation());
          const auto x = trial.begin(start, period, p);
          const auto point = closing.close(x, p);
          if (!point || point->view.pattern == pattern || point->view.pattern.empty() == pattern.empty()) continue;
          // The problem goes on with the nodes of this cycle.
          auto own = problem.begin(trial.start(point->x), trial.period(point->x, p), p);
          return Continuation::Beyond{std::move(own), p, sign};
        }
      }
    return std::nullopt;
  }

  /// Follows for many periods, to the last slip that began; \returns the unknowns then, and the time since the one
  /// before. Nothing where no contact sticks.
  std::optional<std::pair<std::vector<double>, double>> relax(std::vector<double> y, double period, double p,
                                                              int turns) const {
    constexpr int periods = 40;
    constexpr double tolerance = 1e-8, after = 0.02;
    const auto oscillator = family_(p);
    const double drive = oscillator->drive_period();
    if (drive > 0) {
      period = turns * drive;
      Follower follower = oscillator->follower(tolerance);
      for (int k = 0; k < periods; ++k)
        if (!follower.follow(0, y, period).complete()) return std::nullopt;
      return std::pair(y, period);
    }
    std::vector<double> slips;
    {
      auto trial = y;
      Follower follower = oscillator->follower(tolerance);
      follower.observe = [&](Follower::Step&, std::span<const Follower::Event> switches) {
        for (const auto& event : switches)
          if (event.kind == "slip") slips.push_back(event.time);
      };
      if (!follower.follow(0, trial, periods * period).complete() || slips.size() < 3) return std::nullopt;
    }
    const double turn = slips.back() - slips[slips.size() - 2];
    Follower follower = oscillator->follower(tolerance);
    if (!follower.follow(0, y, slips[slips.size() - 2] + after * turn).complete()) return std::nullopt;
    return std::pair(y, turn);
  }

  const Family& family_;
  BranchOptions options_;
  Branches& result_;
};

/// Whether the cycles born there have been followed from another Hopf point.
bool ends_at(const Branches& found, const steady::Crossing& crossing) {
  constexpr double same = 1e-9;
  return std::ranges::any_of(found.cycles, [&](const CycleBranch& cycle) {
    return cycle.to_value && std::abs(*cycle.to_value - crossing.value) <= same * std::abs(crossing.value);
  });
}

template <class Work>
void until_stopped(Branches& result, Work work) {
  try {
    work();
  } catch (const Stopped&) {
    result.outcome = {Ending::interrupted, "what was found until then is kept"};
  }
}

}  // namespace

Settled settle(const motion::StructureModel& model, double tolerance) {
  const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance, .multipliers = false});
  Settled settled{cycle.outcome, cycle.start, 0, 1};
  if (cycle.returns == 0) return settled;
  settled.outcome = {};
  settled.period = cycle.metrics.at("period").value;
  if (const double drive = common_period(model.structure); drive > 0) settled.turns = cycle.returns;
  return settled;
}

bool settles_as_structure(const oscillators::Model& model) { return model.slider.mass > 0; }

Settled settle(const oscillators::Model& model, double tolerance, const std::optional<motion::Start>& start) {
  if (settles_as_structure(model)) {
    motion::StructureModel structure{one_slider(model), {}};
    structure.start.kind = motion::Start::Kind::rest;
    return settle(structure, tolerance);
  }
  Settled settled;
  const oscillators::SliderSystem system(model);
  if (model.drive.constant()) {
    const auto cycle = cycles::find_cycle(model, {.tolerance = tolerance, .multipliers = false, .start = start});
    settled.outcome = cycle.outcome;
    if (!cycle.outcome.complete()) return settled;
    const auto& at = cycle.orbit.front();
    settled.y = system.unknowns_at(0, at.displacement, at.slip_rate, at.state,
                                   at.friction_coefficient * model.drive.normal_load.level());
    // The oscillator measures displacement from steady sliding.
    if (system.mechanics() != oscillators::Mechanics::elastic) {
      const double origin = system.steady(0)[0];
      settled.y[0] -= origin - oscillator_of(model)->steady()[0];
    }
    settled.period = cycle.metrics.period;
    return settled;
  }
  // Without mass the answer to the drive is looked for from steady sliding.
  const auto oscillator = oscillator_of(model);
  settled.y = start ? motion::starting_point(system, *start) : oscillator->steady();
  settled.period = oscillator->drive_period();
  Follower follower = oscillator->follower(tolerance);
  constexpr int periods = 200;
  for (int k = 0; k < periods && settled.outcome.complete(); ++k)
    settled.outcome = follower.follow(0, settled.y, settled.period);
  return settled;
}

const SmallCycles* small_cycles_of(const Branches& found, const CycleBranch& cycle) {
  if (cycle.from != "hopf") return nullptr;
  for (std::size_t k = 0; k < found.small_cycles.size(); ++k)
    if (found.crossings[k].value == cycle.from_value && found.small_cycles[k]) return &*found.small_cycles[k];
  return nullptr;
}

std::vector<steady::Crossing> crossings_of(const oscillators::Model& model, std::string_view parameter,
                                           const ParameterScale& range) {
  std::vector<steady::Crossing> found;
  const auto [low, high] = std::minmax(range.from, range.to);
  for (const auto& hopf : steady::hopf_points(model, parameter)) {
    if (hopf.value < low || hopf.value > high) continue;
    const auto above = steady::stability(model.with(parameter, hopf.value * (1 + 1e-6)));
    found.push_back({hopf.value, hopf.value_error, !above.stable, hopf.angular_frequency});
  }
  std::ranges::sort(found, {}, &steady::Crossing::value);
  return found;
}

Branches from_steady_sliding(const Family& family, const BranchOptions& options,
                             const std::optional<std::vector<steady::Crossing>>& crossings) {
  Branches result;
  constexpr int points = 101;
  std::vector<double> values;
  for (int i = 0; i < points; ++i) values.push_back(options.parameter.value(double(i) / (points - 1)));
  std::ranges::sort(values);
  const auto leading_of = [](const Spectrum& spectrum) {
    std::size_t most = 0;
    for (std::size_t i = 0; i < spectrum.values.size(); ++i)
      if (spectrum.values[i].real() > spectrum.values[most].real()) most = i;
    const auto z = spectrum.values[most];
    return steady::Leading{z.real(), spectrum.errors[most], std::abs(z.imag())};
  };
  std::map<double, steady::Leading> known;
  const auto leading = [&](double p) {
    const auto found = known.find(p);
    return found != known.end() ? found->second
                                : leading_of(steady::spectrum_of_sliding(family(p)->linearised().moving()));
  };
  std::vector<double> sliding;
  for (const double p : values) {
    try {
      const auto oscillator = family(p);
      const auto there = oscillator->linearised();
      auto spectrum = steady::spectrum_of_sliding(there.moving());
      const auto most = known[p] = leading_of(spectrum);
      std::ranges::stable_sort(spectrum.values, std::greater(), [](auto z) { return z.real(); });
      result.steady.push_back(
          {p, most.growth < 0 && !most.is_neutral(), spectrum.values, oscillator->slip_rates(there.y), ""});
      sliding.push_back(p);
    } catch (const InputError& error) {
      result.steady.push_back({p, false, {}, {}, error.what()});
    }
  }
  result.crossings = crossings ? *crossings : steady::crossings(leading, sliding);
  if (!options.cycles) return result;
  until_stopped(result, [&] {
    Tracer tracer(family, options, result);
    const auto begins = result.crossings;  // a branch may end at one that is not among them
    for (const auto& crossing : begins)
      if (crossing.angular_frequency > 0 && !ends_at(result, crossing)) tracer.from_hopf(crossing);
  });
  return result;
}

void require_continuous_period(const Family& family, const ParameterScale& range, double value) {
  constexpr double aside = 1e-6, same = 1e-2;
  const double c = range.coordinate(value), other = range.value(c + (c < 0.5 ? aside : -aside));
  const double period = family(value)->drive_period();
  std::string why;
  try {
    const double next = family(other)->drive_period();
    if (period == 0 || next == 0 || std::abs(next / period - 1) < same) return;
    why = fmt::format("it is {:.9g} s at {:.9g} and {:.9g} s at {:.9g}", period, value, next, other);
  } catch (const InputError& error) {
    why = fmt::format("at {:.9g}: {}", other, error.what());
  }
  throw InputError(
      fmt::format("the period of the drive does not vary continuously along the parameter ({}): no cycle "
                  "can be followed; several frequencies of a drive must keep their ratio",
                  why));
}

Branches from_cycle(const Family& family, const Settled& settled, double value, const BranchOptions& options) {
  Branches result;
  until_stopped(result, [&] {
    Tracer tracer(family, options, result);
    const double c = options.parameter.coordinate(value);
    if (c < 1) tracer.from_cycle(settled, value, 1);
    if (c > 0) tracer.from_cycle(settled, value, -1);
  });
  return result;
}

}  // namespace rosin::analysis::branches
