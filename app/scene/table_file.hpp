/// Tables in text files as instruments write them: how they are laid out is found, and rows are read in blocks so that
/// memory does not grow.
#pragma once
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/scene/table_layout.hpp"

namespace rosin::app::scene {

class TableFile {
 public:
  /// Reads the head. \throws InputError with file and line where it cannot be understood, and with the cure.
  TableFile(const std::filesystem::path&, const TableKeys&);

  const TableHead& head() const { return head_; }
  /// The index of a column, whose numbers will be read. \throws InputError that offers the nearest name.
  std::size_t need(const RecordColumn&);
  /// Reads the next row: the numbers of the needed columns, NaN where one is missing. False at the end.
  /// \throws InputError with file and line for anything else.
  bool row(std::vector<double>& cells);
  long line() const { return line_number_; }
  const std::string& path() const { return path_; }

 private:
  std::size_t find(const RecordColumn&) const;
  bool line(std::string_view& text);
  void fill();
  void read_head(const TableKeys&);
  [[noreturn]] void refuse(long line, const std::string& why) const;

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_ = std::vector<char>(1 << 18);
  std::size_t filled_ = 0, at_ = 0;
  bool ended_ = false;
  char line_end_ = '\n';
  long line_number_ = 0;
  TableHead head_;
  std::vector<char> needed_;
};

}  // namespace rosin::app::scene
