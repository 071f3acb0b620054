/// A progress bar with the time left, on standard error and only on a terminal.
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "analysis/planes/map.hpp"

namespace rosin::app::verbs {

class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  /// `work`: what is done of what this run has to do, 0 … 1; the time left goes by it. Time counts from a first call
  /// with nothing done, after preparations, and again from where less is done than before, as of the next plane.
  void show(std::size_t done, std::size_t total, double work);
  /// Of a pass over a motion, of which a run takes two or more.
  void show_pass(double part);
  /// The same where all take alike long.
  void show(std::size_t done, std::size_t total) { show(done, total, double(done) / double(total)); }
  /// What a map is to call, or nothing where nobody sees it: to foretell its time takes some itself.
  std::function<void(const analysis::planes::MapProgress&)> of_map();
  bool visible() const { return visible_; }

 private:
  /// Whether the bar is due to be drawn.
  bool due(double work);
  void draw(double work, const std::string& what);
  using Clock = std::chrono::steady_clock;
  bool visible_, drawn_ = false;
  double last_work_ = 1;
  Clock::time_point begin_ = Clock::now(), last_{};
};

}  // namespace rosin::app::verbs
