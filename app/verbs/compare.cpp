/// The verb compare: members under one protocol side by side, and designs that tell them apart.

#include "app/tasks/compare.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "analysis/cycles/cycle.hpp"
#include "analysis/cycles/stepped_cycle.hpp"
#include "analysis/cycles/structure_cycle.hpp"
#include "analysis/inference/discrimination.hpp"
#include "analysis/inference/equalise.hpp"
#include "analysis/planes/map.hpp"
#include "analysis/response/sliding_receptance.hpp"
#include "analysis/steady/curve.hpp"
#include "analysis/steady/stability.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "app/output/comparison.hpp"
#include "app/output/pictures.hpp"
#include "app/output/symbols.hpp"
#include "app/results/axis.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/stepped.hpp"
#include "app/scene/toml_document.hpp"
#include "app/tasks/curve.hpp"
#include "app/tasks/frf.hpp"
#include "app/verbs/cycle.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/plane_job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/run.hpp"
#include "app/verbs/stopping.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

// ---------------------------------------------------------------- reading

std::vector<analysis::inference::Property> read_properties(const toml::node& node, const std::string& path) {
  std::vector<analysis::inference::Property> properties;
  for (const auto& element : scene::list(node, path, "tables")) {
    scene::Table keys(element, path);
    keys.expect({"name", "slip_rate", "ratio", "hold", "from", "to", "points"});
    std::vector<std::string> known{"steady-curve"};
    for (const auto& property : analysis::inference::property_names()) known.emplace_back(property.name);
    const auto property = scene::choice(keys.required("name", "of the property"), keys.path("name"), known);
    const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
    if (property == "steady-curve") {
      double from = 0, to = 0;
      int points = 41;
      keys.required("from", "lowest slip rate, m/s");
      keys.required("to", "highest slip rate, m/s");
      keys.read("from", from, speed);
      keys.read("to", to, speed);
      keys.read("points", points, 2, 1'000'000, "slip rates along the curve");
      if (!(from < to)) scene::fail(element.source(), "{}: from = {} must be below to = {}", path, from, to);
      const auto curve = analysis::inference::steady_curve(from, to, points);
      properties.insert(properties.end(), curve.begin(), curve.end());
    } else {
      analysis::inference::Property one{.name = property, .slip_rate = 0};
      keys.required("slip_rate", "m/s");
      keys.read("slip_rate", one.slip_rate, speed);
      keys.read("ratio", one.ratio, {"", "1", {1e-6, 1e6}, "slip rate after the step over that before it"});
      keys.read("hold", one.hold, {"", "s", {0, 1e15}, "time at rest"});
      properties.push_back(one);
    }
    keys.finish();
  }
  return properties;
}

/// A member while it is read as the verb of the protocol, that of the request, reads scenes: the document of the scene,
/// changed in its law and some numbers.
class MemberReader {
 public:
  MemberReader(const Request& protocol, scene::SceneReader& base, const toml::node& node)
      : protocol_(protocol), base_(base), node_(node), document_(base.document) {
    scene::Table table(node, "compare.members");
    table.expect({"name", "law", "set"});
    member.name = scene::text(table.required("name", "of the member"), "compare.members.name");
    if (const auto* law = table.find("law")) {
      scene::Table(*law, "compare.members.law");  // refuses what is no table
      document_.insert_or_assign("law", *law);
    }
    if (const auto* set = table.find("set")) {
      if (!set->is_table())
        scene::wrong_kind(*set, "compare.members.set", "a table of paths, such as { \"law.lambda\" = 10 }");
      for (const auto& [key, value] : *set->as_table())
        scene::located(value.source(), [&] {
          const auto quantity = describe(std::string(key.str()));
          scene::set_number(document_, quantity.name, scene::number(value, quantity));
        });
    }
    table.finish();
    read();
  }
  void set(const std::string& path, double value) { scene::set_number(document_, describe(path).name, value); }
  void read() {
    scene::Scene scene;
    scene.path = protocol_.target;
    scene::SceneReader reader{protocol_, document_,       scene::Table(document_, ""), scene, base_.folder,
                              {},        base_.smoothing, base_.region_width};
    scene::located(node_.source(), [&] { find_verb(protocol_.verb).read(reader); });
    base_.smooths = base_.smooths || reader.smooths;
    for (const auto& note : scene.notes)
      if (std::ranges::find(base_.scene.notes, note) == base_.scene.notes.end()) base_.scene.notes.push_back(note);
    member.scene = std::move(scene);
  }

  tasks::Compare::Member member;

 private:
  Quantity describe(const std::string& path) {
    if (!family_) {
      scene::Scene unused;
      const scene::SceneReader reader{protocol_, document_, scene::Table(document_, ""), unused, base_.folder, {}};
      const bool is_slider = !base_.scene.structure && !base_.scene.plane;
      family_.emplace(
          scene::located(node_.source(), [&] { return scene::Family(reader, "compare.members", is_slider); }));
    }
    return family_->describe(path);
  }

