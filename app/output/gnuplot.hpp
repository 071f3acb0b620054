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
/// "normal load (N)", quoted; what follows a semicolon in a meaning explains more than an axis has room for.
std::string label(std::string_view meaning, std::string_view unit);
/// How an axis names a number of a scene, with its symbol: 'speed of the driving surface V (m/s)', 'force on the slider
/// f, amplitude of harmonic 1 (N)'. Quoted, with a font in which it is no longer than a side of the panel.
std::string axis_label(char axis, std::string_view path, std::string_view meaning, std::string_view unit);

/// A unit with the prefix that suits the largest value: ticks read 20, 40 µm/s instead of 2e-05, 4e-05 m/s.
struct Scaled {
  double factor;  ///< multiplies SI values
  std::string unit;
};
Scaled scaled(const std::string& unit, double largest);

/// How a panel shows values of a quantity: less what they have in common where they hardly change, "displacement x − 5
/// m", so that ticks stay short; by a factor, in the unit that suits the rest.
struct DrawnRange {
  double off, factor;
  std::string label;                     ///< quoted
  double low, high;                      ///< as drawn
  std::string column(int number) const;  ///< for gnuplot
};
DrawnRange drawn_range(const std::string& name, const std::string& unit, double low, double high);

/// True where only a logarithmic axis shows all values.
bool spans_decades(double low, double high);
/// Makes an axis logarithmic, with decades as ticks, or linear.
std::string axis_scale(char axis, bool decades);

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
