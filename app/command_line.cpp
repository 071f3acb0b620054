/// Parsing by CLI11, with suggestions for misspelt verbs and options.
#include "app/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

#include "analysis/lab/experiment.hpp"
#include "bench/bench.hpp"
#include "core/console.hpp"
#include "core/error.hpp"
#include "laws/catalogue.hpp"

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

struct VerbHelp {
  const char *name, *target, *help;
};
constexpr VerbHelp verbs[] = {
    {"laws", "LAW", "list friction laws with parameters, units, ranges and sources"},
    {"curve", "SCENE", "steady friction curve and its extrema"},
    {"stability", "SCENE", "steady sliding, its eigenvalues and Hopf points"},
    {"run", "SCENE", "motion from a given start"},
    {"cycle", "SCENE", "periodic motion, its multipliers and metrics"},
    {"map", "SCENE", "regimes and metrics over a parameter plane"},
    {"compare", "SCENE", "several laws or parameter sets side by side; --design: which measurement tells them apart"},
    {"frf", "SCENE", "friction frequency response: how friction answers small changes of slip rate and load"},
    {"fit", "SCENE", "parameters of laws from responses, velocity steps, steady curves and holds; laws ranked"},
    {"lab", "SCENE", "an experiment as it is done in the laboratory: its record and what is read off it"},
    {"study", "SCENE", "the published force algorithms against exact stick-slip over random oscillators"},
    {"verify", "CASE", "numbers that others have printed or computed, asked of rosin again"},
    {"stress", "", "random scenes over ten decades, each certified by a second method or refused with a reason"},
    {"bench", "WHAT", "run time against true error beside other solvers"},
    {"plot", "PATH", "draw the pictures of a results folder, or of a scene's results, again"},
};

/// The names that an argument is one of; none for files.
std::vector<std::string> names_for(std::string_view argument) {
  std::vector<std::string> names;
  if (argument == "LAW")
    for (const auto& law : laws::catalogue()) names.emplace_back(law->card().name);
  if (argument == "EXPERIMENT")
    for (const auto& experiment : analysis::lab::experiments()) names.emplace_back(experiment.name);
  if (argument == "WHAT") names = ::bench::names();
  return names;
}

