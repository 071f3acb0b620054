/// How friction and the structure behind it answer small changes: predicted, simulated, and out of records.
#pragma once
#include "analysis/response/contact_slopes.hpp"
#include "analysis/response/extraction.hpp"
#include "analysis/response/frf.hpp"
#include "analysis/response/frf_simulation.hpp"
#include "analysis/response/interval_means.hpp"
#include "analysis/response/sliding_receptance.hpp"
#include "analysis/response/structure.hpp"
