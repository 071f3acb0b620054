/// Samples of the work for a plane.
#include "analysis/planes/forecast.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/planes/map_point.hpp"

namespace rosin::analysis::planes {

Forecast::Forecast(const Model& model, const MapOptions& options, double tolerance,
                   const std::vector<std::string>& metrics, cycles::CoexistenceSearch& coexistence) {
  // So few that they do not matter themselves.
  const double points = double(options.x.values.size()) * double(options.y.values.size());
  const int side = int(std::clamp(std::sqrt(points) / 64, 4.0, 16.0));
  const auto place = [&](const Axis& axis, int k) { return int((2 * k + 1) * axis.values.size() / (2 * side)); };
  std::vector<Model> models;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) try {
        const int ix = place(options.x, i), iy = place(options.y, j);
        Model here =
            model.with(options.x.parameter, options.x.values[ix]).with(options.y.parameter, options.y.values[iy]);
        if (judge(here, coexistence) == PointVerdict::stable) continue;
        models.push_back(std::move(here));
        samples_.push_back({ix, iy, 0});
      } catch (const InputError&) {  // the plane itself will say it
      }
  const auto cycles = lanes::find_cycles(models, {tolerance, options.stick_threshold, metrics});
  for (std::size_t k = 0; k < cycles.size(); ++k) samples_[k].attempts = attempts_of(cycles[k]);
}

double Forecast::attempts_of(const lanes::LaneCycle& cycle) {
  constexpr double alone = 30'000;  // what a point by itself takes, in attempts of one lane
  return double(cycle.tries) + (cycle.found || cycle.dies_out ? 0 : alone);
}

double Forecast::attempts_at(int ix, int iy) const {
  if (samples_.empty()) return 1;
  const auto distance = [&](const Sample& s) { return std::hypot(s.ix - ix, s.iy - iy); };
  return std::ranges::min_element(samples_, {}, distance)->attempts;
}

}  // namespace rosin::analysis::planes
