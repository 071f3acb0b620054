/// The friction law of a contact that only presses.
#pragma once
#include <memory>

#include "laws/law.hpp"

namespace rosin::laws {

/// No friction at any slip rate, without states and without rest.
std::shared_ptr<const FrictionLaw> frictionless();

}  // namespace rosin::laws
