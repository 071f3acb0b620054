/// Compiles thermal friction with conduction from a disc under a layer into all its forms.
#include "laws/thermal_layer.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::ThermalLayer<double>&);
