#include "laws/spinodal.hpp"

#include "laws/adapter.hpp"

template class rosin::laws::Law<rosin::laws::Spinodal>;
