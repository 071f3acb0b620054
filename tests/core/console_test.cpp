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

TEST_CASE("within another program, both streams and the progress are captured", "[console]") {
  using namespace rosin;
  {
    const Capture capture(true);
    print("result {}\n", 1);
    tell("note: {}\n", 2);
    CHECK(progress_is_seen());
    write_progress(0.25, "[==  ]");
    CHECK(capture.output() == "result 1\n");
    CHECK(capture.messages() == "note: 2\n");
    CHECK(capture.work() == 0.25);
  }
  const Capture quiet(false);
  CHECK_FALSE(progress_is_seen());
  CHECK(quiet.output().empty());
}
