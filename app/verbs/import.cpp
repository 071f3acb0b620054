/// The verb import: inputs of other programs as scenes.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

#include "app/imports/format.hpp"
#include "app/program_list.hpp"
#include "app/verbs/verb.hpp"
#include "app/verbs/verbs.hpp"
#include "core/console.hpp"
#include "core/error.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

namespace {

constexpr const char* scene_mark = "imported scene";

/// Reads the scene as its verb will. What it refuses is said of the line of the source that gave the value.
void check(const imports::SceneText& scene, const std::string& source) {
  Request request;
  request.verb = "run";
  request.text = scene.text();
  request.target = scene_mark;
  try {
    read_scene(request);
  } catch (const InputError& error) {
    std::string_view message = error.what();
    const auto begin = fmt::format("{}:", scene_mark);
    int line = 0;
    if (message.starts_with(begin)) {
      message.remove_prefix(begin.size());
      message = message.substr(static_cast<std::size_t>(
          std::from_chars(message.data(), message.data() + message.size(), line).ptr - message.data()));
      message.remove_prefix(std::min(message.size(), message.find(": ") == message.npos ? 0 : message.find(": ") + 2));
    }
    const auto origin = scene.origin(line);
    if (!origin) throw InputError(fmt::format("{}: gives no scene that rosin reads: {}", source, message));
    const auto place = origin->line > 0 ? fmt::format("{}:{}", source, origin->line) : source;
    throw InputError(fmt::format("{}: {}: {}", place, origin->was, message));
  }
}

Status print_import(const Request& request) {
  constexpr std::uintmax_t largest = 1'000'000;  // bytes
  const auto text = read_whole(request.target, largest);
  const auto& format = imports::format_of(request.as, request.target, text);
  const auto scene = format.translate(request.target, text);
  check(scene, request.target);
  if (!request.quiet)
    for (const auto& note : scene.notes()) tell("note: not in the scene: {}\n", note);
  print("# rosin run SCENE.toml\n{}", scene.text());
  return done;
}

}  // namespace

Verb import_verb() {
  return {
      .name = "import",
      .help = "print the input of another program as a scene: rsfmodel, QDYN, EQcycle",
      .example = "rosin import examples/import/velocity-step.py > scene.toml",
      .operands = {{"FILE", &Request::target, "a script or an input file; scripts are read, not run"}},
      .options = {{"--as", &Request::as, "the program, where the file does not show it: " + listed(imports::formats())},
                  quiet_option},
      .without_scene = print_import};
}

}  // namespace rosin::app::verbs
