/// The catalogue: laws and presets by name, messages for wrong names, and a page of documentation for each law.
#include "laws/catalogue.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>

using namespace rosin;

TEST_CASE("catalogue: wrong names are answered with the nearest and the known ones", "[laws][catalogue]") {
  CHECK_THROWS_WITH(
      laws::find_law("spinodl"),
      Catch::Contains("unknown friction law 'spinodl'; did you mean 'spinodal'? (known: coulomb, stribeck"));
  CHECK_THROWS_WITH(laws::find_law("qqqq"), Catch::Contains("unknown friction law 'qqqq' (known: "));
  const auto spinodal = laws::find_law("spinodal");
  CHECK_THROWS_WITH(
      laws::preset(*spinodal, "bristol-bord"),
      "law 'spinodal' has no preset 'bristol-bord'; did you mean 'bristol-board'? (known: bristol-board)");
  CHECK_THROWS_WITH(laws::preset(*laws::find_law("slip"), "rock"), Catch::Contains("(known: none)"));
  CHECK_THROWS_WITH(spinodal->parameter("t_heel"), Catch::Contains("did you mean 't_heal'?"));
  CHECK_THROWS_WITH(laws::find_law("tabulated")->parameter("friction"), Catch::Contains("is a list"));
}

TEST_CASE("catalogue: a law is a value, changed copies leave it alone", "[laws][catalogue]") {
  const auto law = laws::find_law("spinodal");
  CHECK(law->with("a", 0.04)->parameter("a") == 0.04);
  CHECK(law->parameter("a") == 0.0349);
}

TEST_CASE("catalogue: each law has a page that shows it in a scene", "[laws][catalogue]") {
  for (const auto& law : laws::catalogue()) {
    const std::string name(law->card().name);
    CAPTURE(name);
    std::ifstream file(ROSIN_SOURCE_DIR "/docs/laws/" + name + ".md");
    const std::string page(std::istreambuf_iterator<char>(file), {});
    for (const auto& part : {"# " + name + ":", "type = \"" + name + "\"", std::string("## When to use it"),
                             std::string("## Limits"), std::string("λ")})
      CHECK_THAT(page, Catch::Contains(part));
    for (const auto& preset : law->presets())
      CHECK_THAT(page, Catch::Contains('`' + preset.name + '`') || Catch::Contains('"' + preset.name + '"'));
  }
}
