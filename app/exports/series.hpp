/// The series of a finished run, as other programs' formats need it.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace rosin::app::exports {

/// A run of one slider, SI; per unit of the scene's area, which is 1 where it gives none.
struct Series {
  std::string title;
  double area = 1;
  std::vector<double> time, slip_rate, velocity, displacement, friction_force, friction_coefficient;
  std::vector<double> load_displacement;  ///< of the load point since the start
  std::vector<double> normal_load;
  double stiffness = 0;
  struct State {
    std::string name;
    std::vector<double> values;
  };
  std::vector<State> states;

  /// Slip of the contact since the start.
  double slip(std::size_t i) const { return load_displacement[i] - (displacement[i] - displacement.front()); }
};

/// One program's columns.
struct Format {
  const char *name, *what;
  /// The whole text, its header included, which says what is not filled.
  std::string (*text)(const Series&);
};

/// All of them, in the order of formats.def.
const std::vector<Format>& formats();

}  // namespace rosin::app::exports
