/// The columns that EQcycle keeps of a cycle (t, v, u_abs, tau, tau of the load), as text that MATLAB's load reads.
#include <fmt/format.h>

#include "app/exports/series.hpp"

namespace rosin::app::exports {

namespace {

std::string text(const Series& series) {
  std::string out =
      "% 1=t (s), 2=v (m/s), 3=u_abs (m), 4=tau (Pa), 5=M*ac+tau (Pa), the load of the spring; all filled\n";
  for (std::size_t i = 0; i < series.time.size(); ++i)
    out += fmt::format("{:.16e} {:.16e} {:.16e} {:.16e} {:.16e}\n", series.time[i], series.slip_rate[i], series.slip(i),
                       series.friction_force[i] / series.area, series.stiffness * series.displacement[i] / series.area);
  return out;
}

}  // namespace

Format eqcycle_format() { return {"eqcycle", "columns of EQcycle's stored cycles, as text", text}; }

}  // namespace rosin::app::exports
