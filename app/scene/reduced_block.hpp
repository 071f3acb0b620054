/// A block whose motion is that of its lower face and some modes: oscillator.modes.
#pragma once
#include <string>

#include "analysis/motion/structure_start.hpp"
#include "app/scene/reader.hpp"
#include "oscillators/block_reduction.hpp"

namespace rosin::app::scene {

/// That the structure in the scene is; null: another oscillator is in the scene.
const oscillators::ReducedBlock* reduced_block_of(const Scene&);

/// The start of the structure in the scene, as its oscillator has it.
analysis::motion::StructureStart read_start_of_structure(const toml::node&, const std::string& path, const Scene&);

/// "steady", "rest", or a table as that of a block on its mesh: along, up and tilt.
analysis::motion::StructureStart read_reduced_block_start(const toml::node&, const std::string& path,
                                                          const oscillators::ReducedBlock&);

/// What the block represents, and how far its slowest modes are those of the mesh.
std::string reduction_note(const oscillators::Reduction&);

}  // namespace rosin::app::scene
