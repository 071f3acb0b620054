/// A verb of the command: one file that defines one `Verb`, and one line in list.def. Parsing, help,
/// manual and completions follow from it.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/command_line.hpp"

namespace rosin::app::scene {
class Table;
struct SceneReader;
}  // namespace rosin::app::scene

namespace rosin::app::verbs {

class Job;

/// Exit statuses of the command.
enum Status { done = 0, ended_short = 1, wrong_input = 2, interrupted = 130 };

/// Where an option or operand goes; flags are bool, or set their own name.
using Target = std::variant<bool Request::*, int Request::*, long Request::*, std::uint64_t Request::*,
                            double Request::*, std::optional<double> Request::*, std::string Request::*,
                            std::vector<std::string> Request::*, std::set<std::string> Request::*>;

struct Option {
  const char* name;  ///< "--tolerance"
  Target target;
  std::string help;
};

struct Operand {
  const char* name;  ///< "SCENE"
  Target target;
  std::string help;
  bool required = true;
  std::vector<std::string> choices = {};  ///< names that it is one of, for completions; empty: anything
  bool checked = false;                   ///< whether others are refused when the line is parsed, before the verb
};

/// A table of a scene.
struct Need {
  const char *table, *what;
  bool optional = false;
};

/// A table that is read in each scene with a model, whatever the verb, so that a wrong key is found at once.
struct TableOfModels {
  const char* name;
  void (*read)(scene::Table, scene::SceneReader&);
};

struct Verb {
  const char *name, *help, *example;
  std::vector<Operand> operands = {};
  std::vector<Need> needs = {};  ///< of a scene
  std::vector<Option> options = {};
  std::vector<TableOfModels> tables = {};
  /// Of verbs that take a scene: reads what they need of it, and does the work.
  void (*read)(scene::SceneReader&) = nullptr;
  Status (*perform)(Job&) = nullptr;
  /// Of the others: does the work.
  Status (*without_scene)(const Request&) = nullptr;
  /// The processes that a launcher such as mpirun starts share the work.
  bool spreads = false;
};

/// All verbs, in the order of the help.
const std::vector<Verb>& verbs();
/// \throws InputError for a name that is none, with the nearest.
const Verb& find_verb(std::string_view name);

// What several verbs have in common.
extern const Operand scene_operand;
extern const Option json_option, quiet_option, pdf_option, width_option;
Option out_option(std::string_view usual);
Option threads_option(std::string help);
/// Those of every verb that takes a scene, and its own.
std::vector<Option> scene_options(std::vector<Option> own = {});
/// [law], [oscillator] and [drive], and the verb's own.
std::vector<Need> model_tables(std::vector<Need> own);
/// Reads the tables of all verbs: those that this one needs, and the others to check them.
void read_tables_of_models(scene::SceneReader&);

}  // namespace rosin::app::verbs
