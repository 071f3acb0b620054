/// Virtual experiments: protocols, sensors and readings.
#pragma once
#include "analysis/lab/experiment.hpp"
