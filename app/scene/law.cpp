/// Laws by name or as formulas, and what surrounds them.
#include "app/scene/law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "app/scene/oscillator.hpp"
#include "app/scene/reader.hpp"
#include "laws/catalogue.hpp"
#include "laws/formula.hpp"
#include "laws/heating.hpp"
#include "laws/one_coefficient.hpp"
#include "laws/regions.hpp"

namespace rosin::app::scene {

namespace {

/// Calls `f`; an error in an expression gets the place of its token in the file, as far as that is known.
template <class F>
auto located_in_formula(const toml::node& formula, F f) {
  try {
    return f();
  } catch (const laws::ExpressionError& error) {
    const toml::node* node = &formula;  // or the innermost of the path that is there
    constexpr std::string_view above = "law.formula.";
    std::istringstream path(error.expression.substr(above.size()));
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
    refuse_reserved(entry, name,
                    {"displacement", "velocity", "acceleration", "slip_rate", "state", "time", "friction_force"});
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

/// Smooths the law, with notes of what it loses by that.
void smooth(SceneReader& reader, oscillators::Model& model) {
  const auto& law = *model.law;
  auto& notes = reader.scene.notes;
  const auto note = [&](std::string text) {  // once for all contacts
    if (std::ranges::find(notes, text) == notes.end()) notes.push_back(std::move(text));
  };
  constexpr double load = 1, rounding = 1e-12;
  const auto at_rest = law.rest(load);
  const double holds = law.static_limit(load, at_rest),
               moves = law.friction({std::numeric_limits<double>::min(), load}, at_rest);
  if (holds > moves * (1 + rounding))
    note(
        fmt::format("solver.smoothing: the coefficient {:.6g} at rest of law '{}' has no effect; smoothed friction "
                    "near rest rises to {:.6g}, its limit in motion",
                    holds, law.card().name, moves));
  if (law.has_states())
    note(
        fmt::format("solver.smoothing: a contact that creeps never stops, so that states of law '{}' count neither "
                    "time at rest nor slip from a stop",
                    law.card().name));
  model.law = reader.smoothing ? laws::smoothed(model.law, *reader.smoothing)
                               : laws::by_regions(model.law, reader.region_width);
  reader.smooths = true;
}

}  // namespace

void read_law(SceneReader& reader, Table law, oscillators::Model& model) {
  const auto& type =
      law.required("type", "name of a friction law; 'rosin laws' lists them, 'formula' is one from text");
  const auto type_name = text(type, law.path("type"));
  const auto* formula = type_name == "formula" ? &law.required("formula", "the law as text") : nullptr;
  auto prototype = formula ? read_formula(*formula) : located(type.source(), [&] { return laws::find_law(type_name); });
  for (const auto& other : laws::catalogue()) {
    const auto& option = other->card().option;
    const auto* word = option.of == type_name ? law.find(option.key) : nullptr;
    if (!word) continue;
    std::vector<std::string> words = {std::string(option.usual)};
    for (const auto& each : laws::catalogue())
      if (const auto& o = each->card().option; o.of == option.of && o.key == option.key) words.emplace_back(o.word);
    if (choice(*word, law.path(option.key), words) == option.word) prototype = other;
  }
  if (const auto* name = law.find("preset"))
    prototype = located(name->source(), [&] { return laws::preset(*prototype, text(*name, law.path("preset"))); });
  auto values = prototype->values();
  const auto both = laws::one_coefficient_of(*prototype);
  const auto* at_once = both ? law.find(laws::one_coefficient) : nullptr;
  if (both && !at_once) {
    auto quantity = *both;
    quantity.name = law.path(quantity.name);
    NumbersAsked::note(quantity);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    auto quantity = prototype->parameters()[i];
    const auto* node = law.find(quantity.name);
    if (at_once && laws::is_rest_or_motion(quantity.name)) quantity.name = both->name, node = at_once;
    quantity.name = law.path(quantity.name);
    if (!node)
      NumbersAsked::note(quantity);
    else if (quantity.is_list)
      values[i] = numbers(*node, quantity);
    else
      values[i] = number(*node, quantity);
  }
  model.law = located(law.source(), [&] { return prototype->with(std::move(values)); });
  if (formula) located_in_formula(*formula, [&] { laws::check_formula(*model.law); });
  if ((reader.smoothing || reader.region_width > 0) && model.law->set_valued())
    located(law.source(), [&] { smooth(reader, model); });

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
  } else if (model.law->has_states()) {
    NumbersAsked::note(mechanical("law.lambda"));
  }
  const std::pair<const char*, double*> of_spring[] = {{"tangential", &model.contact_stiffness.tangential},
                                                       {"per_load", &model.contact_stiffness.per_load},
                                                       {"damping", &model.contact_stiffness.damping},
                                                       {"damping_per_load", &model.contact_stiffness.damping_per_load}};
  auto spring = law.table("contact_stiffness");
  for (const auto& [key, value] : of_spring) {
    const auto quantity = mechanical(fmt::format("law.contact_stiffness.{}", key));
    if (spring)
      spring->read(key, *value, quantity);
    else
      NumbersAsked::note(quantity);
  }
  if (spring) {
    spring->finish();
    if (model.contact_stiffness.damped() && !model.contact_stiffness.present())
      fail(spring->source(),
           "law.contact_stiffness: damping without a spring beside it has no meaning; give tangential (N/m) or "
           "per_load (1/m)");
  }
  if (auto memory = law.table("load_memory")) {
    memory->read("alpha", model.load_memory, mechanical("law.load_memory.alpha"));
    memory->finish();
  } else {
    NumbersAsked::note(mechanical("law.load_memory.alpha"));
  }
  law.finish();
}

}  // namespace rosin::app::scene
