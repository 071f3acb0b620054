/// `rosin bench sections`: a bifurcation diagram of a forced belt, and a plane of its largest Lyapunov exponent, beside
/// CVODE from event to event.
#include <cmath>
#include <numbers>

#include "analysis/lanes/driven_lanes.hpp"
#include "analysis/planes/structure_map.hpp"
#include "analysis/planes/sweep.hpp"
#include "bench/rows.hpp"
#include "bench/section_rivals.hpp"
#include "laws/catalogue.hpp"

namespace bench {
namespace {

using namespace rosin;
using namespace rosin::analysis;

constexpr double slowest = 0.02, fastest = 1.2;  // m/s

motion::StructureModel belt(double speed, double amplitude = 0.5) {
  oscillators::Model model;
  model.law = laws::find_law("hyperbolic")->with({1.0, 3.0});
  model.slider = {1, 1, 0};
  model.drive.speed = speed, model.drive.normal_load = 1.0;
  model.drive.force = Signal(Signal::Harmonics{0, {{amplitude, 2, 0}}});
  motion::StructureModel structure{oscillators::one_slider(model), {}};
  structure.start.kind = motion::Start::Kind::rest;
  return structure;
}

planes::Sweep diagram(int values, int transient, int keep, double tolerance) {
  planes::SweepOptions options;
  options.axis = planes::make_axis("drive.speed", slowest, fastest, values, false, {});
  options.anew = true;
  options.transient = transient, options.keep = keep, options.tolerance = tolerance;
  return planes::sweep([](double speed) { return belt(speed); }, options);
}

json bench_diagram(const Settings& settings, std::vector<Row>& rows) {
  const int values = settings.quick ? 100 : 2000, every = settings.quick ? 20 : 50;
  const int transient = settings.quick ? 20 : 200, kept = settings.quick ? 20 : 200;
  constexpr int judged = 8;  // periods, before irregular motions part
  progress(settings, "diagram: reference");
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
  for (const double tolerance : tolerances(settings, 4, settings.quick ? 7 : 11)) {
    progress(settings, fmt::format("diagram: rosin, {} values, {:.0e}", values, tolerance));
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
  json content = {{"values", values}, {"returns", transient + kept}, {"rows", as_json(rows, quantities)}};
  content["time_to_reach"] = times_to_reach(settings, rows, "One value of the diagram");
  content["ratios"] = ratios(settings, rows, "rosin", settings.quick ? 1e-7 : 1e-8, "One value of the diagram");
  return content;
}

/// Points of the plane of belt speed and amplitude of the force.
struct Plane {
  std::vector<double> speeds, amplitudes;
  std::size_t size() const { return speeds.size() * amplitudes.size(); }
  double speed(std::size_t i) const { return speeds[i % speeds.size()]; }
  double amplitude(std::size_t i) const { return amplitudes[i / speeds.size()]; }
};

/// Growth of a disturbance in the first periods, a logarithm for each point.
std::vector<double> first_growth(const Plane& plane, int periods, double tolerance) {
  std::vector<lanes::DrivenMotion> motions(plane.size());
  for (std::size_t i = 0; i < plane.size(); ++i) {
    motions[i].block = *lanes::DrivenBlock::of(belt(plane.speed(i), plane.amplitude(i)).structure);
    motions[i].keep = periods, motions[i].tolerance = 0.1 * tolerance;
  }
  lanes::DrivenLanes(motions.front().block, true).run(motions);
  std::vector<double> growth(plane.size(), NAN);
  for (std::size_t i = 0; i < plane.size(); ++i)
    if (motions[i].why.empty()) {
      growth[i] = 0;
      for (const auto& at : motions[i].growth) growth[i] += at.logarithm;
    }
  return growth;
}

json bench_exponents(const Settings& settings, std::vector<Row>& rows) {
  const int side = settings.quick ? 10 : 200, every = settings.quick ? 20 : 1001;
  const int transient = settings.quick ? 20 : 100, kept = settings.quick ? 40 : 200;
  constexpr int judged = 8;
  planes::MapOptions options;
  options.x = planes::make_axis("drive.speed", 0.05, 0.6, side, false, {});
  options.y = planes::make_axis("drive.force.amplitude", 0.2, 0.8, side, false, {});
  const double period = std::numbers::pi;
  options.lyapunov.duration = kept * period, options.lyapunov.transient = transient * period;
  const Plane plane{options.x.values, options.y.values};
  const auto metrics = planes::metrics_of_structure(belt(0.1).structure, {"lyapunov"});
  progress(settings, "exponents: reference");
  const auto truth = first_growth(plane, judged, 1e-13);
  const auto error_of = [&](std::size_t i, double growth) { return std::abs(growth - truth[i]) / (judged * period); };
  for (const double tolerance : settings.quick ? std::vector{1e-4, 1e-7} : std::vector{1e-4, 1e-6, 1e-8, 1e-10}) {
    progress(settings, fmt::format("exponents: rosin, {} points, {:.0e}", plane.size(), tolerance));
    options.tolerance = tolerance;
    Row row{"rosin", tolerance};
    row.asked = row.tried = int(plane.size());
    const double begin = now();
    const auto map = planes::compute_structure_map(belt, options, metrics);
    row.seconds = now() - begin;
    for (const auto& point : map.points)
      if (point.regime == planes::Regime::failed) ++row.failures["not followed"];
    const auto growth = first_growth(plane, judged, tolerance);
    for (std::size_t i = 0; i < plane.size(); ++i) row.errors.push_back({error_of(i, growth[i])});
    rows.push_back(std::move(row));
  }
  keep(settings, rows);
  std::vector<std::size_t> asked;
  for (std::size_t i = std::size_t(every) / 2; i < plane.size(); i += std::size_t(every)) asked.push_back(i);
  std::vector<SectionPoints> found(asked.size());
  const auto follow = [&](std::size_t i, int periods, double tolerance) {
    return follow_belt_by_cvode({.speed = plane.speed(i), .amplitude = plane.amplitude(i)}, periods, tolerance, true);
  };
  for (auto& row : sweep(
           "CVODE Adams", int(asked.size()), tolerances(settings, 6, settings.quick ? 9 : 12), settings,
           [&](int i, double tolerance) {
             found[std::size_t(i)] = follow(asked[std::size_t(i)], transient + kept, tolerance);
           },
           [&](int i, Row&row) {
             const std::size_t at = asked[std::size_t(i)];
             if (!found[std::size_t(i)].failure.empty())
               ++row.failures[found[std::size_t(i)].failure];
             else
               row.errors.push_back({error_of(at, follow(at, judged, row.tolerance).growth)});
           }))
    rows.push_back(std::move(row));
  const std::vector<std::string> quantities = {"exponent of eight periods"};
  print(settings, rows, quantities);
  json content = {{"points", plane.size()}, {"returns", transient + kept}, {"rows", as_json(rows, quantities)}};
  content["time_to_reach"] = times_to_reach(settings, rows, "One point of the plane");
  content["ratios"] = ratios(settings, rows, "rosin", settings.quick ? 1e-7 : 1e-8, "One point of the plane");
  return content;
}

}  // namespace

Record bench_sections(const Settings& settings, const SciPy&, const std::filesystem::path& curves) {
  Record record;
  std::vector<Row> diagram_rows, exponent_rows;
  record.content["diagram"] = bench_diagram(settings, diagram_rows);
  record.content["exponents"] = bench_exponents(settings, exponent_rows);
  auto second = curves;
  second.replace_extension(".exponents.dat");
  write_curves(curves, diagram_rows), write_curves(second, exponent_rows);
  record.panels = {
      {curves, "Bifurcation diagram of a forced belt, 2000 speeds",
       "true error of eight section points, met by nine values in ten", "processor time per value (s)"},
      {second, "Its largest Lyapunov exponent, 200 × 200 points",
       "true error of the exponent of eight periods (1/s), met by nine points in ten", "processor time per point (s)"}};
  return record;
}

}  // namespace bench
