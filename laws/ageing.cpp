#include "laws/ageing.hpp"

#include "laws/adapter.hpp"

template class rosin::laws::Law<rosin::laws::Ageing>;
