/// Verbs, options and choices stand in the files of the verbs alone; here is what each reader of them wants them to
/// look like.
#include "app/pages/pages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/command_line.hpp"

namespace rosin::app::pages {

namespace {

std::vector<std::string> names_of(const auto& usages) {
  std::vector<std::string> names;
  for (const auto& usage : usages) names.push_back(usage.name);
  return names;
}

/// `text` with each of `special` behind `escape`.
std::string escaped(std::string_view text, std::string_view special, std::string_view escape) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += escape;
    result += c;
  }
  return result;
}

/// For troff, where a hyphen would be printed as one, which no shell takes for a minus.
std::string troff(std::string_view text) { return escaped(text, "-", "\\"); }
/// Between single quotes of a shell.
std::string in_quotes(std::string_view text) { return "'" + escaped(text, "'", "'\\'") + "'"; }
/// The help of an option within `_arguments` of zsh, which reads brackets and colons.
std::string zsh(std::string_view text) { return escaped(text, "[]:\\", "\\"); }

/// Names that the arguments of a verb are one of.
std::vector<std::string> choices_of(const VerbUsage& verb) {
  std::vector<std::string> choices;
  for (const auto& argument : verb.arguments)
    choices.insert(choices.end(), argument.choices.begin(), argument.choices.end());
  return choices;
}

/// Options of any verb whose value is a file, a folder or a number: no name to complete it by.
std::vector<std::string> options_with_value(const std::vector<VerbUsage>& verbs) {
  std::vector<std::string> options;
  for (const auto& verb : verbs)
    for (const auto& option : verb.options)
      if (!option.value.empty() && std::ranges::find(options, option.name) == options.end())
        options.push_back(option.name);
  return options;
}

std::string entry(const ArgumentUsage& usage) {
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", troff(usage.name),
                     usage.value.empty() ? "" : " \\fI" + usage.value + "\\fR", troff(usage.help));
}

}  // namespace

std::string man_page() {
  std::string page =
      ".\\\" Generated from the command's own tables.\n"
      ".TH ROSIN 1 \"\" \"rosin " ROSIN_VERSION
      "\" \"User Commands\"\n"
      ".SH NAME\nrosin \\- dynamic friction on the command line\n"
      ".SH SYNOPSIS\n.nf\n";
  const auto verbs = verb_usages();
  for (const auto& verb : verbs) {
    page += fmt::format("\\fBrosin {}\\fR", verb.name);
    for (const auto& argument : verb.arguments)
      page += fmt::format(" {0}{1}{2}", argument.required ? "" : "[", argument.name, argument.required ? "" : "]");
    page += " [\\fIOPTION\\fR]...\n";
  }
  page +=
      ".fi\n.SH DESCRIPTION\n"
      "A friction law, a spring\\-mounted slider and a drive, described by a scene (TOML), are asked about steady "
      "sliding,\n"
      "motion, cycles and parameter planes. Every number comes with an estimate of its error.\n"
      ".SH VERBS\n";
  for (const auto& verb : verbs) {
    page += fmt::format(".SS {}\n{}.\n", verb.name, troff(verb.help));
    for (const auto& usage : verb.arguments) {
      auto argument = usage;
      argument.value.clear();
      page += entry(argument);
    }
    for (const auto& option : verb.options) page += entry(option);
  }
  page +=
      ".SH EXIT STATUS\n"
      ".TP\n0\ndone\n"
      ".TP\n1\nthe computation ended short of what was asked, or a file could not be written\n"
      ".TP\n2\nwrong usage or scene: nothing was computed\n"
      ".TP\n130\ninterrupted; a map keeps its finished points, and the same command goes on from there\n"
      ".SH FILES\n"
      ".TP\n\\fIout/SCENE/\\fR\nresults: \\fIresult.json\\fR, columns as NetCDF, pictures\n"
      ".TP\n\\fI../share/rosin/examples\\fR, \\fI../share/rosin/cases\\fR\n"
      "scenes to begin with, and the numbers of others that \\fBrosin verify\\fR asks again, beside the folder of the "
      "command\n"
      ".SH EXAMPLES\n.nf\n"
      "rosin cycle bristol\\-board\\-cycle.toml\n"
      "rosin map bristol\\-board\\-plane.toml \\-\\-set drive.speed=2e\\-5\n"
      ".fi\n";
  return page;
}

