/// The verb stability: steady sliding, its eigenvalues and Hopf points.
#include "analysis/steady/stability.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/steady/mode_windows.hpp"
#include "analysis/steady/reduction_error.hpp"
#include "analysis/steady/sliding_modes.hpp"
#include "analysis/steady/structure_hopf.hpp"
#include "analysis/steady/structure_stability.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/family.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/reduced_block.hpp"
#include "app/scene/scene.hpp"
#include "app/scene/structure.hpp"
#include "app/tasks/stability.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/string_verbs.hpp"
#include "app/verbs/verb.hpp"
#include "oscillators/block.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

tasks::StabilityScan read_scan(scene::Table table, scene::SceneReader& reader) {
  tasks::StabilityScan scan;
  const auto& family = *(reader.scene.family = std::make_shared<scene::Family>(reader, "stability.scan"));
  table.expect({"parameter", "from", "to", "points", "scale"});
  const auto& parameter = table.required("parameter", "path of a number, such as law.mu_d");
  scan.parameter = scene::located(parameter.source(),
                                  [&] { return family.describe(scene::text(parameter, table.path("parameter"))); });
  const auto meaning = scan.parameter.name + ", " + scan.parameter.meaning;
  double from = 0, to = 0;
  int points = 60;
  table.required("from", meaning), table.required("to", meaning);
  table.read("from", from, scan.parameter), table.read("to", to, scan.parameter);
  table.read("points", points, 2, 100'000, "number of values");
  bool logarithmic = false;
  if (const auto* scale = table.find("scale"))
    logarithmic = scene::choice(*scale, table.path("scale"), {"log", "linear"}) == "log";
  table.finish();
  scan.axis = scene::located(table.source(), [&] {
    return analysis::planes::make_axis(scan.parameter.name, std::min(from, to), std::max(from, to), points, logarithmic,
                                       {});
  });
  return scan;
}

void read_stability_table(scene::Table table, scene::SceneReader& reader) {
  auto& scene = reader.scene;
  auto& asked = scene.task<tasks::Stability>();
  if (const auto* parameters = table.find("parameters")) {
    asked.parameters = scene::texts(*parameters, "stability.parameters");
    for (std::size_t i = 0; i < asked.parameters.size(); ++i)
      scene::located(parameters->as_array()->get(i)->source(), [&] { scene.model.describe(asked.parameters[i]); });
  }
  table.read("modes", asked.modes, 1, 200, "modes of lowest frequency that are followed");
  if (const auto* scan = table.find("scan")) asked.scan = read_scan(scene::Table(*scan, table.path("scan")), reader);
  table.finish();
}

ordered_json states(const FrictionLaw& law, std::span<const double> state) {
  auto object = ordered_json::object();
  for (std::size_t i = 0; i < state.size(); ++i) object[law.states()[i].name] = state[i];
  return object;
}

struct StabilityResult {
  analysis::steady::Stability stability;
  std::vector<analysis::steady::HopfPoint> hopf;
};

results::Result result_of(const Job& job, const StabilityResult& of) {
  auto result = job.result();
  const auto& steady = of.stability.steady;
  results::Object sliding;
  sliding.add({"slip_rate", "m/s"}, steady.slip_rate);
  sliding.add({"friction_coefficient"}, steady.friction_coefficient);
  sliding.add({"friction_force", "N"}, steady.friction_force);
  sliding.add({"displacement", "m"}, steady.displacement);
  sliding["state"] = states(*job.scene().model.law, steady.state);
  result["steady"] = sliding.json();
  result.add({"eigenvalues", "1/s"}, results::pairs(of.stability.eigenvalues), of.stability.eigenvalue_errors);
  result["stable"] = of.stability.stable;
  result["marginal"] = of.stability.marginal;
  auto& hopf = result["hopf"] = ordered_json::array();
  for (const auto& point : of.hopf)
    hopf.push_back({{"parameter", point.parameter},
                    {"value", point.value},
                    {"angular_frequency", point.angular_frequency},
                    {"criticality", name(point.criticality)},
                    {"first_lyapunov_coefficient", point.first_lyapunov_coefficient},
                    {"closed_form", point.closed_form},
                    {"error", {{"value", point.value_error}}}});
  return result;
}

ordered_json steady_of(const oscillators::Structure& structure, const analysis::steady::StructureStability& result) {
  auto coordinates = ordered_json::object();
  for (std::size_t i = 0; i < result.coordinates.size(); ++i) coordinates[structure.names[i]] = result.coordinates[i];
  auto contacts = ordered_json::array();
  for (const auto& contact : result.contacts)
    contacts.push_back({{"normal_load", contact.normal_load},
                        {"friction_force", contact.friction_force},
                        {"slip_rate", contact.slip_rate}});
  ordered_json steady = {{"coordinates", coordinates}, {"contacts", contacts}};
  const Eigen::Map<const Eigen::VectorXd> q(result.coordinates.data(), Eigen::Index(result.coordinates.size()));
  for (const auto& functional : structure.functionals) steady[functional.name] = functional.row.dot(q);
  return steady;
}

/// What the stations of a block bear together: forces, and the place of the pressure's resultant.
struct Resultant {
  double normal_load = 0, friction_force = 0, moment = 0;
  double centre_of_pressure() const { return moment / normal_load; }
};
Resultant resultant_of(const oscillators::BlockMesh& mesh, const analysis::steady::StructureStability& result) {
  Resultant sum;
  for (std::size_t s = 0; s < mesh.stations.size(); ++s) {
    sum.normal_load += result.contacts[s].normal_load, sum.friction_force += result.contacts[s].friction_force;
    sum.moment += result.contacts[s].normal_load * mesh.stations[s].place;
  }
  return sum;
}

/// Of a block on its mesh, or of a reduced one; null: another oscillator is in the scene.
const oscillators::BlockMesh* mesh_of(const scene::Scene& scene) {
  const auto* reduced = scene::reduced_block_of(scene);
  return reduced ? &reduced->mesh : scene.block.get();
}

ordered_json document_of(const Resultant& sum) {
  return {{"normal_load", sum.normal_load},
          {"friction_force", sum.friction_force},
          {"centre_of_pressure", sum.centre_of_pressure()}};
}

/// Nodes and elements of a block, for whoever draws it.
ordered_json document_of(const oscillators::BlockMesh& mesh) {
  auto nodes = ordered_json::array(), stations = ordered_json::array();
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) nodes.push_back({mesh.nodes(0, k), mesh.nodes(1, k)});
  for (const auto& station : mesh.stations) stations.push_back({{"place", station.place}, {"area", station.area}});
  return {{"nodes", nodes}, {"elements", mesh.elements}, {"stations", stations}};
}

