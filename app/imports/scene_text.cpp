/// Lines of a scene with their origins.
#include "app/imports/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rosin::app::imports {

namespace {

/// On one line, whatever the source holds.
std::string one_line(std::string_view text) {
  std::string clean;
  for (const char c : text) clean += static_cast<unsigned char>(c) < 32 || c == 127 ? ' ' : c;
  return clean;
}

}  // namespace

SceneText::SceneText(std::string title) {
  text_ = fmt::format("title = {}\n", as_text(title));
  lines_ = 1;
}

void SceneText::table(std::string_view name) {
  text_ += fmt::format("\n[{}]\n", name);
  lines_ += 2;
}

void SceneText::key(std::string_view name, const std::string& value, Origin origin) {
  const auto where = origin.line > 0 ? fmt::format(" (line {})", origin.line) : std::string();
  text_ += fmt::format("# {}{}\n{} = {}\n", one_line(origin.was), where, name, value);
  lines_ += 2;
  origins_[lines_] = std::move(origin);
}

void SceneText::left_out(std::string what, std::string_view why) {
  left_out_.push_back(one_line(fmt::format("{}: {}", what, why)));
}

std::string SceneText::text() const {
  auto whole = text_;
  if (!left_out_.empty()) whole += "\n# not in this scene:\n";
  for (const auto& line : left_out_) whole += fmt::format("# {}\n", line);
  return whole;
}

std::optional<Origin> SceneText::origin(int line) const {
  const auto found = origins_.find(line);
  return found == origins_.end() ? std::nullopt : std::optional(found->second);
}

std::string number(double value) {
  auto digits = fmt::format("{}", value);
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  // 1e+22 is a number of TOML, and so is 12345678901234567000 only with a point
  if (digits.find_first_of(".e") == std::string::npos && digits.size() > 15) digits += ".0";
  return digits;
}

std::string quantity(double value, std::string_view unit) {
  return std::isfinite(value) ? fmt::format("\"{} {}\"", number(value), unit) : number(value);
}

std::string as_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : one_line(text)) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

}  // namespace rosin::app::imports
