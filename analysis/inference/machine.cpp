/// Motions of machines, kept as long as the columns of a record ask for them.
#include "analysis/inference/machine.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/stop.hpp"

namespace rosin::analysis::inference {

namespace {
constexpr std::size_t most_kept = 100;  // those of a few Jacobians
}

Machine::Machine(Family family, std::string name, std::string starts, std::vector<double> times, int threads)
    : family_(std::move(family)),
      name_(std::move(name)),
      starts_(std::move(starts)),
      times_(std::move(times)),
      threads_(std::max(1, threads)) {}

bool Machine::depends_on(const std::string& path) const {
  return !path.starts_with("data.") || path.starts_with(starts_);
}

const std::vector<double>& Machine::Motion::column(const std::string& name) const {
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return columns[std::size_t(found - names.begin())];
  const auto near = nearest_name(name, names);
  throw InputError(fmt::format("the motion has no column '{}'{}", name,
                               near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

std::size_t Machine::Motion::at(double t) const {
  const auto next = std::ranges::lower_bound(time, std::max(t, time.front()));
  return std::size_t(std::min(next, time.end() - 1) - time.begin());
}

std::shared_ptr<const Machine::Motion> Machine::motion(const MachineNumbers& numbers, double clock_offset,
                                                       double beside, long& computed) const {
  Key key{numbers, clock_offset, beside};
  std::erase_if(key.numbers, [&](const auto& number) { return !depends_on(number.first); });
  {
    const std::scoped_lock lock(guard_);
    if (const auto found = kept_.find(key); found != kept_.end()) return found->second;
  }
  auto motion = std::make_shared<Motion>();
  auto& times = motion->time;
  for (const double x : times_)
    for (const double shift : {-beside, 0.0, beside}) times.push_back(std::max(0.0, x - clock_offset + shift));
  std::ranges::sort(times);
  const auto twice = std::ranges::unique(times);
  times.erase(twice.begin(), twice.end());
  auto run = family_.run(key.numbers, times);
  end_if_stopped();
  if (!run.outcome.complete())
    throw InputError(fmt::format("{}: the motion ends before the record, at {:.6g} of {:.6g} s: {}", name_,
                                 run.time.empty() ? 0 : run.time.back(), times.back(), run.outcome.detail));
  motion->names = std::move(run.column_names), motion->units = std::move(run.column_units);
  motion->columns = std::move(run.columns);
  motion->steps = run.cost.steps;
  const std::scoped_lock lock(guard_);
  computed += motion->steps;
  if (kept_.size() >= most_kept) kept_.clear();
  return kept_[std::move(key)] = motion;
}

std::shared_ptr<const Machine::Cycle> Machine::cycle(const MachineNumbers& given) const {
  auto numbers = given;
  std::erase_if(numbers, [&](const auto& number) { return !depends_on(number.first); });
  {
    const std::scoped_lock lock(guard_);
    if (const auto found = kept_cycles_.find(numbers); found != kept_cycles_.end()) return found->second;
  }
  const auto model = family_.structure(numbers);
  auto cycle = std::make_shared<Cycle>(
      Cycle{model.structure, cycles::find_cycle(model, {.tolerance = 1e-9, .multipliers = false})});
  end_if_stopped();
  const std::scoped_lock lock(guard_);
  if (kept_cycles_.size() >= most_kept) kept_cycles_.clear();
  return kept_cycles_[std::move(numbers)] = std::move(cycle);
}

bool Subject::in_model(const std::string& path) const {
  return std::ranges::any_of(model.parameters(), [&](const auto& known) { return known.name == path; });
}

const Machine* Subject::owner(const std::string& path) const {
  for (const auto& machine : machines) {
    if (!machine->depends_on(path)) continue;
    try {
      machine->family().describe(path);
      return machine.get();
    } catch (const InputError&) {
    }
  }
  return nullptr;
}

// A law is that of the model and of all machines; of what else a machine has, the model's is a default.
Quantity Subject::describe(const std::string& path) const {
  const bool of_law = path.starts_with("law.") && in_model(path);
  if (of_law || machines.empty()) return model.describe(path);
  if (const auto* machine = owner(path)) {
    auto quantity = machine->family().describe(path);
    quantity.name = path;
    return quantity;
  }
  return machines.front()->family().describe(path);  // which says what is near
}

double Subject::get(const std::string& path) const {
  if ((path.starts_with("law.") && in_model(path)) || machines.empty()) return model.get(path);
  if (const auto found = changed.find(path); found != changed.end()) return found->second;
  const auto* machine = owner(path);
  return (machine ? machine : machines.front().get())->family().value(path);
}

Subject Subject::with(const std::string& path, double value) const {
  auto other = *this;
  if (machines.empty() || in_model(path)) other.model = model.with(path, value);
  if (!machines.empty()) other.changed[path] = value;
  return other;
}

}  // namespace rosin::analysis::inference
