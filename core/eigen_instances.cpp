/// Kernels and decompositions of Eigen, compiled here for all files.
#include "core/eigen_assertions.hpp"
// Definitions in place of declarations.
#define ROSIN_EIGEN_INSTANCE template
#include "core/eigen_instances.hpp"
