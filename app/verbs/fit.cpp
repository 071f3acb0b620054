/// The verb fit: fits of all candidates, their ranking, tables, and the picture of data, fits and residuals.

#include "app/tasks/fit.hpp"

#include <numeric>

#include "analysis/inference/wider_law.hpp"
#include "app/output/digits.hpp"
#include "app/output/figure.hpp"
#include "app/output/scene_figure.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/verbs/fit_scene.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/verb.hpp"
#include "core/files.hpp"
#include "laws/catalogue.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;
using analysis::inference::Measurement;

constexpr const char *curve_file = "fit-curve-{}.csv", *residual_file = "fit-residuals-{}.csv";

results::Channel abscissa(const Measurement& m) {
  switch (m.kind) {
    case Measurement::Kind::frequency_response:
      return {"frequency", "Hz"};
    case Measurement::Kind::velocity_step:
      if (m.over == Measurement::Over::displacement) return {"displacement", "m"};
      return {"time", "s"};
    case Measurement::Kind::steady_curve:
      return {"slip rate", "m/s"};
    case Measurement::Kind::hold:
      return {"time at rest", "s"};
    case Measurement::Kind::record:
    case Measurement::Kind::motion:
      return {"time", "s"};
    case Measurement::Kind::stick_slip:
      return {"drive speed", "m/s"};
  }
  return {};
}

/// The axis of measured numbers.
results::Axis ordinate(const Measurement& m) {
  if (m.kind == Measurement::Kind::motion) return output::axis_of(m.column, m.unit, results::Extent::of(m.y));
  auto axis = m.pairs()    ? results::Axis{.name = "response", .unit = "N s/m", .symbol = "Z"}
              : m.in_force ? results::Axis{.name = "friction force", .unit = "N", .symbol = "F"}
                           : results::Axis{.name = "friction coefficient", .symbol = "μ"};
  if (m.kind == Measurement::Kind::stick_slip) switch (m.event) {
      case Measurement::Event::recurrence:
        axis = {.name = "recurrence", .unit = "s"};
        break;
      case Measurement::Event::force_drop:
        axis = {.name = "force drop", .unit = "N"};
        break;
      case Measurement::Event::peak_slip_rate:
        axis = {.name = "peak slip rate", .unit = "m/s"};
        break;
      case Measurement::Event::force_range:
        axis = {.name = "range of force", .unit = "N"};
    }
  axis.shown = results::Extent::of(m.y);
  return axis;
}

ordered_json parameters(const std::vector<analysis::inference::FittedParameter>& fitted) {
  auto object = ordered_json::object();
  for (const auto& p : fitted)
    object[p.path] = {{"value", p.value},
                      {"unit", p.unit},
                      {"standard_error", p.standard_error},
                      {"interval", {p.low, p.high}},
                      {"profile", {p.profile_low, p.profile_high}},
                      {"at_bound", p.at_bound}};
  return object;
}

/// As parameters, without a profile, and with the formula of each.
ordered_json derived(const analysis::inference::Fit& fit, const tasks::Fit::Candidate& candidate) {
  auto object = parameters(fit.derived);
  for (const auto& number : candidate.derived) {
    auto& of = object[number.name()];
    of.erase("profile"), of.erase("at_bound");
    of["formula"] = number.text();
  }
  return object;
}

/// Numbers that are not known are null.
ordered_json noise(const analysis::inference::FittedMeasurement& m, const Measurement& data) {
  ordered_json object = {{"data", data.name},
                         {"standard_error", m.error_found ? "from residuals" : "given"},
                         {"durbin_watson", m.neighbours.durbin_watson},
                         {"correlation_of_neighbours", m.neighbours.correlation}};
  if (m.error_found) object["noise"] = {{"size", m.noise.size}, {"correlation", m.noise.correlation}};
  if (m.misfit)
    object["misfit"] = {{"where", m.misfit->where}, {"size", m.misfit->size}, {"probability", m.misfit->probability}};
  if (const auto points = std::ranges::count(m.bounded, 1); points > 0)
    object["rest"] = {
        {"points", points}, {"slip_rate_below", data.history.rest.below}, {"slip_rate_noise", data.history.rest.noise}};
  return object;
}

