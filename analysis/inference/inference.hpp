/// What measurements tell of laws and parameters: fits, laws made equal, and designs that decide between them.
#pragma once
#include "analysis/inference/derived.hpp"
#include "analysis/inference/discrimination.hpp"
#include "analysis/inference/equalise.hpp"
#include "analysis/inference/fit.hpp"
#include "analysis/inference/machine.hpp"
#include "analysis/inference/machine_motion.hpp"
#include "analysis/inference/recorded_motion.hpp"
#include "analysis/inference/recorded_slip_rate.hpp"
#include "analysis/inference/slip_events.hpp"
#include "analysis/inference/wider_law.hpp"
