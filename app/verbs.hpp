/// What each verb of the command does: read the scene, compute, write the results folder, say what came out.
#pragma once
#include <string_view>

#include "app/command_line.hpp"
#include "app/scene.hpp"

namespace rosin::app {

/// Exit statuses of the command.
enum Status { done = 0, ended_short = 1, wrong_input = 2, interrupted = 130 };

/// What a verb that reads a scene asks of it. \throws InputError for a name that is no such verb, with the nearest.
Verb scene_verb(std::string_view name);

/// \throws InputError for a wrong scene, Stopped where it was asked to end and has nothing to keep.
Status execute(const Request&);

}  // namespace rosin::app