  const Request& protocol_;
  scene::SceneReader& base_;
  const toml::node& node_;
  toml::table document_;
  std::optional<scene::Family> family_;
};

void read_noise(const toml::node& node, const scene::Scene& scene, tasks::Compare& compare) {
  if (!node.is_table()) scene::wrong_kind(node, "compare.noise", "a table of metrics");
  for (const auto& [key, value] : *node.as_table()) {
    analysis::inference::Noise noise{std::string(key.str())};
    const auto metric = scene::located(value.source(), [&] { return varied(scene).metrics({noise.metric}).front(); });
    scene::Table keys(value, "compare.noise." + noise.metric);
    keys.read("absolute", noise.absolute, {"", metric.unit, {0, 1e300}, "standard deviation"});
    keys.read("relative", noise.relative, {"", "1", {0, 1e3}, "standard deviation over the value"});
    keys.finish();
    if (noise.absolute + noise.relative == 0)
      scene::fail(value.source(), "compare.noise.{}: give absolute ({}) or relative, above 0", noise.metric,
                  readable_unit(metric.unit));
    compare.noise.push_back(noise);
  }
}

void read_equal(scene::Table table, tasks::Compare& compare, std::vector<MemberReader>& members) {
  table.expect({"properties", "adjust"});
  const auto& properties = table.required("properties", "what the members are to share");
  compare.adjust = scene::texts(table.required("adjust", "paths of parameters"), table.path("adjust"));
  const auto wanted = read_properties(properties, table.path("properties"));
  table.finish();
  for (std::size_t k = 1; k < members.size(); ++k) {
    auto& member = members[k].member;
    scene::located(table.source(), [&] {
      try {
        const auto equalised = analysis::inference::equalise(member.scene.model, members.front().member.scene.model,
                                                             wanted, compare.adjust);
        for (std::size_t i = 0; i < compare.adjust.size(); ++i) members[k].set(compare.adjust[i], equalised.values[i]);
        member.adjusted = equalised.values;
        member.difference = equalised.difference;
      } catch (const InputError& error) {
        throw InputError(fmt::format("compare.equalise, member '{}': {}", member.name, error.what()));
      }
    });
    members[k].read();
  }
}

void read_compare(scene::SceneReader& reader) {
  auto& scene = reader.scene;
  const bool design = reader.request.design;
  const auto is = [&](const char* path, const std::string& usual, const std::string& value) {
    return reader.document.at_path(path).value_or(usual) == value;
  };
  // Planes of strings are compared string by string, at several sample rates.
  if (is("oscillator.type", "", "string") && is("compare.protocol", "map", "map")) {
    reader.law();
    reader.oscillator();
    read_string_map(reader, scene::Table(reader.need("map", "the two axes"), "map"));
    return read_string_comparison(reader, scene::Table(reader.need("compare", "members"), "compare"));
  }
  scene::Table table(reader.need("compare", "members, and what is made equal in them"), "compare");
  auto& compare = scene.task<tasks::Compare>();
  table.expect({"members", "protocol", "equalise", "noise", "confidence", "parameter"});
  if (const auto* protocol = table.find("protocol"))
    compare.protocol =
        scene::choice(*protocol, "compare.protocol", {"curve", "stability", "run", "cycle", "map", "frf"});

  reader.need("oscillator", "mass, stiffness and damping of the slider");
  reader.need("drive", "speed and normal load");
  Request as_protocol = reader.request;
  as_protocol.verb = design ? "map" : compare.protocol;
  scene::SceneReader base{as_protocol, reader.document,  reader.root,        scene, reader.folder,
                          {},          reader.smoothing, reader.region_width};
  find_verb(as_protocol.verb).read(base);
  reader.smooths = base.smooths;
  if (as_protocol.verb == "map" && scene.task<analysis::planes::MapOptions>().y.values.empty())
    scene::Table(*reader.root.find("map"), "map")
        .required("y", "second axis of the plane in which members are compared");

  if (const auto* parameter = table.find("parameter")) {
    compare.parameter = scene::text(*parameter, "compare.parameter");
    scene::located(parameter->source(), [&] { scene.describe(compare.parameter); });
  }
  std::vector<MemberReader> members;
  if (const auto* list = table.find("members"))
    for (const auto& element : scene::list(*list, "compare.members", "tables", scene::most_names)) {
      members.emplace_back(as_protocol, reader, element);
      const auto& name = members.back().member.name;
      if (std::any_of(members.begin(), members.end() - 1, [&](const auto& other) { return other.member.name == name; }))
        scene::fail(table.source(), "compare.members: two are named '{}'", name);
    }
  if (!(design && !compare.parameter.empty()) && members.size() < 2)
    scene::fail(table.source(),
                "compare.members needs two members or more, each a table with a name and what it changes");
  if (auto equal = table.table("equalise")) read_equal(*equal, compare, members);
  for (auto& one : members) compare.members.push_back(std::move(one.member));
  if (const auto* noise = design ? table.find("noise") : nullptr) read_noise(*noise, scene, compare);
  table.read("confidence", compare.confidence, {"", "1", {0.5, 0.999999}, "probability of the right decision"});
  table.finish();
  if (design && compare.noise.empty())
    scene::fail(table.source(), "compare.noise is needed for a design: the noise of each metric that is measured");
  if (as_protocol.verb == "run") reader.note_unread({"run.spectrum"}, "'compare' lays motions over each other");
  if (as_protocol.verb == "frf")
    reader.note_unread({"frf.sensitivities", "frf.family", "frf.structure", "frf.normal", "frf.normal_contact"},
                       "'compare' lays tangential responses over each other");
  if (!design)
    reader.note_unread({"compare.noise", "compare.confidence", "compare.parameter"},
                       "only 'rosin compare --design' asks for it");
}

