/// A slider as a family along one of its numbers.
#pragma once
#include <string>

#include "analysis/branches/branch.hpp"
#include "oscillators/model.hpp"

namespace rosin::tests {

inline analysis::branches::Family along(const oscillators::Model& model, const std::string& path) {
  return [=](double p) { return analysis::branches::oscillator_of(model.with(path, p)); };
}

}  // namespace rosin::tests
