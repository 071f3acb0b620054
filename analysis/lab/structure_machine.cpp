/// A structure as a machine: a slider that hangs on a frame which moves too, or several contacts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/cycles/structure_extremes.hpp"
#include "analysis/lab/machine.hpp"
#include "analysis/motion/structure_record.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/steady/thresholds.hpp"
#include "oscillators/structure_at_contact.hpp"

namespace rosin::analysis::lab {

namespace {

using oscillators::Structure;

class StructureMachine final : public Machine {
 public:
  explicit StructureMachine(Structure structure)
      : structure_(std::move(structure)),
        displacement_(oscillators::contact_displacement(structure_)),
        spring_force_(oscillators::spring_force(structure_)),
        stiffness_(oscillators::stiffness_at_contact(structure_)) {
    for (const auto& contact : structure_.contacts)
      load_ += contact.frictionless() ? 0 : contact.load_factor * contact.normal_load.level();
  }

  motion::Run run(const Signal& speed, const motion::RunOptions& options) const override {
    auto run = motion::run_structure(from(options.start.kind, at(speed)), options);
    if (sums_contacts()) add_sums(run);
    return run;
  }
  std::vector<std::string> column_names() const override {
    auto names = motion::StructureRecord(oscillators::StructureSystem(structure_)).names;
    if (sums_contacts()) names.insert(names.end(), {"slip_rate", "friction_force", "friction_coefficient"});
    return names;
  }
  double settling_time(double V) const override {
    const auto found = steady::stability(at(V));
    if (found.eigenvalues.empty()) return 0;
    return found.stable ? -1 / found.eigenvalues.front().real() : infinity;
  }
  Regime regime(double tolerance) const override;

  double normal_load() const override { return load_; }
  double stiffness() const override { return stiffness_; }
  bool friction_may_jump() const override {
    return std::ranges::any_of(structure_.contacts, [](const auto& contact) { return contact.law->set_valued(); });
  }
  CoordinateSum displacement() const override { return sum_of(displacement_); }
  CoordinateSum spring_force() const override { return sum_of(spring_force_); }

 private:
  static motion::StructureModel from(motion::Start::Kind kind, Structure structure) {
    motion::StructureModel model{std::move(structure), {}};
    model.start.kind = kind;
    return model;
  }
  static CoordinateSum sum_of(const Eigen::VectorXd& weights) { return {{weights.begin(), weights.end()}}; }
  /// Columns carry the number of their contact.
  bool sums_contacts() const { return structure_.contacts.size() > 1; }
  Structure at(const Signal& speed) const {
    auto structure = structure_;
    for (auto& contact : structure.contacts)
      if (!contact.frictionless()) contact.speed = speed;
    return structure;
  }
  /// Slip rate, friction and load of all contacts together, from columns of a run or a cycle.
  struct Together {
    std::vector<double> slip_rate, friction_force, friction_coefficient;
    double errors[3] = {0, 0, 0};
  };
  Together together(const std::vector<std::string>& names, const std::vector<std::vector<double>>& columns,
                    const std::vector<double>& errors) const;
  void add_sums(motion::Run&) const;
  Regime::Number critical(double here, const std::function<void(Structure&, double)>& scale) const;