// ---------------------------------------------------------------- results

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Members of a comparison: names, laws, and what was adjusted in them.
ordered_json members(const tasks::Compare& compare) {
  auto list = ordered_json::array();
  for (const auto& member : compare.members) {
    ordered_json one{
        {"name", member.name},
        {"law", member.scene.model.law->card().name},
        {"parameters", results::values(member.scene.model.law->parameters(), member.scene.model.law->values())}};
    if (member.scene.model.law->has_states()) one["lambda"] = member.scene.model.lambda;
    if (!member.adjusted.empty()) {
      for (std::size_t k = 0; k < compare.adjust.size(); ++k) one["adjusted"][compare.adjust[k]] = member.adjusted[k];
      one["difference_left"] = member.difference;
    }
    list.push_back(std::move(one));
  }
  return list;
}

results::Column names_of(const tasks::Compare& compare) {
  std::vector<std::string> names;
  for (const auto& member : compare.members) names.push_back(member.name);
  return {{"member", "", "member of the comparison"}, std::move(names)};
}

/// Series of the members over their common coordinate, or over samples where each has its own; what is shorter is
/// filled with NaN.
results::Table table_of_series(const scene::Scene& scene, const output::Comparison& comparison) {
  const auto& series = comparison.series;
  const auto& first = series.front().x;
  const bool common = std::ranges::all_of(series, [&](const auto& one) { return one.x == first; });
  std::size_t length = 0;
  for (const auto& one : series) length = std::max(length, one.x.size());
  results::Table table{.name = "compare",
                       .dimensions = {{"member", series.size()}, {common ? comparison.x_name : "sample", length}},
                       .columns = {names_of(scene.task<tasks::Compare>())}};
  const auto padded = [&](auto of) {
    std::vector<double> all(series.size() * length, nothing);
    for (std::size_t k = 0; k < series.size(); ++k) std::ranges::copy(of(series[k]), all.begin() + long(k * length));
    return all;
  };
  const results::Channel x{comparison.x_name, comparison.x_unit};
  const results::Attributes beside =
      common ? results::Attributes{} : results::Attributes{{"coordinates", comparison.x_name}};
  if (common)
    table.columns.push_back({x, first, {}, {1}});
  else
    table.columns.push_back({x, padded([](const auto& one) -> const auto& { return one.x; }), {}, {0, 1}});
  for (std::size_t c = 0; c < comparison.column_names.size(); ++c)
    table.columns.push_back({{comparison.column_names[c], comparison.column_units[c]},
                             padded([c](const auto& one) -> const auto& { return one.columns[c]; }),
                             {},
                             {0, 1},
                             beside});
  return table;
}

results::Table table_of_planes(const scene::Scene& scene, const std::vector<analysis::planes::Map>& maps) {
  const auto& map = maps.front();
  std::vector<std::string> taken = {"member", "regime"};
  for (const auto& metric : map.metrics) taken.push_back(metric.name), taken.push_back(metric.name + "_error");
  const auto names = results::axis_names({map.y.parameter, map.x.parameter}, taken);
  results::Table table{
      .name = "compare",
      .dimensions = {{"member", maps.size()}, {names[0], map.y.values.size()}, {names[1], map.x.values.size()}},
      .columns = {names_of(scene.task<tasks::Compare>()), results::coordinate(names[0], 1, map.y, scene),
                  results::coordinate(names[1], 2, map.x, scene)}};
  std::vector<std::string> regimes;
  for (const auto& one : maps)
    for (const auto& point : one.points) regimes.push_back(name(point.regime));
  for (const auto& metric : map.metrics) {
    std::vector<double> values, errors;
    for (const auto& one : maps)
      for (const auto& point : one.points) values.push_back(metric.value(point)), errors.push_back(metric.error(point));
    table.columns.push_back({{metric.name, metric.unit}, std::move(values), std::move(errors), {0, 1, 2}});
  }
  table.columns.push_back({{"regime", "", "what the motion settles on"}, std::move(regimes), {}, {0, 1, 2}});
  return table;
}

