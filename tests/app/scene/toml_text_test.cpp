/// Texts, keys and numbers as TOML read back as they were, and so does a whole scene.
#include "app/scene/toml_text.hpp"

#include <toml++/toml.h>

#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "app/scene/toml_document.hpp"
#include "core/error.hpp"
#include "tests/printable_texts.hpp"

using namespace rosin::app::scene;

TEST_CASE("any text and any key read back as they were", "[toml]") {
  auto texts = rosin::tests::printable_texts();
  for (const char* more : {"", "a'''b\n", "\"\"\"", "\t\r\n", "\x01\x7f"}) texts.emplace_back(more);
  toml::table scene;
  for (const auto& text : texts) {
    CAPTURE(text);
    const auto read = toml::parse(toml_key(text) + " = " + toml_text(text));
    REQUIRE(read.size() == 1);
    CHECK(read.begin()->first.str() == text);
    CHECK(read.begin()->second.value<std::string>() == text);
    scene.insert("value of " + text, text);
    scene.insert("table " + text, toml::table{{text, toml::array{toml::table{{text, 1}}}}});
  }
  CHECK(toml::parse(resolved(scene)) == scene);
}

TEST_CASE("numbers keep their digits, and whole ones stay whole", "[toml]") {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const double value : {0., -0., 5., 0.1, 1e22, 1.5e-310, 12345678901234567890., infinite, -infinite}) {
    const auto read = toml::parse("value = " + toml_number(value));
    CHECK(read["value"].is_floating_point());
    CHECK(*read["value"].value<double>() == value);
  }
  const auto scene =
      toml::parse("whole = 9007199254740993\nfraction = 5.0\nlist = [1, 1.0, nan, true]\n[t]\nday = 1979-05-27");
  CHECK(toml::parse(resolved(scene)) == scene);
}

namespace {

/// Levels of tables and lists, as the parser has made them.
int depth(const toml::node& node) {
  int below = -1;
  if (const auto* table = node.as_table())
    for (const auto& [key, inner] : *table) below = std::max(below, depth(inner));
  if (const auto* list = node.as_array())
    for (const auto& inner : *list) below = std::max(below, depth(inner));
  return below + 1;
}

}  // namespace

TEST_CASE("no row of quotation marks hides how deep a scene lies", "[toml]") {
  std::string deep;
  for (int i = 0; i < 150; ++i) deep += "a.";
  deep += "a = 1";
  const std::vector<std::string> pieces = {"\"", "\"\"", "\"\"\"", "'", "''", "'''", "\\",   "x", "#",
                                           "\n", "{",    "}",      "[", "]",  ", ",  "b = ", "."};
  std::mt19937 draw(1);
  int refused = 0, read = 0;
  for (int k = 0; k < 20'000; ++k) {
    std::string text = draw() % 2 == 0 ? "q = " : "b = { q = ";
    for (auto count = draw() % 8; count > 0; --count) text += pieces[draw() % pieces.size()];
    text += (draw() % 2 == 0 ? ", " : "\n") + deep + (draw() % 2 == 0 ? "}" : "");
    CAPTURE(text);
    try {
      static_cast<void>(toml::parse(text));
    } catch (const toml::parse_error&) {
      continue;  // what the parser makes of it until then is as deep
    }
    try {
      const auto scene = parse_toml(text, "scene.toml");
      CHECK(depth(scene) <= 100);
      ++read;
    } catch (const rosin::InputError& error) {
      CHECK_THAT(error.what(), Catch::Matches("scene.toml:[0-9]+: tables or lists lie more than 100 levels deep"));
      ++refused;  // before it was parsed: the message knows a line, no column
    }
  }
  CHECK(refused > 100);
  CHECK(read > 20);
}