/// Laws between which the data do not decide: those within a few units of AIC of the least; none where it stands alone.
std::vector<std::string> undecided(const scene::Scene& scene, const std::vector<analysis::inference::Fit>& fits,
                                   const std::vector<std::size_t>& order) {
  constexpr double few = 4;  // a likelihood ratio of e²
  double least = infinity;
  for (const auto& fit : fits) least = std::min(least, fit.aic);
  std::vector<std::string> laws;
  for (const auto k : order)
    if (fits[k].aic - least <= few) laws.push_back(scene.task<tasks::Fit>().candidates[k].name);
  return laws.size() > 1 ? laws : std::vector<std::string>{};
}

/// Fitted parameters with their errors and intervals, and how they hang together.
results::Table table_of(const analysis::inference::Fit& fit, double confidence) {
  std::vector<std::string> names;
  for (const auto& p : fit.parameters) names.push_back(p.path);
  results::Table table{
      .name = "fit",
      .dimensions = {{"parameter", names.size()}, {"other_parameter", names.size()}, {"end", 2}},
      .columns = {{{"parameter", "", "fitted parameter"}, names},
                  {{"other_parameter", "", "fitted parameter"}, names, {}, {1}},
                  {{"correlation", "1", "correlation of two fitted parameters"}, fit.correlation, {}, {0, 1}}}};
  const auto add = [&](const analysis::inference::FittedParameter& p) {
    table.columns.push_back({{p.path, p.unit, p.path}, std::vector{p.value}, {}, {}});
    table.columns.push_back(
        {{p.path + "_error", p.unit, "standard error of " + p.path}, std::vector{p.standard_error}, {}, {}});
    table.columns.push_back(
        {{p.path + "_interval", p.unit, fmt::format("{:g} % interval of {}", 100 * confidence, p.path)},
         std::vector{p.low, p.high},
         {},
         {2}});
  };
  std::ranges::for_each(fit.parameters, add);
  std::ranges::for_each(fit.derived, add);
  return table;
}

results::Result result_of(const Job& job, const std::vector<analysis::inference::Fit>& fits,
                          const std::vector<std::size_t>& order) {
  const auto& scene = job.scene();
  const auto& asked = scene.task<tasks::Fit>();
  const auto& own = fits.front();
  auto result = job.result(own.outcome);
  result["parameters"] = parameters(own.parameters);
  if (!own.derived.empty()) result["derived"] = derived(own, asked.candidates.front());
  result["correlation"] = own.correlation;
  result["chi_square"] = own.chi_square;
  result["points"] = own.points;
  result["confidence"] = asked.options.confidence;
  auto measurements = ordered_json::array(), ranking = measurements;
  for (std::size_t d = 0; d < own.measurements.size(); ++d)
    measurements.push_back(noise(own.measurements[d], asked.data[d]));
  for (const auto k : order) {
    const auto& fit = fits[k];
    ranking.push_back({{"law", asked.candidates[k].name},
                       {"aic", fit.aic},
                       {"bic", fit.bic},
                       {"cross_validation", fit.cross_validation},
                       {"chi_square", fit.chi_square},
                       {"converged_starts", fit.converged_starts},
                       {"parameters", parameters(fit.parameters)},
                       {"warnings", fit.warnings}});
    if (!fit.derived.empty()) ranking.back()["derived"] = derived(fit, asked.candidates[k]);
  }
  result["measurements"] = std::move(measurements);
  result["ranking"] = std::move(ranking);
  result["undecided"] = undecided(scene, fits, order);
  result["warnings"] = own.warnings;
  if (!own.correlation.empty()) result.tables = {table_of(own, asked.options.confidence)};
  return result;
}

std::string described(const analysis::inference::FittedParameter& p, double confidence) {
  const auto unit = written_unit(p.unit);
  if (p.withheld)
    return fmt::format("{:.4g}{}, no interval: the law does not describe these data", p.value / unit.factor,
                       unit.behind());
  if (std::isnan(p.low))
    return std::isnan(p.profile_low)
               ? "not determined by the data"
               : fmt::format("bounded on one side by the data, {:.5g} … {:.5g}{}", p.profile_low / unit.factor,
                             p.profile_high / unit.factor, unit.behind());
  return fmt::format("{}, {:.3g} % interval {:.5g} … {:.5g}", justified(p.value, p.standard_error, p.unit),
                     100 * confidence, p.low / unit.factor, p.high / unit.factor);
}

