/// Bowed strings: motion, transients, planes; periodic motion; and how steady sliding grows into it.
#pragma once
#include "analysis/strings/bowing.hpp"
#include "analysis/strings/plane.hpp"
#include "analysis/strings/sliding.hpp"
#include "analysis/strings/string_cycle.hpp"
#include "analysis/strings/string_exponent.hpp"
#include "analysis/strings/transient.hpp"
