/// Compiles the slip law into all its forms.
#include "laws/slip.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Slip<double>&);
