/// A progress bar with the time left, on standard error and only on a terminal.
#pragma once
#include <chrono>
#include <cstddef>

namespace rosin::app {

class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  void show(std::size_t done, std::size_t total);
  bool visible() const { return visible_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool visible_, drawn_ = false;
  Clock::time_point begin_ = Clock::now(), last_{};
  std::size_t first_ = 0;  ///< points that an earlier run left: they took no time now
};

}  // namespace rosin::app
