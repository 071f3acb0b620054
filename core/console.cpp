/// Writing to the standard streams, and remembering what failed.
#include "core/console.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace rosin {

namespace {
int problem = 0;  ///< errno of the first failure of standard output

void remember(bool written) {
  if (!written && problem == 0) problem = errno != 0 ? errno : EIO;
}

std::atomic<Capture*> capture = nullptr;
}  // namespace

Capture::Capture(bool progress_asked) : progress_asked_(progress_asked) { capture = this; }
Capture::~Capture() { capture = nullptr; }

void Capture::add(std::string& to, std::string_view text) {
  const std::lock_guard lock(mutex_);
  to += text;
}
std::string Capture::output() const {
  const std::lock_guard lock(mutex_);
  return output_;
}
std::string Capture::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

void write_output(std::string_view text) {
  if (Capture* into = capture) return into->add(into->output_, text);
  errno = 0;
  remember(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

void write_message(std::string_view text) {
  if (Capture* into = capture) return into->add(into->messages_, text);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void write_progress(double work, std::string_view bar) {
  if (Capture* into = capture)
    into->work_ = work;
  else
    write_message(bar);
}

bool progress_is_seen() {
  const Capture* into = capture;
  return into ? into->progress_asked_ : isatty(STDERR_FILENO) != 0;
}

std::string presentable(std::string text) {
  constexpr std::size_t longest = 10'000;
  if (text.size() > longest) {
    auto cut = longest;
    while (cut > 0 && (text[cut] & 0xc0) == 0x80) --cut;  // between characters of UTF-8
    text = text.substr(0, cut) + "…\n";
  }
  for (char& c : text)
    if ((static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7f) c = '?';
  return text;
}

int output_problem() {
  errno = 0;
  remember(std::fflush(stdout) == 0 && !std::ferror(stdout));
  return problem;
}

}  // namespace rosin
