/// Compiles the dahl law into all its forms.
#include "laws/dahl.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Dahl<double>&);