/// Of the modes that were followed, Hz.
double highest_frequency(const analysis::steady::StructureStability& result) {
  double highest = 0;
  for (const auto& mode : result.modes) highest = std::max(highest, mode.frequency());
  return highest;
}

using Hopf = std::optional<analysis::steady::StructureHopf>;
using HopfAt = std::function<Hopf(const analysis::steady::Crossing&)>;

ordered_json crossing_of(const analysis::steady::Crossing& crossing, const Hopf& hopf) {
  ordered_json document = {{"value", crossing.value},
                           {"kind", crossing.onset ? "onset" : "end"},
                           {"angular_frequency", crossing.angular_frequency},
                           {"error", crossing.error}};
  if (hopf)
    document.update({{"criticality", name(hopf->criticality)},
                     {"first_lyapunov_coefficient", hopf->first_lyapunov_coefficient},
                     {"first_lyapunov_coefficient_error", hopf->error},
                     {"amplitude_coefficient", hopf->amplitude}});
  return document;
}

/// Eigenvalues along the scan, one of each conjugate pair, by the mode that they are of.
results::Table table_of(const scene::Scene& scene, const analysis::steady::Scan& scan) {
  const auto& [parameter, axis] = *scene.task<tasks::Stability>().scan;
  const auto name = results::axis_names({parameter.name}, {"mode", "growth_rate", "frequency"}).front();
  std::size_t most = 0;
  for (const auto& values : scan.eigenvalues) most = std::max(most, values.size());
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < most; ++k)
    if (std::ranges::any_of(scan.eigenvalues, [k](const auto& at) { return k < at.size() && at[k].imag() >= 0; }))
      kept.push_back(k);
  std::vector<double> growth, frequency;
  for (const auto& at : scan.eigenvalues)
    for (const auto k : kept) {
      growth.push_back(k < at.size() ? at[k].real() : NAN);
      frequency.push_back(k < at.size() ? std::abs(at[k].imag()) / (2 * std::numbers::pi) : NAN);
    }
  return {"stability",
          {{name, scan.values.size()}, {"mode", kept.size()}},
          {{{name, parameter.unit, parameter.meaning}, scan.values, {}, {0}, {{"path", parameter.name}}},
           {{"growth_rate", "1/s", "growth rate"}, std::move(growth), {}, {0, 1}},
           {{"frequency", "Hz", "frequency"}, std::move(frequency), {}, {0, 1}}}};
}

