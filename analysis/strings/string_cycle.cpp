/// The last periods of a bowed string, slip by slip.
#include "analysis/strings/string_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rosin::analysis::strings {

namespace {

/// What the slips of the last periods say.
struct LastPeriods {
  StringPeriod period;      ///< errors: the largest difference of a period from their mean
  double difference = NAN;  ///< of the length of a period, relative
};

/// \param slips_in_period  one or two
std::optional<LastPeriods> last_periods(const BowedStringModel& model, const Bowing& bowing,
                                        std::size_t slips_in_period, int periods) {
  auto slips = bowing.transient.slips;
  if (!slips.empty() && slips.back().off < 0) slips.pop_back();  // the last may not have ended
  const auto wanted = slips_in_period * std::size_t(periods);
  if (slips.size() < wanted + 1) return std::nullopt;
  slips.erase(slips.begin(), slips.end() - std::ptrdiff_t(wanted) - 1);
  const double step = model.string.step();
  std::vector<double> length, stick, distance;
  for (std::size_t k = 0; k + slips_in_period < slips.size(); k += slips_in_period) {
    double slipping = 0, far = 0;
    for (std::size_t m = k; m < k + slips_in_period; ++m)
      slipping += double(slips[m].off - slips[m].on), far += std::abs(slips[m].distance);
    const double samples = double(slips[k + slips_in_period].on - slips[k].on);
    length.push_back(samples * step), stick.push_back(1 - slipping / samples), distance.push_back(far);
  }
  const auto of = [](const std::vector<double>& values) {
    StringPeriod::Measure measure{0, 0};
    for (const double value : values) measure.value += value / double(values.size());
    for (const double value : values) measure.error = std::max(measure.error, std::abs(value - measure.value));
    return measure;
  };
  LastPeriods last;
  last.period = {of(length), {double(slips_in_period), 0}, of(stick), of(distance), {bowing.bridge_force, 0}};
  last.difference = std::max(0.0, last.period.period.error - step) / last.period.period.value;  // onsets are samples
  return last;
}

}  // namespace

const std::array<StringPeriodName, 5>& string_period_names() {
  static constexpr std::array<StringPeriodName, 5> names = {
      {{"period", "s", "period of the motion", &StringPeriod::period},
       {"slips_per_period", "1", "slips in a period", &StringPeriod::slips},
       {"stick_fraction", "1", "part of the period in which the string sticks to the bow",
        &StringPeriod::stick_fraction},
       {"slip_distance", "m", "distance of bow and string past each other in a period", &StringPeriod::slip_distance},
       {"bridge_force", "N", "force on the bridge, peak to peak", &StringPeriod::bridge_force}}};
  return names;
}

StringCycle cycle_of(const BowedStringModel& model, const Bowing& bowing, const Bowing& finer_bowing,
                     const TransientOptions& options) {
  StringCycle cycle{bowing.outcome, bowing.transient.regime, {}, bowing.samples + finer_bowing.samples};
  if (!cycle.outcome.complete()) return cycle;
  const auto& regime = string_regime_names()[std::size_t(cycle.regime)];
  const double periods = double(bowing.samples) * model.string.step() * model.string.frequency;
  const bool helmholtz = cycle.regime == StringRegime::helmholtz;
  if (!helmholtz && cycle.regime != StringRegime::double_slip) {
    const bool at_rest = cycle.regime == StringRegime::sliding || cycle.regime == StringRegime::none;
    cycle.outcome = {
        Ending::none_exists,
        fmt::format("{}: {} after {:.0f} periods",
                    at_rest ? "the string comes to no oscillation" : "no two periods are alike", regime, periods)};
    return cycle;
  }
  const auto last = last_periods(model, bowing, helmholtz ? 1 : 2, options.periods);
  constexpr double alike = 0.01;
  if (!last || last->difference > alike) {
    cycle.outcome = {Ending::none_exists,
                     fmt::format("no two periods are alike: {} after {:.0f} periods, whose lengths differ by {}",
                                 regime, periods, last ? fmt::format("{:.1g}", last->difference) : "more than a slip")};
    return cycle;
  }
  cycle.period = last->period;
  const auto again = finer_bowing.transient.regime == cycle.regime
                         ? last_periods(finer(model), finer_bowing, helmholtz ? 1 : 2, options.periods)
                         : std::nullopt;
  for (const auto& [name, unit, meaning, member] : string_period_names()) {
    auto& measure = cycle.period.*member;
    // Of an error that falls with the step half is left at half the step.
    measure.error += again ? 2 * std::abs((again->period.*member).value - measure.value) : infinity;
  }
  if (!again)
    cycle.outcome = {Ending::tolerance_not_met,
                     fmt::format("at twice the sample rate the string comes to another motion, {}",
                                 string_regime_names()[std::size_t(finer_bowing.transient.regime)])};
  return cycle;
}

