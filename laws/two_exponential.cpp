/// Compiles the two-exponential law into all its forms.
#include "laws/two_exponential.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::TwoExponential<double>&);
