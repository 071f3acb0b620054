/// The verb fit: fits of all candidates, their ranking, tables and the picture of residuals.

#include <numeric>

#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/json.hpp"
#include "app/scene/reader.hpp"
#include "app/verbs/fit_scene.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;
using analysis::inference::Measurement;

const char* abscissa(Measurement::Kind kind) {
  switch (kind) {
    case Measurement::Kind::frequency_response:
      return "frequency (Hz)";
    case Measurement::Kind::velocity_step:
      return "time (s)";
    case Measurement::Kind::steady_curve:
      return "slip rate (m/s)";
    case Measurement::Kind::hold:
      return "time at rest (s)";
  }
  return "";
}

ordered_json parameters(const analysis::inference::Fit& fit) {
  auto object = ordered_json::object();
  for (const auto& p : fit.parameters)
    object[p.path] = {{"value", p.value},
                      {"unit", p.unit},
                      {"standard_error", p.standard_error},
                      {"interval", {p.low, p.high}},
                      {"profile", {p.profile_low, p.profile_high}},
                      {"at_bound", p.at_bound}};
  return object;
}

std::string to_json(const scene::Scene& scene, const std::vector<analysis::inference::Fit>& fits,
                    const std::vector<std::size_t>& order) {
  const auto& own = fits.front();
  auto document = app::output::begin(scene, "fit", own.outcome);
  document["parameters"] = parameters(own);
  document["correlation"] = own.correlation;
  document["chi_square"] = own.chi_square;
  document["points"] = own.points;
  document["confidence"] = scene.fit.options.confidence;
  document["ranking"] = ordered_json::array();
  for (const auto k : order) {
    const auto& fit = fits[k];
    document["ranking"].push_back({{"law", scene.fit.candidates[k].name},
                                   {"aic", fit.aic},
                                   {"bic", fit.bic},
                                   {"cross_validation", fit.cross_validation},
                                   {"chi_square", fit.chi_square},
                                   {"converged_starts", fit.converged_starts},
                                   {"parameters", parameters(fit)},
                                   {"warnings", fit.warnings}});
  }
  document["warnings"] = own.warnings;
  document["notes"] = scene.notes;
  return output::text(document);
}

/// Standardised residuals of each measurement, of the scene's law and of the best of the others.
std::vector<std::string> write_residuals(const fs::path& folder, const scene::Scene& scene,
                                         const std::vector<analysis::inference::Fit>& fits,
                                         const std::vector<std::size_t>& order) {
  std::vector<std::string> files;
  const auto& data = scene.fit.data;
  const int rows = int(data.size());
  std::string script = output::preamble("fit", "Residuals of fits over their standard errors", 760, 120 + 230 * rows) +
                       fmt::format("set multiplot layout {},1 title {}\nset grid linecolor '#CCCCCC' linewidth 0.6\n",
                                   rows, output::single_quoted(scene.title));
  const std::size_t shown = std::min<std::size_t>(order.size(), 4);
  constexpr const char* colours[] = {"#00336F", "#B0560F", "#3A8F5C", "#8A4FA3"};
  for (std::size_t d = 0; d < data.size(); ++d) {
    const bool pairs = data[d].kind == Measurement::Kind::frequency_response;
    std::vector<double> x;
    for (const double value : data[d].x) x.insert(x.end(), pairs ? 2 : 1, value);
    std::vector<output::Column> table{{abscissa(data[d].kind), x}};
    for (std::size_t k = 0; k < shown; ++k)
      table.push_back({scene.fit.candidates[order[k]].name, fits[order[k]].residuals[d]});
    files.push_back(fmt::format("fit-residuals-{}.csv", d + 1));
    output::write_csv(folder / files.back(), table);
    const auto [low, high] = std::ranges::minmax(x);
    script += fmt::format(
        "{} logscale x\nset xrange [{}:{}]\nset xlabel '{}'\nset ylabel 'residual / standard error'\nset title "
        "{}\nplot ",
        low > 0 && high / low > 20 ? "set" : "unset", low, high, abscissa(data[d].kind),
        output::single_quoted(data[d].name));
    for (std::size_t k = 0; k < shown; ++k)
      script += fmt::format("{}'{}' using 1:{} with points pointtype {} pointsize 0.7 linecolor '{}' title {}",
                            k > 0 ? ", \\\n     " : "", files.back(), k + 2, k == 0 ? 7 : int(k) + 3, colours[k],
                            output::single_quoted(scene.fit.candidates[order[k]].name));
    script +=
        ", 2 with lines linecolor '#555555' dashtype (2,3) notitle, -2 with lines linecolor '#555555' dashtype "
        "(2,3) notitle\n";
  }
  write_whole(folder / "fit.gp", script + "unset multiplot\n");
  files.emplace_back("fit.gp");
  return files;
}

