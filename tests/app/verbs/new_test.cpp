/// The verb new: every scene that it prints is computed by the verb that its first line names.
#include <catch2/catch.hpp>
#include <map>
#include <sstream>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

TEST_CASE("every scene to start from is computed by the verb that it names", "[app][new][long]") {
  // Planes and branches with fewer points, which take as many seconds else.
  const std::map<std::string, std::string> fewer = {{"map", " --set map.x.points=3 --set map.y.points=2"},
                                                    {"sweep", " --set sweep.points=2"},
                                                    {"basin", " --set basin.x.points=2 --set basin.y.points=2"}};
  const Folder folder;
  const auto list = run_rosin(folder, "new");
  REQUIRE(list.status == 0);
  std::istringstream lines(list.out);
  int starters = 0;
  for (std::string line; std::getline(lines, line) && !line.empty(); ++starters) {
    const auto name = line.substr(0, line.find(' '));
    INFO(name);
    const auto scene = run_rosin(folder, "new " + name).out;
    std::ofstream(folder.path / "SCENE.toml") << scene;
    const std::string begin = "# rosin ";
    REQUIRE(scene.starts_with(begin));
    const auto command = scene.substr(begin.size(), scene.find('\n') - begin.size());
    const auto options = fewer.find(command.substr(0, command.find(' ')));
    const auto ran =
        run_rosin(folder, command + " --no-pictures --quiet" + (options == fewer.end() ? "" : options->second));
    INFO(command << ran.error);
    CHECK(ran.status == 0);
  }
  CHECK(starters > 20);
}

TEST_CASE("a scene to start from that is none is refused with the nearest", "[app][new]") {
  const Folder folder;
  const auto ran = run_rosin(folder, "new slide-hold-slid");
  CHECK(ran.status == 2);
  CHECK_THAT(ran.error, Contains("did you mean 'slide-hold-slide'?"));
}
