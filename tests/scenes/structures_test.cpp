/// Structures drawn at random: all numbers that a run states against equations and switches written anew, under CVODE;
/// and whether cycles are found.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/motion/structure_run.hpp"
#include "tests/app/folder.hpp"
#include "tests/app/scene_of.hpp"
#include "tests/scenes/cvode_motion.hpp"

using namespace rosin;
using namespace rosin::tests;

namespace {

constexpr double tolerance = 1e-6;  // that a run is asked for

struct Count {
  int structures = 0, failures = 0, undecided = 0, other_order = 0;
  long numbers = 0, outside = 0, unjudged = 0, events = 0;
  std::string faults;  ///< one a line
};

/// A number beside the reference, known from two passes of its own.
void compare(Count& count, unsigned seed, const std::string& name, double value, double error, double fine,
             double coarse) {
  const double known = 3 * std::abs(fine - coarse);
  if (known > std::max(error, 1e-9)) {
    ++count.unjudged;
    return;
  }
  ++count.numbers;
  if (std::abs(value - fine) <= error + known) return;
  ++count.outside;
  count.faults +=
      fmt::format("  {}: {} = {:.15g} ± {:.1e}, by CVODE {:.15g} ± {:.1e}\n", seed, name, value, error, fine, known);
}

void judge(unsigned seed, Count& count) {
  const auto drawn = draw_structure(seed);
  const Folder folder;
  const auto path = folder.path / "structure.toml";
  std::ofstream(path) << drawn.scene();
  const auto scene = scene_of(path, {}, "run");
  analysis::motion::RunOptions options;
  options.duration = drawn.duration, options.times = drawn.times, options.tolerance = tolerance;
  ++count.structures;
  const auto run = analysis::motion::run_structure(*scene.structure, options);
  if (!run.outcome.complete()) {
    ++count.failures;
    count.faults += fmt::format("  {}: {}\n", seed, run.outcome.detail);
  }
  CvodeMotion fine, coarse;
  try {
    fine = cvode_motion(drawn, 1e-12), coarse = cvode_motion(drawn, 1e-11);
  } catch (const std::runtime_error& error) {
    ++count.undecided;
    count.faults += fmt::format("  {}: reference: {}\n", seed, error.what());
    return;
  }
  if (!run.outcome.complete()) return;
  const auto at = [&](const std::string& name) {
    return std::size_t(std::ranges::find(fine.names, name) - fine.names.begin());
  };
  for (std::size_t c = 0; c < run.columns.size(); ++c) {
    const auto& name = run.column_names[c];
    const std::size_t k = at(name);
    if (k == fine.names.size()) continue;
    for (std::size_t i = 0; i < run.time.size(); ++i)
      compare(count, seed, fmt::format("{} at {} s", name, run.time[i]), run.columns[c][i], run.column_error[c],
              fine.samples[i][k], coarse.samples[i][k]);
    for (const bool high : {true, false}) {
      const auto metric = name + (high ? "_max" : "_min");
      compare(count, seed, metric, run.metrics.at(metric), run.metric_error.at(metric),
              (high ? fine.high : fine.low)[k], (high ? coarse.high : coarse.low)[k]);
    }
  }
  const auto list = [](const auto& events) {
    std::vector<std::string> all;
    for (const auto& event : events)
      all.push_back(fmt::format("{} {} {:.6f}", event.kind, std::max(1, event.contact), event.time));
    return fmt::format("{}", fmt::join(all, ", "));
  };
  // Creep that reverses by less than the tolerance need not show.
  for (auto* motion : {&fine, &coarse}) {
    auto shown = *motion;
    for (std::size_t i = 0; i < shown.events.size(); ++i) {
      const auto next = std::ranges::find(shown.events.begin() + long(i) + 1, shown.events.end(),
                                          shown.events[i].contact, &CvodeEvent::contact);
      if (next != shown.events.end() && next->kind == "reversal" && next->fastest > 0 && next->fastest < tolerance)
        shown.events.erase(next), shown.events.erase(shown.events.begin() + long(i)), --i;
    }
    if (shown.events.size() == run.events.size()) *motion = shown;
  }
  const auto same = [](const auto& a, const auto& b) {
    return a.kind == b.kind && std::max(1, a.contact) == std::max(1, b.contact);
  };
  if (!std::ranges::equal(run.events, fine.events, same) || !std::ranges::equal(coarse.events, fine.events, same)) {
    ++count.other_order;
    count.faults += fmt::format("  {}: events\n    {}\n    {}\n    {}\n", seed, list(run.events), list(fine.events),
                                list(coarse.events));
    return;
  }
  for (std::size_t i = 0; i < run.events.size(); ++i) {
    ++count.events;
    compare(count, seed, fmt::format("event {}", i), run.events[i].time, run.events[i].error, fine.events[i].time,
            coarse.events[i].time);
  }
  for (const auto& [name, work] : fine.works) {
    const auto metric = name == "stick_time_1" && drawn.contacts.size() == 1 ? "stick_time" : name;
    const double size = name == "friction_work" ? std::max(1.0, std::abs(work)) : drawn.duration;
    compare(count, seed, metric, run.metrics.at(metric), tolerance * size, work, coarse.works.at(name));
  }
  const auto& slips = run.slips;
  std::size_t next = 0;
  for (std::size_t i = 0; i < slips.onset.size(); ++i) {
    const int contact = slips.contact.empty() ? 1 : int(slips.contact[i]);
    if (!drawn.contacts[std::size_t(contact - 1)].set_valued()) continue;
    std::vector<CvodeSlip> of, of_coarse;
    for (const auto& slip : fine.slips)
      if (slip.contact == contact) of.push_back(slip);
    for (const auto& slip : coarse.slips)
      if (slip.contact == contact) of_coarse.push_back(slip);
    if (i == 0 || slips.contact.empty() || slips.contact[i] != slips.contact[i - 1])
      next = slips.contact.empty() ? i : 0;
    const std::size_t k = next++;
    if (k >= of.size() || k >= of_coarse.size()) {
      ++count.other_order;
      count.faults += fmt::format("  {}: {} slips of contact {}\n", seed, of.size(), contact);
      break;
    }
    const auto& [c0, onset, duration, slip, peak] = of[k];
    const double forward = std::copysign(1.0, drawn.contacts[std::size_t(contact - 1)].speed.mean);
    const auto& [c1, onset_c, duration_c, slip_c, peak_c] = of_coarse[k];
    compare(count, seed, "onset", slips.onset[i], slips.error.onset, onset, onset_c);
    compare(count, seed, "duration", slips.duration[i], slips.error.duration, duration, duration_c);
    compare(count, seed, "slip", slips.slip[i], slips.error.slip, slip, slip_c);
    compare(count, seed, "peak_slip_rate", slips.peak_slip_rate[i], slips.error.peak_slip_rate, forward * peak,
            forward * peak_c);
  }
}

/// The errors that runs state cover all but a hundredth of the numbers, and no more than a hundredth of runs end short
/// or count other events.
void judge_all(unsigned from, unsigned to) {
  Count count;
  for (unsigned seed = from; seed < to; ++seed) judge(seed, count);
  UNSCOPED_INFO(count.faults);
  WARN(
      fmt::format("{} structures: {} end short, {} undecided, {} with other events; of {} numbers {} outside their "
                  "errors, {} not judged; {} events",
                  count.structures, count.failures, count.undecided, count.other_order, count.numbers, count.outside,
                  count.unjudged, count.events));
  CHECK(100 * count.outside <= count.numbers);
  CHECK(100 * count.failures <= count.structures);
  CHECK(100 * count.undecided <= count.structures);
  CHECK(50 * count.other_order <= count.structures);
  CHECK(count.unjudged < count.numbers / 100);
  CHECK(count.events > 4 * count.structures);
}

/// Of structures whose drive has a period nearly all come to a cycle or to rest, each known to the tolerance.
void look_for_cycles(unsigned from, unsigned to, int most_without) {
  int cycles = 0, rest = 0, without = 0;
  std::string faults;
  for (unsigned seed = from; seed < to; ++seed) {
    const auto drawn = draw_periodic_structure(seed);
    if (drawn.constant() && std::ranges::all_of(drawn.contacts, [](const auto& c) { return c.speed.mean == 0; }))
      continue;  // nothing drives it
    const Folder folder;
    const auto path = folder.path / "structure.toml";
    std::ofstream(path) << drawn.scene();
    const auto scene = scene_of(path, {}, "run");
    const auto cycle = analysis::cycles::find_cycle(
        *scene.structure, {.tolerance = 1e-7, .max_cycles = 4000, .multipliers = false, .most_steps = 400'000});
    const auto ending = cycle.outcome.ending;
    INFO(seed << ": " << cycle.outcome.detail);
    CHECK((cycle.outcome.complete() || ending == Ending::none_exists || ending == Ending::budget_spent));
    ++(cycle.outcome.complete() ? cycles : ending == Ending::none_exists ? rest : without);
    if (ending == Ending::budget_spent) faults += fmt::format("  {}: {}\n", seed, cycle.outcome.detail);
  }
  UNSCOPED_INFO(faults);
  WARN(fmt::format("{} cycles, {} at rest or in steady sliding, {} without a period", cycles, rest, without));
  CHECK(without <= most_without);
  CHECK(2 * cycles > cycles + rest + without);
}

}  // namespace

TEST_CASE("motions of random structures are those of other equations under CVODE", "[long][structures-by-cvode]") {
  judge_all(1, 9);
}

TEST_CASE("motions of five hundred random structures are those of other equations under CVODE",
          "[.][long][structures-by-cvode]") {
  judge_all(1, 501);
}

TEST_CASE("random structures under a drive with a period come to cycles or to rest", "[long][structures-by-cvode]") {
  look_for_cycles(4, 9, 0);
}

TEST_CASE("nearly all of a hundred random structures under a drive with a period come to cycles or to rest",
          "[.][long][structures-by-cvode]") {
  look_for_cycles(1, 101, 12);
}
