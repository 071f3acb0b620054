/// Definitions of what eigen_instances.hpp declares.
#include "core/eigen_assertions.hpp"
//
#define ROSIN_EIGEN_INSTANCE template
#include "core/eigen_instances.hpp"
