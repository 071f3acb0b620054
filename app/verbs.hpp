/// What each verb of the command does: read the scene, compute, write the results folder, say what came out.
#pragma once
#include <stop_token>

#include "app/command_line.hpp"

namespace rosin::app {

/// Exit statuses of the command.
enum Status { done = 0, ended_short = 1, wrong_input = 2, interrupted = 130 };

/// \throws InputError for a wrong scene.
Status execute(const Request&, std::stop_token);

/// True if the verb ends in order when it is asked to stop; the others are simply ended.
bool can_stop(const Request&);

}  // namespace rosin::app
