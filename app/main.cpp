/// The `rosin` command.
#include "app/mpi.hpp"

int main(int argc, char** argv) { return rosin::app::command(argc, argv, rosin::app::mpi()); }
