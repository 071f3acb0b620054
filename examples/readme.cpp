/// The example of README.md: which motion does a slider on board come to?
#include <fmt/core.h>

#include <rosin/analysis/cycles/cycles.hpp>
#include <rosin/laws/catalogue.hpp>

int main() {
  using namespace rosin;
  const auto board = laws::preset(*laws::find_law("spinodal"), "bristol-board");
  const auto cycle = analysis::cycles::find_cycle(
      {.law = board, .lambda = 10, .slider = {1, 1.09}, .drive = {.speed = 1e-5, .normal_load = 9.81e-4}});
  fmt::print("it sticks and slips with a period of {:.8f} ± {:.0e} s\n", cycle.metrics.period, cycle.error.period);
}