results::Result result_of(const Job& job, const analysis::steady::StructureStability& of,
                          const analysis::steady::Scan* scan, const HopfAt& hopf_at) {
  const auto& scene = job.scene();
  const auto& asked = scene.task<tasks::Stability>();
  const auto& structure = scene.structure->structure;
  auto result = job.result();
  result["steady"] = steady_of(structure, of);
  if (const auto* mesh = mesh_of(scene)) result["steady"].update(document_of(resultant_of(*mesh, of)));
  if (scene.block) result["mesh"] = document_of(*scene.block);
  if (asked.modes > 0) result["window"] = {{"modes", of.modes.size()}, {"highest_frequency", highest_frequency(of)}};
  result.add({"eigenvalues", "1/s"}, results::pairs(of.eigenvalues));
  result["stable"] = of.stable;
  result["marginal"] = of.marginal;
  result["unstable_modes"] = of.unstable_modes();
  auto& modes = result["modes"] = ordered_json::array();
  for (const auto& mode : of.modes)
    modes.push_back({{"frequency", mode.frequency()},
                     {"growth_rate", mode.growth_rate()},
                     {"damping_ratio", mode.damping_ratio()},
                     {"shape", results::pairs(mode.shape)},
                     {"error", {{"eigenvalue", mode.error}}}});
  if (!scan) return result;
  result["parameter"] = asked.scan->parameter.name;
  result["unit"] = asked.scan->parameter.unit;
  auto& thresholds = result["thresholds"] = ordered_json::array();
  for (const auto& threshold : scan->thresholds) {
    thresholds.push_back(crossing_of(threshold, hopf_at(threshold)));
    thresholds.back()["steady"] = steady_of(structure, threshold.at);
  }
  auto& windows = result["windows"] = ordered_json::array();
  for (const auto& window : scan->windows) {
    const auto edge = [&](const std::optional<analysis::steady::Threshold>& at) {
      return at ? crossing_of(*at, hopf_at(*at)) : ordered_json();
    };
    windows.push_back({{"onset", edge(window.onset)},
                       {"end", edge(window.end)},
                       {"fastest",
                        {{"value", window.at},
                         {"growth_rate", window.fastest.growth_rate()},
                         {"frequency", window.fastest.frequency()},
                         {"shape", results::pairs(window.fastest.shape)},
                         {"error", {{"growth_rate", window.fastest.error}}}}}});
  }
  auto branches = ordered_json::array();
  for (const auto& values : scan->eigenvalues) branches.push_back(results::pairs(values));
  result["path"] = {{"value", scan->values}, {"eigenvalues", branches}, {"unstable_modes", scan->unstable_modes}};
  result.tables = {table_of(scene, *scan)};
  return result;
}

