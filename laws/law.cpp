/// Looking up parameters by name, and the checks that every law makes of its values and answers.
#include "laws/law.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "laws/wrappers.hpp"

namespace rosin {

bool FrictionLaw::deflects() const {
  return std::any_of(states().begin(), states().end(), [](const auto& s) { return s.parity == Parity::odd; });
}

std::string laws::refusal_of_spring(const FrictionLaw& law, bool damped) {
  if (!law.set_valued()) return "";
  const auto friction = law.linear();
  if (law.has_states() || !friction || friction->slope != 0)
    return ", which is set-valued at rest and changes with slip: behind a spring, whose end has no mass, only dry "
           "friction of one coefficient at all slip rates (coulomb) has a slip rate; 'dahl' and 'lugre' are such laws "
           "with an elastic contact";
  if (const double at_rest = law.static_limit(1); !damped && at_rest != friction->constant)
    return fmt::format(
        " where mu_s = {:.9g} is above mu_d = {:.9g}: the end of the spring has no mass, and slip would begin with a "
        "jump; give mu_s = mu_d (a Jenkins element), or a damper beside the spring (law.contact_stiffness.damping)",
        at_rest, friction->constant);
  return "";
}

std::optional<std::size_t> FrictionLaw::find(std::string_view parameter) const {
  const auto& list = parameters();
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i].name == parameter) return i;
  return std::nullopt;
}

namespace {
std::size_t index_or_throw(const FrictionLaw& law, std::string_view parameter) {
  if (const auto i = law.find(parameter)) return *i;
  std::vector<std::string> known;
  for (const auto& p : law.parameters()) known.push_back(p.name);
  const auto near = nearest_name(parameter, known);
  throw InputError(fmt::format("law '{}' has no parameter '{}'{}", law.card().name, parameter,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}
}  // namespace

double FrictionLaw::parameter(std::string_view name) const {
  const auto& value = values()[index_or_throw(*this, name)];
  if (const double* x = std::get_if<double>(&value)) return *x;
  throw InputError(fmt::format("parameter '{}' of law '{}' is a list", name, card().name));
}

std::shared_ptr<const FrictionLaw> FrictionLaw::with(std::string_view name, Value value) const {
  auto changed = values();
  changed[index_or_throw(*this, name)] = std::move(value);
  return with(std::move(changed));
}

namespace {
/// The states that answer to load memory: those that are carried as logarithms, a contact's ages and areas.
std::vector<int> remembering(const FrictionLaw& law) {
  std::vector<int> list;
  for (std::size_t i = 0; i < law.states().size(); ++i)
    if (law.states()[i].scale == Scale::log) list.push_back(int(i));
  if (list.empty() || law.set_valued())
    throw InputError(
        fmt::format("law.load_memory needs a state that stands for the contact's age or area, and law '{}' has none",
                    law.card().name));
  return list;
}
void require_spring(const FrictionLaw& law, const ContactSetup& setup) {
  const bool damped = setup.spring.damping > 0 || setup.spring.damping_per_load > 0;
  if (const auto why = laws::refusal_of_spring(law, damped); !why.empty())
    throw InputError(fmt::format("law.contact_stiffness does not go with law '{}'{}", law.card().name, why));
}
/// Lanes and towers follow no modes of stick and slip.
void require_smooth(const FrictionLaw& law) {
  if (law.set_valued())
    throw InputError(
        fmt::format("law '{}' behind a contact spring is asked one contact at a time, without higher derivatives",
                    law.card().name));
}
}  // namespace

std::unique_ptr<Contact<double>> FrictionLaw::contact(const ContactSetup& setup) const {
  auto contact = bare_contact(setup);
  if (setup.load_memory > 0 && setup.lambda > 0)
    contact = laws::with_load_memory(std::move(contact), bare_contact({.unknowns = Unknowns::states}),
                                     remembering(*this), setup);
  if (!setup.spring.present()) return contact;
  require_spring(*this, setup);
  return set_valued() ? laws::dry_behind_spring(std::move(contact), setup)
                      : laws::behind_spring(std::move(contact), setup);
}
std::unique_ptr<Contact<Lanes>> FrictionLaw::lanes(const ContactSetup& setup) const {
  auto contact = bare_lanes(setup);
  if (setup.spring.present()) require_smooth(*this), contact = laws::behind_spring(std::move(contact), setup);
  return contact;
}
std::unique_ptr<ContactValues<Tower>> FrictionLaw::tower(const ContactSetup& setup, const ContactChange& change) const {
  auto contact = bare_tower(setup, change);
  if (setup.spring.present())
    require_smooth(*this), contact = laws::behind_spring(std::move(contact), setup, change.setup.spring);
  return contact;
}

namespace laws {

void refuse_flow(const Card& card) {
  throw InputError(
      fmt::format("law '{}' has no explicit slip rate: its contact cannot be followed as a flow", card.name));
}

double finite_answer(const Card& card, std::string_view question, Sliding<double> at, double x) {
  if (!std::isfinite(x))
    throw InputError(fmt::format("the {} of law '{}' is not finite at slip rate {} m/s and normal load {} N", question,
                                 card.name, at.slip_rate, at.normal_load));
  return x;
}

void check_parameters(const Card& card, std::span<const Quantity> fields, std::span<const Value> values) {
  if (values.size() != fields.size())
    throw InputError(fmt::format("law '{}' takes {} parameters, got {}", card.name, fields.size(), values.size()));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto path = fmt::format("law.{}", fields[i].name);
    if (std::holds_alternative<double>(values[i]) == fields[i].is_list)
      throw InputError(fmt::format("{} must be {}", path, fields[i].is_list ? "a list of numbers" : "a number"));
    if (fields[i].is_list)
      for (const double x : std::get<std::vector<double>>(values[i]))
        require(x, fields[i].range, path, fields[i].meaning, fields[i].unit);
    else
      require(std::get<double>(values[i]), fields[i].range, path, fields[i].meaning, fields[i].unit);
  }
}

}  // namespace laws
}  // namespace rosin
