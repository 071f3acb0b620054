/// What the verb curve is asked.
#pragma once

namespace rosin::app::tasks {

/// The slip rates at which a steady curve is drawn, logarithmically spaced.
struct Curve {
  double from = 1e-9, to = 1;  ///< m/s
  int points = 541;            ///< 60 a decade
  double normal_load = 1;      ///< N; the drive's, where the scene has one
};

}  // namespace rosin::app::tasks
