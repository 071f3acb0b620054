/// The verb bench: run time against true error beside other solvers.
#include "bench/bench.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

namespace {

Status bench(const Request& request) {
  const bool sound = ::bench::run({.what = request.target,
                                   .quick = request.quick,
                                   .json = request.json,
                                   .quiet = request.quiet,
                                   .folder = request.out.empty() ? "out/bench-" + request.target : request.out,
                                   .limit = request.limit,
                                   .python = request.python});
  return sound ? done : ended_short;
}

}  // namespace

Verb bench_verb() {
  return {
      .name = "bench",
      .help = "run time against true error beside other solvers",
      .example = "rosin bench cycle --quick",
      .operands = {{"WHAT", &Request::target, fmt::format("{}", fmt::join(::bench::names(), ", ")), true,
                    ::bench::names(), true}},
      .options = {out_option("out/bench-<WHAT>/"),
                  quiet_option,
                  json_option,
                  {"--quick", &Request::quick, "few points and tolerances: checks in seconds that everything works"},
                  {"--python", &Request::python, "Python with SciPy; without it SciPy is left out"},
                  {"--limit", &Request::limit, "seconds for all tolerances of one solver"}},
      .without_scene = bench};
}

}  // namespace rosin::app::verbs
