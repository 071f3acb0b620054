/// Documents that were found in files. Include only in .cpp files: the JSON library is slow to compile.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace rosin::app::output {

/// An object, no more than 100 levels deep and 5·10⁷ values large. \throws InputError that says where it is damaged
nlohmann::ordered_json parse_document(const std::string& path, const std::string& text);

}  // namespace rosin::app::output
