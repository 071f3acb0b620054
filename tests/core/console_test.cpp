/// Messages that quote anything.
#include "core/console.hpp"

#include <catch2/catch.hpp>

using rosin::presentable;

TEST_CASE("a message holds nothing that a terminal would obey, and an end", "[console]") {
  CHECK(presentable("μ = 0.3\n\tat 'x'\n") == "μ = 0.3\n\tat 'x'\n");
  CHECK(presentable("a\033[31mb\rc\x7f") == "a?[31mb?c?");
  CHECK(presentable(std::string(1, '\0')) == "?");
  std::string long_text;
  for (int i = 0; i < 100'000; ++i) long_text += "…";
  const auto shown = presentable(long_text);
  CHECK(shown.size() < 10'010);
  CHECK(shown.ends_with("……\n"));
}
