/// No friction: Coulomb's law with a coefficient of 0, smoothed, so that it has no rest to be located.
#include "laws/frictionless.hpp"

#include "laws/catalogue.hpp"
#include "laws/smoothing.hpp"

namespace rosin::laws {

std::shared_ptr<const FrictionLaw> frictionless() {
  static const auto law = smoothed(find_law("coulomb")->with({0.0, 0.0}), {});
  return law;
}

}  // namespace rosin::laws
