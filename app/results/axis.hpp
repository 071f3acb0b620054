/// Axes of planes and sweeps.
#pragma once
#include <string>

#include "app/results/result.hpp"

namespace rosin::analysis::planes {
struct Axis;
}

namespace rosin::app::results {

/// Parameter, unit, scale and values, as documents have them.
ordered_json axis(const analysis::planes::Axis&, const scene::Scene&);

/// The coordinate of a table along its dimension of that number. \param name  one of axis_names
Column coordinate(const std::string& name, std::size_t dimension, const analysis::planes::Axis&, const scene::Scene&);

/// Row by row: [iy][ix] of f(index of the point).
template <class Plane, class F>
ordered_json grid(const Plane& plane, F f) {
  auto table = ordered_json::array();
  const auto width = plane.x.values.size();
  for (std::size_t iy = 0; iy < plane.y.values.size(); ++iy) {
    auto row = ordered_json::array();
    for (std::size_t ix = 0; ix < width; ++ix) row.push_back(f(iy * width + ix));
    table.push_back(std::move(row));
  }
  return table;
}
/// The same of f(point).
template <class Map, class F>
ordered_json grid_of_points(const Map& map, F f) {
  return grid(map, [&](std::size_t i) { return f(map.points[i]); });
}

}  // namespace rosin::app::results
