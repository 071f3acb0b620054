/// The command run in a folder of its own, and what it printed.
#pragma once
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "tests/app/folder.hpp"

namespace rosin::tests {

struct Printed {
  int status;  ///< of its exit; −1: it was ended by a signal
  std::string out, error;
};
/// \param arguments as a shell takes them.
inline Printed run_program(const Folder& folder, const std::string& program, const std::string& arguments) {
  const auto line =
      "cd '" + folder.path.string() + "' && '" + program + "' " + arguments + " >out.txt 2>error.txt </dev/null";
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(folder.path / "out.txt"),
          content(folder.path / "error.txt")};
}
inline Printed run_rosin(const Folder& folder, const std::string& arguments) {
  return run_program(folder, ROSIN_COMMAND, arguments);
}

}  // namespace rosin::tests
