/// Scenes: what a user asks of a model, read from a TOML file and `--set` overrides, and checked before any work.
#pragma once
#include <any>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <typeindex>
#include <vector>

#include "analysis/motion/structure_start.hpp"
#include "app/scene/written_units.hpp"
#include "oscillators/model.hpp"

namespace rosin::oscillators {
struct BlockMesh;
}
namespace rosin::analysis::motion {
struct PlaneModel;
}
namespace rosin::app::tasks {
struct Bowing;
}

namespace rosin::app::scene {

class Family;

struct Scene {
  std::string path;  ///< as the user gave it
  std::string title;
  oscillators::Model model;
  std::shared_ptr<analysis::motion::PlaneModel> plane;        ///< a slider in the plane, in place of the model's
  std::optional<analysis::motion::StructureModel> structure;  ///< in place of the model's slider
  std::shared_ptr<tasks::Bowing> string;                      ///< in place of the model's slider
  std::shared_ptr<const oscillators::BlockMesh> block;        ///< that the structure is the mesh of
  std::shared_ptr<const Family> family;                       ///< of it, where a number of the scene is varied
  std::string resolved;                                       ///< the scene as TOML, overrides included
  std::vector<std::string> notes;                             ///< what was read but has no effect
  std::vector<std::string> files_read;                        ///< what was understood of measured files
  std::uint64_t files_checksum = 0;                           ///< of their numbers; 0: no file was read
  WrittenUnits units;                                         ///< in which its numbers are written
  std::map<std::string, std::string> places;                  ///< of keys by their paths: "scene.toml:7:5"

  /// What the scene's verb asks, of the type in which that verb keeps it (app/tasks/): defaults until it has been read.
  template <class Task>
  Task& task() {
    auto& held = tasks_[typeid(Task)];
    if (!held.has_value()) held = Task{};
    return *std::any_cast<Task>(&held);
  }
  template <class Task>
  const Task& task() const {
    static const Task unread{};
    const auto found = tasks_.find(typeid(Task));
    return found == tasks_.end() ? unread : *std::any_cast<Task>(&found->second);
  }

  /// The parameter at a path: of the family where there is one, else of the model.
  Quantity describe(const std::string& path) const;
  /// A refusal with the place of the first key that it names in front, or that of the key's table, or the file.
  std::string placed(const std::string& refusal) const;

 private:
  std::map<std::type_index, std::any> tasks_;
};

}  // namespace rosin::app::scene
