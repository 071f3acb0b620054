/// Other programs, run by their arguments and never through a shell.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rosin {

/// The program that a command of this name means here and now, as an absolute path: an entry of PATH that is relative
/// would mean another one from within another folder. Nothing if there is none.
std::optional<std::filesystem::path> find_program(const std::string& name);

struct Command {
  std::filesystem::path program;  ///< absolute
  std::vector<std::string> arguments;
  std::filesystem::path folder = {};          ///< in which it runs; empty: the present one
  std::vector<std::string> environment = {};  ///< "NAME=value", besides what is there
};

struct Ran {
  int status;          ///< of its exit; 128 and the signal that ended it
  std::string output;  ///< the first 64 KiB of its standard output
};

/// Runs a program to its end, with nothing to read and its messages dropped. Nothing if it cannot be started.
std::optional<Ran> run_program(const Command&);

}  // namespace rosin