results::Result result_of(const Job& job, const output::Comparison& comparison) {
  const auto& scene = job.scene();
  const auto& compare = scene.task<tasks::Compare>();
  auto result = job.result(comparison.outcome);
  result["protocol"] = compare.protocol;
  result["members"] = members(compare);
  auto& differences = result["differences"] = ordered_json::object();
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
    result["x"] = results::axis(first.x, scene);
    result["y"] = results::axis(first.y, scene);
    auto& planes = result["planes"] = ordered_json::object();
    for (std::size_t k = 0; k < comparison.maps.size(); ++k) {
      const auto& map = comparison.maps[k];
      auto& plane = planes[compare.members[k].name];
      plane["regime"] = results::grid_of_points(map, [](const auto& point) { return name(point.regime); });
      for (const auto& metric : map.metrics) {
        plane["metrics"][metric.name] =
            results::grid_of_points(map, [&](const auto& point) { return metric.value(point); });
        plane["error"][metric.name] =
            results::grid_of_points(map, [&](const auto& point) { return metric.error(point); });
      }
      plane["threshold"] = {{"x", map.threshold.x}, {"y", map.threshold.y}};
    }
    result.tables = {table_of_planes(scene, comparison.maps)};
  } else if (!comparison.series.empty()) {
    auto& series = result["series"] = ordered_json::object();
    for (std::size_t k = 0; k < comparison.series.size(); ++k) {
      auto& one = series[compare.members[k].name];
      one[comparison.x_name] = comparison.series[k].x;
      for (std::size_t c = 0; c < comparison.column_names.size(); ++c)
        one[comparison.column_names[c]] = comparison.series[k].columns[c];
    }
    result.tables = {table_of_series(scene, comparison)};
  }
  return result;
}

struct DesignResult {
  analysis::inference::Design design;
  double seconds = 0;
};

results::Table table_of(const scene::Scene& scene, const analysis::inference::Design& design) {
  const auto& compare = scene.task<tasks::Compare>();
  const auto words = compare.parameter.empty()
                         ? std::string("log-likelihood ratio of one measurement")
                         : "information on ln " + compare.parameter.substr(compare.parameter.rfind('.') + 1);
  const auto names = results::axis_names({design.y.parameter, design.x.parameter},
                                         {"discriminability", "discriminability_error", "repeats"});
  results::Table table{.name = "design",
                       .dimensions = {{names[0], design.y.values.size()}, {names[1], design.x.values.size()}},
                       .columns = {results::coordinate(names[0], 0, design.y, scene),
                                   results::coordinate(names[1], 1, design.x, scene)}};
  const results::Attributes decades = {{"scale", "log"}};
  const auto add = [&](const std::string& name, const std::string& meaning, const std::vector<double>& values,
                       std::vector<double> error = {}, results::Attributes more = {}) {
    table.columns.push_back({{name, "1", meaning}, values, std::move(error), {0, 1}, std::move(more)});
  };
  add("discriminability", words, design.information, design.information_error, decades);
  if (!design.repeats.empty()) add("repeats", "measurements needed", design.repeats);
  for (std::size_t m = 0; m < compare.noise.size(); ++m) {
    const auto& metric = compare.noise[m].metric;
    add("discriminability_" + metric, fmt::format("{}: {}", words, output::readable(metric)), design.by_metric[m], {},
        decades);
  }
  return table;
}

results::Result result_of(const Job& job, const DesignResult& of) {
  const auto& scene = job.scene();
  const auto& compare = scene.task<tasks::Compare>();
  const auto& design = of.design;
  auto result = job.result(design.outcome);
  result["members"] = members(compare);
  if (!compare.parameter.empty()) result["parameter"] = compare.parameter;
  auto& noise = result["noise"] = ordered_json::object();
  for (const auto& n : compare.noise) noise[n.metric] = {{"absolute", n.absolute}, {"relative", n.relative}};
  result["confidence"] = compare.confidence;
  result["x"] = results::axis(design.x, scene);
  result["y"] = results::axis(design.y, scene);
  const auto plane = [&](const std::vector<double>& numbers) {
    return results::grid(design, [&](std::size_t i) { return numbers[i]; });
  };
  result["discriminability"] = plane(design.information);
  result["discriminability_error"] = plane(design.information_error);
  if (!design.repeats.empty()) result["repeats"] = plane(design.repeats);
  const auto best = [&](const analysis::inference::Design::Best& b) {
    return ordered_json{{"x", b.x}, {"y", b.y}, {"discriminability", b.information}, {"repeats", b.repeats}};
  };
  result["best"] = best(design.best);
  auto& parts = result["by_metric"] = ordered_json::object();
  for (std::size_t m = 0; m < compare.noise.size(); ++m)
    parts[compare.noise[m].metric] = {{"discriminability", plane(design.by_metric[m])},
                                      {"best", best(design.best_by_metric[m])}};
  result.cost = {{"seconds", of.seconds}, {"failed", design.failed}};
  result.tables = {table_of(scene, design)};
  return result;
}

// ---------------------------------------------------------------- protocols

using Members = std::vector<tasks::Compare::Member>;

