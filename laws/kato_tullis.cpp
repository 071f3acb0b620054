/// Compiles the kato-tullis law into all its forms.
#include "laws/kato_tullis.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::KatoTullis<double>&);
