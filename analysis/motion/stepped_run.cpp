/// Steps followed with what is seen of them, twice: as asked, and by half the step.
#include "analysis/motion/stepped_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/motion/last_oscillation.hpp"
#include "analysis/motion/stepper.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "core/stop.hpp"

namespace rosin::analysis::motion {

namespace {

using Eigen::VectorXd;
using oscillators::StationForces, oscillators::Structure;
using Sparse = Eigen::SparseMatrix<double>;

/// What is seen of the motion at one moment.
struct Seen {
  VectorXd functionals, pressures, slip_rates;  ///< of each contact
  double friction = 0, load = 0, stick = 0, open = 0, pressure_min = infinity;
  bool all_stick = false;
  std::vector<Touch> touch;  ///< of each station
};

class Observer {
 public:
  Observer(const Structure& structure, const StationForces& contacts, double stick_width)
      : contacts_(contacts), stick_width_(stick_width) {
    for (const auto& functional : structure.functionals) rows_.push_back(functional.row.sparseView());
    size_ = int(rows_.empty() ? structure.size() : rows_.size());
    for (const auto& contact : contacts.contacts())
      for (int s = contact.first; s < contact.first + contact.stations; ++s) area_ += contacts.area(s);
  }
  int functionals() const { return size_; }

  Seen see(const Stepper& stepper) const {
    Seen seen;
    const VectorXd place = contacts_.rows() * stepper.coordinates(), rate = contacts_.rows() * stepper.velocities();
    if (rows_.empty())
      seen.functionals = stepper.coordinates();
    else
      seen.functionals = VectorXd::NullaryExpr(size_, [&](auto i) { return rows_[i].dot(stepper.coordinates()); });
    const auto contacts = Eigen::Index(contacts_.contacts().size());
    seen.pressures.setZero(contacts), seen.slip_rates.setZero(contacts);
    seen.all_stick = true;
    for (std::size_t j = 0; j < contacts_.contacts().size(); ++j) {
      const auto& [slip, first, stations, area] = contacts_.contacts()[j];
      const auto& value = stepper.forces().value;
      seen.friction += value[slip];
      const double N = stations > 0 ? -value.segment(first, stations).sum() : contacts_.load(int(j), stepper.time());
      const double u = contacts_.speed(int(j), stepper.time()) - rate[slip];
      seen.load += N;
      seen.pressures[Eigen::Index(j)] = N / area, seen.slip_rates[Eigen::Index(j)] = u;
      const bool sticks = std::abs(u) < stick_width_;
      bool closed = stations == 0;
      for (int s = first; s < first + stations; ++s) {
        const double part = contacts_.area(s) / area_;
        seen.pressure_min = std::min(seen.pressure_min, -value[s] / contacts_.area(s));
        const Touch touch = contacts_.approach(s, place) <= 0 ? Touch::open : sticks ? Touch::sticks : Touch::slips;
        seen.touch.push_back(touch);
        seen.open += touch == Touch::open ? part : 0, seen.stick += touch == Touch::sticks ? part : 0;
        closed = closed || touch != Touch::open;
      }
      seen.all_stick = seen.all_stick && (sticks || !closed);
    }
    seen.all_stick = seen.all_stick && seen.open < 1;
    return seen;
  }

 private:
  const StationForces& contacts_;
  double stick_width_, area_ = 0;
  std::vector<Eigen::SparseVector<double>> rows_;
  int size_;
};

/// Energy, and the works that change it, by the trapezoidal rule.
class StepAudit {
 public:
  StepAudit(const Structure& structure, const StationForces& contacts)
      : contacts_(contacts),
        structure_(structure),
        C_(structure.C.sparseView()),
        symmetric_(Sparse((structure.K + structure.K.transpose()).sparseView()) / 2),
        skew_(Sparse((structure.K - structure.K.transpose()).sparseView()) / 2) {}

