/// What each verb of the command does: read the scene, compute, write the results folder, say what came out.
#pragma once
#include "app/command_line.hpp"

namespace rosin::app {

/// Exit statuses of the command.
enum Status { done = 0, ended_short = 1, wrong_input = 2, interrupted = 130 };

/// \throws InputError for a wrong scene, Stopped where it was asked to end and has nothing to keep.
Status execute(const Request&);

}  // namespace rosin::app