std::string why_at_rest(const analysis::inference::Rest& rest) {
  if (rest.given) return "as the data's key rest says";
  return fmt::format("slip rates below {:.3g} m/s cannot be told from it, by noise of {:.2g} m/s", rest.below,
                     rest.noise);
}

/// What a picture shows of a measurement: its numbers, or those of one part of a response.
struct Part {
  std::string name;  ///< empty, or "real", "imaginary"
  std::size_t first, stride;
  std::vector<double> of(const std::vector<double>& all) const {
    std::vector<double> some;
    for (std::size_t i = first; i < all.size(); i += stride) some.push_back(all[i]);
    return some;
  }
};
std::vector<Part> parts_of(const Measurement& m) {
  if (m.pairs()) return {{"real ", 0, 2}, {"imaginary ", 1, 2}};
  return {{"", 0, 1}};
}

/// What a picture is drawn over: the measurement's own abscissa, or the displacement that a series in time imposes,
/// which stands last in its tables.
struct Abscissa {
  results::Channel of;
  std::vector<double> values;
  bool last = false;  ///< column of the tables; else the first
};
Abscissa own_abscissa(const Measurement& m) { return {abscissa(m), m.x}; }
/// Empty values where there is none beside the measurement's own.
Abscissa displacement_of(const Measurement& m) {
  if (m.over == Measurement::Over::displacement) return {};
  return {{"displacement", "m"}, analysis::inference::imposed_displacement(m), true};
}

/// The numbers at the scene's law: x, data, fit, residual and standard error, and the fits of the others.
results::Table curve_of(const scene::Scene& scene, const std::vector<analysis::inference::Fit>& fits,
                        const std::vector<std::size_t>& shown, std::size_t d) {
  const auto& m = scene.task<tasks::Fit>().data[d];
  const auto& own = fits.front().measurements[d];
  std::vector<results::Column> columns = {{abscissa(m), m.x}};
  for (const auto& part : parts_of(m)) {
    const auto data = part.of(m.y), fitted = part.of(own.fitted);
    auto residual = data;
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= fitted[i];
    for (const auto& [name, values] :
         {std::pair{"data", data}, {"fit", fitted}, {"residual", residual}, {"standard error", part.of(own.error)}})
      columns.push_back({{part.name + name}, values});
  }
  for (const auto k : shown)
    for (const auto& part : parts_of(m))
      if (k != 0)
        columns.push_back({{fmt::format("{}fit of {}", part.name, scene.task<tasks::Fit>().candidates[k].name)},
                           part.of(fits[k].measurements[d].fitted)});
  if (auto way = displacement_of(m); !way.values.empty()) columns.push_back({way.of, std::move(way.values)});
  return results::rows(fmt::format("fit-curve-{}", d + 1), std::move(columns));
}

/// Residuals over their standard errors.
results::Table residuals_of(const scene::Scene& scene, const std::vector<analysis::inference::Fit>& fits,
                            const std::vector<std::size_t>& shown, std::size_t d) {
  const auto& m = scene.task<tasks::Fit>().data[d];
  std::vector<double> x;
  for (const double value : m.x) x.insert(x.end(), m.pairs() ? 2 : 1, value);
  std::vector<results::Column> columns = {{abscissa(m), std::move(x)}};
  for (const auto k : shown)
    columns.push_back({{scene.task<tasks::Fit>().candidates[k].name}, fits[k].measurements[d].residuals});
  if (auto way = displacement_of(m); !way.values.empty()) columns.push_back({way.of, std::move(way.values)});
  return results::rows(fmt::format("fit-residuals-{}", d + 1), std::move(columns));
}

results::Table correlation_of(const analysis::inference::Fit& fit) {
  const std::size_t p = fit.parameters.size();
  std::vector<results::Column> columns;
  for (std::size_t j = 0; j < p; ++j) {
    std::vector<double> values;
    for (std::size_t i = 0; i < p; ++i) values.push_back(fit.correlation[i * p + j]);
    columns.push_back({{fit.parameters[j].path}, std::move(values)});
  }
  return results::rows("fit-correlation", std::move(columns));
}

