/// The verb branch: what it refuses, and that it follows cycles where steady sliding is never stable.
#include <catch2/catch.hpp>

#include "tests/app/command.hpp"

using Catch::Matchers::Contains;
using namespace rosin::tests;

TEST_CASE("wrong keys of a branch are refused with their range or the nearest name", "[app][branches]") {
  const Folder folder;
  const auto refused = [&](const std::string& change, const std::string& why) {
    const auto answer = run_rosin(folder, "branch " ROSIN_SOURCE_DIR "/examples/two-motions.toml --set " + change);
    INFO(change);
    CHECK(answer.status == 2);
    CHECK_THAT(answer.error, Contains(why));
  };
  refused("branch.parameter=drive.sped", "did you mean 'drive.speed'?");
  refused("branch.strt=1", "unknown key 'strt' in [branch]; did you mean 'start'?");
  refused("branch.to=0.5", "branch.from and branch.to are both 0.5");
  refused("branch.values=[7]", "branch.values: 7 is not between from (0.5) and to (2.5)");
  refused("branch.doublings=99", "branch.doublings = 99");
  refused("branch.from=-1 --set branch.scale=log", "needs from and to on one side of 0");
  refused("oscillator.mass=0", "mass");
  refused("branch.start=cycle --set branch.from=2 --set branch.values=[2.2]", "the motion settles on no cycle");
}

TEST_CASE("a branch tells its points and events, and goes on from stick-slip where sliding is never stable",
          "[app][branches]") {
  const Folder folder;
  const auto answer =
      run_rosin(folder, "branch " ROSIN_SOURCE_DIR
                        "/examples/leine-belt-block.toml --set branch.parameter=drive.speed --set branch.from=0.1 "
                        "--set branch.to=0.3 --no-pictures --json");
  INFO(answer.error);
  REQUIRE(answer.status == 0);
  CHECK_THAT(answer.out, Contains("\"kind\": \"equilibrium\"") && Contains("\"kind\": \"cycle\"") &&
                             Contains("\"events\"") && Contains("\"stick_fraction\""));
  CHECK_THAT(answer.error, Contains("steady sliding is unstable throughout"));
}
