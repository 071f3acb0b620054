/// `rosin bench sections`: a bifurcation diagram of a forced belt beside CVODE from event to event.
#include <cmath>

#include "analysis/planes/sweep.hpp"
#include "bench/rows.hpp"
#include "bench/section_rivals.hpp"
#include "laws/catalogue.hpp"

namespace bench {
namespace {

using namespace rosin;
using namespace rosin::analysis;

constexpr double slowest = 0.02, fastest = 1.2;  // m/s

motion::StructureModel belt(double speed) {
  oscillators::Model model;
  model.law = laws::find_law("hyperbolic")->with({1.0, 3.0});
  model.slider = {1, 1, 0};
  model.drive.speed = speed, model.drive.normal_load = 1.0;
  model.drive.force = Signal(Signal::Harmonics{0, {{0.5, 2, 0}}});
  motion::StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = motion::Start::Kind::rest;
  return structure;
}

planes::Sweep diagram(int values, int transient, int keep, double tolerance) {
  planes::SweepOptions options;
  options.axis = planes::make_axis("drive.speed", slowest, fastest, values, false, {});
  options.anew = true;
  options.transient = transient, options.keep = keep, options.tolerance = tolerance;
  return planes::sweep(belt, options);
}

}  // namespace

Record bench_sections(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  const int values = settings.quick ? 100 : 2000, every = settings.quick ? 20 : 50;
  const int transient = settings.quick ? 20 : 200, kept = settings.quick ? 20 : 200;
  constexpr int judged = 8;  // periods, before irregular motions part
  Record record;
  progress(settings, "reference");
  const auto truth = diagram(values, 0, judged, 1e-13);
  const auto speeds = planes::make_axis("drive.speed", slowest, fastest, values, false, {}).values;
  std::vector<int> asked;
  for (int i = every / 2; i < values; i += every) asked.push_back(i);
  const auto error_of = [&](int value, const std::vector<double>& x) {
    double worst = 0;
    for (int n = 0; n < judged; ++n)
      worst = std::max(worst, std::abs(x[std::size_t(n)] - truth.up[std::size_t(value)].columns[0][std::size_t(n)]));
    return worst;
  };
  std::vector<Row> rows;
  for (const double tolerance : tolerances(settings, 4, settings.quick ? 7 : 11)) {
    progress(settings, fmt::format("rosin, {} values, {:.0e}", values, tolerance));
    Row row{"rosin", tolerance};
    row.asked = row.tried = values;
    row.seconds = INFINITY;
    for (int repetition = 0; repetition < (settings.quick ? 1 : 3); ++repetition) {
      const double begin = now();
      const auto all = diagram(values, transient, kept, tolerance);
      row.seconds = std::min(row.seconds, now() - begin);
      for (const auto& point : all.up) row.failures["not followed"] += repetition == 0 && !point.why.empty();
    }
    std::erase_if(row.failures, [](const auto& failure) { return failure.second == 0; });
    const auto begun = diagram(values, 0, judged, tolerance);
    for (int i = 0; i < values; ++i) row.errors.push_back({error_of(i, begun.up[std::size_t(i)].columns[0])});
    rows.push_back(std::move(row));
  }
  keep(settings, rows);

  // CVODE follows a subset of the values, evenly spread.
  std::vector<SectionPoints> found(asked.size());
  const auto solve = [&](int i, double tolerance) {
    found[std::size_t(i)] =
        follow_belt_by_cvode({.speed = speeds[std::size_t(asked[std::size_t(i)])]}, transient + kept, tolerance, false);
  };
  for (auto& row : sweep("CVODE Adams", int(asked.size()), tolerances(settings, 4, settings.quick ? 7 : 12), settings,
                         solve, [&](int i, Row&row) {
                           const auto& points = found[std::size_t(i)];
                           if (points.failure.empty())
                             row.errors.push_back({error_of(asked[std::size_t(i)], points.x)});
                           else
                             ++row.failures[points.failure];
                         }))
    rows.push_back(std::move(row));
  const std::vector<std::string> quantities = {"section points"};
  print(settings, rows, quantities);
  record.content = {{"values", values}, {"returns", transient + kept}, {"rows", as_json(rows, quantities)}};
  record.content["time_to_reach"] = times_to_reach(settings, rows, "One value of the diagram");
  record.content["ratios"] = ratios(settings, rows, "rosin", settings.quick ? 1e-7 : 1e-8, "One value of the diagram");
  write_curves(curves, rows);
  record.panels = {{curves, fmt::format("Bifurcation diagram of a forced belt, {} section points of each value", kept),
                    "largest true error of the first eight section points, met by nine values in ten",
                    "processor time per value (s)"}};
  return record;
}

}  // namespace bench
