/// The catalogue of friction laws: all of them, one by name, one with published parameter values.
#pragma once
#include "laws/law.hpp"

namespace rosin::laws {

/// Every law that rosin ships, with its default parameter values.
const std::vector<std::shared_ptr<const FrictionLaw>>& catalogue();

/// The law of that name, with its default parameter values. \throws InputError with the nearest name.
std::shared_ptr<const FrictionLaw> find_law(std::string_view name);

/// `law` with the published parameter values of that name. \throws InputError with the nearest name.
std::shared_ptr<const FrictionLaw> preset(const FrictionLaw& law, std::string_view name);

}  // namespace rosin::laws
