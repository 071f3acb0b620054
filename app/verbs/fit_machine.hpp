/// Machines of [fit]: the scene's own oscillator and drive, run from the start of a table of data.
#pragma once
#include <memory>
#include <vector>

#include "analysis/inference/machine.hpp"
#include "app/scene/reader.hpp"

namespace rosin::app::verbs {

/// The machine whose motion a table of data holds.
/// \param law  in place of that of the scene; null: the scene's own
/// \param data  number of the table in fit.data, from 0
/// \param times  of the record, s
std::shared_ptr<const analysis::inference::Machine> machine_of(const scene::SceneReader&, const toml::node* law,
                                                               std::size_t data, std::string name,
                                                               std::vector<double> times);

/// The machine whose stick–slip a table of data holds: a structure, from the start of [cycle], else from rest.
std::shared_ptr<const analysis::inference::Machine> stick_slip_machine_of(const scene::SceneReader&,
                                                                          const toml::node* law, std::size_t data,
                                                                          std::string name);

}  // namespace rosin::app::verbs