  void begin(const Stepper& stepper) { before_ = energy(stepper), power_ = power(stepper); }
  void add(const Stepper& stepper, double step) {
    const Power now = power(stepper);
    work_ += step / 2 * (now.all + power_.all), belt += step / 2 * (now.belt + power_.belt);
    heat += step / 2 * (now.heat + power_.heat);
    power_ = now;
  }
  double residual(const Stepper& stepper) const {
    const double left = std::abs(energy(stepper) - before_ - work_);
    return belt != 0 ? left / std::abs(belt) : 0;
  }
  double belt = 0, heat = 0;  ///< J: work of the surfaces, and what friction has turned into heat

 private:
  struct Power {
    double all = 0, belt = 0, heat = 0;
  };
  double energy(const Stepper& stepper) const {
    const VectorXd& q = stepper.coordinates();
    return stepper.kinetic_energy() + q.dot(symmetric_ * q) / 2;
  }
  Power power(const Stepper& stepper) const {
    const double t = stepper.time();
    const VectorXd &q = stepper.coordinates(), &v = stepper.velocities();
    const VectorXd rate = contacts_.rows() * v;
    Power power;
    power.all = -v.dot(C_ * v) - v.dot(skew_ * q) + v.dot(contacts_.dead_load(t));
    for (std::size_t i = 0; i < structure_.force.size(); ++i)
      power.all += structure_.force[i].value(t) * v[Eigen::Index(i)];
    power.all += rate.dot(stepper.forces().value);
    for (std::size_t j = 0; j < contacts_.contacts().size(); ++j) {
      const int slip = contacts_.contacts()[j].slip;
      const double F = stepper.forces().value[slip], V = contacts_.speed(int(j), t);
      power.belt += F * V, power.heat += F * (V - rate[slip]);
    }
    return power;
  }

  const StationForces& contacts_;
  const Structure& structure_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> C_, symmetric_, skew_;
  double before_ = 0, work_ = 0;
  Power power_;
};

/// Averages over the second half, each step by its length.
class Averages {
 public:
  Averages(double duration, int functionals) : duration_(duration), level_(VectorXd::Zero(functionals)) {
    sum_ = low_ = high_ = before_ = first_ = last_ = level_;
    low_.setConstant(infinity), high_.setConstant(-infinity);
    turns_.assign(functionals, 0);
  }
  void add(double t, double step, const Seen& seen) {
    if (t > duration_ / 4 && t <= duration_ / 2) level_ += seen.functionals, ++of_level_;
    if (t > duration_ / 2) {
      if (count_ == 0) level_ /= double(std::max(of_level_, 1L));
      ++count_;
      sum_ += seen.functionals, low_ = low_.cwiseMin(seen.functionals), high_ = high_.cwiseMax(seen.functionals);
      friction_ += seen.friction, load_ += seen.load, stick_ += seen.stick, open_ += seen.open;
      full_ += seen.all_stick ? 1 : 0;
      load_low_ = std::min(load_low_, seen.load), load_high_ = std::max(load_high_, seen.load);
      pressure_min_ = std::min(pressure_min_, seen.pressure_min);
      for (Eigen::Index i = 0; i < level_.size(); ++i) {
        const double now = seen.functionals[i] - level_[i], then = before_[i] - level_[i];
        if (count_ == 1 || then >= 0 || now < 0) continue;
        last_[i] = t - step * now / (now - then);
        if (turns_[i]++ == 0) first_[i] = last_[i];
      }
    }
    before_ = seen.functionals;
  }
  /// Over its mean over the second quarter, in the second half.
  std::optional<double> departure(Eigen::Index functional, const Seen& seen) const {
    if (count_ == 0) return std::nullopt;
    return seen.functionals[functional] - level_[functional];
  }
  void write(const std::vector<std::string>& names, bool presses, std::map<std::string, double>& metrics) const {
    if (count_ == 0) return;
    const double n = double(count_);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto k = Eigen::Index(i);
      metrics[names[i] + "_mean"] = sum_[k] / n;
      metrics[names[i] + "_amplitude"] = (high_[k] - low_[k]) / 2;
      if (turns_[i] > 1) metrics[names[i] + "_period"] = (last_[k] - first_[k]) / double(turns_[i] - 1);
    }
    metrics["friction_force_mean"] = friction_ / n, metrics["normal_load_mean"] = load_ / n;
    if (load_ != 0) metrics["apparent_friction"] = friction_ / load_;  // nothing touches through all of the second half
    metrics["normal_load_min"] = load_low_, metrics["normal_load_max"] = load_high_;
    metrics["stick_fraction"] = stick_ / n, metrics["full_stick_fraction"] = full_ / n;
    metrics["open_fraction"] = open_ / n;
    if (presses) metrics["pressure_min"] = pressure_min_;
  }

