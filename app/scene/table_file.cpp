/// Reading the rows of a text table by blocks, after its layout was found from the first 64 KiB.
#include "app/scene/table_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <functional>

#include "app/scene/table_cells.hpp"
#include "core/error.hpp"

namespace rosin::app::scene {

namespace {

namespace fs = std::filesystem;
constexpr std::size_t sample_length = 1 << 16;  // bytes by which the layout is judged
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

/// A file may be anything, a secret too: only what reads as a name is shown.
bool reads_as_name(const std::string& name) {
  constexpr std::size_t longest = 60;
  return !name.empty() && name.size() <= longest && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) || c >= 0x80 || std::string_view("_- .'").find(char(c)) != std::string_view::npos;
  });
}

}  // namespace

TableFile::TableFile(const fs::path& path, const TableKeys& keys)
    : path_(path.string()), file_(std::fopen(path_.c_str(), "rb")) {
  if (!file_) throw InputError(fmt::format("{}: cannot be read", path_));
  while (!ended_ && filled_ < buffer_.size()) fill();
  const std::string_view content(buffer_.data(), filled_);
  for (const std::string_view mark : {"\xff\xfe", "\xfe\xff"})
    if (content.starts_with(mark)) refuse(1, "is text of two bytes a letter (UTF-16); save it as UTF-8");
  if (content.starts_with(byte_order_mark)) at_ = byte_order_mark.size();
  if (content.find('\0') != std::string_view::npos)
    throw InputError(fmt::format("{}: holds bytes of zero, and is no text", path_));
  if (content.find('\n') == std::string_view::npos && content.find('\r') != std::string_view::npos) line_end_ = '\r';
  read_head(keys);
  needed_.assign(head_.columns.size(), 0);
}

void TableFile::refuse(long line, const std::string& why) const {
  throw InputError(fmt::format("{}:{}: {}", path_, line, why));
}

void TableFile::fill() {
  const auto got = std::fread(buffer_.data() + filled_, 1, buffer_.size() - filled_, file_.get());
  filled_ += got;
  ended_ = got == 0;
}

bool TableFile::line(std::string_view& text) {
  while (true) {
    const auto* begin = buffer_.data() + at_;
    const auto* end = static_cast<const char*>(std::memchr(begin, line_end_, filled_ - at_));
    if (end || (ended_ && filled_ > at_)) {
      if (!end) end = buffer_.data() + filled_;
      text = std::string_view(begin, std::size_t(end - begin));
      at_ = std::min(filled_, at_ + text.size() + 1);
      ++line_number_;
      return true;
    }
    if (ended_) return false;
    std::memmove(buffer_.data(), begin, filled_ - at_);
    filled_ -= at_, at_ = 0;
    if (filled_ == buffer_.size()) refuse(line_number_ + 1, "a line is longer than 256 KiB");
    fill();
  }
}

void TableFile::read_head(const TableKeys& keys) {
  std::vector<TableLine> lines;
  std::vector<std::size_t> offsets;  // in the buffer
  const auto begin = at_;
  while (at_ - begin < sample_length) {
    const bool whole = ended_ || std::memchr(buffer_.data() + at_, line_end_, filled_ - at_);
    if (!whole && !lines.empty()) break;
    const auto offset = at_;
    std::string_view text;
    if (!line(text)) break;
    text = without_end(text);
    if (trimmed(text).empty()) continue;
    lines.push_back({line_number_, text, is_comment(text)});
    offsets.push_back(offset);
  }
  if (lines.empty())
    throw InputError(
        fmt::format("{}: is empty; rows of numbers are needed, below a line with the names of the columns", path_));
  auto layout = find_layout(path_, lines, keys);
  head_ = std::move(layout.head);
  at_ = offsets[layout.first];
  line_number_ = lines[layout.first].number - 1;
}

std::size_t TableFile::find(const RecordColumn& column) const {
  const auto& columns = head_.columns;
  if (column.number > 0) {
    if (std::size_t(column.number) > columns.size())
      throw InputError(fmt::format("{}: has no column {}; its rows have {}", path_, column.number, columns.size()));
    return std::size_t(column.number) - 1;
  }
  const int found = find_column(columns, column.name);
  if (found >= 0) return std::size_t(found);
  if (found < -1)
    throw InputError(fmt::format("{}:{}: several columns are named '{}'; choose one by its number, from 1", path_,
                                 head_.names_line, column.name));
  if (head_.names_line == 0)
    throw InputError(fmt::format(
        "{}: has no column '{}': no line of it holds names of columns; choose columns by their numbers, from 1 to {}",
        path_, column.name, columns.size()));
  std::vector<std::string> known;
  for (const auto& cell : columns) known.push_back(cell.name);
  std::erase_if(known, std::not_fn(reads_as_name));
  const auto near = nearest_name(column.name, known);
  throw InputError(fmt::format(
      "{}:{}: has no column '{}'{} (names are taken from line {}; names_line = … beside the file's name says another)",
      path_, head_.names_line, column.name,
      !near.empty()   ? fmt::format("; did you mean '{}'?", near)
      : known.empty() ? std::string("; its names are none")
                      : fmt::format("; it has {}", fmt::join(known, ", ")),
      head_.names_line));
}

std::size_t TableFile::need(const RecordColumn& column) {
  const auto index = find(column);
  needed_[index] = 1;
  return index;
}

bool TableFile::row(std::vector<double>& cells) {
  const auto n = head_.columns.size();
  cells.resize(n);
  std::string_view text;
  while (line(text)) {
    text = without_end(text);
    if (trimmed(text).empty() || is_comment(text)) continue;
    auto rest = without_comment(text);
    std::size_t index = 0;
    bool last_is_empty = false;
    for (std::string_view cell; next_cell(rest, head_.separator, cell); ++index) {
      last_is_empty = cell.empty();
      if (index >= n || !needed_[index]) continue;
      const auto kind =
          head_.columns[index].clock ? read_clock(cell, cells[index]) : read_number(cell, head_.decimal, cells[index]);
      if (kind == Kind::text) refuse(line_number_, head_.no_number(index, cell));
    }
    // a separator may end some rows and not others
    if (index == n + 1 && last_is_empty) --index;
    if (index + 1 == n && !needed_.back() && head_.columns.back().text.empty()) ++index;
    if (index != n)
      refuse(line_number_, fmt::format("has {} cells, {} {}", index,
                                       head_.names_line > 0 ? "the names are" : "the other rows have", n));
    return true;
  }
  return false;
}

}  // namespace rosin::app::scene
