/// Compiles the two-state-slip law into all its forms.
#include "laws/two_state_slip.hpp"

#include "laws/adapter.hpp"

template std::shared_ptr<const rosin::FrictionLaw> rosin::laws::make_law(const rosin::laws::TwoStateSlip<double>&);
