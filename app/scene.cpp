/// Reading scenes: every value is taken together with its place in the file, so that each refusal can name it.
#include "app/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "app/fit_scene.hpp"
#include "app/frf_scene.hpp"
#include "app/header.hpp"
#include "app/scene_table.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "laws/heating.hpp"

namespace rosin::app {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_scene = 10'000'000, largest_record = 200'000'000;  // bytes

constexpr int deepest = 100;  // levels: parsing and every walk over a scene goes as deep into the stack

/// Brackets within brackets and keys with dots, counted without parsing them. \throws InputError with the line.
void check_depth(std::string_view text, std::string_view origin) {
  std::vector<int> dots = {0};  // of the key at hand, and of those that it lies within
  int line = 1, levels = 0;
  const auto skip_string = [&](std::size_t begin) {  // returns the index of its last character
    const char quote = text[begin];
    const bool multi = text.substr(begin, 3) == std::string(3, quote);
    const auto end = multi ? text.substr(begin, 3) : text.substr(begin, 1);
    std::size_t i = begin + end.size();
    for (; i < text.size() && text.substr(i, end.size()) != end; ++i) {
      if (text[i] == '\n' && !multi) return i - 1;
      line += text[i] == '\n';
      if (quote == '"' && text[i] == '\\') ++i;
    }
    return i + end.size() - 1;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = skip_string(i);
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '[' || c == '{') {
      dots.push_back(0), ++levels;
    } else if ((c == ']' || c == '}') && dots.size() > 1) {
      levels -= 1 + dots.back(), dots.pop_back();
    } else if (c == '.') {
      ++dots.back(), ++levels;
    } else if (c == ',' || (c == '\n' && dots.size() == 1)) {
      levels -= std::exchange(dots.back(), 0);
    }
    line += c == '\n';
    if (levels > deepest)
      throw InputError(fmt::format("{}:{}: tables or lists lie more than {} levels deep", origin, line, deepest));
  }
}

// ---------------------------------------------------------------- overrides

/// Moves `node` to `key`; unlike a copy, a move keeps the place that the value came from.
void place_at(toml::table& table, std::string_view key, toml::node& node) {
  node.visit([&](auto& value) { table.insert_or_assign(key, std::move(value)); });
}

/// Parses "path=value" and puts the value into the scene.
void apply_override(toml::table& scene, const std::string& given) {
  constexpr std::size_t shown = 200;
  const std::string origin = std::string(override_mark) + (given.size() > shown ? given.substr(0, shown) + "…" : given);
  const auto equals = given.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("{}: must read path=value, such as --set drive.speed=1e-5", origin));
  const std::string path = given.substr(0, equals), value = given.substr(equals + 1);
  check_depth(path + " = " + value, origin);

  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value, origin);
    if (parsed.size() != 1) throw InputError(fmt::format("{}: holds more than one value", origin));
  } catch (const toml::parse_error& error) {
    if (value.empty() || value.find_first_of("[]{}\"'\n") != std::string::npos)
      throw InputError(fmt::format("{}: the value is not valid TOML: {}", origin, error.description()));
    parsed = toml::parse("value = ''", origin);  // a bare word: a text that keeps the override as its place
    parsed["value"].as_string()->get() = value;
  }

  toml::table* table = &scene;
  std::size_t begin = 0;
  for (std::size_t dot; (dot = path.find('.', begin)) != std::string::npos; begin = dot + 1) {
    const auto key = path.substr(begin, dot - begin);
    if (!table->contains(key)) {
      auto empty = toml::parse("value = {}", origin);
      place_at(*table, key, *empty.get("value"));
      table->get(key)->as_table()->is_inline(false);
    }
    auto* next = table->get_as<toml::table>(key);
    if (!next)
      throw InputError(fmt::format("{}: {} is {}, not a table", origin, path.substr(0, dot), kind(*table->get(key))));
    table = next;
  }
  if (begin == path.size()) throw InputError(fmt::format("{}: the path ends with a dot", origin));
  place_at(*table, path.substr(begin), *parsed.get("value"));
}

// ---------------------------------------------------------------- signals

/// Two numbers a line, separated by a comma or blanks: a time in s and a value in `unit`, unless the first line is a
/// header with other units. \throws InputError with the line.
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

// ---------------------------------------------------------------- tables of a scene

constexpr Range any{-1e15, 1e15};

Quantity mechanical(std::string_view path) {
  for (const auto& quantity : oscillators::mechanical_parameters())
    if (quantity.name == path) return quantity;
  throw std::logic_error("no mechanical parameter " + std::string(path));
}

// ---------------------------------------------------------------- laws from text

/// Calls `f`; an error in an expression gets the place of its token in the file, as far as that is known.
template <class F>
auto located_in_formula(const toml::node& formula, F f) {
  try {
    return f();
  } catch (const laws::ExpressionError& error) {
    const toml::node* node = &formula;  // or the innermost of the path that is there
    std::istringstream path(error.expression);
    for (std::string key; std::getline(path, key, '.') && node->is_table();)
      if (const auto* inner = node->as_table()->get(key)) node = inner;
    const auto* expression = node->as_string();
    if (!expression || error.offset == error.whole) fail(node->source(), "{}", error.what());
    auto source = node->source();
    const auto length = [](std::string_view text) {  // in characters, as columns are counted
      return std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; });
    };
    const auto before = length(std::string_view(expression->get()).substr(0, error.offset));
    const bool as_written = source.begin.line == source.end.line &&
                            source.end.column - source.begin.column == length(expression->get()) + 2;
    if (!as_written || place(source).starts_with(override_mark))
      fail(source, "{} (character {} of the text)", error.what(), before + 1);
    source.begin.column += toml::source_index(before + 1);
    fail(source, "{}", error.what());
  }
}

