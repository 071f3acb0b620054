/// The scene of a verb, its summary, and its results folder.
#include "app/job.hpp"

#include <fmt/ranges.h>

#include "app/files.hpp"
#include "app/gnuplot.hpp"

namespace rosin::app {

namespace fs = std::filesystem;

std::string justified(double value, double error, std::string_view unit) {
  const auto suffix = unit == "1" ? std::string() : fmt::format(" {}", unit);
  if (!std::isfinite(value)) return "none";
  if (std::isinf(error)) return fmt::format("{:.6g}{}, of unknown error", value, suffix);
  if (!(error > 0) || value == 0) return fmt::format("{:.10g}{}", value, suffix);
  const double digits = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(error)) + 1;
  return fmt::format("{:.{}g} ± {:.0e}{}", value, static_cast<int>(std::clamp(digits, 1.0, 16.0)), error, suffix);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

fs::path results_folder(const Request& request, const std::string& scene_name) {
  return request.out.empty() ? fs::path("out") / scene_name : fs::path(request.out);
}

Job::Job(const Request& request, Verb verb)
    : request_(request),
      scene_(read_scene(request.target, request.overrides, verb, request.experiment)),
      folder_(results_folder(request, scene_.name)) {
  std::error_code problem;
  fs::create_directories(folder_, problem);
  if (problem) throw InputError(fmt::format("--out {}: cannot be made: {}", folder_.string(), problem.message()));
  for (const auto& text : scene_.notes) note(text);
  manifest_.verb = request.verb;
  manifest_.overrides = request.overrides;
}

void Job::note(std::string_view text) const {
  if (!request_.quiet) fmt::print(stderr, "note: {}\n", text);
}

void Job::explain_model() const {
  if (!request_.explain) return;
  const auto& model = scene_.model;
  const auto& law = *model.law;
  std::vector<std::string> states;
  for (const auto& state : law.states())
    states.push_back(state.name + (state.scale == Scale::log ? " (as its logarithm)" : ""));
  explain("law '{}': {}", law.card().name,
          states.empty()      ? std::string("no states")
          : model.lambda == 0 ? std::string("lambda = 0, so its states are in equilibrium: a friction curve")
                              : fmt::format("states {}", fmt::join(states, ", ")));
  if (!law.approximation().empty()) explain("approximation: {}", law.approximation());
  explain("contact: {}", law.has_slip_rate()
                             ? "the friction coefficient is an unknown, because the slip rate is explicit"
                         : law.set_valued() ? "sticks exactly; switches between stick and slip are located events"
                                            : "friction follows from slip rate and states");
  explain("contact stiffness: {}", !model.contact_stiffness.present() ? "none, the contact is rigid"
                                   : model.contact_stiffness.damped() ? "a spring and a damper in series with the law"
                                                                      : "a spring in series with the law");
  if (model.load_memory > 0)
    explain("load memory: {}", model.drive.normal_load.constant()
                                   ? "without effect, because the normal load is constant"
                                   : "the states answer to the rate of the normal load");
  if (model.slider.mass == 0) explain("slider without mass: inertia is left out");
}

Status Job::finish(const std::string& document, std::vector<std::string> files, const std::string& script,
                   const Outcome& outcome) {
  if (!script.empty()) {
    auto drawn = draw(folder_, script);
    for (const auto& problem : drawn.problems) note(problem);
    files.insert(files.end(), drawn.files.begin(), drawn.files.end());
  }
  files.push_back("result.json");
  manifest_.files = std::move(files);
  manifest_.outcome = outcome;
  write_whole(folder_ / "manifest.json", to_json(scene_, manifest_));
  write_whole(folder_ / "result.json", document);
  if (request_.json) std::fwrite(document.data(), 1, document.size(), stdout);
  if (!outcome.complete() && !request_.quiet)
    fmt::print(stderr, "{}: {}{}{}\n", scene_.path, name(outcome.ending), outcome.detail.empty() ? "" : ": ",
               outcome.detail);
  say("Results: {}", (folder_ / "").string());
  return outcome.complete() ? done : ended_short;
}

}  // namespace rosin::app