/// The entries of one member, in rows that the first member to have a metric begins.
class Entries {
 public:
  Entries(output::Comparison& comparison, std::size_t member, std::size_t members)
      : comparison_(comparison), member_(member), members_(members) {}
  void add(const std::string& metric, const std::string& unit, double value, double error) {
    auto row = std::ranges::find(comparison_.rows, metric, &output::Comparison::Row::metric);
    if (row == comparison_.rows.end())
      row =
          comparison_.rows.insert(row, {metric, unit, std::vector(members_, nothing), std::vector(members_, nothing)});
    row->values[member_] = value;
    row->errors[member_] = error;
  }

 private:
  output::Comparison& comparison_;
  std::size_t member_, members_;
};

void worsen(Outcome& outcome, const Outcome& other, const std::string& member) {
  if (outcome.complete() && !other.complete())
    outcome = {other.ending, fmt::format("member '{}': {}", member, other.detail)};
}

/// Steady curves, and friction and its slope at the drive's speed.
output::Comparison compare_curves(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  const auto& options = scene.task<tasks::Curve>();
  output::Comparison comparison;
  comparison.x_name = "slip_rate", comparison.x_unit = "m/s";
  comparison.column_names = {"friction_coefficient"}, comparison.column_units = {"1"};
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& model = members[k].scene.model;
    output::Comparison::Series series{{}, {{}}};
    for (int i = 0; i < options.points; ++i)
      series.x.push_back(options.from * std::pow(options.to / options.from, double(i) / (options.points - 1)));
    series.columns[0] = analysis::steady::steady_curve(*model.law, series.x, options.normal_load);
    const double V = model.drive.speed.level();
    const auto steady = model.law->steady_friction({V, options.normal_load});
    Entries entries(comparison, k, members.size());
    entries.add("steady_friction", "1", steady.friction, 4e-16 * std::abs(steady.friction));
    entries.add("steady_slope", "1", V * steady.slope, 4e-16 * std::abs(V * steady.slope));
    comparison.series.push_back(std::move(series));
  }
  return comparison;
}

output::Comparison compare_stability(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  output::Comparison comparison;
  for (std::size_t k = 0; k < members.size(); ++k) {
    Entries entries(comparison, k, members.size());
    if (members[k].scene.structure) {  // whose parameters no closed form knows
      const auto mode = analysis::steady::stability(members[k].scene.structure->structure).modes.front();
      entries.add("growth_rate", "1/s", mode.growth_rate(), mode.error);
      entries.add("frequency", "Hz", mode.frequency(), mode.error / (2 * std::numbers::pi));
      continue;
    }
    for (const char* path : {"drive.normal_load", "oscillator.stiffness", "drive.speed"}) {
      const auto points = analysis::steady::hopf_points(members[k].scene.model, path);
      if (points.empty()) continue;
      const auto& nearest = points.front();
      entries.add(fmt::format("hopf {}", path), scene.model.describe(path).unit, nearest.value, nearest.value_error);
      entries.add(fmt::format("hopf {} angular_frequency", path), "rad/s", nearest.angular_frequency,
                  1e-12 * nearest.angular_frequency);
    }
  }
  return comparison;
}

/// Friction responses of the contact, and the receptance along it of what it is a part of.
output::Comparison compare_responses(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  const auto& asked = scene.task<tasks::Frf>();
  if (asked.record || asked.sweep || asked.noise)
    throw InputError("frf.record and frf.simulate have no members: compare lays predictions over each other");
  output::Comparison comparison;
  comparison.x_name = "frequency", comparison.x_unit = "Hz";
  comparison.column_names = {"real", "imaginary"}, comparison.column_units = {"N s/m", "N s/m"};
  constexpr double rounding = 1e-12;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& frf = members[k].scene.task<tasks::Frf>();
    const auto curve = analysis::response::predict_frf(members[k].scene.model, frf.options).curve;
    Entries entries(comparison, k, members.size());
    const auto add = [&](const char* name, double value) {
      entries.add(name, "N s/m", value, rounding * std::abs(value));
    };
    output::Comparison::Series series{frf.options.frequencies, {{}, {}}};
    double largest = 0;
    for (const auto& Z : curve.tangential) {
      series.columns[0].push_back(Z.real()), series.columns[1].push_back(Z.imag());
      largest = std::max(largest, std::abs(Z));
    }
    add("low_frequency_limit", curve.limits.low), add("high_frequency_limit", curve.limits.high);
    add("largest magnitude", largest);
    if (frf.oscillator) {
      double most = 0, error = 0;
      for (const double f : frf.options.frequencies)
        if (const auto answer = frf.oscillator->at({0, 2 * std::numbers::pi * f}); std::abs(answer.contact) > most)
          most = std::abs(answer.contact), error = answer.contact_error;
      entries.add("largest receptance", "m/N", most, error);
    }
    comparison.series.push_back(std::move(series));
  }
  return comparison;
}

/// Of a slider the other columns follow from three.
bool is_shown(const scene::Scene& member, std::string_view column) {
  if (member.structure || member.plane) return true;
  return column == "displacement" || column == "slip_rate" || column == "friction_coefficient";
}

/// What a member's motion is laid over the others by.
struct Motion {
  std::vector<std::string> names, units;
  output::Comparison::Series series;
};

