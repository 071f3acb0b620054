/// Compiles the two-state-ageing law into all its forms.
#include "laws/two_state_ageing.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::TwoStateAgeing<double>&);
