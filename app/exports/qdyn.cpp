/// The columns of QDYN's output_ot_0, as its wrapper reads them: potency needs the size of a fault, which a slider has
/// not.
#include <fmt/format.h>

#include <limits>

#include "app/exports/series.hpp"

namespace rosin::app::exports {

namespace {

std::string text(const Series& series) {
  std::string out =
      "# macroscopic values:\n"
      "# 1=t, 2=pot (not filled), 3=pot_rate (not filled)\n"
      "# values at selected point:\n";
  out += fmt::format("# 4=V, 5=theta{}, 6=tau, 7=dtau_dt, 8=slip, 9=sigma\n",
                     series.states.empty() ? " (not filled)" : "");
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    out += fmt::format("{:>24.14E}", series.time[i]);
    const double theta = series.states.empty() ? none : series.states.front().values[i];
    // tau is the contact's, dtau_dt that of the spring, K (V_PL - V)
    for (const double value :
         {none, none, series.slip_rate[i], theta, series.friction_force[i] / series.area,
          series.stiffness * series.velocity[i] / series.area, series.slip(i), series.normal_load[i] / series.area})
      out += fmt::format("{:>24.14E}", value);
    out += '\n';
  }
  return out;
}

}  // namespace

Format qdyn_format() { return {"qdyn", "columns of QDYN's output_ot", text}; }

}  // namespace rosin::app::exports
