/// Compiles the film law into all its forms.
#include "laws/film.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Film<double>&);
