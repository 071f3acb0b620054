/// Writing to the standard streams, and remembering what failed.
#include "core/console.hpp"

#include <cerrno>
#include <cstdio>

namespace rosin {

namespace {
int problem = 0;  ///< errno of the first failure of standard output

void remember(bool written) {
  if (!written && problem == 0) problem = errno != 0 ? errno : EIO;
}
}  // namespace

void write_output(std::string_view text) {
  errno = 0;
  remember(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

void write_message(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

int output_problem() {
  errno = 0;
  remember(std::fflush(stdout) == 0 && !std::ferror(stdout));
  return problem;
}

}  // namespace rosin
