/// The verb curve: the steady friction curve and its extrema.
#include "analysis/steady/curve.hpp"

#include <cmath>

#include "app/output/curve.hpp"
#include "app/output/pictures.hpp"
#include "app/scene/oscillator.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/curve.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/verb.hpp"

namespace rosin::app::verbs {

using nlohmann::ordered_json;

namespace {

void read_curve_table(scene::Table table, scene::SceneReader& reader) {
  auto& curve = reader.scene.task<tasks::Curve>();
  const Quantity speed{"", "m/s", {1e-15, 1e4}, "slip rate"};
  table.read("from", curve.from, speed);
  table.read("to", curve.to, speed);
  if (!(curve.from < curve.to))
    scene::fail(table.source(), "curve.from = {} must be below curve.to = {}", curve.from, curve.to);
  table.read("points", curve.points, 2, 1'000'000, "number of slip rates");
  if (!table.find("normal_load")) scene::KeysRead::note("drive.normal_load");
  table.read("normal_load", curve.normal_load, scene::mechanical("drive.normal_load"));
  table.finish();
}

void read_curve(scene::SceneReader& reader) {
  reader.law();
  {
    const scene::KeysRead only_checked;
    reader.oscillator_if_there();
  }
  if (!reader.root.find("curve")) scene::KeysRead::note("drive.normal_load");
  read_tables_of_models(reader);
  reader.note_unread({"law.lambda", "law.contact_stiffness", "law.load_memory"},
                     "a steady curve does not depend on it");
}

Status perform_curve(Job& job) {
  const auto& scene = job.scene();
  const auto& options = scene.task<tasks::Curve>();
  const auto& law = *scene.model.law;
  job.explain("steady curve of '{}' at {} slip rates from {} to {} m/s under {} N; no states, no integration",
              law.card().name, options.points, options.from, options.to, options.normal_load);
  output::Curve curve;
  curve.slip_rate.resize(static_cast<std::size_t>(options.points));
  for (int i = 0; i < options.points; ++i)
    curve.slip_rate[static_cast<std::size_t>(i)] =
        options.from * std::pow(options.to / options.from, double(i) / (options.points - 1));
  curve.slip_rate.back() = options.to;
  curve.friction_coefficient = analysis::steady::steady_curve(law, curve.slip_rate, options.normal_load);
  curve.extrema = analysis::steady::steady_extrema(law, options.from, options.to, options.normal_load);

  Reached reached;
  auto extrema = ordered_json::array();
  for (const auto& e : curve.extrema) {
    results::Object extremum;
    extremum["kind"] = e.maximum ? "maximum" : "minimum";
    extremum.add({"slip_rate", "m/s"}, e.slip_rate, e.slip_rate_error);
    extremum.add({"friction_coefficient"}, e.friction_coefficient);
    extrema.push_back(extremum.entry());
    reached.add(e.slip_rate, e.slip_rate_error);
    job.say("{} at {}, friction coefficient {:.10g}", e.maximum ? "maximum" : "minimum",
            justified(e.slip_rate, e.slip_rate_error, "m/s"), e.friction_coefficient);
  }
  if (curve.extrema.empty()) job.say("no extrema between {} and {} m/s", options.from, options.to);
  job.manifest().tolerance_reached = reached.value();
  auto result = job.result();
  result.add({"normal_load", "N"}, options.normal_load);
  result.add({"slip_rate", "m/s"}, curve.slip_rate);
  result.add({"friction_coefficient"}, curve.friction_coefficient);
  result["extrema"] = std::move(extrema);
  result.tables = {results::rows(
      "curve", {{{"slip_rate", "m/s"}, curve.slip_rate}, {{"friction_coefficient"}, curve.friction_coefficient}})};
  return job.finish(result, output::write_picture(job.folder(), scene, curve));
}

}  // namespace

Verb curve_verb() {
  return {.name = "curve",
          .help = "steady friction curve and its extrema",
          .example = "rosin curve examples/bristol-board-cycle.toml",
          .operands = {scene_operand},
          .needs = {{"law", "the friction law"}, {"curve", "slip rates and normal load", true}},
          .options = scene_options(),
          .tables = {{"curve", read_curve_table}},
          .read = read_curve,
          .perform = perform_curve};
}

}  // namespace rosin::app::verbs
