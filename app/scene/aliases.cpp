/// The table of names that other programs use, and the walk over a scene that replaces them.
#include "app/scene/aliases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "app/scene/oscillator.hpp"
#include "app/scene/scene_table.hpp"
#include "app/scene/toml_document.hpp"
#include "laws/catalogue.hpp"
#include "laws/one_coefficient.hpp"

namespace rosin::app::scene {

namespace {

/// A line of the table: words that mean `own`, in a table of the scene that has a key of that name.
struct Alias {
  std::string_view table;  ///< "law.type" for the names of laws
  std::string_view words;  ///< as `plain` writes them; a word with a capital is compared as it stands
  std::string_view own;
  std::string_view advice = {};  ///< the words are refused, with this
};

constexpr Alias aliases[] = {
    {"law.type", "aging dieterich dieterichstate aginglaw ageinglaw", "ageing"},
    {"law.type", "ruina ruinastate sliplaw", "slip"},
    {"law.type", "perrinricezheng przstate przlaw", "prz"},
    {"law.type", "nagatastate", "nagata"},
    {"law.type", "composite compositelaw", "kato-tullis"},
    {"law.type", "amontons amontonscoulomb coulombfriction", "coulomb"},
    {"law.type", "canudasdewit", "lugre"},
    {"law.type", "linearslipweakening lsw", "slip-weakening"},
    {"law.type", "rateandstate rsf dieterichruina ruinadieterich", "",
     "is a family of laws: give 'ageing' (contacts age at rest), 'slip' (they change by slip alone) or another"},
    {"law.type", "exponentialdecay exponential", "",
     "is 'stribeck' with exponent = 1: mu_d is the kinetic coefficient, v_s = 1/d_c of the decay coefficient"},
    {"law.type", "viscous coulombviscous", "",
     "is 'stribeck' with mu_s = mu_d and viscous, the viscous coefficient over the normal load (s/m)"},
    {"law.type", "tanh arctan regularizedcoulomb regularisedcoulomb smoothcoulomb smoothedcoulomb", "",
     "is 'coulomb' with solver.smoothing = { type = \"tanh\", width = … }; 'coulomb' alone sticks exactly"},

    {"law", "dc drs criticalslipdistance characteristicslipdistance characteristicdistance", "L"},
    {"law", "dc1 drs1", "L1"},
    {"law", "dc2 drs2", "L2"},
    {"law", "vref vr vo vstar referencevelocity referencespeed", "v0"},
    {"law", "muo muref mustar f0 fref referencefriction", "mu0"},
    {"law", "mustatic staticfriction staticcoefficient", "mu_s"},
    {"law", "muk muc mudynamic mukinetic kineticfriction kineticcoefficient dynamicfriction", "mu_d"},
    {"law", "vst vstribeck stribeckvelocity stribeckspeed", "v_s"},
    {"law", "delta deltas", "exponent"},
    {"law", "eta", "viscous"},
    {"law", "frictioncoefficient", "mu"},
    {"law", "fs fc fk fcoulomb fstatic fbrk breakawayfrictionforce coulombfrictionforce", "mu_d",
     "is a force: give coefficients, force over normal load, as law.mu_s (at rest) and law.mu_d (in motion)"},
    {"law", "fv viscousfrictioncoefficient", "viscous",
     "is force over speed: give law.viscous (s/m), that over the normal load"},
    {"law", "dc decaycoefficient", "exponent",
     "is a decay coefficient: give law.exponent = 1 and law.v_s = 1/d_c (m/s)"},
    {"law", "vbrk breakawayfrictionvelocity", "v_s", "is not a Stribeck speed: give law.v_s = v_brk √2 (m/s)"},
    {"law", "A B", "a", "may be a stress, a or b times the normal stress: give law.a and law.b, without dimension"},
    {"law", "aminusb amb", "a", "leaves the direct effect open: give law.a and law.b themselves"},
    {"law", "bminusa bma", "a", "leaves the direct effect open: give law.a and law.b themselves"},
    {"law", "alpha linkerdieterich", "", "is that of a memory of the load: give law.load_memory = { alpha = … }"},
    {"law", "kt tangentialstiffness", "",
     "is that of a spring in series: give law.contact_stiffness = { tangential = … }"},
    {"law", "k stiffness kc kcrit criticalstiffness", "",
     "is no property of the law: give oscillator.stiffness (N/m); the critical one is an answer of 'rosin stability'"},
    {"law", "sigma sigman normalstress normalforce load", "",
     "is no property of the law: give drive.normal_load (N), or a stress there and oscillator.area (m²)"},
    {"law", "theta thetainit theta0 thetai", "", "is a state, whose start is run.start = { theta = … }"},

    {"oscillator", "m", "mass"},
    {"oscillator", "k spring springconstant springstiffness", "stiffness"},
    {"oscillator", "c dashpot dampingcoefficient", "damping"},
    {"oscillator", "zeta dampingratio", "damping", "is a damping ratio: give oscillator.damping = 2 ζ √(k m) (N s/m)"},
    {"oscillator", "omega omega0 omegan naturalfrequency f0 fn", "stiffness",
     "is a frequency: give oscillator.stiffness = m ω² (N/m), with ω in rad/s"},
    {"oscillator", "kc kcrit criticalstiffness", "stiffness", "is an answer of 'rosin stability', not a setting"},
    {"drive", "v vlp vl vload vw velocity loadingvelocity loadingrate loadpointvelocity beltspeed", "speed"},
    {"drive", "n fn normalforce load", "normal_load"},
    {"drive", "sigma sigman normalstress pressure", "normal_load",
     "is a stress: give it as drive.normal_load = \"5 MPa\", say, and the area as oscillator.area (m²)"},
    {"drive", "f externalforce", "force"},
    {"run", "tend tfinal tmax stoptime", "duration"},
};

constexpr std::string_view keys_of_laws[] = {
    "type", "preset", "lambda", "formula", "heating", "contact_stiffness", "load_memory"};

/// Letters as they are written, and their names.
constexpr std::pair<std::string_view, std::string_view> letters_by_name[] = {
    {"α", "alpha"}, {"β", "beta"},  {"γ", "gamma"},  {"δ", "delta"}, {"ε", "epsilon"}, {"ζ", "zeta"},   {"η", "eta"},
    {"θ", "theta"}, {"κ", "kappa"}, {"λ", "lambda"}, {"μ", "mu"},    {"µ", "mu"},      {"ν", "nu"},     {"ρ", "rho"},
    {"σ", "sigma"}, {"τ", "tau"},   {"φ", "phi"},    {"ψ", "psi"},   {"ω", "omega"},   {"Λ", "lambda"}, {"₀", "0"},
    {"₁", "1"},     {"₂", "2"},     {"₃", "3"},      {"ₛ", "s"},     {"ᵣ", "r"}};

/// In lower case, without what only separates, and Greek letters by their names: "D_c" and "dc" are one word, as "μ_s"
/// and "mus".
std::string plain(std::string_view word) {
  std::string letters;
  while (!word.empty()) {
    const auto* found =
        std::ranges::find_if(letters_by_name, [&](const auto& one) { return word.starts_with(one.first); });
    if (found != std::end(letters_by_name)) {
      letters += found->second;
      word.remove_prefix(found->first.size());
      continue;
    }
    const auto c = static_cast<unsigned char>(word.front());
    if (std::string_view("_- ").find(char(c)) == std::string_view::npos) letters += char(std::tolower(c));
    word.remove_prefix(1);
  }
  return letters;
}

/// What a key is called by its table.
struct OwnName {
  std::string name;
  std::string_view advice = {};
};

/// Nothing for a key that is an own name, or that nobody knows.
std::optional<OwnName> own_name(std::string_view table, const std::string& key, const std::vector<std::string>& own) {
  if (std::ranges::find(own, key) != own.end()) return std::nullopt;
  const auto word = plain(key);
  if (word.empty()) return std::nullopt;
  const auto find = [&](bool as_it_stands) -> std::optional<OwnName> {
    for (const auto& alias : aliases) {
      if (alias.table != table) continue;
      if (!alias.own.empty() && std::ranges::find(own, alias.own) == own.end()) continue;
      std::istringstream words{std::string(alias.words)};
      for (std::string one; words >> one;)
        if (one == (as_it_stands ? key : word) && as_it_stands == (plain(one) != one))
          return OwnName{std::string(alias.own), alias.advice};
    }
    return std::nullopt;
  };
  if (auto exact = find(true)) return exact;
  const auto same = [&](const std::string& name) { return plain(name) == word; };
  if (std::ranges::count_if(own, same) == 1) return OwnName{*std::ranges::find_if(own, same)};
  return find(false);
}

/// Keys of a table that aliases are known for, with their units.
using Keys = std::map<std::string, std::string>;

std::vector<std::string> names_of(const Keys& keys) {
  std::vector<std::string> names;
  for (const auto& [name, unit] : keys) names.push_back(name);
  return names;
}

/// Of a law with all its options; empty for a law from text, whose names are the user's, and for one that is not known.
Keys keys_of_law(std::string_view type) {
  Keys keys;
  for (const auto& law : laws::catalogue()) {
    const auto& card = law->card();
    if (card.name != type && card.option.of != type) continue;
    for (const auto& parameter : law->parameters()) keys[parameter.name] = parameter.unit;
    if (const auto both = laws::one_coefficient_of(*law)) keys[both->name] = both->unit;
    if (card.option.of == type) keys[std::string(card.option.key)] = "1";
  }
  if (!keys.empty())
    for (const auto key : keys_of_laws) keys[std::string(key)] = "1";
  return keys;
}

Keys keys_of_slider(std::string_view table) {
  if (table == "oscillator")
    return {{"type", "1"},        {"mass", "kg"}, {"stiffness", "N/m"},
            {"damping", "N s/m"}, {"stops", "m"}, {"restitution", "1"}};
  if (table == "drive") return {{"speed", "m/s"}, {"normal_load", "N"}, {"force", "N"}};
  return {{"duration", "s"}, {"times", "s"}, {"samples", "1"}, {"start", "1"}};
}

class Walk {
 public:
  Walk(toml::table& scene, std::vector<std::string>& notes) : scene_(scene), notes_(notes) {}

