/// Compiles the slip-weakening law into all its forms.
#include "laws/slip_weakening.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::SlipWeakening<double>&);
