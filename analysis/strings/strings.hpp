/// Bowed strings: motion, transients, planes.
#pragma once
#include "analysis/strings/bowing.hpp"
#include "analysis/strings/plane.hpp"
#include "analysis/strings/transient.hpp"
