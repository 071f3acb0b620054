/// The JSON documents of every verb.
#include "app/results.hpp"

#include <ctime>

#include "app/json.hpp"

namespace rosin::app {

namespace {

ordered_json values(const std::vector<Quantity>& names, const std::vector<Value>& list) {
  auto object = ordered_json::object();
  for (std::size_t i = 0; i < names.size(); ++i)
    std::visit([&](const auto& value) { object[names[i].name] = value; }, list[i]);
  return object;
}

ordered_json states(const FrictionLaw& law, std::span<const double> state) {
  auto object = ordered_json::object();
  for (std::size_t i = 0; i < state.size(); ++i) object[law.states()[i].name] = state[i];
  return object;
}

ordered_json metrics(const analysis::Metrics& values) {
  auto object = ordered_json::object();
  for (const auto& metric : analysis::metric_names()) object[metric.name] = values.*metric.member;
  return object;
}

ordered_json axis(const analysis::Axis& axis, const oscillators::Model& model) {
  return {{"parameter", axis.parameter},
          {"unit", model.describe(axis.parameter).unit},
          {"scale", axis.logarithmic ? "log" : "linear"},
          {"values", axis.values}};
}

/// Row by row: [iy][ix] of f(index of the point).
template <class Plane, class F>
ordered_json grid(const Plane& plane, F f) {
  auto table = ordered_json::array();
  const auto width = plane.x.values.size();
  for (std::size_t iy = 0; iy < plane.y.values.size(); ++iy) {
    auto row = ordered_json::array();
    for (std::size_t ix = 0; ix < width; ++ix) row.push_back(f(iy * width + ix));
    table.push_back(std::move(row));
  }
  return table;
}
/// The same of f(point).
template <class F>
ordered_json rows(const analysis::Map& map, F f) {
  return grid(map, [&](std::size_t i) { return f(map.points[i]); });
}

/// Members of a comparison: names, laws, and what was adjusted in them.
ordered_json members(const CompareOptions& compare) {
  auto list = ordered_json::array();
  for (const auto& member : compare.members) {
    ordered_json one{{"name", member.name},
                     {"law", member.model.law->card().name},
                     {"parameters", values(member.model.law->parameters(), member.model.law->values())}};
    if (member.model.law->has_states()) one["lambda"] = member.model.lambda;
    if (!member.adjusted.empty()) {
      for (std::size_t k = 0; k < compare.adjust.size(); ++k) one["adjusted"][compare.adjust[k]] = member.adjusted[k];
      one["difference_left"] = member.difference;
    }
    list.push_back(std::move(one));
  }
  return list;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char buffer[32];
  std::strftime(buffer, sizeof buffer, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return buffer;
}

}  // namespace

std::string to_json(std::span<const std::shared_ptr<const FrictionLaw>> laws) {
  auto document = ordered_json::array();
  for (const auto& law : laws) {
    auto parameters = ordered_json::array(), states = ordered_json::array(), presets = ordered_json::array();
    for (std::size_t i = 0; i < law->parameters().size(); ++i) {
      const auto& p = law->parameters()[i];
      ordered_json entry{{"name", p.name}, {"unit", p.unit}};
      std::visit([&](const auto& value) { entry["default"] = value; }, law->values()[i]);
      entry.update({{"minimum", p.range.low}, {"maximum", p.range.high}, {"meaning", p.meaning}});
      parameters.push_back(std::move(entry));
    }
    for (const auto& s : law->states()) states.push_back({{"name", s.name}, {"unit", s.unit}, {"meaning", s.meaning}});
    for (const auto& p : law->presets())
      presets.push_back({{"name", p.name}, {"source", p.source}, {"values", values(law->parameters(), p.values)}});
    const auto& card = law->card();
    auto option = ordered_json();
    if (!card.option.of.empty())
      option = {{"type", card.option.of}, {"key", card.option.key}, {"word", card.option.word}};
    document.push_back({{"name", card.name},
                        {"title", card.title},
                        {"formula", card.formula},
                        {"source", card.source},
                        {"limits", card.limits},
                        {"approximation", card.approximation},
                        {"option", std::move(option)},
                        {"set_valued", law->set_valued()},
                        {"parameters", std::move(parameters)},
                        {"states", std::move(states)},
                        {"presets", std::move(presets)}});
  }
  return text(document);
}

std::string to_json(const Scene& scene, const Curve& curve) {
  auto document = begin(scene, "curve");
  document["normal_load"] = scene.curve.normal_load;
  document["slip_rate"] = curve.slip_rate;
  document["friction_coefficient"] = curve.friction_coefficient;
  auto& extrema = document["extrema"] = ordered_json::array();
  for (const auto& e : curve.extrema)
    extrema.push_back({{"kind", e.maximum ? "maximum" : "minimum"},
                       {"slip_rate", e.slip_rate},
                       {"friction_coefficient", e.friction_coefficient},
                       {"error", {{"slip_rate", e.slip_rate_error}}}});
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const Scene& scene, const StabilityResult& result) {
  auto document = begin(scene, "stability");
  const auto& steady = result.stability.steady;
  document["steady"] = {{"slip_rate", steady.slip_rate},
                        {"friction_coefficient", steady.friction_coefficient},
                        {"friction_force", steady.friction_force},
                        {"displacement", steady.displacement},
                        {"state", states(*scene.model.law, steady.state)}};
  document["eigenvalues"] = pairs(result.stability.eigenvalues);
  document["stable"] = result.stability.stable;
  document["marginal"] = result.stability.marginal;
  auto& hopf = document["hopf"] = ordered_json::array();
  for (const auto& point : result.hopf)
    hopf.push_back({{"parameter", point.parameter},
                    {"value", point.value},
                    {"angular_frequency", point.angular_frequency},
                    {"criticality", name(point.criticality)},
                    {"first_lyapunov_coefficient", point.first_lyapunov_coefficient},
                    {"closed_form", point.closed_form},
                    {"error", {{"value", point.value_error}}}});
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const Scene& scene, const analysis::Run& run) {
  auto document = begin(scene, "run", run.outcome);
  document["time"] = run.time;
  auto columns = ordered_json::object(), units = columns, error = columns;
  for (std::size_t i = 0; i < run.column_names.size(); ++i) {
    columns[run.column_names[i]] = run.columns[i];
    units[run.column_names[i]] = run.column_units[i];
    if (i < run.column_error.size()) error[run.column_names[i]] = run.column_error[i];
  }
  document["columns"] = std::move(columns);
  document["units"] = std::move(units);
  document["error"] = std::move(error);
  auto& events = document["events"] = ordered_json::array();
  for (const auto& event : run.events)
    events.push_back({{"time", event.time},
                      {"kind", event.kind},
                      {"displacement", scene.plane ? ordered_json{event.displacement, event.displacement_y}
                                                   : ordered_json(event.displacement)}});
  document["metrics"] = run.metrics;
  document["solver"] = run.solver;
  document["cost"] = {{"steps", run.cost.steps}, {"evaluations", run.cost.evaluations}};
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const Scene& scene, const analysis::Cycle& cycle) {
  auto document = begin(scene, "cycle", cycle.outcome);
  const bool found = cycle.metrics.period > 0;  // known, if less accurately than asked
  const auto none = [] {
    analysis::Metrics absent;
    for (const auto& metric : analysis::metric_names()) absent.*metric.member = std::nan("");
    return absent;
  };
  document.update(metrics(found ? cycle.metrics : none()));
  document["stick_threshold"] = scene.cycle.stick_threshold;
  document["ill_conditioned_stick"] = cycle.ill_conditioned_stick;
  document["multipliers"] = pairs(cycle.multipliers);
  document["stable"] = found && !cycle.growth ? ordered_json(cycle.stable) : ordered_json();
  if (cycle.growth) document["growth"] = *cycle.growth;
  document["section"] = {{"displacement", found ? cycle.section_displacement : std::nan("")},
                         {"state", states(*scene.model.law, cycle.section_state)}};
  document["error"] = metrics(found ? cycle.error : none());
  document["error"]["multipliers"] = cycle.multiplier_errors;
  document["cost"] = {
      {"steps", cycle.cost.steps}, {"evaluations", cycle.cost.evaluations}, {"cycles", cycle.cost.cycles}};
  auto notes = scene.notes;
  if (!cycle.multipliers_left_out.empty()) notes.push_back(cycle.multipliers_left_out);
  document["notes"] = notes;
  return text(document);
}

std::string to_json(const Scene& scene, const MapResult& result) {
  const auto& map = result.map;
  auto document = begin(scene, "map", map.outcome);
  document["x"] = axis(map.x, scene.model);
  document["y"] = axis(map.y, scene.model);
  document["regime"] = rows(map, [](const auto& point) { return name(point.regime); });
  auto values = ordered_json::object(), error = values;
  for (const auto& wanted : scene.map.metrics) {
    const auto member = analysis::find_metric(wanted).member;
    values[wanted] = rows(map, [=](const auto& point) { return point.metrics.*member; });
    error[wanted] = rows(map, [=](const auto& point) { return point.error.*member; });
  }
  document["metrics"] = std::move(values);
  document["error"] = std::move(error);
  document["threshold"] = {{"x", map.threshold.x}, {"y", map.threshold.y}};
  document["fold"] = {{"x", map.fold.x}, {"y", map.fold.y}, {"error_decades", map.fold_error}};
  auto& failures = document["failures"] = ordered_json::array();
  for (std::size_t i = 0; i < map.points.size(); ++i)
    if (map.points[i].regime == analysis::Regime::failed)
      failures.push_back(
          {{"ix", i % map.x.values.size()}, {"iy", i / map.x.values.size()}, {"why", map.points[i].why}});
  document["stick_threshold"] = scene.map.stick_threshold;
  document["tolerance"] = scene.map.tolerance;
  document["cost"] = {{"seconds", result.seconds},
                      {"points", map.points.size()},
                      {"integrated", map.integrated},
                      {"interpolated", map.interpolated},
                      {"skipped", map.skipped}};
  auto notes = scene.notes;
  notes.insert(notes.end(), map.notes.begin(), map.notes.end());
  document["notes"] = notes;
  return text(document);
}

std::string to_json(const Scene& scene, const Comparison& comparison) {
  auto document = begin(scene, "compare", comparison.outcome);
  document["protocol"] = scene.compare.protocol;
  document["members"] = members(scene.compare);
  auto& differences = document["differences"] = ordered_json::object();
  for (const auto& row : comparison.rows) {
    std::vector<double> difference, error;
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      difference.push_back(row.values[k] - row.values[0]);
      error.push_back(k == 0 ? 0 : row.errors[k] + row.errors[0]);
    }
    differences[row.metric] = {{"unit", row.unit},
                               {"values", row.values},
                               {"errors", row.errors},
                               {"differences", difference},
                               {"difference_errors", error}};
  }
  if (!comparison.maps.empty()) {
    const auto& first = comparison.maps.front();
    document["x"] = axis(first.x, scene.model);
    document["y"] = axis(first.y, scene.model);
    auto& planes = document["planes"] = ordered_json::object();
    for (std::size_t k = 0; k < comparison.maps.size(); ++k) {
      const auto& map = comparison.maps[k];
      auto& plane = planes[scene.compare.members[k].name];
      plane["regime"] = rows(map, [](const auto& point) { return name(point.regime); });
      for (const auto& metric : scene.map.metrics) {
        const auto member = analysis::find_metric(metric).member;
        plane["metrics"][metric] = rows(map, [=](const auto& point) { return point.metrics.*member; });
        plane["error"][metric] = rows(map, [=](const auto& point) { return point.error.*member; });
      }
      plane["threshold"] = {{"x", map.threshold.x}, {"y", map.threshold.y}};
    }
  } else if (!comparison.series.empty()) {
    auto& series = document["series"] = ordered_json::object();
    for (std::size_t k = 0; k < comparison.series.size(); ++k) {
      auto& one = series[scene.compare.members[k].name];
      one[comparison.x_name] = comparison.series[k].x;
      for (std::size_t c = 0; c < comparison.column_names.size(); ++c)
        one[comparison.column_names[c]] = comparison.series[k].columns[c];
    }
  }
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const Scene& scene, const DesignResult& result) {
  const auto& design = result.design;
  auto document = begin(scene, "compare", design.outcome);
  document["members"] = members(scene.compare);
  if (!scene.compare.parameter.empty()) document["parameter"] = scene.compare.parameter;
  auto& noise = document["noise"] = ordered_json::object();
  for (const auto& n : scene.compare.noise) noise[n.metric] = {{"absolute", n.absolute}, {"relative", n.relative}};
  document["confidence"] = scene.compare.confidence;
  document["x"] = axis(design.x, scene.model);
  document["y"] = axis(design.y, scene.model);
  const auto plane = [&](const std::vector<double>& numbers) {
    return grid(design, [&](std::size_t i) { return numbers[i]; });
  };
  document["discriminability"] = plane(design.information);
  document["discriminability_error"] = plane(design.information_error);
  if (!design.repeats.empty()) document["repeats"] = plane(design.repeats);
  const auto best = [&](const analysis::Design::Best& b) {
    return ordered_json{{"x", b.x}, {"y", b.y}, {"discriminability", b.information}, {"repeats", b.repeats}};
  };
  document["best"] = best(design.best);
  auto& parts = document["by_metric"] = ordered_json::object();
  for (std::size_t m = 0; m < scene.compare.noise.size(); ++m)
    parts[scene.compare.noise[m].metric] = {{"discriminability", plane(design.by_metric[m])},
                                            {"best", best(design.best_by_metric[m])}};
  document["cost"] = {{"seconds", result.seconds}, {"failed", design.failed}};
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const Scene& scene, const analysis::lab::Result& result) {
  auto document = begin(scene, "lab", result.outcome);
  document["experiment"] = scene.experiment->name;
  auto object = [] { return ordered_json::object(); };
  auto readings = object(), error = object(), meaning = object(), units = object(), columns = object(),
       tables = object();
  for (const auto& reading : result.readings) {
    readings[reading.name] = reading.value;
    error[reading.name] = reading.error;
    units[reading.name] = reading.unit;
    meaning[reading.name] = reading.meaning;
  }
  for (const auto& table : result.tables)
    for (std::size_t c = 0; c < table.columns.size(); ++c) tables[table.name][table.columns[c]] = table.values[c];
  for (std::size_t c = 0; c < result.record.names.size(); ++c) {
    columns[result.record.names[c]] = result.record.columns[c];
    units[result.record.names[c]] = result.record.units[c];
  }
  document["readings"] = std::move(readings);
  document["error"] = std::move(error);
  document["meaning"] = std::move(meaning);
  document["tables"] = std::move(tables);
  document["time"] = result.record.time;
  document["columns"] = std::move(columns);
  document["units"] = std::move(units);
  auto& events = document["events"] = ordered_json::array();
  for (const auto& event : result.events) events.push_back({{"time", event.time}, {"kind", event.kind}});
  document["warnings"] = result.warnings;
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const Scene& scene, const Manifest& manifest) {
  auto document = begin(scene, manifest.verb.c_str(), manifest.outcome);
  document["date"] = utc_now();
  document["scene"] = scene.path;
  if (scene.experiment) document["experiment"] = scene.experiment->name;
  document["overrides"] = manifest.overrides;
  document["scene_resolved"] = scene.resolved;
  auto& parameters = document["parameters"] = ordered_json::object();
  if (scene.model.law)
    for (const auto& quantity : scene.model.parameters())
      parameters[quantity.name] = {{"value", scene.model.get(quantity.name)}, {"unit", quantity.unit}};
  document["tolerance"] = {{"asked", manifest.tolerance_asked}, {"reached", manifest.tolerance_reached}};
  document["cost"] = manifest.cost;
  document["files"] = manifest.files;
  document["scripts"] = manifest.scripts;
  document["notes"] = scene.notes;
  return text(document);
}

std::string to_json(const std::string& verb, const Outcome& outcome) {
  return text({{"verb", verb},
               {"version", ROSIN_VERSION},
               {"outcome", name(outcome.ending)},
               {"outcome_detail", outcome.detail}});
}

}  // namespace rosin::app
