/// Compiles the coulomb law into all its forms.
#include "laws/coulomb.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Coulomb<double>&);