/// Names and values of the parameters of the laws shown, each law's below its name where there are several.
std::vector<std::pair<std::string, std::string>> rows_of_table(const scene::Scene& scene,
                                                               const std::vector<analysis::inference::Fit>& fits,
                                                               const std::vector<std::size_t>& shown) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto k : shown) {
    if (fits.size() > 1)
      rows.emplace_back(scene.task<tasks::Fit>().candidates[k].name,
                        fmt::format("AIC {:+.2f} from the best", fits[k].aic - fits[shown.front()].aic));
    auto shown_numbers = fits[k].parameters;
    shown_numbers.insert(shown_numbers.end(), fits[k].derived.begin(), fits[k].derived.end());
    for (const auto& p : shown_numbers) {
      const double factor = written_unit(p.unit).factor;
      rows.emplace_back((fits.size() > 1 ? "    " : "") + p.path,
                        std::isnan(p.low)
                            ? described(p, scene.task<tasks::Fit>().options.confidence)
                            : fmt::format("{} ({} … {})", justified(p.value, p.standard_error, p.unit),
                                          output::digits_by_error(p.low / factor, p.standard_error / factor),
                                          output::digits_by_error(p.high / factor, p.standard_error / factor)));
    }
  }
  return rows;
}

/// Data, fits and residuals over the same axis, measurement by measurement, above the parameters of the laws.
/// \param over_displacement each of those that are series in time, and no others
std::vector<std::string> write_picture(const fs::path& folder, const std::string& name, const scene::Scene& scene,
                                       const std::vector<analysis::inference::Fit>& fits,
                                       const std::vector<std::size_t>& shown, bool over_displacement) {
  auto& asked = scene.task<tasks::Fit>();
  std::vector<std::pair<std::size_t, Abscissa>> data;
  for (std::size_t d = 0; d < asked.data.size(); ++d) {
    auto over = over_displacement ? displacement_of(asked.data[d]) : own_abscissa(asked.data[d]);
    if (!over.values.empty()) data.emplace_back(d, std::move(over));
  }
  auto figure = output::figure_of(scene, name, "Data, fits, and residuals over their standard errors");
  figure.width = 760;
  figure.caption = fmt::format("in brackets: {:.3g} % intervals", 100 * asked.options.confidence);
  figure.rows = rows_of_table(scene, fits, shown);
  for (const auto& [d, over] : data) {
    const auto& m = asked.data[d];
    const auto curves = fmt::format(curve_file, d + 1);
    const auto parts = parts_of(m);
    const auto [low, high] = std::ranges::minmax(over.values);
    const int others_shown = int(shown.size()) - (std::ranges::find(shown, 0u) != shown.end() ? 1 : 0),
              count = int(parts.size());
    results::Panel above{.x = {.name = over.of.name,
                               .unit = over.of.unit,
                               .decades = !m.series() && low > 0 && high / low > 20,
                               .shown = {low, high},
                               .from = low,
                               .to = high},
                         .y = ordinate(m),
                         .title = m.name,
                         .height = 230};
    const results::Cell x{over.last ? 2 + (4 + others_shown) * count : 1};
    for (int part = 0; part < count; ++part)
      above.lines.push_back(
          {.table = curves,
           .x = x,
           .y = {2 + 4 * part},
           .how = results::How::points,
           .look = {.colour = "#888888", .point = part == 0 ? results::Point::dot : results::Point::circle},
           .title = parts[std::size_t(part)].name + "data"});
    int others = 2 + 4 * count;
    for (std::size_t k = 0; k < shown.size(); ++k)
      for (int part = 0; part < count; ++part)
        above.lines.push_back({.table = curves,
                               .x = x,
                               .y = {shown[k] == 0 ? 3 + 4 * part : others++},
                               .look = {.style = results::style_of(k), .width = 1.8},
                               .title = asked.candidates[shown[k]].name,
                               .sorted = !over.last});  // a path may come back to where it was
    results::Panel below{.x = above.x, .y = {.name = "residual / error", .shown = {-2, 2}}, .height = 120};
    for (const auto k : shown)
      for (const double r : fits[k].measurements[d].residuals) below.y.shown.include(r);
    constexpr results::Point points[] = {results::Point::dot, results::Point::open_square, results::Point::circle,
                                         results::Point::open_up};
    for (std::size_t k = 0; k < shown.size(); ++k)
      below.lines.push_back({.table = fmt::format(residual_file, d + 1),
                             .x = {over.last ? int(shown.size()) + 2 : 1},
                             .y = {int(k) + 2},
                             .how = results::How::points,
                             .look = {.style = results::style_of(k), .point = points[k]}});
    for (const double at : {-2., 2.}) below.rules.push_back({'y', at, {.style = results::reference_style}});
    figure.panels.push_back(std::move(above));
    figure.panels.push_back(std::move(below));
  }
  return output::write(folder, figure);
}

