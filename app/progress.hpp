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
  /// `work`: what is done of what this run has to do, 0 … 1; the time left goes by it.
  void show(std::size_t done, std::size_t total, double work);
  /// The same where all take alike long.
  void show(std::size_t done, std::size_t total) { show(done, total, double(done) / double(total)); }
  bool visible() const { return visible_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool visible_, drawn_ = false;
  Clock::time_point begin_ = Clock::now(), last_{};
};

}  // namespace rosin::app
