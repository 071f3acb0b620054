/// Each question is put to a process of its own, as its reader would put it: a crash is a verdict, not the end.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <mutex>

#include "app/companion.hpp"
#include "app/report/verdicts.hpp"
#include "app/results/manifest.hpp"
#include "app/results/result.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/verb.hpp"
#include "app/verify/page.hpp"
#include "core/console.hpp"
#include "core/files.hpp"
#include "core/process.hpp"
#include "core/workers.hpp"

namespace rosin::app::verify {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr double longest = 120;                         ///< s, for one question
constexpr std::uintmax_t largest_result = 500'000'000;  ///< bytes

/// One command and the answers that are taken out of its document.
struct Inquiry {
  std::vector<std::string> arguments;
  fs::path folder;
  std::vector<Answer*> answers;
};

/// What behind `rosin` gives the answer to a question.
std::vector<std::string> arguments_of(const Case& one, const Question& question) {
  auto arguments = question.words;
  arguments.insert(arguments.begin() + (arguments[0] == "lab" ? 2 : 1), one.path.string());
  for (const auto& set : question.overrides) arguments.insert(arguments.end(), {"--set", set});
  if (one.tolerance) arguments.insert(arguments.end(), {"--tolerance", fmt::format("{}", *one.tolerance)});
  return arguments;
}

std::vector<Answer> answers_wanted(const std::vector<Case>& cases) {
  std::vector<Answer> answers;
  for (const auto& one : cases)
    for (std::size_t k = 0; k < one.questions.size(); ++k) {
      const auto& question = one.questions[k];
      Answer answer;
      answer.name = one.questions.size() == 1 ? one.name : fmt::format("{}.{}", one.name, k + 1);
      answer.of = &one;
      answer.question = &question;
      if (question.words.empty()) {
        answer.verdict = Verdict::not_reproduced;
        answer.reason = one.not_reproduced;
      } else {
        answer.command = "rosin";
        for (const auto& word : arguments_of(one, question)) answer.command += " " + shell_word(word);
      }
      answers.push_back(std::move(answer));
    }
  return answers;
}

/// Questions of one case under one command are asked together.
std::vector<Inquiry> inquiries(std::vector<Answer>& answers, const fs::path& folder) {
  std::vector<Inquiry> all;
  std::string last;
  int of_case = 0;
  for (auto& answer : answers) {
    if (answer.command.empty()) continue;
    const auto& one = *answer.of;
    if (all.empty() || all.back().answers.front()->of != &one) of_case = 0;
    if (all.empty() || answer.command != last) {
      auto arguments = arguments_of(one, *answer.question);
      const auto own = folder / one.name / fmt::format("{}", ++of_case);
      arguments.insert(arguments.end(), {"--quiet", "--no-pictures", "--threads", "1", "--time-limit",
                                         fmt::format("{}", longest), "--out", fs::absolute(own).string()});
      all.push_back({std::move(arguments), own, {}});
      last = answer.command;
    }
    all.back().answers.push_back(&answer);
  }
  return all;
}

void ask(const Inquiry& inquiry, const fs::path& program) {
  std::error_code problem;
  const auto result = inquiry.folder / "result.json";
  fs::remove(result, problem);  // of another time
  Command command{program, inquiry.arguments};
  command.stops_with_us = true;
  const auto ran = run_program(command);
  std::string why;
  if (!ran) {
    why = "the command cannot be started";
  } else if (ran->status > verbs::ended_short || !fs::exists(result, problem)) {
    why = presentable(ran->messages.substr(0, 400));
    while (!why.empty() && (why.back() == '\n' || why.back() == ' ')) why.pop_back();
    why = fmt::format("status {}{}{}", ran->status, why.empty() ? "" : ": ", why);
  } else {
    const auto document = ordered_json::parse(read_whole(result, largest_result), nullptr, false);
    for (auto* answer : inquiry.answers) judge(*answer, document);
    return;
  }
  for (auto* answer : inquiry.answers) answer->verdict = Verdict::failed, answer->reason = why;
}

ordered_json to_json(const Answer& answer) {
  const auto numbers = [&](const auto& list) {
    return answer.question->list ? ordered_json(list) : ordered_json(list[0]);
  };
  ordered_json entry{{"name", answer.name},
                     {"group", answer.of->group},
                     {"title", answer.of->title},
                     {"source", answer.of->source},
                     {"origin", name(answer.question->origin)},
                     {"note", answer.of->note},
                     {"what", answer.question->what},
                     {"command", answer.command},
                     {"unit", answer.question->unit.si}};
  const auto wanted = answer.wanted();
  if (wanted.empty())
    std::visit([&](const auto& value) { entry["wanted"] = value; }, answer.question->wanted);
  else
    entry["wanted"] = numbers(std::vector<double>(wanted.begin(), wanted.end()));
  entry["accuracy"] = wanted.empty() ? ordered_json() : numbers(answer.question->accuracy);
  entry["got"] = answer.has_number()   ? numbers(answer.got)
                 : answer.text.empty() ? ordered_json()
                                       : ordered_json(answer.text);
  entry["error"] = answer.has_number() ? numbers(answer.error) : ordered_json();
  entry["difference_over_error"] = answer.has_number() ? ordered_json(answer.over_error()) : ordered_json();
  entry["difference_over_accuracy"] = answer.has_number() ? ordered_json(answer.over_accuracy()) : ordered_json();
  entry["verdict"] = name(answer.verdict);
  entry["reason"] = answer.reason;
  return entry;
}

void say(const std::vector<Answer>& answers) {
  const auto line = [](const auto&... cells) {
    print("{:<38.38} {:<36.36} {:>22.22} {:>24.24} {:>8} {:>9}  {}\n", cells...);
  };
  line("case", "number", "wanted", "got", "/error", "/accuracy", "verdict");
  for (const auto& answer : answers) {
    line(presentable(answer.name), presentable(answer.question->what), presentable(wanted_text(answer)),
         presentable(got_text(answer)), answer.has_number() ? readable_ratio(answer.over_error()) : "–",
         answer.has_number() ? readable_ratio(answer.over_accuracy()) : "–", name(answer.verdict));
    if (!accounted_for(answer.verdict)) print("  {}\n  {}\n", presentable(answer.reason), answer.command);
  }
}

verbs::Status verify(const Request& request) {
  const auto program = fs::read_symlink("/proc/self/exe");
  auto cases = read_cases(request.dossier.empty() ? companion("cases") : fs::path(request.dossier), request.cases);
  if (request.quick) std::erase_if(cases, &Case::slow);
  if (cases.empty()) throw InputError("--quick leaves no case: all that are named are slow");
  const fs::path folder = request.out.empty() ? fs::path("out/verify") : fs::path(request.out);
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) throw InputError(fmt::format("--out {}: cannot be made: {}", folder.string(), problem.message()));

