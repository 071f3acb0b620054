/// What all gnuplot scripts have in common, and running gnuplot on them.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/output/symbols.hpp"

namespace rosin::app::output {

/// Any text as gnuplot takes it, in single quotes joined by dots: markup is shown as it is, control characters dropped.
std::string single_quoted(std::string_view text);

/// A unit with the prefix that suits the largest value: ticks read 20, 40 µm/s instead of 2e-05, 4e-05 m/s.
struct Scaled {
  double factor;  ///< multiplies SI values
  std::string unit;
};
Scaled scaled(const std::string& unit, double largest);

/// How a panel shows values of a quantity: less what they have in common where they hardly change, "displacement x − 5
/// m", so that ticks stay short; by a factor, in the unit that suits the rest.
struct DrawnRange {
  double off = 0, factor = 1;
  std::string unit, common;  ///< " − 5 m": behind the name
  double low = 0, high = 0;  ///< as drawn
};
DrawnRange drawn_range(const std::string& unit, double low, double high);

/// A step between ticks that leaves about four: 1, 2 or 5 times a power of ten.
double tick_step(double low, double high);

/// What pictures are drawn as besides SVG and PNG, and how wide they are in print (mm); 0: as on a screen.
struct Formats {
  bool pdf = false;
  double width = 0;
};
/// Draws scripts of the folder.
struct Drawn {
  std::vector<std::string> files, problems;
};
Drawn draw(const std::filesystem::path& folder, const std::vector<std::string>& scripts, const Formats&);

}  // namespace rosin::app::output
