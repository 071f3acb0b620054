/// A structure by its matrices, and what all structures share.
#include "app/scene/structure.hpp"

#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/motion/structure_record.hpp"
#include "app/scene/law.hpp"
#include "app/scene/matrix_file.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/profile.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/signal.hpp"
#include "app/scene/start.hpp"
#include "laws/regions.hpp"

namespace rosin::app::scene {

using oscillators::contact_of;
using oscillators::FrictionContact;
using oscillators::Structure;

std::vector<double> one_or_list(Table& table, std::string_view key, std::size_t size, Quantity quantity, double usual) {
  quantity.name = table.path(key);
  const auto* node = table.find(key);
  if (!node) {
    NumbersAsked::note(quantity);
    return std::vector<double>(size, usual);
  }
  if (!node->is_array()) return std::vector<double>(size, number(*node, quantity));
  auto values = numbers(*node, quantity);
  if (values.size() != size)
    fail(node->source(), "{} has {} entries, but {} are needed, or one number for all", quantity.name, values.size(),
         size);
  return values;
}

void read_structure_drive(SceneReader& reader, Table table, bool complete, bool takes_force) {
  if (const auto* force = takes_force ? nullptr : table.find("force"))
    fail(force->source(), "drive.force has no place on this oscillator; type 'structure' takes oscillator.force");
  read_drive(reader, std::move(table), complete);
}

void read_drive_of_one(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, drive, complete, true);
  auto& structure = reader.scene.structure->structure;
  const auto& own = reader.scene.model.drive;
  structure.contacts[0].speed = own.speed, structure.contacts[0].normal_load = own.normal_load;
  structure.force[0] = own.force;
}

void read_contact(SceneReader& reader, Table& table, FrictionContact& contact) {
  if (const auto* law = table.find("law")) {
    oscillators::Model own;
    read_law(reader, Table(*law, table.path("law")), own);
    own.drive.speed = contact.speed, own.drive.normal_load = contact.normal_load;
    auto changed = contact_of(own);
    changed.tangential = contact.tangential;
    changed.normal = contact.normal, changed.gap = contact.gap, changed.normal_law = contact.normal_law;
    contact = std::move(changed);
  }
  const auto signal = [&](std::string_view key, Signal& into) {
    auto quantity = mechanical(fmt::format("drive.{}", key));
    quantity.name = table.path(key);
    if (const auto* node = table.find(key)) into = read_signal(*node, quantity, reader.folder);
  };
  signal("speed", contact.speed);
  const auto *load = table.find("normal_load"), *factor = table.find("load_factor");
  if (load && factor)
    fail(factor->source(), "{}: give normal_load or load_factor, not both", table.path("load_factor"));
  signal("normal_load", contact.normal_load);
  table.read("load_factor", contact.load_factor, {"", "1", {0, 1e12}, "load of this contact over drive.normal_load"});
}

void read_truth(Table& table, std::string_view key, bool& target) {
  const auto* node = table.find(key);
  if (node && !node->is_boolean()) wrong_kind(*node, table.path(key), "true or false");
  if (node) target = *node->value<bool>();
}