 private:
  double duration_;
  VectorXd level_, sum_, low_, high_, before_, first_, last_;
  std::vector<long> turns_;
  long of_level_ = 0, count_ = 0;
  double friction_ = 0, load_ = 0, stick_ = 0, open_ = 0, full_ = 0;
  double load_low_ = infinity, load_high_ = -infinity, pressure_min_ = infinity;
};

struct SteppedPass {
  Outcome outcome;
  std::vector<double> time;
  std::vector<std::vector<double>> columns;
  std::map<std::string, double> metrics;
  Frames oscillation;
  Run::Cost cost;
};

std::vector<std::string> names_of(const Structure& structure, std::vector<std::string>& units) {
  std::vector<std::string> names;
  for (const auto& functional : structure.functionals)
    names.push_back(functional.name), units.push_back(functional.unit);
  if (names.empty()) names = structure.names, units.assign(names.size(), "m");
  return names;
}

VectorXd start_of(const StructureModel& model, const StationForces& contacts, VectorXd& velocity) {
  const auto& start = model.start;
  const int n = model.structure.size();
  velocity = VectorXd::Zero(n);
  VectorXd q = VectorXd::Zero(n);
  if (start.kind == Start::Kind::steady) q = steady::steady_sliding(model.structure, contacts);
  if (start.kind == Start::Kind::rest)
    throw InputError("run.start = \"rest\" does not serve steps of a given length; use \"steady\" or a table");
  const auto take = [](const std::vector<std::optional<double>>& values, VectorXd& into) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i]) into[Eigen::Index(i)] = *values[i];
  };
  take(start.coordinates, q), take(start.velocities, velocity);
  if (start.beside.size() > 0) q += start.beside;
  return q;
}

SteppedPass follow(const StructureModel& model, const RunOptions& options, const StationForces& contacts, double step,
                   const std::vector<double>& times) {
  const Structure& structure = model.structure;
  VectorXd v;
  const VectorXd q = start_of(model, contacts, v);
  Stepping stepping = *options.stepping;
  stepping.step = step;
  const auto stepper = make_stepper(structure, contacts, stepping, q, v);
  const Observer observer(structure, contacts, stepping.stick_width);
  StepAudit audit(structure, contacts);
  const double end = std::max(options.duration, times.back());
  Averages averages(end, observer.functionals());
  // Oscillations are told by the last functional, the tilt of a block.
  LastOscillation oscillation;
  const auto told_by = Eigen::Index(structure.functionals.size()) - 1;
  SteppedPass pass;
  std::vector<std::string> units;
  const auto names = names_of(structure, units);
  const auto values_of = [](const Seen& seen) {
    VectorXd row(seen.functionals.size() + 4 + 2 * seen.pressures.size());
    row << seen.functionals, seen.friction, seen.load, seen.stick, seen.open, seen.pressures, seen.slip_rates;
    return row;
  };
  Seen seen = observer.see(*stepper);
  VectorXd before = values_of(seen);
  pass.columns.resize(std::size_t(before.size()));
  std::size_t next = 0;
  const auto record = [&](double t, const VectorXd& row) {
    pass.time.push_back(t);
    for (Eigen::Index c = 0; c < row.size(); ++c) pass.columns[std::size_t(c)].push_back(row[c]);
    ++next;
  };
  while (next < times.size() && times[next] <= 0) record(times[next], before);
  audit.begin(*stepper);
  constexpr double same_moment = 1e-9;
  while (stepper->time() < end - same_moment * step) {
    if (Listening::stop_asked()) {
      pass.outcome = {Ending::interrupted, fmt::format("{} of {} samples are kept", pass.time.size(), times.size())};
      break;
    }
    if (pass.cost.steps >= options.most_steps) {
      pass.outcome = {Ending::budget_spent, fmt::format("{} steps at t = {:.9g} s", pass.cost.steps, stepper->time())};
      break;
    }
    const double t = stepper->time();
    pass.outcome = stepper->advance();
    ++pass.cost.steps;
    if (!pass.outcome.complete()) break;
    seen = observer.see(*stepper);
    audit.add(*stepper, step);
    averages.add(stepper->time(), step, seen);
    if (const auto place = told_by >= 0 ? averages.departure(told_by, seen) : std::nullopt)
      oscillation.add(*place, stepper->time(), stepper->coordinates(), seen.touch, seen.friction, seen.load);
    const VectorXd now = values_of(seen);
    for (; next < times.size() && times[next] <= stepper->time() + same_moment * step;) {
      const double part = (times[next] - t) / step;
      record(times[next], before + part * (now - before));
    }
    before = now;
    if (options.progress && pass.cost.steps % 64 == 0) options.progress(stepper->time() / end);
  }
  pass.cost.evaluations = stepper->iterations();
  const bool presses = std::ranges::any_of(contacts.contacts(), [](const auto& contact) { return contact.presses(); });
  averages.write(names, presses, pass.metrics);
  pass.metrics["energy_residual"] = audit.residual(*stepper);
  pass.metrics["friction_work"] = audit.heat;
  pass.oscillation = oscillation.whole();
  return pass;
}

}  // namespace

