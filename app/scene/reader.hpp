/// A scene while it is read: each verb asks for the tables that it needs, and what nobody asked for is refused.
#pragma once
#include <filesystem>
#include <set>
#include <string>

#include "app/command_line.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/scene_table.hpp"
#include "laws/smoothing.hpp"

namespace rosin::app::scene {

struct SceneReader {
  const Request& request;
  const toml::table& document;
  Table root;
  Scene& scene;
  std::filesystem::path folder;                   ///< in which files that the scene names are looked for
  std::set<std::string, std::less<>> needed;      ///< tables without which the verb has nothing to do
  std::optional<laws::Smoothing> smoothing = {};  ///< of every set-valued law of the scene
  double region_width = 0;                        ///< m/s, of the same by regions; 0: not asked for
  bool smooths = false;                           ///< it has met one
  Reference reference = Reference(document);      ///< area and radius of its contact

  /// Of a table that must be there. \throws InputError that says what would stand in it.
  const toml::node& need(const std::string& table, std::string_view meaning) {
    needed.insert(table);
    return root.required(table, meaning);
  }
  bool needs(std::string_view table) const { return needed.contains(table); }

  /// solver.smoothing, before any law.
  void find_smoothing();
  /// \throws InputError where smoothing was asked for and has met no set-valued law.
  void require_smoothing_to_matter() const;
  /// [law], which must be there.
  void law();
  /// [oscillator] and [drive], which must be there, and fit together.
  void oscillator();
  /// The same for verbs that ask of a contact alone: where they are there. \param complete with all that a motion needs
  void oscillator_if_there(bool complete = true);
  /// A note for each of these keys that the scene has although the verb does not look at it.
  void note_unread(std::initializer_list<std::string_view> paths, std::string_view why);
};

}  // namespace rosin::app::scene