namespace {

std::shared_ptr<const NormalLaw> read_linear_contact(Table table) {
  laws::LinearContact law;
  table.expect({"stiffness", "cubic", "damping", "lift_off"});
  table.required("stiffness", "N/m; or the coefficient and exponent of a power law");
  std::apply(
      [&](const auto&... field) {
        (table.read(field.name, law.*field.member,
                    {"", std::string(field.unit), field.range, std::string(field.meaning)}),
         ...);
      },
      laws::LinearContact::parameters);
  read_truth(table, "lift_off", law.lift_off);
  table.finish();
  return laws::normal_law(law);
}

std::shared_ptr<const NormalLaw> read_power_contact(Table table, bool per_area) {
  laws::PowerContact law;
  table.expect({"coefficient", "stiffness", "exponent", "damping", "separation_damping", "damping_exponent", "adhesion",
                "bound", "bound_coefficient", "bound_exponent"});
  constexpr Range any_size{0, 1e60};
  const auto over_approach = [&](const char* force, double exponent) {
    const double power = exponent + (per_area ? 2 : 0);
    return power == 0 ? std::string(force) : fmt::format("{}/m^{}", force, power);
  };
  const auto read_exponent = [&](std::string_view key, double& target, Range range, const char* of) {
    table.read(key, target, {"", "1", range, fmt::format("exponent of the {}", of)});
  };
  read_exponent("exponent", law.exponent, laws::PowerContact::exponents, "contact's pressure");
  // A stiffness alone is a coefficient with the exponent 1.
  const auto* stiffness = table.find("stiffness");
  for (const auto key : {"coefficient", "exponent"})
    if (const auto* node = stiffness ? table.find(key) : nullptr)
      fail(node->source(), "{}: give stiffness, or coefficient and exponent", table.path(key));
  const char* key = stiffness ? "stiffness" : "coefficient";
  const auto& coefficient = table.required(key, over_approach("N", law.exponent));
  table.read(key, law.coefficient,
             {"", over_approach("N", law.exponent), {1e-30, 1e60}, "pressure over the approach to its exponent"});
  law.damping_exponent = law.exponent;
  read_exponent("damping_exponent", law.damping_exponent, laws::PowerContact::damping_exponents, "contact's damping");
  const auto unit_of_damping = over_approach("N s", law.damping_exponent + 1);
  table.read("damping", law.damping, {"", unit_of_damping, any_size, "damping of the contact on approach"});
  law.separation_damping = law.damping;
  table.read("separation_damping", law.separation_damping,
             {"", unit_of_damping, any_size, "damping of the contact on separation"});
  const bool damped = law.damping > 0 || law.separation_damping > 0;
  for (const auto key : {"damping_exponent", "adhesion", "bound"})
    if (const auto* node = table.find(key); node && !damped)
      fail(node->source(), "{} has no effect on a contact without damping", table.path(key));
  read_truth(table, "adhesion", law.adhesion);
  if (const auto* bound = table.find("bound"))
    law.bound_of_pressure = choice(*bound, table.path("bound"), {"elastic", "pressure"}) == "pressure";
  law.bound_exponent = law.exponent, law.bound_coefficient = law.coefficient;
  read_exponent("bound_exponent", law.bound_exponent, laws::PowerContact::exponents, "bound of friction");
  const auto *bound_coefficient = table.find("bound_coefficient"), *bound_exponent = table.find("bound_exponent");
  if ((bound_coefficient == nullptr) != (bound_exponent == nullptr))
    fail(table.source(),
         "{} and bound_exponent go together: friction is the law's coefficient times the one, times the "
         "approach to the other",
         table.path("bound_coefficient"));
  if (bound_coefficient && law.bound_of_pressure)
    fail(bound_coefficient->source(), "{} has no effect where the bound is the pressure",
         table.path("bound_coefficient"));
  table.read(
      "bound_coefficient", law.bound_coefficient,
      {"", over_approach("N", law.bound_exponent), any_size, "bound of friction over the approach to its exponent"});
  table.finish();
  return located(coefficient.source(), [&] { return laws::normal_law(law); });
}

}  // namespace

std::shared_ptr<const NormalLaw> read_normal_law(Table table, bool per_area) {
  return table.find("coefficient") || per_area ? read_power_contact(std::move(table), per_area)
                                               : read_linear_contact(std::move(table));
}