const std::vector<std::string>& scheme_names() {
  static const std::vector<std::string> names = {"average-acceleration", "generalised-alpha", "explicit"};
  return names;
}

Run run_stepped(const StructureModel& model, const RunOptions& options) {
  const auto times = sample_times(options);
  const StationForces contacts(model.structure);
  const double step = options.stepping->step;
  SteppedPass pass = follow(model, options, contacts, step, times);
  Run run;
  run.outcome = pass.outcome;
  run.solver = scheme_names()[std::size_t(options.stepping->scheme)];
  run.why = fmt::format("steps of {:.6g} s; errors are differences to steps of half the length", step);
  run.column_names = names_of(model.structure, run.column_units);
  const auto add_column = [&](std::string name, const char* unit) {
    run.column_names.push_back(std::move(name)), run.column_units.emplace_back(unit);
  };
  add_column("friction_force", "N"), add_column("normal_load", "N");
  add_column("stick_fraction", "1"), add_column("open_fraction", "1");
  for (const auto& [name, unit] : {std::pair{"pressure", "Pa"}, std::pair{"slip_rate", "m/s"}})
    for (std::size_t j = 1; j <= contacts.contacts().size(); ++j) add_column(fmt::format("{}_{}", name, j), unit);
  if (model.start.kind == Start::Kind::steady && model.start.beside.size() == 0 && model.structure.constant())
    run.remark =
        "the motion starts in steady sliding, which nothing disturbs; to see what becomes of a disturbance, start "
        "beside it (run.start)";
  if (!pass.oscillation.empty()) run.oscillation = std::make_shared<const Frames>(std::move(pass.oscillation));
  run.time = pass.time, run.columns = pass.columns, run.metrics = pass.metrics, run.cost = pass.cost;
  run.column_error.assign(run.columns.size(), infinity);
  if (!pass.outcome.complete()) return run;
  const SteppedPass half = follow(model, options, contacts, step / 2, times);
  run.cost.steps += half.cost.steps, run.cost.evaluations += half.cost.evaluations;
  if (!half.outcome.complete()) {
    run.outcome = {half.outcome.ending,
                   "errors are unknown, for half the step does not reach the end: " + half.outcome.detail};
    return run;
  }
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    run.column_error[c] = 0;
    for (std::size_t i = 0; i < run.time.size(); ++i)
      run.column_error[c] = std::max(run.column_error[c], std::abs(run.columns[c][i] - half.columns[c][i]));
  }
  for (const auto& [name, value] : pass.metrics)
    if (const auto other = half.metrics.find(name); other != half.metrics.end() && name != "energy_residual")
      run.metrics[name + "_error"] = std::abs(value - other->second);
  return run;
}

}  // namespace rosin::analysis::motion
