/// Drawing the progress bar, at most ten times a second.
#include "app/verbs/progress.hpp"

#include <fmt/format.h>

#include <string>

#include "core/console.hpp"

namespace rosin::app::verbs {

Progress::Progress(bool quiet) : visible_(!quiet && progress_is_seen()) {}

Progress::~Progress() {
  if (drawn_) write_progress(1, "\r\033[K");
}

bool Progress::due(double work) {
  const auto now = Clock::now();
  if (work < last_work_) begin_ = now;
  last_work_ = work;
  if (!visible_ || now - last_ < std::chrono::milliseconds(100)) return false;
  last_ = now;
  return true;
}

void Progress::draw(double work, const std::string& what) {
  drawn_ = true;
  constexpr int width = 40;
  const auto filled = static_cast<std::size_t>(work * width);
  std::string left;
  if (work > 0) {
    const double spent = std::chrono::duration<double>(Clock::now() - begin_).count();
    left = fmt::format(", {:.0f} s left", spent * (1 - work) / work);
  }
  write_progress(work, fmt::format("\r\033[K[{}{}] {:3.0f} %{}{}", std::string(filled, '='),
                                   std::string(width - filled, ' '), 100 * work, what, left));
}

void Progress::show(std::size_t done, std::size_t total, double work) {
  if (due(work)) draw(work, fmt::format(", {} of {}", done, total));
}

void Progress::show_pass(double part) {
  if (due(part)) draw(part, " of a pass over the motion");
}

std::function<void(const analysis::planes::MapProgress&)> Progress::of_map() {
  if (!visible_) return nullptr;
  return [this](const analysis::planes::MapProgress& now) { show(now.done, now.total, now.work); };
}

}  // namespace rosin::app::verbs
