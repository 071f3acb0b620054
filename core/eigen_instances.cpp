/// Definitions of what eigen_instances.hpp declares.
#define ROSIN_EIGEN_INSTANCE template
#include "core/eigen_instances.hpp"
