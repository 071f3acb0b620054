/// Types of oscillators: what [oscillator] and [drive] hold for each, one file a type and one line in the list.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "app/scene/scene_table.hpp"

namespace rosin::app::scene {

struct SceneReader;

struct OscillatorType {
  std::string name;
  std::vector<std::string_view> verbs;  ///< that it serves; empty: all
  /// \param complete whether the keys that a motion needs must be there
  std::function<void(SceneReader&, Table oscillator, bool complete)> read;
  std::function<void(SceneReader&, Table drive, bool complete)> read_drive;
  std::map<std::string, std::string> reasons = {};  ///< why it does not serve a verb
};

const std::vector<OscillatorType>& oscillator_types();
/// Before any scene is read. \throws InputError for a name that is taken
void add_oscillator_type(OscillatorType);
/// That of the scene; the slider where it names none. \throws InputError for a name that is none, or not of the verb.
const OscillatorType& oscillator_type(SceneReader&, const toml::node& oscillator);

/// [drive] of a slider: speed, normal load and force, one signal each.
void read_drive(SceneReader&, Table drive, bool complete);

/// A parameter of slider, drive or contact by its path. \throws std::logic_error if there is none.
Quantity mechanical(std::string_view path);

}  // namespace rosin::app::scene
