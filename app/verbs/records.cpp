/// Composing and checking records.
#include "app/verbs/records.hpp"

#include <type_traits>

#include "core/files.hpp"

namespace rosin::app::verbs {

namespace {

/// The head of a record as it stands in the file; its numbers and its text follow.
struct Head {
  std::uint64_t checksum;  ///< of everything after it
  std::uint64_t index;
  std::uint32_t text_length;
  std::uint8_t regime, origin;
  Record::Kind kind;
  std::uint8_t unused;
};
static_assert(std::is_trivially_copyable_v<Head>);

constexpr std::uint32_t longest_text = 1000;

/// The checksummed part of a record.
std::string_view body(std::string_view bytes) { return bytes.substr(sizeof(Head::checksum)); }

}  // namespace

RecordWriter::RecordWriter(std::string& bytes, Record::Kind kind, std::size_t index, std::uint8_t regime,
                           std::uint8_t origin)
    : bytes_(bytes), begin_(bytes.size()) {
  Head head{};
  head.index = index, head.kind = kind, head.regime = regime, head.origin = origin;
  bytes_.append(reinterpret_cast<const char*>(&head), sizeof head);
}

void RecordWriter::number(double number) { bytes_.append(reinterpret_cast<const char*>(&number), sizeof number); }

void RecordWriter::finish(std::string_view text) {
  text = text.substr(0, longest_text);
  bytes_ += text;
  Head head;
  std::memcpy(&head, bytes_.data() + begin_, sizeof head);
  head.text_length = static_cast<std::uint32_t>(text.size());
  std::memcpy(bytes_.data() + begin_, &head, sizeof head);
  head.checksum = checksum(body(std::string_view(bytes_).substr(begin_)));
  std::memcpy(bytes_.data() + begin_, &head.checksum, sizeof head.checksum);
}

Record record_at(std::string_view bytes, const NumberCount& count_of) {
  Head head;
  if (bytes.size() < sizeof head) return {};
  std::memcpy(&head, bytes.data(), sizeof head);
  const auto rest = bytes.substr(sizeof head);
  Record record{0, head.index, head.kind, head.regime, head.origin, {}, {}};
  const auto count = count_of(record, rest);
  if (!count || head.text_length > longest_text || *count > rest.size() / sizeof(double)) return {};
  const std::size_t numbers = *count * sizeof(double);
  if (rest.size() - numbers < head.text_length) return {};
  const std::size_t length = sizeof head + numbers + head.text_length;
  if (checksum(body(bytes.substr(0, length))) != head.checksum) return {};
  record.length = length;
  record.numbers = rest.substr(0, numbers), record.text = rest.substr(numbers, head.text_length);
  return record;
}

}  // namespace rosin::app::verbs
