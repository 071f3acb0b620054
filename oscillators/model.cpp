/// Paths into a model: describing, reading and changing each of its numbers, and checking that its parts fit together.
#include "oscillators/model.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "laws/one_coefficient.hpp"
#include "laws/wrappers.hpp"

namespace rosin::oscillators {

namespace {

/// A parameter that does not belong to a law: how it is described, read and changed.
struct Entry {
  Quantity quantity;
  double (*get)(const Model&);
  void (*set)(Model&, double);
};

constexpr std::string_view lambda_path = "law.lambda", load_memory_path = "law.load_memory.alpha";

const std::vector<Entry>& entries() {
  // Products of a few of them must stay within the range of numbers.
  constexpr double smallest = 1e-60, largest = 1e60;
  constexpr Range positive{0, 1e15, smallest}, force{-1e15, 1e15, smallest};
  constexpr Range stiffness{0, infinity, smallest, largest}, contact_stiffness{1e-12, infinity, 0, largest};
  static const std::vector<Entry> list = {
      {{"law.lambda", "1", positive, "clock factor of the law's states; 0: friction curve"},
       [](const Model& m) { return m.lambda; },
       [](Model& m, double x) { m.lambda = x; }},
      {{"law.contact_stiffness.tangential", "N/m", contact_stiffness, "tangential stiffness of the contact"},
       [](const Model& m) { return m.contact_stiffness.tangential; },
       [](Model& m, double x) { m.contact_stiffness.tangential = x; }},
      {{"law.contact_stiffness.per_load", "1/m", contact_stiffness,
        "tangential stiffness of the contact per unit load"},
       [](const Model& m) { return m.contact_stiffness.per_load; },
       [](Model& m, double x) { m.contact_stiffness.per_load = x; }},
      {{"law.contact_stiffness.damping", "N s/m", positive, "damping beside the contact's tangential stiffness"},
       [](const Model& m) { return m.contact_stiffness.damping; },
       [](Model& m, double x) { m.contact_stiffness.damping = x; }},
      {{"law.contact_stiffness.damping_per_load", "s/m", positive,
        "damping beside the contact's tangential stiffness, per unit load"},
       [](const Model& m) { return m.contact_stiffness.damping_per_load; },
       [](Model& m, double x) { m.contact_stiffness.damping_per_load = x; }},
      {{std::string(load_memory_path), "1", {0, 1}, "how much friction falls at once per e-fold of the load"},
       [](const Model& m) { return m.load_memory; },
       [](Model& m, double x) { m.load_memory = x; }},
      {{"oscillator.mass", "kg", {0, 1e12, smallest}, "mass of the slider; 0: quasi-static"},
       [](const Model& m) { return m.slider.mass; },
       [](Model& m, double x) { m.slider.mass = x; }},
      {{"oscillator.stiffness", "N/m", stiffness, "stiffness of the spring; infinite: imposed slip rate"},
       [](const Model& m) { return m.slider.stiffness; },
       [](Model& m, double x) { m.slider.stiffness = x; }},
      {{"oscillator.damping", "N s/m", positive, "damping of the slider's motion"},
       [](const Model& m) { return m.slider.damping; },
       [](Model& m, double x) { m.slider.damping = x; }},
      {{"drive.speed", "m/s", {-1e4, 1e4, smallest}, "speed of the driving surface"},
       [](const Model& m) { return m.drive.speed.level(); },
       [](Model& m, double x) { m.drive.speed = m.drive.speed.with_level(x); }},
      {{"drive.normal_load", "N", positive, "normal load"},
       [](const Model& m) { return m.drive.normal_load.level(); },
       [](Model& m, double x) { m.drive.normal_load = m.drive.normal_load.with_level(x); }},
      {{"drive.force", "N", force, "force on the slider, along its displacement"},
       [](const Model& m) { return m.drive.force.level(); },
       [](Model& m, double x) { m.drive.force = m.drive.force.with_level(x); }},
  };
  return list;
}

/// The entry of a path, or nullptr. λ and load memory are parameters only of laws with states.
const Entry* find_entry(const Model& model, std::string_view path) {
  if ((path == lambda_path || path == load_memory_path) && !model.law->has_states()) return nullptr;
  for (const auto& entry : entries())
    if (entry.quantity.name == path) return &entry;
  return nullptr;
}

/// The index of the law's parameter that a path names, if it is a number and not a list.
std::optional<std::size_t> find_in_law(const Model& model, std::string_view path) {
  if (!path.starts_with("law.")) return std::nullopt;
  const auto index = model.law->find(path.substr(4));
  if (!index || model.law->parameters()[*index].is_list) return std::nullopt;
  return index;
}

/// law.mu, of laws with a coefficient at rest and another in motion: both at once.
std::optional<Quantity> find_one_coefficient(const Model& model, std::string_view path) {
  const auto both = laws::one_coefficient_of(*model.law);
  return both && path == "law." + both->name ? both : std::nullopt;
}

Quantity with_path(Quantity quantity) {
  quantity.name = "law." + quantity.name;
  return quantity;
}

[[noreturn]] void refuse_path(const Model& model, std::string_view path) {
  std::vector<std::string> known;
  for (const auto& quantity : model.parameters()) known.push_back(quantity.name);
  const auto near = nearest_name(path, known);
  throw InputError(fmt::format("unknown parameter '{}' of a slider with law '{}'{}", path, model.law->card().name,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}

}  // namespace

const std::vector<Quantity>& mechanical_parameters() {
  static const std::vector<Quantity> list = [] {
    std::vector<Quantity> quantities;
    for (const auto& entry : entries()) quantities.push_back(entry.quantity);
    return quantities;
  }();
  return list;
}

std::vector<Quantity> Model::parameters() const {
  std::vector<Quantity> list;
  for (const auto& parameter : law->parameters())
    if (!parameter.is_list) list.push_back(with_path(parameter));
  for (const auto& quantity : mechanical_parameters())
    if (find_entry(*this, quantity.name)) list.push_back(quantity);
  return list;
}

Quantity Model::describe(std::string_view path) const {
  if (const auto index = find_in_law(*this, path)) return with_path(law->parameters()[*index]);
  if (const auto* entry = find_entry(*this, path)) return entry->quantity;
  if (const auto both = find_one_coefficient(*this, path)) return with_path(*both);
  refuse_path(*this, path);
}

double Model::get(std::string_view path) const {
  if (const auto index = find_in_law(*this, path)) return std::get<double>(law->values()[*index]);
  if (const auto* entry = find_entry(*this, path)) return entry->get(*this);
  if (find_one_coefficient(*this, path)) return law->parameter(laws::rest_and_motion.back());
  refuse_path(*this, path);
}

Model Model::with(std::string_view path, double value) const {
  const auto quantity = describe(path);
  require(value, quantity.range, quantity.name, quantity.meaning, quantity.unit);
  Model changed = *this;
  if (const auto index = find_in_law(*this, path))
    changed.law = law->with(law->parameters()[*index].name, value);
  else if (const auto* entry = find_entry(*this, path))
    entry->set(changed, value);
  else
    changed.law = laws::with_one_coefficient(*law, value);
  return changed;
}

void Model::check() const {
  if (!law) throw InputError("the model has no friction law");
  for (const auto& quantity : mechanical_parameters()) {
    if (!find_entry(*this, quantity.name)) continue;
    require(get(quantity.name), quantity.range, quantity.name, quantity.meaning, quantity.unit);
  }
  const auto name = law->card().name;
  if (slider.mass == 0 && law->set_valued()) {
    if (std::isfinite(slider.stiffness))
      throw InputError(
          fmt::format("oscillator.mass = 0 does not go with law '{}', whose force at rest is any value up to "
                      "its limit: a slider without mass would have to jump at slip; give it a mass, or impose the slip "
                      "rate with oscillator.stiffness = inf",
                      name));
    if (drive.speed.direction() == 0)
      throw InputError(
          fmt::format("oscillator.stiffness = inf imposes the slip rate, and drive.speed reaches or passes 0 (m/s), "
                      "where the force of law '{}' is any value up to its limit; give the slider a spring and a mass",
                      name));
  }
  if (slider.mass > 0 && std::isinf(slider.stiffness))
    throw InputError("oscillator.stiffness = inf imposes the slip rate and needs oscillator.mass = 0");
  if (slider.mass == 0 && slider.stiffness == 0 && slider.damping == 0)
    throw InputError(
        "oscillator: mass, stiffness and damping are all 0, so that nothing resists the friction force; "
        "give one of them a value");
  const auto& contact = contact_stiffness;
  if (std::isfinite(contact.tangential) && std::isfinite(contact.per_load))
    throw InputError("law.contact_stiffness: give tangential or per_load, not both");
  if (contact.damping > 0 && contact.damping_per_load > 0)
    throw InputError("law.contact_stiffness: give damping or damping_per_load, not both");
  if (contact.damped() && !contact.present())
    throw InputError(
        "law.contact_stiffness: damping without a spring beside it has no meaning; give tangential (N/m) or "
        "per_load (1/m)");
  if (const auto why = laws::refusal_of_spring(*law, contact.damped()); contact.present() && !why.empty())
    throw InputError(fmt::format("law.contact_stiffness does not go with law '{}'{}", name, why));
  const bool damped = slider.damping > 0 || (contact.damped() && std::isfinite(slider.stiffness));
  if (slider.mass == 0 && !law->has_slip_rate() && damped)
    throw InputError(fmt::format(
        "law '{}' cannot be solved for the slip rate: without mass it goes with springs alone, not with {}; "
        "give the slider a mass",
        name, slider.damping > 0 ? "oscillator.damping" : "a damped law.contact_stiffness"));
}

}  // namespace rosin::oscillators
