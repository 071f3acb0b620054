/// Texts, keys and numbers as TOML takes them.
#pragma once
#include <string>
#include <string_view>

namespace rosin::app::scene {

/// In double quotes, on one line, whatever the text holds.
std::string toml_text(std::string_view);
/// The name as it stands before an equals sign: in quotes where it holds more than letters, digits, _ and -.
std::string toml_key(std::string_view);
/// The shortest digits that read back as the same number with a fraction: 5 is "5.0".
std::string toml_number(double);

}  // namespace rosin::app::scene
