/// Compiles the LuGre law without load scaling into all its forms.
#include "laws/lugre_unscaled.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::LugreUnscaled<double>&);
