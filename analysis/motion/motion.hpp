/// How a model moves from a start: runs of a slider, a structure, and a mass in the plane.
#pragma once
#include "analysis/motion/last_oscillation.hpp"
#include "analysis/motion/plane_run.hpp"
#include "analysis/motion/run.hpp"
#include "analysis/motion/slip_events.hpp"
#include "analysis/motion/spectrum.hpp"
#include "analysis/motion/start.hpp"
#include "analysis/motion/stepped_oscillator.hpp"
#include "analysis/motion/stepped_run.hpp"
#include "analysis/motion/stepper.hpp"
#include "analysis/motion/structure_record.hpp"
#include "analysis/motion/structure_run.hpp"
#include "analysis/motion/structure_start.hpp"
