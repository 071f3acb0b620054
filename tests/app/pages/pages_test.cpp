/// Man page and completions name every verb and option that the command's own help does.
#include "app/pages/pages.hpp"

#include <catch2/catch.hpp>
#include <sstream>

#include "laws/catalogue.hpp"
#include "tests/app/command.hpp"

namespace {

using Catch::Matchers::Contains;

/// The words of small letters and hyphens that follow `before` at the beginning of a line.
std::vector<std::string> words_after(const std::string& before, const std::string& text) {
  std::vector<std::string> words;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(before, 0) != 0) continue;
    const auto end = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", before.size());
    if (end != before.size()) words.push_back(line.substr(before.size(), end - before.size()));
  }
  return words;
}

std::string without_backslashes(std::string text) {
  std::erase(text, '\\');
  return text;
}

/// From the line that begins with `begin` to the one that begins with `end`.
std::string part(const std::string& text, const std::string& begin, const std::string& end) {
  const auto from = text.find(begin);
  REQUIRE(from != std::string::npos);
  return text.substr(from, text.find(end, from + begin.size()) - from);
}

}  // namespace

TEST_CASE("man page and completions name every verb and option of the command", "[pages]") {
  const rosin::tests::Folder folder;
  const auto man = without_backslashes(rosin::app::pages::man_page()), bash = rosin::app::pages::bash_completion(),
             zsh = rosin::app::pages::zsh_completion(), fish = rosin::app::pages::fish_completion();
  const auto help = rosin::tests::run_rosin(folder, "--help").out;
  const auto verbs = words_after("  ", help.substr(help.find("Subcommands:")));
  CHECK(verbs.size() > 14);
  for (const auto& verb : verbs) {
    const auto in_man = part(man, "\n.SS " + verb + "\n", "\n.S"), in_bash = part(bash, "\n    " + verb + ") ", "\n"),
               in_zsh = part(zsh, "\n  " + verb + ")\n", ";;"),
               in_fish = part(fish, "__fish_seen_subcommand_from " + verb + "'", "-n __fish_use_subcommand");
    const auto usage = rosin::tests::run_rosin(folder, verb + " --help").out;
    const auto options = words_after("  --", usage);
    CHECK((verb == "help" || verb == "new" || options.size() > 1));
    for (const auto& option : options) {
      INFO(verb << " --" << option);
      CHECK_THAT(in_man, Contains("fB--" + option + "fR"));
      CHECK_THAT(in_bash, Contains("--" + option));
      CHECK_THAT(in_zsh, Contains("--" + option + "["));
      CHECK_THAT(in_fish, Contains("-l " + option + " "));
    }
  }
  for (const auto& law : rosin::laws::catalogue()) CHECK_THAT(bash, Contains(law->card().name.data()));
}

TEST_CASE("what troff and shells read as their own is escaped", "[pages]") {
  CHECK_THAT(rosin::app::pages::man_page(), !Contains(" --"));
  CHECK_THAT(rosin::app::pages::fish_completion(),
             Contains("'draw the pictures of a results folder, or of a scene'\\''s results, again'"));
}
