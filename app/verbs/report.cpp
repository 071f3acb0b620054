/// The verb report: a results folder as one page for a browser.
#include <fmt/format.h>

#include <filesystem>

#include "app/report/page.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "core/results_folder.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;

/// What stands there is either nothing or an older report.
void require_replaceable(const fs::path& page) {
  const auto status = fs::symlink_status(page);
  if (!fs::exists(status)) return;
  constexpr std::uintmax_t largest = 100'000'000;  // bytes
  if (fs::is_regular_file(status) && report::is_report(read_found(page, largest))) return;
  throw InputError(
      fmt::format("{}: is no report of rosin and is left alone; --out FILE writes elsewhere", page.string()));
}

Status write_report(const Request& request) {
  const fs::path folder = request.target, page = request.out.empty() ? folder / "report.html" : fs::path(request.out);
  const auto results = report::read_folder(folder);
  require_replaceable(page);
  const auto text = report::page_of(results);
  write_whole(page, text);
  if (!request.quiet)
    for (const auto& [name, why] : results.left_out) tell("note: {} {}: left out\n", (folder / name).string(), why);
  if (!request.quiet) print("Report: {}, {:.0f} kB\n", page.string(), double(text.size()) / 1000);
  return done;
}

}  // namespace

Verb report_verb() {
  return {.name = "report",
          .help = "a results folder as one page for a browser, which needs no network",
          .example = "rosin report out/bristol-board-plane",
          .operands = {{"DIR", &Request::target, "results folder"}},
          .options = {{"--out", &Request::out, "page to write; default DIR/report.html"}, quiet_option},
          .without_scene = write_report};
}

}  // namespace rosin::app::verbs
