/// Records of a journal, and between processes: numbers and a text under a number, with a checksum.
#pragma once
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace rosin::app::verbs {

/// A record that some bytes begin with, which live elsewhere.
struct Record {
  enum class Kind : std::uint8_t { point, cost, value };
  std::size_t length = 0;  ///< bytes; 0: there is no whole record
  std::size_t index = 0;
  Kind kind = Kind::point;
  std::uint8_t regime = 0, origin = 0;
  std::string_view numbers, text;

  std::size_t count() const { return numbers.size() / sizeof(double); }
  double number(std::size_t k) const {
    double value = 0;
    std::memcpy(&value, numbers.data() + k * sizeof value, sizeof value);
    return value;
  }
};

/// Composes one record behind the bytes that are there.
class RecordWriter {
 public:
  RecordWriter(std::string& bytes, Record::Kind, std::size_t index, std::uint8_t regime = 0, std::uint8_t origin = 0);
  void number(double);
  /// All numbers are given. Signs the record; of the text no more than 1000 bytes are kept.
  void finish(std::string_view text = {});

 private:
  std::string& bytes_;
  std::size_t begin_;
};

/// How many numbers a record has, whose numbers begin with these bytes; nothing if it is none that would be written.
using NumberCount = std::function<std::optional<std::size_t>(const Record&, std::string_view bytes)>;
/// The whole record, with the right checksum, that some bytes begin with.
Record record_at(std::string_view bytes, const NumberCount&);

}  // namespace rosin::app::verbs
