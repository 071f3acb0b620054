/// The `rosin` command as a function, for programs that add oscillators of their own (app/add_oscillator.hpp).
#pragma once
#include <memory>

namespace rosin::app {

namespace verbs {
class Mail;
}

/// Joins the processes that a launcher has started together.
using JoinProcesses = std::unique_ptr<verbs::Mail> (*)();

/// Does what the arguments ask, as `rosin` does, and returns the exit status. Called once, by main.
/// \param join null: planes are not spread over processes
int command(int argc, char** argv, JoinProcesses join = nullptr);

}  // namespace rosin::app
