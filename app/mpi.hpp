/// Letters by MPI.
#pragma once
#include "app/command.hpp"

namespace rosin::app {

/// Joins the processes of the launcher by MPI. Null where the command is built without it.
JoinProcesses mpi();

}  // namespace rosin::app
