/// A structure by its matrices, and what all structures share.
#include "app/scene/structure.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/motion/structure_record.hpp"
#include "app/scene/law.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/signal.hpp"

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

oscillators::NormalSupport read_support(Table table) {
  oscillators::NormalSupport support;
  table.expect({"stiffness", "cubic", "damping", "lift_off"});
  table.required("stiffness", "N/m");
  table.read("stiffness", support.stiffness, {"", "N/m", {0, 1e15}, "stiffness of the contact along its normal"});
  table.read("cubic", support.cubic, {"", "N/m^3", {0, 1e30}, "cubic stiffness of the contact along its normal"});
  table.read("damping", support.damping, {"", "N s/m", {0, 1e15}, "damping of the contact along its normal"});
  if (const auto* node = table.find("lift_off")) {
    if (!node->is_boolean()) wrong_kind(*node, table.path("lift_off"), "true or false");
    support.lift_off = *node->value<bool>();
  }
  table.finish();
  return support;
}

namespace {

constexpr Range any{-1e15, 1e15};

Eigen::MatrixXd read_matrix(const toml::node& node, const Quantity& quantity, Eigen::Index size) {
  const auto& rows = list(node, quantity.name, "rows", most_names);
  const auto n = size > 0 ? size : Eigen::Index(rows.size());
  if (Eigen::Index(rows.size()) != n)
    fail(node.source(), "{} has {} rows, but M has {}", quantity.name, rows.size(), n);
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto values = numbers(*rows.get(std::size_t(i)), quantity);
    if (Eigen::Index(values.size()) != n)
      fail(rows.get(std::size_t(i))->source(), "{} is not square: a row has {} of {}", quantity.name, values.size(), n);
    matrix.row(i) = Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  }
  return matrix;
}

void read(SceneReader& reader, Table table, bool) {
  auto& structure = reader.scene.structure.emplace().structure;
  table.expect({"type", "M", "C", "K", "contacts", "force", "stops"});
  table.find("type");
  structure.M = read_matrix(table.required("M", "mass matrix, kg"), {table.path("M"), "kg", any, "mass"}, 0);
  const auto n = structure.M.rows();
  structure.K =
      read_matrix(table.required("K", "stiffness matrix, N/m"), {table.path("K"), "N/m", any, "stiffness"}, n);
  structure.C = Eigen::MatrixXd::Zero(n, n);
  if (const auto* C = table.find("C")) structure.C = read_matrix(*C, {table.path("C"), "N s/m", any, "damping"}, n);
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

/// Contacts come after the drive, which says what they do not.
void read_drive_and_contacts(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, drive, complete, false);
  auto& structure = reader.scene.structure->structure;
  const auto& contacts = *reader.document.at_path("oscillator.contacts").node();
  for (const auto& element : list(contacts, "oscillator.contacts", "tables", most_names)) {
    Table table(element, fmt::format("oscillator.contacts.{}", structure.contacts.size() + 1));
    table.expect({"tangential", "normal", "normal_contact", "law", "speed", "normal_load", "load_factor"});
    auto contact = contact_of(reader.scene.model);
    const auto& direction = table.required("tangential", "direction of slip");
    const auto entries = numbers(direction, {table.path("tangential"), "1", any, "direction of slip"});
    if (int(entries.size()) != structure.size())
      fail(direction.source(), "{} has {} entries for {} coordinates", table.path("tangential"), entries.size(),
           structure.size());
    contact.tangential = Eigen::Map<const Eigen::VectorXd>(entries.data(), structure.size());
    const auto *normal = table.find("normal"), *support = table.find("normal_contact");
    if ((normal == nullptr) != (support == nullptr))
      fail(table.source(),
           "{}: normal and normal_contact go together: a direction and how the contact answers along it",
           table.path(normal ? "normal" : "normal_contact"));
    if (normal) {
      const auto presses = numbers(*normal, {table.path("normal"), "1", any, "direction that presses"});
      if (int(presses.size()) != structure.size())
        fail(normal->source(), "{} has {} entries for {} coordinates", table.path("normal"), presses.size(),
             structure.size());
      contact.normal = Eigen::Map<const Eigen::VectorXd>(presses.data(), structure.size());
      contact.support = read_support(Table(*support, table.path("normal_contact")));
    }
    read_contact(reader, table, contact);
    table.finish();
    structure.contacts.push_back(std::move(contact));
  }
  located(contacts.source(), [&] { structure.check(); });
}

}  // namespace

OscillatorType structure_type() { return {"structure", verbs_of_structures, read, read_drive_and_contacts}; }

void read_structure_model(SceneReader& reader) {
  auto& scene = reader.scene;
  reader.law();
  reader.oscillator();
  if (scene.plane) return;
  if (!scene.structure)
    scene.structure.emplace().structure =
        located(reader.root.find("oscillator")->source(), [&] { return oscillators::one_slider(scene.model); });
  scene.structure->start.kind = analysis::motion::Start::Kind::rest;
  if (auto cycle = reader.root.table("cycle"))
    if (const auto* start = cycle->find("start"))
      scene.structure->start = read_structure_start(*start, cycle->path("start"), scene.structure->structure);
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
    const auto read = numbers(*values, {table.path(key), unit, any, std::string(key)});
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
    const auto by_name = [&](const std::string& name, std::optional<double>& into, const char* unit, const char* list) {
      const auto* value = table.find(name);
      if (value && value->is_array()) return;
      if (value && into) fail(value->source(), "{}: give {} or {}, not both", path, list, name);
      table.read(name, into, {"", unit, any, name});
    };
    by_name(structure.names[i], start.coordinates[i], "m", "coordinates");
    by_name(analysis::motion::velocity_name(structure.names[i]), start.velocities[i], "m/s", "velocities");
  }
  table.finish();
  return start;
}

}  // namespace rosin::app::scene