/// All modes, or the lowest where the scene asks for some of them or has too many.
analysis::steady::StructureStability stability_of(const scene::Scene& scene, const oscillators::Structure& structure) {
  return scene.task<tasks::Stability>().modes > 0
             ? analysis::steady::lowest_modes_of_sliding(structure, scene.task<tasks::Stability>().modes)
             : analysis::steady::stability(structure);
}

/// Adds to the errors of modes what the reduction of a block changes in them.
void add_reduction(const scene::Scene& scene, analysis::steady::StructureStability& result) {
  const auto* block = scene::reduced_block_of(scene);
  if (!block) return;
  const auto errors = analysis::steady::reduction_errors(block->reduction, result);
  for (std::size_t k = 0; k < errors.size(); ++k) result.modes[k].error += errors[k];
}

/// The same of thresholds, and of the modes that grow fastest.
void add_reduction(const scene::Scene& scene, analysis::steady::Scan& scan) {
  if (!scene::reduced_block_of(scene)) return;
  const auto at = [&](double value) {
    return scene.family->with_numbers({{scene.task<tasks::Stability>().scan->parameter.name, value}});
  };
  std::map<double, double> known;
  const auto add = [&](analysis::steady::Threshold& threshold) {
    const auto [entry, is_new] = known.try_emplace(threshold.value);
    if (is_new)
      entry->second = analysis::steady::reduction_error(
          threshold, [&](double value) { return scene::reduced_block_of(at(value))->reduction; },
          [&](const auto& structure) { return stability_of(scene, structure); });
    threshold.error += entry->second;
    add_reduction(at(threshold.value), threshold.at);
  };
  std::ranges::for_each(scan.thresholds, add);
  for (auto& window : scan.windows) {
    if (window.onset) add(*window.onset);
    if (window.end) add(*window.end);
    const auto there = at(window.at);
    auto modes = stability_of(scene, there.structure->structure);
    add_reduction(there, modes);
    window.fastest.error = std::ranges::min_element(modes.modes, {}, [&](const auto& mode) {
                             return std::abs(mode.eigenvalue - window.fastest.eigenvalue);
                           })->error;
  }
}

/// At most so many digits, none below the error; 0 of what its error hides.
std::string known(double value, double error, int digits) {
  if (!std::isfinite(error)) return fmt::format("{:.{}g}", value, digits);
  if (std::abs(value) <= error) return "0";
  const double vouched = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(error)) + 1;
  return fmt::format("{:.{}g}", value, error > 0 && vouched < digits ? std::max(1, int(vouched)) : digits);
}
std::string signed_known(double value, double error, int digits) {
  return (value < 0 ? "" : "+") + known(value, error, digits);
}

