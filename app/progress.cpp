/// Drawing the progress bar, at most ten times a second.
#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <string>

#include "core/console.hpp"

namespace rosin::app {

Progress::Progress(bool quiet) : visible_(!quiet && isatty(STDERR_FILENO)) {}

Progress::~Progress() {
  if (drawn_) write_message("\r\033[K");
}

void Progress::show(std::size_t done, std::size_t total, double work) {
  const auto now = Clock::now();
  if (work < last_work_) begin_ = now;
  last_work_ = work;
  if (!visible_ || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  drawn_ = true;
  constexpr int width = 40;
  const auto filled = static_cast<std::size_t>(work * width);
  std::string left;
  if (work > 0) {
    const double spent = std::chrono::duration<double>(now - begin_).count();
    left = fmt::format(", {:.0f} s left", spent * (1 - work) / work);
  }
  write_message(fmt::format("\r\033[K[{}{}] {:3.0f} %, {} of {} points{}", std::string(filled, '='),
                            std::string(width - filled, ' '), 100 * work, done, total, left));
}

std::function<void(const analysis::MapProgress&)> Progress::of_map() {
  if (!visible_) return nullptr;
  return [this](const analysis::MapProgress& now) { show(now.done, now.total, now.work); };
}

}  // namespace rosin::app
