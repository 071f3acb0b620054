/// The picture of curves in two parameters: Hopf points, folds, period doublings, tori and grazing.
#include <algorithm>
#include <tuple>

#include "analysis/branches/branches.hpp"
#include "app/output/figure.hpp"
#include "app/output/pictures.hpp"
#include "app/output/scene_figure.hpp"
#include "app/tasks/branch.hpp"

namespace rosin::app::output {

using namespace results;

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::branches::Loci& loci) {
  const auto& task = scene.task<tasks::Branch>();
  const auto& locus = *task.locus;
  const auto axis = [](const Quantity& parameter, const analysis::branches::ParameterScale& range) {
    auto axis = axis_of(parameter.name, parameter, range.logarithmic);
    std::tie(axis.from, axis.to) = std::minmax(range.from, range.to);
    return axis;
  };
  Panel panel{.x = axis(task.parameter, locus.options.p), .y = axis(locus.parameter, locus.options.q)};
  for (std::size_t k = 0; k < loci.curves.size(); ++k) {
    struct Kind {
      const char *name, *title;
      Look look;
    };
    static const Kind kinds[] = {{"hopf", "Hopf points of sliding", {.style = 0}},
                                 {"fold", "folds of cycles", {.style = 1}},
                                 {"period-doubling", "period doublings", {.style = 2}},
                                 {"torus", "tori", {.style = 3}},
                                 {"grazing", "grazing", {.style = 1, .dash = "2,2"}}};
    const auto& [name, title, look] = *std::ranges::find(kinds, loci.curves[k].kind, &Kind::name);
    panel.lines.push_back(
        {.table = "locus.csv", .x = {2}, .y = {4}, .look = look, .title = title, .where = {{1, '=', double(k)}}});
    for (const auto& [event, at] : loci.curves[k].events)
      panel.marks.push_back({at.p, at.q, tasks::label_of(event), Side::right, {.style = reference_style}});
  }
  panel.rules = {{'y', locus.value, {.style = reference_style}, "the scene"}};
  auto figure = figure_of(scene, "locus", "Where steady sliding and cycles change, in two parameters",
                          {task.parameter.name, locus.parameter.name});
  figure.panels = {std::move(panel)};
  return write(folder, figure);
}

}  // namespace rosin::app::output
