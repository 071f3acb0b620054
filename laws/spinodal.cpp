/// Compiles the spinodal law into all its forms.
#include "laws/spinodal.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Spinodal<double>&);