  Structure structure_;
  Eigen::VectorXd displacement_, spring_force_;
  double stiffness_, load_ = 0;
};

StructureMachine::Together StructureMachine::together(const std::vector<std::string>& names,
                                                      const std::vector<std::vector<double>>& columns,
                                                      const std::vector<double>& errors) const {
  const auto find = [&](const char* name, std::size_t contact) {
    return std::size_t(std::ranges::find(names, fmt::format("{}_{}", name, contact + 1)) - names.begin());
  };
  const auto samples = columns.front().size();
  Together sum{std::vector<double>(samples), std::vector<double>(samples), std::vector<double>(samples)};
  std::vector<double> load(samples);
  double load_error = 0, largest = 0, lightest = infinity;
  int contacts = 0;
  for (std::size_t j = 0; j < structure_.contacts.size(); ++j) contacts += !structure_.contacts[j].frictionless();
  for (std::size_t j = 0; j < structure_.contacts.size(); ++j) {
    const auto& contact = structure_.contacts[j];
    if (contact.frictionless()) continue;
    const auto v = find("slip_rate", j), F = find("friction_force", j), N = find("normal_load", j);
    const double weight = load_ > 0 ? contact.load_factor * contact.normal_load.level() / load_ : 1 / double(contacts);
    for (std::size_t i = 0; i < samples; ++i) {
      sum.slip_rate[i] += weight * columns[v][i];
      sum.friction_force[i] += columns[F][i];
      load[i] += columns[N][i];
    }
    sum.errors[0] += weight * errors[v], sum.errors[1] += errors[F], load_error += errors[N];
  }
  for (std::size_t i = 0; i < samples; ++i) {
    if (!(load[i] > 0)) continue;  // all contacts are open
    const double mu = sum.friction_coefficient[i] = sum.friction_force[i] / load[i];
    largest = std::max(largest, std::abs(mu)), lightest = std::min(lightest, load[i]);
  }
  sum.errors[2] = (sum.errors[1] + largest * load_error) / lightest;
  return sum;
}

void StructureMachine::add_sums(motion::Run& run) const {
  auto sum = together(run.column_names, run.columns, run.column_error);
  const struct {
    const char *name, *unit;
    std::vector<double>* values;
  } columns[] = {{"slip_rate", "m/s", &sum.slip_rate},
                 {"friction_force", "N", &sum.friction_force},
                 {"friction_coefficient", "1", &sum.friction_coefficient}};
  for (int c = 0; c < 3; ++c) {
    run.column_names.emplace_back(columns[c].name), run.column_units.emplace_back(columns[c].unit);
    run.columns.push_back(std::move(*columns[c].values));
    run.column_error.push_back(sum.errors[c]);
  }
}

/// The threshold of steady sliding that is nearest in ratio, within six decades.
Regime::Number StructureMachine::critical(double here, const std::function<void(Structure&, double)>& scale) const {
  const auto leading = [&](double factor) -> steady::Leading {
    auto scaled = structure_;
    scale(scaled, factor);
    try {
      const auto found = steady::stability(scaled);
      if (found.modes.empty()) return {-1, 0, 0};
      const auto& mode = found.modes.front();
      return {mode.growth_rate(), mode.error, std::abs(mode.eigenvalue.imag())};
    } catch (const InputError&) {  // no steady sliding, or none that can be linearised
      return {std::nan(""), 0, 0};
    }
  };
  constexpr int decades = 6, points = 10;
  std::vector<double> factors;
  for (int i = -decades * points; i <= decades * points; ++i) factors.push_back(std::pow(10, double(i) / points));
  Regime::Number nearest;
  double away = infinity;
  for (const auto& crossing : steady::crossings(leading, factors))
    if (const double ratio = std::abs(std::log(crossing.value)); ratio < away)
      away = ratio, nearest = {here * crossing.value, here * crossing.error};
  return nearest;
}

Regime StructureMachine::regime(double tolerance) const {
  if (!structure_.constant())
    throw InputError("spring-pulled takes a constant drive.speed, normal_load and force; 'rosin run' follows others");
  if (!(stiffness_ > 0))
    throw InputError("no spring holds the contact: friction would carry the machine away (oscillator, N/m)");
  Regime regime;
  const auto steady = steady::stability(structure_);
  regime.stable = steady.stable;
  regime.settling_time = steady.stable ? -1 / steady.eigenvalues.front().real() : 0;
  double friction = 0, load = 0;
  for (const auto& contact : steady.contacts) friction += contact.friction_force, load += contact.normal_load;
  regime.friction_coefficient = friction / load;
  regime.critical_stiffness = critical(stiffness_, [](Structure& structure, double factor) { structure.K *= factor; });
  regime.critical_load = critical(load_, [](Structure& structure, double factor) {
    for (auto& contact : structure.contacts) contact.load_factor *= factor;
  });

  const auto cycle = cycles::find_cycle(from(motion::Start::Kind::rest, structure_),
                                        cycles::StructureCycleOptions{.tolerance = tolerance, .multipliers = false});
  regime.oscillates = cycle.returns > 0;
  if (!regime.oscillates) {
    regime.why_not = cycle.outcome.detail.empty() ? name(cycle.outcome.ending) : cycle.outcome.detail;
    return regime;
  }
  const auto measured = [&](const std::string& name) {
    const auto& measure = cycle.metrics.at(name);
    return Regime::Number{measure.value, measure.error};
  };
  regime.period = measured("period");
  const auto force = cycles::extremes_of(cycle, spring_force_);
  regime.force_drop = {force.high - force.low, 2 * force.error};
  const oscillators::StructureSystem system(structure_);
  const auto contacts = std::ranges::count_if(structure_.contacts, [](const auto& c) { return !c.frictionless(); });
  regime.slip_rate_max = {-infinity}, regime.stick_fraction = {0};
  for (int j = 0; j < system.friction_contacts(); ++j) {
    if (structure_.contacts[std::size_t(j)].frictionless()) continue;
    if (const auto fastest = measured(motion::numbered(system, "slip_rate", j) + "_max");
        fastest.value > regime.slip_rate_max.value)
      regime.slip_rate_max = fastest;
    const auto stick = measured(motion::numbered(system, "stick_fraction", j));
    regime.stick_fraction.value += stick.value / double(contacts);
    regime.stick_fraction.error += stick.error / double(contacts);
  }
  if (sums_contacts()) {
    auto sum = together(cycle.column_names, cycle.columns, std::vector<double>(cycle.columns.size()));
    regime.slip_rate = std::move(sum.slip_rate), regime.friction_coefficient_over = std::move(sum.friction_coefficient);
  } else {
    const auto column = [&](const char* name) {
      return cycle.columns[std::size_t(std::ranges::find(cycle.column_names, name) - cycle.column_names.begin())];
    };
    regime.slip_rate = column("slip_rate"), regime.friction_coefficient_over = column("friction_coefficient");
  }
  return regime;
}

}  // namespace

std::unique_ptr<const Machine> structure_machine(Structure structure) {
  return std::make_unique<StructureMachine>(std::move(structure));
}

}  // namespace rosin::analysis::lab
