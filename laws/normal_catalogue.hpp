/// The normal laws by name, with their parameters as scenes give them.
#pragma once
#include <string>
#include <vector>

#include "laws/normal_law.hpp"

namespace rosin::laws {

/// A parameter of `normal_contact`. Its default is a number, or a word: "required", or that of another parameter.
struct NormalParameter {
  Quantity quantity;
  std::string value;
};
struct NormalEntry {
  const Card* card;
  std::vector<NormalParameter> parameters;
};

const std::vector<NormalEntry>& normal_catalogue();

}  // namespace rosin::laws
