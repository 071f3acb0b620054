/// Parsing by CLI11, with suggestions for misspelt verbs and options.
#include "app/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>
#include <type_traits>

#include "app/output/sheet.hpp"
#include "app/verbs/mail.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "core/error.hpp"

namespace rosin::app {

namespace {

constexpr int wrong_usage = 2;

int refuse(const std::string& text) {
  tell("rosin: {}\n", text);
  return wrong_usage;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
  const auto near = nearest_name(name, known);
  return near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near);
}

/// Defaults of numbers are shown where they are more than "none".
template <class T>
void add(CLI::App& command, const verbs::Option& option, T& target) {
  if constexpr (std::is_same_v<T, bool>)
    command.add_flag(option.name, target, option.help);
  else if constexpr (std::is_same_v<T, std::set<std::string>>)
    command.add_flag_callback(
        option.name, [&target, name = std::string(option.name + 2)] { target.insert(name); }, option.help);
  else if constexpr (std::is_arithmetic_v<T>)
    command.add_option(option.name, target, option.help)->capture_default_str();
  else if constexpr (std::is_same_v<T, std::string>)  // empty is what a variable that is not set leaves in a script
    command.add_option(option.name, target, option.help)->capture_default_str()->check([](const std::string& given) {
      return given.empty() ? std::string("is empty; leave the option out, or say what it is") : std::string();
    });
  else
    command.add_option(option.name, target, option.help)->allow_extra_args(false);
}

/// "one SCENE", "one EXPERIMENT and one SCENE".
std::string operands_of(const verbs::Verb& verb) {
  std::vector<std::string> words;
  for (const auto& operand : verb.operands) words.push_back(fmt::format("one {}", operand.name));
  return words.empty() ? "no scene" : fmt::format("{}", fmt::join(words, " and "));
}

/// What help says below the options.
std::string footer(const verbs::Verb& verb) {
  std::string text;
  if (!verb.needs.empty()) text += "Tables of the scene:\n";
  for (const auto& need : verb.needs)
    text +=
        fmt::format("  {:<14} {}{}\n", fmt::format("[{}]", need.table), need.what, need.optional ? " (optional)" : "");
  return text + fmt::format("Example:\n  {}\n", verb.example);
}

/// The parser of all verbs, which writes into the request.
void describe(CLI::App& app, Request& request) {
  request.threads = verbs::launched() ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  app.set_version_flag("--version", fmt::format("rosin {}", ROSIN_VERSION));
  app.require_subcommand(1);
  app.allow_extras();
  app.footer("'rosin help VERB' tells what a verb needs, its options and an example.");
  for (const auto& verb : verbs::verbs()) {
    auto* command = app.add_subcommand(verb.name, verb.help);
    command->allow_extras();
    command->footer(footer(verb));
    command->callback([&request, name = std::string(verb.name)] { request.verb = name; });
    for (const auto& operand : verb.operands) {
      auto* added = std::visit(
          [&](auto member) -> CLI::Option* {
            using T = std::remove_reference_t<decltype(request.*member)>;
            if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::set<std::string>>)
              return nullptr;
            else
              return command->add_option(operand.name, request.*member, operand.help);
          },
          operand.target);
      added->required(operand.required);
      if (operand.checked) added->check(CLI::IsMember(operand.choices));
    }
    for (const auto& option : verb.options)
      std::visit([&](auto member) { add(*command, option, request.*member); }, option.target);
    if (verb.name != std::string_view("help"))
      command->add_option("--time-limit", request.time_limit,
                          "seconds after which the work ends in order, with status 1");
  }
}

}  // namespace

std::vector<VerbUsage> verb_usages() {
  Request request;
  CLI::App app;
  describe(app, request);
  std::vector<VerbUsage> usages;
  for (const auto* command : app.get_subcommands({})) {
    usages.push_back({command->get_name(), command->get_description(), {}, {}});
    const auto& operands = verbs::find_verb(command->get_name()).operands;
    for (const auto* option : command->get_options()) {
      const auto value = option->get_items_expected_max() > 0 ? option->get_type_name() : std::string();
      auto help = option->get_description();
      if (const auto standard = option->get_default_str(); !standard.empty()) help += "; default " + standard;
      if (!option->get_positional()) {
        usages.back().options.push_back({"--" + option->get_lnames().front(), value, help, false, {}});
        continue;
      }
      const auto name = option->get_name(true);
      const auto operand =
          std::ranges::find(operands, name, [](const verbs::Operand& one) { return std::string(one.name); });
      usages.back().arguments.push_back({name, value, help, option->get_required(), operand->choices});
    }
  }
  return usages;
}

std::string help_of(const std::string& verb) {
  Request request;
  CLI::App app("rosin: dynamic friction on the command line", "rosin");
  describe(app, request);
  return verb.empty() ? app.help() : app.get_subcommand(verbs::find_verb(verb).name)->help("rosin");
}

std::variant<Request, int> parse_command_line(int argc, char** argv) {
  try {
    if (argc > 1 && argv[1][0] != '-') verbs::find_verb(argv[1]);
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  Request request;
  CLI::App app("rosin: dynamic friction on the command line", "rosin");
  describe(app, request);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return refuse(fmt::format("{}\nSee 'rosin --help'.", error.what()));
  }
  const auto* command = app.get_subcommands().front();
  for (const auto& extra : app.remaining(true)) {
    std::vector<std::string> options;
    for (const auto* option : command->get_options())
      for (const auto& name : option->get_lnames()) options.push_back("--" + name);
    const auto word = extra.substr(0, extra.find('='));
    return refuse(extra.starts_with('-')
                      ? fmt::format("'{}' has no option '{}'{}", request.verb, word, did_you_mean(word, options))
                      : fmt::format("'{}' takes {}, '{}' is too much", request.verb,
                                    operands_of(verbs::find_verb(request.verb)), extra));
  }
  try {
    if (request.tolerance) require(*request.tolerance, {1e-13, 0.1}, "--tolerance", "relative accuracy", "1");
    if (request.width)
      require(*request.width, {output::least_width, output::most_width}, "--width", "width of pictures in print", "mm");
    if (request.time_limit) require(*request.time_limit, {1e-3, 1e9}, "--time-limit", "time for all work", "s");
    require(request.threads, {1, 4096}, "--threads", "number of threads", "1");
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  return request;
}

}  // namespace rosin::app
