/// Axes as documents and tables have them.
#include "app/results/axis.hpp"

#include "analysis/planes/map.hpp"
#include "app/scene/scene.hpp"

namespace rosin::app::results {

ordered_json axis(const analysis::planes::Axis& axis, const scene::Scene& scene) {
  return {{"parameter", axis.parameter},
          {"unit", scene.describe(axis.parameter).unit},
          {"scale", axis.logarithmic ? "log" : "linear"},
          {"values", axis.values}};
}

Column coordinate(const std::string& name, std::size_t dimension, const analysis::planes::Axis& axis,
                  const scene::Scene& scene) {
  const auto quantity = scene.describe(axis.parameter);
  return {{name, quantity.unit, quantity.meaning},
          axis.values,
          {},
          {dimension},
          {{"path", axis.parameter},
           {"scale", axis.logarithmic ? "log" : "linear"},
           {"regular_values", int(axis.regular)}}};  // the ones behind them stand outside the scale
}

}  // namespace rosin::app::results
