/// The verb compare for bowed strings: planes of transients side by side, and the strings that tell members apart.
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "analysis/planes/map.hpp"
#include "analysis/strings/strings.hpp"
#include "app/output/pictures.hpp"
#include "app/results/axis.hpp"
#include "app/scene/family.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/bowing.hpp"
#include "app/verbs/job.hpp"
#include "app/verbs/progress.hpp"
#include "app/verbs/string_verbs.hpp"

namespace rosin::app::verbs {

using analysis::strings::Pixel;
using nlohmann::ordered_json;

void read_string_comparison(scene::SceneReader& reader, scene::Table table) {
  auto& task = *reader.scene.string;
  table.expect({"members", "protocol"});
  const auto& members = table.required("members", "tables with a name and what each changes");
  for (const auto& element : scene::list(members, "compare.members", "tables", scene::most_names)) {
    scene::Table keys(element, "compare.members");
    keys.expect({"name", "law", "set"});
    tasks::Bowing::Member member{scene::text(keys.required("name", "of the member"), keys.path("name")), {}, {}};
    toml::table document = reader.document;
    if (const auto* law = keys.find("law")) document.insert_or_assign("law", *law);
    scene::Scene unused;
    scene::SceneReader with_law{reader.request, document, scene::Table(document, ""), unused, reader.folder, {}};
    member.family = scene::located(element.source(),
                                   [&] { return std::make_shared<scene::Family>(with_law, "compare.members", true); });
    if (const auto* set = keys.find("set")) {
      if (!set->is_table())
        scene::wrong_kind(*set, keys.path("set"), "a table of paths, such as { \"oscillator.bow_position\" = 0.06 }");
      for (const auto& [key, value] : *set->as_table()) {
        const std::string path(key.str());
        scene::located(value.source(), [&] {
          if (path == task.x.parameter || path == task.y.parameter)
            throw InputError(fmt::format("{} is an axis of the map and no difference between members", path));
          member.changed.emplace_back(path, scene::number(value, member.family->describe(path)));
        });
      }
    }
    keys.finish();
    for (const auto& other : task.members)
      if (other.name == member.name) scene::fail(element.source(), "compare.members: two are named '{}'", member.name);
    task.members.push_back(std::move(member));
  }
  if (task.members.size() < 2) scene::fail(table.source(), "compare.members needs two members or more");
  table.finish();
}

namespace {

/// Of each string, what the least different pair of members has between its transients (periods); NaN where one of the
/// transients hangs on the sample rate.
std::vector<double> separations(const std::vector<std::vector<Pixel>>& planes) {
  std::vector<double> least(planes.front().size(), INFINITY);
  for (std::size_t i = 0; i < least.size(); ++i)
    for (std::size_t a = 0; a < planes.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const auto &one = planes[a][i], &other = planes[b][i];
        const double apart = std::abs(one.bowing.transient.length - other.bowing.transient.length);
        least[i] = one.reproducible && other.reproducible ? std::min(least[i], apart) : NAN;
      }
  return least;
}

/// The string whose neighbours tell members apart as well, so that bow and force need not be met exactly: it has the
/// largest mean over itself and its neighbours, those that tell nothing counted as 0.
std::size_t best_of(const std::vector<double>& least, std::size_t width) {
  const std::size_t height = least.size() / width;
  std::size_t best = 0;
  double most = -1;
  for (std::size_t i = 0; i < least.size(); ++i) {
    if (!std::isfinite(least[i])) continue;
    const std::size_t x = i % width, y = i / width;
    double sum = 0;
    int count = 0;
    for (std::size_t b = y == 0 ? 0 : y - 1; b <= std::min(y + 1, height - 1); ++b)
      for (std::size_t a = x == 0 ? 0 : x - 1; a <= std::min(x + 1, width - 1); ++a, ++count)
        if (const double one = least[b * width + a]; std::isfinite(one)) sum += one;
    if (sum / count > most) most = sum / count, best = i;
  }
  return best;
}

/// Transients under each member, and how far the closest two lie apart.
results::Table table_of(const scene::Scene& scene, const std::vector<std::vector<Pixel>>& planes,
                        const std::vector<double>& separation) {
  const auto& task = *scene.string;
  const auto names = results::axis_names({task.y.parameter, task.x.parameter},
                                         {"member", "transient_length", "reproducible", "separation"});
  std::vector<std::string> members;
  for (const auto& member : task.members) members.push_back(member.name);
  std::vector<double> lengths;
  results::Flags reproducible{{}, {0, 1}, "no yes"};
  for (const auto& plane : planes)
    for (const auto& pixel : plane) {
      lengths.push_back(pixel.bowing.transient.length);
      reproducible.values.push_back(pixel.reproducible ? 1 : 0);
    }
  return {"compare",
          {{"member", planes.size()}, {names[0], task.y.values.size()}, {names[1], task.x.values.size()}},
          {{{"member", "", "member of the comparison"}, std::move(members)},
           results::coordinate(names[0], 1, task.y, scene),
           results::coordinate(names[1], 2, task.x, scene),
           {{"transient_length", "1", "transient, in periods"}, std::move(lengths), {}, {0, 1, 2}},
           {{"reproducible", "", "whether a small change keeps it"}, std::move(reproducible), {}, {0, 1, 2}},
           {{"separation", "1", "least difference of two transients, in periods"}, separation, {}, {1, 2}}}};
}

}  // namespace

Status perform_string_comparison(Job& job) {
  auto& scene = job.scene();
  auto& task = *scene.string;
  task.plane.threads = job.request().threads;
  const auto nx = task.x.values.size(), count = nx * task.y.values.size(), total = task.members.size();
  job.explain(
      "{} planes of {} strings; strings whose transient differs by more than {} periods at {} times the sample "
      "rate are left out of every difference",
      total, count, task.plane.within, fmt::join(task.plane.finer, " and "));
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::vector<Pixel>> planes;
  {
    Progress progress(job.request().quiet);
    for (const auto& member : task.members) {
      planes.push_back(bow_plane(strings_of_plane(task, *member.family, member.changed), task.plane));
      progress.show(planes.size(), total);
    }
  }
  const auto least = separations(planes);
  auto result = job.result();
  result["protocol"] = "map";
  result["x"] = results::axis(task.x, scene);
  result["y"] = results::axis(task.y, scene);
  auto members = ordered_json::array();
  struct Axes {
    analysis::planes::Axis x, y;
  } axes{task.x, task.y};
  for (std::size_t k = 0; k < total; ++k) {
    const auto found = statistics_of(planes[k], nx, task.good, task.options.transient.most);
    job.say("{:<20} {} of {} transients below {:g} periods, {} of them reproducible", task.members[k].name, found.good,
            count, task.good, found.good_and_reproducible);
    members.push_back(
        {{"name", task.members[k].name},
         {"good", found.good},
         {"good_and_reproducible", found.good_and_reproducible},
         {"reproducible", found.reproducible},
         {"transient_length", results::grid(axes, [&](std::size_t i) { return planes[k][i].bowing.transient.length; })},
         {"reproducible_at", results::grid(axes, [&](std::size_t i) { return planes[k][i].reproducible; })}});
  }
  result["members"] = std::move(members);
  auto& differences = result["differences"] = ordered_json::array();
  for (std::size_t b = 1; b < total; ++b)
    for (std::size_t a = 0; a < b; ++a) {
      const auto found = difference(planes[a], planes[b], task.good);
      job.say("{} and {}: of {} strings that are reproducible for both, {} are good for one alone",
              task.members[a].name, task.members[b].name, found.compared, found.differ);
      differences.push_back({{"between", {task.members[a].name, task.members[b].name}},
                             {"compared", found.compared},
                             {"differ", found.differ}});
    }
  result["separation"] = results::grid(axes, [&](std::size_t i) { return least[i]; });
  if (job.request().design) {
    const auto best = best_of(least, nx);
    const double x = task.x.values[best % nx], y = task.y.values[best / nx];
    const bool tells = std::isfinite(least[best]) && least[best] > 0;
    if (tells) {
      ordered_json lengths;
      std::string told;
      for (std::size_t k = 0; k < total; ++k) {
        const double length = planes[k][best].bowing.transient.length;
        lengths[task.members[k].name] = length;
        told += fmt::format("{}{} {}", k > 0 ? ", " : "", task.members[k].name,
                            length < task.options.transient.most
                                ? fmt::format("{:.3g}", length)
                                : fmt::format("none within {:g}", task.options.transient.most));
      }
      job.say("measure at {} = {:.6g}, {} = {:.6g}: transients of {} periods, {:.3g} apart or more", task.x.parameter,
              x, task.y.parameter, y, told, least[best]);
      result["best"] = {{"x", x}, {"y", y}, {"separation", least[best]}, {"transient_length", std::move(lengths)}};
    } else {
      job.say("no string of this plane tells all members apart reproducibly");
      result["best"] = nullptr;
    }
  }
  result.cost = {{"seconds", seconds_since(begin)}, {"points", count * total}};
  result.tables = {table_of(scene, planes, least)};
  job.manifest().cost = {{"seconds", seconds_since(begin)}, {"points", double(count * total)}};
  return job.finish(result, output::write_string_picture(job.folder(), scene, planes, least));
}

}  // namespace rosin::app::verbs
