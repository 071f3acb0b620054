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