namespace {

constexpr Range any_number{-1e15, 1e15};

void read_structure(SceneReader& reader, Table table, bool) {
  auto& structure = reader.scene.structure.emplace().structure;
  table.expect({"type", "M", "C", "K", "contacts", "force", "stops"});
  table.find("type");
  const auto matrix = [&](const toml::node& node, const char* key, const char* unit, const char* meaning) {
    return read_matrix(node, {table.path(key), unit, any_number, meaning}, structure.M.rows(), reader.folder);
  };
  structure.M = matrix(table.required("M", "mass matrix, kg"), "M", "kg", "mass");
  const auto n = structure.M.rows();
  structure.K = matrix(table.required("K", "stiffness matrix, N/m"), "K", "N/m", "stiffness");
  structure.C = Eigen::MatrixXd::Zero(n, n);
  if (const auto* C = table.find("C")) structure.C = matrix(*C, "C", "N s/m", "damping");
  for (Eigen::Index i = 0; i < n; ++i) structure.names.push_back(fmt::format("displacement_{}", i + 1));
  table.required("contacts", "tables [[oscillator.contacts]] with a tangential direction");
  if (const auto* force = table.find("force")) {
    const auto& signals = list(*force, table.path("force"), "signals", most_names);
    if (Eigen::Index(signals.size()) != n)
      fail(force->source(), "{} has {} entries for {} coordinates", table.path("force"), signals.size(), n);
    auto quantity = mechanical("drive.force");
    quantity.name = table.path("force");
    for (const auto& signal : signals) structure.force.push_back(read_signal(signal, quantity, reader.folder));
  }
  read_stops(reader, table);
  table.finish();
}

/// support and centre of a contact.
std::optional<FrictionContact::Ring> read_ring(Table& table) {
  const auto *support = table.find("support"), *centre = table.find("centre");
  const bool is_ring = support && choice(*support, table.path("support"), {"flat", "ring"}) == "ring";
  if (centre && !is_ring)
    fail(centre->source(), "{} goes with support = \"ring\", whose centre it is", table.path("centre"));
  if (!is_ring) return std::nullopt;
  FrictionContact::Ring ring;
  if (!centre) return ring;
  const auto place = numbers(*centre, {table.path("centre"), "m", any_number, "centre of the ring"});
  if (place.size() != 2)
    fail(centre->source(), "{} has {} entries, but 2 are needed: along normal and along tangential",
         table.path("centre"), place.size());
  std::ranges::copy(place, ring.centre);
  return ring;
}

/// Contacts come after the drive, which says what they do not.
void read_drive_and_contacts(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, drive, complete, false);
  auto& structure = reader.scene.structure->structure;
  const auto& contacts = *reader.document.at_path("oscillator.contacts").node();
  for (const auto& element : list(contacts, "oscillator.contacts", "tables", most_names)) {
    Table table(element, fmt::format("oscillator.contacts.{}", structure.contacts.size() + 1));
    table.expect({"tangential", "normal", "normal_contact", "gap", "support", "centre", "profile", "law", "speed",
                  "normal_load", "load_factor"});
    const auto read_direction = [&](const toml::node& node, std::string_view key,
                                    const char* meaning) -> Eigen::VectorXd {
      const auto entries = numbers(node, {table.path(key), "1", any_number, meaning});
      if (int(entries.size()) != structure.size())
        fail(node.source(), "{} has {} entries for {} coordinates", table.path(key), entries.size(), structure.size());
      return Eigen::Map<const Eigen::VectorXd>(entries.data(), structure.size());
    };
    const auto *normal = table.find("normal"), *answer = table.find("normal_contact");
    if ((normal == nullptr) != (answer == nullptr))
      fail(table.source(),
           "{}: normal and normal_contact go together: a direction and how the contact answers along it",
           table.path(normal ? "normal" : "normal_contact"));
    const auto* tangential = table.find("tangential");
    if (!tangential && !normal) table.required("tangential", "direction of slip");
    auto contact = contact_of(reader.scene.model);
    if (tangential) contact.tangential = read_direction(*tangential, "tangential", "direction of slip");
    if (normal) {
      contact.normal = read_direction(*normal, "normal", "direction that presses");
      contact.normal_law = read_normal_law(Table(*answer, table.path("normal_contact")), false);
      double gap = 0;
      table.read("gap", gap, {"", "m", any_number, "way along the normal before the contact touches"});
      if (const auto* given = table.find("gap"); given && !Table(*answer, "").find("coefficient"))
        fail(given->source(), "{} goes with the power law of normal_contact, whose load begins where surfaces touch",
             table.path("gap"));
      contact.gap = Eigen::VectorXd::Constant(1, gap);
    }
    const bool rides = normal && table.find("profile");  // whose speed matters where there is no friction too
    if (!tangential) {
      for (const auto key : {"law", "speed"})
        if (const auto* node = table.find(key); node && !(rides && key == std::string_view("speed")))
          fail(node->source(), "{} has no effect on a contact without tangential, which has no friction",
               table.path(key));
      auto pressed = oscillators::frictionless_contact(contact.normal, contact.normal_law);
      pressed.normal_load = contact.normal_load, pressed.gap = contact.gap;
      if (rides) pressed.speed = contact.speed;
      contact = std::move(pressed);
    }
    read_contact(reader, table, contact);
    contact.ring = read_ring(table);
    read_profile_under(reader, table, contact);
    if (!tangential) contact.speed = 0.0;
    table.finish();
    structure.contacts.push_back(std::move(contact));
  }
  located(contacts.source(), [&] { structure.check(); });
}

}  // namespace

OscillatorType structure_type() { return {"structure", verbs_of_structures, read_structure, read_drive_and_contacts}; }

void read_structure_model(SceneReader& reader) {
  auto& scene = reader.scene;
  reader.law();
  reader.oscillator();
  if (scene.plane || scene.block) return;  // whose starts are their own
  if (!scene.structure)
    scene.structure.emplace().structure =
        located(reader.root.find("oscillator")->source(), [&] { return oscillators::one_slider(scene.model); });
  scene.structure->start.kind = analysis::motion::Start::Kind::rest;
  if (auto cycle = reader.root.table("cycle"))
    if (const auto* start = cycle->find("start"))
      scene.structure->start = read_start_of_structure(*start, cycle->path("start"), scene);
}

