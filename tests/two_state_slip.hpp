/// A slider without mass under the slip law with two states of Gu, Rice, Ruina & Tse (1984), whose periods double.
#pragma once
#include <utility>

#include "laws/catalogue.hpp"
#include "oscillators/model.hpp"

namespace rosin {

inline oscillators::Model two_state_slip(double stiffness) {
  oscillators::Model model;
  model.law = laws::find_law("two-state-slip");
  model.slider = {0, stiffness, 0};
  model.drive.speed = 1e-6, model.drive.normal_load = 1.0;
  for (const auto& [name, value] : {std::pair{"law.a", 0.01},
                                    {"law.b1", 0.01},
                                    {"law.b2", 0.0084},
                                    {"law.L1", 2e-6},
                                    {"law.L2", 2e-6 / 0.048},
                                    {"law.v0", 1e-6}})
    model = model.with(name, value);
  return model;
}

}  // namespace rosin
