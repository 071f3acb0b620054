/// A contact that heals below 4e-11 m/s and creeps through rest in each period.
#pragma once
#include "tests/bristol_board.hpp"

namespace rosin::tests {

inline oscillators::Model healing_at_rest() {
  auto model = slider_under("kato-tullis", {0.3667, 0.005767, 0.0221, 9.415e-6, 0.0001642, 3.689e-11},
                            {6.34e-5, 1084, 0.002561}, 0.4926, 1.054e5);
  model.lambda = 1.542e5;
  return model;
}

}  // namespace rosin::tests
