/// Compiles thermal friction with conduction from a disc into all its forms.
#include "laws/thermal_disc.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::ThermalDisc<double>&);
