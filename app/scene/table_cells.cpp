/// Reading cells without copying them.
#include "app/scene/table_cells.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

namespace rosin::app::scene {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool means_missing(std::string_view cell) {
  constexpr std::size_t longest = 9;
  if (cell.empty()) return true;
  if (cell.size() > longest) return false;
  static constexpr std::array<std::string_view, 18> words = {
      "-",   "--",   "–",  "—",    "nan",  "-nan", "+nan",    "nan(ind)", "-nan(ind)",
      "n/a", "#n/a", "na", "n.a.", "null", "none", "missing", "1.#qnan",  "-1.#ind"};
  return std::ranges::find(words, lower(cell)) != words.end();
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = char(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

bool next_cell(std::string_view& rest, char separator, std::string_view& cell) {
  if (rest.data() == nullptr) return false;
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin]) && rest[begin] != separator) ++begin;
  if (separator == ' ') {
    while (begin < rest.size() && is_blank(rest[begin])) ++begin;
    if (begin == rest.size()) return false;
  }
  std::size_t end = begin, quote = begin;  // the closing one
  if (begin < rest.size() && rest[begin] == '"') {
    do quote = std::min(rest.find('"', quote + 1), rest.size());
    while (rest.substr(quote, 2) == "\"\"" && ++quote);
    end = std::min(quote + 1, rest.size());
  }
  while (end < rest.size() && (separator == ' ' ? !is_blank(rest[end]) : rest[end] != separator)) ++end;
  cell = rest.substr(begin, end - begin);
  const bool quoted = quote > begin && quote < rest.size() && trimmed(rest.substr(quote + 1, end - quote - 1)).empty();
  if (quoted) cell = rest.substr(begin + 1, quote - begin - 1);
  cell = trimmed(cell);
  rest = end < rest.size() ? rest.substr(end + 1) : std::string_view();
  return true;
}

Kind read_number(std::string_view cell, char decimal, double& value) {
  value = std::nan("");
  std::array<char, 64> copy;
  auto digits = cell;
  if (decimal == ',') {
    if (cell.size() > copy.size() || cell.find('.') != std::string_view::npos)
      return means_missing(cell) ? Kind::missing : Kind::text;
    if (const auto comma = cell.find(','); comma != std::string_view::npos) {
      if (comma == 0 || comma + 1 == cell.size() || !is_digit(cell[comma - 1]) || !is_digit(cell[comma + 1]))
        return Kind::text;
      std::ranges::copy(cell, copy.begin());
      copy[comma] = '.';
      digits = {copy.data(), cell.size()};
    }
  }
  if (digits.size() > 1 && digits[0] == '+' && (is_digit(digits[1]) || digits[1] == '.')) digits.remove_prefix(1);
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (problem == std::errc{} && end == digits.data() + digits.size() && std::isfinite(value)) return Kind::number;
  value = std::nan("");
  return means_missing(cell) ? Kind::missing : Kind::text;
}

Kind read_clock(std::string_view cell, double& seconds) {
  seconds = std::nan("");
  if (means_missing(cell)) return Kind::missing;
  const auto whole = [](std::string_view digits, std::size_t most, int low, int high) -> std::optional<int> {
    int value = 0;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool is_whole = !digits.empty() && is_digit(digits.front()) && digits.size() <= most &&
                          problem == std::errc{} && end == digits.data() + digits.size();
    return is_whole && value >= low && value <= high ? std::optional(value) : std::nullopt;
  };
  double days = 0;
  if (cell.size() > 11 && (cell[10] == 'T' || cell[10] == ' ') && cell[4] == cell[7] &&
      (cell[4] == '-' || cell[4] == '/')) {
    const auto year = whole(cell.substr(0, 4), 4, 1900, 9999), month = whole(cell.substr(5, 2), 2, 1, 12),
               day = whole(cell.substr(8, 2), 2, 1, 31);
    if (!year || !month || !day) return Kind::text;
    const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(unsigned(*month)),
                                           std::chrono::day(unsigned(*day))};
    if (!date.ok()) return Kind::text;
    days = double(std::chrono::sys_days(date).time_since_epoch().count());
    cell.remove_prefix(11);
    if (cell.ends_with('Z')) cell.remove_suffix(1);
  }
  const auto first = cell.find(':'), second = cell.find(':', std::min(first, cell.size() - 1) + 1);
  if (first == std::string_view::npos || second == std::string_view::npos) return Kind::text;
  const auto point = std::min(cell.find_first_of(".,", second), cell.size());
  const auto hours = whole(cell.substr(0, first), 4, 0, 9999),
             minutes = whole(cell.substr(first + 1, second - first - 1), 2, 0, 59),
             whole_seconds = whole(cell.substr(second + 1, point - second - 1), 2, 0, 59);
  if (!hours || !minutes || !whole_seconds) return Kind::text;
  double part = 0;
  if (point < cell.size()) {
    const auto digits = cell.substr(point + 1);
    if (digits.empty() || !std::ranges::all_of(digits, is_digit)) return Kind::text;
    const auto fraction = "0." + std::string(digits);
    std::from_chars(fraction.data(), fraction.data() + fraction.size(), part);
  }
  seconds = days * 86400 + *hours * 3600 + *minutes * 60 + *whole_seconds + part;
  return Kind::number;
}

Kind read_cell(std::string_view cell, char decimal, double& value) {
  const auto kind = read_number(cell, decimal, value);
  return kind == Kind::text ? read_clock(cell, value) : kind;
}

std::string_view without_end(std::string_view line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  return line;
}

std::string_view without_comment(std::string_view text) {
  for (auto at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1)) {
    const bool begins = at == 0 || std::string_view(" \t,;").find(text[at - 1]) != std::string_view::npos;
    const bool quoted = std::ranges::count(text.substr(0, at), '"') % 2 != 0;
    if (begins && !quoted && lower(text.substr(at, 4)) != "#n/a") return text.substr(0, at);  // "1.#QNAN" is none
  }
  return text;
}
bool is_comment(std::string_view text) {
  text = trimmed(text);
  return !text.empty() && (text.front() == '%' || (text.front() == '#' && lower(text.substr(0, 4)) != "#n/a"));
}

std::string in_utf8(std::string_view text) {
  bool valid = true;
  for (std::size_t i = 0; i < text.size() && valid;) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t more = c < 0x80 ? 0 : (c >> 5) == 6 ? 1 : (c >> 4) == 14 ? 2 : (c >> 3) == 30 ? 3 : 9;
    valid = i + more < text.size();
    for (std::size_t k = 1; valid && k <= more; ++k) valid = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    i += more + 1;
  }
  std::string result;
  for (const char byte : text) {
    const auto c = static_cast<unsigned char>(byte);
    if (valid || c < 0x80)
      result += byte;
    else
      result += char(0xc0 | (c >> 6)), result += char(0x80 | (c & 0x3f));
  }
  return result;
}

}  // namespace rosin::app::scene