/// Adds the tables of all measurements. \returns the pictures of them
std::vector<std::string> add_tables_and_pictures(const fs::path& folder, results::Result& result,
                                                 const std::vector<analysis::inference::Fit>& fits,
                                                 const std::vector<std::size_t>& order) {
  const auto& scene = result.scene;
  const auto& data = scene.task<tasks::Fit>().data;
  constexpr std::size_t most_shown = 4;  // laws
  std::vector<std::size_t> shown;
  for (const auto k : order)
    if (shown.size() < most_shown && !fits[k].measurements.empty()) shown.push_back(k);
  if (fits.front().measurements.empty()) return {};  // it ended before it could be laid beside the data
  for (std::size_t d = 0; d < data.size(); ++d) {
    result.tables.push_back(curve_of(scene, fits, shown, d));
    result.tables.push_back(residuals_of(scene, fits, shown, d));
  }
  result.tables.push_back(correlation_of(fits.front()));
  auto files = write_picture(folder, "fit", scene, fits, shown, false);
  if (std::ranges::any_of(data, [](const auto& m) { return !displacement_of(m).values.empty(); }))
    for (auto& file : write_picture(folder, "fit-displacement", scene, fits, shown, true))
      files.push_back(std::move(file));
  return files;
}

/// A fit that fails because b would have to be negative says so, and which law allows it.
void say_negative_evolution(const oscillators::Model& start, const std::vector<Measurement>& data,
                            const analysis::inference::FitOptions& options, analysis::inference::Fit& fit) {
  const auto name = fmt::format("two-state-{}", start.law->card().name);
  const auto& laws = laws::catalogue();
  const auto form = std::ranges::find_if(laws, [&](const auto& law) { return law->card().name == name; });
  if (form == laws.end()) return;
  const auto wider = analysis::inference::fit_with_negative_evolution(start, *form, data, options, fit);
  if (!wider) return;
  if (fit.outcome.complete()) fit.outcome.ending = Ending::none_exists;
  fit.outcome.detail = fmt::format(
      "law.b would have to be negative, where its range begins at 0: law '{}' with b1 = 0 and b2 = {} describes these "
      "data (BIC lower by {:.4g}); fit its b2",
      name, justified(wider->b, wider->standard_error, ""), fit.bic - wider->fit.bic);
  fit.warnings.insert(fit.warnings.begin(), fit.outcome.detail);
}

