/// Man page and completions name every verb and option that the command's own help does.
#include "app/pages/pages.hpp"

#include <catch2/catch.hpp>
#include <regex>

#include "laws/catalogue.hpp"
#include "tests/app/command.hpp"

namespace {

using Catch::Matchers::Contains;

/// What the first group of `pattern` finds, line by line.
std::vector<std::string> found(const std::string& text, const std::string& pattern) {
  const std::regex each(pattern, std::regex::multiline);
  std::vector<std::string> words;
  for (std::sregex_iterator at(text.begin(), text.end(), each), end; at != end; ++at) words.push_back((*at)[1]);
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
  const auto man = without_backslashes(rosin::app::man_page()), bash = rosin::app::bash_completion(),
             zsh = rosin::app::zsh_completion(), fish = rosin::app::fish_completion();
  const auto help = rosin::tests::run_rosin(folder, "--help").out;
  const auto verbs = found(help.substr(help.find("Subcommands:")), "^  ([a-z]+) ");
  CHECK(verbs.size() > 14);
  for (const auto& verb : verbs) {
    const auto in_man = part(man, "\n.SS " + verb + "\n", "\n.S"), in_bash = part(bash, "\n    " + verb + ") ", "\n"),
               in_zsh = part(zsh, "\n  " + verb + ")\n", ";;"),
               in_fish = part(fish, "__fish_seen_subcommand_from " + verb + "'", "-n __fish_use_subcommand");
    const auto usage = rosin::tests::run_rosin(folder, verb + " --help").out;
    const auto options = found(usage, "^  (?:-h,)?--([a-z-]+)");
    CHECK(options.size() > (verb == "help" ? 0 : 2));
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
  CHECK_THAT(rosin::app::man_page(), !Contains(" --"));
  CHECK_THAT(rosin::app::fish_completion(),
             Contains("'draw the pictures of a results folder, or of a scene'\\''s results, again'"));
}
