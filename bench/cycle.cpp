/// `rosin bench cycle`: Fig 1 of Woodhouse, Putelat & McKay (2015).
#include <cmath>

#include "bench/cycles.hpp"

namespace bench {

Record bench_cycle(const Settings& settings, const SciPy& scipy, const std::filesystem::path& curves) {
  Record record;
  if (const double defect = jacobian_defect(); defect > 1e-5)
    record.findings.push_back(fmt::format("the rivals' Jacobians differ from differences by {:.1e}", defect));
  const Truth one = truth_of(1e-4 * weight, 10, 1e-12);
  constexpr double published = 22.58705579716;  // independent shooting, all digits sure
  if (std::abs(one.value.period - published) > 1e-11 + one.error.period)
    record.findings.push_back(fmt::format("period {:.14g} s is not {:.14g} s", one.value.period, published));
  say(settings, "One cycle: N = 1e-4 m g, lambda = 10; period {:.13g} s (independent: {:.13g})\n", one.value.period,
      published);
  std::vector<Row> rows;
  const auto append = [&](std::vector<Row> more) { rows.insert(rows.end(), more.begin(), more.end()); };
  const auto list = tolerances(settings, 3, settings.quick ? 6 : 11);
  for (const auto& solver : rosin_solvers()) append(sweep(solver, {one}, list, settings));
  for (const auto& solver : rivals()) append(sweep(solver, {one}, list, settings));
  for (const char* method : {"Radau", "LSODA"})
    append(sweep_scipy(scipy, method, {one}, tolerances(settings, 3, settings.quick ? 3 : 11), settings.quick ? 1 : 3));
  print(settings, rows, cycle_quantities);
  record.content = {{"reference_period", one.value.period},
                    {"independent_period", published},
                    {"rows", as_json(rows, cycle_quantities)}};
  record.content["time_to_reach"] = times_to_reach(settings, rows, "One cycle");
  record.content["ratios"] = ratios(settings, rows, "rosin", 1e-6, "One cycle");
  write_curves(curves, rows);
  record.panels = {{curves, "One cycle: N = 10^{−4} m g, λ = 10",
                    "largest true error of period, stick fraction, loop area (relative)", "processor time (s)"}};
  return record;
}

}  // namespace bench
