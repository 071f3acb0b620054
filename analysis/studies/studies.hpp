/// Statistics over many random scenes: the stress suite, and the study of force algorithms.
#pragma once
#include "analysis/studies/stress.hpp"
#include "analysis/studies/study.hpp"