Status perform(Job& job) {
  const auto& scene = job.scene();
  const auto begin = std::chrono::steady_clock::now();
  std::vector<analysis::inference::Fit> fits;
  {
    Progress progress(job.request().quiet);
    for (const auto& candidate : scene.fit.candidates) {
      auto options = scene.fit.options;
      options.parameters = candidate.parameters;
      options.progress = [&](int done, int total) { progress.show(std::size_t(done), std::size_t(total)); };
      job.explain("{}: {} parameters by least squares from {} starts", candidate.name, candidate.parameters.size(),
                  options.starts);
      fits.push_back(analysis::inference::fit(candidate.model, scene.fit.data, options));
    }
  }
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return fits[k].bic; });
  job.manifest().cost = {{"seconds", seconds_since(begin)}};

  for (std::size_t k = 0; k < fits.size(); ++k) {
    const auto& fit = fits[k];
    job.say("{}: chi square {:.5g} of {} numbers", scene.fit.candidates[k].name, fit.chi_square, fit.points);
    for (const auto& p : fit.parameters)
      if (std::isnan(p.low))
        job.say("  {:<34} not determined by the data", p.path);
      else
        job.say("  {:<34} {}, {:.3g} % interval {:.5g} … {:.5g}", p.path, justified(p.value, p.standard_error, p.unit),
                100 * scene.fit.options.confidence, p.low, p.high);
    if (k > 0 && fit.outcome.ending == Ending::budget_spent)  // that of the scene's own law ends the verb
      job.note(fmt::format("{}: {}", scene.fit.candidates[k].name, fit.outcome.detail));
    for (const auto& warning : fit.warnings) job.note(fmt::format("{}: {}", scene.fit.candidates[k].name, warning));
  }
  if (fits.size() > 1)
    for (const auto k : order)
      job.say("rank {:<20} AIC {:+.2f}, BIC {:+.2f} from the best, left-out points {:.3f}",
              scene.fit.candidates[k].name, fits[k].aic - fits[order[0]].aic, fits[k].bic - fits[order[0]].bic,
              fits[k].cross_validation);
  auto files = write_residuals(job.folder(), scene, fits, order);
  return job.finish(to_json(scene, fits, order), std::move(files), fits.front().outcome);
}

void read(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator_if_there();
  read_tables_of_models(reader);
  read_fit(scene::Table(reader.need("fit", "parameters and data"), "fit"), reader);
  reader.note_unread({"oscillator", "drive.force", "law.load_memory"}, "a fit does not ask for it");
}

}  // namespace

Verb fit_verb() {
  return {.name = "fit",
          .help = "parameters of laws from responses, velocity steps, steady curves and holds; laws ranked",
          .example = "rosin fit examples/fit-laws.toml",
          .operands = {scene_operand},
          .needs = {{"law", "the friction law, with values to start from"},
                    {"fit", "parameters and data"},
                    {"drive", "speed and load, where data do not say them", true}},
          .options = scene_options(),
          .read = read,
          .perform = perform};
}

}  // namespace rosin::app::verbs