/// What a law from text says of a parameter or a state.
Quantity read_quantity(Table& table, const std::string& name, Range range) {
  Quantity quantity{name, "1", range, name};
  if (const auto* unit = table.find("unit")) quantity.unit = text(*unit, table.path("unit"));
  if (const auto* meaning = table.find("meaning")) quantity.meaning = text(*meaning, table.path("meaning"));
  const Quantity bound{"", quantity.unit, range, "bound of " + name};
  table.read("minimum", quantity.range.low, bound);
  table.read("maximum", quantity.range.high, bound);
  if (!(quantity.range.low <= quantity.range.high))
    fail(table.source(), "{} is above {}", table.path("minimum"), table.path("maximum"));
  return quantity;
}

std::shared_ptr<const FrictionLaw> read_formula(const toml::node& node) {
  Table table(node, "law.formula");
  table.expect({"title", "parameters", "states", "define", "friction", "rate", "steady", "slip_rate", "static_limit",
                "rest", "after_stop", "kink", "size"});
  laws::FormulaDescription law;
  if (const auto* title = table.find("title")) law.title = text(*title, table.path("title"));

  constexpr Range finite{-1e300, 1e300}, positive{1e-300, 1e300};
  const auto named = [&](std::string_view key) {
    const auto* inner = table.find(key);
    return inner ? Table(*inner, table.path(key)).named_tables() : std::vector<std::pair<std::string, Table>>();
  };
  const auto refuse_reserved = [&](const Table& entry, const std::string& name, std::vector<std::string> reserved) {
    if (std::ranges::find(reserved, name) != reserved.end())
      fail(entry.source(), "law.formula: '{}' has another meaning in scenes; take another name", name);
  };
  for (auto& [name, entry] : named("parameters")) {
    refuse_reserved(entry, name,
                    {"type", "preset", "lambda", "formula", "contact_stiffness", "load_memory", "heating"});
    entry.expect({"default", "unit", "minimum", "maximum", "meaning"});
    laws::FormulaDescription::Parameter parameter{read_quantity(entry, name, finite), 0};
    auto quantity = parameter.quantity;
    quantity.name = entry.path("default");
    parameter.value = number(entry.required("default", "its value unless [law] sets another"), quantity);
    entry.finish();
    law.parameters.push_back(std::move(parameter));
  }
  for (auto& [name, entry] : named("states")) {
    refuse_reserved(entry, name, {"displacement", "velocity", "slip_rate", "state", "time", "friction_force"});
    entry.expect({"unit", "scale", "minimum", "maximum", "meaning"});
    const auto* scale = entry.find("scale");
    const bool logarithmic = scale && choice(*scale, entry.path("scale"), {"log", "linear"}) == "log";
    auto state = read_quantity(entry, name, logarithmic ? positive : finite);
    state.scale = logarithmic ? Scale::log : Scale::linear;
    entry.finish();
    law.states.push_back(std::move(state));
  }
  const auto expression = [&](std::string_view key) {
    const auto* given = table.find(key);
    return given ? text(*given, table.path(key)) : std::string();
  };
  const auto of_states = [&](std::string_view key) {
    std::vector<std::string> expressions(law.states.size());
    auto given = table.table(key);
    for (std::size_t k = 0; given && k < law.states.size(); ++k)
      if (const auto* rate = given->find(law.states[k].name))
        expressions[k] = text(*rate, given->path(law.states[k].name));
    if (given) given->finish();
    return expressions;
  };
  if (const auto* define = table.find("define")) {
    Table definitions(*define, table.path("define"));
    for (const auto& [key, value] : *define->as_table())
      law.define.emplace_back(key.str(), text(value, definitions.path(key.str())));
  }
  law.friction = text(table.required("friction", "coefficient of friction, a formula"), table.path("friction"));
  law.rate = of_states("rate");
  law.steady = of_states("steady");
  law.rest = of_states("rest");
  law.after_stop = of_states("after_stop");
  law.size = of_states("size");
  law.slip_rate = expression("slip_rate");
  law.static_limit = expression("static_limit");
  law.kink = expression("kink");
  table.finish();
  return located_in_formula(node, [&] { return laws::make_formula(law); });
}

void read_law(Table law, oscillators::Model& model) {
  const auto& type =
      law.required("type", "name of a friction law; 'rosin laws' lists them, 'formula' is one from text");
  const auto type_name = text(type, law.path("type"));
  const auto* formula = type_name == "formula" ? &law.required("formula", "the law as text") : nullptr;
  auto prototype = formula ? read_formula(*formula) : located(type.source(), [&] { return laws::find_law(type_name); });
  for (const auto& other : laws::catalogue()) {
    const auto& option = other->card().option;
    const auto* word = option.of == type_name ? law.find(option.key) : nullptr;
    if (word &&
        choice(*word, law.path(option.key), {std::string(option.usual), std::string(option.word)}) == option.word)
      prototype = other;
  }
  if (const auto* name = law.find("preset"))
    prototype = located(name->source(), [&] { return laws::preset(*prototype, text(*name, law.path("preset"))); });
  auto values = prototype->values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    auto quantity = prototype->parameters()[i];
    const auto* node = law.find(quantity.name);
    if (!node) continue;
    quantity.name = law.path(quantity.name);
    if (quantity.is_list)
      values[i] = numbers(*node, quantity);
    else
      values[i] = number(*node, quantity);
  }
  model.law = located(law.source(), [&] { return prototype->with(std::move(values)); });
  if (formula) located_in_formula(*formula, [&] { laws::check_formula(*model.law); });

  if (auto heat = law.table("heating")) {
    laws::Heating heating;
    double* const values[] = {&heating.resistance, &heating.time, &heating.softening};
    for (std::size_t i = 0; i < laws::heating_parameters().size(); ++i) {
      auto quantity = laws::heating_parameters()[i];
      const auto& node = heat->required(quantity.name, quantity.meaning + ", " + quantity.unit);
      quantity.name = heat->path(quantity.name);
      *values[i] = number(node, quantity);
    }
    if (const auto* word = heat->find("conduction"))
      heating.kernel = choice(*word, heat->path("conduction"), {"lumped", "disc"}) == "disc"
                           ? std::span<const laws::HeatMode>(laws::disc)
                           : laws::lump;
    model.law = located(heat->source(), [&] { return laws::heated(model.law, heating); });
    heat->finish();
  }
  if (const auto* node = law.find("lambda")) {
    if (!model.law->has_states())
      fail(node->source(), "law.lambda has no meaning for law '{}', which has no states; leave it out",
           model.law->card().name);
    model.lambda = number(*node, mechanical("law.lambda"));
  }
  if (auto spring = law.table("contact_stiffness")) {
    spring->read("tangential", model.contact_stiffness.tangential, mechanical("law.contact_stiffness.tangential"));
    spring->read("per_load", model.contact_stiffness.per_load, mechanical("law.contact_stiffness.per_load"));
    spring->read("damping", model.contact_stiffness.damping, mechanical("law.contact_stiffness.damping"));
    spring->read("damping_per_load", model.contact_stiffness.damping_per_load,
                 mechanical("law.contact_stiffness.damping_per_load"));
    spring->finish();
  }
  if (auto memory = law.table("load_memory")) {
    memory->read("alpha", model.load_memory, mechanical("law.load_memory.alpha"));
    memory->finish();
  }
  law.finish();
}

