/// Blocks in a row, each in contact with the moving surface and held by a spring of its own.
#include <fmt/format.h>

#include "app/scene/oscillator.hpp"
#include "app/scene/profile.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

namespace {

void read_chain(SceneReader& reader, Table table, bool) {
  table.expect(
      {"type", "blocks", "mass", "stiffness", "damping", "pull_stiffness", "pull_damping", "contacts", "stops"});
  table.find("type");
  int blocks = 0;
  table.required("blocks", "number of blocks");
  table.required("mass", "of each block, kg");
  table.required("stiffness", "between neighbours, N/m");
  table.required("pull_stiffness", "from each block to the fixed frame, N/m");
  table.read("blocks", blocks, 1, 1000, "number of blocks");
  const std::size_t n = std::size_t(blocks);
  const Quantity mass{"", "kg", {1e-12, 1e12}, "mass"}, stiffness{"", "N/m", {0, 1e15}, "stiffness of a spring"},
      damping{"", "N s/m", {0, 1e15}, "damping"};
  oscillators::Chain chain;
  chain.mass = one_or_list(table, "mass", n, mass, 1);
  chain.coupling_stiffness = one_or_list(table, "stiffness", n - 1, stiffness, 0);
  chain.coupling_damping = one_or_list(table, "damping", n - 1, damping, 0);
  chain.pull_stiffness = one_or_list(table, "pull_stiffness", n, stiffness, 0);
  chain.pull_damping = one_or_list(table, "pull_damping", n, damping, 0);
  table.find("contacts");
  table.finish();
  reader.scene.structure.emplace().structure =
      oscillators::chain(chain, std::vector<oscillators::FrictionContact>(n, contact_of(reader.scene.model)));
  read_stops(reader, table);
}

void read_drive_and_contacts(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, drive, complete, false);
  auto& structure = reader.scene.structure->structure;
  for (auto& contact : structure.contacts) {
    contact.speed = reader.scene.model.drive.speed;
    contact.normal_load = reader.scene.model.drive.normal_load;
  }
  const auto contacts = reader.document.at_path("oscillator.contacts");
  if (!contacts) return;
  std::vector<bool> given(structure.contacts.size());
  int entry = 0;
  for (const auto& element : list(*contacts.node(), "oscillator.contacts", "tables", most_names)) {
    Table table(element, fmt::format("oscillator.contacts.{}", ++entry));
    table.expect({"block", "law", "speed", "normal_load", "load_factor"});
    refuse_profile(table);
    int block = 0;
    const auto& node = table.required("block", "number of the block, from 1");
    table.read("block", block, 1, int(structure.contacts.size()), "number of the block, from 1");
    if (given[block - 1]) fail(node.source(), "block {} has a contact in this list already", block);
    given[block - 1] = true;
    read_contact(reader, table, structure.contacts[block - 1]);
    table.finish();
  }
}

}  // namespace

OscillatorType chain_type() { return {"chain", verbs_of_structures, read_chain, read_drive_and_contacts}; }

}  // namespace rosin::app::scene
