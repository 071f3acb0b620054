/// Signals as constants, steps, ramps, harmonics, noise, or records in files.
#include "app/scene/signal.hpp"

#include <array>
#include <utility>

namespace rosin::app::scene {

namespace fs = std::filesystem;

Signal::Table read_table_file(const toml::node& node, const std::string& path, const std::string& unit,
                              const fs::path& folder, bool units_needed) {
  RecordSource source;
  RecordColumn time{"", "", "s", 1}, value{"", "", unit, 2};
  bool chosen = false;
  if (node.is_table()) {
    Table table(node, path);
    table.expect({"file", "names_line", "decimal", "time", "value"});
    source = read_file(table, folder);
    if (const auto* column = table.find("time")) time = read_column(*column, table.path("time"), "s");
    if (const auto* column = table.find("value")) value = read_column(*column, table.path("value"), unit);
    chosen = table.find("time") && table.find("value");
    table.finish();
  } else {
    const fs::path file = text(node, path);
    source.file = file.is_absolute() ? file : folder / file;
  }
  time.unit_needed = value.unit_needed = units_needed;
  source.columns = {std::move(time), std::move(value)};
  source.least = 1;
  if (!chosen) source.width = 2;
  return located(node.source(), [&] {
    Signal::Table record;
    read_record(source, [&](double, std::span<const std::span<const double>> block) {
      record.time.insert(record.time.end(), block[0].begin(), block[0].end());
      record.value.insert(record.value.end(), block[1].begin(), block[1].end());
      if (record.time.size() > std::size_t(most_points))
        throw InputError(fmt::format("{}: has more than {} rows", source.file.string(), most_points));
    });
    return record;
  });
}

Signal read_signal(const toml::node& node, const Quantity& quantity, const fs::path& folder) {
  if (!node.is_table()) return number(node, quantity);
  Table table(node, quantity.name);
  const Quantity unbounded{quantity.name, quantity.unit, {-1e300, 1e300}, quantity.meaning};
  const Quantity time{quantity.name, "s", {0, 1e300}, "time"};
  const auto *steps = table.find("steps"), *ramp = table.find("ramp"), *file = table.find("table");
  const auto *harmonics = table.find("harmonics"), *mean = table.find("mean");
  const auto* noise = table.find("noise");
  table.finish();
  const auto forms =
      std::ranges::count_if(std::array{steps, ramp, file, harmonics, noise}, [](auto* form) { return form; });
  if (forms != 1 || (mean && !harmonics && !noise))
    fail(node.source(), "{} needs one of steps, ramp, table, or harmonics or noise with a mean", quantity.name);

  const Signal signal = located(node.source(), [&]() -> Signal {
    if (steps) {
      Signal::Steps form;
      for (const auto& element : list(*steps, quantity.name + ".steps", "[time, value]")) {
        const auto* pair = element.as_array();
        if (!pair || pair->size() != 2) wrong_kind(element, quantity.name + ".steps", "[time, value]");
        form.steps.push_back({number(*pair->get(0), time), number(*pair->get(1), quantity)});
      }
      return Signal(std::move(form));
    }
    if (ramp) {
      Table keys(*ramp, quantity.name + ".ramp");
      Signal::Ramp form{0, 0};
      auto rate = unbounded;
      rate.unit = quantity.unit + "/s";
      keys.required("rate", "change per second, " + rate.unit);
      keys.read("from", form.from, quantity);
      keys.read("rate", form.rate, rate);
      keys.finish();
      return Signal(form);
    }
    if (file)
      return located(file->source(),
                     [&] { return Signal(read_table_file(*file, quantity.name + ".table", quantity.unit, folder)); });
    if (noise) {
      Table keys(*noise, quantity.name + ".noise");
      keys.expect({"rms", "band", "seed"});
      Signal::Noise form{0, {0, 0, 0, 1}};
      if (mean) form.mean = number(*mean, unbounded);
      keys.required("rms", quantity.unit);
      keys.read("rms", form.band.rms, {"", quantity.unit, {0, 1e300}, "root mean square"});
      const auto band = numbers(keys.required("band", "[lowest, highest] frequency, Hz"),
                                {keys.path("band"), "Hz", {0, 1e12}, "end of the band"});
      if (band.size() != 2) fail(noise->source(), "{} needs two frequencies", keys.path("band"));
      form.band.low = band[0], form.band.high = band[1];
      int seed = 1;
      keys.read("seed", seed, 0, largest_seed, "of the random numbers");
      form.band.seed = std::uint64_t(seed);
      keys.finish();
      return Signal(form);
    }
    Signal::Harmonics form{0, {}};
    if (mean) form.mean = number(*mean, unbounded);
    for (const auto& element : list(*harmonics, quantity.name + ".harmonics", "tables", most_names)) {
      Table keys(element, quantity.name + ".harmonics");
      Signal::Harmonic term{0, 0, 0};
      keys.required("amplitude", quantity.unit);
      keys.required("angular_frequency", "rad/s");
      keys.read("amplitude", term.amplitude, unbounded);
      keys.read("angular_frequency", term.angular_frequency, {"", "rad/s", {0, 1e15}, "angular frequency"});
      keys.read("phase", term.phase, {"", "rad", {-1e6, 1e6}, "phase of the cosine at t = 0"});
      keys.finish();
      form.terms.push_back(term);
    }
    return Signal(std::move(form));
  });
  if (harmonics && !signal.within(quantity.range) && quantity.range.contains(signal.level()))
    fail(node.source(), "{} leaves {} … {} ({}, {}): about a mean of {} amplitudes may add up to {} at most",
         quantity.name, quantity.range.low, quantity.range.high, quantity.meaning, quantity.unit, signal.level(),
         std::min(signal.level() - quantity.range.low, quantity.range.high - signal.level()));
  if (!signal.within(quantity.range))
    fail(node.source(), "{} leaves {} ({}, {})", quantity.name, text(quantity.range), quantity.meaning, quantity.unit);
  return signal;
}

}  // namespace rosin::app::scene
