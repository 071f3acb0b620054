/// The verb plot: the pictures of a results folder, drawn again.
#include <fmt/format.h>

#include <filesystem>

#include "app/output/gnuplot.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;

Status plot(const Request& request) {
  const fs::path path = request.target;
  if (!fs::exists(path)) throw InputError(fmt::format("{}: no such file or folder", path.string()));
  const fs::path folder = fs::is_directory(path) ? path : results_folder(request);
  if (!fs::exists(folder / "result.json"))
    throw InputError(fmt::format("{}: holds no results; compute them first, such as with 'rosin map {}'",
                                 (folder / "").string(), path.string()));
  const FolderClaim claim(folder);
  const auto scripts = scripts_of(folder);
  auto drawn = output::draw(folder, scripts.ours, {request.pdf, request.width.value_or(0)});
  for (const auto& script : scripts.foreign)  // a script may run any program
    drawn.problems.push_back(
        fmt::format("{} is not as rosin wrote it, and is left alone; if you trust it, draw it by 'gnuplot {}' in {}",
                    (folder / script).string(), script, (folder / "").string()));
  if (drawn.files.empty() && drawn.problems.empty())
    drawn.problems.push_back(fmt::format("{} holds no pictures", (folder / "").string()));
  if (!request.quiet) {
    for (const auto& problem : drawn.problems) tell("note: {}\n", problem);
    for (const auto& file : drawn.files) print("{}\n", (folder / file).string());
  }
  return drawn.problems.empty() ? done : ended_short;
}

}  // namespace

Verb plot_verb() {
  return {.name = "plot",
          .help = "draw the pictures of a results folder, or of a scene's results, again",
          .example = "rosin plot out/bristol-board-plane",
          .operands = {{"PATH", &Request::target, "results folder or scene"}},
          .options = {out_option("out/<scene>/"), quiet_option, pdf_option, width_option},
          .without_scene = plot};
}

}  // namespace rosin::app::verbs
