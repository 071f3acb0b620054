/// The names of rsfmodel's results, in its units: um, s and coefficients of friction. rsfmodel itself writes no file.
#include <fmt/format.h>

#include "app/exports/series.hpp"

namespace rosin::app::exports {

namespace {

std::string text(const Series& series) {
  constexpr double um = 1e-6;
  std::string out = "time,loadpoint_displacement,slider_velocity,friction,slider_displacement";
  for (std::size_t k = 0; k < series.states.size(); ++k) out += fmt::format(",state{}", k + 1);
  out += '\n';
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    out += fmt::format("{},{},{},{},{}", series.time[i], series.load_displacement[i] / um, series.slip_rate[i] / um,
                       series.friction_coefficient[i], series.slip(i) / um);
    for (const auto& state : series.states) out += fmt::format(",{}", state.values[i]);
    out += '\n';
  }
  return out;
}

}  // namespace

Format rsfmodel_format() { return {"rsfmodel", "results of rsfmodel by name, in um and s", text}; }

}  // namespace rosin::app::exports
