/// The registry of verbs: each tells what it needs and shows a command that works.
#include "app/verbs/verbs.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.hpp"
#include "tests/app/command.hpp"

namespace fs = std::filesystem;
using namespace rosin::app;
using Catch::Matchers::Contains;
using rosin::tests::Folder;
using rosin::tests::run_rosin;

TEST_CASE("the help of each verb names its tables, options with their defaults, and an example", "[app]") {
  std::set<std::string> names;
  for (const auto& verb : verbs::verbs()) {
    INFO(verb.name);
    CHECK(names.insert(verb.name).second);
    const auto help = help_of(verb.name);
    CHECK_THAT(help, Contains(verb.help));
    CHECK_THAT(help, Contains(std::string("Example:\n  rosin ") + verb.name));
    for (const auto& option : verb.options) CHECK_THAT(help, Contains(option.name));
    for (const auto& need : verb.needs) CHECK_THAT(help, Contains(std::string("[") + need.table + "] "));
    CHECK((verb.read != nullptr) == (verb.perform != nullptr));
    CHECK((verb.read == nullptr) == (verb.without_scene != nullptr));
    CHECK_THAT(help_of(""), Contains(verb.help));
  }
  CHECK_THAT(help_of("stress"), Contains("--scenes INT=1000"));
  CHECK_THAT(help_of("run"), Contains("[run]          duration and start") && Contains("[solver]"));
  CHECK_THROWS_AS(help_of("cicle"), rosin::InputError);
}

TEST_CASE("work that its time limit ends has spent its budget, and was not interrupted", "[app]") {
  for (const char* asked : {"basin which-motion", "branch both-motions-in-two-parameters", "branch two-motions",
                            "sweep forced-belt-sweep", "run coulomb-stick-slip", "map guettler-diagram"}) {
    INFO(asked);
    const Folder folder;
    const std::string words = asked, verb = words.substr(0, words.find(' ')), name = words.substr(verb.size() + 1);
    const auto long_run = verb == "run" ? " --set run.duration=1e8" : "";
    const auto ended = run_rosin(folder, verb + " '" ROSIN_SOURCE_DIR "/examples/" + name + ".toml'" + long_run +
                                             " --time-limit 0.05 --json --no-pictures --out out");
    CHECK(ended.status == 1);
    const auto document = nlohmann::json::parse(ended.out);
    CHECK(document["outcome"] == "budget spent");
    CHECK_THAT(document["outcome_detail"].get<std::string>(), Contains("the time limit of 0.05 s has passed"));
  }
}

TEST_CASE("the example of each verb works", "[app][long]") {
  const rosin::tests::Folder folder;
  fs::create_directory_symlink(ROSIN_SOURCE_DIR "/examples", folder.path / "examples");
  for (const auto& verb : verbs::verbs()) {  // a plot draws what the map before it has left
    CAPTURE(verb.example);
    if (verb.name == std::string_view("merge"))  // of shares that were computed before
      for (const std::string share : {"1/2", "2/2"})
        REQUIRE(run_rosin(folder, "map examples/bristol-board-plane.toml --shard " + share).status == 0);
    const auto answer = run_rosin(folder, std::string(verb.example).substr(6));
    INFO(answer.error);
    CHECK(answer.status == 0);
  }
}
