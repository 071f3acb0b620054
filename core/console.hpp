/// Standard output and standard error. A line that cannot be written there neither throws nor ends the process: results
/// stand in files, and what standard output has lost is asked for once, at the end. Within another program, which has
/// its own use for these streams, both may be captured.
#pragma once
#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace rosin {

void write_output(std::string_view);
/// A message: lost without a word if nobody can read it.
void write_message(std::string_view);
/// A text that may quote anything, as a message: no control characters, which a terminal would obey, and no more of it
/// than anybody reads.
std::string presentable(std::string text);
/// How much of the work is done, 0 … 1, and the bar that a terminal shows of it.
void write_progress(double work, std::string_view bar);
/// Whether anybody sees the progress: on a terminal, or where a capture asks for it.
bool progress_is_seen();
/// Writes out what waits. \returns the errno of the first failure of standard output, 0 if it has all.
int output_problem();

/// While it lives, all threads write into it instead of the standard streams. One at a time.
class Capture {
 public:
  explicit Capture(bool progress_asked);
  ~Capture();
  Capture(const Capture&) = delete;

  std::string output() const;
  std::string messages() const;
  double work() const { return work_; }

 private:
  friend void write_output(std::string_view);
  friend void write_message(std::string_view);
  friend void write_progress(double, std::string_view);
  friend bool progress_is_seen();
  void add(std::string& to, std::string_view text);

  mutable std::mutex mutex_;
  std::string output_, messages_;
  std::atomic<double> work_ = 0;
  bool progress_asked_;
};

template <class... Args>
void print(fmt::format_string<Args...> text, Args&&... args) {
  write_output(fmt::format(text, std::forward<Args>(args)...));
}
template <class... Args>
void tell(fmt::format_string<Args...> text, Args&&... args) {
  write_message(presentable(fmt::format(text, std::forward<Args>(args)...)));
}

}  // namespace rosin
