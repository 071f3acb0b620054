/// What the types of oscillators with several masses have in common: lists, contacts, their drive and starts.
#pragma once
#include <string_view>
#include <vector>

#include "app/scene/reader.hpp"
#include "app/scene/scene_table.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::scene {

/// Verbs that follow structures.
inline const std::vector<std::string_view> verbs_of_structures = {
    "run", "stability", "cycle", "map", "sweep", "branch", "lyapunov", "basin", "compare", "frf", "fit", "lab"};

/// One number for all of `size`, or a list of so many.
std::vector<double> one_or_list(Table&, std::string_view key, std::size_t size, Quantity, double usual);

void read_truth(Table&, std::string_view key, bool& target);

/// Speed and normal load of the drive, for contacts that give none of their own, and its force where the structure has
/// a place for one.
void read_structure_drive(SceneReader&, Table drive, bool complete, bool takes_force);

/// The same for a block with one contact, its first coordinate along the belt: the force acts on it.
void read_drive_of_one(SceneReader&, Table drive, bool complete);

/// Law, oscillator and drive as a structure, of one coordinate for a slider, with the start of [cycle], else from rest.
void read_structure_model(SceneReader&);

/// Changes the contact by the tables law, speed, normal_load and load_factor of its own.
void read_contact(SceneReader&, Table&, oscillators::FrictionContact&);

/// \throws InputError for a verb that follows no motion to its stops.
void refuse_stops_elsewhere(const SceneReader&, const toml::node& stops);
/// [[oscillator.stops]] of the structure in the scene.
void read_stops(SceneReader&, Table& oscillator);
/// A slider with stops = [low, high] and restitution, or tables as those above: it becomes a structure of one
/// coordinate. Nothing where it has none.
void read_slider_stops(SceneReader&, Table oscillator);

/// A slider becomes a structure where its contact needs one: dry friction behind law.contact_stiffness, and smoothing
/// by regions. \throws InputError for a verb that follows no structure
void read_slider_as_structure(SceneReader&);

/// oscillator.servo, of a slider or a structure that is read: a slider becomes a structure.
void read_servo(SceneReader&, const toml::node& servo);

/// A normal law: the linear one by its stiffness, cubic, damping and lift_off, the power law by its coefficient.
/// \param per_area  the law gives pressures, of a contact with an area
std::shared_ptr<const NormalLaw> read_normal_law(Table, bool per_area);

/// "steady", "rest", or a table: coordinates and velocities as lists, or columns by name, states among them.
analysis::motion::StructureStart read_structure_start(const toml::node&, const std::string& path,
                                                      const oscillators::Structure&);

/// "steady", or a table: a block moved and turned as a rigid body beside steady sliding, by along, up and tilt.
analysis::motion::StructureStart read_block_start(const toml::node&, const std::string& path,
                                                  const oscillators::BlockMesh&);

}  // namespace rosin::app::scene