void read_oscillator(Table table, oscillators::Slider& slider, bool complete) {
  table.expect({"type", "mass", "stiffness", "damping"});
  if (const auto* type = table.find("type")) {
    const auto name =
        choice(*type, table.path("type"), {"slider", "plane-slider", "two-mass-belt", "mode-coupling", "modal"});
    if (name == "plane-slider") fail(type->source(), "oscillator.type = 'plane-slider' serves 'run' only");
    if (name != "slider")
      fail(type->source(), "oscillator.type = '{}' is not available in this version; use 'slider'", name);
  }
  if (complete) {
    table.required("mass", "kg; 0: quasi-static");
    table.required("stiffness", "N/m");
  }
  table.read("mass", slider.mass, mechanical("oscillator.mass"));
  table.read("stiffness", slider.stiffness, mechanical("oscillator.stiffness"));
  table.read("damping", slider.damping, mechanical("oscillator.damping"));
  table.finish();
}

void read_drive(Table table, oscillators::Drive& drive, const fs::path& folder, bool complete) {
  table.expect({"speed", "normal_load", "force"});
  if (complete) {
    table.required("speed", "m/s");
    table.required("normal_load", "N");
  }
  for (const auto& [key, signal] : {std::pair{"speed", &drive.speed}, std::pair{"normal_load", &drive.normal_load},
                                    std::pair{"force", &drive.force}})
    if (const auto* node = table.find(key)) *signal = read_signal(*node, mechanical(table.path(key)), folder);
  table.finish();
}

analysis::Start read_start(const toml::node& node, const std::string& path, const FrictionLaw& law) {
  using Kind = analysis::Start::Kind;
  if (node.is_string())
    return {choice(node, path, {"steady", "rest"}) == "rest" ? Kind::rest : Kind::steady, {}, {}, {}, {}};
  if (!node.is_table()) wrong_kind(node, path, "\"steady\", \"rest\" or a table");
  analysis::Start start{Kind::given, {}, {}, {}, {}};
  Table table(node, path);
  table.read("displacement", start.displacement, {"", "m", any, "displacement of the slider"});
  table.read("velocity", start.velocity, {"", "m/s", any, "velocity of the slider"});
  table.read("slip_rate", start.slip_rate, {"", "m/s", any, "drive speed minus velocity of the slider"});
  if (start.velocity && start.slip_rate) fail(node.source(), "{}: give velocity or slip_rate, not both", path);
  const auto read_states = [&](Table& from) {
    for (auto state : law.states()) {
      std::optional<double> value;
      from.read(state.name, value, state);
      if (value) start.states[state.name] = *value;
    }
  };
  if (const auto* state = table.find("state")) {
    if (law.states().empty()) fail(state->source(), "{}.state: law '{}' has no states", path, law.card().name);
    if (state->is_table()) {
      Table states(*state, path + ".state");
      read_states(states);
      states.finish();
    } else if (law.states().size() == 1) {
      auto quantity = law.states().front();
      const auto name = std::exchange(quantity.name, path + ".state");
      start.states[name] = number(*state, quantity);
    } else {
      wrong_kind(*state, path + ".state", fmt::format("a table with the {} states by name", law.states().size()));
    }
  }
  read_states(table);
  table.finish();
  return start;
}

/// Two numbers, or two of what `read` makes of the elements.
template <class Read>
auto both(const toml::node& node, const std::string& path, Read read) {
  const auto& pair = list(node, path, "two, along x and y");
  if (pair.size() != 2) fail(node.source(), "{} has {} entries, but 2 are needed, along x and y", path, pair.size());
  return std::array{read(*pair.get(0)), read(*pair.get(1))};
}
std::array<double, 2> both(Table& table, std::string_view key, Quantity quantity) {
  quantity.name = table.path(key);
  return both(table.required(key, quantity.meaning + ", along x and y"), quantity.name,
              [&](const toml::node& node) { return number(node, quantity); });
}

/// A slider in the plane: springs, dampers and forces along x and y, friction against the velocity vector.
analysis::PlaneModel read_plane(Table table, Table drive, const FrictionLaw& law, const toml::source_region& law_source,
                                const fs::path& folder) {
  const auto friction = law.linear();
  if (!friction || friction->slope != 0)
    fail(law_source, "oscillator.type = 'plane-slider' is for Coulomb friction; law '{}' is another", law.card().name);
  analysis::PlaneModel plane;
  auto& mass = plane.mass;
  table.expect({"type", "mass", "stiffness", "damping"});
  table.find("type");
  table.required("mass", "kg");
  table.read("mass", mass.mass, {"", "kg", {1e-12, 1e12}, "mass of the slider"});
  mass.stiffness = both(table, "stiffness", {"", "N/m", {1e-12, 1e15}, "stiffness of the springs"});
  mass.damping = both(table, "damping", {"", "N s/m", {0, 1e15}, "damping of the motion"});
  table.finish();
  drive.expect({"speed", "normal_load", "force"});
  if (drive.find("speed")) mass.surface_velocity = both(drive, "speed", mechanical("drive.speed"));
  mass.load = read_signal(drive.required("normal_load", "N"), mechanical("drive.normal_load"), folder);
  const auto quantity = mechanical("drive.force");
  mass.force = both(drive.required("force", "two signals, N"), quantity.name,
                    [&](const toml::node& node) { return read_signal(node, quantity, folder); });
  drive.finish();
  mass.dynamic_friction = friction->constant;
  mass.static_friction = law.static_limit(mass.load.level());
  return plane;
}

