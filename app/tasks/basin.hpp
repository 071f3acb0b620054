/// What the verb basin is asked.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/basins/basins.hpp"

namespace rosin::app::tasks {

/// A coordinate, or the velocity of one, that starts differ in.
struct StartAxis {
  std::string name;
  int coordinate = 0;
  bool is_velocity = false;
  std::vector<double> values = {};  ///< of a grid, or the ends of the range of random starts
  std::string unit = is_velocity ? "m/s" : "m";
  std::optional<double> surface_speed = {};  ///< m/s; of a slip rate, which is this minus the velocity

  /// The velocity that a value stands for, and the value of a velocity.
  double velocity_of(double value) const { return surface_speed ? *surface_speed - value : value; }
  bool is_same(const StartAxis& other) const {
    return coordinate == other.coordinate && is_velocity == other.is_velocity;
  }
};

/// Starts over a plane of two of their values, or disturbances of steady sliding.
struct Basin {
  StartAxis x, y;
  bool random = false;
  std::vector<std::pair<double, double>> places;        ///< of each start along x and y; of a grid in rows of y
  std::vector<std::pair<StartAxis, double>> direction;  ///< of disturbances
  analysis::basins::BasinTask task;
};

}  // namespace rosin::app::tasks
