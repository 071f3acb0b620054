/// A mechanism that moves through one oscillation, as an SVG that plays by itself in any browser, without scripts.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "analysis/motion/last_oscillation.hpp"

namespace rosin::app::output {

using Place = std::array<double, 2>;  ///< m, to the right and upwards

struct Animation {
  std::string title;
  std::vector<std::string> caption = {};          ///< lines below
  double left = 0, right = 1, low = 0, high = 1;  ///< m, what is shown
  double begin = 0, period = 1;                   ///< s
  double rough = 0;  ///< m: depth of the layer of roughness below the surface at height 0; the solid begins there
  double belt = 0;   ///< m, by which the surface moves to the right in the period

  /// Lines, in frames of equal duration.
  struct Lines {
    const char* style;
    std::vector<std::vector<std::vector<Place>>> frames;  ///< [frame][line]
  };
  std::vector<Lines> lines = {};
  struct Station {
    std::vector<Place> place;
    std::vector<analysis::motion::Touch> touch;
  };
  std::vector<Station> stations = {};
  /// Drawn over the period, with a line that moves along.
  struct Curve {
    const char *name, *style;
    std::vector<double> values;
  };
  std::vector<Curve> curves = {};
  std::string curve_unit;
};

inline constexpr const char* body_style = "fill:none;stroke:#33475b;stroke-width:1.2;stroke-linejoin:round";
inline constexpr const char* spring_style = "fill:none;stroke:#666;stroke-width:1.5;stroke-linejoin:round";

/// As many frames as keep a drawing of so many points below 200 kB, 12 to 48.
int frames_for(std::size_t points);

std::string svg(const Animation&);

}  // namespace rosin::app::output