Status perform_on_structure(Job& job) {
  auto& scene = job.scene();
  auto& asked = scene.task<tasks::Stability>();
  const auto& structure = scene.structure->structure;
  constexpr int usual_modes = 10;
  if (scene.block && asked.modes == 0) asked.modes = usual_modes;
  job.explain("eigenvalues of the linearised structure of {} coordinates and {} contacts; no integration",
              structure.size(), structure.contacts.size());
  if (!asked.parameters.empty())
    throw InputError(
        "stability.parameters serves sliders; of a structure give stability.scan = { parameter, from, to }");
  if (!structure.constant()) job.note("the drive varies: stability is that of its mean, or of its start");
  auto result = stability_of(scene, structure);
  add_reduction(scene, result);
  if (asked.modes > 0)
    job.note(
        fmt::format("stability is that of the {} modes of lowest frequency, up to {:.4g} Hz (stability.modes); above "
                    "them a mesh has "
                    "modes of its own, which grow a little where nothing damps them",
                    result.modes.size(), highest_frequency(result)));
  const auto* mesh = mesh_of(scene);
  if (mesh) {
    const auto sum = resultant_of(*mesh, result);
    job.say(
        "steady sliding under {:.10g} N: friction force {:.10g} N, elongation of the spring {:.10g} m, centre of "
        "pressure at {:.10g} m",
        sum.normal_load, sum.friction_force,
        structure.functionals.front().row.dot(
            Eigen::Map<const Eigen::VectorXd>(result.coordinates.data(), Eigen::Index(result.coordinates.size()))),
        sum.centre_of_pressure());
  }
  for (std::size_t j = 0; j < result.contacts.size() && !mesh; ++j)
    job.say("contact {}: steady sliding at {:.6g} m/s under {:.6g} N, friction force {:.10g} N", j + 1,
            result.contacts[j].slip_rate, result.contacts[j].normal_load, result.contacts[j].friction_force);
  job.say("{}", result.marginal ? "marginal: small disturbances neither grow nor decay"
                : result.stable ? "stable"
                                : "unstable");
  job.say("  {:>14} {:>16} {:>12}", "frequency (Hz)", "growth (1/s)", "damping (1)");
  Reached reached;
  for (const auto& mode : result.modes) {
    const double turn = 2 * std::numbers::pi, size = std::abs(mode.eigenvalue);
    job.say("  {:>14} {:>16} {:>12}", known(mode.frequency(), mode.error / turn, 8),
            signed_known(mode.growth_rate(), mode.error, 8), known(mode.damping_ratio(), mode.error / size, 4));
    reached.add(std::abs(mode.eigenvalue), mode.error);
  }
  std::vector<std::string> files;
  if (scene.block) files = output::write_block_picture(job.folder(), scene, result);
  if (!asked.scan) {
    job.manifest().tolerance_reached = reached.value();
    return job.finish(result_of(job, result, nullptr, nullptr), std::move(files));
  }
  const auto& parameter = asked.scan->parameter;
  const auto& axis = asked.scan->axis;
  job.explain("{} values of {}, with the eigenvalues of each; thresholds between them located to rounding",
              axis.values.size(), parameter.name);
  auto scan = analysis::steady::scan(
      [&](double value) {
        return stability_of(scene, scene.family->with({{parameter.name, value}}).structure);
      },
      axis.values, asked.modes > 0 ? int(axis.values.size()) : 2000);
  add_reduction(scene, scan);
  const HopfAt hopf_at = [&](const auto& crossing) {
    return asked.modes > 0 ? std::nullopt
                           : analysis::steady::hopf_at(
                                 [&](double value) {
                                   return scene.family->with({{parameter.name, value}}).structure;
                                 },
                                 crossing);
  };
  for (const auto& threshold : scan.thresholds) {
    reached.add(threshold.value, threshold.error);
    const auto hopf = hopf_at(threshold);
    job.say("{} of instability at {} = {}, {:.10g} rad/s{}", threshold.onset ? "onset" : "end", parameter.name,
            justified(threshold.value, threshold.error, parameter.unit), threshold.angular_frequency,
            hopf ? ", " + name(hopf->criticality) : "");
  }
  for (const auto& window : scan.windows) {
    const auto edge = [&](const std::optional<analysis::steady::Threshold>& at, const char* none) {
      if (at) reached.add(at->value, at->error);
      return at ? justified(at->value, at->error, parameter.unit) : none;
    };
    const auto& fastest = window.fastest;
    job.say("the mode of {:.4g} Hz grows from {} to {}, with {} 1/s at {:.4g}", fastest.frequency(),
            edge(window.onset, "the scan's beginning"), edge(window.end, "its end"),
            known(fastest.growth_rate(), fastest.error, 4), window.at / written_unit(parameter.unit).factor);
  }
  if (!scan.without.empty())
    job.note(fmt::format("no steady sliding at {} = {:.9g}: no eigenvalues there", parameter.name,
                         fmt::join(scan.without, ", ")));
  if (scan.thresholds.empty())
    job.say("no threshold in {} from {:g} to {:g}", parameter.name, axis.values.front(), axis.values.back());
  job.manifest().tolerance_reached = reached.value();
  for (auto& file : output::write_picture(job.folder(), scene, scan)) files.push_back(std::move(file));
  return job.finish(result_of(job, result, &scan, hopf_at), std::move(files));
}

