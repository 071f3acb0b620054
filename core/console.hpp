/// Standard output and standard error. A line that cannot be written there neither throws nor ends the process: results
/// stand in files, and what standard output has lost is asked for once, at the end.
#pragma once
#include <fmt/format.h>

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
/// Writes out what waits. \returns the errno of the first failure of standard output, 0 if it has all.
int output_problem();

template <class... Args>
void print(fmt::format_string<Args...> text, Args&&... args) {
  write_output(fmt::format(text, std::forward<Args>(args)...));
}
template <class... Args>
void tell(fmt::format_string<Args...> text, Args&&... args) {
  write_message(presentable(fmt::format(text, std::forward<Args>(args)...)));
}

}  // namespace rosin
