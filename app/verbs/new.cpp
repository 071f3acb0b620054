/// The verb new: a scene to start from, out of the examples that come with the command.
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "app/companion.hpp"
#include "app/scene/scene_table.hpp"
#include "app/scene/toml_document.hpp"
#include "app/verbs/fit_starter.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;

/// An example that stands alone, and the verb that it is made for.
struct Starter {
  const char *name, *verb;
};
constexpr Starter starters[] = {{"velocity-step", "run"},
                                {"slide-hold-slide", "run"},
                                {"coulomb-stick-slip", "run"},
                                {"harmonic-stick-slip", "run"},
                                {"load-step", "run"},
                                {"block-into-a-stop", "run"},
                                {"drop-on-rough-surface", "run"},
                                {"plane-stick-slip", "run"},
                                {"bowed-string", "run"},
                                {"bristol-board-cycle", "cycle"},
                                {"leine-belt-block", "cycle"},
                                {"formula-law", "cycle"},
                                {"forced-dry-friction", "cycle"},
                                {"pin-on-disk", "stability"},
                                {"brake-two-modes", "stability"},
                                {"two-blocks-on-a-belt", "stability"},
                                {"elastic-block", "stability"},
                                {"bristol-board-plane", "map"},
                                {"guettler-diagram", "map"},
                                {"schelleng-diagram", "map"},
                                {"forced-belt-sweep", "sweep"},
                                {"two-motions", "branch"},
                                {"which-motion", "basin"},
                                {"belt-chaos", "lyapunov"},
                                {"compare-laws", "compare"},
                                {"ageing-or-slip", "compare --design"},
                                {"which-law-plays-the-cello", "compare --design"},
                                {"frf-load-family", "frf"},
                                {"frf-squeal", "frf"},
                                {"lab-inclined-plane", "lab inclined-plane"},
                                {"lab-velocity-step", "lab velocity-step"},
                                {"lab-slide-hold-slide", "lab slide-hold-slide"},
                                {"lab-spring-pulled", "lab spring-pulled"},
                                {"lab-reciprocation", "lab reciprocation"}};

/// "rosin compare FILE --design"
std::string command_of(const Starter& starter, std::string_view file) {
  const std::string verb = starter.verb;
  const auto option = std::min(verb.find(" --"), verb.size());
  return fmt::format("rosin {} {}{}", verb.substr(0, option), file, verb.substr(option));
}

Status print_starter(const Request& request) {
  if (request.target == "fit" && !request.record.empty()) {
    print("{}", fit_starter(request.record));
    return done;
  }
  if (!request.record.empty())
    throw InputError(fmt::format("'{}' is too much: a table is made into a scene by 'rosin new fit {}'", request.record,
                                 request.record));
  const auto folder = companion("examples");
  std::vector<std::string> names;
  for (const auto& starter : starters) {
    const auto path = folder / fmt::format("{}.toml", starter.name);
    if (request.target.empty()) {
      const auto title = scene::read_toml(path.string())["title"].value_or(std::string());
      print("{:<22} {:<22} {}\n", starter.name, starter.verb, title);
    } else if (request.target == starter.name) {
      constexpr std::uintmax_t largest = 1'000'000;  // bytes
      print("# {}\n{}", command_of(starter, "SCENE.toml"), read_whole(path.string(), largest));
      return done;
    }
    names.emplace_back(starter.name);
  }
  if (request.target.empty()) {
    print(
        "\nA scene to change: rosin new {} > scene.toml\nOne that fits a law to your table: rosin new fit record.csv > "
        "fit.toml\n",
        starters[0].name);
    return done;
  }
  throw InputError(
      fmt::format("no scene to start from is named '{}'{}", request.target, scene::suggestion(request.target, names)));
}

}  // namespace

Verb new_verb() {
  std::vector<std::string> names;
  for (const auto& starter : starters) names.emplace_back(starter.name);
  names.emplace_back("fit");
  return {.name = "new",
          .help = "print a scene to start from; alone, list them, each with its verb",
          .example = "rosin new slide-hold-slide > my.toml",
          .operands = {{"STARTER", &Request::target, "one of the list, or fit; the list if left out", false, names},
                       {"TABLE", &Request::record, "of measurements, which a scene for 'rosin fit' is made of", false}},
          .without_scene = print_starter};
}

}  // namespace rosin::app::verbs
