/// Compiles the flash-heating law into all its forms.
#include "laws/flash_heating.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::FlashHeating<double>&);