std::string bash_completion() {
  const auto verbs = verb_usages();
  std::string text = fmt::format(
      "# Completion of rosin for bash. Generated from the command's own tables.\n"
      "_rosin() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} options= choices=\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" = 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '{} --help --version' -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[COMP_CWORD-1]}} in\n"
      "    {}) return ;; # files\n"
      "  esac\n"
      "  case ${{COMP_WORDS[1]}} in\n",
      fmt::join(names_of(verbs), " "), fmt::join(options_with_value(verbs), "|"));
  for (const auto& verb : verbs)
    text += fmt::format("    {}) options='{}' choices='{}' ;;\n", verb.name, fmt::join(names_of(verb.options), " "),
                        fmt::join(choices_of(verb), " "));
  text +=
      "  esac\n"
      "  case $word in\n"
      "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
      "    *) [ \"$COMP_CWORD\" = 2 ] && COMPREPLY=($(compgen -W \"$choices\" -- \"$word\")) ;;\n"
      "  esac\n"
      "}\n"
      "complete -o default -F _rosin rosin\n";
  return text;
}

std::string zsh_completion() {
  const auto verbs = verb_usages();
  std::string text =
      "#compdef rosin\n"
      "# Completion of rosin for zsh. Generated from the command's own tables.\n"
      "local -a verbs=(\n";
  for (const auto& verb : verbs) text += fmt::format("  {}\n", in_quotes(verb.name + ":" + zsh(verb.help)));
  text +=
      ")\n"
      "if (( CURRENT == 2 )); then\n"
      "  _describe command verbs\n"
      "  _arguments '--help' '--version'\n"
      "  return\n"
      "fi\n"
      "local verb=$words[2]\n"
      "shift words\n"
      "(( CURRENT-- ))\n"
      "case $verb in\n";
  for (const auto& verb : verbs) {
    text += fmt::format("  {})\n    _arguments", verb.name);
    for (const auto& option : verb.options)
      text += fmt::format(" \\\n      {}", in_quotes(fmt::format("{}[{}]{}", option.name, zsh(option.help),
                                                                 option.value.empty() ? "" : ":value:_files")));
    for (const auto& argument : verb.arguments) {
      const auto names = argument.choices.empty() ? "_files" : fmt::format("({})", fmt::join(argument.choices, " "));
      text += fmt::format(" \\\n      {}",
                          in_quotes(fmt::format("{}:{}:{}", argument.required ? "" : ":", argument.name, names)));
    }
    text += " ;;\n";
  }
  return text + "esac\n";
}

std::string fish_completion() {
  const auto verbs = verb_usages();
  std::string text =
      "# Completion of rosin for fish. Generated from the command's own tables.\n"
      "complete -c rosin -n __fish_use_subcommand -l help\n"
      "complete -c rosin -n __fish_use_subcommand -l version\n";
  for (const auto& verb : verbs) {
    text += fmt::format("complete -c rosin -f -n __fish_use_subcommand -a {} -d {}\n", verb.name, in_quotes(verb.help));
    const auto here = fmt::format("complete -c rosin -n '__fish_seen_subcommand_from {}'", verb.name);
    for (const auto& option : verb.options)
      text += fmt::format("{} -l {}{} -d {}\n", here, option.name.substr(2), option.value.empty() ? "" : " -r",
                          in_quotes(option.help));
    if (const auto choices = choices_of(verb); !choices.empty())
      text += fmt::format("{} -a '{}'\n", here, fmt::join(choices, " "));
  }
  return text;
}

}  // namespace rosin::app::pages