  void go() {
    name_laws(scene_, "");
    const auto* type = scene_.at_path("oscillator.type").as_string();
    const bool slider = !type || type->get() == "slider" || type->get() == "plane-slider";
    for (const char* name : {"oscillator", "drive", "run"})
      if (auto* table = scene_.get_as<toml::table>(name); table && (slider || name == std::string_view("run")))
        rename(*table, name, name, keys_of_slider(name));
    name_paths(scene_, {});
  }

 private:
  void note(std::string text) {
    if (std::ranges::find(notes_, text) == notes_.end()) notes_.push_back(std::move(text));
  }

  static bool is_override(const toml::node& node) { return place(node.source()).starts_with(override_mark); }

  void rename(toml::table& table, std::string_view kind, const std::string& path, const Keys& keys) {
    if (keys.empty()) return;
    const auto own = names_of(keys);
    std::vector<std::string> given;
    for (const auto& [key, node] : table) given.emplace_back(key.str());
    for (const auto& key : given) {
      const auto found = own_name(kind, key, own);
      if (!found) continue;
      auto& node = *table.get(key);
      if (!found->advice.empty()) fail(node.source(), "{}.{} {}", path, key, found->advice);
      if (table.contains(found->name) && !is_override(node))
        fail(node.source(), "{0}.{1} means {0}.{2}, which is given too: leave one of them out", path, key, found->name);
      const auto& unit = keys.at(found->name);
      note(fmt::format("{0}.{1} is read as {0}.{2}{3}", path, key, found->name,
                       unit == "1" ? "" : fmt::format(" ({})", readable_unit(unit))));
      node.visit([&](auto& value) { table.insert_or_assign(found->name, std::move(value)); });
      table.erase(key);
    }
  }