void read_plane_start(const toml::node& node, const std::string& path, analysis::PlaneModel& plane) {
  plane.velocity = plane.mass.surface_velocity;
  if (node.is_string()) {
    choice(node, path, {"rest"});
    return;
  }
  Table table(node, path);
  if (table.find("displacement"))
    plane.displacement = both(table, "displacement", {"", "m", any, "displacement of the slider"});
  if (table.find("velocity")) plane.velocity = both(table, "velocity", {"", "m/s", any, "velocity of the slider"});
  table.finish();
}

void read_run(Table table, analysis::RunOptions& run, const FrictionLaw& law, analysis::PlaneModel* plane,
              bool needed) {
  table.expect({"duration", "times", "samples", "start"});
  const Quantity time{table.path("times"), "s", {0, 1e15}, "time of a sample"};
  const auto* times = table.find("times");
  if (times) {
    run.times = numbers(*times, time);
    if (run.times.empty()) fail(times->source(), "run.times is empty");
    if (std::ranges::adjacent_find(run.times, std::greater_equal{}) != run.times.end())
      fail(times->source(), "run.times must ascend");
    run.duration = run.times.back();
  } else if (needed) {
    table.required("duration", "s");
  }
  table.read("duration", run.duration, {"", "s", {1e-15, 1e15}, "time that is computed"});
  if (times && run.times.back() > run.duration)
    fail(times->source(), "run.times ends at {} s, after run.duration = {} s", run.times.back(), run.duration);
  table.read("samples", run.samples, 1, most_points, "equal intervals of the record");
  if (const auto* start = table.find("start")) {
    if (plane)
      read_plane_start(*start, table.path("start"), *plane);
    else
      run.start = read_start(*start, table.path("start"), law);
  }
  table.finish();
}

void read_cycle(Table table, Scene& scene) {
  table.read("stick_threshold", scene.cycle.stick_threshold,
             {"", "1", {1e-6, 0.999}, "stick is |v| <= threshold times V"});
  if (const auto* start = table.find("start")) {
    scene.cycle.start = read_start(*start, table.path("start"), *scene.model.law);
    if (scene.model.law->set_valued())
      scene.notes.push_back("cycle.start has no effect under a set-valued law: stick forgets how the motion began");
  }
  table.finish();
}

analysis::Axis read_axis(Table table, const oscillators::Model& model) {
  table.expect({"parameter", "from", "to", "points", "scale", "extra"});
  const auto& parameter = table.required("parameter", "path, such as drive.normal_load");
  const auto path = text(parameter, table.path("parameter"));
  auto quantity = located(parameter.source(), [&] { return model.describe(path); });
  quantity.meaning = path + ", " + quantity.meaning;
  table.required("from", quantity.meaning);
  table.required("to", quantity.meaning);
  table.required("points", "number of values");
  double from = 0, to = 0;
  int points = 0;
  table.read("from", from, quantity);
  table.read("to", to, quantity);
  table.read("points", points, 2, most_points, "number of values");
  bool logarithmic = true;
  if (const auto* scale = table.find("scale"))
    logarithmic = choice(*scale, table.path("scale"), {"log", "linear"}) == "log";
  std::vector<double> extra;
  if (const auto* node = table.find("extra")) {
    quantity.name = table.path("extra");
    extra = numbers(*node, quantity);
  }
  table.finish();
  return located(table.source(), [&] { return analysis::make_axis(path, from, to, points, logarithmic, extra); });
}

void read_map(Table table, Scene& scene) {
  auto& map = scene.map;
  table.expect({"x", "y", "metrics", "stick_threshold"});
  const auto &x = table.required("x", "first axis"), &y = table.required("y", "second axis");
  map.x = read_axis(Table(x, table.path("x")), scene.model);
  map.y = read_axis(Table(y, table.path("y")), scene.model);
  if (map.x.parameter == map.y.parameter)
    fail(y.source(), "map.x and map.y are the same parameter, {}", map.y.parameter);
  if (map.x.values.size() > most_points / map.y.values.size())
    fail(table.source(), "map has {} x {} points, more than {}", map.x.values.size(), map.y.values.size(), most_points);
  map.metrics = {"stick_fraction", "loop_area_normalised"};
  if (const auto* metrics = table.find("metrics")) {
    map.metrics = texts(*metrics, table.path("metrics"));
    for (std::size_t i = 0; i < map.metrics.size(); ++i)
      located(metrics->as_array()->get(i)->source(), [&] { analysis::find_metric(map.metrics[i]); });
    for (auto name = map.metrics.begin(); name != map.metrics.end(); ++name)
      if (std::find(map.metrics.begin(), name, *name) != name)
        fail(metrics->source(), "map.metrics names '{}' twice", *name);
    if (map.metrics.empty()) fail(metrics->source(), "map.metrics is empty");
  }
  map.stick_threshold = scene.cycle.stick_threshold;
  table.read("stick_threshold", map.stick_threshold, {"", "1", {1e-6, 0.999}, "stick is |v| <= threshold times V"});
  const bool hangs_on_it = std::ranges::find(map.metrics, "slow_fraction") != map.metrics.end();
  if (table.find("stick_threshold") && scene.model.law->set_valued() && !hangs_on_it)
    scene.notes.push_back(
        "map.stick_threshold has no effect on stick_fraction under a set-valued law, whose stick is exact rest; ask "
        "for "
        "slow_fraction");
  table.finish();
}

