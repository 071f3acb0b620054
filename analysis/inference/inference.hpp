/// What measurements tell of laws and parameters: fits, laws made equal, and designs that decide between them.
#pragma once
#include "analysis/inference/discrimination.hpp"
#include "analysis/inference/equalise.hpp"
#include "analysis/inference/fit.hpp"
#include "analysis/inference/stick_slip.hpp"
