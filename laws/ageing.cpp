/// Compiles the ageing law into all its forms.
#include "laws/ageing.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::Ageing<double>&);