void read_curve(Table table, CurveOptions& curve) {
  const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
  table.read("from", curve.from, speed);
  table.read("to", curve.to, speed);
  if (!(curve.from < curve.to))
    fail(table.source(), "curve.from = {} must be below curve.to = {}", curve.from, curve.to);
  table.read("points", curve.points, 2, 1'000'000, "number of slip rates");
  table.read("normal_load", curve.normal_load, mechanical("drive.normal_load"));
  table.finish();
}

void read_solver(Table table, analysis::RunOptions& run) {
  const auto* type = table.find("type");
  if (type) {
    auto known = analysis::solver_names();
    known.emplace_back("lanes");
    run.solver = choice(*type, table.path("type"), known);
    if (run.solver == "lanes")
      fail(type->source(), "solver.type = 'lanes' is that of maps and not to be chosen; use one of {}",
           fmt::join(analysis::solver_names(), ", "));
  }
  // Keys of the force algorithms, and the algorithms that each means something to.
  auto& algorithm = run.algorithm;
  const auto meant = [&](std::string_view key, std::string_view for_these) {
    const auto* node = table.find(key);
    if (node && (" " + std::string(for_these) + " ").find(" " + run.solver + " ") == std::string::npos)
      fail(node->source(), "{} has no meaning for solver '{}', only for {}", table.path(key), run.solver, for_these);
    return node;
  };
  const auto flag = [&](std::string_view key, bool& target, std::string_view for_these) {
    if (const auto* node = meant(key, for_these)) {
      if (!node->is_boolean()) wrong_kind(*node, table.path(key), "true or false");
      target = *node->value<bool>();
    }
  };
  const auto value = [&](std::string_view key, double& target, Quantity quantity, std::string_view for_these) {
    if (meant(key, for_these)) table.read(key, target, std::move(quantity));
  };
  constexpr std::string_view sticking = "o-fbfm r-fbfm aabg-sdfm tr-sdfm", sprung = "aabg-sdfm tr-sdfm";
  value("step", algorithm.step, {"", "s", {1e-15, 1e15}, "step of time"},
        "cfm o-fbfm r-fbfm aabg-sdfm tr-sdfm vlfm svlfm meijaard");
  if (const auto* node = meant("stepping", "cfm o-fbfm r-fbfm aabg-sdfm tr-sdfm"))
    algorithm.closed_form = choice(*node, table.path("stepping"), {"runge-kutta", "closed-form"}) == "closed-form";
  flag("micro_slip", algorithm.micro_slip, sticking);
  value("window", algorithm.window, {"", "m/s", {1e-15, 1e4}, "speed of slip below which the mass counts as at rest"},
        "o-fbfm");
  value("adherence_stiffness", algorithm.adherence_stiffness, {"", "N/m", {1e-12, 1e18}, "spring of stick"}, sprung);
  value("adherence_damping", algorithm.adherence_damping, {"", "1", {1e-3, 1e6}, "damping ratio of stick"}, sprung);
  flag("original", algorithm.original, "aabg-sdfm");
  flag("refusal", algorithm.refusal, "tr-sdfm");
  if (const auto* node = meant("restart", "tr-sdfm"))
    algorithm.restart_before = choice(*node, table.path("restart"), {"before", "at"}) == "before";
  value("transition_speed", algorithm.transition_speed,
        {"", "m/s", {1e-15, 1e4}, "speed of slip below which friction falls to zero"}, "vlfm svlfm");
  table.refuse("smoothing");
  table.finish();
}

void read_study(Table table, analysis::StudyOptions& study) {
  if (const auto* dimensions = table.find("dimensions")) {
    study.dimensions = count(*dimensions, table.path("dimensions"), 1, 2, "1 or 2");
    if (study.dimensions > 2) fail(dimensions->source(), "study.dimensions = {} is outside 1 … 2", study.dimensions);
    if (study.dimensions == 2) study.window_threshold = 0.2751;
  }
  table.read("cases", study.cases, 1, 1'000'000, "random oscillators");
  int seed = 1;
  table.read("seed", seed, 0, largest_seed, "of the random oscillators");
  study.seed = static_cast<std::uint64_t>(seed);
  if (const auto* names = table.find("algorithms")) {
    study.algorithms = texts(*names, table.path("algorithms"));
    if (study.algorithms.empty()) fail(names->source(), "study.algorithms is empty");
  }
  table.read("start_factor", study.start_factor, {"", "1", {1.000001, 1e6}, "start over where stick could hold"});
  table.read("duration_factor", study.duration_factor, {"", "1", {1e-3, 1e3}, "time in four decay times"});
  table.read("steps_per_period", study.steps_per_period, 600, 1'000'000, "steps of the shortest period");
  table.read("most_sticks", study.most_sticks, 1, 1'000'000, "sticks with which a motion ends");
  table.read("window_share", study.window_share, {"", "1", {1e-9, 1}, "window of o-fbfm over the average speed"});
  table.read("window_threshold", study.window_threshold,
             {"", "1", {1e-6, 1e6}, "threshold of the distribution of o-fbfm's errors"});
  table.read("show", study.show, 0, 1'000'000, "case whose motions are drawn");
  table.finish();
}

// ---------------------------------------------------------------- comparisons

std::vector<analysis::Property> read_properties(const toml::node& node, const std::string& path) {
  std::vector<analysis::Property> properties;
  for (const auto& element : list(node, path, "tables")) {
    Table keys(element, path);
    keys.expect({"name", "slip_rate", "ratio", "hold", "from", "to", "points"});
    std::vector<std::string> known{"steady-curve"};
    for (const auto& property : analysis::property_names()) known.emplace_back(property.name);
    const auto property = choice(keys.required("name", "of the property"), keys.path("name"), known);
    const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
    if (property == "steady-curve") {
      double from = 0, to = 0;
      int points = 41;
      keys.required("from", "lowest slip rate, m/s");
      keys.required("to", "highest slip rate, m/s");
      keys.read("from", from, speed);
      keys.read("to", to, speed);
      keys.read("points", points, 2, 1'000'000, "slip rates along the curve");
      if (!(from < to)) fail(element.source(), "{}: from = {} must be below to = {}", path, from, to);
      const auto curve = analysis::steady_curve(from, to, points);
      properties.insert(properties.end(), curve.begin(), curve.end());
    } else {
      analysis::Property one{.name = property, .slip_rate = 0};
      keys.required("slip_rate", "m/s");
      keys.read("slip_rate", one.slip_rate, speed);
      keys.read("ratio", one.ratio, {"", "1", {1e-6, 1e6}, "slip rate after the step over that before it"});
      keys.read("hold", one.hold, {"", "s", {0, 1e15}, "time at rest"});
      properties.push_back(one);
    }
    keys.finish();
  }
  return properties;
}