/// A scan is of a structure; a slider is one of one coordinate.
void read_stability(scene::SceneReader& reader) {
  reader.law();
  reader.oscillator();
  if (reader.scene.string)
    return reader.note_unread({"stability.parameters", "stability.modes", "stability.scan"},
                              "of a string all partials are found, at the bow's own speed and load");
  read_tables_of_models(reader);
  if (reader.scene.task<tasks::Stability>().scan && !reader.scene.structure) scene::read_structure_model(reader);
  if (!reader.scene.structure) reader.note_unread({"stability.modes"}, "a slider has few modes, which are all found");
}

Status perform_stability(Job& job) {
  if (job.scene().string) return perform_string_stability(job);
  if (job.scene().structure) return perform_on_structure(job);
  const auto& scene = job.scene();
  const auto& model = scene.model;
  std::vector<std::string> paths = {"drive.normal_load", "oscillator.stiffness", "drive.speed"};
  if (model.law->has_states()) paths.push_back("law.lambda");
  for (const auto& path : scene.task<tasks::Stability>().parameters)
    if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  job.explain_model();
  job.explain("eigenvalues of the linearised slider; Hopf points in {}; no integration", fmt::join(paths, ", "));
  if (!model.drive.constant()) job.note("the drive varies: stability is that of its mean, or of its start");

  StabilityResult result;
  result.stability = analysis::steady::stability(model);
  const auto& steady = result.stability.steady;
  job.say("steady sliding at {} m/s: friction coefficient {:.10g}, force {:.10g} N", steady.slip_rate,
          steady.friction_coefficient, steady.friction_force);
  job.say("{}", result.stability.marginal ? "marginal: small disturbances neither grow nor decay"
                : result.stability.stable ? "stable"
                                          : "unstable");
  for (std::size_t i = 0; i < result.stability.eigenvalues.size(); ++i) {
    const auto z = result.stability.eigenvalues[i];
    const double error = result.stability.eigenvalue_errors[i];
    job.say("  eigenvalue {} {} i 1/s", known(z.real(), error, 8), signed_known(z.imag(), error, 8));
  }
  Reached reached;
  for (const auto& path : paths) {
    const auto points = analysis::steady::hopf_points(model, path);
    for (const auto& point : points) {
      reached.add(point.value, point.value_error);
      job.say("Hopf point at {} = {}, {:.8g} rad/s, {}", path,
              justified(point.value, point.value_error, model.describe(path).unit), point.angular_frequency,
              name(point.criticality));
    }
    if (points.empty()) job.say("no Hopf point in {}", path);
    result.hopf.insert(result.hopf.end(), points.begin(), points.end());
  }
  job.manifest().tolerance_reached = reached.value();
  return job.finish(result_of(job, result));
}

}  // namespace

Verb stability_verb() {
  return {.name = "stability",
          .help = "steady sliding, its eigenvalues and Hopf points",
          .example = "rosin stability examples/bristol-board-cycle.toml --set law.lambda=30",
          .operands = {scene_operand},
          .needs = model_tables({{"stability", "further parameters for Hopf points, or a scan of one", true}}),
          .options = scene_options(),
          .tables = {{"stability", read_stability_table}},
          .read = read_stability,
          .perform = perform_stability};
}

}  // namespace rosin::app::verbs
