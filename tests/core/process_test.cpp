/// Other programs: found as from here, and given their arguments as they are.
#include "core/process.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <thread>

#include "core/stop.hpp"
#include "tests/app/folder.hpp"
#include "tests/printable_texts.hpp"

using namespace rosin;
using rosin::tests::Folder;

namespace fs = std::filesystem;

TEST_CASE("arguments reach a program as they are, whatever a shell would make of them", "[process]") {
  const Folder folder;
  const std::vector<std::string> arguments = {
      "-c", "printf '%s|' \"$@\" \"$GIVEN\"; pwd", "sh", "it's", "$(date)", "`date`; exit 3", "a b"};
  const auto ran = run_program({"/bin/sh", arguments, folder.path, {"GIVEN=here"}});
  REQUIRE(ran);
  CHECK(ran->status == 0);
  CHECK(ran->output == "it's|$(date)|`date`; exit 3|a b|here|" + fs::canonical(folder.path).string() + "\n");
  CHECK(run_program({"/bin/sh", {"-c", "exit 3"}})->status == 3);
  CHECK(run_program({"/bin/sh", {"-c", "kill -9 $$"}})->status == 128 + 9);
  CHECK(run_program({"/bin/sh", {"-c", "head -c 1000000 /dev/zero"}})->output.size() == 65536);
  CHECK(run_program({"/bin/sh", {"-c", "printf '%s' \"$HOME\"; env | grep -c ^HOME="}, {}, {"HOME=there"}})->output ==
        "there1\n");
  const std::string text(200'000, 'x');  // more than a pipe holds
  CHECK(run_program({.program = "/bin/cat", .arguments = {}, .input = text, .longest_output = 1 << 20})->output ==
        text);
  const auto both = run_program({"/bin/sh", {"-c", "head -c 1000000 /dev/zero >&2; echo done; echo why >&2"}});
  CHECK(both->output == "done\n");
  CHECK(both->messages.size() == 65536);
  CHECK_FALSE(run_program({folder.path / "none", {}}));
}

TEST_CASE("a program that stops with its caller is ended", "[process]") {
  std::stop_source stop;
  const Listening listening(stop.get_token());
  Command sleep{"/bin/sh", {"-c", "exec sleep 100"}};
  sleep.stops_with_us = true;
  std::jthread asks([&] { stop.request_stop(); });
  CHECK_THROWS_AS(run_program(sleep), Stopped);
  sleep.arguments[1] = "exit 4";
  sleep.stops_with_us = false;  // as pictures of work that was stopped are still drawn
  CHECK(run_program(sleep)->status == 4);
}

TEST_CASE("a program is looked for once, from where the command was given", "[process]") {
  const Folder folder;
  const auto tool = folder.path / "rosin-test-tool";
  std::ofstream(tool) << "#!/bin/sh\n";
  fs::permissions(tool, fs::perms::owner_all);
  const std::string before = std::getenv("PATH");
  const auto here = fs::current_path();
  fs::current_path(folder.path);
  setenv("PATH", ("/none:.:" + before).c_str(), 1);
  const auto found = find_program("rosin-test-tool");
  CHECK(find_program("sh"));
  CHECK_FALSE(find_program("rosin-test-none"));
  setenv("PATH", before.c_str(), 1);
  fs::current_path(here);
  REQUIRE(found);
  CHECK(found->is_absolute());
  CHECK(fs::equivalent(*found, tool));
}

TEST_CASE("a word of a command line that is copied reaches the program as it was", "[process]") {
  CHECK(shell_word("map.x.points=40") == "map.x.points=40");
  for (const std::string word : {"it's", "a b", "", "$(date)", "[1, 2]", "\"q\"", "~", "µ; exit 3", "a\nb"}) {
    const auto ran = run_program({"/bin/sh", {"-c", "printf %s " + shell_word(word)}});
    REQUIRE(ran);
    CHECK(ran->output == word);
  }
  std::string line = "printf '%s\\n'", wanted;
  for (const auto& text : tests::printable_texts()) line += " " + shell_word(text), wanted += text + "\n";
  const auto ran = run_program({"/bin/sh", {"-c", line}});
  REQUIRE(ran);
  CHECK(ran->output == wanted);
}