/// The scene's model with what a member changes.
CompareOptions::Member read_member(const toml::node& node, const oscillators::Model& model) {
  Table table(node, "compare.members");
  table.expect({"name", "law", "set"});
  CompareOptions::Member member{text(table.required("name", "of the member"), "compare.members.name"), model, {}, 0};
  if (const auto* law = table.find("law")) {
    member.model.lambda = 1;
    member.model.contact_stiffness = {};
    read_law(Table(*law, "compare.members.law"), member.model);
  }
  if (const auto* set = table.find("set")) {
    if (!set->is_table()) wrong_kind(*set, "compare.members.set", "a table of paths, such as { \"law.lambda\" = 10 }");
    for (const auto& [key, value] : *set->as_table()) {
      const std::string path(key.str());
      located(value.source(), [&] {
        auto quantity = member.model.describe(path);
        member.model = member.model.with(path, number(value, quantity));
      });
    }
  }
  table.finish();
  return member;
}

void read_noise(const toml::node& node, CompareOptions& compare) {
  if (!node.is_table()) wrong_kind(node, "compare.noise", "a table of metrics");
  for (const auto& [key, value] : *node.as_table()) {
    analysis::Noise noise{std::string(key.str())};
    const auto* metric = located(value.source(), [&] { return &analysis::find_metric(noise.metric); });
    Table keys(value, "compare.noise." + noise.metric);
    keys.read("absolute", noise.absolute, {"", std::string(metric->unit), {0, 1e300}, "standard deviation"});
    keys.read("relative", noise.relative, {"", "1", {0, 1e3}, "standard deviation over the value"});
    keys.finish();
    if (noise.absolute + noise.relative == 0)
      fail(value.source(), "compare.noise.{}: give absolute ({}) or relative, above 0", noise.metric,
           readable_unit(metric->unit));
    compare.noise.push_back(noise);
  }
}

void read_compare(Table table, Scene& scene, Verb verb) {
  auto& compare = scene.compare;
  table.expect({"members", "protocol", "equalise", "noise", "confidence", "parameter"});
  if (const auto* protocol = table.find("protocol"))
    compare.protocol = choice(*protocol, "compare.protocol", {"curve", "stability", "run", "cycle", "map"});
  if (const auto* parameter = table.find("parameter")) {
    compare.parameter = text(*parameter, "compare.parameter");
    located(parameter->source(), [&] { scene.model.describe(compare.parameter); });
  }
  const bool of_parameter = verb == Verb::design && !compare.parameter.empty();
  if (const auto* members = table.find("members"))
    for (const auto& element : list(*members, "compare.members", "tables", most_names))
      compare.members.push_back(read_member(element, scene.model));
  if (!of_parameter && compare.members.size() < 2)
    fail(table.source(), "compare.members needs two members or more, each a table with a name and what it changes");
  for (auto member = compare.members.begin(); member != compare.members.end(); ++member) {
    if (std::any_of(compare.members.begin(), member, [&](const auto& other) { return other.name == member->name; }))
      fail(table.source(), "compare.members: two are named '{}'", member->name);
    located(table.source(), [&] { member->model.check(); });
  }
  if (auto equal = table.table("equalise")) {
    equal->expect({"properties", "adjust"});
    const auto& properties = equal->required("properties", "what the members are to share");
    compare.adjust = texts(equal->required("adjust", "paths of parameters"), equal->path("adjust"));
    const auto wanted = read_properties(properties, equal->path("properties"));
    equal->finish();
    for (std::size_t k = 1; k < compare.members.size(); ++k) {
      auto& member = compare.members[k];
      located(equal->source(), [&] {
        try {
          const auto equalised =
              analysis::equalise(member.model, compare.members.front().model, wanted, compare.adjust);
          member.model = equalised.model;
          member.adjusted = equalised.values;
          member.difference = equalised.difference;
        } catch (const InputError& error) {
          throw InputError(fmt::format("compare.equalise, member '{}': {}", member.name, error.what()));
        }
      });
    }
  }
  if (const auto* noise = table.find("noise")) read_noise(*noise, compare);
  table.read("confidence", compare.confidence, {"", "1", {0.5, 0.999999}, "probability of the right decision"});
  table.finish();
  if (verb == Verb::design && compare.noise.empty())
    fail(table.source(), "compare.noise is needed for a design: the noise of each metric that is measured");
}

// ---------------------------------------------------------------- the laboratory

/// Numbers by name of a column of the experiment's record.
std::map<std::string, double> read_columns(Table table, const std::vector<std::string>& columns,
                                           std::string_view meaning) {
  std::map<std::string, double> values;
  for (const auto& column : columns) {
    std::optional<double> value;
    table.read(column, value, {"", "1", {0, 1e300}, std::string(meaning)});
    if (value) values[column] = *value;
  }
  table.finish();
  return values;
}

analysis::lab::Sensor read_sensor(Table table, const std::vector<std::string>& columns) {
  analysis::lab::Sensor sensor;
  table.read("sample_rate", sensor.sample_rate, {"", "Hz", {1e-15, 1e15}, "samples per second"});
  table.read("low_pass", sensor.low_pass, {"", "Hz", {1e-15, 1e15}, "corner frequency of the pole before sampling"});
  int seed = 1;
  table.read("seed", seed, 0, largest_seed, "of the noise");
  sensor.seed = static_cast<std::uint64_t>(seed);
  if (auto noise = table.table("noise")) sensor.noise = read_columns(*noise, columns, "rms of white noise, SI");
  if (auto step = table.table("resolution"))
    sensor.resolution = read_columns(*step, columns, "step of the converter, SI");
  if (auto range = table.table("range")) sensor.range = read_columns(*range, columns, "largest reading, SI");
  table.finish();
  return sensor;
}

