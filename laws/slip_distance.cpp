/// Compiles the slip-distance law into all its forms.
#include "laws/slip_distance.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::SlipDistance<double>&);