  const auto begin = std::chrono::steady_clock::now();
  auto answers = answers_wanted(cases);
  const auto all = inquiries(answers, folder);
  std::size_t answered = 0;
  bool complete = true;
  try {
    verbs::Progress progress(request.quiet);
    std::mutex showing;
    in_parallel(request.threads, all.size(), [&](std::size_t k) {
      ask(all[k], program);
      const std::scoped_lock lock(showing);
      progress.show(++answered, all.size());
    });
  } catch (const Stopped&) {
    complete = false;
  }

  verbs::results_are_due();
  const bool sound = std::ranges::all_of(answers, [](const Answer& answer) { return accounted_for(answer.verdict); });
  results::Manifest manifest;
  manifest.verb = "verify";
  const Outcome outcome =
      complete ? Outcome{}
               : verbs::why_stopped(
                     {Ending::interrupted, fmt::format("{} of {} commands have answered", answered, all.size())});
  manifest.outcome = outcome;
  manifest.files = write_page(folder, answers);

  auto list = ordered_json::array();
  for (const auto& answer : answers) list.push_back(to_json(answer));
  report::Result told{.label = "verify",
                      .document = {{"verb", "verify"},
                                   {"version", ROSIN_VERSION},
                                   {"outcome", name(outcome.ending)},
                                   {"passed", sound},
                                   {"summary", counted(answers)},
                                   {"seconds", verbs::seconds_since(begin)},
                                   {"cases", std::move(list)}},
                      .manifest = {},
                      .checksum = {}};
  told.document["verdict"] = report::verdict_of(told);
  const auto document = results::text(told.document);
  verbs::draw_pictures(request, folder, manifest);
  manifest.files.emplace_back("verify.json");
  scene::Scene none;
  none.title = "Numbers of others, asked of rosin again";
  verbs::write_results(folder, "verify", document, results::to_json(none, manifest));
  if (request.json) write_output(document);
  if (!request.json && !request.quiet) {
    say(answers);
    print("{} cases in {:.3g} s: {}\nResults: {}\n", cases.size(), verbs::seconds_since(begin), counted(answers),
          (folder / "").string());
  }
  if (!complete) {
    tell("{}: {}\n", name(outcome.ending), outcome.detail);
    return verbs::status_of(outcome);
  }
  return sound ? verbs::done : verbs::ended_short;
}

}  // namespace

}  // namespace rosin::app::verify

namespace rosin::app::verbs {

Verb verify_verb() {
  return {.name = "verify",
          .help = "numbers that others have printed or computed, asked of rosin again",
          .example = "rosin verify slip-weakening-recurrence velocity-step-ageing",
          .operands = {{"CASE", &Request::cases, "cases or groups by name, or files; all if left out", false}},
          .options = {{"--quick", &Request::quick, "only cases that take less than half a second"},
                      {"--cases", &Request::dossier, "folder of cases; default the dossier of this installation"},
                      threads_option("cases at a time; results do not depend on it"),
                      out_option("out/verify/"),
                      json_option,
                      quiet_option},
          .without_scene = verify::verify};
}

}  // namespace rosin::app::verbs