void read_lab(Table table, Scene& scene, const fs::path& folder) {
  const auto& experiment = *scene.experiment;
  auto& task = *scene.lab;
  for (const auto& setting : experiment.settings) {
    auto quantity = setting.quantity;
    const auto name = std::exchange(quantity.name, table.path(setting.quantity.name));
    const auto* node = table.find(name);
    if (!node) continue;
    located(node->source(), [&] {
      if (quantity.is_list)
        task.settings.set(name, numbers(*node, quantity));
      else if (setting.whole)
        task.settings.set(name, double(count(*node, quantity.name, static_cast<int>(quantity.range.low),
                                             static_cast<int>(std::min<double>(quantity.range.high, most_points)),
                                             quantity.meaning)));
      else
        task.settings.set(name, number(*node, quantity));
    });
  }
  if (experiment.takes_motion)
    if (const auto* record = table.find("record"))
      located(record->source(), [&] {
        task.motion = read_signal(folder / text(*record, table.path("record")), "m");
        Signal{*task.motion};  // refuses empty records and times that do not ascend
      });
  if (auto sensor = table.table("sensor"))
    task.sensor = read_sensor(*sensor, analysis::lab::column_names(experiment, *scene.model.law));
  table.finish();
}

// ---------------------------------------------------------------- the scene as resolved

/// A value on one line. Numbers are the shortest that read back the same (the library prints seventeen digits).
void write_value(std::string& out, const toml::node& node) {
  if (node.is_number()) {
    out += fmt::format("{}", *node.value<double>());
  } else if (const auto* list = node.as_array()) {
    out += '[';
    for (const auto& element : *list) {
      if (&element != &list->front()) out += ", ";
      write_value(out, element);
    }
    out += ']';
  } else if (const auto* table = node.as_table()) {
    const char* separator = "{ ";
    for (const auto& [key, value] : *table) {
      out += std::exchange(separator, ", ");
      out += fmt::format("{} = ", key.str());
      write_value(out, value);
    }
    out += table->empty() ? "{}" : " }";
  } else {
    std::ostringstream text;
    node.visit([&](const auto& value) { text << toml::toml_formatter(value); });
    out += text.str();
  }
}

/// Values first, then a section for each table of the first level, whose own tables stand on one line.
void write_table(std::string& out, const toml::table& table, std::string_view name) {
  if (!name.empty()) out += fmt::format("\n[{}]\n", name);
  for (const auto& [key, value] : table) {
    if (name.empty() && value.is_table()) continue;
    out += fmt::format("{} = ", key.str());
    write_value(out, value);
    out += '\n';
  }
  for (const auto& [key, value] : table)
    if (name.empty() && value.is_table()) write_table(out, *value.as_table(), key.str());
}

/// Where each key stands, by its path.
void note_places(const toml::node& node, const std::string& path, std::map<std::string, std::string>& places) {
  if (!path.empty()) places[path] = place(node.source());
  if (const auto* table = node.as_table())
    for (const auto& [key, inner] : *table)
      note_places(inner, path.empty() ? std::string(key.str()) : fmt::format("{}.{}", path, key.str()), places);
}

