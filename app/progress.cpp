/// Drawing the progress bar, at most ten times a second.
#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace rosin::app {

Progress::Progress(bool quiet) : visible_(!quiet && isatty(STDERR_FILENO)) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::show(std::size_t done, std::size_t total) {
  const auto now = Clock::now();
  if (!visible_ || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  if (!drawn_) first_ = done;
  drawn_ = true;
  constexpr int width = 40;
  const double part = total == 0 ? 1 : double(done) / double(total);
  const auto filled = static_cast<std::size_t>(part * width);
  std::string left;
  if (done > first_) {
    const double spent = std::chrono::duration<double>(now - begin_).count();
    left = fmt::format(", {:.0f} s left", spent * double(total - done) / double(done - first_));
  }
  fmt::print(stderr, "\r\033[K[{}{}] {:3.0f} %, {} of {} points{}", std::string(filled, '='),
             std::string(width - filled, ' '), 100 * part, done, total, left);
  std::fflush(stderr);
}

}  // namespace rosin::app
