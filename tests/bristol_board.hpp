/// The slider of Woodhouse, Putelat & McKay (2015), Figs 1 and 2, for tests.
#pragma once
#include <cmath>

#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"

namespace rosin::tests {

inline constexpr double gravity = 9.81;

/// Bristol board at λ under a load (N); mass 1 kg, spring 1.09 N/m.
inline oscillators::Model board_under(double load, double lambda, double speed) {
  oscillators::Model model;
  model.law = laws::find_law("spinodal");
  model.lambda = lambda;
  model.slider = {.mass = 1, .stiffness = 1.09, .damping = 0};
  model.drive = {.speed = speed, .normal_load = load, .force = 0.0};
  return model;
}
/// The same at N/(mg), drive 0.01 mm/s.
inline oscillators::Model bristol_board(double load_over_weight, double lambda, double speed = 1e-5) {
  return board_under(load_over_weight * gravity, lambda, speed);
}

/// Where the question is of the contact alone.
inline constexpr oscillators::Slider any_slider{.mass = 1, .stiffness = 1, .damping = 0};

/// Law `name` with parameter values in the order of its table, on a slider.
inline oscillators::Model slider_under(const char* name, std::vector<Value> values, oscillators::Slider slider,
                                       double speed, double load) {
  oscillators::Model model;
  model.law = laws::find_law(name)->with(std::move(values));
  model.slider = slider;
  model.drive = {.speed = speed, .normal_load = load, .force = 0.0};
  return model;
}

}  // namespace rosin::tests