/// The columns that all members have which move.
void lay_over(output::Comparison& comparison, const std::vector<Motion>& motions) {
  comparison.x_name = "time", comparison.x_unit = "s";
  const auto place = [](const Motion& motion, const std::string& name) {
    return std::size_t(std::ranges::find(motion.names, name) - motion.names.begin());
  };
  const auto moves = std::ranges::find_if(motions, [](const auto& motion) { return !motion.names.empty(); });
  if (moves == motions.end()) return;
  for (std::size_t c = 0; c < moves->names.size(); ++c) {
    const auto& name = moves->names[c];
    if (std::ranges::any_of(motions, [&](const auto& motion) {
          return !motion.names.empty() && place(motion, name) == motion.names.size();
        }))
      continue;
    comparison.column_names.push_back(name), comparison.column_units.push_back(moves->units[c]);
  }
  for (const auto& motion : motions) {
    auto& series = comparison.series.emplace_back();
    series.x = motion.series.x;
    for (const auto& name : comparison.column_names)
      series.columns.push_back(motion.names.empty() ? std::vector<double>()
                                                    : motion.series.columns[place(motion, name)]);
  }
}

Motion compare_run(const StringRun& run, const tasks::Bowing& task, Entries entries) {
  for (const auto& metric : run.metrics) entries.add(metric.name, metric.unit, metric.value, metric.error);
  Motion motion{{}, {}, {run.record.time, {}}};
  for (const auto& [name, unit, values] : columns_of(run.record, task))
    motion.names.push_back(name), motion.units.push_back(unit), motion.series.columns.push_back(*values);
  return motion;
}

output::Comparison compare_runs(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  output::Comparison comparison;
  std::vector<Motion> motions;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& member = members[k].scene;
    if (member.string) {
      const auto run = run_of(*member.string);
      worsen(comparison.outcome, run.record.bowing.outcome, members[k].name);
      motions.push_back(compare_run(run, *member.string, Entries(comparison, k, members.size())));
      continue;
    }
    auto how = member.task<analysis::motion::RunOptions>();
    how.tolerance = scene.task<analysis::motion::RunOptions>().tolerance;
    const auto run = run_of(member, how);
    worsen(comparison.outcome, run.outcome, members[k].name);
    Motion motion{{}, {}, {run.time, {}}};
    Entries entries(comparison, k, members.size());
    for (std::size_t c = 0; c < run.columns.size(); ++c) {
      const auto& column = run.columns[c];
      const auto &name = run.column_names[c], &unit = run.column_units[c];
      if (!is_shown(member, name)) continue;
      motion.names.push_back(name), motion.units.push_back(unit), motion.series.columns.push_back(column);
      if (column.empty()) continue;
      const double error = c < run.column_error.size() ? run.column_error[c] : nothing;
      entries.add(name + " at the end", unit, column.back(), error);
      entries.add("largest " + name, unit, *std::ranges::max_element(column), error);
    }
    motions.push_back(std::move(motion));
  }
  lay_over(comparison, motions);
  return comparison;
}

Motion compare_cycle(const scene::Scene& member, const analysis::cycles::StructureCycle& cycle, Entries entries) {
  if (cycle.returns == 0) return {};
  for (const auto& [name, measure] : cycle.metrics) entries.add(name, measure.unit, measure.value, measure.error);
  Motion motion{{}, {}, {cycle.time, {}}};
  for (std::size_t c = 0; c < cycle.columns.size(); ++c) {
    if (!is_shown(member, cycle.column_names[c])) continue;
    motion.names.push_back(cycle.column_names[c]), motion.units.push_back(cycle.column_units[c]);
    motion.series.columns.push_back(cycle.columns[c]);
  }
  return motion;
}

Motion compare_cycle(const scene::Scene&, const analysis::strings::StringCycle& cycle, Entries entries) {
  for (const auto& [name, unit, meaning, member] : analysis::strings::string_period_names())
    entries.add(name, unit, (cycle.period.*member).value, (cycle.period.*member).error);
  return {};
}

output::Comparison compare_cycles(const scene::Scene& scene) {
  const auto& members = scene.task<tasks::Compare>().members;
  output::Comparison comparison;
  std::vector<Motion> motions;
  const auto add = [&](std::size_t k, const auto& cycle) {
    worsen(comparison.outcome, cycle.outcome, members[k].name);
    motions.push_back(compare_cycle(members[k].scene, cycle, Entries(comparison, k, members.size())));
  };
  const double tolerance = scene.task<analysis::cycles::CycleOptions>().tolerance;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto& member = members[k].scene;
    if (const auto& string = member.string) {
      add(k,
          analysis::strings::string_cycles(std::span(&string->model, 1), string->periods, string->options.transient, 1)
              .front());
      continue;
    }
    auto how = member.task<analysis::cycles::CycleOptions>();
    how.tolerance = tolerance;
    const analysis::cycles::StructureCycleOptions many{
        .tolerance = tolerance, .stick_threshold = how.stick_threshold, .multipliers = false};
    if (const auto* stepped = scene::stepped_of(member))
      add(k, analysis::cycles::find_cycle(*stepped, many));
    else if (member.structure)
      add(k, analysis::cycles::find_cycle(*member.structure, many));
    else
      add(k, analysis::cycles::find_measured_cycle(member.model, how));
  }
  lay_over(comparison, motions);
  return comparison;
}

