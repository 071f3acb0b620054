/// Compiles the hyperbolic law into all its forms.
#include "laws/hyperbolic.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Hyperbolic<double>&);
