/// Signals as constants, steps, ramps, harmonics, noise, or records in files.
#include "app/scene/signal.hpp"

#include <array>
#include <charconv>
#include <sstream>
#include <utility>

#include "app/scene/header.hpp"
#include "core/files.hpp"

namespace rosin::app::scene {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_record = 200'000'000;  // bytes

}  // namespace

Signal::Table read_signal(const fs::path& path, const std::string& unit) {
  Signal::Table record;
  std::istringstream lines(read_whole(path, largest_record));
  std::string line;
  double time_factor = 1, value_factor = 1;
  bool begun = false;
  const auto take_units = [&](const std::string& header, int number) {
    const auto cells = read_header(header).cells;
    if (cells.size() != 2) return false;
    try {
      time_factor = to_si_factor(cells[0], "", "s"), value_factor = to_si_factor(cells[1], "", unit);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}:{}: {}", path.string(), number, error.what()));
    }
    return true;
  };
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto hash = line.find('#');
    if (hash != std::string::npos) {
      const auto comment = line.substr(hash + 1);
      if (hash == 0 && !begun && names_units(comment)) take_units(comment, number);
      line.resize(hash);
    }
    const std::string written = line;
    std::ranges::replace_if(
        line, [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
    if (line.find_first_not_of(' ') == std::string::npos) continue;
    std::vector<double> values;
    const char *at = line.data(), *end = at + line.size();
    while (at != end) {
      if (*at == ' ') {
        ++at;
        continue;
      }
      double value = 0;
      const auto [next, problem] = std::from_chars(at, end, value);
      if (problem != std::errc{} || (next != end && *next != ' ')) break;
      values.push_back(value);
      at = next;
    }
    if (at != end && !std::exchange(begun, true)) {
      if (!take_units(written, number))
        throw InputError(fmt::format(
            "{}:{}: the header '{}' does not name two columns, such as \"time (s), value ({})\"; correct it, or "
            "delete the line",
            path.string(), number, written, unit));
      continue;
    }
    if (at != end && record.time.empty() && holds_units(written))
      throw InputError(fmt::format(
          "{}:{}: '{}' holds units in a line of their own; write them into the header, \"time (…), value (…)\", and "
          "delete this line",
          path.string(), number, written));
    if (at != end || values.size() != 2)
      throw InputError(fmt::format("{}:{}: two numbers are needed, a time in s and a value", path.string(), number));
    begun = true;
    record.time.push_back(values[0] * time_factor);
    record.value.push_back(values[1] * value_factor);
  }
  return record;
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
    if (file) {
      const fs::path record = text(*file, quantity.name + ".table");
      return Signal(located(
          file->source(), [&] { return read_signal(record.is_absolute() ? record : folder / record, quantity.unit); }));
    }
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
