/// `rosin bench plane`: the plane of Fig 2 of Woodhouse, Putelat & McKay (2015), whole, against point by point.
#include <algorithm>
#include <cmath>

#include "analysis/planes/map.hpp"
#include "bench/cycles.hpp"

namespace bench {
namespace {

using rosin::analysis::planes::Regime;

constexpr const char* whole_map = "rosin, whole map";

/// rosin's plane as a user asks for it, on one thread.
struct Plane {
  rosin::analysis::planes::Map map;
  double seconds = 0;
};
Plane compute_plane(int points, double tolerance) {
  Plane plane;
  rosin::analysis::planes::MapOptions options;
  options.x = rosin::analysis::planes::make_axis("drive.normal_load", 1e-8 * weight, weight, points, true, {});
  options.y = rosin::analysis::planes::make_axis("law.lambda", 1e-4, 1e2, points, true, {});
  options.metrics = {"stick_fraction", "loop_area"};
  options.tolerance = tolerance;
  options.threads = 1;
  const double begin = now();
  plane.map = rosin::analysis::planes::compute_map(bristol_board(weight, 1), options, {});
  plane.seconds = now() - begin;
  return plane;
}

bool has_cycle(const rosin::analysis::planes::MapPoint& p) {
  return p.regime == Regime::cycle || p.regime == Regime::bistable;
}
int count_cycles(const rosin::analysis::planes::Map& map) {
  return int(std::count_if(map.points.begin(), map.points.end(), has_cycle));
}

}  // namespace

Record bench_plane(const Settings& settings, const SciPy& scipy, const std::filesystem::path& curves) {
  Record record;
  // Seventeen is prime to what a map divides its grid by, so that the subset has no part of it more often than the
  // rest.
  const int points = settings.quick ? 8 : 48, stride = 17;
  const auto findings = [&](std::string text) { record.findings.push_back(std::move(text)); };

  // Which points have a cycle; the subset that rivals compute, evenly spread; the truth there.
  progress(settings, fmt::format("survey of {0} x {0} points", points));
  const auto survey = compute_plane(points, 1e-3).map;
  const int cycles_in_plane = count_cycles(survey);
  std::vector<Truth> cycles;
  std::vector<std::size_t> index;
  int stable = 0, unchecked = 0, beyond = 0;
  double largest = 0;
  Stage references(settings, "reference values, point by point", survey.points.size() / stride);
  for (std::size_t i = stride / 2; i < survey.points.size(); i += stride) {
    references.done(i / stride);
    const double N = survey.x.values[i % points], lambda = survey.y.values[i / points];
    if (survey.points[i].regime == Regime::failed)
      findings(fmt::format("no regime at N = {:.4g}, lambda = {:.4g}: {}", N, lambda, survey.points[i].why));
    if (!has_cycle(survey.points[i])) {
      ++stable;
      continue;
    }
    const Truth truth = truth_of(N, lambda, settings.quick ? 1e-9 : 1e-11);
    cycles.push_back(truth);
    index.push_back(i);
    const double tight = settings.quick ? 1e-10 : 1e-12;
    Check other;
    std::string why;
    if (!check(truth, tight, other, why)) {
      ++unchecked;
      continue;
    }
    const Errors stated = {truth.error.period / truth.value.period, truth.error.stick_fraction,
                           truth.error.loop_area / truth.loop_size};
    bool agree = true;
    for (int k = 0; k < 3; ++k) {
      agree = agree && other.between[k] <= stated[k] + 3 * other.noise[k] + 1e3 * tight;
      largest = std::max(largest, other.between[k]);
    }
    if (!agree) {
      ++beyond;
      findings(fmt::format("N = {:.4g}, lambda = {:.4g}: rosin and CVODE differ by {:.1e}", N, lambda,
                           fmt::join(other.between, ", ")));
    }
  }
  say(settings,
      "Plane: {0} x {0} points, N = 9.81e-8 ... 9.81 N, lambda = 1e-4 ... 1e2; {1} with a cycle. Rivals compute {2} of "
      "them, evenly spread (every {3}th point, row by row), and their time is scaled to all.\nThe {4} stable points of "
      "the "
      "subset and of the plane are not charged to them: the user of a rival computes the threshold in closed form.\n"
      "Reference against CVODE at its tightest: largest disagreement {5:.1e}; {6} beyond the stated errors, {7} not "
      "checked because CVODE fails\n",
      points, cycles_in_plane, cycles.size(), stride, stable, largest, beyond, unchecked);

  // rosin's map as a whole; its time is shared out over the cycles, so that rows compare.
  std::vector<Row> rows;
  std::vector<std::string> outside;
  double at_1e6 = 0;
  for (const double tolerance : tolerances(settings, 3, settings.quick ? 6 : 9)) {
    progress(settings, fmt::format("{}, {:.0e}", whole_map, tolerance));
    Plane plane;
    rows.push_back(measure(
        whole_map, 1, tolerance, settings, [&](int, double t) { plane = compute_plane(points, t); }, [](int, Row&) {}));
    Row& row = rows.back();
    if (std::abs(tolerance / 1e-6 - 1) < 1e-9) at_1e6 = row.seconds;
    row.asked = row.tried = int(cycles.size());
    row.note = fmt::format("whole plane {:.3g} s", row.seconds);
    row.seconds *= double(cycles.size()) / std::max(1, cycles_in_plane);
    for (std::size_t i = 0; i < cycles.size(); ++i) {
      const auto& point = plane.map.points[index[i]];
      Reading reading;
      reading.period = point.metrics.period;
      reading.stick_fraction = point.metrics.stick_fraction;
      reading.loop_area = point.metrics.loop_area;
      if (!has_cycle(point)) reading.failure = "no cycle found: " + point.why;
      take(row, reading, cycles[i]);
      if (!has_cycle(point)) continue;
      const Truth& t = cycles[i];
      const Errors e = errors_of(reading, t);
      const bool is_outside = e[1] > point.error.stick_fraction + t.error.stick_fraction ||
                              e[2] > (point.error.loop_area + t.error.loop_area) / t.loop_size;
      row.understated += is_outside;
      if (is_outside)
        outside.push_back(fmt::format("{:.0e}: N = {:.4g}, lambda = {:.4g}: true {:.1e}", tolerance, t.N, t.lambda,
                                      fmt::join(e, " ")));
    }
    keep(settings, {row});
  }
  for (const auto& solver : rosin_solvers()) {
    const auto more = sweep(solver, cycles, tolerances(settings, 3, settings.quick ? 3 : 10), settings);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  for (const auto& solver : rivals()) {
    const auto more = sweep(solver, cycles, tolerances(settings, 3, settings.quick ? 6 : 11), settings);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  if (!settings.quick)
    for (const char* method : {"Radau", "LSODA"}) {
      const auto more = sweep_scipy(scipy, method, cycles, tolerances(settings, 3, 10), 1);
      rows.insert(rows.end(), more.begin(), more.end());
    }
  print(settings, rows, cycle_quantities);
  record.content = {{"points", points * points},
                    {"cycles", cycles_in_plane},
                    {"subset", cycles.size()},
                    {"reference", {{"largest_disagreement", largest}, {"beyond", beyond}, {"unchecked", unchecked}}},
                    {"rows", as_json(rows, cycle_quantities)},
                    {"outside_stated_error", outside}};
  record.content["time_to_reach"] = times_to_reach(settings, rows, "Plane, each cycle");
  record.content["ratios"] = ratios(settings, rows, whole_map, 1e-6, "Plane");
  if (at_1e6 > 0) {
    say(settings, "\n{0} x {0} planes a second at tolerance 1e-6, one thread: {1:.3g}\n", points, 1 / at_1e6);
    record.content["planes_a_second"] = 1 / at_1e6;
  }
  for (const auto& point : outside) say(settings, "outside the stated error (period, stick, loop), {}\n", point);

  // A picture: 400 × 400 points to 1e-3, against CVODE computing every pixel that has a cycle.
  const int pixels = settings.quick ? 10 : 400;
  const double expected = rows.front().seconds * cycles_in_plane / std::max<double>(1, double(cycles.size())) * pixels *
                          pixels / (points * points);
  if (expected > 2 * settings.limit) {
    say(settings, "{0} x {0} points at 1e-3: left out, it would take {1:.0f} s or less\n", pixels, expected);
    record.content["picture"] = {{"pixels", pixels * pixels}, {"left_out", expected}};
  } else {
    progress(settings, fmt::format("{0} x {0} pixels", pixels));
    Plane picture = compute_plane(pixels, 1e-3);
    for (int again = 0; again < 2; ++again) {  // the least of three, as of all that takes so little time
      const double seconds = compute_plane(pixels, 1e-3).seconds;
      picture.seconds = std::min(picture.seconds, seconds);
    }
    const int with_cycle = count_cycles(picture.map);
    say(settings, "{0} x {0} points at 1e-3: {1:.3g} s; {2} with a cycle\n", pixels, picture.seconds, with_cycle);
    record.content["picture"] = {{"pixels", pixels * pixels}, {"seconds", picture.seconds}, {"cycles", with_cycle}};
    for (const char* rival : {"CVODE", "CVODE, accelerated", "odeint, good variables, accelerated"})
      if (const auto at = time_at(rows, rival, 1e-3); *at.relation != '>') {
        const double ratio = 1e-6 * at.microseconds * with_cycle / picture.seconds;
        say(settings, "  {:<34} computing every pixel to 1e-3: {} {:.3g} times as long (scaled)\n", rival, at.relation,
            ratio);
        record.content["picture"]["ratios"].push_back({{"solver", rival}, {"relation", at.relation}, {"ratio", ratio}});
      }
  }
  record.content["lane_steps"] = lane_steps(settings);
  write_curves(curves, rows);
  record.panels = {{curves, "Plane: N/(m g) = 10^{−8} … 1, λ = 10^{−4} … 10^2",
                    "largest true error of period, stick fraction, loop area, met by nine cycles in ten",
                    "processor time per cycle (s)"}};
  return record;
}

}  // namespace bench
