/// Compiles the thermal law into all its forms.
#include "laws/thermal.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Thermal<double>&);
