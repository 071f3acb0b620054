/// Compiles the kato-growth law into all its forms.
#include "laws/kato_growth.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::KatoGrowth<double>&);