void read_slider_as_structure(SceneReader& reader) {
  auto& scene = reader.scene;
  const auto& model = scene.model;
  const bool dry_spring = model.law->set_valued() && model.contact_stiffness.present();
  if (!dry_spring && laws::region_width(*model.law) == 0) return;
  const auto& source = reader.root.find("oscillator")->source();
  if (std::ranges::find(verbs_of_structures, reader.request.verb) == verbs_of_structures.end())
    fail(source, "{} makes the slider a structure, which serves {} only, not '{}'",
         dry_spring ? fmt::format("law.contact_stiffness of law '{}'", model.law->card().name)
                    : "solver.smoothing.type = 'multi-region'",
         fmt::join(verbs_of_structures, ", "), reader.request.verb);
  located(source, [&] { model.check(); });
  scene.structure.emplace().structure = located(source, [&] { return oscillators::one_slider(model); });
}

analysis::motion::StructureStart read_structure_start(const toml::node& node, const std::string& path,
                                                      const Structure& structure) {
  using Kind = analysis::motion::Start::Kind;
  analysis::motion::StructureStart start;
  if (node.is_string()) {
    start.kind = choice(node, path, {"steady", "rest"}) == "rest" ? Kind::rest : Kind::steady;
    return start;
  }
  if (!node.is_table()) wrong_kind(node, path, "\"steady\", \"rest\" or a table");
  start.kind = Kind::given;
  const std::size_t n = std::size_t(structure.size());
  start.coordinates.resize(n), start.velocities.resize(n);
  Table table(node, path);
  const auto read_all = [&](std::string_view key, std::vector<std::optional<double>>& into, const char* unit) {
    const auto* values = table.find(key);
    if (!values) return;
    const auto read = numbers(*values, {table.path(key), unit, any_number, std::string(key)});
    if (read.size() != n) fail(values->source(), "{} has {} entries for {}", table.path(key), read.size(), n);
    std::ranges::copy(read, into.begin());
  };
  // "displacement" is a list too where the coordinates are displacements of several masses.
  const auto is_list = [&](const char* key) {
    const auto* given = node.as_table()->get(key);
    return given && given->is_array();
  };
  read_all(is_list("displacement") ? "displacement" : "coordinates", start.coordinates, "m");
  read_all(is_list("velocity") ? "velocity" : "velocities", start.velocities, "m/s");
  for (std::size_t i = 0; i < n; ++i) {
    const auto by_name = [&](const std::string& name, std::optional<double>& into, const std::string& unit,
                             const char* list) {
      const auto* value = table.find(name);
      if (value && value->is_array() && (name == "displacement" || name == "velocity")) return;  // read above
      if (value && into) fail(value->source(), "{}: give {} or {}, not both", path, list, name);
      table.read(name, into, {"", unit, any_number, name});
    };
    const auto by_column = [&](const std::string& name) {
      by_name(name, start.coordinates[i], structure.unit(int(i)), "coordinates");
      by_name(analysis::motion::velocity_name(name), start.velocities[i], structure.unit(int(i)) + "/s", "velocities");
    };
    by_column(structure.names[i]);
    if (n == 1 && structure.names[i] != "displacement") by_column("displacement");
  }
  const auto& contacts = structure.contacts;
  for (std::size_t j = 0; j < contacts.size(); ++j) {
    const std::string slip = contacts.size() > 1 ? fmt::format("slip_rate_{}", j + 1) : "slip_rate";
    Eigen::Index i = 0;
    contacts[j].tangential.cwiseAbs().maxCoeff(&i);
    if (contacts[j].tangential == Eigen::VectorXd::Unit(contacts[j].tangential.size(), i)) {
      std::optional<double> rate;
      table.read(slip, rate, {"", "m/s", any_number, slip});
      if (rate && start.velocities[std::size_t(i)])
        fail(table.find(slip)->source(), "{} takes a velocity or {}, not both", path, slip);
      if (rate) start.velocities[std::size_t(i)] = contacts[j].speed.value(0) - *rate;
    }
    start.states.push_back(
        read_start_states(table, *contacts[j].law, contacts.size() > 1 ? fmt::format("_{}", j + 1) : ""));
  }
  table.finish();
  return start;
}

analysis::motion::StructureStart read_start_of_structure(const toml::node& node, const std::string& path,
                                                         const Scene& scene) {
  const auto* reduced = reduced_block_of(scene);
  return scene.block ? read_block_start(node, path, *scene.block)
         : reduced   ? read_reduced_block_start(node, path, *reduced)
                     : read_structure_start(node, path, scene.structure->structure);
}

}  // namespace rosin::app::scene
