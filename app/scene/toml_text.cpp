/// Quotation marks and escapes of TOML.
#include "app/scene/toml_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace rosin::app::scene {

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (letter < 0x20 || letter == 0x7f)
      quoted += fmt::format("\\u{:04X}", letter);
    else if (c == '"' || c == '\\')
      quoted += {'\\', c};
    else
      quoted += c;
  }
  return quoted + '"';
}

std::string toml_key(std::string_view name) {
  const auto plain = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-'); };
  return !name.empty() && std::ranges::all_of(name, plain) ? std::string(name) : toml_text(name);
}

std::string toml_number(double value) {
  if (std::isnan(value)) return "nan";
  auto digits = fmt::format("{}", value);
  if (digits.find_first_not_of("-0123456789") == std::string::npos) digits += ".0";
  return digits;
}

}  // namespace rosin::app::scene
