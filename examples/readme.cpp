/// The example of README.md: where does board start to squeal, and what motion follows?
#include <fmt/core.h>

#include <rosin/analysis/cycles/cycles.hpp>
#include <rosin/analysis/steady/steady.hpp>
#include <rosin/laws/catalogue.hpp>

int main() {
  using namespace rosin;
  const oscillators::Model slider{.law = laws::preset(*laws::find_law("spinodal"), "bristol-board"),
                                  .lambda = 10,
                                  .slider = {.mass = 1, .stiffness = 1.09},
                                  .drive = {.speed = 1e-5, .normal_load = 9.81e-4}};
  for (const auto& hopf : analysis::steady::hopf_points(slider, "drive.normal_load"))
    fmt::print("sliding vibrates above {:.9g} N ({})\n", hopf.value, name(hopf.criticality));
  const auto cycle = analysis::cycles::find_cycle(slider, {.tolerance = 1e-9});
  fmt::print("with a period of {:.9f} ± {:.0e} s\n", cycle.metrics.period, cycle.error.period);
}
