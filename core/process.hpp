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
  std::vector<std::string> environment = {};  ///< "NAME=value", in place of what is there
  bool stops_with_us = false;                 ///< is ended where this thread is asked to stop
  std::string input = {};                     ///< that it reads
  std::size_t longest_output = 1 << 16;       ///< bytes of its standard output that are kept
};

struct Ran {
  int status;                    ///< of its exit; 128 and the signal that ended it
  std::string output, messages;  ///< the beginning of its standard output, and of its standard error (64 KiB)
};

/// Runs a program to its end. Nothing if it cannot be started.
/// \throws Stopped where the thread was asked to stop and the program was ended for it.
std::optional<Ran> run_program(const Command&);

/// A text as one word of a POSIX shell, for command lines that people copy.
std::string shell_word(const std::string& text);

}  // namespace rosin
