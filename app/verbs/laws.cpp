/// The verb laws: cards of friction laws and normal laws.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/output/files.hpp"
#include "app/results/result.hpp"
#include "app/scene/aliases.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "laws/catalogue.hpp"
#include "laws/normal_catalogue.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

using Normal = laws::NormalEntry;

/// A number or true and false as such, other words as text, and what must be given as null.
ordered_json default_of(const laws::NormalParameter& parameter) {
  if (parameter.value == "required") return nullptr;
  auto value = ordered_json::parse(parameter.value, nullptr, false);
  return value.is_discarded() ? ordered_json(parameter.value) : value;
}

ordered_json card_of(const Normal& law) {
  auto parameters = ordered_json::array();
  for (const auto& parameter : law.parameters) {
    const auto& p = parameter.quantity;
    ordered_json entry{{"name", p.name}, {"unit", p.unit}, {"default", default_of(parameter)}};
    const bool number = !p.unit.empty();
    entry["minimum"] = number ? ordered_json(p.range.low) : ordered_json();
    entry["maximum"] = number ? ordered_json(p.range.high) : ordered_json();
    entry["meaning"] = p.meaning;
    parameters.push_back(std::move(entry));
  }
  return {{"name", law.card->name},
          {"kind", "normal"},
          {"title", law.card->title},
          {"formula", law.card->formula},
          {"source", law.card->source},
          {"limits", law.card->limits},
          {"approximation", law.card->approximation},
          {"option", nullptr},
          {"set_valued", false},
          {"parameters", std::move(parameters)},
          {"states", ordered_json::array()},
          {"presets", ordered_json::array()}};
}

std::string document_of(const std::vector<std::shared_ptr<const FrictionLaw>>& laws,
                        const std::vector<Normal>& normal_laws) {
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
          {{"name", p.name}, {"source", p.source}, {"values", results::values(law->parameters(), p.values)}});
    const auto& card = law->card();
    auto option = ordered_json();
    if (!card.option.of.empty())
      option = {{"type", card.option.of}, {"key", card.option.key}, {"word", card.option.word}};
    document.push_back({{"name", card.name},
                        {"kind", "friction"},
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
  for (const auto& law : normal_laws) document.push_back(card_of(law));
  return results::text(document);
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

void print_law(const Normal& law) {
  const auto& card = *law.card;
  print("{}: {}\n  normal law: oscillator.….normal_contact\n  {}\n  source: {}\n  limits: {}\n", card.name, card.title,
        card.formula, card.source, card.limits);
  for (const auto& [p, value] : law.parameters)
    if (p.unit.empty())
      print("  {:<18} {:<26} {}\n", p.name, value, p.meaning);
    else
      print("  {:<18} {:<26} {} … {}  {}\n", p.name, output::column_header(value, p.unit), p.range.low, p.range.high,
            p.meaning);
  print("\n");
}

Status list_laws(const Request& request) {
  std::vector<std::shared_ptr<const FrictionLaw>> laws = laws::catalogue();
  std::vector<Normal> normal_laws = laws::normal_catalogue();
  if (!request.target.empty()) {
    std::erase_if(normal_laws, [&](const Normal& law) { return law.card->name != request.target; });
    if (normal_laws.empty())
      laws = {laws::find_law(scene::law_called(request.target))};
    else
      laws.clear();
  }
  if (request.json)
    write_output(document_of(laws, normal_laws));
  else {
    for (const auto& law : laws) print_law(*law);
    for (const auto& law : normal_laws) print_law(law);
  }
  return done;
}

}  // namespace

Verb laws_verb() {
  std::vector<std::string> names;
  for (const auto& law : laws::catalogue()) names.emplace_back(law->card().name);
  for (const auto& law : laws::normal_catalogue()) names.emplace_back(law.card->name);
  return {.name = "laws",
          .help = "list friction and normal laws with parameters, units, ranges and sources",
          .example = "rosin laws spinodal",
          .operands = {{"LAW", &Request::target, "one law; all if left out", false, names}},
          .options = {json_option},
          .without_scene = list_laws};
}

}  // namespace rosin::app::verbs