Status perform_fit(Job& job) {
  const auto& scene = job.scene();
  auto& asked = scene.task<tasks::Fit>();
  const auto begin = std::chrono::steady_clock::now();
  std::vector<analysis::inference::Fit> fits;
  {
    Progress progress(job.request().quiet);
    for (const auto& candidate : asked.candidates) {
      auto options = asked.options;
      options.parameters = candidate.parameters;
      options.derived = candidate.derived;
      options.progress = [&](int done, int total) { progress.show(std::size_t(done), std::size_t(total)); };
      job.explain("{}: {} parameters by least squares", candidate.name, candidate.parameters.size());
      fits.push_back(analysis::inference::fit(candidate.subject, asked.data, options));
      const auto& fit = fits.back();
      for (const auto& decision : fit.decisions) job.explain("{}: {}", candidate.name, decision);
      job.explain("{}: {} predictions, {} steps of motion", candidate.name, fit.predictions, fit.steps);
      if (candidate.subject.machines.empty())
        say_negative_evolution(candidate.subject.model, asked.data, options, fits.back());
    }
  }
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return fits[k].bic; });
  long predictions = 0, steps = 0;
  for (const auto& fit : fits) predictions += fit.predictions, steps += fit.steps;
  job.manifest().cost = {
      {"seconds", seconds_since(begin)}, {"predictions", double(predictions)}, {"steps", double(steps)}};

  for (const auto k : order) {
    const auto& fit = fits[k];
    job.say("{}: chi square {:.5g} of {} numbers", asked.candidates[k].name, fit.chi_square, fit.points);
    for (const auto& p : fit.parameters) job.say("  {:<34} {}", p.path, described(p, asked.options.confidence));
    for (const auto& p : fit.derived) job.say("  {:<34} {}", p.path, described(p, asked.options.confidence));
    for (std::size_t d = 0; d < fit.measurements.size(); ++d) {
      const auto& m = fit.measurements[d];
      const auto& data = asked.data[d];
      constexpr double least = 0.005;  // that two digits show
      if (m.error_found)
        job.say("  noise of {:<25} {:.3g}{}{}", data.name, m.noise.size,
                data.unit_of_y() == "1" ? "" : " " + data.unit_of_y(),
                std::abs(m.noise.correlation) < least
                    ? ""
                    : fmt::format(", of neighbours correlated by {:.2f}", m.noise.correlation));
      if (const auto points = std::ranges::count(m.bounded, 1); points > 0)
        job.say("  rest in  {:<25} {} of {} points: friction there is bounded, not predicted; {}", data.name, points,
                data.y.size(), why_at_rest(data.history.rest));
    }
    if (k > 0 && fit.outcome.ending == Ending::budget_spent)  // that of the scene's own law ends the verb
      job.note(fmt::format("{}: {}", asked.candidates[k].name, fit.outcome.detail));
    for (const auto& warning : fit.warnings) job.note(fmt::format("{}: {}", asked.candidates[k].name, warning));
  }
  if (fits.size() > 1)
    for (const auto k : order)
      job.say("rank {:<20} AIC {:+.2f}, BIC {:+.2f} from the best, left-out points {:.3f}", asked.candidates[k].name,
              fits[k].aic - fits[order[0]].aic, fits[k].bic - fits[order[0]].bic, fits[k].cross_validation);
  if (const auto laws = undecided(scene, fits, order); !laws.empty())
    job.say("undecided between {}, a few units of AIC apart", fmt::join(laws, ", "));
  auto result = result_of(job, fits, order);
  auto files = add_tables_and_pictures(job.folder(), result, fits, order);
  return job.finish(result, std::move(files));
}

void read_fit_question(scene::SceneReader& reader) {
  reader.law();
  const auto& fit = reader.need("fit", "parameters and data");
  const bool slides = fits_stick_slip(fit);
  const bool moves = fits_a_machine(fit);
  if (moves)
    reader.oscillator();
  else
    reader.oscillator_if_there(slides);
  if (slides && (reader.scene.plane || reader.scene.block))
    scene::fail(reader.root.find("oscillator")->source(),
                "this oscillator is followed by steps, between which no stick and slip are located: fit the record of "
                "its motion, type = \"motion\"");
  read_tables_of_models(reader);
  read_fit(scene::Table(fit, "fit"), reader);
  const auto note_unread = [&](std::initializer_list<std::string_view> paths) {
    for (const auto path : paths)
      if (std::ranges::none_of(reader.scene.task<tasks::Fit>().candidates, [&](const auto& candidate) {
            return std::ranges::any_of(candidate.derived, [&](const auto& number) {
              return std::ranges::find(number.paths(), path) != number.paths().end();
            });
          }))
        reader.note_unread({path}, "a fit does not ask for it");
  };
  if (!slides && !moves)
    note_unread({"oscillator.mass", "oscillator.stiffness", "oscillator.damping", "oscillator.stops",
                 "oscillator.restitution"});
  if (!moves && !reader.scene.structure) note_unread({"drive.force", "law.load_memory"});
  if (std::ranges::all_of(reader.scene.task<tasks::Fit>().data,
                          [](const auto& m) { return m.kind == Measurement::Kind::steady_curve; }))
    reader.note_unread({"drive.speed", "law.contact_stiffness"}, "a steady curve does not depend on it");
}

}  // namespace

Verb fit_verb() {
  return {.name = "fit",
          .help =
              "parameters of laws from responses, velocity steps, steady curves, holds, records, motions and "
              "stick-slip; laws ranked",
          .example = "rosin fit examples/fit-laws.toml",
          .operands = {scene_operand},
          .needs = {{"law", "the friction law, with values to start from"},
                    {"fit", "parameters and data"},
                    {"drive", "speed and load, where data do not say them", true}},
          .options = scene_options(),
          .read = read_fit_question,
          .perform = perform_fit};
}

}  // namespace rosin::app::verbs
