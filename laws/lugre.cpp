/// Compiles the lugre law into all its forms.
#include "laws/lugre.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Lugre<double>&);