/// Verbs with their arguments and options, which parsing writes into `request`.
void add_verbs(CLI::App& app, Request& request) {
  app.set_version_flag("--version", fmt::format("rosin {}", ROSIN_VERSION));
  app.require_subcommand(1);
  app.allow_extras();
  for (const auto& verb : verbs) {
    auto* command = app.add_subcommand(verb.name, verb.help);
    command->allow_extras();
    const std::string name = verb.name;
    command->callback([&request, name] { request.verb = name; });
    command->add_option("--time-limit", request.time_limit,
                        "seconds after which the work ends in order, with status 1");
    if (name == "stress") {
      command->add_option("--seed", request.seed, "of the random scenes")->capture_default_str();
      command->add_option("--scenes", request.scenes, "number of scenes")->capture_default_str();
      command->add_option("--only", request.only, "one scene by its number");
      command->add_flag("--draw", request.draw, "write the scenes as files, judge none");
      command->add_option("--threads", request.threads, "threads; results do not depend on it")
          ->default_str("all cores");
      command->add_option("--out", request.out, "results folder; default out/stress-SEED/");
      command->add_flag("--json", request.json, "print the result as JSON, and nothing else");
      command->add_flag("--quiet", request.quiet, "say nothing but errors");
      continue;
    }
    if (name == "verify") {
      command->add_option("CASE", request.cases, "cases or groups by name, or files; all if left out");
      command->add_flag("--quick", request.quick, "only cases that take less than half a second");
      command->add_option("--cases", request.dossier, "folder of cases; default the dossier of this installation");
      command->add_option("--threads", request.threads, "cases at a time; results do not depend on it")
          ->default_str("all cores");
      command->add_option("--out", request.out, "results folder; default out/verify/");
      command->add_flag("--json", request.json, "print the result as JSON, and nothing else");
      command->add_flag("--quiet", request.quiet, "say nothing but errors");
      continue;
    }
    if (name == "lab")
      command->add_option("EXPERIMENT", request.experiment)
          ->required()
          ->description(fmt::format("{}", fmt::join(names_for("EXPERIMENT"), ", ")));
    auto* target = command->add_option(verb.target, request.target);
    if (name == "laws") {
      target->description("one law; all if left out");
    } else {
      target->required()->description(name == "plot" ? "results folder or scene" : "scene file (TOML)");
      command->add_option("--out", request.out, "results folder; default out/<scene>/");
      command->add_flag("--quiet", request.quiet, "say nothing but errors");
    }
    if (name != "plot") command->add_flag("--json", request.json, "print the result as JSON, and nothing else");
    if (name == "bench") {
      const auto benches = names_for("WHAT");
      target->description(fmt::format("{}", fmt::join(benches, ", ")))->check(CLI::IsMember(benches));
      command->add_flag("--quick", request.quick, "few points and tolerances: checks in seconds that everything works");
      command->add_option("--python", request.python, "Python with SciPy; without it SciPy is left out")
          ->default_val("/usr/bin/python3");
      command->add_option("--limit", request.limit, "seconds for all tolerances of one solver")->capture_default_str();
    }
    if (name == "laws" || name == "plot" || name == "bench") continue;
    command->add_option("--set", request.overrides, "path=value: change the scene, such as drive.speed=1e-5")
        ->allow_extra_args(false);
    command->add_option("--tolerance", request.tolerance, "relative accuracy of every result");
    command->add_option("--threads", request.threads, "threads of a map; results do not depend on it")
        ->default_str("all cores");
    command->add_flag("--no-pictures", request.no_pictures,
                      "write no pictures, only what 'rosin plot' draws them from");
    if (name == "compare")
      command->add_flag("--design", request.design, "where, and by how many repeats, measurements tell members apart");
    if (name == "map") command->add_flag("--exact", request.exact, "compute every point of a map, interpolate none");
    command->add_flag("--explain", request.explain, "say on standard error what is computed how, and what is skipped");
  }
}

}  // namespace

std::vector<VerbUsage> verb_usages() {
  Request request;
  CLI::App app;
  add_verbs(app, request);
  std::vector<VerbUsage> usages;
  for (const auto* command : app.get_subcommands({})) {
    usages.push_back({command->get_name(), command->get_description(), {}, {}});
    for (const auto* option : command->get_options()) {
      const auto value = option->get_items_expected_max() > 0 ? option->get_type_name() : std::string();
      auto help = option->get_description();
      if (const auto standard = option->get_default_str(); !standard.empty()) help += "; default " + standard;
      if (option->get_positional())
        usages.back().arguments.push_back(
            {option->get_name(true), value, help, option->get_required(), names_for(option->get_name(true))});
      else
        usages.back().options.push_back({"--" + option->get_lnames().front(), value, help, false, {}});
    }
  }
  return usages;
}

std::variant<Request, int> parse_command_line(int argc, char** argv) {
  std::vector<std::string> names;
  for (const auto& verb : verbs) names.emplace_back(verb.name);
  if (argc > 1 && argv[1][0] != '-' && std::ranges::find(names, argv[1]) == names.end())
    return refuse(fmt::format("unknown command '{}'{}\nCommands: {}", argv[1], did_you_mean(argv[1], names),
                              fmt::join(names, ", ")));

  Request request;
  request.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  CLI::App app("rosin: dynamic friction on the command line", "rosin");
  add_verbs(app, request);

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
                                    request.verb == "stress" ? "no scene"
                                    : request.verb == "laws" ? "one law"
                                    : request.verb == "lab"  ? "one experiment and one scene"
                                                             : "one path",
                                    extra));
  }
  try {
    if (request.tolerance) require(*request.tolerance, {1e-13, 0.1}, "--tolerance", "relative accuracy", "1");
    if (request.time_limit) require(*request.time_limit, {1e-3, 1e9}, "--time-limit", "time for all work", "s");
    require(request.threads, {1, 4096}, "--threads", "number of threads", "1");
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  return request;
}

}  // namespace rosin::app
