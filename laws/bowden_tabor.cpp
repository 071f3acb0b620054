/// Compiles the bowden-tabor law into all its forms.
#include "laws/bowden_tabor.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::BowdenTabor<double>&);