  /// law.mu becomes the coefficients that it stands for.
  void give_at_once(toml::table& law, const std::string& path, const Keys& keys) {
    const std::string key(laws::one_coefficient);
    const auto* node = law.get(key);
    if (!node || !keys.contains(key)) return;
    for (const auto parameter : laws::rest_and_motion) {
      const std::string name(parameter);
      if (law.contains(name) && !is_override(*node))
        fail(node->source(), "{0}.{1} is {0}.{2} and {0}.{3} at once, which is given too: leave {0}.{1} or {0}.{4} out",
             path, key, laws::rest_and_motion[0], laws::rest_and_motion[1], name);
      law.get(key)->visit([&](const auto& value) { law.insert_or_assign(name, value); });
    }
    note(fmt::format("{0}.{1} is {0}.{2} and {0}.{3} at once", path, key, laws::rest_and_motion[0],
                     laws::rest_and_motion[1]));
    law.erase(key);
  }

  /// Every law at or below this node.
  void name_laws(toml::node& node, const std::string& path) {
    const auto below = [&](std::string_view key) {
      return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
    };
    if (auto* list = node.as_array()) {
      for (std::size_t i = 0; i < list->size(); ++i) name_laws(*list->get(i), below(std::to_string(i + 1)));
    } else if (auto* table = node.as_table()) {
      for (auto&& [key, inner] : *table) {
        name_laws(inner, below(key.str()));
        if (key.str() != "law" || !inner.is_table()) continue;
        auto& law = *inner.as_table();
        auto* type = law.get_as<std::string>("type");
        if (!type) continue;
        const auto name = located(type->source(), [&] { return law_called(type->get()); });
        if (name != type->get()) {
          note(fmt::format("{}.type = '{}' is read as '{}'", below("law"), type->get(), name));
          type->get() = name;
        }
        const auto keys = keys_of_law(name);
        rename(law, "law", below("law"), keys);
        if (keys.contains(std::string(laws::rest_and_motion[0]))) give_at_once(law, below("law"), keys);
      }
    }
  }

