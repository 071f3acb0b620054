/// What all gnuplot scripts have in common, and running gnuplot on them.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::output {

/// A text for gnuplot in single quotes: markup characters are shown as they are, control characters dropped.
std::string single_quoted(std::string_view text);
/// "normal load (N)", quoted; what follows a semicolon in a meaning explains more than an axis has room for.
std::string label(std::string_view meaning, std::string_view unit);
/// "slip_rate" as it is read on an axis.
std::string readable(std::string name);

/// A unit with the prefix that suits the largest value: ticks read 20, 40 µm/s instead of 2e-05, 4e-05 m/s.
struct Scaled {
  double factor;  ///< multiplies SI values
  std::string unit;
};
Scaled scaled(const std::string& unit, double largest);

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
