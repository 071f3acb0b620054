/// Stick and slip by located events: of any system, in closed form, and in the plane.
#pragma once
#include "solvers/stick_slip/exact.hpp"
#include "solvers/stick_slip/plane_stick_slip.hpp"
#include "solvers/stick_slip/stick_slip_solver.hpp"
