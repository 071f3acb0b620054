/// Compiles the loading-rate law into all its forms.
#include "laws/loading_rate.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::LoadingRate<double>&);
