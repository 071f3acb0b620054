/// Compiles the stribeck law into all its forms.
#include "laws/stribeck.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Stribeck<double>&);