  /// The own name of a path such as "law.D_c" or "oscillator.contacts.1.law.D_c"; nothing if it has no other.
  /// \param law of the table that the path stands in, if it has one of its own
  std::optional<std::string> own_path(const std::string& path, const toml::table* law, const toml::node& source) const {
    const auto dot = path.rfind('.');
    if (dot == std::string::npos || path.find_first_of(" \n") != std::string::npos) return std::nullopt;
    const auto table = path.substr(0, dot), key = path.substr(dot + 1);
    const auto last = table.substr(table.rfind('.') + 1);
    Keys keys;
    if (last == "law") {
      const auto* at = node_at(scene_, table);
      if (!at) at = node_at(scene_, "oscillator." + table);  // contacts go by their short name too
      const auto* named = table == "law" && law ? law : at ? at->as_table() : nullptr;
      const auto* type = named ? named->get_as<std::string>("type") : nullptr;
      if (type) keys = keys_of_law(type->get());
    } else if (table == "oscillator" || table == "drive") {
      keys = keys_of_slider(table);
    }
    if (keys.empty()) return std::nullopt;
    const auto found = own_name(last, key, names_of(keys));
    if (!found) return std::nullopt;
    if (!found->advice.empty()) fail(source.source(), "{} {}", path, found->advice);
    return fmt::format("{}.{}", table, found->name);
  }

  /// Texts, and keys of tables, that are paths.
  void name_paths(toml::node& node, const toml::table* law) {
    if (auto* text = node.as_string()) {
      if (const auto own = own_path(text->get(), law, node)) {
        note(fmt::format("{} is read as {}", text->get(), *own));
        text->get() = *own;
      }
    } else if (auto* list = node.as_array()) {
      for (auto& element : *list) name_paths(element, law);
    } else if (auto* table = node.as_table()) {
      if (const auto* own = table->get_as<toml::table>("law")) law = own;
      std::vector<std::string> keys;
      for (const auto& [key, inner] : *table) keys.emplace_back(key.str());
      for (const auto& key : keys) {
        auto& inner = *table->get(key);
        name_paths(inner, law);
        const auto own = own_path(key, law, inner);
        if (!own) continue;
        note(fmt::format("{} is read as {}", key, *own));
        inner.visit([&](auto& value) { table->insert_or_assign(*own, std::move(value)); });
        table->erase(key);
      }
    }
  }

  toml::table& scene_;
  std::vector<std::string>& notes_;
};

}  // namespace

std::string law_called(std::string_view name) {
  std::vector<std::string> known = {"formula"};
  for (const auto& law : laws::catalogue()) known.emplace_back(law->card().name);
  const std::string given(name);
  const auto found = own_name("law.type", given, known);
  if (!found) return given;
  if (!found->advice.empty()) throw InputError(fmt::format("'{}' {}", name, found->advice));
  return found->name;
}

void resolve_aliases(toml::table& scene, std::vector<std::string>& notes) { Walk(scene, notes).go(); }

}  // namespace rosin::app::scene
