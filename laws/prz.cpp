/// Compiles the prz law into all its forms.
#include "laws/prz.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Prz<double>&);
