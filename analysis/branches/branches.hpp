/// What changes along a parameter: branches of steady sliding and of cycles.
#pragma once
#include "analysis/branches/branch.hpp"
#include "analysis/branches/locus.hpp"