output::Comparison compare_maps(const scene::Scene& scene, const Request& request) {
  const auto& members = scene.task<tasks::Compare>().members;
  auto options = scene.task<analysis::planes::MapOptions>();
  options.threads = request.threads;
  output::Comparison comparison;
  Progress progress(request.quiet);
  for (std::size_t k = 0; k < members.size(); ++k) {
    comparison.maps.push_back(
        varied(members[k].scene).map(options, {.known = {}, .finished = {}, .progress = progress.of_map()}));
    worsen(comparison.outcome, comparison.maps.back().outcome, members[k].name);
    if (comparison.outcome.ending == Ending::interrupted) return comparison;
  }
  // Of each metric the largest difference to the first member, where both have a cycle.
  for (const auto& metric : comparison.maps[0].metrics) {
    for (std::size_t k = 0; k < members.size(); ++k) {
      double largest = 0, its_error = 0;
      for (std::size_t i = 0; i < comparison.maps[0].points.size(); ++i) {
        const auto &one = comparison.maps[0].points[i], &other = comparison.maps[k].points[i];
        const double difference = std::abs(metric.value(other) - metric.value(one));
        if (!(difference > largest)) continue;
        largest = difference;
        its_error = metric.error(one) + metric.error(other);
      }
      Entries(comparison, k, members.size())
          .add("largest difference of " + metric.name, metric.unit, largest, its_error);
    }
  }
  return comparison;
}

void say_members(const Job& job, const tasks::Compare& compare) {
  for (const auto& member : compare.members) {
    std::string adjusted;
    for (std::size_t k = 0; k < member.adjusted.size(); ++k)
      adjusted +=
          fmt::format("{}{} = {:.10g}", k == 0 ? "; made equal by " : ", ", compare.adjust[k], member.adjusted[k]);
    if (!member.adjusted.empty()) adjusted += fmt::format(", leaving {:.1g} (relative)", member.difference);
    job.say("{}: law '{}'{}", member.name, member.scene.model.law->card().name, adjusted);
  }
}

/// Stick is creep below the threshold under smooth laws and exact rest under set-valued ones. Where members are of both
/// kinds stick_fraction would compare the two, slow_fraction is the same for all.
bool of_both_kinds(const Members& members) {
  const auto set_valued = [](const auto& member) { return member.scene.model.law->set_valued(); };
  return std::ranges::any_of(members, set_valued) && !std::ranges::all_of(members, set_valued);
}
constexpr std::string_view two_kinds =
    "stick_fraction is exact rest under set-valued laws, and slip below the threshold under smooth ones";
void say_too(Job& job, std::string text) {
  job.note(text);
  job.scene().notes.push_back(std::move(text));
}
/// Takes the slow fraction for the stick fraction among the metrics named, and says so.
void take_slow_fraction(Job& job, const std::vector<std::string*>& metrics) {
  const auto named = [&](std::string_view name) {
    return std::ranges::find_if(metrics, [&](const auto* metric) { return *metric == name; });
  };
  const auto stick = named("stick_fraction");
  if (stick == metrics.end() || named("slow_fraction") != metrics.end() ||
      !of_both_kinds(job.scene().task<tasks::Compare>().members))
    return;
  **stick = "slow_fraction";
  say_too(job, fmt::format("{}: members of both kinds are compared by slow_fraction, slip below the threshold under "
                           "every law",
                           two_kinds));
}

Status side_by_side(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& compare = scene.task<tasks::Compare>();
  const auto& protocol = compare.protocol;
  if (request.tolerance)
    scene.task<analysis::motion::RunOptions>().tolerance = scene.task<analysis::cycles::CycleOptions>().tolerance =
        scene.task<analysis::planes::MapOptions>().tolerance = *request.tolerance;
  if (protocol == "cycle" && of_both_kinds(compare.members))
    say_too(job, fmt::format("{}: compare slow_fraction, slip below the threshold under every law", two_kinds));
  if (protocol == "map") {
    std::vector<std::string*> metrics;
    for (auto& metric : scene.task<analysis::planes::MapOptions>().metrics) metrics.push_back(&metric);
    take_slow_fraction(job, metrics);
  }
  job.explain("{} members under protocol '{}'", compare.members.size(), protocol);
  const auto begin = std::chrono::steady_clock::now();
  const output::Comparison comparison = protocol == "curve"       ? compare_curves(scene)
                                        : protocol == "stability" ? compare_stability(scene)
                                        : protocol == "run"       ? compare_runs(scene)
                                        : protocol == "map"       ? compare_maps(scene, request)
                                        : protocol == "frf"       ? compare_responses(scene)
                                                                  : compare_cycles(scene);
  if (comparison.outcome.ending == Ending::interrupted) return stopped_early(request, "nothing is written");
  say_members(job, compare);
  Reached reached;
  std::string header(34, ' ');
  for (const auto& member : compare.members) header += fmt::format("  {:>28}", member.name);
  job.say("{}", header);
  std::vector<std::string> told;
  for (const auto& row : comparison.rows) told.push_back(row.metric);
  if (protocol == "cycle" && !scene.string) told = told_metrics(scene, told);
  for (const auto& metric : told) {
    const auto& row = *std::ranges::find(comparison.rows, metric, &output::Comparison::Row::metric);
    std::string line = fmt::format("{:<34}", row.metric);
    for (std::size_t k = 0; k < row.values.size(); ++k) {
      line += fmt::format("  {:>28}", justified(row.values[k], row.errors[k], row.unit));
      reached.add(row.values[k], row.errors[k]);
    }
    job.say("{}", line);
  }
  auto& manifest = job.manifest();
  manifest.tolerance_reached = reached.value();
  manifest.cost = {{"seconds", seconds_since(begin)}};
  return job.finish(result_of(job, comparison), comparison.series.empty()
                                                    ? std::vector<std::string>()
                                                    : output::write_picture(job.folder(), scene, comparison));
}

