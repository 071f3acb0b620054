/// Steps of smooth motion: collocation, explicit steps, and CVODE.
#pragma once
#include "solvers/steps/collocation.hpp"
#include "solvers/steps/cvode.hpp"
#include "solvers/steps/explicit.hpp"
