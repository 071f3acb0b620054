/// Parameters of a script as numbers, each with the line that gave it.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "app/imports/scene_text.hpp"
#include "app/imports/script.hpp"

namespace rosin::app::imports {

struct Parameter {
  double value = 0;
  int line = 0;      ///< 0: a default
  std::string name;  ///< as the source has it, "model.a"

  Origin origin(std::string_view meaning = {}) const;
};

/// A number of a record. Nothing where it is not there. \throws InputError where it is no number that is known
std::optional<Parameter> parameter(const Script&, const Record&, std::string_view name, std::string_view shown);
/// The same, refused where it is missing: "script.py: model.a is not given (direct effect)".
Parameter required(const Script&, const Record&, std::string_view name, std::string_view shown,
                   std::string_view meaning);

}  // namespace rosin::app::imports