/// Reads what the verb asks of the scene; `chosen`: the experiment of the verb lab.
void read_tables(const toml::table& document, Verb verb, const analysis::lab::Experiment* chosen, Scene& scene) {
  const fs::path folder = fs::path(scene.path).parent_path();
  Table root(document, "");
  for (const char* table : {"sweep", "branch", "lyapunov"}) root.refuse(table);
  root.expect({"title", "law", "oscillator", "drive", "curve", "stability", "run", "cycle", "map", "compare", "fit",
               "frf", "lab", "solver", "study", "verify"});
  if (const auto* title = root.find("title")) scene.title = text(*title, "title");
  if (verb == Verb::study) {  // draws its own models
    read_study(Table(root.required("study", "cases, seed and algorithms"), "study"), scene.study);
    root.finish();
    write_table(scene.resolved, document, "");
    return;
  }
  const auto* response = document.at_path("frf.record").node();  // a measured one needs neither law nor drive
  if (verb == Verb::frf && response && !document.contains("law") && !document.contains("drive")) {
    scene.frf_predicts = false;
    auto table = root.table("frf");
    read_frf(*table, scene, nullptr, folder);
    root.finish();
    write_table(scene.resolved, document, "");
    return;
  }
  read_law(Table(root.required("law", "the friction law"), "law"), scene.model);

  const bool contact_only = verb == Verb::curve || verb == Verb::frf || verb == Verb::fit;  // no slider is asked for
  const bool needs_slider = !contact_only && verb != Verb::lab, complete = verb != Verb::lab;
  if (chosen) {
    scene.experiment = chosen;
    scene.lab = analysis::lab::task_for(*chosen, scene.model.law);
    scene.model.slider = chosen->slider;
    scene.model.drive = chosen->drive;
  }
  const toml::node* oscillator = root.find("oscillator");
  if (needs_slider) root.required("oscillator", "mass, stiffness and damping of the slider");
  const auto* type = oscillator && oscillator->is_table() ? oscillator->as_table()->get("type") : nullptr;
  if (verb == Verb::run && type && type->value_or(std::string()) == "plane-slider") {
    const auto& loads = root.required("drive", "normal load and two forces");
    if (scene.model.contact_stiffness.present())
      fail(document.get("law")->source(),
           "law.contact_stiffness does not go with a plane slider, whose contact is rigid");
    scene.plane = read_plane(Table(*oscillator, "oscillator"), Table(loads, "drive"), *scene.model.law,
                             document.get("law")->source(), folder);
    read_run(Table(root.required("run", "duration and start"), "run"), scene.run, *scene.model.law, &*scene.plane,
             true);
    if (auto table = root.table("solver")) read_solver(*table, scene.run);
    root.finish();
    write_table(scene.resolved, document, "");
    return;
  }
  if (oscillator) read_oscillator(Table(*oscillator, "oscillator"), scene.model.slider, complete);
  const toml::node* drive = root.find("drive");
  if (needs_slider || (verb == Verb::frf && !response)) root.required("drive", "speed and normal load");
  scene.frf_predicts = drive;
  if (drive) {
    read_drive(Table(*drive, "drive"), scene.model.drive, folder, complete);
    scene.curve.normal_load = scene.model.drive.normal_load.level();
  }
  if (needs_slider) located(oscillator->source(), [&] { scene.model.check(); });

  if (auto table = root.table("curve")) read_curve(*table, scene.curve);
  if (auto table = root.table("stability")) {
    if (const auto* parameters = table->find("parameters")) {
      scene.hopf_parameters = texts(*parameters, "stability.parameters");
      for (std::size_t i = 0; i < scene.hopf_parameters.size(); ++i)
        located(parameters->as_array()->get(i)->source(), [&] { scene.model.describe(scene.hopf_parameters[i]); });
    }
    table->finish();
  }
  const toml::node* comparison = root.find("compare");
  const auto protocol = [&](std::string_view name) {  // compared by this one
    const auto* given = comparison && comparison->is_table() ? comparison->as_table()->get("protocol") : nullptr;
    return verb == Verb::compare && given && given->value_or(std::string()) == name;
  };
  const bool runs = verb == Verb::run || protocol("run"), maps = verb == Verb::map || verb == Verb::design;
  if (runs) root.required("run", "duration and start");
  if (auto table = root.table("run")) read_run(*table, scene.run, *scene.model.law, nullptr, runs);
  if (auto table = root.table("cycle")) read_cycle(*table, scene);
  if (maps || protocol("map")) root.required("map", "the two axes and the metrics");
  if (auto table = root.table("map")) read_map(*table, scene);
  if (verb == Verb::compare || verb == Verb::design) {
    root.required("compare", "members, and what is made equal in them");
    read_compare(Table(*comparison, "compare"), scene, verb);
  }
  if (verb == Verb::frf) root.required("frf", "frequencies");
  if (auto table = root.table("frf"); table && verb == Verb::frf) read_frf(*table, scene, oscillator, folder);
  if (verb == Verb::fit) root.required("fit", "parameters and data");
  if (auto table = root.table("fit"); table && verb == Verb::fit)
    read_fit(*table, scene, folder, [](Table law, oscillators::Model& model) { read_law(std::move(law), model); });
  if (verb == Verb::fit)  // measurements have their own drive, and none of them knows a slider
    for (const char* unread : {"oscillator", "drive.force", "law.load_memory"})
      if (document.at_path(unread))
        scene.notes.push_back(fmt::format("{} has no effect: a fit does not ask for it", unread));
  if (auto table = root.table("solver")) read_solver(*table, scene.run);
  if (auto table = root.table("lab"); table && chosen) read_lab(*table, scene, folder);
  root.finish();
  if (chosen) {
    scene.lab->model = scene.model;
    for (const auto& path : chosen->prescribed)
      if (document.at_path(path))
        scene.notes.push_back(fmt::format("{} has no effect: {} sets it itself", path, chosen->name));
  }

  if (runs)  // a ramp has no end of its own: it must stay in range for as long as the run lasts
    for (const auto& [signal, name] :
         {std::pair{&scene.model.drive.speed, "speed"}, std::pair{&scene.model.drive.normal_load, "normal_load"},
          std::pair{&scene.model.drive.force, "force"}}) {
      const auto quantity = mechanical(std::string("drive.") + name);
      if (!quantity.range.contains(signal->value(scene.run.duration)))
        fail(drive->as_table()->get(name)->source(), "{} leaves {} ({}, {}) before run.duration", quantity.name,
             text(quantity.range), quantity.meaning, quantity.unit);
    }

  write_table(scene.resolved, document, "");
}

}  // namespace

toml::table read_toml(const std::string& path) {
  const auto content = read_whole(path, largest_scene);
  if (content.find_first_not_of(" \t\r\n") == std::string::npos)
    throw InputError(fmt::format("{}:1:1: the file is empty; a scene needs at least [law] with a type", path));
  check_depth(content, path);
  try {
    return toml::parse(content, path);
  } catch (const toml::parse_error& error) {
    fail(error.source(), "not valid TOML: {}", error.description());
  }
}

Scene read_scene(const std::string& path, std::span<const std::string> overrides, Verb verb,
                 std::string_view experiment) {
  const auto* chosen = verb == Verb::lab ? &analysis::lab::find_experiment(experiment) : nullptr;
  toml::table document = read_toml(path);
  for (const auto& override : overrides) apply_override(document, override);

  Scene scene;
  scene.path = path;
  note_places(document, "", scene.places);
  try {
    read_tables(document, verb, chosen, scene);
  } catch (const PlacedError&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(scene.placed(error.what()));
  }
  return scene;
}

std::string Scene::placed(const std::string& text) const {
  if (text.starts_with(path) || text.starts_with(override_mark)) return text;
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
  };
  std::string above;  // the place of a table that a key would stand in
  for (auto begin = text.begin(); begin != text.end();) {
    begin = std::find_if(begin, text.end(), is_part);
    const auto end = std::find_if_not(begin, text.end(), is_part);
    std::string word(begin, end);
    begin = end;
    while (word.ends_with('.')) word.pop_back();
    if (word.find('.') == std::string::npos) continue;
    if (const auto place = places.find(word); place != places.end()) return fmt::format("{}: {}", place->second, text);
    if (const auto place = places.find(word.substr(0, word.rfind('.'))); place != places.end() && above.empty())
      above = place->second;
  }
  return fmt::format("{}: {}", above.empty() ? path : above, text);
}

}  // namespace rosin::app