void require_steady_bow(const BowedStringModel& model) {
  if (!model.speed.constant() || !model.load.constant())
    throw InputError(
        "a bow whose speed or load changes has no motion that lasts: give drive.speed (m/s) and drive.normal_load (N) "
        "as numbers");
  if (model.speed.value(0) == 0) throw InputError("drive.speed is 0 m/s: a bow at rest moves no string");
}

BowingOptions until_periodic(const BowedStringModel& model, double periods, const TransientOptions& transient) {
  require_steady_bow(model);
  return {.duration = periods * model.string.period(), .transient = transient};
}

std::vector<StringCycle> string_cycles(std::span<const BowedStringModel> models, double periods,
                                       const TransientOptions& transient, int threads) {
  std::vector<StringCycle> cycles(models.size());
  if (models.empty()) return cycles;
  // Strings of one frequency sound equally long.
  std::vector<double> known;
  for (const auto& model : models)
    if (std::ranges::find(known, model.string.frequency) == known.end()) known.push_back(model.string.frequency);
  for (const double frequency : known) {
    std::vector<BowedStringModel> these, fine;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < models.size(); ++i)
      if (models[i].string.frequency == frequency)
        these.push_back(models[i]), fine.push_back(finer(models[i])), places.push_back(i);
    const auto options = until_periodic(these.front(), periods, transient);
    for (const auto& model : these) require_steady_bow(model);
    const auto bowings = bow(these, options, threads), again = bow(fine, options, threads);
    for (std::size_t k = 0; k < these.size(); ++k)
      cycles[places[k]] = cycle_of(these[k], bowings[k], again[k], transient);
  }
  return cycles;
}

std::vector<std::vector<StringCycle>> string_cycles_along(const BowedStringModel& model,
                                                          Gesture BowedStringModel::*moved,
                                                          std::span<const std::vector<double>> values, double periods,
                                                          const TransientOptions& transient) {
  const auto options = until_periodic(model, periods, transient);
  std::vector<BowedStringModel> models, fine;
  for (const auto& way : values) {
    Signal::Table table{{0}, {way.front()}};
    for (std::size_t k = 1; k < way.size(); ++k)
      for (const auto& [part, value] : {std::pair{0.0, way[k - 1]}, {0.5, way[k]}})
        table.time.push_back((double(k) + part) * options.duration), table.value.push_back(value);
    models.push_back(model);
    (models.back().*moved).signal = Signal(std::move(table));
    fine.push_back(finer(models.back()));
  }
  const int stages = int(values.front().size());
  const auto bowings = bow_in_stages(models, options, stages), again = bow_in_stages(fine, options, stages);
  std::vector<std::vector<StringCycle>> cycles(values.size());
  for (std::size_t way = 0; way < values.size(); ++way)
    for (std::size_t k = 0; k < values[way].size(); ++k)
      cycles[way].push_back(cycle_of(model, bowings[way][k], again[way][k], transient));
  return cycles;
}

}  // namespace rosin::analysis::strings
