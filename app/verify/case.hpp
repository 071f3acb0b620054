/// A case of the dossier: a scene, what is asked of it, and the numbers that somebody else has printed or computed.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/verify/field.hpp"

namespace rosin::app::verify {

/// A unit in which a source gives its numbers.
struct SourceUnit {
  std::string name;   ///< "ms"; empty: a pure number
  double factor = 1;  ///< to SI
  std::string si = "1";
};

/// How somebody else came to the numbers.
enum class Origin { printed, stored, closed_form, computed };
const char* name(Origin);

/// What is to come out: numbers in SI, whatever unit the case gives them in, a text, or a truth value.
using Wanted = std::variant<std::vector<double>, std::string, bool>;

struct Question {
  std::string what;                    ///< the number in words: "mean recurrence"
  std::vector<std::string> words;      ///< of the command: "lab", "velocity-step"; none where rosin cannot be asked
  std::vector<std::string> overrides;  ///< as of --set
  std::optional<Field> field, error;
  Wanted wanted;
  bool list = false;             ///< the wanted numbers are a list, if of one
  std::vector<double> accuracy;  ///< of each number, as its source resolves it
  SourceUnit unit;
  Origin origin = Origin::printed;
  std::string differs;  ///< why the numbers are known not to agree; empty: they must
  Wanted instead;       ///< where they differ: what rosin is known to give instead
};

struct Case {
  std::filesystem::path path;
  std::string group, name;  ///< of its folder and its file
  std::string title, source, note;
  Origin origin = Origin::printed;
  std::string not_reproduced;  ///< why rosin cannot be asked; empty: it can
  bool slow = false;           ///< not for the quick form
  std::optional<double> tolerance;
  std::vector<Question> questions;
};

/// \throws InputError with file, line and key for whatever a case cannot be asked by; scenes are read as their verbs
/// would read them.
Case read_case(const std::filesystem::path&);

/// The cases of a dossier, by group and name: <folder>/<group>/<case>.toml; of all, those that are named: by case, by
/// group, or as files that may lie anywhere. \throws InputError for unknown names, with the nearest.
std::vector<Case> read_cases(const std::filesystem::path& folder, const std::vector<std::string>& named);

}  // namespace rosin::app::verify