Status design(Job& job) {
  const auto& request = job.request();
  auto& scene = job.scene();
  auto& map = scene.task<analysis::planes::MapOptions>();
  auto& compare = scene.task<tasks::Compare>();
  std::vector<std::string*> metrics;
  for (auto& noise : compare.noise) metrics.push_back(&noise.metric);
  take_slow_fraction(job, metrics);
  analysis::inference::DesignOptions options{.x = map.x,
                                             .y = map.y,
                                             .noise = compare.noise,
                                             .tolerance = request.tolerance.value_or(map.tolerance),
                                             .stick_threshold = map.stick_threshold,
                                             .threads = request.threads,
                                             .confidence = compare.confidence};
  std::vector<std::string> measured;
  for (const auto& noise : compare.noise) measured.push_back(noise.metric);
  const bool of_parameter = !compare.parameter.empty();
  job.explain("{} over {} and {}, measuring {}; every point is computed",
              of_parameter ? "information on " + compare.parameter : std::string("likelihood ratio between members"),
              options.x.parameter, options.y.parameter, fmt::join(measured, ", "));
  const auto begin = std::chrono::steady_clock::now();
  DesignResult result;
  {
    Progress progress(request.quiet);
    const analysis::planes::MapHooks hooks{.known = {}, .finished = {}, .progress = progress.of_map()};
    std::vector<analysis::planes::Varied> members;
    for (const auto& member : compare.members) members.push_back(varied(member.scene));
    result.design = of_parameter ? analysis::inference::inform(varied(scene), compare.parameter, options, hooks)
                                 : analysis::inference::discriminate(members, options, hooks);
  }
  result.seconds = seconds_since(begin);
  const auto& plane = result.design;
  if (plane.outcome.ending == Ending::interrupted) return stopped_early(request, "nothing is written");
  if (!of_parameter) say_members(job, compare);
  const auto say_best = [&](const std::string& what, const analysis::inference::Design::Best& best) {
    if (!(best.information > 0)) return job.say("{:<22} tells nothing anywhere", what);
    const auto place = fmt::format("at {} = {:.4g}, {} = {:.4g}", plane.x.parameter, best.x, plane.y.parameter, best.y);
    if (of_parameter)
      job.say("{:<22} best {}: standard error of ln({}) from one measurement {:.3g}", what, place, compare.parameter,
              1 / std::sqrt(best.information));
    else
      job.say("{:<22} best {}: log-likelihood ratio {:.4g} a measurement, {} for {:.4g} %", what, place,
              best.information, best.repeats == 1 ? std::string("one") : fmt::format("{}", best.repeats),
              100 * compare.confidence);
  };
  say_best("all metrics together", plane.best);
  if (compare.noise.size() > 1)
    for (std::size_t m = 0; m < measured.size(); ++m) say_best(measured[m], plane.best_by_metric[m]);
  job.manifest().tolerance_asked = options.tolerance;
  job.manifest().cost = {{"seconds", result.seconds}, {"points", double(plane.information.size())}};
  return job.finish(result_of(job, result), output::write_picture(job.folder(), scene, plane));
}

Status perform_compare(Job& job) {
  if (job.scene().string && !job.scene().string->members.empty()) return perform_string_comparison(job);
  return job.request().design ? design(job) : side_by_side(job);
}

}  // namespace

Verb compare_verb() {
  return {.name = "compare",
          .help = "several laws or parameter sets side by side; --design: which measurement tells them apart",
          .example = "rosin compare examples/compare-laws.toml",
          .operands = {scene_operand},
          .needs = model_tables({{"compare", "members, and what is made equal in them"},
                                 {"run", "where the protocol is a run", true},
                                 {"map", "where the protocol is a map, and for a design", true}}),
          .options = scene_options(
              {{"--design", &Request::design, "where, and by how many repeats, measurements tell members apart"}}),
          .read = read_compare,
          .perform = perform_compare};
}

}  // namespace rosin::app::verbs
