/// Texts that quotation marks and escapes must bear: every printable character once, twice and three times in a row, at
/// the beginning, within and at the end, and random rows of those that mean something somewhere.
#pragma once
#include <random>
#include <string>
#include <vector>

namespace rosin::tests {

inline std::vector<std::string> printable_texts() {
  std::vector<std::string> texts;
  for (char c = ' '; c <= '~'; ++c)
    for (const std::size_t times : {1u, 2u, 3u}) {
      const std::string row(times, c);
      for (const auto& text : {row, row + "b", "a" + row, "a" + row + "b"}) texts.push_back(text);
    }
  const std::string marks = "'\"`$\\{}[]()<>&|;#%@^_~!*?=.,: \u00b5";
  std::mt19937 draw(1);
  for (int k = 0; k < 500; ++k) {
    std::string text;
    for (auto length = draw() % 12 + 1; length > 0; --length) text += marks[draw() % (marks.size() - 2)];
    texts.push_back(text + "\u00b5");
  }
  return texts;
}

}  // namespace rosin::tests
