/// Report of the stress suite as text and JSON, and its scenes as TOML.
#include "analysis/studies/stress.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/output/files.hpp"
#include "app/verbs/contact_stress.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"
#include "core/console.hpp"
#include "core/stop.hpp"
#include "laws/catalogue.hpp"

namespace rosin::app::verbs {

namespace {

namespace fs = std::filesystem;
using analysis::studies::Judgement;
using analysis::studies::Question;
using analysis::studies::StressReport;
using analysis::studies::StressScene;
using analysis::studies::Tally;
using analysis::studies::Verdict;
using nlohmann::ordered_json;

std::string toml(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const auto text = fmt::format("{:.17g}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}
std::string toml(const Value& value) {
  if (const auto* number = std::get_if<double>(&value)) return toml(*number);
  std::vector<std::string> numbers;
  for (const double x : std::get<std::vector<double>>(value)) numbers.push_back(toml(x));
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string in_words(const Judgement& judgement) {
  return fmt::format("{}{}{}", name(judgement.verdict), judgement.reason.empty() ? "" : ": ", judgement.reason);
}

/// The scene as a file that the ordinary verbs read; `judgement` in words, or "drawn".
std::string toml(const StressScene& scene, const std::string& judgement) {
  std::string text = fmt::format("# rosin {} FILE: {}\n", name(scene.question), judgement);
  text += fmt::format("# Drawn by: rosin stress --seed {} --only {}\ntitle = \"stress {} of seed {}\"\n", scene.seed,
                      scene.index, scene.index, scene.seed);
  std::string table = "law";
  text += fmt::format("\n[law]\ntype = \"{}\"\n", scene.law->card().name);
  for (const std::string part : {"law", "law.contact_stiffness", "oscillator", "drive"})
    for (const auto& [path, value] : scene.settings) {
      const auto dot = path.rfind('.');
      if (path.substr(0, dot) != part) continue;
      if (part != table) {
        text += fmt::format("\n[{}]\n", part);
        table = part;
      }
      text += fmt::format("{} = {}\n", path.substr(dot + 1), toml(value));
    }
  if (scene.question == Question::cycle) text += "\n[cycle]\n";
  if (scene.question == Question::run) {
    const auto& run = scene.run;
    text += fmt::format("\n[run]\nduration = {}\nsamples = {}\n", toml(run.duration), run.samples);
    using Kind = analysis::motion::Start::Kind;
    text += run.start.kind == Kind::steady ? std::string("start = \"steady\"\n")
            : run.start.kind == Kind::rest ? std::string("start = \"rest\"\n")
                                           : fmt::format("start = {{ slip_rate = {} }}\n", toml(*run.start.slip_rate));
  }
  return text;
}

ordered_json tallies(const std::map<std::string, Tally>& table, long total) {
  auto object = ordered_json::object();
  for (const auto& [kind, tally] : table)
    object[kind] = {{"count", tally.count},
                    {"share", total > 0 ? double(tally.count) / double(total) : 0},
                    {"example", tally.example}};
  return object;
}

ordered_json to_json(const StressReport& report, std::uint64_t seed) {
  auto slowest = ordered_json::array();
  for (const auto& [seconds, index] : report.slowest) slowest.push_back({{"index", index}, {"seconds", seconds}});
  const long asked = report.scenes - report.refusals();
  return {{"verb", "stress"},
          {"version", ROSIN_VERSION},
          {"seed", seed},
          {"passed", report.passed()},
          {"complete", report.complete},
          {"scenes", report.scenes},
          {"questions", tallies(report.questions, report.scenes)},
          {"certified", report.certified},
          {"less_exact", tallies(report.less_exact, report.scenes)},
          {"none_exists", report.none_exists},
          {"refused", tallies(report.refused, report.scenes)},
          {"failures", tallies(report.failures, asked)},
          {"failure_share", report.failure_share()},
          {"wrong", report.wrong},
          {"not_finite", report.not_finite},
          {"crashed", report.crashed},
          {"alarms", tallies(report.alarms, report.scenes)},
          {"compared", report.compared},
          {"coverage", report.coverage()},
          {"worst_error_ratio", report.worst_error_ratio},
          {"seconds", report.seconds},
          {"slowest", slowest}};
}

void say(const StressReport& report) {
  print(
      "{} scenes in {:.3g} s: {} certified, {} less exactly than asked, {} where none exists, {} refused, "
      "{} failures ({:.2f} %)\n",
      report.scenes, report.seconds, report.certified, StressReport::sum(report.less_exact), report.none_exists,
      report.refusals(), report.failed(), 100 * report.failure_share());
  print("wrong numbers {}, not finite {}, crashes {}\n", report.wrong, report.not_finite, report.crashed);
  print("stated errors cover {:.2f} % of {} compared results; worst ratio among the certified {:.2f}\n",
        100 * report.coverage(), report.compared, report.worst_error_ratio);
  const auto list = [](const char* title, const std::map<std::string, Tally>& table) {
    if (table.empty()) return;
    print("{}\n", title);
    for (const auto& [kind, tally] : table) print("  {:6}  {} (such as {})\n", tally.count, kind, tally.example);
  };
  list("Certified, less exactly than asked", report.less_exact);
  list("Refused", report.refused);
  list("Failures", report.failures);
  list("Alarms", report.alarms);
  if (!report.slowest.empty())
    print("slowest: scene {} with {:.3g} s\n", report.slowest.front().second, report.slowest.front().first);
}

Status stress(const Request& request) {
  if (request.target == "contacts") return stress_contacts(request);
  const fs::path folder =
      request.out.empty() ? fs::path("out") / fmt::format("stress-{}", request.seed) : fs::path(request.out);
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) throw InputError(fmt::format("--out {}: cannot be made: {}", folder.string(), problem.message()));
  const auto keep = [&](const StressScene& scene, const std::string& judgement) {
    const auto path = folder / fmt::format("scene-{}.toml", scene.index);
    write_whole(path, toml(scene, judgement));
    return path.string();
  };
  const bool single = request.only >= 0;
  const long first = single ? request.only : 0;
  const auto count = std::size_t(single ? 1 : request.scenes);
  if (request.draw) {
    const analysis::studies::Laws laws = laws::catalogue();
    for (long i = first; i < first + long(count); ++i) {
      end_if_stopped();
      keep(analysis::studies::draw_scene(laws, request.seed, i), "drawn");
    }
    if (!request.quiet) print("{} scenes in {}\n", count, (folder / "").string());
    return done;
  }
  std::size_t judged = 0;
  StressReport report;
  {
    Progress progress(request.quiet);
    report = analysis::studies::stress({.laws = laws::catalogue(),
                                        .seed = request.seed,
                                        .first = first,
                                        .scenes = long(count),
                                        .threads = request.threads},
                                       {.finished =
                                            [&](const StressScene& scene, const Judgement& judgement) {
                                              progress.show(++judged, count);
                                              const bool fails = judgement.verdict >
                                                                 Verdict::refused;  // from there on they must not be
                                              if (!fails && !single) return;
                                              const auto path = keep(scene, in_words(judgement));
                                              if (!request.quiet && !progress.visible())
                                                tell("{}: {}: {}\n", path, name(judgement.verdict), judgement.reason);
                                            },
                                        .hung =
                                            [&](const StressScene& scene) {
                                              const auto path = keep(scene, "hung: no answer in time");
                                              tell("{}: hung; the suite cannot go on\n", path);
                                              _exit(ended_short);
                                            }});
  }
  const auto document =
      to_json(report, request.seed).dump(1, ' ', false, ordered_json::error_handler_t::replace) + '\n';
  write_whole(folder / "result.json", document);
  if (request.json)
    write_output(document);
  else if (!request.quiet)
    say(report);
  if (!report.complete) {
    const Outcome stopped =
        why_stopped({Ending::interrupted, fmt::format("{} of {} scenes are judged", judged, count)});
    tell("{}: {}\n", name(stopped.ending), stopped.detail);
    return status_of(stopped);
  }
  return report.passed() ? done : ended_short;
}

}  // namespace

Verb stress_verb() {
  return {.name = "stress",
          .help = "random scenes over ten decades, each certified by a second method or refused with a reason",
          .example = "rosin stress --seed 2 --scenes 20",
          .operands = {{"WHAT",
                        &Request::target,
                        "sliders if left out, or contacts: elastic blocks and pins on disks",
                        false,
                        {"contacts"}}},
          .options = {{"--seed", &Request::seed, "of the random scenes"},
                      {"--scenes", &Request::scenes, "number of scenes"},
                      {"--only", &Request::only, "one scene by its number"},
                      {"--draw", &Request::draw, "write the scenes as files, judge none"},
                      threads_option("threads; results do not depend on it"),
                      out_option("out/stress-SEED/"),
                      json_option,
                      quiet_option},
          .without_scene = stress};
}

}  // namespace rosin::app::verbs
