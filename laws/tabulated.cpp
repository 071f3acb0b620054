/// Compiles the tabulated law into all its forms.
#include "laws/tabulated.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Tabulated<double>&);
