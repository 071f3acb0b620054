/// The picture of curves in two parameters: Hopf points, folds, period doublings, tori and grazing.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "analysis/branches/branches.hpp"
#include "app/output/caption.hpp"
#include "app/output/files.hpp"
#include "app/output/gnuplot.hpp"
#include "app/output/pictures.hpp"
#include "app/output/sheet.hpp"
#include "app/scene/scene.hpp"
#include "app/tasks/branch.hpp"

namespace rosin::app::output {

namespace {

/// 1, 2 and 5 of each decade, for logarithmic axes on which few decades lie.
std::string few_ticks(char axis, double low, double high) {
  std::vector<std::string> ticks;
  for (double decade = std::pow(10, std::floor(std::log10(low))); decade <= high; decade *= 10)
    for (const double part : {1.0, 2.0, 5.0})
      if (const double at = part * decade; at >= low && at <= high) ticks.push_back(fmt::format("{:.3g}", at));
  return fmt::format("set {0}tics ({1})\nset format {0} '%g'\n", axis, fmt::join(ticks, ", "));
}

}  // namespace

std::vector<std::string> write_picture(const std::filesystem::path& folder, const scene::Scene& scene,
                                       const analysis::branches::Loci& loci) {
  const auto& task = scene.task<tasks::Branch>();
  const auto& locus = *task.locus;
  const Sheet sheet{"locus",
                    "Where steady sliding and cycles change, in two parameters",
                    {.panel = 400},
                    scene.title,
                    caption(scene, {task.parameter.name, locus.parameter.name})};
  std::string script = "set grid\n";
  for (const auto& [axis, parameter, range] :
       {std::tuple{'x', &task.parameter, &locus.options.p}, {'y', &locus.parameter, &locus.options.q}}) {
    const auto [low, high] = std::minmax(range->from, range->to);
    script += axis_scale(axis, range->logarithmic) + '\n';
    script += fmt::format("set {0}range [{1}:{2}]\nset {0}label {3}\n", axis, low, high,
                          axis_label(axis, parameter->name, parameter->meaning, parameter->unit));
    if (range->logarithmic && !spans_decades(low, high)) script += few_ticks(axis, low, high);
  }
  std::vector<std::string> curves;
  std::vector<std::string> titled;
  for (std::size_t k = 0; k < loci.curves.size(); ++k) {
    const auto& kind = loci.curves[k].kind;
    const bool again = std::ranges::find(titled, kind) != titled.end();
    struct Look {
      const char *kind, *title, *line;
    };
    static constexpr Look looks[] = {{"hopf", "Hopf points of sliding", "linestyle 1"},
                                     {"fold", "folds of cycles", "linestyle 2"},
                                     {"period-doubling", "period doublings", "linestyle 4"},
                                     {"torus", "tori", "linestyle 5"},
                                     {"grazing", "grazing", "linestyle 2 dashtype (2,2)"}};
    const auto& [named, title, line] =
        *std::ranges::find_if(looks, [&](const Look& look) { return look.kind == kind; });
    curves.push_back(fmt::format("'locus.csv' using ($1=={}?$2:NaN):4 with lines {} {}", k, line,
                                 again ? "notitle" : fmt::format("title '{}'", title)));
    titled.push_back(kind);
  }
  curves.push_back(fmt::format("{} with lines linestyle 3 title 'the scene'", locus.value));
  script += fmt::format("plot {}\n", fmt::join(curves, ", \\\n     "));
  write_whole(folder / "locus.gp", sheet.with(std::move(script)));
  return {"locus.gp"};
}

}  // namespace rosin::app::output
