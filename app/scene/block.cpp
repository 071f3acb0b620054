/// An elastic block on a moving belt, as a mesh of nine-node elements.
#include "oscillators/block.hpp"

#include "analysis/steady/reduction_error.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/structure.hpp"

namespace rosin::app::scene {

using Reduced = std::shared_ptr<oscillators::ReducedBlock>;

namespace {

void read_block(SceneReader& reader, Table table, bool) {
  table.expect({"type", "length", "height", "thickness", "youngs_modulus", "poisson_ratio", "density", "elements",
                "mass_matrix", "spring_stiffness", "stiffness_damping", "gauss_points", "normal_contact", "modes"});
  table.find("type");
  const auto* modes = table.find("modes");
  oscillators::ElasticBlock block;
  const auto number = [&](std::string_view key, double& into, const char* unit, Range range, const char* meaning,
                          bool required = true) {
    if (required) table.required(key, fmt::format("{}, {}", meaning, unit));
    table.read(key, into, {"", unit, range, meaning});
  };
  number("length", block.length, "m", {1e-9, 1e6}, "length of the block along the belt");
  number("height", block.height, "m", {1e-9, 1e6}, "height of the block");
  number("thickness", block.thickness, "m", {1e-9, 1e6}, "thickness of the block across the belt", false);
  number("youngs_modulus", block.youngs_modulus, "Pa", {1e-9, 1e15}, "Young's modulus");
  number("poisson_ratio", block.poisson_ratio, "1", {-0.99, 0.499}, "Poisson's ratio");
  number("density", block.density, "kg/m^3", {1e-9, 1e9}, "density");
  constexpr int most_elements = 16;
  if (const auto* elements = table.find("elements")) {
    const auto path = table.path("elements");
    const auto& pair = list(*elements, path, "numbers", 2);
    if (pair.size() != 2) fail(elements->source(), "{} is a pair: along the belt and upwards", path);
    for (const std::size_t i : {0, 1})
      block.elements[i] = count(*pair.get(i), path, 1, most_elements, "nine-node elements along the belt and upwards");
  }
  if (const auto* mass = table.find("mass_matrix"))
    block.lumped_mass = choice(*mass, table.path("mass_matrix"), {"consistent", "lumped"}) == "lumped";
  table.read("gauss_points", block.gauss_points, 1, 10, "stations on each edge of the lower face");
  oscillators::BlockOnBelt on_belt;
  number("spring_stiffness", on_belt.spring_stiffness, "N/m", {0, 1e15}, "stiffness of the spring on the left face");
  number("stiffness_damping", on_belt.stiffness_damping, "s", {0, 1e6}, "damping over stiffness of the block", false);
  const auto& contact = table.required("normal_contact", "pressure of the lower face by its approach");
  on_belt.contact = read_normal_law(Table(contact, table.path("normal_contact")), true);
  table.finish();
  auto& scene = reader.scene;
  located(table.source(), [&] {
    oscillators::BlockMesh mesh(block);
    auto& structure = scene.structure.emplace().structure;
    structure = oscillators::block_on_belt(mesh, on_belt, contact_of(scene.model));
    if (!modes) {
      scene.block = std::make_shared<const oscillators::BlockMesh>(std::move(mesh));
      return;
    }
    const int inside = mesh.size() - 2 * (2 * block.elements[0] + 1);
    int kept = 0;
    table.read("modes", kept, 0, inside, "modes of the interior that are kept");
    oscillators::Reduction reduction(std::move(structure), kept);
    structure = reduction.reduced;
    scene.task<Reduced>() =
        std::make_shared<oscillators::ReducedBlock>(oscillators::ReducedBlock{std::move(mesh), std::move(reduction)});
  });
}

/// All stations move with the belt, and share the weight.
void read_drive_of_block(SceneReader& reader, Table drive, bool complete) {
  read_structure_drive(reader, drive, complete, false);
  auto& scene = reader.scene;
  const auto move = [&](oscillators::Structure& structure) {
    for (auto& contact : structure.contacts)
      contact.speed = scene.model.drive.speed, contact.normal_load = scene.model.drive.normal_load;
  };
  move(scene.structure->structure);
  if (const auto& block = scene.task<Reduced>()) move(block->reduction.whole), move(block->reduction.reduced);
}

}  // namespace

analysis::motion::StructureStart read_block_start(const toml::node& node, const std::string& path,
                                                  const oscillators::BlockMesh& mesh) {
  analysis::motion::StructureStart start;
  if (node.is_string()) {
    choice(node, path, {"steady"});
    return start;
  }
  if (!node.is_table()) wrong_kind(node, path, "\"steady\" or a table: along, up, tilt");
  Table table(node, path);
  double along = 0, up = 0, tilt = 0;
  constexpr Range any{-1e15, 1e15};
  table.read("along", along, {"", "m", any, "displacement of the block along the belt, beside steady sliding"});
  table.read("up", up, {"", "m", any, "displacement of the block upwards, beside steady sliding"});
  table.read("tilt", tilt, {"", "rad", any, "rotation of the block about its centre, beside steady sliding"});
  table.finish();
  start.beside = mesh.rigid(along, up, tilt);
  return start;
}

const oscillators::ReducedBlock* reduced_block_of(const Scene& scene) { return scene.task<Reduced>().get(); }

analysis::motion::StructureStart read_reduced_block_start(const toml::node& node, const std::string& path,
                                                          const oscillators::ReducedBlock& block) {
  analysis::motion::StructureStart start;
  start.kind = analysis::motion::Start::Kind::rest;
  if (node.value_or(std::string()) == "rest") return start;
  start = read_block_start(node, path, block.mesh);
  if (start.beside.size() > 0) start.beside = block.reduction.coordinates(start.beside);
  return start;
}

std::string reduction_note(const oscillators::Reduction& reduction) {
  const std::size_t kept = std::size_t(reduction.modes), all = reduction.frequency.size();
  auto text = fmt::format(
      "oscillator.modes: the block has {} coordinates of its lower face and {} of the {} modes of "
      "the others",
      reduction.touching.size(), kept, all);
  if (kept > 0) text += fmt::format(", up to {:.4g} Hz", reduction.frequency[kept - 1]);
  if (kept == all) return text + ": all that its mesh has";
  text +=
      fmt::format("; the next has {:.4g} Hz. What is said of motion holds for this block", reduction.frequency[kept]);
  constexpr int slowest = 3;  // the spring, bounce and pitch
  try {
    const auto sliding = analysis::steady::lowest_modes_of_sliding(reduction.reduced, slowest);
    const auto errors = analysis::steady::reduction_errors(reduction, sliding);
    double worst = 0;
    for (std::size_t k = 0; k < errors.size(); ++k)
      worst = std::max(worst, errors[k] / std::abs(sliding.modes[k].eigenvalue));
    if (std::isfinite(worst))
      return text + fmt::format(
                        ": about steady sliding eigenvalues of its {} slowest modes are within {:.1e} of those "
                        "of the mesh, relative",
                        errors.size(), worst);
  } catch (const InputError&) {  // no steady sliding, or contacts with states
  }
  return text + ", whose error is not known here: compare with more modes";
}

OscillatorType block_type() {
  return {"block",
          verbs_by_steps,
          read_block,
          read_drive_of_block,
          {{"lab",
            "its face slips in part before it slips as a whole, so that no slip rate is that of the experiment; 'run' "
            "follows any drive.speed"}}};
}

}  // namespace rosin::app::scene
