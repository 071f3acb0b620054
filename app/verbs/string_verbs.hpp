/// The verbs for bowed strings.
#pragma once
#include "analysis/planes/sweep.hpp"
#include "app/scene/reader.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/bowing.hpp"
#include "app/verbs/verb.hpp"
#include "oscillators/bowed_string.hpp"

namespace rosin::app::verbs {

/// An axis of a plane: parameter, from, to, points, scale, extra. Defined beside the verb map.
analysis::planes::Axis read_axis(scene::Table, const scene::Scene&);

struct StringColumn {
  std::string name, unit;
  const std::vector<double>* values;
};
/// Of the record, which must outlive them.
std::vector<StringColumn> columns_of(const analysis::strings::StringRecord&, const tasks::Bowing&);

/// The motion of a string, and its numbers with their errors.
struct StringMetric {
  const char *name, *unit, *meaning;
  double value, error;
};
struct StringRun {
  analysis::strings::StringRecord record;
  std::vector<StringMetric> metrics;
};
StringRun run_of(const tasks::Bowing&);

Status perform_string_run(Job&);
Status perform_string_stability(Job&);
Status perform_string_cycle(Job&);
/// Along [sweep], each from the start of [cycle].
analysis::planes::Sweep sweep_of_strings(Job&);
/// [map] of a scene whose oscillator is a string, with what [run] and [transient] say.
void read_string_map(scene::SceneReader&, scene::Table map);
Status perform_string_map(Job&);
/// The strings of the plane in rows of x, with other numbers beside those of the axes; they start as the scene's does.
std::vector<oscillators::BowedStringModel> strings_of_plane(const tasks::Bowing&, const scene::Family&,
                                                            const std::vector<std::pair<std::string, double>>& changed);
/// [compare] of such a scene: members, each with a law of its own or other numbers.
void read_string_comparison(scene::SceneReader&, scene::Table compare);
Status perform_string_comparison(Job&);

}  // namespace rosin::app::verbs
