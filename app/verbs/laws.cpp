/// The verb laws: cards of friction laws.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/output/files.hpp"
#include "app/output/json.hpp"
#include "app/scene/aliases.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "laws/catalogue.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

std::string document_of(const std::vector<std::shared_ptr<const FrictionLaw>>& laws) {
  auto document = ordered_json::array();
  for (const auto& law : laws) {
    auto parameters = ordered_json::array(), states = ordered_json::array(), presets = ordered_json::array();
    for (std::size_t i = 0; i < law->parameters().size(); ++i) {
      const auto& p = law->parameters()[i];
      ordered_json entry{{"name", p.name}, {"unit", p.unit}};
      std::visit([&](const auto& value) { entry["default"] = value; }, law->values()[i]);
      entry.update({{"minimum", p.range.low}, {"maximum", p.range.high}, {"meaning", p.meaning}});
      parameters.push_back(std::move(entry));
    }
    for (const auto& s : law->states()) states.push_back({{"name", s.name}, {"unit", s.unit}, {"meaning", s.meaning}});
    for (const auto& p : law->presets())
      presets.push_back(
          {{"name", p.name}, {"source", p.source}, {"values", output::values(law->parameters(), p.values)}});
    const auto& card = law->card();
    auto option = ordered_json();
    if (!card.option.of.empty())
      option = {{"type", card.option.of}, {"key", card.option.key}, {"word", card.option.word}};
    document.push_back({{"name", card.name},
                        {"title", card.title},
                        {"formula", card.formula},
                        {"source", card.source},
                        {"limits", card.limits},
                        {"approximation", card.approximation},
                        {"option", std::move(option)},
                        {"set_valued", law->set_valued()},
                        {"parameters", std::move(parameters)},
                        {"states", std::move(states)},
                        {"presets", std::move(presets)}});
  }
  return output::text(document);
}

void print_law(const FrictionLaw& law) {
  const auto& card = law.card();
  print("{}: {}\n  {}\n  source: {}\n  limits: {}\n", card.name, card.title, card.formula, card.source, card.limits);
  if (!card.approximation.empty()) print("  approximation: {}\n", card.approximation);
  if (!card.option.of.empty())
    print("  also: type = \"{}\", {} = \"{}\"\n", card.option.of, card.option.key, card.option.word);
  for (std::size_t i = 0; i < law.parameters().size(); ++i) {
    const auto& p = law.parameters()[i];
    const auto value = std::visit([](const auto& v) { return fmt::format("{}", v); }, law.values()[i]);
    print("  {:<12} {:<22} {} … {}  {}\n", p.name, output::column_header(value, p.unit), p.range.low, p.range.high,
          p.meaning);
  }
  for (const auto& s : law.states()) print("  state {:<6} {}  {}\n", s.name, readable_unit(s.unit), s.meaning);
  for (const auto& p : law.presets()) print("  preset \"{}\": {}\n", p.name, p.source);
  print("\n");
}

Status list_laws(const Request& request) {
  std::vector<std::shared_ptr<const FrictionLaw>> laws = laws::catalogue();
  if (!request.target.empty()) laws = {laws::find_law(scene::law_called(request.target))};
  if (request.json)
    write_output(document_of(laws));
  else
    for (const auto& law : laws) print_law(*law);
  return done;
}

}  // namespace

Verb laws_verb() {
  std::vector<std::string> names;
  for (const auto& law : laws::catalogue()) names.emplace_back(law->card().name);
  return {.name = "laws",
          .help = "list friction laws with parameters, units, ranges and sources",
          .example = "rosin laws spinodal",
          .operands = {{"LAW", &Request::target, "one law; all if left out", false, names}},
          .options = {json_option},
          .without_scene = list_laws};
}

}  // namespace rosin::app::verbs
