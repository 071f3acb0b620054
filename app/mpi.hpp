/// Letters by MPI.
#pragma once
#include <memory>

#include "app/verbs/mail.hpp"

namespace rosin::app {

/// True if the command was built with MPI.
bool has_mpi();
/// Joins the processes of the launcher. Nothing without MPI.
std::unique_ptr<verbs::Mail> mail_by_mpi();

}  // namespace rosin::app
